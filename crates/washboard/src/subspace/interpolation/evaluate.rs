//! What a realisation does at its nodes, by powers of the resolvent in the plane of the data.

use super::super::SubspaceError;
use super::data::{InterpolationData, Node, Point, Side, largest};
use crate::linalg::{C64, CMat, Mat, solve_complex};
use crate::lti::{Continuous, Discrete, StateSpace};

/// A system in the time of its data.
#[derive(Debug, Clone)]
pub enum Realisation {
    /// Of data on the disk; the step is 1 s, for none is given.
    Discrete(StateSpace<Discrete>),
    /// Of data in the half plane.
    Continuous(StateSpace<Continuous>),
}

impl Realisation {
    /// A, B, C, D.
    #[must_use]
    pub fn matrices(&self) -> [&Mat; 4] {
        match self {
            Realisation::Discrete(g) => [g.a(), g.b(), g.c(), g.d()],
            Realisation::Continuous(g) => [g.a(), g.b(), g.c(), g.d()],
        }
    }

    /// Whether all poles are where they may be: inside the circle, left of the axis.
    ///
    /// # Errors
    /// Poles that do not converge.
    pub fn is_stable(&self) -> Result<bool, SubspaceError> {
        Ok(match self {
            Realisation::Discrete(g) => g.is_stable()?,
            Realisation::Continuous(g) => g.is_stable()?,
        })
    }

    /// Derivatives 0, 1, … of G at a finite point, (3.55); at infinity Markov parameters.
    ///
    /// # Errors
    /// A pole there.
    pub fn derivatives(&self, z: Point, count: usize) -> Result<Vec<CMat>, SubspaceError> {
        let [a, b, c, d] = self.matrices();
        let complex = |m: &Mat| CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0));
        let n = a.nrows();
        let (a, b, c, d) = (complex(a), complex(b), complex(c), complex(d));
        let Point::Finite(z) = z else {
            let mut x = b;
            let mut all = vec![d];
            while all.len() < count {
                all.push(&c * &x);
                x = &a * x;
            }
            return Ok(all);
        };
        let pencil = CMat::from_fn(n, n, |i, j| if i == j { z } else { C64::new(0.0, 0.0) } - a[(i, j)]);
        let mut x = b * faer::Scale(C64::new(-1.0, 0.0));
        let mut all = Vec::with_capacity(count);
        for j in 0..count {
            if n > 0 {
                // −j (zI − A)⁻¹ times the one before, and 1 at first
                x = solve_complex(&pencil, &x)? * faer::Scale(C64::new(-(j.max(1) as f64), 0.0));
            }
            all.push(if j == 0 { &c * &x + &d } else { &c * &x });
        }
        Ok(all)
    }

    /// The largest difference from the data, over the largest value of the same derivative (where all are 0: itself).
    ///
    /// # Errors
    /// A pole at a node.
    pub fn max_error(&self, data: &InterpolationData) -> Result<f64, SubspaceError> {
        let at_infinity = |node: &Node| node.z == Point::Infinity;
        let mut worst: f64 = 0.0;
        for node in &data.nodes {
            let found = self.derivatives(node.z, node.values.len())?;
            for (j, (g, value)) in found.iter().zip(&node.values).enumerate() {
                let alike = data.nodes.iter().filter(|n| at_infinity(n) == at_infinity(node));
                let size = alike
                    .filter_map(|n| n.values.get(j))
                    .map(|v| largest(v, |x| x.norm()))
                    .fold(0.0, f64::max);
                let off = largest(&(part(g, &node.side) - value), |x| x.norm());
                worst = worst.max(if size > 0.0 { off / size } else { off });
            }
        }
        Ok(worst)
    }
}

fn part(g: &CMat, side: &Side) -> CMat {
    match side {
        Side::Full => g.clone(),
        Side::Left(v) => CMat::from_fn(1, v.len(), |_, j| v[j]) * g,
        Side::Right(u) => g * CMat::from_fn(u.len(), 1, |i, _| u[i]),
    }
}
