//! A plant with a controller of given order: the closed loop, and what its matrices gain from each entry.

use crate::linalg::{Mat, solve};
use crate::lti::{GeneralizedPlant, LtiError, blocks};

/// A plant's blocks at hand.
#[derive(Debug, Clone)]
pub(super) struct Open {
    pub a: Mat,
    pub b1: Mat,
    pub b2: Mat,
    pub c1: Mat,
    pub c2: Mat,
    pub d11: Mat,
    pub d12: Mat,
    pub d21: Mat,
    pub d22: Mat,
    through: bool,
}

/// ẋ = A x + B w, z = C x + D w with the states \[x; ξ\].
#[derive(Debug, Clone)]
pub(super) struct Closed {
    pub a: Mat,
    pub b: Mat,
    pub c: Mat,
    pub d: Mat,
    /// (I − K D₂₂)⁻ᵀ and (I − D₂₂K)⁻ᵀ of the extended matrices, where D₂₂ is not 0.
    turn: Option<(Mat, Mat)>,
}

impl Open {
    /// With the performances and disturbances that are asked about.
    pub fn of(plant: &GeneralizedPlant, outputs: &[usize], disturbances: &[usize]) -> Self {
        // of states of unlike size (a delay's approximation) Lyapunov's equation knows few digits: a search needs ten
        let calm = plant.system().balanced_scales().ok();
        let calm = calm.and_then(|(g, _)| GeneralizedPlant::new(g, plant.signals().clone()).ok());
        let plant = calm.as_ref().unwrap_or(plant);
        let d22 = plant.d22();
        let rows = |m: &Mat| Mat::from_fn(outputs.len(), m.ncols(), |i, j| m[(outputs[i], j)]);
        let columns = |m: &Mat| Mat::from_fn(m.nrows(), disturbances.len(), |i, j| m[(i, disturbances[j])]);
        Open {
            a: plant.a().clone(),
            b1: columns(&plant.b1()),
            b2: plant.b2(),
            c1: rows(&plant.c1()),
            c2: plant.c2(),
            d11: columns(&rows(&plant.d11())),
            d12: rows(&plant.d12()),
            d21: columns(&plant.d21()),
            through: d22.norm_max() > 0.0,
            d22,
        }
    }

    /// z = u, y = w: its closed loop is the controller itself.
    pub fn bare(controls: usize, measurements: usize) -> Self {
        let one = |n: usize| Mat::identity(n, n);
        let none = |r: usize, c: usize| Mat::zeros(r, c);
        let (u, y) = (controls, measurements);
        Open {
            a: none(0, 0),
            b1: none(0, y),
            b2: none(0, u),
            c1: none(u, 0),
            c2: none(y, 0),
            d11: none(u, y),
            d12: one(u),
            d21: one(y),
            d22: none(y, u),
            through: false,
        }
    }

    /// Closes the loop with \[A_K, B_K; C_K, D_K\]; none where that is not well posed.
    pub fn close(&self, k: &Mat, order: usize) -> Option<Closed> {
        let (n, nu, ny) = (self.a.nrows(), self.b2.ncols(), self.c2.nrows());
        let mut turn = None;
        let mut k = k.clone();
        if self.through {
            let zero = |r: usize, c: usize| Mat::zeros(r, c);
            let d = blocks(&[&[&zero(order, order), &zero(order, nu)], &[&zero(ny, order), &self.d22]]);
            let left = Mat::identity(order + nu, order + nu) - &k * &d;
            let right = Mat::identity(order + ny, order + ny) - &d * &k;
            let inverse = |m: &Mat| -> Result<Mat, LtiError> {
                Ok(solve(&m.transpose().to_owned(), &Mat::identity(m.nrows(), m.nrows()))?)
            };
            let (left, right) = (inverse(&left).ok()?, inverse(&right).ok()?);
            k = left.transpose() * &k;
            if k.norm_max() > 1e12 * (1.0 + self.d22.norm_max().recip()) {
                return None;
            }
            turn = Some((left, right));
        }
        // entry by entry: at this size a product's call costs more than its arithmetic
        let all = n + order;
        let (b2d, d12d) = (along(&self.b2, &k, order, ny), along(&self.d12, &k, order, ny));
        let a = Mat::from_fn(all, all, |i, j| match (i < n, j < n) {
            (true, true) => self.a[(i, j)] + dot(ny, |y| b2d[(i, y)] * self.c2[(y, j)]),
            (true, false) => dot(nu, |u| self.b2[(i, u)] * k[(order + u, j - n)]),
            (false, true) => dot(ny, |y| k[(i - n, order + y)] * self.c2[(y, j)]),
            (false, false) => k[(i - n, j - n)],
        });
        let b = Mat::from_fn(all, self.b1.ncols(), |i, w| {
            if i < n {
                self.b1[(i, w)] + dot(ny, |y| b2d[(i, y)] * self.d21[(y, w)])
            } else {
                dot(ny, |y| k[(i - n, order + y)] * self.d21[(y, w)])
            }
        });
        let c = Mat::from_fn(self.c1.nrows(), all, |z, j| {
            if j < n {
                self.c1[(z, j)] + dot(ny, |y| d12d[(z, y)] * self.c2[(y, j)])
            } else {
                dot(nu, |u| self.d12[(z, u)] * k[(order + u, j - n)])
            }
        });
        let d = Mat::from_fn(c.nrows(), b.ncols(), |z, w| {
            self.d11[(z, w)] + dot(ny, |y| d12d[(z, y)] * self.d21[(y, w)])
        });
        let finite = |m: &Mat| m.nrows() == 0 || m.ncols() == 0 || m.norm_max().is_finite();
        (finite(&a) && finite(&b) && finite(&c) && finite(&d)).then_some(Closed { a, b, c, d, turn })
    }
}

/// M D_K of a block \[A_K, B_K; C_K, D_K\].
fn along(m: &Mat, k: &Mat, order: usize, ny: usize) -> Mat {
    Mat::from_fn(m.nrows(), ny, |i, y| dot(m.ncols(), |u| m[(i, u)] * k[(order + u, order + y)]))
}

fn dot(n: usize, of: impl Fn(usize) -> f64) -> f64 {
    (0..n).map(of).sum()
}

impl Closed {
    /// From a gradient in the loop's own block to that of \[A_K, B_K; C_K, D_K\].
    pub fn back(&self, gradient: Mat) -> Mat {
        match &self.turn {
            Some((left, right)) => left * gradient * right,
            None => gradient,
        }
    }
}
