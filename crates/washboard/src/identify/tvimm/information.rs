//! The Fisher information of free modes, by the structure of the response's derivatives.

use super::model::{Evaluation, FreeModel, Point};
use super::orbit::Entries;
use crate::identify::likelihood::{Place, Road, Whitening, information_bins};
use crate::linalg::small::{ZERO, product};
use crate::linalg::{C64, Mat};
use faer::MatRef;
use rayon::prelude::*;

/// Bins are summed in so many parts, whatever the number of threads: the same bits on all.
const PARTS: usize = 8;

/// n_avg Σ_k Re tr(S⁻¹ ∂_aS S⁻¹ ∂_bS), each bin's derivatives as at its middle.
///
/// An entry (l, r) moves S by conj(u_l) z_rᵀP + h.c. with u_l a column of \[Y, W\] and z_r a row of \[X; I\]. With
/// ũ = L⁻¹conj(u) and p̃ = conj(z)P L⁻ᴴ, M₁ = p̃ũ, M₂ = p̃p̃ᴴ and M₃ = ũᴴũ,
/// F_(l,r)(k,s) = 2 Σ_k Re(M₁\[r, k\] M₁\[s, l\] + M₂\[r, s\] M₃\[k, l\]): two products of real matrices whose inner
/// dimension runs over the bins.
pub(super) fn information(
    model: &FreeModel,
    evaluation: &Evaluation,
    whitening: &Whitening,
    at: &Point,
) -> Mat {
    let (bins, weight) = information_bins(model.data.measured.len());
    let weight = weight * model.data.averages;
    let e = Entries::of(&at.system);
    let sizes = Sizes { n: e.outputs, wheels: e.inputs, states: e.states };
    let (rows, wide) = (e.rows(), sizes.wide());
    let [one, two, three] = [wide * rows, wide * wide, rows * rows];
    let road = model.road(at);
    let mut grams = vec![0.0; bins.len() * 2 * (2 * one + two + three)];
    let tails: Vec<Mat> = grams
        .par_chunks_mut(bins.len().div_ceil(PARTS) * 2 * (2 * one + two + three))
        .zip(bins.par_chunks(bins.len().div_ceil(PARTS)))
        .map(|(grams, bins)| {
            let mut tail = Mat::zeros(e.len() + 4 + sizes.n, 4 + sizes.n);
            for (bin, out) in bins.iter().zip(grams.chunks_exact_mut(2 * (2 * one + two + three))) {
                if let Some(place) = evaluation.grid.at(model.data.middle(*bin)) {
                    let whitened = Bin::new(sizes, place, whitening.inverse(*bin));
                    whitened.grams(out);
                    whitened.tail(&mut tail, &road, place, whitening.inverse(*bin), at);
                }
            }
            tail
        })
        .collect();
    let mut tail = Mat::zeros(e.len() + 4 + sizes.n, 4 + sizes.n);
    tails.iter().for_each(|t| tail += t);
    // each bin's block: M₁'s real and imaginary parts, the same with the imaginary part turned, M₂'s, M₃'s turned
    let all = MatRef::from_column_major_slice(&grams, 2 * (2 * one + two + three), bins.len());
    let stacked = |from: usize, size: usize| {
        Mat::from_fn(size, 2 * bins.len(), |i, k| all[(from + (k % 2) * size + i, k / 2)])
    };
    let (first, second) = rayon::join(
        || stacked(0, one) * stacked(2 * one, one).transpose(),
        || stacked(4 * one, two) * stacked(4 * one + 2 * two, three).transpose(),
    );
    let p = e.len() + 4 + sizes.n;
    let place: Vec<(usize, usize)> = (0..rows).flat_map(|l| (0..e.row(l).1).map(move |r| (l, r))).collect();
    Mat::from_fn(p, p, |a, b| {
        let (a, b) = (a.min(b), a.max(b));
        if b >= e.len() {
            return weight * tail[(a, b - e.len())];
        }
        let ((l, r), (k, s)) = (place[a], place[b]);
        2.0 * weight * (first[(r * rows + k, s * rows + l)] + second[(r * wide + s, k * rows + l)])
    })
}

#[derive(Clone, Copy)]
struct Sizes {
    n: usize,
    wheels: usize,
    states: usize,
}

impl Sizes {
    fn wide(self) -> usize {
        self.states + self.wheels
    }

    fn rows(self) -> usize {
        self.states + self.n
    }
}

/// One bin's whitened parts.
struct Bin {
    sizes: Sizes,
    /// ũ (channels × rows).
    u: Vec<C64>,
    /// p̃ (wide × channels).
    right: Vec<C64>,
}

impl Bin {
    fn new(sizes: Sizes, place: Place<'_>, inverse: &[C64]) -> Self {
        let Sizes { n, wheels, states } = sizes;
        let (rows, wide) = (sizes.rows(), sizes.wide());
        let mut plain = vec![ZERO; n * rows];
        for i in 0..n {
            (0..states).for_each(|l| plain[i * rows + l] = place.y[i * states + l].conj());
            plain[i * rows + states + i] = place.weight[i].conj();
        }
        let mut u = vec![ZERO; n * rows];
        product(&mut u, [n, n, rows], |i, j| inverse[i * n + j], &plain);
        // P L⁻ᴴ
        let mut half = vec![ZERO; wheels * n];
        for i in 0..wheels {
            for j in 0..n {
                half[i * n + j] = (0..=j).map(|k| place.p[i * n + k] * inverse[j * n + k].conj()).sum();
            }
        }
        let mut right = vec![ZERO; wide * n];
        product(&mut right, [states, wheels, n], |i, j| place.x[i * wheels + j].conj(), &half);
        right[states * n..].copy_from_slice(&half);
        Bin { sizes, u, right }
    }

    /// M₁, M₁ and M₂ with real parts first, M₃; of the second factors the imaginary parts with their sign turned, so that
    /// a product of real matrices is the real part of one of complex matrices.
    fn grams(&self, out: &mut [f64]) {
        let (n, rows, wide) = (self.sizes.n, self.sizes.rows(), self.sizes.wide());
        let (mut m1, mut m2, mut m3) =
            (vec![ZERO; wide * rows], vec![ZERO; wide * wide], vec![ZERO; rows * rows]);
        product(&mut m1, [wide, n, rows], |i, j| self.right[i * n + j], &self.u);
        for i in 0..wide {
            for j in 0..wide {
                let (a, b) = (&self.right[i * n..(i + 1) * n], &self.right[j * n..(j + 1) * n]);
                m2[i * wide + j] = a.iter().zip(b).map(|(x, y)| x * y.conj()).sum();
            }
        }
        product(&mut m3, [rows, n, rows], |i, j| self.u[j * rows + i].conj(), &self.u);
        let mut rest = out;
        for (m, sign) in [(&m1, 1.0), (&m1, -1.0), (&m2, 1.0), (&m3, -1.0)] {
            let (part, more) = std::mem::take(&mut rest).split_at_mut(2 * m.len());
            let (re, im) = part.split_at_mut(m.len());
            for ((re, im), v) in re.iter_mut().zip(im).zip(m) {
                (*re, *im) = (v.re, sign * v.im);
            }
            rest = more;
        }
    }

    /// Adds the columns of road and noise. A derivative of the road is V = L⁻¹H* S' HᵀL⁻ᴴ, one of noise ν ee ᴴ with e a
    /// column of L⁻¹; with an entry, Re tr(V(ũp̃ + h.c.)) = 2 Re p̃Vũ.
    fn tail(&self, tail: &mut Mat, road: &Road<'_>, place: Place<'_>, inverse: &[C64], at: &Point) {
        let Sizes { n, wheels, states } = self.sizes;
        let (rows, wide) = (self.sizes.rows(), self.sizes.wide());
        let e = Entries { states, inputs: wheels, outputs: n };
        let mut h = vec![ZERO; n * wheels];
        let conj: Vec<C64> = place.h.iter().map(|v| v.conj()).collect();
        product(&mut h, [n, n, wheels], |i, j| inverse[i * n + j], &conj);
        let ln_nu = road.ln_nu(place.omega);
        let by_exponent: Vec<C64> = place.road.iter().map(|v| v * -ln_nu).collect();
        let [by_mu, by_delay] = road.derivatives(place.omega, place.road);
        // V = B C Bᴴ: B with rank columns, C small
        let mut dense: Vec<(Vec<C64>, Vec<C64>)> =
            [place.road, &by_exponent, &by_mu, &by_delay].map(|sr| (h.clone(), sr.to_vec())).into();
        dense.extend((0..n).map(|c| {
            let column = (0..n).map(|i| inverse[i * n + c]).collect();
            (column, vec![C64::new(at.ln_noise[c].exp(), 0.0)])
        }));
        let mut whole: Vec<Vec<C64>> = Vec::with_capacity(dense.len());
        for (m, (b, core)) in dense.iter().enumerate() {
            let rank = b.len() / n;
            let (mut seen, mut left, mut cross) =
                (vec![ZERO; rank * rows], vec![ZERO; wide * rank], vec![ZERO; wide * rows]);
            product(&mut seen, [rank, n, rows], |i, j| b[j * rank + i].conj(), &self.u);
            let mut turned = vec![ZERO; rank * rows];
            product(&mut turned, [rank, rank, rows], |i, j| core[i * rank + j], &seen);
            product(&mut left, [wide, n, rank], |i, j| self.right[i * n + j], b);
            product(&mut cross, [wide, rank, rows], |i, j| left[i * rank + j], &turned);
            for l in 0..rows {
                let (start, len) = e.row(l);
                (0..len).for_each(|r| tail[(start + r, m)] += 2.0 * cross[r * rows + l].re);
            }
            let (mut half, mut v) = (vec![ZERO; n * rank], vec![ZERO; n * n]);
            product(&mut half, [n, rank, rank], |i, j| b[i * rank + j], core);
            for i in 0..n {
                for j in 0..n {
                    v[i * n + j] = (0..rank).map(|k| half[i * rank + k] * b[j * rank + k].conj()).sum();
                }
            }
            whole.push(v);
            // tr VW of Hermitian V and W is Σ Re V W*
            for (k, w) in whole.iter().enumerate() {
                let v = &whole[m];
                tail[(e.len() + k, m)] +=
                    v.iter().zip(w).map(|(a, b)| a.re * b.re + a.im * b.im).sum::<f64>();
            }
        }
    }
}
