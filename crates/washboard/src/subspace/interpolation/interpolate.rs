//! Algorithm 3.1.1: the function of least order through the data.

use super::super::SubspaceError;
use super::basis::Kind;
use super::conditions::{Condition, conditions};
use super::data::{Domain, InterpolationData, Point};
use super::evaluate::Realisation;
use super::plane::Mobius;
use super::projection::{Range, columns};
use super::realise::{inputs, poles};
use crate::linalg::Mat;
use crate::lti::StateSpace;

/// Singular values below this share of the largest are rounding of exact data.
pub(super) const ROUNDING: f64 = 1e-12;
/// An interpolant meets its data to this.
const MEETS: f64 = 1e-6;

/// A rational function and what shows that it is the one.
#[derive(Debug, Clone)]
pub struct Interpolant {
    /// A, B, C, D: discrete for the disk, continuous for the half plane.
    pub system: Realisation,
    /// n.
    pub order: usize,
    /// Of R₂₂ of (3.46) in orthogonal polynomials, or of the Löwner matrix; n of them stand out.
    pub singular_values: Vec<f64>,
    /// The largest error at any node or constraint, recomputed from A, B, C, D; over the largest value of the same derivative.
    pub max_error: f64,
    /// Whether its poles are where the domain has them.
    pub stable: bool,
}

impl Interpolant {
    /// Whether all data are met, to 1e-6 of their size.
    #[must_use]
    pub fn meets_its_data(&self) -> bool {
        self.max_error <= MEETS
    }

    pub(super) fn new(
        data: &InterpolationData,
        map: Mobius,
        abcd: [&Mat; 4],
        singular_values: Vec<f64>,
    ) -> Result<Self, SubspaceError> {
        let order = abcd[0].nrows();
        let [a, b, c, d] = map.system_back(abcd)?;
        let system = match data.domain {
            Domain::Disk => Realisation::Discrete(StateSpace::discrete(a, b, c, d, 1.0)?),
            Domain::HalfPlane { .. } => Realisation::Continuous(StateSpace::continuous(a, b, c, d)?),
        };
        let max_error = system.max_error(data)?;
        let stable = system.is_stable()?;
        Ok(Interpolant { system, order, singular_values, max_error, stable })
    }
}

/// The minimal interpolant: G of least order n with the given values and derivatives.
///
/// With q block rows and N real conditions a column (a conjugate pair counts 2, a real node 1, a derivative each), data
/// of a system of order n give it back if N ≥ q + n and q > n; with more than one input less may do, and the rank decides.
/// Data of the left alone are those of Gᵀ; where left and right directions mix, the Löwner matrix is used ([`super::loewner`]).
///
/// | what | is |
/// |---|---|
/// | `order` | n; none: the rank of exact data, singular values above 1e-12 of the largest |
///
/// # Errors
/// As [`InterpolationData::new`]; too little data, with the rank that is missing; an order above the data's; an interpolant
/// that is not proper; a pole at a node.
///
/// An interpolant that is not stable, or of an order too low to meet the data, is returned: `stable`, `max_error`.
///
/// Polynomials are orthogonal over the nodes rather than powers, and coefficients are Taylor's: the range is the same, and high
/// orders keep their digits.
///
/// Source: Türkay's thesis, algorithm 3.1.1, theorem 3.1.1; (3.43) with each conjugate pair counted once.
///
/// ```
/// use washboard::linalg::{C64, CMat};
/// use washboard::subspace::{Domain, InterpolationData, Node, interpolate};
/// // 1/(z − 1/2) at 1, 2 and 3
/// let value = |z: f64| CMat::from_fn(1, 1, |_, _| C64::new(1.0 / (z - 0.5), 0.0));
/// let nodes = [1.0, 2.0, 3.0].map(|z| Node::full(C64::new(z, 0.0), vec![value(z)]));
/// let found = interpolate(&InterpolationData::new(Domain::Disk, nodes.into())?, None)?;
/// assert_eq!(found.order, 1);
/// assert!((found.system.matrices()[0][(0, 0)] - 0.5).abs() < 1e-12 && found.max_error < 1e-12);
/// # Ok::<(), washboard::subspace::SubspaceError>(())
/// ```
pub fn interpolate(data: &InterpolationData, order: Option<usize>) -> Result<Interpolant, SubspaceError> {
    data.check()?;
    anywhere(data, order)
}

/// The same for nodes anywhere.
pub(super) fn anywhere(data: &InterpolationData, order: Option<usize>) -> Result<Interpolant, SubspaceError> {
    let size = (data.outputs, data.inputs);
    let points: Vec<Point> = data.nodes.iter().map(|n| n.z).collect();
    let map = Mobius::to_work(data.domain, &points);
    let all = conditions(map, &data.nodes, size);
    if all.iter().any(|c| !c.whole[0]) && all.iter().any(|c| !c.whole[1]) {
        return super::loewner::mixed(data, map, &all, order);
    }
    let (a, b, c, d, singular_values) = if all.iter().any(|c| !c.whole[0]) {
        let turned: Vec<Condition> = all.iter().map(Condition::transposed).collect();
        let (a, b, c, d, s) = realised(&turned, (size.1, size.0), order)?;
        let turn = |m: Mat| m.transpose().to_owned();
        (turn(a), turn(c), turn(b), turn(d), s)
    } else {
        realised(&all, size, order)?
    };
    Interpolant::new(data, map, [&a, &b, &c, &d], singular_values)
}

type Realised = (Mat, Mat, Mat, Mat, Vec<f64>);

/// In the plane of work, from conditions on all rows.
fn realised(
    all: &[Condition],
    (p, m): (usize, usize),
    order: Option<usize>,
) -> Result<Realised, SubspaceError> {
    let range = enough(all, (p, m), order)?;
    let n = order.unwrap_or_else(|| rank(&range.singular_values));
    let (a, c) = poles(&range, p, n);
    let (b, d) = inputs(all, &[], (&a, &c), m)?;
    Ok((a, b, c, d, range.singular_values))
}

pub(super) fn rank(singular_values: &[f64]) -> usize {
    let largest = singular_values.first().copied().unwrap_or(0.0);
    singular_values.iter().filter(|s| **s > ROUNDING * largest).count()
}

/// A range that shows the order: with as many block rows as data allow for any system, else with those that show most.
fn enough(all: &[Condition], (p, m): (usize, usize), order: Option<usize>) -> Result<Range, SubspaceError> {
    let total = columns(all);
    let most = |q: usize| (p * (q - 1)).min(total.saturating_sub(q * m));
    let highest = (total / m).max(1);
    // N = 2q − 1 or 2q: order q − 1 is shown for any system, and order q by a rank of q
    let even = highest.div_ceil(2).max(1);
    let best = (1..=highest).fold(even, |best, q| if most(q) > most(best) { q } else { best });
    let mut shown = (0, 0);
    for q in [even, best] {
        let range = Range::new(all, (p, m), q, Kind::Orthogonal)?;
        let q = range.basis.len();
        let rank = rank(&range.singular_values);
        let sure = rank < q && total >= (q + rank) * m;
        let seen = rank < range.singular_values.len() && rank <= p * (q - 1);
        match order {
            Some(n) if n <= most(q) && (n <= rank || !(sure || seen)) => return Ok(range),
            Some(n) if n > rank && (sure || seen) => {
                return Err(SubspaceError::OrderAboveRank { order: n, rank });
            }
            None if sure || seen => return Ok(range),
            _ => shown = (rank.max(shown.0), most(q).max(shown.1)),
        }
    }
    let (rank, most) = shown;
    let missing = order.map_or(1, |n| n.saturating_sub(most)).max(1);
    Err(SubspaceError::TooLittleData { rank, most, missing })
}
