//! §3.2: a fit of measured frequency responses with values, zeros and a relative degree that it has exactly.

use super::super::SubspaceError;
use super::basis::Kind;
use super::conditions::conditions;
use super::data::{Domain, InterpolationData, Node, ON_BOUNDARY, Point, check_domain, check_nodes};
use super::interpolate::Interpolant;
use super::plane::Mobius;
use super::projection::{Range, columns};
use super::realise::{inputs, poles};
use crate::linalg::{C64, CMat};

/// Block rows beyond this many times n + 1 cost time and gain little.
const BLOCK_ROWS: usize = 5;

/// A measured value of G.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// z on the unit circle, or s = iω.
    pub z: C64,
    /// p × m.
    pub value: CMat,
    /// E|η|² of each entry's noise, up to a common factor.
    pub variance: f64,
}

/// A model of order n of measured responses that meets its constraints exactly.
///
/// A and C are those of the data by the projection of algorithm 3.1.1, each response over its noise's deviation, in polynomials that are
/// orthonormal over the frequencies, so that the noise of every block row is alike; B and D are weighted least squares on the affine set (3.73)
/// that the constraints leave, found by its null space. With independent noise and distinct frequencies that fill their band the model
/// tends to G with probability one.
///
/// Zeros are [`Node::zero`], a relative degree τ is [`Node::relative_degree`] (Markov parameters j = 0 … τ − 1; the thesis has
/// 1 … τ), the gain at frequency zero [`Node::static_gain`]. `max_error` of the outcome is that of the constraints.
///
/// # Errors
/// Points where G may have poles, shapes, variances that are not positive; an order of 0 or one that the data cannot show;
/// constraints that no B and D meet with the poles found; as [`InterpolationData::new`].
///
/// A model that is not stable is returned: `stable`.
///
/// Source: Türkay's thesis, §3.2, (3.67)–(3.73); McKelvey, Akçay and Ljung (1996), algorithm 2.
pub fn fit_response(
    domain: Domain,
    measured: &[Measured],
    constraints: &[Node],
    order: usize,
) -> Result<Interpolant, SubspaceError> {
    check_domain(domain)?;
    let Some(first) = measured.first() else {
        return Err(SubspaceError::Count { what: "measured values", expected: 1, found: 0 });
    };
    let (p, m) = (first.value.nrows(), first.value.ncols());
    let nodes: Vec<Node> = measured.iter().map(|x| Node::full(x.z, vec![x.value.clone()])).collect();
    check_measured(domain, measured, &nodes, (p, m))?;
    check_nodes(domain, constraints, (p, m))?;
    let points: Vec<Point> = nodes.iter().chain(constraints).map(|n| n.z).collect();
    let map = Mobius::to_work(domain, &points);
    let mut data = Vec::with_capacity(nodes.len());
    for (node, x) in nodes.iter().zip(measured) {
        // one by one: a frequency measured twice is two measurements
        let mut one = conditions(map, std::slice::from_ref(node), (p, m));
        one.iter_mut().for_each(|c| c.weights = vec![x.variance.sqrt().recip()]);
        data.append(&mut one);
    }
    let exact = conditions(map, constraints, (p, m));
    let rows = columns(&data) / m;
    let q = (BLOCK_ROWS * (order + 1)).min(rows.saturating_sub(order));
    let most = (p * q.saturating_sub(1)).min(columns(&data).saturating_sub(q * m));
    if q <= order || most < order {
        let (rank, missing) =
            (most.min(q.saturating_sub(1)), order - most.min(order.min(q.saturating_sub(1))));
        return Err(SubspaceError::TooLittleData { rank, most, missing });
    }
    let range = Range::new(&data, (p, m), q, Kind::White)?;
    let (a, c) = poles(&range, p, order)?;
    let (b, d) = inputs(&data, &exact, (&a, &c), m)?;
    let checked = InterpolationData { domain, outputs: p, inputs: m, nodes: constraints.to_vec() };
    Interpolant::new(&checked, map, [&a, &b, &c, &d], range.singular_values)
}

fn check_measured(
    domain: Domain,
    measured: &[Measured],
    nodes: &[Node],
    size: (usize, usize),
) -> Result<(), SubspaceError> {
    for (index, (x, node)) in measured.iter().zip(nodes).enumerate() {
        if !(x.variance > 0.0 && x.variance.is_finite()) {
            let why = format!("{:e}, expected a finite number above 0", x.variance);
            return Err(SubspaceError::Sample { what: "variance", index, why });
        }
        check_edge(domain, index, x.z)?;
        // noise is no contradiction, and makes a real node's value complex
        let off_axis = |z: C64| if z.im == 0.0 { C64::new(z.re, f64::MIN_POSITIVE) } else { z };
        let alone = Node::full(off_axis(x.z), node.values.clone());
        check_nodes(domain, &[alone], size).map_err(|e| numbered(e, index))?;
    }
    Ok(())
}

/// Refuses a point outside of the region of poles that is not on its edge: measurements are of frequencies. Those inside have words of
/// their own.
fn check_edge(domain: Domain, index: usize, z: C64) -> Result<(), SubspaceError> {
    let (off, limit, edge) = match domain {
        Domain::Disk => (z.norm() - 1.0, ON_BOUNDARY, "the unit circle"),
        Domain::HalfPlane { .. } => (z.re, ON_BOUNDARY * z.norm(), "the imaginary axis"),
    };
    if off > limit {
        let why = format!(
            "{} + {}i is {off:e} off {edge}, expected a point on it (to 1e-12: give all digits); values elsewhere are nodes or constraints",
            z.re, z.im
        );
        return Err(SubspaceError::Sample { what: "measured value", index, why });
    }
    Ok(())
}

/// The same of measured value `to`.
fn numbered(e: SubspaceError, to: usize) -> SubspaceError {
    match e {
        SubspaceError::NodeShape { derivative, expected, found, .. } => {
            SubspaceError::NodeShape { index: to, derivative, expected, found }
        }
        SubspaceError::NodeInside { re, im, inside, region, .. } => {
            let why = format!(
                "{re} + {im}i is {inside:e} inside {region}, expected a point on its edge (to 1e-12: give all digits) or outside"
            );
            SubspaceError::Sample { what: "measured value", index: to, why }
        }
        SubspaceError::Sample { why, .. } => SubspaceError::Sample { what: "measured value", index: to, why },
        other => other,
    }
}
