//! Variances of a ride's outputs behind filters of their own: frequency-weighted rms.

use super::{CANCELLED_VARIANCE, Driven, Growth, Ride, RideError, Variance, infinite};
use crate::linalg::Mat;
use crate::lti::{Continuous, Responder, StateSpace};
use crate::vehicle::Output;

/// Filters behind outputs, one each, ready for quadrature.
#[derive(Debug)]
pub(super) struct Behind {
    pub responders: Vec<Responder<Continuous>>,
    /// Their poles' sizes: where a quadrature is to look.
    pub corners_rad_s: Vec<f64>,
}

impl Behind {
    fn new(filters: &[&StateSpace<Continuous>]) -> Result<Self, RideError> {
        let mut corners_rad_s = Vec::new();
        for filter in filters {
            corners_rad_s.extend(filter.poles()?.iter().map(|p| p.norm()));
        }
        let responders = filters.iter().map(|f| f.responder()).collect::<Result<_, _>>()?;
        Ok(Behind { responders, corners_rad_s })
    }

    /// |F(iω)|² of the filter behind an output.
    pub fn power_gain(&self, output: usize, omega_rad_s: f64) -> Result<f64, RideError> {
        Ok(self.responders[output].at_frequency(omega_rad_s)?[(0, 0)].norm_sqr())
    }
}

impl Ride<'_> {
    /// Variances of outputs, each behind a stable filter that lets neither a jump nor a mean through at once (strictly proper): a frequency-weighted
    /// rms squared, (1/π) ∫ |F(iω)|² S_y dω.
    ///
    /// The filter's states are appended to those of vehicle, road and controller and Lyapunov's equation gives the variance, delays exact; by
    /// quadrature where [`Ride::variances`] is, and of outputs with white noise in them, which the filter makes finite.
    ///
    /// `filters`: one an output, of one input and one output.
    ///
    /// # Errors
    /// As [`Ride::variances`]; filters that are not as many as outputs, not of one input and one output, or not stable.
    pub fn filtered_variances(
        &self,
        outputs: &[&Output],
        filters: &[&StateSpace<Continuous>],
    ) -> Result<Vec<Variance>, RideError> {
        let shapes = filters.iter().map(|f| (f.outputs(), f.inputs()));
        if filters.len() != outputs.len() || shapes.into_iter().any(|s| s != (1, 1)) {
            let expected = (outputs.len(), 1);
            let name = "filters behind outputs";
            return Err(crate::lti::LtiError::Shape { name, expected, found: (filters.len(), 1) }.into());
        }
        filters.iter().try_for_each(|f| f.check_stable("a filter behind an output"))?;
        let driven = self.driven(outputs)?.filter(|_| !self.is_bogsjo());
        let mut found: Vec<Option<Variance>> = vec![None; outputs.len()];
        if let Some(d) = &driven {
            for (i, whole) in self.variances(outputs)?.into_iter().enumerate() {
                found[i] = match (whole, d.growth[i]) {
                    (Variance::Finite(0.0), _) => Some(Variance::Finite(0.0)),
                    (Variance::Finite(whole), Growth::Finite) => self
                        .behind_state(d, i, filters[i])?
                        .filter(|v| *v > CANCELLED_VARIANCE * whole)
                        .map(Variance::Finite),
                    (_, Growth::Wandering) => infinite(d.growth[i]),
                    _ => None,
                };
            }
        }
        let open: Vec<usize> = (0..outputs.len()).filter(|i| found[*i].is_none()).collect();
        let (outputs, filters): (Vec<&Output>, Vec<_>) =
            open.iter().map(|i| (outputs[*i], filters[*i])).unzip();
        for (i, v) in open.into_iter().zip(self.filtered_by_quadrature(&outputs, &filters)?) {
            found[i] = Some(Variance::Finite(v));
        }
        Ok(found.into_iter().flatten().collect())
    }

    /// The same by quadrature alone, of outputs that do not wander.
    ///
    /// # Errors
    /// A quadrature that does not reach its accuracy.
    pub fn filtered_by_quadrature(
        &self,
        outputs: &[&Output],
        filters: &[&StateSpace<Continuous>],
    ) -> Result<Vec<f64>, RideError> {
        let behind = Behind::new(filters)?;
        Ride { behind: Some(&behind), ..self.clone() }.integrate_spectra(outputs)
    }

    /// E\[y²\] behind a filter: ẋ_F = A_F x_F + B_F c x beside the driven state.
    fn behind_state(
        &self,
        driven: &Driven,
        output: usize,
        filter: &StateSpace<Continuous>,
    ) -> Result<Option<f64>, RideError> {
        let (n, m) = (driven.a.nrows(), filter.order());
        let a = Mat::from_fn(n + m, n + m, |i, j| match (i < n, j < n) {
            (true, true) => driven.a[(i, j)],
            (true, false) => 0.0,
            (false, true) => filter.b()[(i - n, 0)] * driven.c[(output, j)],
            (false, false) => filter.a()[(i - n, j - n)],
        });
        let b = Mat::from_fn(n + m, driven.b.ncols(), |i, x| if i < n { driven.b[(i, x)] } else { 0.0 });
        let through = filter.d()[(0, 0)];
        let seen = |j: usize| if j < n { through * driven.c[(output, j)] } else { filter.c()[(0, j - n)] };
        let c = Mat::from_fn(1, n + m, |_, j| seen(j));
        let outputs = vec![driven.outputs[output].clone()];
        let whole = Driven { a, b, c, growth: vec![Growth::Finite], outputs }.balanced()?;
        let variance = &whole.c * self.state_covariance(&whole, 0.0)? * whole.c.transpose();
        Ok(Some(variance[(0, 0)]).filter(|v| v.is_finite()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::Coherence;
    use crate::vehicle::test_cases as cases;
    use crate::vehicle::{Disturbance, PlantSettings};

    /// A band-pass about ω₀ with a zero at rest.
    fn band_pass(omega: f64) -> StateSpace<Continuous> {
        let a = Mat::from_fn(2, 2, |i, j| [[0.0, omega], [-omega, -1.4 * omega]][i][j]);
        let b = Mat::from_fn(2, 1, |i, _| [0.0, omega][i]);
        StateSpace::continuous(a, b, Mat::from_fn(1, 2, |_, j| [0.0, 1.4][j]), Mat::zeros(1, 1)).unwrap()
    }

    #[test]
    fn three_routes_to_a_filtered_rms_agree() {
        // Lyapunov with the filter's states, quadrature of |F|² S, and the H2 norm of the generalised plant in series with F
        for (case, road, names) in [
            ("turkay-quarter-car", "turkay-white-velocity", vec!["sprung_acceleration", "suspension_travel"]),
            ("turkay-half-car", "turkay-first-order", vec!["heave_acceleration", "pitch_acceleration"]),
        ] {
            let car = cases::vehicle(case).unwrap();
            let road = cases::road(road).unwrap().with_coherence(Coherence::Independent);
            let z: Vec<&Output> = names.iter().map(|n| car.output(n).unwrap()).collect();
            let ride = Ride::new(&car, &road, 20.0).unwrap();
            let (slow, fast) = (band_pass(8.0), band_pass(60.0));
            let found = ride.filtered_variances(&z, &[&slow, &fast]).unwrap();
            let integral = ride.filtered_by_quadrature(&z, &[&slow, &fast]).unwrap();
            let settings = PlantSettings {
                road: (&road).into(),
                speed_m_s: 20.0,
                disturbance: Disturbance::RoadNoise,
                delay_order: 2,
            };
            let plant = car.plant(&z, &[], &settings).unwrap().passive();
            let h2 = plant.series(&slow.append(&fast).unwrap()).unwrap().h2_of_outputs().unwrap();
            for i in 0..2 {
                let rms = found[i].rms().unwrap();
                assert!((rms / h2[i] - 1.0).abs() < 1e-9, "{case} {}: {rms} {}", names[i], h2[i]);
                assert!((rms / integral[i].sqrt() - 1.0).abs() < 1e-7, "{case} {}: {rms}", names[i]);
                let whole = ride.variances(&[z[i]]).unwrap()[0].rms().unwrap();
                assert!(rms < 0.99 * whole && rms > 0.1 * whole, "{rms} {whole}");
            }
        }
    }

    #[test]
    fn white_noise_is_finite_behind_a_filter_and_delays_are_exact() {
        // a damped tire on a road of white velocity: white noise in the wheel's acceleration
        let spec = cases::spec("turkay-quarter-car");
        let car =
            spec.with_overrides(&[("tire_damping_n_s_per_m".into(), 80.0)]).unwrap().build_alone().unwrap();
        let road = cases::road("turkay-white-velocity").unwrap();
        let z = [car.output("unsprung_acceleration").unwrap()];
        let ride = Ride::new(&car, &road, 20.0).unwrap();
        assert_eq!(ride.variances(&z).unwrap()[0].rms(), None);
        let low = band_pass(30.0);
        assert!(ride.filtered_variances(&z, &[&low]).unwrap()[0].rms().is_some_and(|v| v > 0.0));
        // the rear wheel follows the front one: by Lyapunov with e^{Aδ}, and by quadrature
        let half = cases::vehicle("turkay-half-car").unwrap();
        let z = [half.output("pitch_acceleration").unwrap()];
        let road = cases::road("turkay-first-order").unwrap();
        let ride = Ride::new(&half, &road, 20.0).unwrap();
        let exact = ride.filtered_variances(&z, &[&low]).unwrap()[0].rms().unwrap();
        let integral = ride.filtered_by_quadrature(&z, &[&low]).unwrap()[0].sqrt();
        assert!((exact / integral - 1.0).abs() < 1e-7, "{exact} {integral}");
    }

    #[test]
    fn filters_that_do_not_fit_are_refused() {
        let car = cases::vehicle("turkay-quarter-car").unwrap();
        let road = cases::road("iso8608-c").unwrap();
        let ride = Ride::new(&car, &road, 20.0).unwrap();
        let z = [car.output("sprung_acceleration").unwrap()];
        assert!(ride.filtered_variances(&z, &[]).is_err());
        let grows = StateSpace::continuous(
            Mat::identity(1, 1),
            Mat::identity(1, 1),
            Mat::identity(1, 1),
            Mat::zeros(1, 1),
        );
        assert!(ride.filtered_variances(&z, &[&grows.unwrap()]).unwrap_err().to_string().contains("stable"));
    }
}
