//! Which entries of a controller are free.

use crate::linalg::Mat;
use crate::lti::{Continuous, LtiError, StateSpace};

/// One entry of \[A_K, B_K; C_K, D_K\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Entry {
    /// Chosen by the design.
    Free,
    /// Kept.
    Fixed(f64),
}

/// The free and the fixed entries of a controller ξ̇ = A_K ξ + B_K y, u = C_K ξ + D_K y.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    order: usize,
    controls: usize,
    measurements: usize,
    /// Rows of \[A_K, B_K; C_K, D_K\].
    entries: Vec<Entry>,
}

/// A controller inside a decentralised one: its states, and which signals it sees and drives.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Local {
    /// Its own states.
    pub order: usize,
    /// Measurements that it sees, by their number.
    pub measurements: Vec<usize>,
    /// Controls that it drives, by their number.
    pub controls: Vec<usize>,
}

impl Structure {
    /// All entries free.
    #[must_use]
    pub fn full(order: usize, controls: usize, measurements: usize) -> Self {
        let entries = vec![Entry::Free; (order + controls) * (order + measurements)];
        Structure { order, controls, measurements, entries }
    }

    /// Entries row after row of \[A_K, B_K; C_K, D_K\].
    ///
    /// # Errors
    /// A number of entries that is not (order + controls)(order + measurements); fixed ones that are not finite.
    pub fn of_entries(
        order: usize,
        controls: usize,
        measurements: usize,
        entries: Vec<Entry>,
    ) -> Result<Self, LtiError> {
        let (rows, cols) = (order + controls, order + measurements);
        if entries.len() != rows * cols {
            let (expected, found) =
                (format!("{rows} × {cols} = {} entries", rows * cols), entries.len().to_string());
            return Err(LtiError::Join { what: "a controller's structure", expected, found });
        }
        for e in &entries {
            if let Entry::Fixed(found) = *e
                && !found.is_finite()
            {
                let (field, expected) = ("a fixed entry of the controller", "a finite number");
                return Err(LtiError::Field { field, expected, found });
            }
        }
        Ok(Structure { order, controls, measurements, entries })
    }

    /// Controllers beside each other, none of which knows of the others' measurements: one a corner, say.
    ///
    /// # Errors
    /// A signal that is none; a control that nothing or more than one of them drives.
    pub fn decentralised(controls: usize, measurements: usize, parts: &[Local]) -> Result<Self, LtiError> {
        let order = parts.iter().map(|p| p.order).sum();
        let wrong = |what: &'static str, expected: String, found: String| {
            Err(LtiError::Join { what, expected, found })
        };
        for u in 0..controls {
            let times = parts.iter().flat_map(|p| &p.controls).filter(|c| **c == u).count();
            if times != 1 {
                let expected = format!("control {u} once");
                return wrong("a decentralised structure", expected, format!("{times} times"));
            }
        }
        for p in parts {
            if let Some(found) = p.controls.iter().find(|c| **c >= controls) {
                return wrong(
                    "a decentralised structure",
                    format!("controls below {controls}"),
                    found.to_string(),
                );
            }
            if let Some(found) = p.measurements.iter().find(|c| **c >= measurements) {
                let expected = format!("measurements below {measurements}");
                return wrong("a decentralised structure", expected, found.to_string());
            }
        }
        let mut made = Structure {
            order,
            controls,
            measurements,
            entries: vec![Entry::Fixed(0.0); (order + controls) * (order + measurements)],
        };
        let mut first = 0;
        for p in parts {
            let rows: Vec<usize> =
                (first..first + p.order).chain(p.controls.iter().map(|c| order + c)).collect();
            let cols: Vec<usize> =
                (first..first + p.order).chain(p.measurements.iter().map(|c| order + c)).collect();
            for i in &rows {
                for j in &cols {
                    made.entries[i * (order + measurements) + j] = Entry::Free;
                }
            }
            first += p.order;
        }
        Ok(made)
    }

    /// K(s) = k_p + k_i/s + k_d s/(1 + τs) with free gains: integrator and filter are fixed.
    ///
    /// # Errors
    /// τ that is not positive.
    pub fn pid(filter_s: f64) -> Result<Self, LtiError> {
        if !(filter_s > 0.0 && filter_s.is_finite()) {
            let (field, expected) = ("a PID controller's filter, s", "a positive, finite number");
            return Err(LtiError::Field { field, expected, found: filter_s });
        }
        use Entry::{Fixed, Free};
        let entries = vec![
            Fixed(0.0),
            Fixed(0.0),
            Fixed(1.0),
            Fixed(0.0),
            Fixed(-1.0 / filter_s),
            Fixed(1.0),
            Free,
            Free,
            Free,
        ];
        Structure::of_entries(2, 1, 1, entries)
    }

    /// Its feedthrough alone, as a structure without states; none where nothing of that is free.
    #[must_use]
    pub(super) fn feedthrough(&self) -> Option<Self> {
        let (u, y, n) = (self.controls, self.measurements, self.order);
        let entries: Vec<Entry> = (0..u * y).map(|k| self.entry(n + k / y, n + k % y)).collect();
        let entries = entries.contains(&Entry::Free).then_some(entries)?;
        Some(Structure { order: 0, controls: u, measurements: y, entries })
    }

    /// The same without feedthrough: D_K = 0.
    #[must_use]
    pub fn strictly_proper(mut self) -> Self {
        for u in 0..self.controls {
            for y in 0..self.measurements {
                self.fix(self.order + u, self.order + y, 0.0);
            }
        }
        self
    }

    pub(super) fn fix(&mut self, row: usize, col: usize, value: f64) {
        let cols = self.cols();
        self.entries[row * cols + col] = Entry::Fixed(value);
    }

    /// States.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// Controls u.
    #[must_use]
    pub fn controls(&self) -> usize {
        self.controls
    }

    /// Measurements y.
    #[must_use]
    pub fn measurements(&self) -> usize {
        self.measurements
    }

    pub(super) fn rows(&self) -> usize {
        self.order + self.controls
    }

    pub(super) fn cols(&self) -> usize {
        self.order + self.measurements
    }

    /// An entry.
    #[must_use]
    pub fn entry(&self, row: usize, col: usize) -> Entry {
        self.entries[row * self.cols() + col]
    }

    /// Places of the free entries, row after row.
    pub(super) fn free(&self) -> Vec<(usize, usize)> {
        let cols = self.cols();
        let is_free = |k: &usize| self.entries[*k] == Entry::Free;
        (0..self.entries.len()).filter(is_free).map(|k| (k / cols, k % cols)).collect()
    }

    /// Whether every entry is free.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.entries.iter().all(|e| *e == Entry::Free)
    }
}

/// \[A_K, B_K; C_K, D_K\] of a controller.
pub(super) fn block_of(k: &StateSpace<Continuous>) -> Mat {
    let (n, m) = (k.order(), k.inputs());
    Mat::from_fn(n + k.outputs(), n + m, |i, j| match (i < n, j < n) {
        (true, true) => k.a()[(i, j)],
        (true, false) => k.b()[(i, j - n)],
        (false, true) => k.c()[(i - n, j)],
        (false, false) => k.d()[(i - n, j - n)],
    })
}

/// The controller of a block.
pub(super) fn controller_of(block: &Mat, order: usize) -> Result<StateSpace<Continuous>, LtiError> {
    use crate::lti::cut;
    let (rows, cols) = (block.nrows() - order, block.ncols() - order);
    StateSpace::continuous(
        cut(block, 0, 0, order, order),
        cut(block, 0, order, order, cols),
        cut(block, order, 0, rows, order),
        cut(block, order, order, rows, cols),
    )
}
