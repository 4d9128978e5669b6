//! What is to be interpolated: nodes with values and derivatives, in full or in a direction.

use super::super::SubspaceError;
use super::agreement::agree;
use crate::linalg::{C64, CMat};

/// A node may lie this far inside the region of poles: rounding of points of the circle or of the axis.
pub(super) const ON_BOUNDARY: f64 = 1e-12;
/// Values given twice agree to this share of their largest entry, or they contradict each other.
pub(super) const SAME: f64 = 1e-9;

/// A point of the closed plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Point {
    /// z, or s in rad/s.
    Finite(C64),
    /// z = ∞, or s = ∞.
    Infinity,
}

/// Which part of G a node's values are of.
#[derive(Debug, Clone, PartialEq)]
pub enum Side {
    /// G: values are p × m.
    Full,
    /// v G of a row v with p entries: values are 1 × m.
    Left(Vec<C64>),
    /// G u of a column u with m entries: values are p × 1.
    Right(Vec<C64>),
}

/// Where G has no poles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Domain {
    /// On and outside the unit circle, z.
    Disk,
    /// In the closed right half plane, s; carried to the disk by s = λ(z − 1)/(z + 1).
    HalfPlane {
        /// λ, where accuracy is best.
        lambda_rad_s: f64,
    },
}

/// A node with its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Where.
    pub z: Point,
    /// At a finite node derivatives 0, 1, …; at infinity Markov parameters g₀, g₁, …, the coefficients of 1, 1/z, ….
    pub values: Vec<CMat>,
    /// Of which part.
    pub side: Side,
}

impl Node {
    /// G and its derivatives at a finite node.
    #[must_use]
    pub fn full(z: C64, values: Vec<CMat>) -> Self {
        Node { z: Point::Finite(z), values, side: Side::Full }
    }

    /// Markov parameters g₀, g₁, ….
    #[must_use]
    pub fn at_infinity(values: Vec<CMat>) -> Self {
        Node { z: Point::Infinity, values, side: Side::Full }
    }

    /// A zero of a p × m matrix, all entries, of some multiplicity.
    #[must_use]
    pub fn zero(z: C64, multiplicity: usize, (p, m): (usize, usize)) -> Self {
        Self::full(z, vec![CMat::zeros(p, m); multiplicity])
    }

    /// Relative degree τ or more of a p × m matrix: Markov parameters j = 0, …, τ − 1 are zero.
    #[must_use]
    pub fn relative_degree(tau: usize, (p, m): (usize, usize)) -> Self {
        Self::at_infinity(vec![CMat::zeros(p, m); tau])
    }

    /// The gain at frequency zero: z = 1, s = 0.
    #[must_use]
    pub fn static_gain(domain: Domain, value: CMat) -> Self {
        let at = if domain == Domain::Disk { 1.0 } else { 0.0 };
        Self::full(C64::new(at, 0.0), vec![value])
    }
}

/// Nodes of one p × m function.
#[derive(Debug, Clone)]
pub struct InterpolationData {
    /// Where it has no poles.
    pub domain: Domain,
    /// p.
    pub outputs: usize,
    /// m.
    pub inputs: usize,
    /// Distinct or consistent.
    pub nodes: Vec<Node>,
}

impl InterpolationData {
    /// Checked nodes; p and m are those of the first node that shows them.
    ///
    /// A node and its conjugate are one, for G is real; so is a node that is given again.
    ///
    /// # Errors
    /// No nodes; shapes and directions that do not fit, entries that are not finite; nodes where G may have poles; values of a
    /// real node that are not real; values at a node given twice that contradict each other.
    pub fn new(domain: Domain, nodes: Vec<Node>) -> Result<Self, SubspaceError> {
        let (p, m) = size(&nodes)?;
        let data = InterpolationData { domain, outputs: p, inputs: m, nodes };
        data.check()?;
        Ok(data)
    }

    pub(super) fn check(&self) -> Result<(), SubspaceError> {
        check_domain(self.domain)?;
        check_nodes(self.domain, &self.nodes, (self.outputs, self.inputs))
    }
}

/// p and m.
fn size(nodes: &[Node]) -> Result<(usize, usize), SubspaceError> {
    let (mut p, mut m) = (None, None);
    for node in nodes {
        let Some(first) = node.values.first() else { continue };
        match &node.side {
            Side::Full => (p, m) = (p.or(Some(first.nrows())), m.or(Some(first.ncols()))),
            Side::Left(v) => (p, m) = (p.or(Some(v.len())), m.or(Some(first.ncols()))),
            Side::Right(u) => (p, m) = (p.or(Some(first.nrows())), m.or(Some(u.len()))),
        }
    }
    match (p, m) {
        (Some(p), Some(m)) if p > 0 && m > 0 => Ok((p, m)),
        _ => Err(SubspaceError::Count { what: "nodes", expected: 1, found: 0 }),
    }
}

pub(super) fn check_domain(domain: Domain) -> Result<(), SubspaceError> {
    match domain {
        Domain::HalfPlane { lambda_rad_s } if !(lambda_rad_s > 0.0 && lambda_rad_s.is_finite()) => {
            let expected = "a positive, finite number".to_owned();
            Err(SubspaceError::Field { field: "lambda", expected, found: lambda_rad_s.to_string() })
        }
        _ => Ok(()),
    }
}

/// Everything that [`InterpolationData::new`] refuses of nodes.
pub(super) fn check_nodes(
    domain: Domain,
    nodes: &[Node],
    (p, m): (usize, usize),
) -> Result<(), SubspaceError> {
    for (index, node) in nodes.iter().enumerate() {
        check_region(domain, index, node.z)?;
        let expected = match &node.side {
            Side::Full => (p, m),
            Side::Left(v) => {
                direction(index, v, p)?;
                (1, m)
            }
            Side::Right(u) => {
                direction(index, u, m)?;
                (p, 1)
            }
        };
        if node.values.is_empty() {
            return Err(SubspaceError::Sample { what: "node", index, why: "no values".into() });
        }
        for (derivative, value) in node.values.iter().enumerate() {
            let found = (value.nrows(), value.ncols());
            if found != expected {
                return Err(SubspaceError::NodeShape { index, derivative, expected, found });
            }
            if !finite(value) {
                let why = format!("derivative {derivative}: an entry that is not finite");
                return Err(SubspaceError::Sample { what: "node", index, why });
            }
        }
        if is_real(node) {
            for (derivative, value) in node.values.iter().enumerate() {
                let imaginary = largest(value, |x| x.im.abs());
                if imaginary > SAME * largest(value, |x| x.norm()) {
                    return Err(SubspaceError::NotReal { index, derivative, imaginary });
                }
            }
        }
    }
    for (second, b) in nodes.iter().enumerate() {
        for (first, a) in nodes[..second].iter().enumerate() {
            agree(first, a, second, b)?;
        }
    }
    Ok(())
}

fn direction(index: usize, v: &[C64], expected: usize) -> Result<(), SubspaceError> {
    let why = if v.len() != expected {
        format!("a direction of {} entries, expected {expected}", v.len())
    } else if !v.iter().all(|x| x.re.is_finite() && x.im.is_finite()) || v.iter().all(|x| x.norm() == 0.0) {
        "a direction that is zero or not finite".to_owned()
    } else {
        return Ok(());
    };
    Err(SubspaceError::Sample { what: "node", index, why })
}

/// Refuses a point where G may have poles.
pub(super) fn check_region(domain: Domain, index: usize, z: Point) -> Result<(), SubspaceError> {
    let Point::Finite(z) = z else { return Ok(()) };
    if !(z.re.is_finite() && z.im.is_finite()) {
        let why = "not a number; infinity has a word of its own".to_owned();
        return Err(SubspaceError::Sample { what: "node", index, why });
    }
    let (inside, limit, region) = match domain {
        Domain::Disk => (1.0 - z.norm(), ON_BOUNDARY, "the unit disk"),
        Domain::HalfPlane { .. } => (-z.re, ON_BOUNDARY * z.norm(), "the left half plane"),
    };
    if inside > limit {
        return Err(SubspaceError::NodeInside { index, re: z.re, im: z.im, inside, region });
    }
    Ok(())
}

/// Whether conjugation leaves a node as it is.
fn is_real(node: &Node) -> bool {
    let straight = match &node.side {
        Side::Full => true,
        Side::Left(v) | Side::Right(v) => v.iter().all(|x| x.im == 0.0),
    };
    straight
        && match node.z {
            Point::Finite(z) => z.im == 0.0,
            Point::Infinity => true,
        }
}

fn finite(value: &CMat) -> bool {
    (0..value.ncols())
        .all(|j| (0..value.nrows()).all(|i| value[(i, j)].re.is_finite() && value[(i, j)].im.is_finite()))
}

pub(super) fn largest(value: &CMat, size: impl Fn(C64) -> f64) -> f64 {
    (0..value.ncols())
        .flat_map(|j| (0..value.nrows()).map(move |i| (i, j)))
        .fold(0.0, |l, at| l.max(size(value[at])))
}
