//! The phase that a minimum-phase response has by its gain.

use std::f64::consts::PI;

/// Beyond either end of the band a gain goes on in steps of this factor, so many of them: the rest turns the band's
/// phase by less than a milliradian.
const STEP: f64 = 1.1;
const STEPS: i32 = 60;
/// The gain above the band continues that above this share of it.
const UPPER: f64 = 0.7;

/// The phases at all ω of a response with gains e^{a}, in radians.
///
/// φ(ω₀) = (1/π) ∫ (dA/du) ln coth(|u − ln ω₀|/2) du over u = ln ω, exact for an A = ln|T| that is piecewise linear in u. A is
/// `a` in the band. Below it is `a[0]`·(ω/ω₁)², since T(0) = 1 and ln|T| is even in ω. Above it is a damped oscillator's of
/// static gain 1, |T|⁻² = 1 + βω² + γω⁴, that continues the upper part of the band.
///
/// Source: Bode, *Network Analysis and Feedback Amplifier Design* (1945), ch. 14.
pub(super) fn minimum_phase(omega: &[f64], a: &[f64]) -> Vec<f64> {
    let (Some((first, a_first)), Some((last, a_last))) = (pair(omega, a, 0), pair(omega, a, omega.len() - 1))
    else {
        return Vec::new();
    };
    let below = (1..=STEPS).rev().map(|k| {
        let ratio = STEP.powi(-k);
        (first * ratio, a_first * ratio * ratio)
    });
    let [free, square, fourth] = oscillator(omega, a);
    let above = (1..=STEPS).map(|k| {
        let omega = last * STEP.powi(k);
        let ratio = (omega / last).powi(2);
        (omega, a_last - 0.5 * (free + square * ratio + fourth * ratio * ratio).ln())
    });
    let points: Vec<(f64, f64)> = below
        .chain(omega.iter().copied().zip(a.iter().copied()))
        .chain(above)
        .map(|(omega, a)| (omega.ln(), a))
        .collect();
    let phase = |at: f64| {
        let share = |pair: &[(f64, f64)]| {
            let [(u0, a0), (u1, a1)] = [pair[0], pair[1]];
            (a1 - a0) / (u1 - u0) * (weight(u1 - at) - weight(u0 - at))
        };
        // a mass's slope goes on for ever
        let rest = -2.0 * (0.25 * PI * PI - points.last().map_or(0.0, |p| weight(p.0 - at)));
        (points.windows(2).map(share).sum::<f64>() + rest) / PI
    };
    omega.iter().map(|omega| phase(omega.ln())).collect()
}

/// 1, β and γ of |T|⁻² = 1 + βx + γx², x = (ω/ω_last)², over the upper part of the band, all divided by the sum: at x = 1 it
/// continues the band's last gain. Least squares of |T|²(1 + βx + γx²) − 1 with γ > 0.
fn oscillator(omega: &[f64], a: &[f64]) -> [f64; 3] {
    let last = omega[omega.len() - 1];
    let [mut xx, mut xy, mut yy, mut xr, mut yr] = [0.0; 5];
    for (omega, a) in omega.iter().zip(a).filter(|(o, _)| **o > UPPER * last) {
        let (gain, ratio) = ((2.0 * a).exp(), (omega / last).powi(2));
        let (x, y, r) = (gain * ratio, gain * ratio * ratio, 1.0 - gain);
        (xx, xy, yy, xr, yr) = (xx + x * x, xy + x * y, yy + y * y, xr + x * r, yr + y * r);
    }
    let det = xx * yy - xy * xy;
    let (beta, gamma) = ((xr * yy - yr * xy) / det, (yr * xx - xr * xy) / det);
    let sum = 1.0 + beta + gamma;
    // an oscillator that is none: a mass alone
    if !(gamma > 0.0 && beta > -2.0 * gamma.sqrt() && sum > 0.0 && beta + 2.0 * gamma > 0.0) {
        return [0.0, 0.0, 1.0];
    }
    [1.0 / sum, beta / sum, gamma / sum]
}

fn pair(omega: &[f64], a: &[f64], i: usize) -> Option<(f64, f64)> {
    Some((*omega.get(i)?, *a.get(i)?))
}

/// ∫₀^x ln coth(|t|/2) dt.
fn weight(x: f64) -> f64 {
    let t = x.abs();
    let value = if t < 0.3 {
        let square = t * t;
        if t == 0.0 {
            0.0
        } else {
            t * (1.0 - (0.5 * t).ln() + square / 36.0 - 7.0 * square * square / 7200.0)
        }
    } else {
        // 2 Σ e^{−(2k+1)t}/(2k+1)², to 1e-9 from .3 on
        let terms = (0..36).map(|k| {
            let odd = f64::from(2 * k + 1);
            (-odd * t).exp() / (odd * odd)
        });
        0.25 * PI * PI - 2.0 * terms.sum::<f64>()
    };
    value.copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::C64;
    use crate::units::rad_per_s;

    #[test]
    fn the_weight_is_the_integral() {
        for to in [0.01, 0.29, 0.31, 1.0, 4.0, 30.0] {
            let n = 200_000;
            // t = to·q³ takes the singularity at 0 away
            let sum: f64 = (0..n)
                .map(|i| {
                    let q = (f64::from(i) + 0.5) / f64::from(n);
                    let t = to * q.powi(3);
                    -(0.5 * t).tanh().ln() * 3.0 * to * q * q / f64::from(n)
                })
                .sum();
            assert!(
                (weight(to) - sum).abs() < 1e-7 && weight(-to) == -weight(to),
                "{to}: {} {sum}",
                weight(to)
            );
        }
    }

    /// A quarter car's wheel: known phase, band .4–20 Hz.
    #[test]
    fn a_wheel_has_the_phase_of_its_gain() {
        let (ms, mu, k, c, kt, ct) = (290.0, 40.0, 20e3, 1500.0, 190e3, 150.0);
        let response = |f: f64| {
            let s = C64::new(0.0, rad_per_s(f));
            let (spring, tire) = (s * c + k, s * ct + kt);
            let body = s * s * ms + spring;
            tire * body / ((s * s * mu + spring + tire) * body - spring * spring)
        };
        let f: Vec<f64> = (2..=98).map(|k| 0.2 * f64::from(k)).collect();
        let omega: Vec<f64> = f.iter().map(|f| rad_per_s(*f)).collect();
        let a: Vec<f64> = f.iter().map(|f| response(*f).norm().ln()).collect();
        let found = minimum_phase(&omega, &a);
        let worst = (0..f.len()).map(|i| (found[i] - response(f[i]).arg()).abs()).fold(0.0, f64::max);
        // .084 at 19.6 Hz: what is above the band is guessed. A mass alone there gives .14
        assert!(worst < 0.1, "{worst}");
        // .043 in the lower half of the band
        let half = f.len() / 2;
        let worst = (0..half).map(|i| (found[i] - response(f[i]).arg()).abs()).fold(0.0, f64::max);
        assert!(worst < 0.06, "{worst}");
    }
}
