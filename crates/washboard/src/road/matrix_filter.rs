//! Rational filters of several road inputs at once: the spectrum matrix of chassis points or of wheels, delays and coherence included.

use super::{RoadError, Shapes};
use crate::linalg::{C64, CMat, Mat, eigen, solve};
use crate::lti::{Continuous, StateSpace};

/// A height that a velocity filter leaves standing, below this share of its terms, is rounding.
const SETTLED: f64 = 1e-12;
/// How names of a truck cabin's road inputs begin.
const CHASSIS: &str = "chassis_";

/// y = C(sI − A)⁻¹B + D, driven by unit-intensity white noises: one output a road input of the vehicle.
///
/// G(iω)G(iω)ᴴ is the spectrum of what stands under the vehicle, E\[y_i y_j*\]: all that is known of the relation of one input
/// to another, delays included. Over *distance* it is, at speed v over time, G(s/v)/√v.
///
/// Source: Türkay's thesis, eq. (8.1): ẋ_w = A_w x_w + B_w ν, w = C_w x_w.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixFilter {
    system: StateSpace<Continuous>,
    of: Shapes,
    over_distance: bool,
    points: Vec<String>,
    band_rad: Option<[f64; 2]>,
}

impl MatrixFilter {
    /// A filter from its state space; `points` are the names of its outputs (none: the vehicle's own order), `band_rad` is
    /// where it may be believed (rad/s, or rad/m over distance).
    ///
    /// # Errors
    /// A system without inputs or outputs, a pole that is not in the open left half plane, another number of names than of
    /// outputs, a name that is there twice, a band that is none.
    pub fn new(
        system: StateSpace<Continuous>,
        of: Shapes,
        over_distance: bool,
        points: Vec<String>,
        band_rad: Option<[f64; 2]>,
    ) -> Result<Self, RoadError> {
        let (m, k) = (system.outputs(), system.inputs());
        if m == 0 || k == 0 {
            let found = format!("{m} rows of c and {k} columns of b");
            return Err(RoadError::Field { field: "c", expected: "one row or more, driven by b", found });
        }
        check_stable(&system)?;
        if !points.is_empty() && points.len() != m {
            let found = format!("{} names for {m} rows of c", points.len());
            return Err(RoadError::Field { field: "points", expected: "one name a row of c", found });
        }
        if let Some(name) = points.iter().enumerate().find(|(i, p)| points[..*i].contains(p)).map(|(_, p)| p)
        {
            let found = format!("`{name}` twice");
            return Err(RoadError::Field { field: "points", expected: "every name once", found });
        }
        check_fitted_band(band_rad)?;
        Ok(MatrixFilter { system, of, over_distance, points, band_rad })
    }

    /// How many road inputs it has.
    #[must_use]
    pub fn size(&self) -> usize {
        self.system.outputs()
    }

    /// Their names; none where they are the vehicle's in its own order.
    #[must_use]
    pub fn points(&self) -> &[String] {
        &self.points
    }

    /// What the outputs are.
    #[must_use]
    pub fn of(&self) -> Shapes {
        self.of
    }

    /// Whether it runs over distance, and so gives a road of its own at any speed.
    #[must_use]
    pub fn is_over_distance(&self) -> bool {
        self.over_distance
    }

    /// Where it may be believed, rad per its own variable.
    #[must_use]
    pub fn band_rad(&self) -> Option<[f64; 2]> {
        self.band_rad
    }

    /// The filter itself, in its own variable.
    #[must_use]
    pub fn system(&self) -> &StateSpace<Continuous> {
        &self.system
    }

    /// The same filter with its outputs in the order of these names (as it is, where it has none).
    ///
    /// # Errors
    /// Another number of names than of outputs; names that are not the filter's.
    pub fn in_order(&self, names: &[String]) -> Result<Self, RoadError> {
        let listed = |names: &[String]| names.join(", ");
        if names.len() != self.size() {
            let found = format!("{} points, {} road inputs ({})", self.size(), names.len(), listed(names));
            let expected = "as many points as the vehicle has road inputs";
            return Err(RoadError::Field { field: "points", expected, found });
        }
        if self.points.is_empty() {
            return Ok(self.clone());
        }
        let rows: Option<Vec<usize>> =
            names.iter().map(|n| self.points.iter().position(|p| p == n)).collect();
        let Some(rows) = rows else {
            let stray = self.points.iter().find(|p| !names.contains(p)).map_or("", String::as_str);
            let near = crate::files::nearest(stray, names.iter().map(String::as_str));
            let hint = match near {
                Some(name) => format!(" (`{stray}`: did you mean `{name}`?)"),
                None if stray.starts_with(CHASSIS) => {
                    format!(" ({CHASSIS}… are the points of a truck cabin, and this vehicle is none)")
                }
                None => String::new(),
            };
            let found = format!("{}; the vehicle has {}{hint}", listed(&self.points), listed(names));
            return Err(RoadError::Field { field: "points", expected: "the vehicle's road inputs", found });
        };
        let picked = |m: &Mat| Mat::from_fn(rows.len(), m.ncols(), |i, j| m[(rows[i], j)]);
        let g = &self.system;
        let system = remade(g.a().clone(), g.b().clone(), picked(g.c()), picked(g.d()))?;
        Ok(MatrixFilter { system, points: names.to_vec(), ..self.clone() })
    }

    /// The same inputs seen over time at a speed (itself, where it is over time already): (vA, √v B, C, D/√v), of velocity
    /// with C and D times v.
    ///
    /// # Errors
    /// A speed that leaves no finite matrices.
    pub fn over_time(&self, speed_m_s: f64) -> Result<Self, RoadError> {
        if !self.over_distance {
            return Ok(self.clone());
        }
        let v = speed_m_s;
        let out = if self.of == Shapes::Velocity { v } else { 1.0 };
        let scaled = |m: &Mat, by: f64| m * faer::Scale(by);
        let g = &self.system;
        let system = remade(
            scaled(g.a(), v),
            scaled(g.b(), v.sqrt()),
            scaled(g.c(), out),
            scaled(g.d(), out / v.sqrt()),
        )?;
        let band_rad = self.band_rad.map(|b| b.map(|w| w * v));
        Ok(MatrixFilter { system, over_distance: false, band_rad, ..self.clone() })
    }

    /// The same inputs as a filter of height, where one of velocity over time has G(0) = 0, so that no height wanders off:
    /// r = C A⁻¹ x. Itself otherwise.
    #[must_use]
    pub(crate) fn as_height(&self) -> Self {
        let g = &self.system;
        if self.of == Shapes::Height || g.order() == 0 {
            return self.clone();
        }
        // C A⁻¹ = (A⁻ᵀ Cᵀ)ᵀ; a stable A has an inverse
        let Ok(x) = solve(&g.a().transpose().to_owned(), &g.c().transpose().to_owned()) else {
            return self.clone();
        };
        let c = x.transpose().to_owned();
        for i in 0..g.outputs() {
            for j in 0..g.inputs() {
                let terms = (0..g.order()).map(|k| c[(i, k)] * g.b()[(k, j)]);
                let (sum, size) = terms.fold((0.0, 0.0), |(s, a), t| (s + t, a + f64::abs(t)));
                if (sum - g.d()[(i, j)]).abs() > SETTLED * (size + g.d()[(i, j)].abs()) {
                    return self.clone();
                }
            }
        }
        match remade(g.a().clone(), g.b().clone(), c, Mat::zeros(g.outputs(), g.inputs())) {
            Ok(system) => MatrixFilter { system, of: Shapes::Height, ..self.clone() },
            Err(_) => self.clone(),
        }
    }

    /// The spectrum matrix of heights at ω of a filter over time, two-sided, S_ij = E\[r_i* r_j\]; NaN where a pole stands at ω
    /// exactly.
    #[must_use]
    pub fn height_spectrum(&self, omega_rad_s: f64) -> CMat {
        let m = self.size();
        let Ok(g) = self.system.at(C64::new(0.0, omega_rad_s)) else {
            return CMat::from_fn(m, m, |_, _| C64::new(f64::NAN, 0.0));
        };
        let scale = if self.of == Shapes::Velocity { (omega_rad_s * omega_rad_s).recip() } else { 1.0 };
        let s = g.conjugate() * g.transpose();
        CMat::from_fn(m, m, |i, j| s[(i, j)] * scale)
    }
}

fn remade(a: Mat, b: Mat, c: Mat, d: Mat) -> Result<StateSpace<Continuous>, RoadError> {
    StateSpace::continuous(a, b, c, d).map_err(|e| RoadError::Field {
        field: "a, b, c, d",
        expected: "finite matrices whose sizes fit",
        found: e.to_string(),
    })
}

fn check_stable(system: &StateSpace<Continuous>) -> Result<(), RoadError> {
    if system.order() == 0 {
        return Ok(());
    }
    let expected = "a stable filter (all poles with negative real part)";
    let (poles, _) = eigen(system.a()).map_err(|e| RoadError::Field {
        field: "a",
        expected: "a finite matrix",
        found: e.to_string(),
    })?;
    let worst = poles.iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max);
    if worst < 0.0 {
        return Ok(());
    }
    let found = format!("a pole with real part {worst}");
    Err(RoadError::Field { field: "a", expected, found })
}

/// The band of the data that a filter was fitted to: two ascending frequencies.
pub(super) fn check_fitted_band(band: Option<[f64; 2]>) -> Result<(), RoadError> {
    match band {
        Some([low, high]) if !(low >= 0.0 && high > low && high.is_finite()) => {
            let expected = "two ascending frequencies, 0 or more";
            Err(RoadError::Field { field: "fitted_band_rad", expected, found: format!("[{low}, {high}]") })
        }
        _ => Ok(()),
    }
}
