//! One order's right matrix fraction S⁺ = B A⁻¹, and its poles with shapes and participations.

use super::normal::NormalEquations;
use crate::identify::operational::{OperationalError, OrderModel};
use crate::linalg::{C64, Mat, solve};
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

/// The poles of one order.
///
/// With x = 1/z and a_j = A_j (A_0 held) or x = z and a_j = A_{n−j} (A_n held), A is monic in x:
/// S⁺ = b_0 + C (x − F)⁻¹ G with F = [−a_1 … −a_n; I 0], C = [b_j − b_0 a_j], G = [I; 0].
pub(super) fn model(
    normal: &NormalEquations,
    order: usize,
    constraint: Constraint,
) -> Result<OrderModel, OperationalError> {
    let (l, m) = (normal.outputs, normal.references);
    let reduced = normal.reduced(order);
    let size = order * m;
    let (free, held) = match constraint {
        Constraint::Lowest => (m, 0),
        Constraint::Highest => (0, size),
    };
    let known = -reduced.submatrix(free, held, size, m).to_owned();
    let unknown = solve(&reduced.submatrix(free, free, size, size).to_owned(), &known)?;
    let alpha = Mat::from_fn(size + m, m, |i, j| {
        if (held..held + m).contains(&i) { f64::from(u8::from(i - held == j)) } else { unknown[(i - free, j)] }
    });
    let b = normal.numerator(order, &alpha);
    let power = |j: usize| if constraint == Constraint::Lowest { j } else { order - j };
    let a = |j: usize| alpha.subrows(power(j) * m, m);
    let mut companion = Mat::zeros(size, size);
    let mut c = Mat::zeros(l, size);
    for j in 1..=order {
        let output = &b[power(j)] - &b[power(0)] * a(j);
        for col in 0..m {
            for row in 0..m {
                companion[(row, (j - 1) * m + col)] = -a(j)[(row, col)];
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
fn in_z(pole: &mut crate::identify::operational::ModelPole) {
    let x = pole.mu;
    pole.mu = if x.norm() < INFINITE { C64::new(1.0 / INFINITE, 0.0) } else { x.inv() };
    let factor = -pole.mu * pole.mu;
    if let Some(input) = &mut pole.input {
        input.iter_mut().for_each(|g| *g *= factor);
    }
}
