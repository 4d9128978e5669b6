//! Transmission zeros of any system, and its poles and zeros that nothing drives or nothing sees.

use super::connect::{blocks, cut};
use super::{LtiError, StateSpace, Time};
use crate::linalg::{C64, CMat, LinalgError, Mat, RealSchur, solve};

/// A singular value below this many n ε of the system's size is zero.
const RANK_EPSILONS: f64 = 20.0;

/// A system matrix on its way to one with an invertible D.
struct Pencil {
    a: Mat,
    b: Mat,
    c: Mat,
    d: Mat,
}

impl<T: Time> StateSpace<T> {
    /// The transmission zeros: the finite s at which [A − sI, B; C, D] has less than its normal rank. Modes that are not
    /// controllable or not observable are zeros too.
    ///
    /// Rows and columns are compressed by orthogonal matrices until D is square and invertible; the zeros are then the
    /// eigenvalues of A − B D⁻¹C. Ranks are decided at 20 n ε of the size of the balanced system.
    ///
    /// # Errors
    /// An iteration that does not converge.
    ///
    /// Source: Emami-Naeini and Van Dooren, Automatica 18 (1982) 415–430.
    pub fn zeros(&self) -> Result<Vec<C64>, LtiError> {
        let g = self.balanced_scales()?.0;
        let size = [g.a(), g.b(), g.c(), g.d()].iter().map(|m| m.norm_l2()).fold(0.0, f64::max);
        let tolerance = RANK_EPSILONS * f64::EPSILON * (g.order() + g.inputs() + g.outputs()) as f64 * size;
        let start = Pencil { a: g.a().clone(), b: g.b().clone(), c: g.c().clone(), d: g.d().clone() };
        let wide = start.with_full_rows(tolerance)?;
        let square = wide.dual().with_full_rows(tolerance)?;
        if square.a.nrows() == 0 {
            return Ok(Vec::new());
        }
        let a = if square.d.nrows() == 0 {
            square.a
        } else {
            &square.a - &square.b * solve(&square.d, &square.c)?
        };
        Ok(RealSchur::new(&a)?.eigenvalues())
    }

    /// How far each mode is from being uncontrollable: σ_min([A − λI, B]) over ‖[A, B]‖ of the balanced system, by pole.
    /// Zero for a mode that no input moves.
    ///
    /// # Errors
    /// An iteration that does not converge.
    ///
    /// Source: Popov, Belevitch and Hautus's test; Eising, Syst. Control Lett. 4 (1984) 263–264.
    pub fn controllability(&self) -> Result<Vec<(C64, f64)>, LtiError> {
        let g = self.balanced_scales()?.0;
        let (n, m) = (g.order(), g.inputs());
        let size = g.a().norm_l2().hypot(g.b().norm_l2()).max(f64::MIN_POSITIVE);
        let measure = |pole: C64| -> Result<(C64, f64), LtiError> {
            let wide = CMat::from_fn(n, n + m, |i, j| {
                let real = if j < n { g.a()[(i, j)] } else { g.b()[(i, j - n)] };
                C64::new(real, 0.0) - if i == j { pole } else { C64::new(0.0, 0.0) }
            });
            let values = wide
                .singular_values()
                .map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: n })?;
            Ok((pole, values.last().copied().unwrap_or(0.0) / size))
        };
        self.poles()?.into_iter().map(measure).collect()
    }

    /// How far each mode is from being unobservable: [`StateSpace::controllability`] of the dual system.
    ///
    /// # Errors
    /// An iteration that does not converge.
    pub fn observability(&self) -> Result<Vec<(C64, f64)>, LtiError> {
        self.transposed().controllability()
    }

    /// The system without the modes that nothing drives or nothing sees, by orthogonal staircases.
    ///
    /// What a state adds to a step of a staircase is zero below `relative` of the size of the balanced system (1e-10
    /// where rounding of a few operations is all there is).
    ///
    /// # Errors
    /// A share outside 0 to 1; an iteration that does not converge.
    ///
    /// Source: Van Dooren, IEEE Trans. Automat. Control 26 (1981) 111–129.
    pub fn minimal(&self, relative: f64) -> Result<Self, LtiError> {
        if !(0.0..1.0).contains(&relative) {
            let (field, expected) = ("relative", "a share from 0 to 1");
            return Err(LtiError::Field { field, expected, found: relative });
        }
        let g = self.balanced_scales()?.0;
        Ok(g.controllable(relative)?.transposed().controllable(relative)?.transposed())
    }

    /// The controllable part.
    fn controllable(&self, relative: f64) -> Result<Self, LtiError> {
        let n = self.order();
        let tolerance = relative * self.a().norm_l2().max(self.b().norm_l2());
        let (mut a, mut c) = (self.a().clone(), self.c().clone());
        let mut b = self.b().clone();
        // [B A] row-compressed: the rank of what drives the rest from the part already reached
        let (mut reached, mut drive) = (0, b.clone());
        while reached < n {
            let (turn, rank) = row_compression(&drive, tolerance)?;
            if rank == 0 {
                break;
            }
            // the states not yet reached are turned so that the first `rank` of them are driven
            let mut whole = Mat::identity(n, n);
            whole.submatrix_mut(reached, reached, n - reached, n - reached).copy_from(&turn);
            a = whole.transpose() * &a * &whole;
            b = whole.transpose() * &b;
            c = &c * &whole;
            let (from, left) = (reached, n - reached - rank);
            reached += rank;
            drive = cut(&a, reached, from, left, rank);
        }
        let kept = reached;
        StateSpace::new(
            cut(&a, 0, 0, kept, kept),
            cut(&b, 0, 0, kept, self.inputs()),
            cut(&c, 0, 0, self.outputs(), kept),
            self.d().clone(),
            self.time(),
        )
    }
}

impl Pencil {
    fn dual(&self) -> Self {
        let t = |m: &Mat| m.transpose().to_owned();
        Pencil { a: t(&self.a), b: t(&self.c), c: t(&self.b), d: t(&self.d) }
    }

    /// The same zeros with a D of full row rank.
    fn with_full_rows(mut self, tolerance: f64) -> Result<Self, LtiError> {
        loop {
            let (n, m) = (self.a.nrows(), self.d.ncols());
            // outputs turned so that the last ones have no feedthrough
            let (turn, through) = row_compression(&self.d, tolerance)?;
            let (c, d) = (turn.transpose() * &self.c, turn.transpose() * &self.d);
            let blind = c.nrows() - through;
            if blind == 0 {
                return Ok(self);
            }
            let (c1, d1) = (cut(&c, 0, 0, through, n), cut(&d, 0, 0, through, m));
            let still = cut(&c, through, 0, blind, n);
            // states turned so that the first ones are what those outputs hold at zero
            let (states, held) = row_compression(&still.transpose().to_owned(), tolerance)?;
            if held == 0 {
                self.c = c1;
                self.d = d1;
                return Ok(self);
            }
            let a = states.transpose() * &self.a * &states;
            let (b, c1) = (states.transpose() * &self.b, c1 * &states);
            let free = n - held;
            self = Pencil {
                a: cut(&a, held, held, free, free),
                b: cut(&b, held, 0, free, m),
                c: blocks(&[&[&cut(&c1, 0, held, through, free)], &[&cut(&a, 0, held, held, free)]]),
                d: blocks(&[&[&d1], &[&cut(&b, 0, 0, held, m)]]),
            };
        }
    }
}

/// An orthogonal U with UᵀM = [full rank; 0], and the rank.
fn row_compression(m: &Mat, tolerance: f64) -> Result<(Mat, usize), LtiError> {
    let (rows, cols) = (m.nrows(), m.ncols());
    if rows == 0 || cols == 0 {
        return Ok((Mat::identity(rows, rows), 0));
    }
    let svd = m.svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: rows })?;
    let rank = svd.S().column_vector().iter().filter(|s| **s > tolerance).count();
    Ok((svd.U().to_owned(), rank))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lti::Continuous;

    fn any(r: usize, c: usize, s: f64) -> Mat {
        Mat::from_fn(r, c, |i, j| ((5 * i * i + 7 * j + i * j) as f64 + s).sin())
    }

    /// Smallest singular value of the system matrix at s, over its norm.
    fn rank_loss(g: &StateSpace<Continuous>, s: C64) -> f64 {
        let (n, m, p) = (g.order(), g.inputs(), g.outputs());
        let pencil = CMat::from_fn(n + p, n + m, |i, j| {
            let real = match (i < n, j < n) {
                (true, true) => g.a()[(i, j)],
                (true, false) => g.b()[(i, j - n)],
                (false, true) => g.c()[(i - n, j)],
                (false, false) => g.d()[(i - n, j - n)],
            };
            C64::new(real, 0.0) - if i == j && i < n { s } else { C64::new(0.0, 0.0) }
        });
        pencil.singular_values().unwrap().last().unwrap() / pencil.norm_l2()
    }

    #[test]
    fn zeros_are_where_the_system_matrix_loses_rank() {
        for (n, m, p, through) in [(5, 1, 1, 0.0), (5, 2, 2, 0.0), (6, 2, 2, 1.0), (7, 3, 3, 0.0)] {
            let g = StateSpace::continuous(
                any(n, n, 0.2),
                any(n, m, 1.0),
                any(p, n, 2.0),
                any(p, m, 3.0) * faer::Scale(through),
            )
            .unwrap();
            let zeros = g.zeros().unwrap();
            // n − m·(relative degree) for a system in general position
            assert_eq!(zeros.len(), if through == 0.0 { n - m } else { n }, "{n} {m} {p}");
            for z in zeros {
                assert!(rank_loss(&g, z) < 1e-13, "{z}: {:e}", rank_loss(&g, z));
            }
        }
        // more outputs than inputs: none in general
        let tall =
            StateSpace::continuous(any(5, 5, 0.2), any(5, 1, 1.0), any(2, 5, 2.0), Mat::zeros(2, 1)).unwrap();
        assert!(tall.zeros().unwrap().is_empty());
    }

    #[test]
    fn known_zeros_come_back_and_cancelled_modes_count() {
        // (s + 1)(s² + 4)/((s + 2)(s + 3)(s + 5)(s + 7)) in companion form
        let (den, num) = ([210.0, 247.0, 101.0, 17.0], [4.0, 4.0, 1.0, 1.0]);
        let a = Mat::from_fn(4, 4, |i, j| if i == 3 { -den[j] } else { f64::from(u8::from(j == i + 1)) });
        let b = Mat::from_fn(4, 1, |i, _| f64::from(u8::from(i == 3)));
        let c = Mat::from_fn(1, 4, |_, j| num[j]);
        let g = StateSpace::continuous(a, b, c, Mat::zeros(1, 1)).unwrap();
        let mut zeros = g.zeros().unwrap();
        zeros.sort_by(|x, y| (x.im, x.re).partial_cmp(&(y.im, y.re)).unwrap());
        for (z, known) in zeros.iter().zip([(0.0, -2.0), (-1.0, 0.0), (0.0, 2.0)]) {
            assert!((z - C64::new(known.0, known.1)).norm() < 1e-12, "{zeros:?}");
        }
        // a lag beside it that nothing sees: its pole is a zero
        let one = |x: f64| Mat::from_fn(1, 1, |_, _| x);
        let hidden = StateSpace::continuous(one(-9.0), one(1.0), one(0.0), one(0.0)).unwrap();
        let both = g.parallel(&hidden).unwrap();
        assert!(both.zeros().unwrap().iter().any(|z| (z - C64::new(-9.0, 0.0)).norm() < 1e-9));
        let seen = both.observability().unwrap();
        let of = |pole: f64| seen.iter().find(|(p, _)| (p.re - pole).abs() < 1e-6).unwrap().1;
        assert!(of(-9.0) < 1e-15 && of(-2.0) > 1e-6, "{seen:?}");
        assert!(both.controllability().unwrap().iter().all(|(_, far)| *far > 1e-8));
        assert_eq!(both.minimal(1e-10).unwrap().order(), 4);
    }

    #[test]
    fn the_minimal_system_has_the_same_response() {
        let g =
            StateSpace::continuous(any(4, 4, 0.2), any(4, 2, 1.0), any(2, 4, 2.0), any(2, 2, 3.0)).unwrap();
        // g·g⁻¹ has eight states and is a unit gain; (g + g)/2 has eight and needs four
        let twice = g.parallel(&g).unwrap();
        let least = twice.minimal(1e-10).unwrap();
        assert_eq!((twice.order(), least.order()), (8, 4));
        let s = C64::new(0.3, 1.9);
        assert!((least.at(s).unwrap() - twice.at(s).unwrap()).norm_l2() < 1e-11);
        assert_eq!(g.series(&g.inverse().unwrap()).unwrap().minimal(1e-9).unwrap().order(), 0);
        assert!(g.minimal(f64::NAN).is_err());
    }
}
