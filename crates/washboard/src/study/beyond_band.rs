//! How much of a variance is from where a fitted filter has no data.

use super::{Flag, Named};
use crate::units::hz;
use crate::vehicle::{Output, Ride, RideError, Variance};
use serde::{Deserialize, Serialize};

/// A share of an output's variance from beyond the band of a filter's data that is worth a word.
const BEYOND: f64 = 0.05;

/// What a fitted filter's own continuation does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BeyondBand {
    /// Band of the data at this speed.
    pub band_hz: [f64; 2],
    /// Share of each output's variance from outside that band, 0 to 1.
    pub share: Named<f64>,
}

/// Shares of variances from outside a band, of single outputs and of stacked vectors.
pub(super) fn beyond(
    ride: &Ride<'_>,
    outputs: &[&Output],
    variances: &[Variance],
    band_rad_s: [f64; 2],
) -> Result<BeyondBand, RideError> {
    let finite = |i: &usize| matches!(variances[*i], Variance::Finite(v) if v > 0.0);
    let kept: Vec<usize> = (0..outputs.len()).filter(finite).collect();
    let subset: Vec<&Output> = kept.iter().map(|i| outputs[*i]).collect();
    let within = ride.variances_in_band(&subset, band_rad_s)?;
    let mut sums: Named<[f64; 2]> = Named::default();
    for (output, (i, within)) in subset.iter().zip(kept.iter().zip(within)) {
        let whole = variances[*i].rms().map_or(0.0, |r| r * r);
        let mut names = vec![output.base.as_str(), output.name.as_str()];
        names.dedup();
        for name in names {
            let [a, b] = sums.get(name).copied().unwrap_or_default();
            sums.insert(name, [a + within, b + whole]);
        }
    }
    let share =
        sums.iter().map(|(n, [within, whole])| (n.to_owned(), (1.0 - within / whole).clamp(0.0, 1.0)));
    Ok(BeyondBand { band_hz: band_rad_s.map(hz), share: share.collect() })
}

/// In words, where a share is large (`whose` follows "variance"); a stacked vector speaks for its components.
pub(super) fn continued(beyond: &BeyondBand, outputs: &[&Output], whose: &str) -> Option<Flag> {
    let mut large: Vec<String> = Vec::new();
    let mut done: Vec<&str> = Vec::new();
    for output in outputs {
        for name in [output.base.as_str(), output.name.as_str()] {
            let Some(share) = beyond.share.get(name).filter(|s| **s > BEYOND) else { continue };
            if done.contains(&name) || done.contains(&output.base.as_str()) {
                continue;
            }
            done.push(name);
            large.push(format!("{name} {:.0} %", 100.0 * share));
        }
    }
    let [low, high] = beyond.band_hz;
    let text = format!(
        "the road's filter was fitted to data from {low:.4} to {high:.4} Hz (at this speed) and goes on beyond as no data says; share of the variance{whose} that is from there: {}",
        large.join(", ")
    );
    (!large.is_empty()).then(|| Flag { name: "beyond-band".into(), text })
}
