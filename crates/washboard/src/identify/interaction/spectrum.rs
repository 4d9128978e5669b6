//! The model in the frequency domain: eqs. (45) and (46).

use crate::linalg::{C64, CMat};
use crate::lti::{MechanicsError, ModalForm, WheeledSystem};
use crate::road::{Coherence, Road, SAME_TRACK_M};

/// Which of the paper's factors a term is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Delay {
    /// α: wheels side by side.
    None,
    /// β, e^{+iωτ_l}: τ_l in s.
    Ahead(f64),
    /// χ, e^{−iωτ_l}: τ_l in s.
    Behind(f64),
}

/// One term of eq. (46): Γ_p(ω) e^{±iωτ_l} times a constant reference vector a mode.
#[derive(Debug, Clone)]
pub struct Term {
    /// Lateral distance W_p of the tracks, m (0 for one track).
    pub distance_m: f64,
    /// Delay of the axles.
    pub delay: Delay,
    /// α, β or χ: outputs × 2N, column n for mode n.
    pub factors: CMat,
}

/// S_q(ω) = Σₙ φₙ(ω)ψₙᵀ/(iω − λₙ) + ψₙφₙᵀ(−ω)/(−iω − λₙ), φₙ = S_d Σ Γ_p (αₙ + β e^{iωτ} + χ e^{−iωτ}).
///
/// | symbol | shape | meaning |
/// |---|---|---|
/// | poles λₙ | 2N | all poles, conjugates included, 1/s |
/// | shapes ψₙ | outputs × 2N | in the output coordinates |
/// | [`Term`]s | outputs × 2N each | α, β, χ for every pair of tracks and axles |
///
/// Any number of wheels, axles and tracks. Displacements; S in m²·s/rad, two-sided.
#[derive(Debug, Clone)]
pub struct InteractionModel {
    pub(super) poles: Vec<C64>,
    pub(super) psi: CMat,
    pub(super) terms: Vec<Term>,
    pub(super) road: Road,
    pub(super) speed_m_s: f64,
}

impl InteractionModel {
    /// The model of a vehicle with sensors on a road.
    ///
    /// # Errors
    /// A system without modal form (see [`ModalForm::new`]).
    pub fn new(vehicle: &WheeledSystem, road: &Road, speed_m_s: f64) -> Result<Self, MechanicsError> {
        let form = ModalForm::new(vehicle.system())?;
        let modes = form.poles().len();
        let (n, w) = (vehicle.system().order(), vehicle.at_m().len());
        let rows = vehicle.rows();
        let psi = CMat::from_fn(rows.nrows(), modes, |i, m| {
            (0..n).map(|k| form.psi()[(k, m)] * rows[(i, k)]).sum::<C64>()
        });
        // what the force of wheel j excites of mode m: (K_w + λ C_w)ᵀ ℓ; `fixed` takes another λ for the tire damping
        let tire = |j: usize, m: usize, lambda: C64| -> C64 {
            (0..n)
                .map(|k| {
                    let stiffness = C64::new(vehicle.wheel_stiffness()[(k, j)], 0.0);
                    (stiffness + lambda * vehicle.wheel_damping()[(k, j)]) * form.l()[(k, m)]
                })
                .sum()
        };
        let mut terms: Vec<Term> = Vec::new();
        for a in 0..w {
            for b in 0..w {
                let Some((distance_m, delay)) = relation(road.coherence(), vehicle.at_m(), a, b, speed_m_s)
                else {
                    continue;
                };
                // Σ_m ψ_im (k_a − c_a λ_n)ψ_am (k_b + c_b λ_n)ψ_bn / (−m_an m_am (λ_n + λ_m)): corrected (A16)–(A21)
                let factors = CMat::from_fn(rows.nrows(), modes, |i, nn| {
                    let lambda = form.poles()[nn];
                    let sum: C64 = (0..modes)
                        .map(|m| psi[(i, m)] * tire(a, m, -lambda) / (lambda + form.poles()[m]))
                        .sum();
                    -sum * tire(b, nn, lambda)
                });
                match terms.iter_mut().find(|t| same(t, distance_m, delay)) {
                    Some(term) => term.factors += factors,
                    None => terms.push(Term { distance_m, delay, factors }),
                }
            }
        }
        Ok(InteractionModel { poles: form.poles().to_vec(), psi, terms, road: road.clone(), speed_m_s })
    }

    /// All 2N poles λₙ, 1/s.
    #[must_use]
    pub fn poles(&self) -> &[C64] {
        &self.poles
    }

    /// Shapes ψₙ in the output coordinates (outputs × 2N).
    #[must_use]
    pub fn psi(&self) -> &CMat {
        &self.psi
    }

    /// The factors α, β and χ.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// The frequency-dependent reference vectors φₙ(ω) as columns (outputs × 2N), eq. (46).
    #[must_use]
    pub fn reference(&self, omega_rad_s: f64) -> CMat {
        let s = self.road.spectrum().psd(omega_rad_s, self.speed_m_s);
        let mut phi = CMat::zeros(self.psi.nrows(), self.psi.ncols());
        for term in &self.terms {
            let gamma = self.road.coherence().gamma(term.distance_m, omega_rad_s, self.speed_m_s);
            let turn = match term.delay {
                Delay::None => C64::new(1.0, 0.0),
                Delay::Ahead(tau) => C64::new(0.0, omega_rad_s * tau).exp(),
                Delay::Behind(tau) => C64::new(0.0, -omega_rad_s * tau).exp(),
            };
            let weight = turn * (s * gamma);
            for j in 0..phi.ncols() {
                for i in 0..phi.nrows() {
                    phi[(i, j)] += weight * term.factors[(i, j)];
                }
            }
        }
        phi
    }

    /// S_q(ω) (outputs × outputs), eq. (45).
    #[must_use]
    pub fn spectrum(&self, omega_rad_s: f64) -> CMat {
        let first = self.first_fraction(omega_rad_s);
        &first + self.first_fraction(-omega_rad_s).transpose()
    }

    /// The first sum of eq. (45), Σₙ φₙψₙᵀ/(iω − λₙ): what a half spectrum would be, were the inputs white and
    /// uncorrelated. On a road it is not the transform of the positive lags (eq. 49).
    #[must_use]
    pub fn first_fraction(&self, omega_rad_s: f64) -> CMat {
        let phi = self.reference(omega_rad_s);
        let weighted = CMat::from_fn(phi.nrows(), phi.ncols(), |i, n| {
            phi[(i, n)] / (C64::new(0.0, omega_rad_s) - self.poles[n])
        });
        &weighted * self.psi.transpose()
    }
}

/// Lateral distance and delay of a pair of wheels, or None where their roads are unrelated.
fn relation(
    coherence: &Coherence,
    at_m: &[[f64; 2]],
    a: usize,
    b: usize,
    speed_m_s: f64,
) -> Option<(f64, Delay)> {
    let mut distance = (at_m[a][1] - at_m[b][1]).abs();
    match coherence {
        Coherence::Independent if a != b => return None,
        Coherence::None if distance >= SAME_TRACK_M => return None,
        Coherence::None | Coherence::Full => distance = 0.0,
        _ => {}
    }
    // e^{−iω(x_a − x_b)/V}
    let tau = (at_m[a][0] - at_m[b][0]) / speed_m_s;
    let delay = if tau == 0.0 {
        Delay::None
    } else if tau > 0.0 {
        Delay::Behind(tau)
    } else {
        Delay::Ahead(-tau)
    };
    Some((distance, delay))
}

/// Distances and delays that differ by rounding only are one.
fn same(term: &Term, distance_m: f64, delay: Delay) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
    let delays = match (term.delay, delay) {
        (Delay::None, Delay::None) => true,
        (Delay::Ahead(a), Delay::Ahead(b)) | (Delay::Behind(a), Delay::Behind(b)) => near(a, b),
        _ => false,
    };
    delays && near(term.distance_m, distance_m)
}
