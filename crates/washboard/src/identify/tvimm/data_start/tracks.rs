//! Which wheels the road reaches first, and which follow them in the same track.

use super::NoDataStart;

/// Wheels this close along the vehicle are on one axle, m.
const SAME_AXLE_M: f64 = 1e-3;

/// The wheels, by axle and track.
#[derive(Debug)]
pub(super) struct Tracks {
    /// Wheel of \[axle\]\[track\], the front axle first; tracks as on the front axle.
    pub wheels: Vec<Vec<Option<usize>>>,
    /// Distance behind the front axle, m.
    pub behind_m: Vec<f64>,
    /// Width between the tracks, m (0 for one).
    pub width_m: f64,
}

impl Tracks {
    /// Every wheel belongs to the nearest track of the front axle.
    pub fn new(at_m: &[[f64; 2]]) -> Result<Self, NoDataStart> {
        let mut behind: Vec<f64> = at_m.iter().map(|p| p[0]).collect();
        behind.sort_by(|a, b| b.total_cmp(a));
        behind.dedup_by(|a, b| (*a - *b).abs() < SAME_AXLE_M);
        let Some(&front) = behind.first() else { return Err(NoDataStart::Wheels) };
        let on_front: Vec<usize> = (0..at_m.len()).filter(|w| front - at_m[*w][0] < SAME_AXLE_M).collect();
        let y: Vec<f64> = on_front.iter().map(|w| at_m[*w][1]).collect();
        let width_m = match y[..] {
            [_] => 0.0,
            [a, b] if (a - b).abs() > SAME_AXLE_M => (a - b).abs(),
            _ => return Err(NoDataStart::Wheels),
        };
        let mut wheels = vec![vec![None; y.len()]; behind.len()];
        for (w, [x, side]) in at_m.iter().enumerate() {
            let axle = behind.iter().position(|b| (b - x).abs() < SAME_AXLE_M).ok_or(NoDataStart::Wheels)?;
            let near = |t: &usize| (y[*t] - side).abs();
            let track = (0..y.len()).min_by(|a, b| near(a).total_cmp(&near(b))).ok_or(NoDataStart::Wheels)?;
            if wheels[axle][track].replace(w).is_some() {
                return Err(NoDataStart::Wheels);
            }
        }
        Ok(Tracks { wheels, behind_m: behind.iter().map(|b| front - b).collect(), width_m })
    }

    /// Number of tracks.
    pub fn count(&self) -> usize {
        self.wheels[0].len()
    }

    /// Share of track t in input k: one track is itself, two are their sum and difference over √2.
    pub fn share(&self, track: usize, input: usize) -> f64 {
        match (self.count(), track, input) {
            (1, ..) => 1.0,
            (_, 1, 1) => -std::f64::consts::FRAC_1_SQRT_2,
            _ => std::f64::consts::FRAC_1_SQRT_2,
        }
    }
}
