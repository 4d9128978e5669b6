//! Complex matrices of ten or twenty rows in slices, row after row: what a model at a thousand frequencies is made of.
//!
//! faer is made for large matrices: at this size its calls cost more than their arithmetic, and an allocation as much as a
//! factorisation. Nothing here allocates.

use super::C64;

/// 0 + 0i.
pub(crate) const ZERO: C64 = C64::new(0.0, 0.0);

/// P A = L U in place, with partial pivoting; false where A is singular. `pivots[k]` is the row that was swapped with k.
pub(crate) fn lu(a: &mut [C64], pivots: &mut [usize]) -> bool {
    let n = pivots.len();
    for k in 0..n {
        let size = |i: usize| a[i * n + k].norm_sqr();
        let row = (k + 1..n).fold(k, |best, i| if size(i) > size(best) { i } else { best });
        if !(size(row) > 0.0 && size(row).is_finite()) {
            return false;
        }
        pivots[k] = row;
        swap_rows(a, n, k, row);
        let inverse = a[k * n + k].inv();
        let (top, below) = a.split_at_mut((k + 1) * n);
        let pivot = &top[k * n + k + 1..];
        for row in below.chunks_exact_mut(n) {
            let factor = row[k] * inverse;
            row[k] = factor;
            subtract(&mut row[k + 1..], factor, pivot);
        }
    }
    true
}

/// X of A X = B in place of B (n × columns), A factored by [`lu`].
pub(crate) fn lu_solve(factors: &[C64], pivots: &[usize], b: &mut [C64], columns: usize) {
    let n = pivots.len();
    for (k, row) in pivots.iter().enumerate() {
        swap_rows(b, columns, k, *row);
    }
    for i in 0..n {
        let (above, rest) = b.split_at_mut(i * columns);
        for (k, x) in above.chunks_exact(columns).enumerate() {
            subtract(&mut rest[..columns], factors[i * n + k], x);
        }
    }
    for i in (0..n).rev() {
        let (upto, below) = b.split_at_mut((i + 1) * columns);
        let row = &mut upto[i * columns..];
        for (k, x) in below.chunks_exact(columns).enumerate() {
            subtract(row, factors[i * n + i + 1 + k], x);
        }
        let inverse = factors[i * n + i].inv();
        row.iter_mut().for_each(|v| *v *= inverse);
    }
}

/// X of Aᵀ X = B in place of B (n × columns), A factored by [`lu`].
pub(crate) fn lu_solve_transposed(factors: &[C64], pivots: &[usize], b: &mut [C64], columns: usize) {
    let n = pivots.len();
    for i in 0..n {
        let (upto, below) = b.split_at_mut((i + 1) * columns);
        let row = &mut upto[i * columns..];
        let inverse = factors[i * n + i].inv();
        row.iter_mut().for_each(|v| *v *= inverse);
        for (k, x) in below.chunks_exact_mut(columns).enumerate() {
            subtract(x, factors[i * n + i + 1 + k], row);
        }
    }
    for i in (0..n).rev() {
        let (above, rest) = b.split_at_mut(i * columns);
        for (k, x) in above.chunks_exact_mut(columns).enumerate() {
            subtract(x, factors[i * n + k], &rest[..columns]);
        }
    }
    for (k, row) in pivots.iter().enumerate().rev() {
        swap_rows(b, columns, k, *row);
    }
}

/// L of the Hermitian A = L Lᴴ in place of its lower triangle; false where A is not positive definite.
pub(crate) fn cholesky(a: &mut [C64], n: usize) -> bool {
    for i in 0..n {
        let (above, rest) = a.split_at_mut(i * n);
        let row = &mut rest[..n];
        for (j, l) in above.chunks_exact(n).enumerate() {
            let sum: C64 = row[..j].iter().zip(l).map(|(x, y)| x * y.conj()).sum();
            row[j] = (row[j] - sum) / l[j].re;
        }
        let square = row[i].re - row[..i].iter().map(|x| x.norm_sqr()).sum::<f64>();
        if !(square > 0.0 && square.is_finite()) {
            return false;
        }
        row[i] = C64::new(square.sqrt(), 0.0);
    }
    true
}

/// L⁻¹ of a lower triangle with a real diagonal, zeros above its own.
pub(crate) fn lower_inverse(l: &[C64], inverse: &mut [C64], n: usize) {
    inverse.fill(ZERO);
    for i in 0..n {
        let (above, rest) = inverse.split_at_mut(i * n);
        let row = &mut rest[..n];
        row[i] = C64::new(1.0, 0.0);
        for (k, x) in above.chunks_exact(n).enumerate() {
            subtract(&mut row[..=k], l[i * n + k], &x[..=k]);
        }
        let scale = 1.0 / l[i * n + i].re;
        row[..=i].iter_mut().for_each(|v| *v *= scale);
    }
}

/// `out` = A B of shapes [m, k] and [k, n], the entries of A by a function: its conjugate or transpose costs nothing.
pub(crate) fn product(out: &mut [C64], [m, k, n]: [usize; 3], a: impl Fn(usize, usize) -> C64, b: &[C64]) {
    for (i, row) in out[..m * n].chunks_exact_mut(n).enumerate() {
        row.fill(ZERO);
        for (l, x) in b[..k * n].chunks_exact(n).enumerate() {
            let f = a(i, l);
            for (r, v) in row.iter_mut().zip(x) {
                r.re += f.re * v.re - f.im * v.im;
                r.im += f.re * v.im + f.im * v.re;
            }
        }
    }
}

/// `out` = A B for a real A, whose zeros are skipped.
pub(crate) fn real_product(out: &mut [C64], [m, k, n]: [usize; 3], a: &[f64], b: &[C64]) {
    for (i, row) in out[..m * n].chunks_exact_mut(n).enumerate() {
        row.fill(ZERO);
        for (l, x) in b[..k * n].chunks_exact(n).enumerate() {
            let f = a[i * k + l];
            if f != 0.0 {
                row.iter_mut().zip(x).for_each(|(r, v)| *r += v * f);
            }
        }
    }
}

fn subtract(row: &mut [C64], factor: C64, other: &[C64]) {
    for (r, v) in row.iter_mut().zip(other) {
        r.re -= factor.re * v.re - factor.im * v.im;
        r.im -= factor.re * v.im + factor.im * v.re;
    }
}

fn swap_rows(a: &mut [C64], columns: usize, k: usize, row: usize) {
    if k != row {
        let (low, high) = (k.min(row), k.max(row));
        let (above, below) = a.split_at_mut(high * columns);
        above[low * columns..(low + 1) * columns].swap_with_slice(&mut below[..columns]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CMat, solve_complex};
    use super::*;

    /// Products and solutions of well-conditioned matrices of order 9 round to a few units in the last place.
    const ROUNDING: f64 = 1e-13;
    const N: usize = 9;

    fn value(i: usize, j: usize) -> C64 {
        C64::new(((7 * i + 3 * j + i * j) % 11) as f64 - 5.0, ((5 * i + 2 * j * j) % 13) as f64 - 6.0)
    }

    fn flat(m: &CMat) -> Vec<C64> {
        (0..m.nrows() * m.ncols()).map(|k| m[(k / m.ncols(), k % m.ncols())]).collect()
    }

    fn assert_close(found: &[C64], expected: &CMat) {
        let scale = expected.norm_max();
        for (f, e) in found.iter().zip(flat(expected)) {
            assert!((f - e).norm() < ROUNDING * scale, "{f} {e}");
        }
    }

    /// A zero in the corner, so that rows must be swapped.
    #[test]
    fn both_solves_are_faers() {
        let a = CMat::from_fn(N, N, |i, j| if i + j == 0 { ZERO } else { value(i, j) });
        let b = CMat::from_fn(N, 4, |i, j| value(i + 3, j + 2));
        let (mut factors, mut pivots) = (flat(&a), [0; N]);
        assert!(lu(&mut factors, &mut pivots));
        let mut x = flat(&b);
        lu_solve(&factors, &pivots, &mut x, 4);
        assert_close(&x, &solve_complex(&a, &b).unwrap());
        let mut x = flat(&b);
        lu_solve_transposed(&factors, &pivots, &mut x, 4);
        assert_close(&x, &solve_complex(&a.transpose().to_owned(), &b).unwrap());
    }

    #[test]
    fn the_inverse_factor_is_faers_and_what_has_none_is_refused() {
        let g = CMat::from_fn(N, N, value);
        let a = &g * g.adjoint() + CMat::identity(N, N);
        let mut l = flat(&a);
        assert!(cholesky(&mut l, N));
        let mut inverse = vec![ZERO; N * N];
        lower_inverse(&l, &mut inverse, N);
        let mut expected = CMat::identity(N, N);
        a.llt(faer::Side::Lower).unwrap().L().solve_lower_triangular_in_place(expected.as_mut());
        assert_close(&inverse, &expected);
        let mut indefinite = flat(&CMat::from_fn(2, 2, |i, j| C64::new(if i == j { 1.0 } else { 2.0 }, 0.0)));
        assert!(!cholesky(&mut indefinite, 2));
        assert!(!lu(&mut [ZERO; 4], &mut [0; 2]));
    }

    #[test]
    fn products_are_faers() {
        let (a, b) = (CMat::from_fn(3, 5, value), CMat::from_fn(5, 4, |i, j| value(j, i + 1)));
        let mut out = [ZERO; 12];
        product(&mut out, [3, 5, 4], |i, j| a[(i, j)].conj(), &flat(&b));
        assert_close(&out, &(a.conjugate() * &b));
        let real: Vec<f64> = (0..15).map(|k| value(k / 5, k % 5).re).collect();
        real_product(&mut out, [3, 5, 4], &real, &flat(&b));
        assert_close(&out, &(CMat::from_fn(3, 5, |i, j| C64::new(real[i * 5 + j], 0.0)) * &b));
    }
}
