//! The H∞ norm: local peaks first, then a Hamiltonian's eigenvalues show that nothing stands above them.

use super::peak::{Gain, Hint, hints, largest_singular_value};
use crate::linalg::{C64, CMat, LinalgError, Mat, RealSchur, small, solve};
use crate::lti::connect::blocks;
use crate::lti::state_space::complex;
use crate::lti::{Continuous, Discrete, LtiError, Responder, StateSpace, Time};

/// Nothing stands above the norm reported by more than this share.
const ACCURACY: f64 = 1e-7;
/// An eigenvalue this near to the axis, as a share of its size, may be on it but for rounding: G is looked at there.
const NEAR_AXIS: f64 = 1e-2;
/// Peaks that reach this share of the highest value seen are climbed before any Hamiltonian.
const CLIMBED: f64 = 0.85;
/// Peaks climbed at most, the highest first.
const MOST_CLIMBED: usize = 6;
/// Levels, at most: each one is above a peak that had not been seen.
const MOST_LEVELS: usize = 50;
/// The Schur form's rounding moves a lightly damped pole: where the plain solve differs by more than this share, the peak
/// is climbed once more with it.
const MOVED: f64 = 1e-10;
/// Up to this order a solve in slices is faster than faer's.
const SMALL: usize = 32;

/// The largest gain over frequency, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HinfNorm {
    /// sup σ_max(G(iω)), attained: within 1e-7 of the supremum.
    pub norm: f64,
    /// Where, rad/s; infinite where it is the feedthrough's.
    pub omega_rad_s: f64,
    /// Evaluations of G.
    pub evaluations: usize,
    /// Eigenvalue problems of order 2n.
    pub eigenvalue_problems: usize,
}

impl StateSpace<Continuous> {
    /// ‖G‖∞ = sup σ_max(G(iω)), the largest gain of sustained sines.
    ///
    /// σ_max is looked at for ω = 0, ∞ and at every pole's frequency and the highest peaks are climbed; then G has a
    /// singular value γ at ω exactly where iω is an eigenvalue of the Hamiltonian (R = γ²I − DᵀD)
    ///
    /// H = [A + B R⁻¹DᵀC, B R⁻¹Bᵀ; −Cᵀ(I + D R⁻¹Dᵀ)C, −(A + B R⁻¹DᵀC)ᵀ].
    ///
    /// With γ just above the highest peak, G is evaluated at all eigenvalues near the axis and between them. What stands
    /// higher is climbed, and the test repeated, until nothing does. Eigenvalues that rounding moved off the axis are
    /// looked at too, and the value reported is G's own at the frequency reported, from a plain solve: rounding can't make
    /// the norm too large, and only a peak which no pole's frequency and no eigenvalue shows could make it too small.
    ///
    /// # Errors
    /// A system that is not stable; gains that overflow.
    ///
    /// Source: Boyd and Balakrishnan, Syst. Control Lett. 15 (1990) 1–7; Bruinsma and Steinbuch, ibid. 14 (1990) 287–293.
    pub fn hinf_norm(&self) -> Result<HinfNorm, LtiError> {
        let g = self.balanced_scales()?.0;
        let (responder, hints) = prepared(&g)?;
        let last = (f64::INFINITY, largest_singular_value(&complex(g.d())));
        norm_from(&g, &responder, &hints, last, |level| crossings(&g, level))
    }
}

impl StateSpace<Discrete> {
    /// ‖G‖∞ = sup σ_max(G(e^{iω dt})), looked at on the circle itself; the levels are those of the continuous system that
    /// the bilinear map makes of it, as [`StateSpace::<Continuous>::hinf_norm`] has them.
    ///
    /// # Errors
    /// A system that is not stable; gains that overflow.
    pub fn hinf_norm(&self) -> Result<HinfNorm, LtiError> {
        let g = self.balanced_scales()?.0;
        let (responder, hints) = prepared(&g)?;
        let dt_s = self.time().dt_s;
        let end = std::f64::consts::PI / dt_s;
        let last = responder.at(C64::new(-1.0, 0.0)).map_or(f64::INFINITY, |d| largest_singular_value(&d));
        let mut image: Option<StateSpace<Continuous>> = None;
        norm_from(&g, &responder, &hints, (end, last), |level| {
            let continuous = match image.take() {
                Some(known) => known,
                None => g.inverse_bilinear(1.0)?.balanced_scales()?.0,
            };
            // s = i tan(θ/2)
            let found = crossings(&continuous, level)?.into_iter().map(|w| 2.0 * w.atan() / dt_s).collect();
            image = Some(continuous);
            Ok(found)
        })
    }
}

/// A stable system made ready, and the frequencies of its poles.
fn prepared<T: Time>(g: &StateSpace<T>) -> Result<(Responder<T>, Vec<Hint>), LtiError> {
    let schur = RealSchur::new(g.a())?;
    let poles = schur.eigenvalues();
    g.check_poles("the H∞ norm", &poles)?;
    Ok((g.responder_on(schur), hints(g.time(), &poles)))
}

/// The norm of a stable system, looked at first at its hints and at the end of the axis, whose value is known.
fn norm_from<T: Time>(
    g: &StateSpace<T>,
    responder: &Responder<T>,
    hints: &[Hint],
    last: (f64, f64),
    mut crossings: impl FnMut(f64) -> Result<Vec<f64>, LtiError>,
) -> Result<HinfNorm, LtiError> {
    let mut gain = Gain::new(|w| Ok(largest_singular_value(&responder.at_frequency(w)?)));
    if g.order() == 0 || g.inputs() == 0 || g.outputs() == 0 {
        let norm = largest_singular_value(&complex(g.d()));
        finite((0.0, norm))?;
        return Ok(HinfNorm { norm, omega_rad_s: 0.0, evaluations: 0, eigenvalue_problems: 0 });
    }
    let mut best = last;
    let mut seen = vec![(Hint { omega: 0.0, width: 0.0 }, gain.at(0.0))];
    seen.extend(hints.iter().map(|h| (*h, gain.at(h.omega))));
    seen.iter().for_each(|(h, value)| raise(&mut best, (h.omega, *value)));
    climb_highest(&mut gain, &seen, last.0, &mut best);
    let mut eigenvalue_problems = 0;
    while best.1 > 0.0 && best.1.is_finite() && eigenvalue_problems < MOST_LEVELS {
        let level = best.1 * (1.0 + ACCURACY);
        let crossings = crossings(level)?;
        eigenvalue_problems += 1;
        let mut higher: Option<(f64, f64)> = None;
        for (k, omega) in crossings.iter().enumerate() {
            let next = crossings.get(k + 1).map_or(2.0 * omega, |n| 0.5 * (omega + n));
            let before = if k == 0 { Some(0.5 * omega) } else { None };
            for w in [Some(*omega), Some(next), before].into_iter().flatten() {
                let w = w.min(last.0);
                let value = gain.at(w);
                if value > level && higher.is_none_or(|h| value > h.1) {
                    higher = Some((w, value));
                }
            }
        }
        let Some(found) = higher else { break };
        let inside = |w: &&f64| **w < found.0 * (1.0 - 1e-12);
        let low = crossings.iter().rev().find(inside).copied().unwrap_or(0.5 * found.0);
        let high = crossings.iter().find(|w| **w > found.0 * (1.0 + 1e-12)).copied().unwrap_or(2.0 * found.0);
        raise(&mut best, found);
        raise(&mut best, gain.climb(low, found, high.min(last.0), 0.0));
    }
    let plain = |w: f64| plain_solve(g, g.time().point(w));
    let (best, again) = confirmed(best, plain, hints, last.0);
    finite(best)?;
    let evaluations = gain.evaluations + again;
    Ok(HinfNorm { norm: best.1, omega_rad_s: best.0, evaluations, eigenvalue_problems })
}

/// G(s) without a Schur form.
fn plain_solve<T: Time>(g: &StateSpace<T>, s: C64) -> Result<CMat, LtiError> {
    let (n, m) = (g.order(), g.inputs());
    if n > SMALL {
        return g.at(s);
    }
    let mut resolvent = vec![C64::new(0.0, 0.0); n * n];
    for (k, z) in resolvent.iter_mut().enumerate() {
        let (i, j) = (k / n, k % n);
        *z = C64::new(-g.a()[(i, j)], 0.0) + if i == j { s } else { C64::new(0.0, 0.0) };
    }
    let mut x: Vec<C64> = (0..n * m).map(|k| C64::new(g.b()[(k / m, k % m)], 0.0)).collect();
    let mut pivots = vec![0; n];
    if !small::lu(&mut resolvent, &mut pivots) {
        return g.at(s);
    }
    small::lu_solve(&resolvent, &pivots, &mut x, m);
    let entry =
        |i: usize, j: usize| (0..n).map(|k| x[k * m + j] * g.c()[(i, k)]).sum::<C64>() + g.d()[(i, j)];
    let found = CMat::from_fn(g.outputs(), m, entry);
    let finite = |z: C64| z.re.is_finite() && z.im.is_finite();
    let all = (0..m).all(|j| (0..g.outputs()).all(|i| finite(found[(i, j)])));
    if all { Ok(found) } else { g.at(s) }
}

/// The highest point by the plain solve of sI − A, and how often that was made.
fn confirmed(
    best: (f64, f64),
    plain: impl Fn(f64) -> Result<CMat, LtiError>,
    hints: &[Hint],
    end: f64,
) -> ((f64, f64), usize) {
    if !(best.0.is_finite() && best.1 > 0.0) {
        return (best, 0);
    }
    let mut gain = Gain::new(|w| Ok(largest_singular_value(&plain(w)?)));
    let here = (best.0, gain.at(best.0));
    if (here.1 - best.1).abs() <= MOVED * best.1 || best.0 == 0.0 || best.0 == end {
        return (here, gain.evaluations);
    }
    let width = hints.iter().map(|h| (h.omega - best.0).hypot(h.width)).fold(best.0, f64::min);
    let top = gain.climb(best.0 - 0.9 * width, here, (best.0 + 0.9 * width).min(end), 0.1 * width);
    (top, gain.evaluations)
}

/// Refuses a gain that is not a number.
fn finite((omega, norm): (f64, f64)) -> Result<(), LtiError> {
    if norm.is_finite() {
        return Ok(());
    }
    let (what, why) = ("the H∞ norm", "the gain overflows, or a pole stands on the axis, at rad/s");
    Err(LinalgError::Singular { what, why, value: omega }.into())
}

fn raise(best: &mut (f64, f64), found: (f64, f64)) {
    if found.1 > best.1 {
        *best = found;
    }
}

/// Climbs the highest of the values seen (the first at 0) that stand above their neighbours.
fn climb_highest<F: Fn(f64) -> Result<f64, LtiError>>(
    gain: &mut Gain<F>,
    seen: &[(Hint, f64)],
    end: f64,
    best: &mut (f64, f64),
) {
    let value = |k: usize| seen[k].1;
    let mut peaks: Vec<usize> = (1..seen.len())
        .filter(|k| value(*k) >= value(k - 1) && (k + 1 == seen.len() || value(*k) >= value(k + 1)))
        .collect();
    peaks.sort_by(|i, j| value(*j).total_cmp(&value(*i)));
    for k in peaks.into_iter().take(MOST_CLIMBED) {
        if value(k) < CLIMBED * best.1 {
            break;
        }
        let Hint { omega, width } = seen[k].0;
        let high = seen.get(k + 1).map_or(2.0 * omega, |s| s.0.omega).min(end);
        raise(best, gain.climb(seen[k - 1].0.omega, (omega, value(k)), high, width));
    }
}

/// Frequencies of the Hamiltonian's eigenvalues on or near the axis, ascending.
fn crossings(g: &StateSpace<Continuous>, gamma: f64) -> Result<Vec<f64>, LtiError> {
    let h = hamiltonian(g, gamma)?;
    let floor = f64::EPSILON * h.nrows() as f64 * h.norm_l2();
    let mut omegas: Vec<f64> = RealSchur::only_eigenvalues(&h)?
        .iter()
        .filter(|z: &&C64| z.im >= 0.0 && z.re.abs() <= NEAR_AXIS * z.norm() + floor)
        .map(|z| z.norm())
        .filter(|w| *w > 0.0)
        .collect();
    omegas.sort_by(f64::total_cmp);
    omegas.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * *b);
    Ok(omegas)
}

/// H at a level above σ_max(D), its off-diagonal blocks of like size: G/γ at the level 1, B and C of equal norm.
fn hamiltonian(g: &StateSpace<Continuous>, gamma: f64) -> Result<Mat, LtiError> {
    let (b_norm, c_norm, root) = (g.b().norm_max().sqrt(), g.c().norm_max().sqrt(), gamma.sqrt());
    let even = |up: f64, down: f64| if up > 0.0 && down > 0.0 { up / down } else { 1.0 };
    let b = g.b() * faer::Scale(even(c_norm, b_norm) / root);
    let c = g.c() * faer::Scale(even(b_norm, c_norm) / root);
    let d = g.d() * faer::Scale(1.0 / gamma);
    let mut a11 = g.a().clone();
    let (mut a12, mut a21) = (&b * b.transpose(), c.transpose() * &c);
    if d.norm_max() > 0.0 {
        let r = Mat::identity(d.ncols(), d.ncols()) - d.transpose() * &d;
        let (over_bt, over_dtc) = (solve(&r, &b.transpose().to_owned())?, solve(&r, &(d.transpose() * &c))?);
        a11 += &b * &over_dtc;
        a12 = &b * over_bt;
        a21 += c.transpose() * (&d * over_dtc);
    }
    let a22 = -a11.transpose().to_owned();
    Ok(blocks(&[&[&a11, &a12], &[&-a21, &a22]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oscillator(zeta: f64, omega: f64) -> StateSpace<Continuous> {
        let a = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-omega * omega, -2.0 * zeta * omega]][i][j]);
        let b = Mat::from_fn(2, 1, |i, _| i as f64);
        let c = Mat::from_fn(1, 2, |_, j| 1.0 - j as f64);
        StateSpace::continuous(a, b, c, Mat::zeros(1, 1)).unwrap()
    }

    /// Largest gain of 1/(s² + 2ζωs + ω²).
    fn peak(zeta: f64, omega: f64) -> f64 {
        1.0 / (2.0 * zeta * (1.0 - zeta * zeta).sqrt() * omega * omega)
    }

    #[test]
    fn an_oscillators_peak_is_found_however_sharp() {
        for zeta in [0.5, 0.1, 1e-2, 1e-4, 1e-7] {
            for omega in [1e-3, 1.0, 70.0, 1e5] {
                let found = oscillator(zeta, omega).hinf_norm().unwrap();
                assert!((found.norm / peak(zeta, omega) - 1.0).abs() < 1e-9, "{zeta} {omega}: {found:?}");
                let at = omega * (1.0 - 2.0 * zeta * zeta).sqrt();
                assert!((found.omega_rad_s / at - 1.0).abs() < 1e-6, "{found:?}");
            }
        }
    }

    #[test]
    fn the_ends_of_the_axis_count() {
        let one = |x: f64| Mat::from_fn(1, 1, |_, _| x);
        let lag = StateSpace::continuous(one(-2.0), one(1.0), one(3.0), one(0.0)).unwrap();
        let found = lag.hinf_norm().unwrap();
        assert_eq!((found.norm, found.omega_rad_s), (1.5, 0.0));
        // 1 − 1.5/(s + 2): at most 1, at infinity
        let high = StateSpace::continuous(one(-2.0), one(1.0), one(-1.5), one(1.0)).unwrap();
        let found = high.hinf_norm().unwrap();
        assert_eq!((found.norm, found.omega_rad_s), (1.0, f64::INFINITY));
        // all-pass: everywhere
        let pass = StateSpace::continuous(one(-2.0), one(2.0), one(-2.0), one(1.0)).unwrap();
        assert!((pass.hinf_norm().unwrap().norm - 1.0).abs() < 1e-14);
        let nothing = StateSpace::continuous(one(-2.0), one(0.0), one(1.0), one(0.0)).unwrap();
        assert_eq!(nothing.hinf_norm().unwrap().norm, 0.0);
        assert!(matches!(oscillator(-0.1, 1.0).hinf_norm(), Err(LtiError::NotStable { .. })));
    }

    #[test]
    fn a_dense_grid_finds_nothing_higher() {
        use rand::{Rng, SeedableRng};
        for seed in 0..60 {
            let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let (n, m, p) = (rng.random_range(1..9), rng.random_range(1..4), rng.random_range(1..4));
            let shift = rng.random_range(0.3..2.0);
            let mut any = |r: usize, c: usize| Mat::from_fn(r, c, |_, _| rng.random_range(-1.0..1.0));
            let mut a = any(n, n);
            let worst = crate::linalg::eigen(&a).unwrap().0.iter().map(|z| z.re).fold(f64::MIN, f64::max);
            (0..n).for_each(|i| a[(i, i)] -= worst + 0.05 * shift);
            let d = any(p, m) * faer::Scale(if seed % 3 == 0 { 0.0 } else { 1.0 });
            let g = StateSpace::continuous(a, any(n, m), any(p, n), d).unwrap();
            let found = g.hinf_norm().unwrap();
            let r = g.responder().unwrap();
            let on_grid = (0..40_000)
                .map(|k| 10f64.powf(-3.0 + 6.0 * f64::from(k) / 40_000.0))
                .map(|w| super::super::peak::largest_singular_value(&r.at_frequency(w).unwrap()))
                .fold(0.0, f64::max);
            assert!(on_grid <= found.norm * (1.0 + ACCURACY), "{seed}: {on_grid} above {found:?}");
            assert!(
                on_grid >= found.norm * 0.999 || !(1e-3..1e3).contains(&found.omega_rad_s),
                "{seed}: {on_grid} {found:?}"
            );
            let dual = g.transposed().hinf_norm().unwrap();
            assert!((dual.norm / found.norm - 1.0).abs() < 1e-7);
            let disk = g.bilinear(1.7, 0.1).unwrap().hinf_norm().unwrap();
            assert!((disk.norm / found.norm - 1.0).abs() < 1e-7, "{seed}: {disk:?} {found:?}");
        }
    }

    #[test]
    fn without_any_hint_the_hamiltonian_finds_the_peak() {
        for zeta in [0.5, 0.1, 1e-2, 1e-4] {
            for omega in [0.1, 1.0, 300.0] {
                let g = oscillator(zeta, omega);
                let last = (f64::INFINITY, 0.0);
                let responder = g.responder().unwrap();
                let found = norm_from(&g, &responder, &[], last, |level| crossings(&g, level)).unwrap();
                assert!((found.norm / peak(zeta, omega) - 1.0).abs() < 1e-9, "{zeta} {omega}: {found:?}");
                assert!(zeta > 0.6 || found.eigenvalue_problems > 1);
            }
        }
    }

    #[test]
    fn a_crossing_is_where_the_gain_is_the_level() {
        let g = oscillator(0.1, 3.0);
        let r = g.responder().unwrap();
        let omegas = crossings(&g, 0.4).unwrap();
        assert_eq!(omegas.len(), 2);
        for w in omegas {
            assert!((r.at_frequency(w).unwrap()[(0, 0)].norm() / 0.4 - 1.0).abs() < 1e-12);
        }
    }

    /// The highest gain on a grid about each pole, by the plain solve, refined about its best point: a lower bound.
    fn on_refined_grid(g: &StateSpace<Continuous>) -> f64 {
        let value = |w: f64| g.at(C64::new(0.0, w)).map_or(0.0, |m| largest_singular_value(&m));
        let mut omegas: Vec<f64> = (0..400).map(|k| 10f64.powf(-2.0 + 8.0 * f64::from(k) / 400.0)).collect();
        for p in g.poles().unwrap() {
            omegas.extend((-80..=80).map(|k| (p.norm() + p.re.abs() * (0.05 * f64::from(k)).sinh()).abs()));
        }
        omegas.sort_by(f64::total_cmp);
        omegas.dedup(); // a pair has one frequency
        let mut best = 0.0;
        for _ in 0..6 {
            let values: Vec<f64> = omegas.iter().map(|w| value(*w)).collect();
            let k = (0..values.len()).max_by(|i, j| values[*i].total_cmp(&values[*j])).unwrap();
            best = values[k].max(best);
            let (low, high) = (omegas[k.saturating_sub(1)], omegas[(k + 1).min(omegas.len() - 1)]);
            omegas = (0..=100).map(|i| low + (high - low) * f64::from(i) / 100.0).collect();
        }
        best
    }

    /// Three oscillators among fast poles, mixed by a triangular similarity, in states of other units.
    fn hidden(zeta: f64, units: f64, seed: u64) -> StateSpace<Continuous> {
        use rand::{Rng, SeedableRng};
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let fast = [-2.0, -900.0, -4e4, -3e5];
        let mut a = Mat::zeros(10, 10);
        for (k, w) in [0.7, 3.1, 40.0].into_iter().enumerate() {
            let i = 2 * k;
            (a[(i, i + 1)], a[(i + 1, i)], a[(i + 1, i + 1)]) = (w, -w, -2.0 * zeta * w);
        }
        (0..4).for_each(|k| a[(6 + k, 6 + k)] = fast[k]);
        let mut any = |r: usize, c: usize| Mat::from_fn(r, c, |_, _| rng.random_range(-1.0..1.0));
        let (mut b, mut c, f) = (any(10, 2), any(2, 10), any(10, 10));
        for j in 0..2 {
            (0..4).for_each(|i| b[(6 + i, j)] *= fast[i]);
            (0..6).for_each(|i| b[(i, j)] *= 30.0 * zeta);
        }
        for (i, j) in (0..10).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let f = 0.1 * f[(i, j)];
            (0..10).for_each(|k| a[(i, k)] += f * a[(j, k)]);
            (0..10).for_each(|k| a[(k, j)] -= f * a[(k, i)]);
            (0..2).for_each(|k| b[(i, k)] += f * b[(j, k)]);
            (0..2).for_each(|k| c[(k, j)] -= f * c[(k, i)]);
        }
        let scales: Vec<f64> = (0..10).map(|k| units.powf(f[(k, k)])).collect();
        StateSpace::continuous(a, b, c, Mat::zeros(2, 2)).unwrap().with_states_scaled(&scales).unwrap()
    }

    #[test]
    fn light_damping_hidden_among_fast_poles_is_found_in_any_units() {
        for seed in 0..6 {
            for zeta in [1e-2, 1e-4, 1e-5, 1e-6] {
                for units in [1.0, 1e6] {
                    let g = hidden(zeta, units, seed);
                    let (found, judge) = (g.hinf_norm().unwrap(), on_refined_grid(&g));
                    let difference = found.norm / judge - 1.0;
                    // rounding of A's entries moves Re p by about 1e-16·3e5, which is 1e-8 of it at the least damping
                    assert!(
                        difference.abs() < 1e-9 + 1e-14 / zeta,
                        "{seed} {zeta} {units}: {difference:e} {found:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn poles_near_both_ends_of_the_circle_are_seen() {
        for eps in [1e-1, 1e-3, 1e-5, 1e-7, 1e-9] {
            // ε/(z − 1 + ε) + 3ε/(z + 1 − ε), mixed: at z = −1 it is −3 − ε/(2 − ε)
            let mut a = Mat::from_fn(2, 2, |i, j| if i == j { [1.0 - eps, eps - 1.0][i] } else { 0.0 });
            a[(0, 1)] = 0.5 * (a[(1, 1)] - a[(0, 0)]);
            let b = Mat::from_fn(2, 1, |i, _| [eps + 0.5 * 3.0 * eps, 3.0 * eps][i]);
            let c = Mat::from_fn(1, 2, |_, j| [1.0, 0.5][j]);
            let g = StateSpace::discrete(a, b, c, Mat::zeros(1, 1), 0.01).unwrap();
            let found = g.hinf_norm().unwrap();
            let expected = 3.0 + eps / (2.0 - eps);
            assert!((found.norm / expected - 1.0).abs() < 1e-12 + 1e-15 / eps, "{eps}: {found:?}");
            assert!((found.omega_rad_s * 0.01 / std::f64::consts::PI - 1.0).abs() < 1e-9, "{eps}: {found:?}");
        }
    }
}
