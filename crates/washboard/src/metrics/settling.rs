//! How long a response lasts.

/// The usual band about the final value, as a share of the peak.
pub const SETTLING_BAND: f64 = 0.05;

/// The time of the first sample after which a response to a passing disturbance stays within a share of its largest magnitude.
///
/// A response that ends at rest at 0; samples at `time_s`, ascending. 0 where nothing moves. None where it has not been within
/// the band for the whole second half of what comes after `from_s` (when the disturbance is over): the record is too short to say.
///
/// ```
/// use washboard::metrics::{SETTLING_BAND, settling_time};
/// let t: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
/// let y: Vec<f64> = t.iter().map(|t| (-t).exp()).collect();
/// // e^{−t} is 0.05 at ln 20
/// let settled = settling_time(&t, &y, SETTLING_BAND, 0.0);
/// assert!(settled.is_some_and(|s| (s - 20f64.ln()).abs() < 0.011));
/// ```
#[must_use]
pub fn settling_time(time_s: &[f64], response: &[f64], band: f64, from_s: f64) -> Option<f64> {
    let peak = response.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
    if peak == 0.0 {
        return Some(0.0);
    }
    let last = response.iter().rposition(|y| y.abs() > band * peak)?;
    let (settled, end) = (*time_s.get(last + 1)?, *time_s.last()?);
    (settled - from_s <= 0.5 * (end - from_s)).then_some(settled)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(samples: usize) -> Vec<f64> {
        (0..samples).map(|k| 1e-3 * k as f64).collect()
    }

    #[test]
    fn an_oscillation_settles_with_its_envelope() {
        // e^{−ζωt} sin: the last crossing of the band lies within half a period before its envelope's
        let (t, zeta, omega) = (times(20_000), 0.2, 10.0);
        let y: Vec<f64> = t.iter().map(|t| f64::exp(-zeta * omega * t) * f64::sin(omega * t)).collect();
        let peak = y.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let envelope = -(0.05 * peak).ln() / (zeta * omega);
        let found = settling_time(&t, &y, SETTLING_BAND, 0.0).unwrap();
        assert!(
            found <= envelope + 1e-3 && found > envelope - 0.5 * std::f64::consts::TAU / omega,
            "{found}"
        );
        // a tighter band takes longer
        assert!(settling_time(&t, &y, 0.01, 0.0).unwrap() > found);
    }

    #[test]
    fn what_has_not_settled_has_no_time() {
        let t = times(2000);
        let slow: Vec<f64> = t.iter().map(|t| f64::exp(-t)).collect();
        assert_eq!(settling_time(&t, &slow, SETTLING_BAND, 0.0), None);
        assert_eq!(settling_time(&t, &vec![0.0; t.len()], SETTLING_BAND, 0.0), Some(0.0));
        // settled, but not for as long as it has been looked at after the disturbance
        let late: Vec<f64> = t.iter().map(|t| if *t < 1.5 { 1.0 } else { 0.0 }).collect();
        assert_eq!(settling_time(&t, &late, SETTLING_BAND, 0.0), None);
        assert!(settling_time(&t, &late, SETTLING_BAND, 1.4).is_some());
        assert_eq!(settling_time(&[], &[], SETTLING_BAND, 0.0), Some(0.0));
    }
}
