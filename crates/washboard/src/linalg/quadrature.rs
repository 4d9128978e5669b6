//! Adaptive quadrature of several functions at once, by the 7- and 15-point Gauss–Kronrod pair.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Positive Kronrod nodes; the odd ones are Gauss's.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
];
const GAUSS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_7, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

/// A halved panel whose estimated error falls to no less than this share, while its values agree to [`SETTLED`], is rounding.
const VAIN: f64 = 0.3;
const SETTLED: f64 = 1e-5;
/// After so many of these no more is to be gained.
const MOST_VAIN: usize = 500;

/// What an integration gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Integral {
    /// ∫ f, one a function.
    pub values: Vec<f64>,
    /// Estimated absolute errors.
    pub errors: Vec<f64>,
    /// Number of evaluations of all functions.
    pub evaluations: usize,
    /// Whether every error is below the tolerance.
    pub converged: bool,
}

struct Panel {
    from: f64,
    to: f64,
    values: Vec<f64>,
    errors: Vec<f64>,
    worst: f64,
}

impl PartialEq for Panel {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Panel {}
impl PartialOrd for Panel {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Panel {
    fn cmp(&self, other: &Self) -> Ordering {
        self.worst.total_cmp(&other.worst)
    }
}

/// ∫ f over ascending `breakpoints` (at least two), each component to `relative` of ∫ |its panels| or to its entry of
/// `absolute` (empty: none), whichever is coarser.
///
/// `f(x, out)` writes all components at x. The panel with the worst component is halved until all are within the
/// tolerance, `max_evaluations` is reached, or halving shows nothing but rounding; the caller looks at `converged`.
pub fn integrate(
    mut f: impl FnMut(f64, &mut [f64]),
    components: usize,
    breakpoints: &[f64],
    relative: f64,
    absolute: &[f64],
    max_evaluations: usize,
) -> Integral {
    let mut scratch = vec![0.0; components];
    let mut evaluations = 0;
    let mut panel = |from: f64, to: f64| {
        let (mid, half) = (0.5 * (from + to), 0.5 * (to - from));
        let (mut k, mut g) = (vec![0.0; components], vec![0.0; components]);
        for i in 0..8 {
            for sign in [-1.0, 1.0] {
                if i == 7 && sign > 0.0 {
                    continue;
                }
                f(mid + sign * half * NODES[i], &mut scratch);
                for c in 0..components {
                    k[c] += KRONROD[i] * scratch[c];
                    if i % 2 == 1 {
                        g[c] += GAUSS[i / 2] * scratch[c];
                    }
                }
            }
        }
        let errors = k.iter().zip(&g).map(|(k, g)| ((k - g) * half).abs()).collect();
        Panel { from, to, values: k.iter().map(|v| v * half).collect(), errors, worst: 0.0 }
    };
    let mut panels: Vec<Panel> = Vec::new();
    for pair in breakpoints.windows(2) {
        panels.push(panel(pair[0], pair[1]));
        evaluations += 15;
    }
    let mut values = vec![0.0; components];
    let mut errors = vec![0.0; components];
    let mut scale = vec![0.0; components];
    for p in &panels {
        for c in 0..components {
            values[c] += p.values[c];
            scale[c] += p.values[c].abs();
            errors[c] += p.errors[c];
        }
    }
    let allowed =
        |scale: &[f64], c: usize| (relative * scale[c]).max(absolute.get(c).copied().unwrap_or(0.0));
    let worst = |p: &Panel, scale: &[f64]| {
        (0..components)
            .map(|c| if p.errors[c] > 0.0 { p.errors[c] / allowed(scale, c) } else { 0.0 })
            .fold(0.0, f64::max)
    };
    let within = |errors: &[f64], scale: &[f64]| (0..components).all(|c| errors[c] <= allowed(scale, c));
    let mut heap: BinaryHeap<Panel> = panels
        .into_iter()
        .map(|mut p| {
            p.worst = worst(&p, &scale);
            p
        })
        .collect();
    let mut vain = 0;
    while !within(&errors, &scale) && evaluations < max_evaluations && vain < MOST_VAIN {
        let Some(p) = heap.pop() else { break };
        let mid = 0.5 * (p.from + p.to);
        if !(mid > p.from && mid < p.to) {
            break;
        }
        for c in 0..components {
            values[c] -= p.values[c];
            scale[c] -= p.values[c].abs();
            errors[c] -= p.errors[c];
        }
        let halves = [panel(p.from, mid), panel(mid, p.to)];
        evaluations += 30;
        let worst_of = |c: &usize| if p.errors[*c] > 0.0 { p.errors[*c] / allowed(&scale, *c) } else { 0.0 };
        if let Some(c) = (0..components).max_by(|a, b| worst_of(a).total_cmp(&worst_of(b))) {
            let (value, error) =
                (halves[0].values[c] + halves[1].values[c], halves[0].errors[c] + halves[1].errors[c]);
            vain += usize::from(
                error > VAIN * p.errors[c] && (value - p.values[c]).abs() <= SETTLED * value.abs(),
            );
        }
        for half in &halves {
            for c in 0..components {
                values[c] += half.values[c];
                scale[c] += half.values[c].abs();
                errors[c] += half.errors[c];
            }
        }
        for mut half in halves {
            half.worst = worst(&half, &scale);
            heap.push(half);
        }
    }
    // sums again, free of the rounding of many additions and subtractions
    let mut sorted = heap.into_vec();
    sorted.sort_by(|a, b| a.from.total_cmp(&b.from));
    for c in 0..components {
        values[c] = sorted.iter().map(|p| p.values[c]).sum();
        scale[c] = sorted.iter().map(|p| p.values[c].abs()).sum();
        errors[c] = sorted.iter().map(|p| p.errors[c]).sum();
    }
    let converged = within(&errors, &scale);
    Integral { values, errors, evaluations, converged }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_22_are_exact() {
        let r = integrate(|x, out| out[0] = x.powi(22), 1, &[0.0, 1.0], 1.0, &[], 100);
        assert!((r.values[0] * 23.0 - 1.0).abs() < 1e-14);
        assert_eq!(r.evaluations, 15);
    }

    #[test]
    fn a_narrow_resonance_is_found_from_its_breakpoint() {
        let w = 1e-4; // ∫ w/((x−1)² + w²) over (−∞, ∞) is π
        let r = integrate(
            |x, out| out[0] = w / ((x - 1.0).powi(2) + w * w),
            1,
            &[-100.0, 1.0, 100.0],
            1e-10,
            &[],
            100_000,
        );
        let exact = (99.0f64 / w).atan() + (101.0f64 / w).atan();
        assert!(r.converged && (r.values[0] / exact - 1.0).abs() < 1e-10, "{r:?}");
    }

    #[test]
    fn rounding_ends_it() {
        let noise =
            |x: f64| (x.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / (1u64 << 24) as f64;
        let r = integrate(|x, out| out[0] = 1.0 + 1e-7 * noise(x), 1, &[0.0, 1.0], 1e-10, &[], 2_000_000);
        assert!(!r.converged && r.evaluations < 100_000 && (r.values[0] - 1.0).abs() < 1e-7, "{r:?}");
        // a kink and a peak are none
        let bent = |x: f64| (x - 0.3).abs() + 1e-6 / ((x - 0.7).powi(2) + 1e-12);
        let r = integrate(|x, out| out[0] = bent(x), 1, &[0.0, 1.0], 1e-12, &[], 2_000_000);
        let exact = 0.5 * (0.3f64.powi(2) + 0.7f64.powi(2)) + (0.3e6f64).atan() + (0.7e6f64).atan();
        assert!(r.converged && (r.values[0] / exact - 1.0).abs() < 1e-11, "{r:?} {exact}");
    }

    #[test]
    fn too_few_evaluations_are_said() {
        let r = integrate(|x, out| out[0] = (1e3 * x).sin().abs(), 1, &[0.0, 1.0], 1e-12, &[], 45);
        assert!(!r.converged);
    }
}
