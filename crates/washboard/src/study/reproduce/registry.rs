//! What can be reproduced: a name, what it is, and the function that computes it.

use super::context::Context;
use super::item::Sheet;
use super::{
    ReproduceError, chapter_2, chapter_3, chapter_4_car, chapter_4_figures, chapter_4_hybrid,
    chapter_4_identities, chapter_4_lqg, chapter_4_propositions, chapter_5_bump, chapter_5_feedback,
    chapter_5_fixed, chapter_5_limits, chapter_6_feedback, chapter_6_figures, chapter_6_limits,
    chapter_7_car, chapter_7_design, chapter_7_figures, chapter_7_fixed, chapter_8_cabin, chapter_8_figures,
    paper_car, paper_road, paper_spectra,
};

/// One published item.
#[derive(Debug)]
pub(super) struct Item {
    /// `thesis.fig-4.3`.
    pub name: &'static str,
    /// In words.
    pub title: &'static str,
    /// Whether `--quick` leaves it out.
    pub slow: bool,
    /// Fills its sheet.
    pub run: Compute,
}

type Compute = fn(&Context, &mut Sheet) -> Result<(), ReproduceError>;

const fn item(name: &'static str, title: &'static str, run: Compute) -> Item {
    Item { name, title, slow: false, run }
}

const fn slow(name: &'static str, title: &'static str, run: Compute) -> Item {
    Item { name, title, slow: true, run }
}

/// All of them, in the order of the sources.
pub(super) const ITEMS: &[Item] = &[
    slow("thesis.fig-2.1", "Power spectrum from noisy samples, with their covariance", chapter_2::figure_1),
    slow("thesis.fig-2.2", "Power spectrum from noisy samples, without it", chapter_2::figure_2),
    item("thesis.ex-2.3.1", "What the covariance saves", chapter_2::reduction),
    item("thesis.fig-2.3", "Road spectra", chapter_2::figure_3),
    item("thesis.eq-2.96", "First-order road filter, from its own samples", chapter_2::road_filter),
    slow("thesis.fig-2.7", "Function from its noisy real part", chapter_2::figure_7),
    item("thesis.sec-2.4.3", "How many samples a function takes", chapter_2::samples),
    item("thesis.ex-3.3", "Lagrange–Sylvester interpolation, step by step", chapter_3::example),
    item("thesis.sec-3.1.3", "How many nodes an order takes", chapter_3::node_counts),
    item("thesis.table-4.1", "Parameters of the quarter car", chapter_4_car::parameters),
    item("thesis.eq-4.7", "Characteristic polynomial", chapter_4_identities::delta),
    item("thesis.eq-4.20", "Responses by Q̂, travel measured", chapter_4_identities::travel_measured),
    item("thesis.eq-4.29", "Trade-offs (4.29)–(4.31)", chapter_4_identities::trade_offs),
    item("thesis.eq-4.32", "Invariant frequencies", chapter_4_car::invariant_frequencies),
    item("thesis.prop-4.3.1", "H₁ with tire damping, y₂", chapter_4_propositions::p1),
    item("thesis.prop-4.3.2", "H₂ with tire damping, y₂", chapter_4_propositions::p2),
    item("thesis.prop-4.3.3", "H₃ with tire damping, y₂", chapter_4_propositions::p3),
    item("thesis.prop-4.3.4", "H₁ without tire damping, y₂", chapter_4_propositions::p4),
    item("thesis.prop-4.3.5", "H₂ without tire damping, y₂", chapter_4_propositions::p5),
    item("thesis.prop-4.3.6", "H₃ without tire damping, y₂", chapter_4_propositions::p6),
    item("thesis.eq-4.35", "Unimodular matrix of two measurements", chapter_4_identities::unimodular_matrix),
    item("thesis.eq-4.37", "Responses by q̃, both measured", chapter_4_identities::both_measured),
    item("thesis.prop-4.3.7", "H₁ with tire damping, [y₁ y₂]", chapter_4_propositions::p7),
    item("thesis.prop-4.3.8", "H₂ with tire damping, [y₁ y₂] (printed: y₂)", chapter_4_propositions::p8),
    item("thesis.prop-4.3.9", "H₃ with tire damping, [y₁ y₂]", chapter_4_propositions::p9),
    item("thesis.prop-4.3.10", "H₁ without tire damping, [y₁ y₂]", chapter_4_propositions::p10),
    item("thesis.prop-4.3.11", "H₂ without tire damping, [y₁ y₂]", chapter_4_propositions::p11),
    item("thesis.prop-4.3.12", "H₃ without tire damping, [y₁ y₂]", chapter_4_propositions::p12),
    item("thesis.eq-4.41", "What the travel alone cannot do", chapter_4_identities::gap_at_infinity),
    item(
        "thesis.sec-4.3",
        "Conservation law, and cars that cannot be parametrised",
        chapter_4_identities::section,
    ),
    item("thesis.eq-4.50", "The road", chapter_4_car::road),
    item("thesis.sec-4.4", "Modes, rms values, LQG designs, hybrid design", chapter_4_lqg::section),
    item("thesis.fig-4.3", "Acceleration, c_t = 0", chapter_4_figures::f3),
    item("thesis.fig-4.4", "Travel, c_t = 0", chapter_4_figures::f4),
    item("thesis.fig-4.5", "Tire deflection, c_t = 0", chapter_4_figures::f5),
    item("thesis.fig-4.6", "Acceleration, c_t = 2c_s", chapter_4_figures::f6),
    item("thesis.fig-4.7", "Travel, c_t = 2c_s", chapter_4_figures::f7),
    item("thesis.fig-4.8", "Tire deflection, c_t = 2c_s", chapter_4_figures::f8),
    item("thesis.fig-4.9", "Acceleration, c_t = 0.1c_s", chapter_4_figures::f9),
    item("thesis.eq-4.53", "Hybrid design", chapter_4_hybrid::equation),
    item("thesis.fig-4.10", "Hybrid design and what it copies", chapter_4_hybrid::figure_10),
    item("thesis.fig-4.11", "Actuators", chapter_4_hybrid::figure_11),
    slow("thesis.fig-4.12", "Actuators over 101 tire dampings", chapter_4_hybrid::figure_12),
    item("thesis.fig-5.1", "H2 limit, Λ = I", chapter_5_limits::f1),
    item("thesis.fig-5.2", "H2 limit, Λ = diag(1, 10, 100)", chapter_5_limits::f2),
    item("thesis.eq-5.18", "H2 limit by two routes", chapter_5_limits::formula),
    item("thesis.sec-5.1.1", "Passive rms values", chapter_5_limits::passive),
    item("thesis.sec-5.2.1", "Scalings, and orders", chapter_5_feedback::section),
    slow("thesis.fig-5.3", "State feedback over tire damping, μ = 1", chapter_5_feedback::f3),
    slow("thesis.fig-5.4", "State feedback over tire damping, μ = 2", chapter_5_feedback::f4),
    item("thesis.fig-5.5", "State feedback over frequency, μ = 2", chapter_5_bump::f5),
    item("thesis.fig-5.6", "State feedback over a bump, μ = 2", chapter_5_bump::f6),
    slow("thesis.fig-5.7", "State feedback over a bump and tire damping", chapter_5_bump::f7),
    item("thesis.table-5.1", "One gain for a range of tire dampings", chapter_5_feedback::table_1),
    item("thesis.sec-5.3", "Scalings of the fixed-order design", chapter_5_limits::norms),
    item("thesis.table-5.2", "Fixed-order designs", chapter_5_fixed::table_2),
    item("thesis.fig-5.8", "First-order design", chapter_5_fixed::f8),
    slow("thesis.fig-5.9", "First-order designs over tire damping", chapter_5_fixed::f9),
    slow("thesis.fig-5.10", "Second-order designs over tire damping", chapter_5_fixed::f10),
    slow("thesis.fig-5.11", "Third-order designs over tire damping", chapter_5_fixed::f11),
    slow("thesis.fig-5.12", "Fourth-order designs over tire damping", chapter_5_fixed::f12),
    item("thesis.table-6.1", "Parameters of the half car", chapter_6_limits::table_1),
    item("thesis.sec-6.1", "The road, the limit by two routes, passive ratios", chapter_6_limits::section),
    item("thesis.fig-6.2", "H2 limit, Λ = I", chapter_6_limits::f2),
    item("thesis.fig-6.3", "H2 limit, Λ = diag(10 I, 100 I, I)", chapter_6_limits::f3),
    item("thesis.sec-6.2", "Tire damping and the passive car", chapter_6_feedback::passive),
    item("thesis.sec-6.2.2", "Output feedback by matrix inequalities", chapter_6_feedback::section),
    item("thesis.fig-6.5", "Travels and tire deflections, (0.1, 1.5)", chapter_6_figures::f5),
    item("thesis.fig-6.6", "Accelerations, (0.1, 1.5)", chapter_6_figures::f6),
    item("thesis.fig-6.7", "Tire gain, (0.1, 1.5)", chapter_6_figures::f7),
    item("thesis.fig-6.8", "Forces, (0.1, 1.5)", chapter_6_figures::f8),
    item("thesis.fig-6.9", "Travels and tire deflections, (1, 1)", chapter_6_figures::f9),
    item("thesis.fig-6.10", "Accelerations, (1, 1)", chapter_6_figures::f10),
    item("thesis.fig-6.11", "Tire gain, (1, 1)", chapter_6_figures::f11),
    item("thesis.fig-6.12", "Forces, (1, 1)", chapter_6_figures::f12),
    item("thesis.sec-6.2.3", "One gain for a box of tire dampings", chapter_6_feedback::polytopic),
    item("thesis.table-7.1", "Parameters of the full car", chapter_7_car::table_1),
    item("thesis.sec-7.1.1", "The road, modes, sizes", chapter_7_car::section),
    item("thesis.sec-7.2", "The passive car", chapter_7_design::passive),
    slow("thesis.sec-7.2.1", "Output feedback by matrix inequalities, truncated", chapter_7_design::section),
    slow("thesis.fig-7.3", "Trade-off of comfort and tire load", chapter_7_design::figure_3),
    slow("thesis.fig-7.4", "Roll responses, LMI design", chapter_7_figures::f4),
    slow("thesis.fig-7.5", "Roll responses, order 6", chapter_7_fixed::figure_5),
    item("thesis.table-7.2", "Fixed-order designs: the passive row", chapter_7_car::table_2),
    slow("thesis.sec-7.3", "Truncated designs beside fixed-order ones", chapter_7_car::section_3),
    item("thesis.table-8.1", "Parameters of the truck cabin", chapter_8_cabin::table_1),
    item("thesis.table-8.2", "Parameters of the truck's bounce model", chapter_8_cabin::table_2),
    item("thesis.fig-8.3", "Spectrum of the chassis", chapter_8_figures::f3),
    item("thesis.sec-8.3.1", "LQG design of the cabin", chapter_8_cabin::section),
    item("thesis.fig-8.4", "Heave of the cabin", chapter_8_figures::f4),
    item("thesis.fig-8.5", "Pitch of the cabin", chapter_8_figures::f5),
    item("thesis.fig-8.6", "Roll of the cabin", chapter_8_figures::f6),
    item("paper.table-1", "Parameters of the full car", paper_car::table_1),
    item("paper.sec-4.2", "Band and class of the road", paper_road::section_4_2),
    item("paper.fig-3", "Spectrum and correlation of one track", paper_road::figure_3),
    item("paper.fig-4", "Coherence of two tracks", paper_road::figure_4),
    item("paper.sec-4.3", "Where the modes lie", paper_car::section_4_3),
    item("paper.fig-5", "Modes", paper_car::figure_5),
    item("paper.fig-6", "Cross spectra by two routes", paper_spectra::figure_6),
    item("paper.fig-7", "Cross-correlations by two routes", paper_spectra::figure_7),
];
