//! What this module refuses, with the numbers that matter.

use crate::linalg::{LinalgError, RiccatiError};
use crate::lti::LtiError;
use thiserror::Error;

/// Why there is no model.
#[derive(Debug, Clone, Error)]
pub enum SubspaceError {
    /// Linear algebra that did not converge, or entries that are not finite.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// A system that can't be built.
    #[error(transparent)]
    Lti(#[from] LtiError),
    /// Another number of things than there must be.
    #[error("{what}: expected {expected}, found {found}")]
    Count {
        /// Of what.
        what: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A setting out of its range.
    #[error("{field}: expected {expected}, found {found}")]
    Field {
        /// Which.
        field: &'static str,
        /// What it may be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// An angle that is not in [0, π].
    #[error("angle {index}: {value}, expected one from 0 to π")]
    Angle {
        /// Which, from 0.
        index: usize,
        /// θ.
        value: f64,
    },
    /// Angles that do not ascend.
    #[error("angle {index}: {value} after {before}: expected distinct angles in ascending order")]
    Order {
        /// Which, from 0.
        index: usize,
        /// The one before it.
        before: f64,
        /// θ.
        value: f64,
    },
    /// A sample, variance or covariance that is none.
    #[error("{what} {index}: {why}")]
    Sample {
        /// Sample, variance or covariance.
        what: &'static str,
        /// Which, from 0.
        index: usize,
        /// What is wrong with it.
        why: String,
    },
    /// A power spectrum with a negative density.
    #[error("sample {index}: a density of {value:e}, expected none below 0")]
    Negative {
        /// Which, from 0.
        index: usize,
        /// The density.
        value: f64,
    },
    /// Fewer samples than the order and the number of block rows ask for.
    #[error(
        "order {order} with p = {block_rows} needs {needed} independent real samples (2 a frequency, 1 at 0 and at π), found {found}"
    )]
    TooFew {
        /// n.
        order: usize,
        /// p.
        block_rows: usize,
        /// How many it takes.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// An order that the number of block rows does not allow.
    #[error("order {order}: p = {block_rows} block rows of {size} allow {most} at most")]
    OrderTooHigh {
        /// n.
        order: usize,
        /// p.
        block_rows: usize,
        /// m.
        size: usize,
        /// The largest order.
        most: usize,
    },
    /// Poles do not part into those inside the circle and their mirror images.
    #[error(
        "order {order}: {inside} of {both} eigenvalues are inside the unit circle, expected half: the spectrum is not rational enough of this order, or too noisy. Try a lower or a higher order, a narrower band, or a smoothed spectrum",
        both = 2 * order
    )]
    NoSplit {
        /// n.
        order: usize,
        /// How many are inside.
        inside: usize,
    },
    /// A spectrum without a spectral factor.
    #[error("no spectral factor: {0}")]
    NoFactor(#[from] RiccatiError),
    /// A spectrum that could not be made positive.
    #[error(
        "the spectrum of order {order} falls to {least:e} at {theta_rad:.4} rad, and {rounds} repairs did not lift it above 0"
    )]
    NotPositive {
        /// n.
        order: usize,
        /// Its smallest eigenvalue.
        least: f64,
        /// Where.
        theta_rad: f64,
        /// Repairs that were tried.
        rounds: usize,
    },
    /// A factor that does not give its spectrum back.
    #[error("the factor's spectrum is off by {relative:e} of the fitted one, expected below {limit:e}")]
    Unverified {
        /// Largest difference over the largest value.
        relative: f64,
        /// What is allowed.
        limit: f64,
    },
    /// A value of another shape.
    #[error("node {index}, derivative {derivative}: expected shape {expected:?}, found {found:?}")]
    NodeShape {
        /// Which node, from 0.
        index: usize,
        /// Which value, from 0.
        derivative: usize,
        /// Rows and columns by the first node or its side.
        expected: (usize, usize),
        /// Its own.
        found: (usize, usize),
    },
    /// A node where the system may have a pole.
    #[error("node {index}: {re} + {im}i is {inside:e} inside {region}, where the system may have poles")]
    NodeInside {
        /// Which, from 0.
        index: usize,
        /// Re z.
        re: f64,
        /// Im z.
        im: f64,
        /// How far.
        inside: f64,
        /// Of what.
        region: &'static str,
    },
    /// A real node with a value that is not real.
    #[error(
        "node {index}, derivative {derivative}: an imaginary part of {imaginary:e} at a real node, expected a real value"
    )]
    NotReal {
        /// Which, from 0.
        index: usize,
        /// Which value, from 0.
        derivative: usize,
        /// The largest.
        imaginary: f64,
    },
    /// Two values of one thing.
    #[error(
        "nodes {first} and {second} are one, or conjugate, and their derivatives {derivative} differ by {difference:e}"
    )]
    Contradiction {
        /// One, from 0.
        first: usize,
        /// The other.
        second: usize,
        /// Which value, from 0.
        derivative: usize,
        /// The largest.
        difference: f64,
    },
    /// Data whose rank is as high as it can be, or that cannot show the order asked for.
    #[error(
        "too little data: they show rank {rank} and can show no more than {most}; a rank of at least {missing} more is missing to tell the order (data that are not exact have full rank: give the order)"
    )]
    TooLittleData {
        /// What it is.
        rank: usize,
        /// What it can be.
        most: usize,
        /// What it lacks.
        missing: usize,
    },
    /// Data that leave B and D open.
    #[error(
        "too little data: B and D have {unknowns} unknowns and the data determine {rank}: rank {missing} is missing",
        missing = unknowns - rank
    )]
    MissingRank {
        /// (n + p) m.
        unknowns: usize,
        /// What there is.
        rank: usize,
    },
    /// Directions that leave inputs, or outputs, open.
    #[error("too little data: their directions have rank {rank} of {needed}: rank {missing} is missing", missing = needed - rank)]
    MissingDirections {
        /// What they have.
        rank: usize,
        /// Inputs (right) or outputs (left).
        needed: usize,
    },
    /// Data of a system of lower order.
    #[error("order {order}: the data have rank {rank}, so that order {rank} is the highest")]
    OrderAboveRank {
        /// What was asked for.
        order: usize,
        /// What they have.
        rank: usize,
    },
    /// A system with a pole at infinity.
    #[error(
        "order {order}: the function through the data is not proper (a pole {distance:e} from infinity, as a share)"
    )]
    Improper {
        /// n.
        order: usize,
        /// How near.
        distance: f64,
    },
    /// Constraints that B and D cannot meet.
    #[error(
        "{count} real constraints of rank {rank} cannot be met with the poles found: off by {off:e} of their size"
    )]
    Constraints {
        /// How many.
        count: usize,
        /// Of these independent.
        rank: usize,
        /// What is left.
        off: f64,
    },
    /// A bound that no function through the data has.
    #[error(
        "bound {bound:?}: no stable function through the data is below {least:.6e} everywhere on the boundary"
    )]
    Bound {
        /// What was asked for.
        bound: f64,
        /// The least.
        least: f64,
    },
}
