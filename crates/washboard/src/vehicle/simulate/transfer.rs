//! From road heights to channels: the transfer functions that a drive is made of.

use super::super::Vehicle;
use crate::linalg::{C64, CMat};
use crate::lti::ModalForm;

/// (iω)^d R G(ω)(K_w + iωC_w): by modes where the system has them, else by solving.
pub(super) struct Transfer<'a> {
    vehicle: &'a Vehicle,
    looks: &'a [(Vec<f64>, usize)],
    /// Poles, and residues per (channel, wheel).
    modal: Option<(Vec<C64>, Vec<CMat>)>,
}

impl<'a> Transfer<'a> {
    pub fn new(vehicle: &'a Vehicle, looks: &'a [(Vec<f64>, usize)]) -> Self {
        let n = vehicle.system().order();
        let wheels = vehicle.wheels().len();
        let modal = ModalForm::new(vehicle.system()).ok().map(|form| {
            let residues = (0..form.poles().len())
                .map(|m| {
                    let input = |j: usize| -> C64 {
                        (0..n)
                            .map(|k| {
                                let stiffness = C64::new(vehicle.wheel_stiffness()[(k, j)], 0.0);
                                (stiffness + form.poles()[m] * vehicle.wheel_damping()[(k, j)])
                                    * form.l()[(k, m)]
                            })
                            .sum()
                    };
                    CMat::from_fn(looks.len(), wheels, |i, j| {
                        (0..n).map(|k| form.psi()[(k, m)] * looks[i].0[k]).sum::<C64>() * input(j)
                    })
                })
                .collect();
            (form.poles().to_vec(), residues)
        });
        Transfer { vehicle, looks, modal }
    }

    pub fn at(&self, omega: f64) -> CMat {
        let wheels = self.vehicle.wheels().len();
        let iw = C64::new(0.0, omega);
        let powers = [C64::new(1.0, 0.0), iw, iw * iw];
        if let Some((poles, residues)) = &self.modal {
            let mut h = CMat::zeros(self.looks.len(), wheels);
            for (pole, residue) in poles.iter().zip(residues) {
                let factor = C64::new(1.0, 0.0) / (iw - pole);
                for j in 0..wheels {
                    for i in 0..self.looks.len() {
                        h[(i, j)] += residue[(i, j)] * factor;
                    }
                }
            }
            return CMat::from_fn(self.looks.len(), wheels, |i, j| h[(i, j)] * powers[self.looks[i].1]);
        }
        // a damped vehicle has no resonance on the axis, so that the solution exists
        let q = self
            .vehicle
            .road_response(omega)
            .unwrap_or_else(|_| CMat::zeros(self.vehicle.system().order(), wheels));
        CMat::from_fn(self.looks.len(), wheels, |i, j| {
            self.looks[i].0.iter().enumerate().map(|(k, v)| q[(k, j)] * *v).sum::<C64>()
                * powers[self.looks[i].1]
        })
    }
}
