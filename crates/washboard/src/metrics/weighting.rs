//! The frequency weightings of ISO 2631-1 as filters, and its words for comfort.

use crate::linalg::{C64, Mat};
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::units::rad_per_s;
use std::f64::consts::SQRT_2;

/// Band limits f₁ and f₂ of the three weightings here, Hz; both filters are Butterworth's of second order.
const BAND_HZ: [f64; 2] = [0.4, 100.0];

/// A frequency weighting of ISO 2631-1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// W_k: z of the seat surface, of a floor under a standing person and (vertical) of a surface under a lying one but for the head; x, y and
    /// z at the feet of a seated one.
    Wk,
    /// W_d: horizontal vibration of the seat surface, of a floor under a standing person and of a surface under a lying one.
    Wd,
    /// W_e: rotational vibration (all directions) of the seat surface.
    We,
}

/// f₃ = f₄ and Q₄ of the acceleration–velocity transition; f₅, Q₅, f₆, Q₆ of the upward step, where there is one.
struct Parameters {
    transition_hz: f64,
    q4: f64,
    step: Option<[f64; 4]>,
}

/// b(s)/a(s) of second order in p = s/ω₀: (b₀ + b₁p + b₂p²)/(a₀ + a₁p + p²).
struct Section {
    omega: f64,
    b: [f64; 3],
    a: [f64; 2],
}

impl Weighting {
    /// As the standard writes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Weighting::Wk => "W_k",
            Weighting::Wd => "W_d",
            Weighting::We => "W_e",
        }
    }

    /// Table A.1.
    fn parameters(self) -> Parameters {
        match self {
            Weighting::Wk => {
                Parameters { transition_hz: 12.5, q4: 0.63, step: Some([2.37, 0.91, 3.35, 0.91]) }
            }
            Weighting::Wd => Parameters { transition_hz: 2.0, q4: 0.63, step: None },
            Weighting::We => Parameters { transition_hz: 1.0, q4: 0.63, step: None },
        }
    }

    /// H_h, H_l, H_t and, where there is one, H_s: eqs. (A.1)–(A.4).
    fn sections(self) -> Vec<Section> {
        let [low, high] = BAND_HZ.map(rad_per_s);
        let p = self.parameters();
        let transition = rad_per_s(p.transition_hz);
        let mut all = vec![
            Section { omega: low, b: [0.0, 0.0, 1.0], a: [1.0, SQRT_2] },
            Section { omega: high, b: [1.0, 0.0, 0.0], a: [1.0, SQRT_2] },
            // f₃ = f₄ of all three
            Section { omega: transition, b: [1.0, 1.0, 0.0], a: [1.0, 1.0 / p.q4] },
        ];
        if let Some([f5, q5, f6, q6]) = p.step {
            // (1 + s/(Q₅ω₅) + (s/ω₅)²)/(1 + s/(Q₆ω₆) + (s/ω₆)²) (ω₅/ω₆)², over p = s/ω₆
            let r = f5 / f6;
            all.push(Section { omega: rad_per_s(f6), b: [r * r, r / q5, 1.0], a: [1.0, 1.0 / q6] });
        }
        all
    }

    /// The filter: acceleration in, weighted acceleration out, of order 8 (W_k) or 6.
    ///
    /// H = H_h H_l H_t H_s with p = s:
    /// H_h = 1/(1 + √2 ω₁/p + (ω₁/p)²), H_l = 1/(1 + √2 p/ω₂ + (p/ω₂)²),
    /// H_t = (1 + p/ω₃)/(1 + p/(Q₄ω₄) + (p/ω₄)²), H_s = (1 + p/(Q₅ω₅) + (p/ω₅)²)/(1 + p/(Q₆ω₆) + (p/ω₆)²)·(ω₅/ω₆)².
    ///
    /// | | f₁ | f₂ | f₃ = f₄ | Q₄ | f₅ | Q₅ | f₆ | Q₆ |
    /// |---|---|---|---|---|---|---|---|---|
    /// | W_k | 0.4 | 100 | 12.5 | 0.63 | 2.37 | 0.91 | 3.35 | 0.91 |
    /// | W_d | 0.4 | 100 | 2.0 | 0.63 | ∞ | | ∞ | |
    /// | W_e | 0.4 | 100 | 1.0 | 0.63 | ∞ | | ∞ | |
    ///
    /// It falls as 1/f³ above 100 Hz: what has white noise in it has a finite weighted rms.
    ///
    /// # Errors
    /// None for these parameters; systems that are joined say so.
    ///
    /// Source: ISO 2631-1:1997, annex A, table A.1.
    ///
    /// ```
    /// use washboard::metrics::Weighting;
    /// let at = |hz: f64| -> Result<f64, washboard::lti::LtiError> {
    ///     Ok(Weighting::Wk.filter()?.responder()?.at_frequency(std::f64::consts::TAU * hz)?[(0, 0)].norm())
    /// };
    /// assert!((at(8.0)? - 1.036).abs() < 1e-3);
    /// # Ok::<(), washboard::lti::LtiError>(())
    /// ```
    pub fn filter(self) -> Result<StateSpace<Continuous>, LtiError> {
        let one = StateSpace::continuous_gain(Mat::identity(1, 1))?;
        self.sections().iter().try_fold(one, |before, section| before.series(&section.state_space()?))
    }

    /// H(i2πf), from the factors themselves.
    #[must_use]
    pub fn response(self, freq_hz: f64) -> C64 {
        let omega = rad_per_s(freq_hz);
        self.sections().iter().map(|s| s.at(omega)).product()
    }
}

impl Section {
    fn at(&self, omega: f64) -> C64 {
        let p = C64::new(0.0, omega / self.omega);
        let [b0, b1, b2] = self.b;
        let [a0, a1] = self.a;
        (p * (p * b2 + b1) + b0) / (p * (p + a1) + a0)
    }

    /// Controllable form over p, its time in units of 1/ω₀ undone.
    fn state_space(&self) -> Result<StateSpace<Continuous>, LtiError> {
        let ([b0, b1, b2], [a0, a1], w) = (self.b, self.a, self.omega);
        StateSpace::continuous(
            Mat::from_fn(2, 2, |i, j| w * [[0.0, 1.0], [-a0, -a1]][i][j]),
            Mat::from_fn(2, 1, |i, _| w * [0.0, 1.0][i]),
            Mat::from_fn(1, 2, |_, j| [b0 - b2 * a0, b1 - b2 * a1][j]),
            Mat::from_fn(1, 1, |_, _| b2),
        )
    }
}

/// Reactions in public transport by the overall vibration total value, m/s²: they overlap.
///
/// Source: ISO 2631-1:1997, annex C (informative), C.2.3.
pub const REACTIONS: [([f64; 2], &str); 6] = [
    ([0.0, 0.315], "not uncomfortable"),
    ([0.315, 0.63], "a little uncomfortable"),
    ([0.5, 1.0], "fairly uncomfortable"),
    ([0.8, 1.6], "uncomfortable"),
    ([1.25, 2.5], "very uncomfortable"),
    ([2.0, f64::INFINITY], "extremely uncomfortable"),
];

/// The words of [`REACTIONS`] for a weighted rms acceleration, where two hold, both.
#[must_use]
pub fn reactions(weighted_rms_m_s2: f64) -> Vec<&'static str> {
    let within = |[low, high]: [f64; 2]| (low..high).contains(&weighted_rms_m_s2);
    REACTIONS.iter().filter(|(range, _)| within(*range)).map(|(_, words)| *words).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nominal third-octave centres.
    const CENTRES_HZ: [f64; 37] = [
        0.1, 0.125, 0.16, 0.2, 0.25, 0.315, 0.4, 0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0,
        6.3, 8.0, 10.0, 12.5, 16.0, 20.0, 25.0, 31.5, 40.0, 50.0, 63.0, 80.0, 100.0, 125.0, 160.0, 200.0,
        250.0, 315.0, 400.0,
    ];
    /// Factors × 1000: ISO 2631-1:1997, table 3.
    const WK: [f64; 37] = [
        31.2, 48.6, 79.0, 121.0, 182.0, 263.0, 352.0, 418.0, 459.0, 477.0, 482.0, 484.0, 494.0, 531.0, 631.0,
        804.0, 967.0, 1039.0, 1054.0, 1036.0, 988.0, 902.0, 768.0, 636.0, 513.0, 405.0, 314.0, 246.0, 186.0,
        132.0, 88.7, 54.0, 28.5, 15.2, 7.90, 3.98, 1.95,
    ];
    const WD: [f64; 37] = [
        62.4, 97.3, 158.0, 243.0, 365.0, 530.0, 713.0, 853.0, 944.0, 992.0, 1011.0, 1008.0, 968.0, 890.0,
        776.0, 642.0, 512.0, 409.0, 323.0, 253.0, 212.0, 161.0, 125.0, 100.0, 80.0, 63.2, 49.4, 38.8, 29.5,
        21.1, 14.1, 8.63, 4.55, 2.43, 1.26, 0.64, 0.31,
    ];
    /// Table 4.
    const WE: [f64; 30] = [
        62.5, 97.5, 159.0, 245.0, 368.0, 536.0, 723.0, 862.0, 939.0, 941.0, 880.0, 772.0, 632.0, 512.0,
        409.0, 323.0, 253.0, 202.0, 160.0, 125.0, 100.0, 80.1, 62.5, 50.0, 39.9, 31.6, 24.7, 19.4, 14.8,
        10.5,
    ];

    /// A unit of the third printed digit: the table rounds, and its factors are of three or four digits.
    fn printed_unit(factor: f64) -> f64 {
        10f64.powf(factor.log10().floor() - 2.0).max(0.01)
    }

    #[test]
    fn the_filters_are_the_tabulated_factors() {
        for (weighting, table) in [(Weighting::Wk, &WK[..]), (Weighting::Wd, &WD), (Weighting::We, &WE)] {
            let exact = weighting.filter().unwrap().responder().unwrap();
            for (f, known) in CENTRES_HZ.iter().zip(table) {
                let found = exact.at_frequency(rad_per_s(*f)).unwrap()[(0, 0)];
                let factors = weighting.response(*f);
                // the realised high-pass has its feedthrough less what its states give: at 0.1 Hz that is 1e-3 of it, three times over
                assert!((found - factors).norm() <= 1e-10 * factors.norm(), "{weighting:?} {f}");
                let off = (1000.0 * found.norm() - known).abs();
                // table 3 prints 212 for W_d at 10 Hz, and table 4 prints 202 for W_e at 5 Hz, the same filter an octave lower
                if weighting == Weighting::Wd && *f == 10.0 {
                    assert!((1000.0 * found.norm() - 201.7).abs() < 0.1 && off > 10.0, "{off}");
                } else {
                    assert!(off <= printed_unit(*known), "{weighting:?} at {f} Hz: {} {known}", found.norm());
                }
            }
        }
    }

    #[test]
    fn words_overlap_as_the_standards_do() {
        assert_eq!(reactions(0.2), ["not uncomfortable"]);
        assert_eq!(reactions(0.55), ["a little uncomfortable", "fairly uncomfortable"]);
        assert_eq!(reactions(3.0), ["extremely uncomfortable"]);
        assert!(reactions(f64::NAN).is_empty());
    }
}
