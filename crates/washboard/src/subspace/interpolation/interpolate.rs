//! Algorithm 3.1.1: the function of least order through the data.

use super::super::SubspaceError;
use super::conditions::{Condition, conditions};
use super::data::{Domain, InterpolationData, Point};
use super::evaluate::Realisation;
use super::loewner::polished_route;
use super::plane::Mobius;
use super::polish::{polished, residual};
use super::projection::{Range, columns};
use super::realise::{inputs, poles};
use crate::linalg::{C64, Mat};
use crate::lti::StateSpace;

/// Rounding of exact data is below this share of the largest singular value, however derivatives amplify it.
const SMALL: f64 = 1e-8;
/// No gap ends lower than this share.
const FLOOR: f64 = 1e-16;
/// An interpolant meets its data to this.
const MEETS: f64 = 1e-6;
/// A realisation that leaves this share of the data's norm meets them; rounding leaves less.
const MET: f64 = 1e-12;
/// An order that leaves no more than this many times what the best one leaves is as good: the rest is noise.
const NEAR: f64 = 1e3;
/// Singular values below this share of the data's norm are rounding: the data are those of a constant.
const CONSTANT: f64 = 1e-14;
/// Block rows that are tried first.
const FEW: usize = 64;
/// Directions that are one but for this share.
const PARALLEL: f64 = 1e-12;
/// Orders that are tried beside the rank.
const TRIED: usize = 4;

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
/// | `order` | n; none: the rank of exact data, by the widest gap of the singular values that ends below 1e-8 of the largest |
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
    let sided = |k: usize| all.iter().any(|c| !c.whole[k]);
    let mut found = match (sided(0), sided(1)) {
        (true, true) => polished_route(&all, size, order)?,
        (true, false) => transposed(&all, size, order)?,
        _ => by_range(&all, size, order)?,
    };
    if found.off >= MET && !(sided(0) && sided(1)) {
        // conditions from the other side, or from both, may keep more digits
        let other = if sided(0) || sided(1) { None } else { transposed(&all, size, order).ok() };
        for other in other.into_iter().chain(polished_route(&all, size, order).ok()) {
            if other.off < MET || NEAR * other.off < found.off {
                found = other;
            }
        }
    }
    Interpolant::new(data, map, found.abcd.each_ref(), found.singular_values)
}

/// A realisation in the plane of work, and what it leaves.
pub(super) struct Route {
    pub off: f64,
    pub abcd: [Mat; 4],
    pub singular_values: Vec<f64>,
}

fn transposed(
    all: &[Condition],
    (p, m): (usize, usize),
    order: Option<usize>,
) -> Result<Route, SubspaceError> {
    let turned: Vec<Condition> = all.iter().map(Condition::transposed).collect();
    let mut found = by_range(&turned, (m, p), order)?;
    found.abcd = {
        let [a, b, c, d] = found.abcd.each_ref().map(|m| m.transpose().to_owned());
        [a, c, b, d]
    };
    Ok(found)
}

fn by_range(all: &[Condition], size: (usize, usize), order: Option<usize>) -> Result<Route, SubspaceError> {
    let (range, shown) = enough(all, size, order)?;
    let orders = order.map_or_else(|| candidates(&range.singular_values, shown), |n| vec![n]);
    let (off, abcd) = least_that_meets(all, &orders, |n| realised(all, &range, size, n))?;
    Ok(Route { off, abcd, singular_values: range.singular_values })
}

/// In the plane of work, from conditions on all rows.
fn realised(
    all: &[Condition],
    range: &Range,
    (p, m): (usize, usize),
    n: usize,
) -> Result<[Mat; 4], SubspaceError> {
    let (a, c) = poles(range, p, n)?;
    let (b, d) = inputs(all, &[], (&a, &c), m)?;
    Ok([a, b, c, d])
}

/// The least order whose realisation, polished, meets the conditions; where none does, the least that comes near the best.
pub(super) fn least_that_meets(
    all: &[Condition],
    orders: &[usize],
    realised: impl Fn(usize) -> Result<[Mat; 4], SubspaceError>,
) -> Result<(f64, [Mat; 4]), SubspaceError> {
    let mut tried: Vec<(f64, [Mat; 4])> = Vec::new();
    let mut refused = None;
    for n in orders {
        let found = realised(*n).and_then(|start| {
            let found = polished(all, start)?;
            Ok((residual(all, &found)?, found))
        });
        match found {
            Ok(found) => {
                let met = found.0 < MET;
                tried.push(found);
                if met {
                    break;
                }
            }
            Err(e) => refused = refused.or(Some(e)),
        }
    }
    let best = tried.iter().map(|(off, _)| *off).fold(f64::INFINITY, f64::min);
    match (tried.into_iter().find(|(off, _)| *off <= (NEAR * best).max(MET)), refused) {
        (Some(found), _) => Ok(found),
        (None, Some(e)) => Err(e),
        (None, None) => Err(SubspaceError::TooLittleData { rank: 0, most: 0, missing: 1 }),
    }
}

/// The rank and the other orders that rounding may have hidden, those with the widest gaps; ascending.
pub(super) fn candidates(singular_values: &[f64], rank: usize) -> Vec<usize> {
    let mut all = vec![rank];
    let mut others: Vec<usize> =
        possible(singular_values).filter(|n| *n != rank && *n <= singular_values.len()).collect();
    others.sort_by(|i, j| gap(singular_values, *j).total_cmp(&gap(singular_values, *i)));
    all.extend(others.into_iter().take(TRIED));
    all.sort_unstable();
    all
}

/// Orders whose next singular value may be rounding.
fn possible(values: &[f64]) -> impl Iterator<Item = usize> {
    (1..=values.len()).filter(|n| relative(values, *n) < SMALL && relative(values, *n - 1) > FLOOR)
}

/// σ_{k+1}/σ₁, not below the floor.
fn relative(values: &[f64], k: usize) -> f64 {
    values.get(k).map_or(FLOOR, |s| (s / values[0]).max(FLOOR))
}

fn gap(values: &[f64], n: usize) -> f64 {
    relative(values, n - 1) / relative(values, n)
}

/// The number of singular values before the widest gap that ends at what may be rounding, or after all.
pub(super) fn rank(values: &[f64]) -> usize {
    if !values.first().is_some_and(|s| *s > 0.0) {
        return 0;
    }
    possible(values).fold(values.len(), |best, n| if gap(values, n) > gap(values, best) { n } else { best })
}

/// A range that shows the order, and its rank: with as many block rows as data allow for any system, else with those that show most.
fn enough(
    all: &[Condition],
    (p, m): (usize, usize),
    order: Option<usize>,
) -> Result<(Range, usize), SubspaceError> {
    directions(all, m)?;
    let total = columns(all);
    let most = |q: usize| (p * (q - 1)).min(total.saturating_sub(q * m));
    let highest = (total / m).max(1);
    // N = 2q − 1 or 2q: order q − 1 is shown for any system, and order q by a rank of q
    let even = highest.div_ceil(2).max(1);
    let best = (1..=highest).fold(even, |best, q| if most(q) > most(best) { q } else { best });
    let mut shown = (0, 0);
    // few at first: the work grows with q³, and the rank of exact data shows as soon as q is above the order
    let mut rows: Vec<usize> =
        std::iter::successors(Some(FEW), |q| Some(2 * q)).take_while(|q| *q < even).collect();
    rows.extend([even, best]);
    for q in rows {
        let range = Range::explained(all, (p, m), q)?;
        let grows = q < even;
        let q = range.basis.len();
        let constant = !range.singular_values.first().is_some_and(|s| *s > CONSTANT * range.size);
        let rank = if constant { 0 } else { rank(&range.singular_values) };
        if grows && 2 * rank.max(order.unwrap_or(0)) >= q {
            continue;
        }
        let sure = rank < q && total >= (q + rank) * m;
        let seen = rank < range.singular_values.len() && rank <= p * (q - 1);
        match order {
            Some(n) if n <= most(q) && (n <= rank || !(sure || seen)) => return Ok((range, rank)),
            Some(n) if n > rank && rank < most(q) && (sure || seen) => {
                return Err(SubspaceError::OrderAboveRank { order: n, rank });
            }
            None if sure || seen => return Ok((range, rank)),
            _ => shown = (rank.max(shown.0), most(q).max(shown.1)),
        }
    }
    let (rank, most) = shown;
    let missing = order.map_or(1, |n| n.saturating_sub(most)).max(1);
    Err(SubspaceError::TooLittleData { rank, most: most.max(rank), missing })
}

/// Refuses directions that leave an input open.
fn directions(all: &[Condition], m: usize) -> Result<(), SubspaceError> {
    let parts = all.iter().flat_map(|c| {
        (0..c.right.ncols()).flat_map(|j| {
            let part = |f: fn(C64) -> f64| (0..m).map(|i| f(c.right[(i, j)])).collect::<Vec<_>>();
            [part(|x| x.re), part(|x| x.im)]
        })
    });
    let parts: Vec<Vec<f64>> = parts.collect();
    let rank = crate::linalg::rank(&Mat::from_fn(m, parts.len(), |i, j| parts[j][i]), PARALLEL)?;
    if rank < m {
        return Err(SubspaceError::MissingDirections { rank, needed: m });
    }
    Ok(())
}
