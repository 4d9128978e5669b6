//! A 2 × 2 block in standard form, and the plane rotation that brings it there.

use super::Mat;

/// The rotation [c s; −s c] of a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rotation {
    pub c: f64,
    pub s: f64,
}

impl Rotation {
    /// Replaces rows i and j of `a`, columns `from..`, by G times them.
    pub fn rows(self, a: &mut Mat, i: usize, j: usize, from: usize) {
        for col in from..a.ncols() {
            let (x, y) = (a[(i, col)], a[(j, col)]);
            a[(i, col)] = self.c * x + self.s * y;
            a[(j, col)] = self.c * y - self.s * x;
        }
    }

    /// Replaces columns i and j of `a`, rows `..to`, by them times Gᵀ.
    pub fn cols(self, a: &mut Mat, i: usize, j: usize, to: usize) {
        for row in 0..to {
            let (x, y) = (a[(row, i)], a[(row, j)]);
            a[(row, i)] = self.c * x + self.s * y;
            a[(row, j)] = self.c * y - self.s * x;
        }
    }
}

/// [a b; c d] in standard form: c = 0 for two real eigenvalues, else a = d and bc < 0; with the rotation
/// G [a b; c d] Gᵀ that does it. LAPACK's dlanv2.
pub(super) fn standardise(a: f64, b: f64, c: f64, d: f64) -> ([f64; 4], Rotation) {
    const REAL: f64 = 4.0 * f64::EPSILON; // a discriminant below this may be a complex pair by rounding
    let turn = |c, s| Rotation { c, s };
    if c == 0.0 {
        return ([a, b, c, d], turn(1.0, 0.0));
    }
    if b == 0.0 {
        return ([d, -c, 0.0, a], turn(0.0, 1.0));
    }
    if a == d && (b > 0.0) != (c > 0.0) {
        return ([a, b, c, d], turn(1.0, 0.0));
    }
    let p = 0.5 * (a - d);
    let (largest, signed_least) = (b.abs().max(c.abs()), b.abs().min(c.abs()) * b.signum() * c.signum());
    let scale = p.abs().max(largest);
    let discriminant = p / scale * p + largest / scale * signed_least;
    if discriminant >= REAL {
        let z = p + (scale.sqrt() * discriminant.sqrt()).copysign(p);
        let tau = c.hypot(z);
        return ([d + z, b - c, 0.0, d - largest / z * signed_least], turn(z / tau, c / tau));
    }
    // a complex pair, or real eigenvalues that are nearly equal: make the diagonal equal
    let sigma = b + c;
    let tau = sigma.hypot(a - d);
    let cs = (0.5 * (1.0 + sigma.abs() / tau)).sqrt();
    let sn = -(p / (tau * cs)) * 1f64.copysign(sigma);
    let (aa, bb, cc, dd) = (a * cs + b * sn, -a * sn + b * cs, c * cs + d * sn, -c * sn + d * cs);
    let (a, b, c, d) = (aa * cs + cc * sn, bb * cs + dd * sn, -aa * sn + cc * cs, -bb * sn + dd * cs);
    let mean = 0.5 * (a + d);
    if c == 0.0 {
        ([mean, b, 0.0, mean], turn(cs, sn))
    } else if b == 0.0 {
        ([mean, -c, 0.0, mean], turn(-sn, cs))
    } else if (b > 0.0) == (c > 0.0) {
        let (sab, sac) = (b.abs().sqrt(), c.abs().sqrt());
        let p = (sab * sac).copysign(c);
        let tau = 1.0 / (b + c).abs().sqrt();
        let (c1, s1) = (sab * tau, sac * tau);
        ([mean + p, b - c, 0.0, mean - p], turn(cs * c1 - sn * s1, cs * s1 + sn * c1))
    } else {
        ([mean, b, c, mean], turn(cs, sn))
    }
}

/// Standardises the block of T at (k, k) and carries the rotation through T and Q.
pub(super) fn standardise_at(q: &mut Mat, t: &mut Mat, k: usize) {
    let ([a, b, c, d], turn) = standardise(t[(k, k)], t[(k, k + 1)], t[(k + 1, k)], t[(k + 1, k + 1)]);
    turn.rows(t, k, k + 1, k + 2);
    turn.cols(t, k, k + 1, k);
    let n = q.nrows();
    turn.cols(q, k, k + 1, n);
    (t[(k, k)], t[(k, k + 1)], t[(k + 1, k)], t[(k + 1, k + 1)]) = (a, b, c, d);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rotation_reproduces_the_block() {
        let values = [0.0, 1.0, -1.0, 3.0, 1e-9, -2e5];
        for a in values {
            for b in values {
                for c in values {
                    for d in values {
                        let ([a2, b2, c2, d2], g) = standardise(a, b, c, d);
                        assert!(c2 == 0.0 || (a2 == d2 && b2 * c2 < 0.0), "{a} {b} {c} {d}");
                        let mut m = Mat::from_fn(2, 2, |i, j| [[a, b], [c, d]][i][j]);
                        g.rows(&mut m, 0, 1, 0);
                        g.cols(&mut m, 0, 1, 2);
                        let e = Mat::from_fn(2, 2, |i, j| [[a2, b2], [c2, d2]][i][j]);
                        let size = a.abs() + b.abs() + c.abs() + d.abs();
                        assert!((m - e).norm_max() <= 8.0 * f64::EPSILON * size, "{a} {b} {c} {d}");
                    }
                }
            }
        }
    }
}
