//! One order's right matrix fraction S⁺ = B A⁻¹, and its poles with shapes and participations.

use super::normal::NormalEquations;
use crate::identify::operational::{ModelPole, OperationalError, OrderModel};
use crate::linalg::{C64, CMat, Mat, solve, solve_complex};
use faer::MatRef;
use serde::{Deserialize, Serialize};

/// |1/μ| below this is a pole at infinity.
const INFINITE: f64 = 1e-9;

/// Which coefficient of A(z) = Σ A_j z^j is held at I.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Constraint {
    /// A_0 = I: mathematical poles grow and are told by that. A clear diagram.
    #[default]
    Lowest,
    /// A_n = I: mathematical poles decay as physical ones do.
    Highest,
}

/// A(z) of one order.
pub(super) struct Denominator {
    order: usize,
    constraint: Constraint,
    /// The coefficients by power, one below the other.
    alpha: Mat,
}

impl Denominator {
    /// The minimiser of αᵀ M α with one coefficient held: M_ff α_f = −M_fh.
    pub fn new(
        normal: &NormalEquations,
        order: usize,
        constraint: Constraint,
    ) -> Result<Self, OperationalError> {
        let m = normal.references;
        let reduced = normal.reduced(order);
        let size = order * m;
        let (free, held) = match constraint {
            Constraint::Lowest => (m, 0),
            Constraint::Highest => (0, size),
        };
        let known = -reduced.submatrix(free, held, size, m).to_owned();
        let unknown = solve(&reduced.submatrix(free, free, size, size).to_owned(), &known)?;
        let alpha = Mat::from_fn(size + m, m, |i, j| {
            if (held..held + m).contains(&i) {
                f64::from(u8::from(i - held == j))
            } else {
                unknown[(i - free, j)]
            }
        });
        Ok(Self { order, constraint, alpha })
    }

    /// The power of z whose coefficient is the j-th below the held one.
    fn power(&self, j: usize) -> usize {
        if self.constraint == Constraint::Lowest { j } else { self.order - j }
    }

    /// a_j, m × m.
    fn a(&self, j: usize) -> MatRef<'_, f64> {
        let m = self.alpha.ncols();
        self.alpha.subrows(self.power(j) * m, m)
    }

    /// The root of det A near μ, by Newton's method on ln det: x ← x − 1/tr(A⁻¹A').
    pub fn root_near(&self, mu: C64) -> Option<C64> {
        const STEPS: usize = 30;
        const CONVERGED: f64 = 1e-11;
        let m = self.alpha.ncols();
        let of_x = |x: C64| if self.constraint == Constraint::Lowest { x.inv() } else { x };
        let mut x = of_x(mu);
        for _ in 0..STEPS {
            let (mut value, mut slope) = (CMat::identity(m, m), CMat::zeros(m, m));
            for j in 1..=self.order {
                let a = self.a(j);
                for (r, c) in (0..m * m).map(|rc| (rc % m, rc / m)) {
                    slope[(r, c)] = slope[(r, c)] * x + value[(r, c)];
                    value[(r, c)] = value[(r, c)] * x + a[(r, c)];
                }
            }
            // at the root itself A is singular
            let Ok(ratio) = solve_complex(&value, &slope) else { return Some(of_x(x)) };
            let step = (0..m).map(|i| ratio[(i, i)]).sum::<C64>().inv();
            x -= step;
            if !(x.re.is_finite() && x.im.is_finite()) {
                return None;
            }
            if step.norm() <= CONVERGED * x.norm() {
                return Some(of_x(x));
            }
        }
        None
    }
}

/// The poles of one order.
///
/// With x = 1/z and a_j = A_j (A_0 held) or x = z and a_j = A_{n−j} (A_n held), A is monic in x:
/// S⁺ = b_0 + C (x − F)⁻¹ G with F = [−a_1 … −a_n; I 0], C = [b_j − b_0 a_j], G = [I; 0].
pub(super) fn model(
    normal: &NormalEquations,
    order: usize,
    constraint: Constraint,
) -> Result<OrderModel, OperationalError> {
    let denominator = Denominator::new(normal, order, constraint)?;
    let (l, m) = (normal.outputs, normal.references);
    let size = order * m;
    let b = normal.numerator(order, &denominator.alpha);
    let mut companion = Mat::zeros(size, size);
    let mut c = Mat::zeros(l, size);
    for j in 1..=order {
        let a = denominator.a(j);
        let output = &b[denominator.power(j)] - &b[denominator.power(0)] * a;
        for col in 0..m {
            for row in 0..m {
                companion[(row, (j - 1) * m + col)] = -a[(row, col)];
            }
            for row in 0..l {
                c[(row, (j - 1) * m + col)] = output[(row, col)];
            }
        }
    }
    for i in m..size {
        companion[(i, i - m)] = 1.0;
    }
    let g = Mat::from_fn(size, m, |i, j| f64::from(u8::from(i == j)));
    let mut model = OrderModel::of_realisation(&companion, &c, &g)?;
    model.order = order;
    if constraint == Constraint::Lowest {
        model.poles.iter_mut().for_each(in_z);
    }
    Ok(model)
}

/// From 1/(x − x_k), x = 1/z, to the same pole in z: −μ − μ²/(z − μ) with μ = 1/x_k.
fn in_z(pole: &mut ModelPole) {
    let x = pole.mu;
    pole.mu = if x.norm() < INFINITE { C64::new(1.0 / INFINITE, 0.0) } else { x.inv() };
    let factor = -pole.mu * pole.mu;
    if let Some(input) = &mut pole.input {
        input.iter_mut().for_each(|g| *g *= factor);
    }
}
