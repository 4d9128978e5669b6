//! A unimodular Π that leaves one entry of a row of polynomials: (4.34)–(4.35) for any number of measurements.

use crate::lti::Polynomial;

/// row·Π = [0 … 0 g].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unimodular {
    /// Π, by rows; its determinant is ±1.
    pub pi: Vec<Vec<Polynomial>>,
    /// g: a greatest common divisor of the row.
    pub g: Polynomial,
}

/// Elementary column operations (Euclid's algorithm) that leave the greatest common divisor in the last place.
///
/// For the two measurements of (4.10), n = [s²(c_s s + k_s)(c_t s + k_t), −m_s s²(c_t s + k_t)], it is (4.34):
/// Π = [1 0; (c_s s + k_s)/m_s 1] and g = −m_s s²(c_t s + k_t).
///
/// ```
/// use washboard::lti::Polynomial;
/// use washboard::synthesis::achievable::unimodular;
/// // [s(s + 1), s] → [0, s]
/// let p = |c: &[i64]| Polynomial::integers(c);
/// let found = unimodular(&[p(&[0, 1, 1]), p(&[0, 1])]);
/// assert_eq!(found.g, p(&[0, 1]));
/// assert_eq!(found.pi[1][0], p(&[-1, -1]));
/// ```
#[must_use]
pub fn unimodular(row: &[Polynomial]) -> Unimodular {
    let n = row.len();
    let mut row = row.to_vec();
    let one = |i: usize, j: usize| if i == j { Polynomial::one() } else { Polynomial::zero() };
    let mut pi: Vec<Vec<Polynomial>> = (0..n).map(|i| (0..n).map(|j| one(i, j)).collect()).collect();
    // the entry of least degree divides the others
    while let Some(pivot) = (0..n).rev().filter(|j| !row[*j].is_zero()).min_by_key(|j| row[*j].degree()) {
        let others: Vec<usize> = (0..n).filter(|j| *j != pivot && !row[*j].is_zero()).collect();
        if others.is_empty() {
            row.swap(pivot, n - 1);
            for line in &mut pi {
                line.swap(pivot, n - 1);
            }
            break;
        }
        for j in others {
            let Ok((q, r)) = row[j].divided_by(&row[pivot]) else { continue };
            for line in &mut pi {
                line[j] = &line[j] - &(&q * &line[pivot]);
            }
            row[j] = r;
        }
    }
    let g = row.pop().unwrap_or_else(Polynomial::zero);
    Unimodular { pi, g }
}
