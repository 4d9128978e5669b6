//! What is wrong in the sources: what is printed, what is right, and the numbers that show it.

use super::context::Context;
use super::item::{Erratum, Evidence};
use super::{ReproduceError, errata_2, errata_3, errata_4, errata_5, errata_list};

/// Computes what shows an error.
pub(super) type Shown = fn(&Context) -> Result<Vec<Evidence>, ReproduceError>;

/// One error of a source.
#[derive(Debug)]
pub(super) struct Entry {
    /// `E4.1`: the chapter, and a number.
    pub id: &'static str,
    pub place: &'static str,
    pub printed: &'static str,
    pub right: &'static str,
    /// Whether `--quick` leaves it out where no number names it.
    pub slow: bool,
    /// Nothing where only the print is at fault.
    pub evidence: Shown,
}

impl Entry {
    pub fn computed(&self, context: &Context) -> Result<Erratum, ReproduceError> {
        Ok(Erratum {
            id: self.id.to_owned(),
            place: self.place.to_owned(),
            printed: self.printed.to_owned(),
            right: self.right.to_owned(),
            evidence: (self.evidence)(context)?,
        })
    }
}

pub(super) const fn entry(id: &'static str, words: [&'static str; 3], evidence: Shown) -> Entry {
    let [place, printed, right] = words;
    Entry { id, place, printed, right, slow: false, evidence }
}

pub(super) const fn slow(id: &'static str, words: [&'static str; 3], evidence: Shown) -> Entry {
    let [place, printed, right] = words;
    Entry { id, place, printed, right, slow: true, evidence }
}

/// A number by what is printed and by what is right.
pub(super) fn shown(what: impl Into<String>, as_printed: f64, right: f64) -> Evidence {
    Evidence { what: what.into(), as_printed, right }
}

/// Only the print is at fault: there is no number to compute.
pub(super) fn print_only(_: &Context) -> Result<Vec<Evidence>, ReproduceError> {
    Ok(Vec::new())
}

/// All of them, in the order of the sources.
pub(super) fn all() -> Vec<&'static Entry> {
    ERRATA.iter().chain(errata_list::LATER).chain(errata_list::PAPER).collect()
}

/// Chapters 2 to 5 of the thesis.
const ERRATA: &[Entry] = &[
    slow(
        "E2.1",
        [
            "Example 2.3.1, errors .3307/2.4208 and .4500/2.6240",
            "noise S + S̃ν on the spectrum",
            "errors of that size come of noise on the amplitude, |G + S̃ν|²; the printed noise gives a seventh of them",
        ],
        errata_2::noise,
    ),
    entry("E2.2", ["(2.39)", "Wᴴ", "Wᵀ: W is real, no number changes"], print_only),
    entry(
        "E2.3",
        ["(2.49) and algorithm 2.4.1, step 3", "blocks of V without transpose", "Vᵀ"],
        errata_2::transposed_blocks,
    ),
    entry("E2.4", ["(2.53), (2.54)", "zero block of (p − 1) × m", "(p − 1)m × m"], errata_2::zero_blocks),
    entry(
        "E2.5",
        ["(2.60), (2.74)", "zero block of m × (p − 1)", "m × (p − 1)m"],
        errata_2::zero_blocks_beside,
    ),
    entry("E2.6", ["(2.93)", "last factor F − APCᵀ", "its transpose"], print_only),
    entry("E2.7", ["(2.78), (2.92)", "E free", "E = Eᵀ"], print_only),
    entry(
        "E2.8",
        [
            "Lemma 2.2.1, theorems 2.2.2 and 2.4.1",
            "N ≥ p/2 + n + 1",
            "2N ≥ p + 2n where no θ is 0 or π: fewer are enough",
        ],
        errata_2::fewest_samples,
    ),
    entry(
        "E2.9",
        [
            "Before (2.21): p > 2n",
            "for every m",
            "for m = 1; for m > 1 a condition on the observability index",
        ],
        errata_2::fewer_block_rows,
    ),
    entry("E2.10", ["(A.8), (A.9)", "Λ[t]", "[t]Λ: n × n times 2n × n is not defined"], print_only),
    entry("E2.11", ["(A.16)", "block diagonal", "[I B̃]"], print_only),
    entry(
        "E2.12",
        ["Theorem 2.4.1", "supremum over z in D", "over |z| ≥ 1: poles of f and of its estimate lie in D"],
        print_only,
    ),
    entry(
        "E2.13",
        ["§2.3.1, last sentence", "\"about 30 %\"", "26.5 % of the printed errors"],
        errata_2::reduction,
    ),
    entry(
        "E2.14",
        ["Appendix A.3", "E‖Re η‖_F = ½ Tr R", "that is E‖Re η‖²_F; the mean norm is at most its root"],
        errata_2::mean_norm,
    ),
    entry(
        "E2.15",
        ["Example 2.3.1, intervals of θ_k", "[π/N(k − ½), π/N(k + ½)], k ≤ N", "the last interval ends at π"],
        errata_2::last_interval,
    ),
    entry(
        "E2.16",
        ["(2.91), (A.17), after (2.103)", "limits without \"= 0\", brackets", "typography"],
        print_only,
    ),
    entry(
        "E3.1",
        [
            "(3.43), example 3.3",
            "N = 9: conjugates count twice, and z₂ = z̄₁ is counted as well",
            "N = 7; the data have rank 4 either way",
        ],
        errata_3::double_count,
    ),
    entry(
        "E3.2",
        ["Theorem 3.1.1", "N ≥ q + n is necessary", "sufficient only, for m > 1"],
        errata_3::fewer_nodes,
    ),
    entry(
        "E3.3",
        [
            "After (3.72), constraints for a relative degree τ",
            "derivatives j = 1 … τ at z = −1",
            "j = 0 … τ − 1",
        ],
        errata_3::relative_degree,
    ),
    entry(
        "E3.4",
        ["After (3.72), \"high-pass filter\"", "1/(s + μ)^τ", "a low-pass filter, with gain μ^τ"],
        errata_3::low_pass,
    ),
    entry("E3.5", ["(3.66), (3.69)", "b₁z, a₁z", "b₁z^(n−1), a₁z^(n−1)"], print_only),
    entry(
        "E4.1",
        ["§4.4, rms at c_t = 0", ".5240 with y₂, .5234 with [y₁ y₂]", "exchanged"],
        errata_4::exchanged_labels,
    ),
    entry("E4.2", ["Proposition 4.3.8", "y = y₂", "y = [y₁ y₂]ᵀ"], errata_4::proposition_8),
    entry(
        "E4.3",
        [
            "Propositions 4.3.7–4.3.12",
            "no condition for a proper controller",
            "H₁(∞) ≠ 0 (c_t > 0), coefficient of 1/s ≠ 0 (c_t = 0): q̃(∞) = m_s keeps every printed condition, and no controller exists",
        ],
        errata_4::proper_controller,
    ),
    entry(
        "E4.4",
        [
            "§4.3, §4.4, §5.2.1: \"without sacrificing road holding\", \"also very accurate\"",
            "H₂ and H₃ follow H₁",
            "the design hides the wheel's own mode m_u s² + c_t s + k_t from H₁; H₃ at ω₂ is α₂/α₁ times the copied one",
        ],
        errata_4::hidden_mode,
    ),
    entry("E4.5", ["§5.2.1", "17th order controller", "9th order: the rest cancels"], errata_4::order),
    entry(
        "E4.6",
        ["§5.2.1", "order 8 of the loop", "8 and the 2 of Ψ; the whole loop has 4 + 9"],
        errata_4::loop_order,
    ),
    entry(
        "E4.7",
        [
            "After (4.53)",
            "numerator of order 18, which Ψ(∞) lowers by two",
            "17, which it lowers by one, as H₁ is strictly proper; the end, 13, is right",
        ],
        errata_4::numerator,
    ),
    entry(
        "E4.8",
        ["(4.51)", "lim E∫₀^t_f (…) dt", "1/t_f is missing: the integral grows without end"],
        print_only,
    ),
    entry(
        "E4.9",
        [
            "§4.4: \"the increase in the actuator gain is less than 30 decibels for all frequencies\"",
            "30 dB",
            "true against LQG of c_t = 2c_s to 100 Hz, not against LQG on the same tire",
        ],
        errata_4::decibels,
    ),
    entry(
        "E4.10",
        [
            "§4.4: \"the actuator gain is seen to peak at the heave and the wheel-hop frequencies\"",
            "two peaks, near 1.25 and 11.03 Hz",
            "|K| of the hybrid design has none; its force peaks at ω₂, on the figures' grid of 100 points a decade",
        ],
        errata_4::peaks,
    ),
    entry("E4.11", ["§4.4, drop of rms z₁ at c_t = 98", "6.83 %", "from unrounded values"], errata_4::drop),
    entry("E4.12", ["(4.42); conditions of Ψ", "x₃, x₄; (iv)–(vi)", "ẋ₁, ẋ₂; there is no (iii)"], print_only),
    entry(
        "E4.13",
        [
            "After proposition 4.3.13, Bode's integral",
            "stated for c_t = 0 only: 0 where there are no zeros to the right",
            "with tire damping −(π/2)c_t/m_u is added",
        ],
        errata_4::integral,
    ),
    entry(
        "E5.4",
        ["§5.2.1, force \"between 59.5 and 62.5 N for all\"", "for all", "of μ = 1 only"],
        errata_5::force,
    ),
    entry(
        "E5.5",
        ["§5.1.1", "rms travel \"more than three times\" the tire's", "2.65 times"],
        errata_5::ratio,
    ),
    entry(
        "E5.6",
        ["§5.2.1, \"declining responses\"", "declining", "the active travel rises with tire damping"],
        errata_5::rising,
    ),
    entry(
        "E5.7",
        ["§5.3, scalings at c_t = 98", "20.2380, .2739", "a tenth of a per cent off"],
        errata_5::norms,
    ),
    entry(
        "E5.8",
        [
            "Table 5.2, active columns, and figures 5.9–5.12",
            "rms values by order; \"the simplest controller achieves the best\"",
            "of local optima of a goal without rms values: not determined by what is stated",
        ],
        errata_5::fixed_order_rows,
    ),
    entry(
        "E5.10",
        [
            "Table 5.1, K_p",
            "z₁ .4881 .4856 .4818, z₂ .0045",
            "the optimum of the stated problem has less of both",
        ],
        errata_5::robust_gain,
    ),
];
