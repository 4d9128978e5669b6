//! A goal and bounds, each the largest of smooth pieces.

/// What a piece belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The goal: the largest of all such pieces is minimised.
    Goal,
    /// A bound: the piece is to be ≤ 0. The number says which bound.
    Bound(usize),
    /// The edge of where the functions are defined, or a bound that is to be kept before all others: ≤ 0, with a penalty of its own,
    /// as the largest bound alone counts among bounds and may hide it.
    Edge,
}

/// A smooth function that is the largest, or nearly so, at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothPiece<I> {
    /// What it is: a frequency and a direction, an eigenvalue.
    pub id: I,
    /// Goal or bound.
    pub role: Role,
    /// Its value.
    pub value: f64,
    /// Its gradient.
    pub gradient: Vec<f64>,
}

/// A goal f(x) = max over pieces, under bounds c(x) = max over pieces ≤ 0.
pub trait Pieces: Sync {
    /// Names a piece, at whatever x.
    type Id: Clone + Send + Sync;

    /// Length of x.
    fn dimension(&self) -> usize;

    /// The pieces that are the largest at x and those near to it; none where the functions are not defined.
    fn pieces(&self, x: &[f64]) -> Option<Vec<SmoothPiece<Self::Id>>>;

    /// Given pieces at another x, in their order: lower bounds of f or c there; none where one doesn't exist at x.
    fn again(&self, ids: &[&Self::Id], x: &[f64]) -> Vec<Option<SmoothPiece<Self::Id>>>;

    /// How far two pieces are from being the same one as x moves: none where they can't be, 0 where they are.
    fn apart(&self, one: &Self::Id, other: &Self::Id) -> Option<f64>;
}

/// The edges' penalty, as a multiple of the bounds'.
pub(super) const EDGE: f64 = 100.0;

/// What a point's pieces come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Levels {
    /// f; −∞ where there is no goal.
    pub goal: f64,
    /// max(0, c) of the bounds.
    pub bound: f64,
    /// The same of the edges.
    pub edge: f64,
}

impl Levels {
    pub fn of<I>(pieces: &[SmoothPiece<I>]) -> Self {
        let none = Levels { goal: f64::NEG_INFINITY, bound: 0.0, edge: 0.0 };
        pieces.iter().fold(none, |l, p| match p.role {
            Role::Goal => Levels { goal: l.goal.max(p.value), ..l },
            Role::Bound(_) => Levels { bound: l.bound.max(p.value), ..l },
            Role::Edge => Levels { edge: l.edge.max(p.value), ..l },
        })
    }

    /// What a piece's role comes to.
    pub fn at(self, role: Role) -> f64 {
        match role {
            Role::Goal => self.goal,
            Role::Bound(_) => self.bound,
            Role::Edge => self.edge,
        }
    }

    /// f + ρ (max(0, c) + 100 max(0, e)); without f where there is no goal.
    pub fn merit(self, penalty: f64) -> f64 {
        let bounds = penalty * (self.bound + EDGE * self.edge);
        if self.goal == f64::NEG_INFINITY { bounds } else { self.goal + bounds }
    }
}

/// The merit of pieces.
pub(super) fn merit<I>(pieces: &[SmoothPiece<I>], penalty: f64) -> f64 {
    Levels::of(pieces).merit(penalty)
}
