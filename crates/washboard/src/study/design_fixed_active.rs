//! The peaks that hold a fixed-order optimum, without the many points of a flat top.

/// A peak below this share of the vehicles' slowest pole is at 0.
const AT_REST: f64 = 1e-6;
/// Active frequencies that are nearer than this share are points of one flat top.
const NEIGHBOURS: f64 = 0.02;

/// Peaks without the many points of one: below a share of the slowest pole they are at 0, and neighbours belong together,
/// where the largest gain is or at the lowest of them.
pub(super) fn clusters(active_rad_s: &[f64], largest_at: Option<f64>, slowest: f64) -> Vec<f64> {
    let own = |w: f64| if w < AT_REST * slowest { 0.0 } else { w };
    let mut all: Vec<f64> = active_rad_s.iter().filter(|w| w.is_finite()).map(|w| own(*w)).collect();
    all.sort_by(f64::total_cmp);
    let apart = |a: &f64, b: &f64| *b <= a * (1.0 + NEIGHBOURS);
    let of = |cluster: &[f64]| {
        let [first, .., last] = cluster else { return cluster[0] };
        largest_at.map(own).filter(|w| (*first..=*last).contains(w)).unwrap_or(*first)
    };
    all.chunk_by(apart).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_at_rest_is_one_peak_and_a_flat_top_too() {
        let all = [10.0, 1e-9, 0.0, 10.1, 3e-8, 10.25, 55.0];
        // 10, 10.1 and 10.25 follow each other within 2 %
        assert_eq!(clusters(&all, None, 1.0), [0.0, 10.0, 55.0]);
        assert_eq!(clusters(&all, Some(10.1), 1.0), [0.0, 10.1, 55.0]);
        // at rest is for the vehicle to say
        assert_eq!(clusters(&[1e-9, 2e-9], None, 1e-4), [1e-9, 2e-9]);
        assert_eq!(clusters(&[f64::INFINITY, 3.0], Some(f64::INFINITY), 1.0), [3.0]);
        assert!(clusters(&[], None, 1.0).is_empty());
    }
}
