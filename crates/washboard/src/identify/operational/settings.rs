//! When a pole is stable and a cluster of stable poles a mode: one set of tests for all estimators with orders.

use super::OperationalError;
use serde::{Deserialize, Serialize};

/// The tests of the stabilisation diagram. The defaults suit a dozen modes or fewer.
///
/// No setting is a cut-off of damping: a car's body mode with ζ = 0.3–0.45 is an ordinary mode.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StabilitySettings {
    /// A stable pole's frequency differs by at most this fraction from one of the order before.
    pub frequency_tolerance: f64,
    /// A stable pole's damping ratio differs by at most this from that pole's (0.02 is two points) …
    pub damping_tolerance: f64,
    /// … or by this fraction of itself, whichever is more: a heavily damped mode's ζ scatters more.
    pub damping_tolerance_relative: f64,
    /// A stable pole's shape has at least this modal assurance criterion with that pole's.
    pub min_mac: f64,
    /// A mode is a cluster of stable poles at so many orders at least, as a fraction of the orders computed.
    pub min_order_fraction: f64,
    /// A mode's part of the spectrum exceeds the spectrum's sampling error by so many standard deviations: poles settle
    /// on the highest of some hundred chance bumps, which reach about four.
    pub min_significance: f64,
    /// Poles outside this band are left out, with that reason; without it, those within 2 % of the Nyquist frequency.
    pub band_hz: Option<[f64; 2]>,
}

impl Default for StabilitySettings {
    fn default() -> Self {
        Self {
            frequency_tolerance: 0.02,
            damping_tolerance: 0.02,
            damping_tolerance_relative: 0.1,
            min_mac: 0.95,
            min_order_fraction: 0.4,
            min_significance: 5.0,
            band_hz: None,
        }
    }
}

impl StabilitySettings {
    /// Refuses tolerances and bands without meaning at this rate.
    pub(in crate::identify) fn check(&self, rate_hz: f64) -> Result<(), OperationalError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        require(positive(rate_hz), "rate_hz", "a positive number", rate_hz)?;
        for (field, value) in
            [("frequency_tolerance", self.frequency_tolerance), ("damping_tolerance", self.damping_tolerance)]
        {
            require(positive(value), field, "a positive number", value)?;
        }
        for (field, value) in [
            ("min_mac", self.min_mac),
            ("min_order_fraction", self.min_order_fraction),
            ("damping_tolerance_relative", self.damping_tolerance_relative),
        ] {
            require((0.0..=1.0).contains(&value), field, "a number from 0 to 1", value)?;
        }
        let value = self.min_significance;
        require(value >= 0.0, "min_significance", "a number from 0", value)?;
        check_band(self.band_hz, rate_hz)
    }
}

/// Refuses a band that is none or reaches beyond half the rate.
fn check_band(band_hz: Option<[f64; 2]>, rate_hz: f64) -> Result<(), OperationalError> {
    let Some([low, high]) = band_hz else { return Ok(()) };
    let sound = low >= 0.0 && high > low && high <= rate_hz / 2.0;
    let expected = format!("0 ≤ low < high ≤ {} Hz", rate_hz / 2.0);
    require(sound, "band_hz", expected, if low >= 0.0 { high } else { low })
}

/// A wrong setting as an error that says what was expected.
pub(in crate::identify) fn require(
    holds: bool,
    field: &'static str,
    expected: impl Into<String>,
    found: f64,
) -> Result<(), OperationalError> {
    if holds { Ok(()) } else { Err(OperationalError::Setting { field, expected: expected.into(), found }) }
}
