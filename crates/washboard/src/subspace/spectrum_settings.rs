//! How a spectrum is fitted: its order, block rows, and what is done with poles that have no mirror image.

/// Which order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// This one.
    Given(usize),
    /// The one with the smallest Bayesian information criterion, up to this one.
    AtMost(usize),
}

/// What is done where eigenvalues do not part into n inside the unit circle and n outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unpaired {
    /// An error with their number.
    #[default]
    Refuse,
    /// The n smallest are taken, those outside mirrored; the result says so.
    Fold,
}

/// How a spectrum is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumSettings {
    /// n.
    pub order: Order,
    /// p: block rows of the data matrices. For scalar spectra above 2n.
    pub block_rows: usize,
    /// Poles that have no mirror image.
    pub unpaired: Unpaired,
    /// Whether moments may be used where they are accurate enough: scalar spectra of a given order.
    pub moments: bool,
    /// The sampling interval that the filter is labelled with, s.
    pub dt_s: f64,
}

impl SpectrumSettings {
    /// A given order and number of block rows.
    #[must_use]
    pub fn new(order: usize, block_rows: usize) -> Self {
        let order = Order::Given(order);
        SpectrumSettings { order, block_rows, unpaired: Unpaired::Refuse, moments: true, dt_s: 1.0 }
    }
}

/// An order, and how well it explains the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderTried {
    /// n.
    pub order: usize,
    /// Root of the weighted sum of squares of the fitted spectrum less the samples; none where the order can't be fitted.
    pub misfit: Option<f64>,
    /// N_obs ln(misfit²/N_obs) + k ln N_obs.
    pub bic: Option<f64>,
}
