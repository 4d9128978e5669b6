//! A goal and bounds, each the largest of smooth pieces.

/// What a piece belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The goal: the largest of all such pieces is minimised.
    Goal,
    /// A bound: the piece is to be ≤ 0. The number says which bound.
    Bound(usize),
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

    /// Given pieces at another x: lower bounds of f or c there. Those that don't exist at x are left out.
    fn again(&self, ids: &[&Self::Id], x: &[f64]) -> Vec<SmoothPiece<Self::Id>>;

    /// How far two pieces are from being the same one as x moves: none where they can't be, 0 where they are.
    fn apart(&self, one: &Self::Id, other: &Self::Id) -> Option<f64>;
}

/// f and max(0, c) of the pieces at a point; −∞ where there is no goal.
pub(super) fn levels<I>(pieces: &[SmoothPiece<I>]) -> (f64, f64) {
    pieces.iter().fold((f64::NEG_INFINITY, 0.0), |(f, c), p| match p.role {
        Role::Goal => (f.max(p.value), c),
        Role::Bound(_) => (f, c.max(p.value)),
    })
}

/// f + ρ max(0, c); of bounds alone max(0, c).
pub(super) fn merit<I>(pieces: &[SmoothPiece<I>], penalty: f64) -> f64 {
    let (f, c) = levels(pieces);
    if f == f64::NEG_INFINITY { penalty * c } else { f + penalty * c }
}
