//! Systems joined: in series, in parallel, side by side, in feedback, through a linear fractional transformation.

use super::{LtiError, StateSpace, Time};
use crate::linalg::{Mat, condition_estimate, solve};

/// A loop whose I − D₁D₂ has a smaller reciprocal condition number (in the 1-norm) is not well posed.
const LEAST_RCOND: f64 = 1e-12;

impl<T: Time> StateSpace<T> {
    /// `after`·self: first this system, then the other one.
    ///
    /// # Errors
    /// Outputs and inputs that do not match in number, or different steps.
    pub fn series(&self, after: &Self) -> Result<Self, LtiError> {
        self.check_time(after)?;
        expect("series connection, inputs of the second system", self.outputs(), after.inputs())?;
        Self::new(
            blocks(&[
                &[self.a(), &zeros(self.order(), after.order())],
                &[&(after.b() * self.c()), after.a()],
            ]),
            blocks(&[&[self.b()], &[&(after.b() * self.d())]]),
            blocks(&[&[&(after.d() * self.c()), after.c()]]),
            after.d() * self.d(),
            self.time(),
        )
    }

    /// self + other: the same inputs, outputs added.
    ///
    /// # Errors
    /// Numbers of inputs or outputs that differ, or different steps.
    pub fn parallel(&self, other: &Self) -> Result<Self, LtiError> {
        self.check_time(other)?;
        expect("parallel connection, inputs", self.inputs(), other.inputs())?;
        expect("parallel connection, outputs", self.outputs(), other.outputs())?;
        Self::new(
            diagonal(self.a(), other.a()),
            blocks(&[&[self.b()], &[other.b()]]),
            blocks(&[&[self.c(), other.c()]]),
            self.d() + other.d(),
            self.time(),
        )
    }

    /// Both, side by side: diag(self, other).
    ///
    /// # Errors
    /// Different steps.
    pub fn append(&self, other: &Self) -> Result<Self, LtiError> {
        self.check_time(other)?;
        Self::new(
            diagonal(self.a(), other.a()),
            diagonal(self.b(), other.b()),
            diagonal(self.c(), other.c()),
            diagonal(self.d(), other.d()),
            self.time(),
        )
    }

    /// Outputs of both one above the other, from the same inputs: [self; other].
    ///
    /// # Errors
    /// Numbers of inputs that differ, or different steps.
    pub fn stack(&self, other: &Self) -> Result<Self, LtiError> {
        self.check_time(other)?;
        expect("stacked systems, inputs", self.inputs(), other.inputs())?;
        Self::new(
            diagonal(self.a(), other.a()),
            blocks(&[&[self.b()], &[other.b()]]),
            diagonal(self.c(), other.c()),
            blocks(&[&[self.d()], &[other.d()]]),
            self.time(),
        )
    }

    /// A gain before the inputs: self·`gain`.
    ///
    /// # Errors
    /// A gain whose rows are not the inputs.
    pub fn times(&self, gain: &Mat) -> Result<Self, LtiError> {
        StateSpace::gain(gain.clone(), self.time())?.series(self)
    }

    /// y = G(r + K y): positive feedback through `back`, (I − G K)⁻¹ G.
    ///
    /// # Errors
    /// Numbers that do not match, different steps, a loop that is not well posed.
    pub fn feedback(&self, back: &Self) -> Result<Self, LtiError> {
        self.check_time(back)?;
        expect("feedback, inputs of the system behind", self.outputs(), back.inputs())?;
        expect("feedback, outputs of the system behind", self.inputs(), back.outputs())?;
        // the plant [y; y] = [G G; G G][r; u] closed by u = K y
        let (m, p) = (self.inputs(), self.outputs());
        let twice_in: Vec<usize> = (0..m).chain(0..m).collect();
        let twice_out: Vec<usize> = (0..p).chain(0..p).collect();
        self.select(&twice_out, &twice_in)?.lft(back)
    }

    /// The lower linear fractional transformation F_l(P, K): the last outputs y and inputs u of this system closed by
    /// u = +K y, P₁₁ + P₁₂ K (I − P₂₂K)⁻¹ P₂₁.
    ///
    /// States are the plant's, then the controller's.
    ///
    /// # Errors
    /// A controller with more inputs or outputs than the plant has outputs or inputs, different steps, a loop that is
    /// not well posed (I − D₂₂D_K singular, its reciprocal condition below 1e-12).
    pub fn lft(&self, controller: &Self) -> Result<Self, LtiError> {
        self.check_time(controller)?;
        let (ny, nu) = (controller.inputs(), controller.outputs());
        let (Some(nz), Some(nw)) = (self.outputs().checked_sub(ny), self.inputs().checked_sub(nu)) else {
            return Err(LtiError::Join {
                what: "lft, controller",
                expected: format!("at most {} inputs and {} outputs", self.outputs(), self.inputs()),
                found: format!("{ny} inputs and {nu} outputs"),
            });
        };
        let n = self.order();
        let (b1, b2) = (cut(self.b(), 0, 0, n, nw), cut(self.b(), 0, nw, n, nu));
        let (c1, c2) = (cut(self.c(), 0, 0, nz, n), cut(self.c(), nz, 0, ny, n));
        let (d11, d12) = (cut(self.d(), 0, 0, nz, nw), cut(self.d(), 0, nw, nz, nu));
        let (d21, d22) = (cut(self.d(), nz, 0, ny, nw), cut(self.d(), nz, nw, ny, nu));
        let (ak, bk, ck, dk) = (controller.a(), controller.b(), controller.c(), controller.d());
        let loop_y = Mat::identity(ny, ny) - &d22 * dk;
        let rcond = 1.0 / condition_estimate(&loop_y)?;
        if !(rcond > LEAST_RCOND) {
            return Err(LtiError::IllPosed { what: "the loop of plant and controller", rcond });
        }
        // y = E (C₂x + D₂₂C_K ξ + D₂₁w), u = C_K ξ + D_K y
        let e =
            |m: &Mat| -> Result<Mat, LtiError> { Ok(if ny == 0 { m.clone() } else { solve(&loop_y, m)? }) };
        let (y_x, y_xi, y_w) = (e(&c2)?, e(&(&d22 * ck))?, e(&d21)?);
        let (u_x, u_xi, u_w) = (dk * &y_x, ck + dk * &y_xi, dk * &y_w);
        Self::new(
            blocks(&[&[&(self.a() + &b2 * &u_x), &(&b2 * &u_xi)], &[&(bk * &y_x), &(ak + bk * &y_xi)]]),
            blocks(&[&[&(b1 + &b2 * &u_w)], &[&(bk * &y_w)]]),
            blocks(&[&[&(c1 + &d12 * &u_x), &(&d12 * &u_xi)]]),
            d11 + &d12 * &u_w,
            self.time(),
        )
    }

    /// G⁻¹, of a square system with an invertible D.
    ///
    /// # Errors
    /// A system that is not square, or a D whose reciprocal condition is below 1e-12.
    pub fn inverse(&self) -> Result<Self, LtiError> {
        expect("inverse, outputs", self.inputs(), self.outputs())?;
        let rcond = 1.0 / condition_estimate(self.d())?;
        if !(rcond > LEAST_RCOND) {
            return Err(LtiError::IllPosed { what: "the inverse", rcond });
        }
        let identity = Mat::identity(self.inputs(), self.inputs());
        let (over, c) = (solve(self.d(), &identity)?, solve(self.d(), self.c())?);
        Self::new(self.a() - self.b() * &c, self.b() * &over, -c, over, self.time())
    }

    fn check_time(&self, other: &Self) -> Result<(), LtiError> {
        if self.time() == other.time() {
            return Ok(());
        }
        let (expected, found) = (format!("{:?}", self.time()), format!("{:?}", other.time()));
        Err(LtiError::Join { what: "systems in different times", expected, found })
    }
}

fn expect(what: &'static str, expected: usize, found: usize) -> Result<(), LtiError> {
    if expected == found {
        return Ok(());
    }
    Err(LtiError::Join { what, expected: expected.to_string(), found: found.to_string() })
}

fn zeros(rows: usize, cols: usize) -> Mat {
    Mat::zeros(rows, cols)
}

/// A matrix of blocks.
pub(crate) fn blocks(rows: &[&[&Mat]]) -> Mat {
    let height: usize = rows.iter().map(|r| r.first().map_or(0, |m| m.nrows())).sum();
    let width: usize = rows.first().map_or(0, |r| r.iter().map(|m| m.ncols()).sum());
    let mut all = Mat::zeros(height, width);
    let mut top = 0;
    for row in rows {
        let mut left = 0;
        for m in *row {
            all.submatrix_mut(top, left, m.nrows(), m.ncols()).copy_from(*m);
            left += m.ncols();
        }
        top += row.first().map_or(0, |m| m.nrows());
    }
    all
}

/// diag(a, b).
pub(crate) fn diagonal(a: &Mat, b: &Mat) -> Mat {
    blocks(&[&[a, &zeros(a.nrows(), b.ncols())], &[&zeros(b.nrows(), a.ncols()), b]])
}

/// A block of a matrix, by its first row and column and its shape.
pub(crate) fn cut(m: &Mat, row: usize, col: usize, rows: usize, cols: usize) -> Mat {
    m.submatrix(row, col, rows, cols).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{C64, CMat};
    use crate::lti::Continuous;
    use rand::{Rng, SeedableRng};

    /// Products of a dozen matrices of order ten, conditioned like 1e3.
    const ROUNDING: f64 = 1e-11;

    fn system(n: usize, m: usize, p: usize, seed: u64) -> StateSpace<Continuous> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut any = |r: usize, c: usize| Mat::from_fn(r, c, |_, _| rng.random_range(-1.0..1.0));
        StateSpace::continuous(any(n, n), any(n, m), any(p, n), any(p, m)).unwrap()
    }

    fn close(a: &CMat, b: &CMat) -> bool {
        (a - b).norm_l2() <= ROUNDING * b.norm_l2().max(1.0)
    }

    const S: C64 = C64::new(0.3, 1.7);

    #[test]
    fn connections_are_the_algebra_of_transfer_functions() {
        let (g, k) = (system(4, 2, 3, 1), system(3, 3, 2, 2));
        let (gs, ks) = (g.at(S).unwrap(), k.at(S).unwrap());
        assert!(close(&g.series(&k).unwrap().at(S).unwrap(), &(&ks * &gs)));
        let h = system(2, 2, 3, 3);
        assert!(close(&g.parallel(&h).unwrap().at(S).unwrap(), &(&gs + h.at(S).unwrap())));
        let loop_ = CMat::identity(3, 3) - &gs * &ks;
        let closed = crate::linalg::solve_complex(&loop_, &gs).unwrap();
        assert!(close(&g.feedback(&k).unwrap().at(S).unwrap(), &closed));
        let square = system(5, 2, 2, 4);
        let unit = square.series(&square.inverse().unwrap()).unwrap().at(S).unwrap();
        assert!(close(&unit, &CMat::identity(2, 2)));
        let stacked = g.stack(&h).unwrap().at(S).unwrap();
        assert!(close(&stacked.submatrix(3, 0, 3, 2).to_owned(), &h.at(S).unwrap()));
        let beside = g.append(&k).unwrap().at(S).unwrap();
        assert!(close(&beside.submatrix(3, 2, 2, 3).to_owned(), &ks));
        assert_eq!(beside[(0, 3)], C64::new(0.0, 0.0));
    }

    #[test]
    fn the_fractional_transformation_is_its_formula() {
        let (nz, ny, nw, nu) = (2, 3, 4, 2);
        let (p, k) = (system(6, nw + nu, nz + ny, 5), system(3, ny, nu, 6));
        let (ps, ks) = (p.at(S).unwrap(), k.at(S).unwrap());
        let part = |i, j, r, c| ps.submatrix(i, j, r, c).to_owned();
        let (p11, p12) = (part(0, 0, nz, nw), part(0, nw, nz, nu));
        let (p21, p22) = (part(nz, 0, ny, nw), part(nz, nw, ny, nu));
        let y = crate::linalg::solve_complex(&(CMat::identity(ny, ny) - &p22 * &ks), &p21).unwrap();
        assert!(close(&p.lft(&k).unwrap().at(S).unwrap(), &(p11 + p12 * &ks * y)));
        assert_eq!(p.lft(&k).unwrap().order(), 9);
    }

    #[test]
    fn a_loop_without_a_solution_is_refused() {
        let one = |x: f64| StateSpace::continuous_gain(Mat::from_fn(1, 1, |_, _| x)).unwrap();
        assert!(
            matches!(one(2.0).feedback(&one(0.5)), Err(LtiError::IllPosed { rcond, .. }) if rcond < 1e-12)
        );
        // y = 2(r − 0.5·y)
        assert_eq!(one(2.0).feedback(&one(-0.5)).unwrap().d()[(0, 0)], 1.0);
        assert!(matches!(one(0.0).inverse(), Err(LtiError::IllPosed { .. })));
        let d = |dt| StateSpace::discrete(zeros(0, 0), zeros(0, 1), zeros(1, 0), zeros(1, 1), dt).unwrap();
        assert!(matches!(d(0.1).series(&d(0.2)), Err(LtiError::Join { .. })));
        assert!(system(1, 2, 2, 1).lft(&system(1, 3, 1, 1)).is_err());
    }
}
