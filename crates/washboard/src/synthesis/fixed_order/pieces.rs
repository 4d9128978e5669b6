//! The pieces of a fixed-order problem at a controller: peaks, H2 norms and eigenvalues, with their gradients.

use super::closed::Closed;
use super::eigenvalues::Spectrum;
use super::h2_norm::h2_norm;
use super::peaks::find;
use super::problem::{Id, Kind, Of, Problem, Wanted};
use super::resolvent::{Resolvent, form};
use super::targets::Channel;
use crate::linalg::{C64, Mat, RealSchur};
use crate::optimize::{Pieces, Role, SmoothPiece};
use std::sync::atomic::Ordering::Relaxed;

/// Eigenvalues count whose real part is within this of the largest, as a share of the unit.
const BESIDE: f64 = 0.05;
/// Eigenvalues farther below a bound than this are not asked about.
const ROOM: f64 = 0.7;
/// Poles farther left of it than this, in units of the pace, are not asked about.
const FAR_LEFT: f64 = 0.1;
/// Eigenvalues of one matrix that count at most.
const MOST_EIGENVALUES: usize = 6;

impl Problem {
    /// Pieces of all wants of a plant; none where its loop is not stable.
    fn of_plant(&self, plant: usize, block: &Mat, out: &mut Vec<SmoothPiece<Id>>) -> Option<()> {
        let wants: Vec<usize> = (0..self.wanted.len()).filter(|t| self.wanted[*t].plant == plant).collect();
        if wants.is_empty() && !self.stable[plant] {
            return Some(());
        }
        let closed = self.close(plant, block)?;
        self.counters.eigenproblems.fetch_add(1, Relaxed);
        let form = form(&closed);
        let poles = match &form {
            Some(f) => RealSchur::eigenvalues_of_hessenberg(&f.h, f.order).ok()?,
            None if closed.a.nrows() == 0 => Vec::new(),
            None => RealSchur::only_eigenvalues(&closed.a).ok()?,
        };
        if self.stable[plant] {
            let worst = poles.iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max);
            // what a certificate would not call stable
            let size = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
            if !(worst < -1e-12 * size) {
                return None;
            }
        }
        let order = self.structure.order();
        let of_hinf = |t: &&usize| matches!(self.wanted[**t].kind, Kind::Hinf(_));
        let channels: Vec<(usize, &Channel, f64, bool)> = wants
            .iter()
            .filter(of_hinf)
            .filter_map(|t| match &self.wanted[*t].kind {
                Kind::Hinf(c) => Some((*t, c, self.wanted[*t].unit, self.wanted[*t].role != Role::Goal)),
                _ => None,
            })
            .collect();
        if !channels.is_empty() {
            let mut resolvent = Resolvent::new(&self.opens[plant], &closed, order, form, self.room());
            let found = find(&mut resolvent, &channels, &poles, &self.frequencies);
            for (t, peaks) in found.iter().flatten() {
                for peak in peaks {
                    let id = Id { target: *t, of: Of::Peak(peak.clone()) };
                    out.extend(self.peak_piece(&mut resolvent, &closed, id));
                }
            }
            self.done(resolvent);
            found?;
        }
        for t in wants {
            match &self.wanted[t].kind {
                Kind::Hinf(_) => {}
                Kind::H2(_) => out.push(self.h2_piece(t, &closed)?),
                Kind::Abscissa | Kind::Margin | Kind::Radius => {
                    out.extend(self.eigenvalue_pieces(t, &closed, &poles)?)
                }
            }
        }
        Some(())
    }

    fn peak_piece(&self, resolvent: &mut Resolvent, closed: &Closed, id: Id) -> Option<SmoothPiece<Id>> {
        let Of::Peak(peak) = &id.of else { return None };
        let (value, zu, yw) = resolvent.derivative(peak.omega, &peak.u, &peak.v)?;
        if !(value.re > 0.0 && value.re.is_finite()) {
            return None;
        }
        let by_block = Mat::from_fn(zu.len(), yw.len(), |i, j| (zu[i] * yw[j]).re / value.re);
        let wanted = &self.wanted[id.target];
        let gradient = self.gradient(closed, by_block);
        Some(SmoothPiece { role: wanted.role, value: value.re.ln() - wanted.unit, gradient, id })
    }

    fn h2_piece(&self, target: usize, closed: &Closed) -> Option<SmoothPiece<Id>> {
        let wanted = &self.wanted[target];
        let Kind::H2(channel) = &wanted.kind else { return None };
        self.counters.lyapunov.fetch_add(2, Relaxed);
        let (norm, by_block) = h2_norm(&self.opens[wanted.plant], closed, channel, self.structure.order())?;
        let gradient = self.gradient(closed, by_block);
        let id = Id { target, of: Of::Smooth };
        Some(SmoothPiece { role: wanted.role, value: norm.ln() - wanted.unit, gradient, id })
    }

    fn eigenvalue_pieces(
        &self,
        target: usize,
        closed: &Closed,
        poles: &[C64],
    ) -> Option<Vec<SmoothPiece<Id>>> {
        let wanted = &self.wanted[target];
        // a bound with much room needs no derivative
        let height = |v: &C64| self.eigenvalue_height(wanted, *v);
        let highest = poles.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
        let room = if matches!(wanted.kind, Kind::Margin) { FAR_LEFT } else { ROOM };
        if poles.is_empty() || (wanted.role != Role::Goal && highest < -room) {
            return Some(Vec::new());
        }
        self.counters.eigenproblems.fetch_add(1, Relaxed);
        let spectrum = Spectrum::of(&closed.a, poles.to_vec())?;
        let mut all: Vec<(f64, usize)> = (0..spectrum.values.len())
            .filter(|k| spectrum.values[*k].im >= 0.0)
            .map(|k| (self.eigenvalue_height(wanted, spectrum.values[k]), k))
            .collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let top = all.first()?.0;
        let near = all.iter().take_while(|(h, _)| *h >= top - BESIDE).take(MOST_EIGENVALUES);
        // one that is left out would be one that the search does not see: then nothing is known here
        near.map(|(_, k)| self.eigenvalue_piece(target, closed, &spectrum, *k)).collect()
    }

    fn eigenvalue_height(&self, wanted: &Wanted, value: C64) -> f64 {
        match (&wanted.kind, wanted.role) {
            (Kind::Radius, _) => value.norm().max(f64::MIN_POSITIVE).ln() - wanted.unit,
            (_, Role::Goal) => value.re / wanted.unit,
            _ => (value.re - wanted.unit) / self.scales.pace,
        }
    }

    fn eigenvalue_piece(
        &self,
        target: usize,
        closed: &Closed,
        spectrum: &Spectrum,
        k: usize,
    ) -> Option<SmoothPiece<Id>> {
        let wanted = &self.wanted[target];
        let value = spectrum.values[k];
        let along = match (&wanted.kind, wanted.role) {
            (Kind::Radius, _) => value.conj() / value.norm_sqr().max(f64::MIN_POSITIVE),
            (_, Role::Goal) => C64::new(1.0 / wanted.unit, 0.0),
            _ => C64::new(1.0 / self.scales.pace, 0.0),
        };
        let by_block = spectrum.derivative(k, &self.opens[wanted.plant], self.structure.order(), along)?;
        let gradient = self.gradient(closed, by_block);
        let id = Id { target, of: Of::Eigenvalue(value) };
        Some(SmoothPiece { role: wanted.role, value: self.eigenvalue_height(wanted, value), gradient, id })
    }
}

impl Pieces for Problem {
    type Id = Id;

    fn dimension(&self) -> usize {
        self.free.len()
    }

    fn pieces(&self, x: &[f64]) -> Option<Vec<SmoothPiece<Id>>> {
        let block = self.block(x);
        let mut out = Vec::new();
        for plant in 0..self.opens.len() {
            self.of_plant(plant, &block, &mut out)?;
        }
        Some(out)
    }

    fn again(&self, ids: &[&Id], x: &[f64]) -> Vec<Option<SmoothPiece<Id>>> {
        let block = self.block(x);
        let mut out = vec![None; ids.len()];
        for plant in 0..self.opens.len() {
            let here: Vec<usize> =
                (0..ids.len()).filter(|k| self.wanted[ids[*k].target].plant == plant).collect();
            if here.is_empty() {
                continue;
            }
            let Some(closed) = self.close(plant, &block) else { continue };
            let mut resolvent = None;
            let mut spectrum = None;
            for k in here {
                let id = ids[k];
                out[k] = match &id.of {
                    Of::Peak(_) => {
                        let r = resolvent.get_or_insert_with(|| {
                            let order = self.structure.order();
                            Resolvent::new(&self.opens[plant], &closed, order, form(&closed), self.room())
                        });
                        self.peak_piece(r, &closed, id.clone())
                    }
                    Of::Smooth => self.h2_piece(id.target, &closed),
                    Of::Eigenvalue(value) => {
                        if spectrum.is_none() {
                            spectrum = Spectrum::new(&closed.a);
                        }
                        spectrum
                            .as_ref()
                            .and_then(|s| self.eigenvalue_piece(id.target, &closed, s, s.nearest(*value)?))
                    }
                };
            }
            if let Some(r) = resolvent {
                self.done(r);
            }
        }
        out
    }

    fn apart(&self, one: &Id, other: &Id) -> Option<f64> {
        if one.target != other.target {
            return None;
        }
        match (&one.of, &other.of) {
            (Of::Smooth, Of::Smooth) => Some(0.0),
            (Of::Eigenvalue(a), Of::Eigenvalue(b)) => {
                Some((a - b).norm() / a.norm().max(b.norm()).max(1e-300))
            }
            (Of::Peak(a), Of::Peak(b)) => {
                let norm = |z: &[C64]| z.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
                let (p, q) = (&a.u, &b.u);
                let along = p.iter().zip(q).map(|(p, q)| p.conj() * q).sum::<C64>() / (norm(p) * norm(q));
                let ratio = match (a.omega, b.omega) {
                    (a, b) if a == b => 0.0,
                    (a, b) if a == 0.0 || b == 0.0 || a.is_infinite() || b.is_infinite() => f64::INFINITY,
                    (a, b) => (a / b).ln().abs(),
                };
                Some(ratio + (1.0 - along.norm()).max(0.0))
            }
            _ => None,
        }
    }
}
