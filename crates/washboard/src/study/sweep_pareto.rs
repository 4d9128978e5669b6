//! Points that no other point beats.

/// Which rows no other row dominates: none is as small in every number and smaller in one. Rows with a number that is not finite
/// are beaten by definition.
#[must_use]
pub fn non_dominated(rows: &[Vec<f64>]) -> Vec<bool> {
    let finite = |r: &Vec<f64>| r.iter().all(|v| v.is_finite());
    let beats = |a: &Vec<f64>, b: &Vec<f64>| {
        a.iter().zip(b).all(|(x, y)| x <= y) && a.iter().zip(b).any(|(x, y)| x < y)
    };
    let known: Vec<&Vec<f64>> = rows.iter().filter(|r| finite(r)).collect();
    rows.iter().map(|r| finite(r) && !known.iter().any(|other| beats(other, r))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_worse_in_all_is_beaten_and_equals_are_not() {
        let rows = [[1.0, 3.0], [2.0, 2.0], [2.0, 3.0], [3.0, 1.0], [3.0, 1.0], [0.0, f64::NAN]];
        let rows: Vec<Vec<f64>> = rows.iter().map(|r| r.to_vec()).collect();
        assert_eq!(non_dominated(&rows), [true, true, false, true, true, false]);
    }
}
