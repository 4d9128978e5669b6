//! The smallest bounds that can be kept, where those asked cannot: one factor on all of them, upwards, then by bisection.

/// It is found to this share.
const NEAR_BOUND: f64 = 0.01;
/// The first factor; its square, fourth power, … follow.
const GROWTH: f64 = 1.6;
/// The tightest bound is raised to this multiple of its passive norm at most.
const MOST: f64 = 1e3;

/// The smallest factor on all bounds with which there is a controller, to a per cent: above `least`, which is known to be
/// necessary. None where nothing helps up to a `tightest` bound of [`MOST`] times the passive norm.
pub(super) fn smallest(least: Option<f64>, tightest: f64, met: impl Fn(f64) -> bool) -> Option<f64> {
    let most = MOST / tightest.min(1.0);
    let mut low = least.filter(|l| l.is_finite()).unwrap_or(1.0).max(1.0);
    // from below: where rounding decides, what is possible may have gaps
    if least.is_none() && !met(most) {
        return None;
    }
    let mut high = low * (1.0 + NEAR_BOUND);
    let mut growth = GROWTH;
    while !met(high) {
        low = high;
        high *= growth;
        growth *= growth;
        if low >= most {
            return None;
        }
    }
    while high / low > 1.0 + NEAR_BOUND {
        let middle = (low * high).sqrt();
        if met(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thresholds over twelve decades are found, to a per cent, in at most 24 tries.
    #[test]
    fn a_threshold_is_found_over_decades() {
        for threshold in [1.005, 3.0, 5.4e2, 1e5, 7e8] {
            let tries = std::cell::Cell::new(0);
            let found = smallest(None, 1e-9, |f| {
                tries.set(tries.get() + 1);
                f >= threshold
            });
            let found = found.unwrap();
            assert!(found >= threshold && found <= threshold * 1.0101, "{threshold}: {found}");
            assert!(tries.get() <= 24, "{threshold}: {}", tries.get());
        }
        assert_eq!(smallest(None, 0.1, |_| false), None);
        assert_eq!(smallest(Some(2.0), 0.1, |_| false), None);
    }
}
