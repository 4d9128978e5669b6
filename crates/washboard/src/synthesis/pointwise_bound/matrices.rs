//! Several controls or disturbances: a semidefinite program, and the bound that its dual solution proves.

use super::terms::{Term, singular};
use crate::linalg::{C64, CMat, Mat};
use crate::optimize::{Block, Sdp, SdpError, SdpSettings, Status};

/// Of numbers as they are: rounding in sums of some tens of terms.
const LEAST_DOUBT: f64 = 1e-14;
/// Directions of the control count as reached above this share of the most.
const REACHED: f64 = 1e-8;
/// Projections onto the dual condition: the second takes away the rounding of the first.
const PROJECTIONS: usize = 2;

/// A lower bound of the least largest goal under the bounds, V being nu × `nw`; `None` where none is proven.
///
/// min t subject to [sI, M; Mᴴ, sI] ⪰ 0 for M = A + B V, s = t for goals and 1 for bounds, as real matrices of twice the size.
///
/// `doubt` is the relative error of A and B.
pub(super) fn proven_level(terms: &[Term], nw: usize, doubt: f64) -> Result<Option<f64>, SdpError> {
    let nu = terms.first().map_or(0, |t| t.b.ncols());
    // V in units of what the control reaches
    let reach = terms.iter().map(|t| largest(&t.b)).fold(0.0, f64::max);
    if reach == 0.0 {
        let fixed =
            terms.iter().map(|t| singular(&t.a).and_then(|s| s.first().copied()).map(|s| (s, t.goal)));
        let Some(fixed) = fixed.collect::<Option<Vec<_>>>() else { return Ok(None) };
        if fixed.iter().any(|(s, goal)| !goal && *s > 1.0) {
            return Ok(None);
        }
        return Ok(Some(fixed.iter().filter(|f| f.1).map(|f| f.0).fold(0.0, f64::max)));
    }
    let scaled: Vec<Term> = terms
        .iter()
        .map(|t| Term { b: &t.b * faer::Scale(C64::new(1.0 / reach, 0.0)), ..t.clone() })
        .collect();
    let mut objective = vec![0.0; 1 + 2 * nu * nw];
    objective[0] = 1.0;
    // the dual proves what it proves, however far the search came
    let settings = SdpSettings { double_double: false, ..SdpSettings::default() };
    let outcome = Sdp::new(objective, scaled.iter().map(|t| block(t, nu)).collect())?.solve(&settings);
    if outcome.status == Status::Infeasible {
        return Ok(None);
    }
    let duals = scaled.iter().zip(&outcome.multiplier).map(|(t, z)| dual(t, z)).collect();
    Ok(certified(&scaled, duals, nw, doubt))
}

fn largest(m: &CMat) -> f64 {
    (0..m.ncols()).flat_map(|j| (0..m.nrows()).map(move |i| m[(i, j)].norm())).fold(0.0, f64::max)
}

/// The four places of M_ij's real part, real part, −imaginary part, imaginary part in the real matrix.
fn places(t: &Term, i: usize, j: usize) -> [(usize, usize); 4] {
    let (p, n) = (t.a.nrows(), t.a.nrows() + t.a.ncols());
    [(i, p + j), (n + i, n + p + j), (i, n + p + j), (p + j, n + i)]
}

fn block(t: &Term, nu: usize) -> Block {
    let n = 2 * (t.a.nrows() + t.a.ncols());
    let mut constant = if t.goal { Mat::zeros(n, n) } else { Mat::identity(n, n) };
    let mut entries: Vec<(usize, usize, usize, f64)> = Vec::new();
    if t.goal {
        entries.extend((0..n).map(|i| (0, i, i, 1.0)));
    }
    for i in 0..t.a.nrows() {
        for (j, column) in t.columns.iter().enumerate() {
            let at = places(t, i, j);
            let values = |m: C64| [m.re, m.re, -m.im, m.im];
            for ((r, c), v) in at.into_iter().zip(values(t.a[(i, j)])) {
                constant[(r, c)] = v;
                constant[(c, r)] = v;
            }
            for k in 0..nu {
                let first = 1 + 2 * (column * nu + k);
                for (variable, part) in [(first, t.b[(i, k)]), (first + 1, t.b[(i, k)] * C64::new(0.0, 1.0))]
                {
                    entries.extend(at.into_iter().zip(values(part)).map(|((r, c), v)| (variable, r, c, v)));
                }
            }
        }
    }
    Block::from_entries(constant, &entries)
}

/// −Z₁₂ of the complex multiplier: σ̄(M) ‖Z‖_* ≥ Re⟨Z, M⟩.
fn dual(t: &Term, z: &Mat) -> CMat {
    CMat::from_fn(t.a.nrows(), t.a.ncols(), |i, j| {
        let (p, n) = (t.a.nrows(), t.a.nrows() + t.a.ncols());
        let re = z[(i, p + j)] + z[(n + i, n + p + j)];
        let im = z[(n + i, p + j)] - z[(i, n + p + j)];
        C64::new(-re, -im)
    })
}

/// What Z_i prove once Σ B_iᴴ Z_i = 0 in every column of V.
///
/// A and B are known to `doubt` only: (‖A‖ + ‖B‖ |V|)‖Z‖ times that is taken off, for every V that keeps all terms at the
/// level that V = 0 has; a larger V can't be better. |V| by the least singular value of all B that is not 0.
fn certified(terms: &[Term], mut duals: Vec<CMat>, nw: usize, doubt: f64) -> Option<f64> {
    let mut left = 0.0;
    for column in 0..nw {
        // rows of all targets that have this column
        let mut rows: Vec<(usize, usize, usize)> = Vec::new();
        for (k, t) in terms.iter().enumerate() {
            for (j, _) in t.columns.iter().enumerate().filter(|(_, c)| **c == column) {
                rows.extend((0..t.a.nrows()).map(|i| (k, i, j)));
            }
        }
        if rows.is_empty() {
            continue;
        }
        let b =
            CMat::from_fn(rows.len(), terms.first()?.b.ncols(), |r, k| terms[rows[r].0].b[(rows[r].1, k)]);
        let q = range(&b)?;
        let take =
            |duals: &[CMat]| CMat::from_fn(rows.len(), 1, |r, _| duals[rows[r].0][(rows[r].1, rows[r].2)]);
        for _ in 0..PROJECTIONS {
            let z = take(&duals);
            let along = &q * (q.adjoint() * &z);
            for (r, (k, i, j)) in rows.iter().enumerate() {
                duals[*k][(*i, *j)] -= along[(r, 0)];
            }
        }
        left += frobenius(&(b.adjoint() * take(&duals))).powi(2);
    }
    // where next to nothing of Z is left, what is left is rounding
    let control = largest_control(terms)?;
    let (mut gain, mut weight, mut lost) = (0.0, 0.0, left.sqrt() * control);
    for (t, z) in terms.iter().zip(&duals) {
        let nuclear: f64 = singular(z)?.iter().sum();
        for j in 0..z.ncols() {
            gain += (0..z.nrows()).map(|i| (z[(i, j)].conj() * t.a[(i, j)]).re).sum::<f64>();
        }
        lost += doubt.max(LEAST_DOUBT) * nuclear * (frobenius(&t.a) + frobenius(&t.b) * control + 1.0);
        if t.goal { weight += nuclear } else { gain -= nuclear }
    }
    let level = (gain - lost) / weight;
    // no less than 0 is always true
    level.is_finite().then_some(level.max(0.0))
}

/// An orthonormal basis of what B reaches.
fn range(b: &CMat) -> Option<CMat> {
    let svd = b.thin_svd().ok()?;
    let (u, s) = (svd.U(), svd.S().column_vector());
    let most = if s.nrows() > 0 { s[0].re } else { 0.0 };
    let count = (0..s.nrows()).filter(|k| s[*k].re > REACHED * most).count();
    Some(CMat::from_fn(b.nrows(), count, |i, j| u[(i, j)]))
}

fn frobenius(m: &CMat) -> f64 {
    (0..m.ncols()).flat_map(|j| (0..m.nrows()).map(move |i| m[(i, j)].norm_sqr())).sum::<f64>().sqrt()
}

/// ‖V‖ at most of a V that makes no term larger than the largest of all is without it.
fn largest_control(terms: &[Term]) -> Option<f64> {
    let rows: usize = terms.iter().map(|t| t.b.nrows()).sum();
    let nu = terms.first()?.b.ncols();
    let of: Vec<(usize, usize)> =
        terms.iter().enumerate().flat_map(|(k, t)| (0..t.b.nrows()).map(move |i| (k, i))).collect();
    let all = CMat::from_fn(rows, nu, |r, k| terms[of[r].0].b[(of[r].1, k)]);
    let values = singular(&all)?;
    let most = values.first().copied()?;
    let least = values.iter().copied().filter(|s| *s > REACHED * most).fold(f64::INFINITY, f64::min);
    let without = terms.iter().map(|t| frobenius(&t.a)).fold(1.0, f64::max);
    Some(2.0 * without * (terms.len() as f64).sqrt() / least)
}
