//! Functions by poles and residues: values and derivatives without a resolvent.

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use washboard::linalg::{C64, CMat, Mat};
use washboard::subspace::{Domain, Node, Point, Side};

/// D + Σ R_k/(z − λ_k).
pub struct Sum {
    pub d: CMat,
    pub terms: Vec<(C64, CMat)>,
}

impl Sum {
    /// Order n, p × m, residues of rank 1: poles spread over |z| in `radius`, or over the left half plane with |s| in
    /// it and 10 to 70 % damping.
    pub fn random(
        domain: Domain,
        n: usize,
        (p, m): (usize, usize),
        radius: [f64; 2],
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let mut any = |r: usize, c: usize, real: bool| {
            CMat::from_fn(r, c, |_, _| {
                C64::new(rng.random_range(-1.0..1.0), if real { 0.0 } else { rng.random_range(-1.0..1.0) })
            })
        };
        let d = any(p, m, true);
        let mut terms = Vec::new();
        let pairs = n / 2;
        for k in 0..n - pairs {
            let real = k == pairs;
            let share = any(1, 2, true);
            let (at, size) = (0.5 + 0.5 * share[(0, 0)].re, 0.5 + 0.5 * share[(0, 1)].re);
            let r = radius[0] + (radius[1] - radius[0]) * size;
            let pole = match domain {
                Domain::Disk if real => C64::new(r * (2.0 * at - 1.0), 0.0),
                Domain::Disk => {
                    C64::from_polar(r, std::f64::consts::PI * (k as f64 + 0.2 + 0.6 * at) / pairs as f64)
                }
                Domain::HalfPlane { .. } if real => C64::new(-r, 0.0),
                Domain::HalfPlane { .. } => {
                    let zeta = 0.1 + 0.6 * at;
                    let r = radius[0] + (radius[1] - radius[0]) * (k as f64 + size) / pairs as f64;
                    C64::new(-zeta * r, r * (1.0 - zeta * zeta).sqrt())
                }
            };
            let scale = C64::new(if domain == Domain::Disk { 1.0 } else { r }, 0.0);
            let residue = any(p, 1, real) * any(1, m, real) * faer::Scale(scale);
            if !real {
                terms.push((pole.conj(), conj(&residue)));
            }
            terms.push((pole, residue));
        }
        Sum { d, terms }
    }

    /// Derivatives 0, 1, …; Markov parameters at infinity.
    pub fn derivatives(&self, z: Point, count: usize) -> Vec<CMat> {
        let mut factorial = 1.0;
        (0..count)
            .map(|j| {
                factorial *= j.max(1) as f64;
                let mut g = if j == 0 { self.d.clone() } else { CMat::zeros(self.d.nrows(), self.d.ncols()) };
                for (pole, residue) in &self.terms {
                    let factor = match z {
                        Point::Finite(z) => {
                            (z - pole).powi(-(j as i32) - 1) * (factorial * (-1f64).powi(j as i32))
                        }
                        Point::Infinity if j == 0 => continue,
                        Point::Infinity => pole.powi(j as i32 - 1),
                    };
                    g += residue * faer::Scale(factor);
                }
                let real = matches!(z, Point::Infinity) || matches!(z, Point::Finite(z) if z.im == 0.0);
                if real { CMat::from_fn(g.nrows(), g.ncols(), |i, j| C64::new(g[(i, j)].re, 0.0)) } else { g }
            })
            .collect()
    }

    pub fn at(&self, z: C64) -> CMat {
        self.derivatives(Point::Finite(z), 1).remove(0)
    }

    /// A node of it.
    pub fn node(&self, z: Point, count: usize, side: Side) -> Node {
        let values = self.derivatives(z, count).iter().map(|g| part(g, &side)).collect();
        Node { z, values, side }
    }
}

pub fn part(g: &CMat, side: &Side) -> CMat {
    match side {
        Side::Full => g.clone(),
        Side::Left(v) => CMat::from_fn(1, v.len(), |_, j| v[j]) * g,
        Side::Right(u) => g * CMat::from_fn(u.len(), 1, |i, _| u[i]),
    }
}

fn conj(m: &CMat) -> CMat {
    CMat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)].conj())
}

/// G of A, B, C, D by one solve.
pub fn at([a, b, c, d]: [&Mat; 4], z: C64) -> CMat {
    let system =
        washboard::lti::StateSpace::discrete(a.clone(), b.clone(), c.clone(), d.clone(), 1.0).unwrap();
    system.at(z).unwrap()
}
