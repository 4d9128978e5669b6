//! Mode shapes as components of channels, and the criteria of operational modal analysis for them.

use crate::linalg::C64;
use serde::{Deserialize, Serialize};

/// One channel's part in a mode shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShapeComponent {
    /// Which channel.
    pub channel: usize,
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

/// Modal assurance criterion |aᴴb|²/(aᴴa · bᴴb) of shapes as [re, im]: 1 for shapes that are multiples.
///
/// Source: Allemang and Brown, *A correlation coefficient for modal vector analysis*, IMAC I (1982).
#[must_use]
pub fn modal_assurance(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let (mut re, mut im, mut aa, mut bb) = (0.0, 0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        re += x[0] * y[0] + x[1] * y[1];
        im += x[0] * y[1] - x[1] * y[0];
        aa += x[0] * x[0] + x[1] * x[1];
        bb += y[0] * y[0] + y[1] * y[1];
    }
    (re * re + im * im) / (aa * bb).max(f64::MIN_POSITIVE)
}

/// Modal phase collinearity ((Sxx − Syy)² + 4 Sxy²)/(Sxx + Syy)², with S the sums of products of the real and imaginary
/// parts: 1 for a shape whose components are in phase or opposite, 0 for a travelling wave.
///
/// Source: Vacher, Jacquier and Bucharles, *Extensions of the MAC criterion to complex modes*, ISMA (2010).
#[must_use]
pub fn phase_collinearity(shape: &[[f64; 2]]) -> f64 {
    let (xx, yy, xy) = second_moments(shape);
    let trace = xx + yy;
    ((xx - yy).powi(2) + 4.0 * xy * xy) / (trace * trace).max(f64::MIN_POSITIVE)
}

/// Mean phase in degrees in (−90, 90]: the direction of the line through zero that the components lie nearest to,
/// tan 2θ = 2 Sxy/(Sxx − Syy).
///
/// Source: Reynders, Houbrechts and De Roeck, *Fully automated (operational) modal analysis*, MSSP 29 (2012), section 3.
#[must_use]
pub fn mean_phase_deg(shape: &[[f64; 2]]) -> f64 {
    let (xx, yy, xy) = second_moments(shape);
    let degrees = 0.5 * (2.0 * xy).atan2(xx - yy).to_degrees();
    if degrees <= -90.0 { degrees + 180.0 } else { degrees }
}

/// Mean phase deviation in degrees, from 0 (a real shape): Σ |φ_o| acos(|Re(φ_o e^{−iθ})|/|φ_o|)/Σ |φ_o|, θ the mean
/// phase.
///
/// Source: as [`mean_phase_deg`].
#[must_use]
pub fn mean_phase_deviation_deg(shape: &[[f64; 2]]) -> f64 {
    let (sin, cos) = mean_phase_deg(shape).to_radians().sin_cos();
    let (mut sum, mut weights) = (0.0, 0.0);
    for [re, im] in shape {
        let (along, across) = (re * cos + im * sin, im * cos - re * sin);
        let weight = re.hypot(*im);
        sum += weight * across.abs().atan2(along.abs());
        weights += weight;
    }
    (sum / f64::max(weights, f64::MIN_POSITIVE)).to_degrees()
}

fn second_moments(shape: &[[f64; 2]]) -> (f64, f64, f64) {
    shape
        .iter()
        .fold((0.0, 0.0, 0.0), |(xx, yy, xy), s| (xx + s[0] * s[0], yy + s[1] * s[1], xy + s[0] * s[1]))
}

pub(super) fn unit_norm(shape: &mut [[f64; 2]]) {
    let norm = shape.iter().map(|s| s[0] * s[0] + s[1] * s[1]).sum::<f64>().sqrt();
    if norm > 0.0 {
        shape.iter_mut().for_each(|s| *s = [s[0] / norm, s[1] / norm]);
    }
}

/// The shape of normalised channels in the channels' units, its largest component made 1; and the same turn applied to
/// the normalised shape, whose phases do not depend on units otherwise.
pub(in crate::identify) fn largest_one(
    shape: &[[f64; 2]],
    rms: &[f64],
) -> (Vec<ShapeComponent>, Vec<[f64; 2]>) {
    let of = |s: &[f64; 2]| C64::new(s[0], s[1]);
    let scaled: Vec<C64> = shape.iter().zip(rms).map(|(s, rms)| of(s) * *rms).collect();
    let one = C64::new(1.0, 0.0);
    let pivot = scaled.iter().copied().max_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr())).unwrap_or(one);
    let pivot = if pivot.norm() > 0.0 { pivot } else { one };
    let component = |(channel, s): (usize, &C64)| {
        let over = s / pivot;
        ShapeComponent { channel, re: over.re, im: over.im }
    };
    let turned = |s: &[f64; 2]| {
        let turned = of(s) * pivot.conj() / pivot.norm();
        [turned.re, turned.im]
    };
    (scaled.iter().enumerate().map(component).collect(), shape.iter().map(turned).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_real_shape_that_is_turned_has_its_phase_and_no_deviation() {
        let turn = C64::from_polar(1.0, 30f64.to_radians());
        let shape: Vec<[f64; 2]> = [1.0, -0.4, 0.7].iter().map(|s| turn * s).map(|s| [s.re, s.im]).collect();
        assert!((mean_phase_deg(&shape) - 30.0).abs() < 1e-12);
        assert!(mean_phase_deviation_deg(&shape) < 1e-12);
        assert!((phase_collinearity(&shape) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_travelling_wave_is_not_collinear() {
        let shape = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        assert!(phase_collinearity(&shape) < 1e-14);
        assert!(mean_phase_deviation_deg(&shape) > 40.0);
    }

    #[test]
    fn a_component_off_the_line_by_an_angle_counts_with_its_size() {
        // the line is the x axis; the two components deviate by ±10°
        let angle = 10f64.to_radians();
        let shape = [[angle.cos(), angle.sin()], [3.0 * angle.cos(), -3.0 * angle.sin()], [2.0, 0.0]];
        let theta = mean_phase_deg(&shape);
        let expected = ((10.0 - theta) + 3.0 * (10.0 + theta) + 2.0 * theta.abs()) / 6.0;
        assert!((mean_phase_deviation_deg(&shape) - expected).abs() < 1e-9);
    }
}
