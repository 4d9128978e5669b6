//! What a response H = W C G B and its road make on the grid of half bins: spectra, and the parts of their derivatives.

use super::spectra::{Spectra, pack, unpack};
use super::{BandData, Road};
use crate::linalg::C64;
use crate::linalg::small::{ZERO, product};
use rayon::prelude::*;
use std::ops::Range;

/// Sums over the grid are made in so many parts, whatever the number of threads: the same bits on all.
const PARTS: usize = 16;

/// Channels, wheels and states (or degrees of freedom).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shape {
    pub channels: usize,
    pub wheels: usize,
    pub states: usize,
}

impl Shape {
    /// Numbers of X, Y, H, P, W, S_r.
    fn sizes(self) -> [usize; 6] {
        let Shape { channels: n, wheels: w, states } = self;
        [states * w, n * states, n * w, w * n, n, w * w]
    }

    fn stride(self) -> usize {
        self.sizes().iter().sum()
    }
}

/// The parts at one half bin, matrices row after row.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub omega: f64,
    /// G B (states × wheels).
    pub x: &'a [C64],
    /// W C G (channels × states).
    pub y: &'a [C64],
    /// H (channels × wheels).
    pub h: &'a [C64],
    /// S_r Hᵀ (wheels × channels).
    pub p: &'a [C64],
    /// The channels' weights.
    pub weight: &'a [C64],
    /// S_r (wheels × wheels).
    pub road: &'a [C64],
}

/// What a solver fills.
pub(crate) struct PlaceMut<'a> {
    pub x: &'a mut [C64],
    /// None where no derivatives are wanted.
    pub y: Option<&'a mut [C64]>,
    pub h: &'a mut [C64],
    pub weight: &'a mut [C64],
    /// Room for a matrix of states × states, and for the columns of Y turned.
    pub matrix: &'a mut [C64],
    pub turned: &'a mut [C64],
    pub pivots: &'a mut [usize],
}

struct Scratch {
    place: Vec<C64>,
    matrix: Vec<C64>,
    turned: Vec<C64>,
    pivots: Vec<usize>,
}

/// The parts on the whole grid.
pub(crate) struct Response {
    pub shape: Shape,
    omega: Vec<f64>,
    values: Vec<C64>,
}

impl Response {
    /// Spectra at the bins, and all parts. `solve` fills X, Y, H and W at an ω > 0 and says whether it could.
    pub fn new(
        data: &BandData,
        shape: Shape,
        road: &Road<'_>,
        noise: &[f64],
        solve: impl Fn(f64, PlaceMut<'_>) -> bool + Sync,
    ) -> Option<(Spectra, Self)> {
        let (n, [from, last]) = (shape.channels, data.grid());
        let omega: Vec<f64> = (from..=last).map(|index| data.half_omega(index)).collect();
        let mut values = vec![ZERO; omega.len() * shape.stride()];
        let mut grid = vec![0.0; omega.len() * n * n];
        grid.par_chunks_exact_mut(n * n)
            .zip(values.par_chunks_exact_mut(shape.stride()))
            .zip(&omega)
            .try_for_each_init(
                || Scratch::new(shape),
                |scratch, ((s, values), omega)| {
                    fill(shape, road, *omega, (values, true), scratch, s, &solve).then_some(())
                },
            )?;
        Some((data.convolve(&Spectra::new(n, grid), noise), Response { shape, omega, values }))
    }

    /// The spectra alone.
    pub fn spectra(
        data: &BandData,
        shape: Shape,
        road: &Road<'_>,
        noise: &[f64],
        solve: impl Fn(f64, PlaceMut<'_>) -> bool + Sync,
    ) -> Option<Spectra> {
        let (n, [from, last]) = (shape.channels, data.grid());
        let mut grid = vec![0.0; (last - from + 1) * n * n];
        grid.par_chunks_exact_mut(n * n).enumerate().try_for_each_init(
            || Scratch::new(shape),
            |scratch, (k, s)| {
                let mut values = std::mem::take(&mut scratch.place);
                let omega = data.half_omega(from + k);
                let solved = fill(shape, road, omega, (&mut values, false), scratch, s, &solve);
                scratch.place = values;
                solved.then_some(())
            },
        )?;
        Some(data.convolve(&Spectra::new(n, grid), noise))
    }

    /// Places on the grid.
    pub fn len(&self) -> usize {
        self.omega.len()
    }

    /// The parts at a place; None at ω = 0.
    pub fn at(&self, place: usize) -> Option<Place<'_>> {
        let stride = self.shape.stride();
        let mut rest = &self.values[place * stride..(place + 1) * stride];
        let [x, y, h, p, weight, road] = self.shape.sizes().map(|size| {
            let (part, more) = rest.split_at(size);
            rest = more;
            part
        });
        let omega = self.omega[place];
        (omega > 0.0).then_some(Place { omega, x, y, h, p, weight, road })
    }

    /// Σ over the grid of what `add` makes of each place and of the pull there, started from `zero`.
    ///
    /// `bins` are the pulls G at the bins, by which the sought sum is Σ tr(G_k dS_k).
    pub fn pulled<T: Send>(
        &self,
        data: &BandData,
        bins: &Spectra,
        zero: impl Fn() -> T + Sync,
        add: impl Fn(&mut T, Place<'_>, &Pulled) + Sync,
    ) -> Vec<T> {
        let size = self.len().div_ceil(PARTS);
        let part = |places: Range<usize>| {
            let (mut sum, mut pulled) = (zero(), Pulled::new(self.shape));
            for k in places {
                if let Some(place) = self.at(k) {
                    data.spread(bins, k, &mut pulled.packed);
                    pulled.fill(self.shape, place);
                    add(&mut sum, place, &pulled);
                }
            }
            sum
        };
        (0..PARTS)
            .into_par_iter()
            .map(|i| part((i * size).min(self.len())..((i + 1) * size).min(self.len())))
            .collect()
    }
}

impl Scratch {
    fn new(shape: Shape) -> Self {
        Scratch {
            place: vec![ZERO; shape.stride()],
            matrix: vec![ZERO; shape.states * shape.states],
            turned: vec![ZERO; shape.states * shape.channels],
            pivots: vec![0; shape.states],
        }
    }
}

/// The parts and the packed S = H* S_r Hᵀ at one ω.
fn fill(
    shape: Shape,
    road: &Road<'_>,
    omega: f64,
    (values, whole): (&mut [C64], bool),
    scratch: &mut Scratch,
    s: &mut [f64],
    solve: &impl Fn(f64, PlaceMut<'_>) -> bool,
) -> bool {
    if omega <= 0.0 {
        return true;
    }
    let mut rest = values;
    let [x, y, h, p, weight, sr] = shape.sizes().map(|size| {
        let (part, more) = std::mem::take(&mut rest).split_at_mut(size);
        rest = more;
        part
    });
    let Scratch { matrix, turned, pivots, .. } = scratch;
    let y = whole.then_some(y);
    if !solve(omega, PlaceMut { x, y, h: &mut *h, weight, matrix, turned, pivots }) {
        return false;
    }
    road.fill(omega, sr);
    let Shape { channels: n, wheels: w, .. } = shape;
    for i in 0..w {
        for j in 0..n {
            p[i * n + j] = (0..w).map(|k| sr[i * w + k] * h[j * w + k]).sum();
        }
    }
    pack(s, n, |i, j| (0..w).map(|k| h[i * w + k].conj() * p[k * n + j]).sum());
    s.iter().all(|v| v.is_finite())
}

/// Products of a place's parts with the pull G there, Q = (P G)*.
pub(crate) struct Pulled {
    packed: Vec<f64>,
    /// G (channels × channels).
    pub g: Vec<C64>,
    /// Q (wheels × channels).
    pub q: Vec<C64>,
    /// X Q (states × channels).
    pub xq: Vec<C64>,
    /// Q Y (wheels × states).
    pub qy: Vec<C64>,
    /// X Q Y (states × states).
    pub xqy: Vec<C64>,
    /// Hᵀ G H* (wheels × wheels).
    pub through: Vec<C64>,
    gh: Vec<C64>,
}

impl Pulled {
    fn new(shape: Shape) -> Self {
        let Shape { channels: n, wheels: w, states } = shape;
        let zeros = |len: usize| vec![ZERO; len];
        Pulled {
            packed: vec![0.0; n * n],
            g: zeros(n * n),
            q: zeros(w * n),
            xq: zeros(states * n),
            qy: zeros(w * states),
            xqy: zeros(states * states),
            through: zeros(w * w),
            gh: zeros(w * n),
        }
    }

    fn fill(&mut self, shape: Shape, at: Place<'_>) {
        let Shape { channels: n, wheels: w, states } = shape;
        unpack(&self.packed, &mut self.g, n);
        product(&mut self.q, [w, n, n], |i, j| at.p[i * n + j], &self.g);
        self.q.iter_mut().for_each(|v| *v = v.conj());
        let q = &self.q;
        product(&mut self.xq, [states, w, n], |i, j| at.x[i * w + j], q);
        product(&mut self.qy, [w, n, states], |i, j| q[i * n + j], at.y);
        product(&mut self.xqy, [states, w, states], |i, j| at.x[i * w + j], &self.qy);
        product(&mut self.gh, [w, n, n], |i, j| at.h[j * w + i], &self.g);
        for i in 0..w {
            for j in 0..w {
                self.through[i * w + j] = (0..n).map(|k| self.gh[i * n + k] * at.h[k * w + j].conj()).sum();
            }
        }
    }
}
