//! The errata of chapters 6 to 8 of the thesis, and of the paper.

use super::errata::{Entry, entry, print_only, slow};
use super::{errata_6, errata_7, errata_8, errata_8_kinematics, errata_paper};

/// Chapters 6 to 8.
pub(super) const LATER: &[Entry] = &[
    entry(
        "E6.1",
        [
            "(6.15), (6.18), and \"only road holding quality is influenced\" (§6.2.2)",
            "the dampers' forces on the body without the velocities of the wheels",
            "with them: as printed, the body is damped to the ground, and its accelerations hardly know the tires' damping",
        ],
        errata_6::damped_to_the_ground,
    ),
    entry("E6.2", ["(6.15), first block row", "two rows", "[0 [I −I; 0 I]], four rows"], print_only),
    entry("E6.3", ["(6.4)", "k_s", "k_s2"], print_only),
    entry(
        "E6.4",
        ["§6.1.2, controller of Q", "K = Q(I + G₂₂)⁻¹", "K = Q(I + G₂₂Q)⁻¹"],
        errata_6::controller_of_q,
    ),
    entry("E6.5", ["(6.24)", "K ∈ RH∞", "K need only stabilise"], print_only),
    entry(
        "E6.6",
        [
            "§6.1.1: Padé's second order is \"sufficiently accurate\"; §6.1.3: \"further improved by increasing velocities\"",
            "order 2",
            "order 40: the wheels hop through up to 28 rad within the delay; speed does not help Λ = diag(10 I, 100 I, I) then, nor Λ = I at every damping with order 2",
        ],
        errata_6::pade,
    ),
    entry("E6.7", ["(6.20)", "μ = .0027", "2πn₀√κ of chapter 4, unrounded"], errata_6::rounded_road),
    entry(
        "E6.8",
        ["§6.1.3", "rms acceleration \"more than one hundred times\" the travels", "less"],
        errata_6::hundred_times,
    ),
    entry(
        "E6.9",
        [
            "§6.2.2, decreases by tire damping of the active cars; 12 % and 3 % of (1, 1)",
            "designs of a solver that need not end at the least cost",
            "not determined to the printed digits: the optimum is flat; the rear travel and tire fall less than the front ones",
        ],
        errata_6::above_the_optimum,
    ),
    entry(
        "E6.10",
        ["§6.2.3, rms heave .10145 and .10160", "as printed", "less than a per cent lower"],
        errata_6::robust_gains,
    ),
    slow(
        "E7.1",
        [
            "§7.2.1, the active car",
            "3.5916, .0722, 1.13, 2.95",
            "up to a per cent off: of a solver that need not end at the least cost",
        ],
        errata_7::above_the_optimum,
    ),
    entry("E7.2", ["Table 7.1, K_F and K_R", "N rad/m", "N m/rad"], errata_7::unit_of_roll_stiffness),
    slow(
        "E7.3",
        [
            "§7.2.1, truncations \"as good as the original\"",
            "of the design as it is posed",
            "its slowest poles must be kept off the axis, by a decay rate in the region of poles",
        ],
        errata_7::truncation,
    ),
    slow(
        "E7.4",
        [
            "Figure 7.3, \"one component increases as λ increases while the other decreases\"",
            "‖Λ₂T‖₂ and ‖Λ∞T‖∞",
            "true without their factors √(1 − λ) and √λ",
        ],
        errata_7::weighted,
    ),
    entry(
        "E7.5",
        ["After problem 7.2.1", "171 LMIs", "171 = 18·19/2 unknowns of one symmetric matrix"],
        print_only,
    ),
    entry(
        "E7.6",
        ["§7.2, y = (x_bᵀ − x_aᵀ, ẋᵀ)ᵀ", "ẋ", "the velocities, as C₂ has it"],
        errata_7::measurements,
    ),
    slow(
        "E7.7",
        [
            "Table 7.2, active rows",
            "rms values of fixed-order designs",
            "local optima, of a goal without rms values: not determined by what is stated; the truncated LMI design has less of all five",
        ],
        errata_7::fixed_order_rows,
    ),
    entry("E7.8", ["After problem 7.2.1, the objective", "α₁²‖T_r∞ξ‖∞", "α₁²‖T_r∞ξ‖²∞"], print_only),
    entry(
        "E7.9",
        ["§7.1.1, natural frequencies .99, 1.23, 1.69 Hz", "natural", "damped"],
        errata_7::natural_frequencies,
    ),
    entry(
        "E7.10",
        ["Table 7.2, passive row", "2.1700, 1.3500, 3.9800", "zeros appended to two places"],
        errata_7::appended_zeros,
    ),
    entry(
        "E8.1",
        ["§8.1, S, last row", "[1 l₁ n₂]", "[1 −l₁ n₂], as z_D above it"],
        errata_8_kinematics::corner_d,
    ),
    entry(
        "E8.2",
        ["§8.3, J = ∫(ẋ_SᵀQẋ_S + uᵀRu) dt", "ẋ_S", "ẍ_S: with velocities there is hardly any control"],
        errata_8::velocities,
    ),
    entry("E8.3", ["§8.3, R = ρI₄", "ρ = 10⁻³", "ρ² = 10⁻⁶"], errata_8::force_weight),
    entry(
        "E8.4",
        [
            "§8.3, the regulator",
            "without the cross term of accelerations and forces, as the printed numbers show",
            "with it the cost has its minimum",
        ],
        errata_8::cross_term,
    ),
    entry(
        "E8.5",
        ["§8.2, after (8.6)", "\"very accurate for all |ω| ≥ 0.02 Hz\"", "from 0.05 Hz on"],
        errata_8::leak,
    ),
    entry(
        "E8.6",
        [
            "(8.4), §8.3.1: μ = .0027",
            "for everything",
            "the printed rms values are of the unrounded road; forces and active ones come out where Q and filter are of μ = .0027, which the text does not say",
        ],
        errata_8::rounded_road,
    ),
    entry(
        "E8.7",
        [
            "§8.3.1: magnitudes \"do not change at the heave and the wheel-hop natural frequencies of the truck bounce model\"",
            "no change",
            "up to 32 % less at 3.5 Hz, up to 27 % more at 17 Hz",
        ],
        errata_8::unchanged,
    ),
    entry("E8.8", ["§8.3.1, reduction of pitch", "23.5 %", "from unrounded values"], errata_8::reduction),
    entry(
        "E8.9",
        ["§8.3, E(νν') = I₄", "intensity 1 in the filter", "μ²v, as in (8.4)"],
        errata_8::unit_noise,
    ),
    entry(
        "E8.10",
        [
            "§8.3.1, \"the warp input\" [1 0 0 −1]",
            "warp",
            "half pitch and half roll: chapter 7's warp, [1 −1 −1 1], has no share in it, and moves neither heave nor pitch",
        ],
        errata_8::warp,
    ),
    entry("E8.11", ["Table 8.1, K_F", "N/m", "N m/rad"], errata_8::unit_of_roll_stiffness),
    entry(
        "E8.12",
        [
            "§8.3.1, the closed loop's outputs",
            "−[M⁻¹[…]; 0 K_r] with +WK_r",
            "signs: ẍ_S = −M⁻¹(… + WK_r x̂), u = −K_r x̂",
        ],
        print_only,
    ),
];

/// The paper.
pub(super) const PAPER: &[Entry] = &[
    entry(
        "EP.1",
        [
            "(A11)–(A12), (A16)–(A21), tires' factors",
            "λ_m",
            "λ_n: with λ_m the model equals (50) only for tires without damping",
        ],
        errata_paper::tire_factors,
    ),
    entry(
        "EP.2",
        ["(43)–(44), (A22)–(A23)", "e^{λ_n τ} outside the convolution", "inside, as in (A14)"],
        print_only,
    ),
    entry(
        "EP.3",
        [
            "(57), second coordinates",
            "M₂ = M₁T⁻¹, likewise C₂ and K₂",
            "T⁻ᵀM₁T⁻¹ where modal a is formed by these matrices",
        ],
        errata_paper::second_coordinates,
    ),
    entry(
        "EP.4",
        [
            "(38), (44), (61)",
            "H₀(τ) = 1; e^{−μWω/(2πV)} for ω ≥ 0",
            "H₀ = δ(τ), as Γ₀ = 1; |ω|, as φ(−ω) is used",
        ],
        errata_paper::coherence,
    ),
    entry(
        "EP.5",
        ["(59)–(60)", "a one-sided density used as the two-sided S_d", "π times as much"],
        errata_paper::one_sided,
    ),
    entry(
        "EP.6",
        [
            "§4.2, band 1.89–177.7 rad/s",
            "for 20 m/s",
            "what 10 to 30 m/s have in common; ISO's wavelengths at 20 m/s are 1.26–355.4 rad/s",
        ],
        errata_paper::band,
    ),
    entry(
        "EP.7",
        [
            "(49), half spectra",
            "the first sum of (45) fails by delays alone, with e^{−λ_n τ_l}",
            "e^{+λ_n τ_l}; a coloured road fails it, too",
        ],
        errata_paper::half_spectra,
    ),
    entry(
        "EP.8",
        ["(A5), (A8)", "second term h(τ); e^{λ_n(t−σ+τ₁)}", "h(−τ); e^{λ_n(t−σ−τ₁)}"],
        errata_paper::sign_of_delay,
    ),
    entry(
        "EP.9",
        [
            "Table 1, c_f and c_r",
            "1.475 and 1.310 kN s/m",
            "0.0936 k: 1.4742 and 1.3104, from which figure 5's damping ratios come",
        ],
        errata_paper::dampers,
    ),
    entry(
        "EP.10",
        [
            "§2 \"c.g. of the unsprung mass\"; D and d ∈ ℝ⁴ˣ⁴; (28); (A15)",
            "as printed",
            "of the sprung mass; 2 × 2; h(t) is missing; γ is χ",
        ],
        print_only,
    ),
];
