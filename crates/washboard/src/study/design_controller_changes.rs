//! A controller with one of its numbers changed by a share: gains, poles and residues, which no similarity of states changes, and the
//! entries of its matrices as they are written.

use super::design_robustness::PerturbedKind;
use crate::linalg::{C64, CMat, Mat, eigen, solve_complex};
use crate::lti::{Continuous, LtiError, StateSpace};

/// Entries of matrices are changed one by one up to so many; of larger controllers gains, poles and residues alone.
pub(super) const MOST_ENTRIES: usize = 100;
/// With a larger norm of a pole's projector v wᵀ the pole is a repeated one, and says nothing by itself.
const MOST_PROJECTOR: f64 = 1e6;

/// One number, and the controller with it times 1 + δ for each of two δ.
pub(super) struct ControllerChange {
    pub kind: PerturbedKind,
    pub what: String,
    pub changed: [StateSpace<Continuous>; 2],
}

/// Which changes there are, and what was left out.
pub(super) struct ControllerChanges {
    pub changes: Vec<ControllerChange>,
    /// Entries that were not changed one by one.
    pub entries_left_out: usize,
    /// Poles so near to each other that none has a residue of its own.
    pub repeated_poles: usize,
}

/// Every change of K = C(sI − A)⁻¹B + D by a share of ±δ.
///
/// A pole λ with right and left eigenvectors v, w (wᵀv = 1) moves to (1 ± δ)λ by A ± δ λ v wᵀ, its conjugate with it, residues staying as
/// they are; its residue C v wᵀB grows by (I ± δ v wᵀ)B.
///
/// # Errors
/// An eigenvalue iteration that does not converge.
pub(super) fn controller_changes(
    k: &StateSpace<Continuous>,
    names: (&[String], &[String]),
    delta: f64,
) -> Result<ControllerChanges, LtiError> {
    let (inputs, outputs) = names;
    let (n, m, p) = (k.order(), k.inputs(), k.outputs());
    let mut changes = Vec::new();
    let mut add = |kind, what: String, make: &dyn Fn(f64) -> Result<StateSpace<Continuous>, LtiError>| {
        let changed = [make(-delta)?, make(delta)?];
        changes.push(ControllerChange { kind, what, changed });
        Ok::<(), LtiError>(())
    };
    let gain = |of: &dyn Fn(usize) -> f64, size: usize| {
        Mat::from_fn(size, size, |i, j| if i == j { of(i) } else { 0.0 })
    };
    add(PerturbedKind::Gain, "overall gain".into(), &|s| k.times(&gain(&|_| 1.0 + s, m)))?;
    if m > 1 {
        for (j, name) in inputs.iter().enumerate() {
            let one = |s: f64| gain(&|i| 1.0 + if i == j { s } else { 0.0 }, m);
            add(PerturbedKind::Sensor, name.clone(), &|s| k.times(&one(s)))?;
        }
    }
    if p > 1 {
        for (j, name) in outputs.iter().enumerate() {
            let one = |s: f64| gain(&|i| 1.0 + if i == j { s } else { 0.0 }, p);
            add(PerturbedKind::Actuator, name.clone(), &|s| k.series(&StateSpace::continuous_gain(one(s))?))?;
        }
    }
    let mut repeated_poles = 0;
    for pole in poles(k)? {
        let Some(Pole { at, projector, moved }) = pole else {
            repeated_poles += 1;
            continue;
        };
        let what = if at.im == 0.0 {
            format!("{} 1/s", super::design_words::short(at.re))
        } else {
            format!(
                "{} ± {}i 1/s",
                super::design_words::short(at.re),
                super::design_words::short(at.im.abs())
            )
        };
        let with = |a: Mat, b: Mat| StateSpace::continuous(a, b, k.c().clone(), k.d().clone());
        add(PerturbedKind::Pole, what.clone(), &|s| with(k.a() + &moved * faer::Scale(s), k.b().clone()))?;
        add(PerturbedKind::Residue, what, &|s| {
            with(k.a().clone(), k.b() + &projector * k.b() * faer::Scale(s))
        })?;
    }
    let matrices = [("a", k.a()), ("b", k.b()), ("c", k.c()), ("d", k.d())];
    let entries: Vec<(usize, usize, usize)> = matrices
        .iter()
        .enumerate()
        .flat_map(|(which, (_, x))| {
            (0..x.nrows()).flat_map(move |i| (0..x.ncols()).map(move |j| (which, i, j)))
        })
        .filter(|(which, i, j)| matrices[*which].1[(*i, *j)] != 0.0)
        .collect();
    // the one entry of a gain is its overall gain
    let alone = n == 0 && m * p == 1;
    let few = entries.len() <= MOST_ENTRIES && !alone;
    for (which, i, j) in entries.iter().copied().filter(|_| few) {
        let what = format!("{}[{}, {}]", matrices[which].0, i + 1, j + 1);
        add(PerturbedKind::Entry, what, &|s| {
            let one = |at: usize| {
                let x = matrices[at].1;
                let times = |r, c| if (at, r, c) == (which, i, j) { 1.0 + s } else { 1.0 };
                Mat::from_fn(x.nrows(), x.ncols(), |r, c| times(r, c) * x[(r, c)])
            };
            StateSpace::continuous(one(0), one(1), one(2), one(3))
        })?;
    }
    let entries_left_out = if few || alone { 0 } else { entries.len() };
    Ok(ControllerChanges { changes, entries_left_out, repeated_poles })
}

/// A pole with Im ≥ 0: real parts of v wᵀ and λ v wᵀ, twice those of a pair.
struct Pole {
    at: C64,
    projector: Mat,
    moved: Mat,
}

/// Poles with Im ≥ 0; none for one of several that are equal.
fn poles(k: &StateSpace<Continuous>) -> Result<Vec<Option<Pole>>, LtiError> {
    let n = k.order();
    if n == 0 {
        return Ok(Vec::new());
    }
    let (values, v) = eigen(k.a())?;
    let one = |i: usize, j: usize| C64::new(f64::from(u8::from(i == j)), 0.0);
    // rows of V⁻¹ are the left eigenvectors
    let w = match solve_complex(&v, &CMat::from_fn(n, n, one)) {
        Ok(w) => w,
        Err(_) => return Ok(values.iter().filter(|l| l.im >= 0.0).map(|_| None).collect()),
    };
    let upper = (0..n).filter(|l| values[*l].im >= 0.0);
    let pole = |l: usize| {
        let at = values[l];
        let twice = if at.im == 0.0 { 1.0 } else { 2.0 };
        let real = |factor: C64| Mat::from_fn(n, n, |i, j| twice * (factor * v[(i, l)] * w[(l, j)]).re);
        let projector = real(C64::new(1.0, 0.0));
        let size = projector.norm_l2();
        (size <= MOST_PROJECTOR).then(|| Pole { at, projector, moved: real(at) })
    };
    Ok(upper.map(pole).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controller() -> StateSpace<Continuous> {
        let a = Mat::from_fn(3, 3, |i, j| [[-3.0, 20.0, 1.0], [-20.0, -3.0, 2.0], [0.5, 0.0, -9.0]][i][j]);
        let b = Mat::from_fn(3, 2, |i, j| 1.0 + (i + 2 * j) as f64);
        let c = Mat::from_fn(1, 3, |_, j| 2.0 - j as f64);
        StateSpace::continuous(a, b, c, Mat::from_fn(1, 2, |_, j| j as f64)).unwrap()
    }

    fn sorted(k: &StateSpace<Continuous>) -> Vec<C64> {
        let mut poles = k.poles().unwrap();
        poles.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        poles
    }

    #[test]
    fn a_pole_moves_alone_and_a_residue_grows_alone() {
        let k = controller();
        let names = (vec!["y1".to_owned(), "y2".to_owned()], vec!["u".to_owned()]);
        let all = controller_changes(&k, (&names.0, &names.1), 0.05).unwrap();
        let of = |kind| all.changes.iter().filter(move |c| c.kind == kind).collect::<Vec<_>>();
        assert_eq!((of(PerturbedKind::Pole).len(), of(PerturbedKind::Residue).len()), (2, 2));
        let before = sorted(&k);
        for change in of(PerturbedKind::Pole) {
            for (s, changed) in [-0.05, 0.05].into_iter().zip(&change.changed) {
                let after = sorted(changed);
                let real = !change.what.contains('i');
                for (one, other) in before.iter().zip(&after) {
                    let own = (one.im == 0.0) == real;
                    let expected = if own { one * (1.0 + s) } else { *one };
                    assert!((other - expected).norm() < 1e-12, "{}: {other} {expected}", change.what);
                }
            }
        }
        // residues from the response next to a pole, where all but its own term is small
        let change = of(PerturbedKind::Residue)[0];
        let at =
            k.poles().unwrap().into_iter().find(|p| (p.im > 0.0) != change.what.starts_with("-9")).unwrap();
        let near = at + C64::new(1e-7, 0.0);
        let ratio = change.changed[1].at(near).unwrap()[(0, 0)] / k.at(near).unwrap()[(0, 0)];
        assert!((ratio - C64::new(1.05, 0.0)).norm() < 1e-6, "{ratio} at {at}");
    }

    #[test]
    fn a_gain_of_one_entry_is_changed_once() {
        let one = StateSpace::continuous_gain(Mat::from_fn(1, 1, |_, _| 7.0)).unwrap();
        let names = [vec!["y".to_owned()], vec!["u".to_owned()]];
        let all = controller_changes(&one, (&names[0], &names[1]), 0.05).unwrap();
        assert_eq!(all.changes.len(), 1);
        assert!((all.changes[0].changed[1].d()[(0, 0)] - 7.35).abs() < 1e-12);
        // one entry a sensor, and overall
        let two = StateSpace::continuous_gain(Mat::from_fn(1, 2, |_, j| 1.0 + j as f64)).unwrap();
        let names = [vec!["y1".to_owned(), "y2".to_owned()], vec!["u".to_owned()]];
        assert_eq!(controller_changes(&two, (&names[0], &names[1]), 0.05).unwrap().changes.len(), 5);
    }
}
