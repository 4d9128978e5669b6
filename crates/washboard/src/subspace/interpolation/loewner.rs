//! The Löwner matrix: the same functions by divided differences, a second route, and the one for data of both sides.

use super::super::SubspaceError;
use super::conditions::{Condition, conditions};
use super::data::{InterpolationData, Point};
use super::interpolate::{Interpolant, Route, candidates, least_that_meets, rank};
use super::plane::Mobius;
use crate::linalg::{C64, CMat, LinalgError, Mat};

/// Directions of the four matrices that no equation sees, as a share of the largest.
const UNSEEN: f64 = 1e-13;

/// The minimal interpolant by the Löwner matrix 𝕃 of divided differences (v G(x) u − v G(y) u)/(x − y) at left nodes x and
/// right nodes y, derivatives where they are one node.
///
/// 𝕃 = −𝒪 𝓡 with v C(x − A)⁻¹ in the rows of 𝒪 and (y − A)⁻¹B u in the columns of 𝓡: its rank is the order, its singular
/// value decomposition gives 𝒪 and 𝓡, and \[A B; C D\] solves \[A B; C D\]\[𝓡; U\] = \[𝓡Λ; W\] and
/// \[𝒪 V\]\[A B; C D\] = \[M𝒪 W'\] in least squares. Coefficients of a full node are dealt to both sides in turn.
///
/// # Errors
/// As [`interpolate`](super::interpolate); too little data where the rank is as high as 𝕃 can have and some entry of the
/// four matrices is not determined.
///
/// Source: Türkay's thesis, §3.1.5; Antoulas and Anderson (1986); Mayo and Antoulas (2007).
pub fn loewner(data: &InterpolationData, order: Option<usize>) -> Result<Interpolant, SubspaceError> {
    data.check()?;
    let points: Vec<Point> = data.nodes.iter().map(|n| n.z).collect();
    let map = Mobius::to_work(data.domain, &points);
    let all = conditions(map, &data.nodes, (data.outputs, data.inputs));
    let found = Factored::new(&all, (data.outputs, data.inputs))?;
    let abcd = found.realised(order.unwrap_or_else(|| rank(&found.values)))?;
    Interpolant::new(data, map, abcd.each_ref(), found.values)
}

/// The same for [`interpolate`](super::interpolate), polished; with the residual.
pub(super) fn polished_route(
    all: &[Condition],
    size: (usize, usize),
    order: Option<usize>,
) -> Result<Route, SubspaceError> {
    let found = Factored::new(all, size)?;
    let orders = order.map_or_else(|| candidates(&found.values, rank(&found.values)), |n| vec![n]);
    let (off, abcd) = least_that_meets(all, &orders, |n| found.realised(n))?;
    Ok(Route { off, abcd, singular_values: found.values })
}

/// One side of the data: coefficients of x(w) = (w − A)⁻¹B u, or of its dual, at one node.
struct Chain<'a> {
    of: &'a Condition,
    count: usize,
}

/// 𝕃 = U Σ Vᵀ with the conditions of its rows and columns.
struct Factored<'a> {
    left: Vec<Chain<'a>>,
    right: Vec<Chain<'a>>,
    u: Mat,
    v: Mat,
    values: Vec<f64>,
    size: (usize, usize),
}

impl<'a> Factored<'a> {
    fn new(all: &'a [Condition], size: (usize, usize)) -> Result<Self, SubspaceError> {
        let (left, right) = dealt(all);
        let l = real_rows(&left, &right);
        let svd = l.thin_svd().map_err(|_| svd_failed(l.nrows()))?;
        let values: Vec<f64> = (0..l.nrows().min(l.ncols())).map(|i| svd.S()[i]).collect();
        Ok(Factored { u: svd.U().to_owned(), v: svd.V().to_owned(), left, right, values, size })
    }

    /// A, B, C, D of order n.
    fn realised(&self, n: usize) -> Result<[Mat; 4], SubspaceError> {
        let (p, m) = self.size;
        let most = self.values.len();
        if n > most {
            return Err(SubspaceError::TooLittleData { rank: rank(&self.values), most, missing: n - most });
        }
        let root: Vec<f64> = self.values[..n].iter().map(|s| s.sqrt()).collect();
        // 𝕃 = −𝒪 𝓡
        let o = Mat::from_fn(self.u.nrows(), n, |i, j| -self.u[(i, j)] * root[j]);
        let r = Mat::from_fn(self.v.nrows(), n, |i, j| self.v[(i, j)] * root[j]);
        let columns = side(&self.right, |c| c.clone(), r, m, p);
        let rows = side(&self.left, Condition::transposed, o, p, m);
        // Θ = [A B; C D]: Θ R = K, L Θ = J
        let turn = |x: &Mat| x.transpose().to_owned();
        let theta = both_sides(&turn(&columns.0), &turn(&columns.1), &rows.0, &rows.1)?;
        let part = |i: usize, j: usize, r: usize, c: usize| theta.submatrix(i, j, r, c).to_owned();
        Ok([part(0, 0, n, n), part(0, n, n, m), part(n, 0, p, n), part(n, n, p, m)])
    }
}

fn svd_failed(order: usize) -> LinalgError {
    LinalgError::NoConvergence { what: "the SVD", order }
}

/// Coefficients of each condition to the left and to the right; a whole one to both, the longer half in turn.
fn dealt(all: &[Condition]) -> (Vec<Chain<'_>>, Vec<Chain<'_>>) {
    let (mut left, mut right) = (Vec::new(), Vec::new());
    let (mut rows, mut columns) = (0, 0);
    for of in all {
        let count = of.series.len();
        let (a, b) = match of.whole {
            [true, true] if rows <= columns => (count.div_ceil(2), count / 2),
            [true, true] => (count / 2, count.div_ceil(2)),
            [true, false] => (0, count),
            _ => (count, 0),
        };
        rows += a * of.parts();
        columns += b * of.parts();
        if a > 0 {
            left.push(Chain { of, count: a });
        }
        if b > 0 {
            right.push(Chain { of, count: b });
        }
    }
    // at one node from both sides the mixed difference is a derivative that may not be known: the right then is not asked
    let known = |r: &Chain| {
        left.iter().all(|l| l.of.w != r.of.w || l.count + r.count <= l.of.series.len().max(r.of.series.len()))
    };
    right.retain(known);
    (left, right)
}

/// Coefficients (i, j) of v (G(x) − G(y)) u/(x − y) about two nodes; `conjugate`: the right one's mirror image.
fn differences(l: &Chain, r: &Chain, conjugate: bool) -> Vec<Vec<CMat>> {
    let turn = |m: &CMat| {
        if conjugate { CMat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)].conj()) } else { m.clone() }
    };
    let (y, u) = (if conjugate { r.of.w.conj() } else { r.of.w }, turn(&r.of.right));
    let of_left = |k: usize| &l.of.series[k] * &u;
    let of_right = |k: usize| &l.of.left * turn(&r.of.series[k]);
    let mut all: Vec<Vec<CMat>> = Vec::with_capacity(l.count);
    for i in 0..l.count {
        let mut row: Vec<CMat> = Vec::with_capacity(r.count);
        for j in 0..r.count {
            let value = if l.of.w == y {
                let k = i + j + 1;
                if k < l.of.series.len() { of_left(k) } else { of_right(k) }
            } else {
                // (x − y) L = v G(x) u − v G(y) u, coefficient by coefficient
                let mut sum = CMat::zeros(l.of.left.nrows(), u.ncols());
                if j == 0 {
                    sum += of_left(i);
                } else {
                    sum += &row[j - 1];
                }
                if i == 0 {
                    sum -= of_right(j);
                } else {
                    sum -= &all[i - 1][j];
                }
                sum * faer::Scale(C64::new(1.0, 0.0) / (l.of.w - y))
            };
            row.push(value);
        }
        all.push(row);
    }
    all
}

/// Real and imaginary parts of coefficients over x and over y: 𝕃, real.
fn real_rows(left: &[Chain], right: &[Chain]) -> Mat {
    let count = |side: &[Chain], width: &dyn Fn(&Condition) -> usize| -> usize {
        side.iter().map(|c| c.count * width(c.of) * c.of.parts()).sum()
    };
    let rows = count(left, &|c| c.left.nrows());
    let columns = count(right, &|c| c.right.ncols());
    let mut l = Mat::zeros(rows, columns);
    let mut row = 0;
    for x in left {
        let height = x.of.left.nrows() * x.of.parts();
        let mut column = 0;
        for y in right {
            let width = y.of.right.ncols() * y.of.parts();
            let (plain, mirrored) = (differences(x, y, false), differences(x, y, true));
            for i in 0..x.count {
                for j in 0..y.count {
                    let (f, g) = (&plain[i][j], &mirrored[i][j]);
                    for a in 0..x.of.left.nrows() {
                        for b in 0..y.of.right.ncols() {
                            // over Re x(y) = (x(y) + x(ȳ))/2 and Im x(y) = (x(y) − x(ȳ))/2i
                            let (f, g) = (f[(a, b)], g[(a, b)]);
                            let re = (f + g) * 0.5;
                            let im = (f - g) * C64::new(0.0, -0.5);
                            let (r, c) =
                                (row + i * height + a * x.of.parts(), column + j * width + b * y.of.parts());
                            l[(r, c)] = re.re;
                            if !x.of.real {
                                l[(r + 1, c)] = re.im;
                            }
                            if !y.of.real {
                                l[(r, c + 1)] = im.re;
                            }
                            if !(x.of.real || y.of.real) {
                                l[(r + 1, c + 1)] = im.im;
                            }
                        }
                    }
                }
            }
            column += y.count * width;
        }
        row += x.count * height;
    }
    l
}

/// Rows [xᵀ uᵀ] and [(w x)ᵀ (G u)ᵀ] of one side's coefficients, x a row of `states` each.
fn side(
    chains: &[Chain],
    turned: impl Fn(&Condition) -> Condition,
    states: Mat,
    m: usize,
    p: usize,
) -> (Mat, Mat) {
    let (count, n) = (states.nrows(), states.ncols());
    let (mut known, mut wanted) = (Mat::zeros(count, n + m), Mat::zeros(count, n + p));
    let mut row = 0;
    for chain in chains {
        let c = turned(chain.of);
        let (parts, width) = (c.parts(), c.right.ncols());
        for l in 0..chain.count {
            for b in 0..width {
                let put = |to: &mut Mat, at: usize, x: C64| {
                    to[(row, at)] = x.re;
                    if !c.real {
                        to[(row + 1, at)] = x.im;
                    }
                };
                let x = |at: usize, k: usize| {
                    C64::new(states[(at, k)], if c.real { 0.0 } else { states[(at + 1, k)] })
                };
                for k in 0..n {
                    put(&mut known, k, x(row, k));
                    // (w₀ + τ) x: coefficient l is w₀ x_l + x_{l−1}
                    let before = if l > 0 { x(row - width * parts, k) } else { C64::new(0.0, 0.0) };
                    put(&mut wanted, k, c.w * x(row, k) + before);
                }
                if l == 0 {
                    (0..m).for_each(|y| put(&mut known, n + y, c.right[(y, b)]));
                }
                (0..p).for_each(|a| put(&mut wanted, n + a, c.series[l][(a, b)]));
                row += parts;
            }
        }
    }
    (known, wanted)
}

/// Θ of Θ R = K and L Θ = J in least squares: entry by entry between the singular vectors of L and of R.
fn both_sides(r: &Mat, k: &Mat, l: &Mat, j: &Mat) -> Result<Mat, SubspaceError> {
    let (rows, columns) = (l.ncols(), r.nrows());
    let (of_l, of_r) = (l.svd(), r.svd());
    let of_l = of_l.map_err(|_| svd_failed(rows))?;
    let of_r = of_r.map_err(|_| svd_failed(columns))?;
    // L = U S Vᵀ of its rows, R = X T Zᵀ of its columns
    let from_j = of_l.U().transpose() * j * of_r.U();
    let from_k = of_l.V().transpose() * k * of_r.V();
    let size = |s: faer::diag::DiagRef<'_, f64>, i: usize, most: usize| if i < most { s[i] } else { 0.0 };
    let least = l.nrows().min(rows);
    let least_r = r.ncols().min(columns);
    let largest = size(of_l.S(), 0, least).max(size(of_r.S(), 0, least_r));
    let mut unseen = 0;
    let inner = Mat::from_fn(rows, columns, |x, y| {
        let (s, t) = (size(of_l.S(), x, least), size(of_r.S(), y, least_r));
        if !(s.max(t) > UNSEEN * largest) {
            unseen += 1;
            return 0.0;
        }
        let above = s * if x < least { from_j[(x, y)] } else { 0.0 }
            + t * if y < least_r { from_k[(x, y)] } else { 0.0 };
        above / (s * s + t * t)
    });
    if unseen > 0 {
        let unknowns = rows * columns;
        return Err(SubspaceError::MissingRank { unknowns, rank: unknowns - unseen });
    }
    Ok(of_l.V() * inner * of_r.U().transpose())
}
