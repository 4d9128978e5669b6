//! The International Roughness Index: a standard quarter car's mean suspension speed over distance.

use super::MetricsError;
use crate::linalg::{Mat, expm};
use std::collections::HashMap;

/// Profiles whose mean step is below two thirds of this are averaged over it first: what the tire's footprint does.
pub const MOVING_AVERAGE_M: f64 = 0.25;
/// Steps above this are too coarse for the standard (ASTM E1364, class 1 and 2: 0.25 and 0.5 m; E1926 advises 0.3 m).
pub const COARSE_STEP_M: f64 = 0.3;
/// Over which the profile's first slope is taken: the car starts as if it had run on that slope for ever.
const FIRST_M: f64 = 11.0;
/// Matrices of steps that are kept: an irregular profile has a step of its own at each point.
const MOST_STEPS: usize = 4096;
/// Steps that are alike to this (m) are one.
const SAME_STEP_M: f64 = 1e-9;

/// The quarter car of the standard, over its sprung mass, and its speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoldenCar {
    /// Tire stiffness over sprung mass, 1/s².
    pub tire: f64,
    /// Suspension stiffness over sprung mass, 1/s².
    pub spring: f64,
    /// Suspension damping over sprung mass, 1/s.
    pub damper: f64,
    /// Unsprung mass over sprung mass.
    pub mass_ratio: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
}

impl GoldenCar {
    /// k_t/m_s = 653, k_s/m_s = 63.3, c/m_s = 6, m_u/m_s = 0.15, 80 km/h.
    ///
    /// Source: ASTM E1926; M. W. Sayers, Transportation Research Record 1501 (1995) 1–12.
    pub const STANDARD: Self =
        GoldenCar { tire: 653.0, spring: 63.3, damper: 6.0, mass_ratio: 0.15, speed_m_s: 80.0 / 3.6 };

    /// ż = A z + b y′ of z = (z_s′, z_s″, z_u′, z_u″), driven by the road's slope.
    fn matrices(&self) -> ([[f64; 4]; 4], [f64; 4]) {
        let (k, c, u) = (self.spring, self.damper, self.mass_ratio);
        let a = [
            [0.0, 1.0, 0.0, 0.0],
            [-k, -c, k, c],
            [0.0, 0.0, 0.0, 1.0],
            [k / u, c / u, -(self.tire + k) / u, -c / u],
        ];
        (a, [0.0, 0.0, 0.0, self.tire / u])
    }
}

/// How an index is taken.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IriSettings {
    /// Length of the segments; none takes the whole profile only.
    pub segment_m: Option<f64>,
    /// Length of the moving average, 0 for none; left out, what the standard says: 0.25 m for mean steps below a sixth of a metre.
    pub moving_average_m: Option<f64>,
}

/// The index of a part of the profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IriSegment {
    /// Where it begins.
    pub start_m: f64,
    /// Where it ends.
    pub end_m: f64,
    /// Mean of |z_s′ − z_u′| in mm/m, which is m/km.
    pub iri_mm_per_m: f64,
}

/// The index of a profile and of its segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Iri {
    /// From the first to the last point.
    pub whole: IriSegment,
    /// Whole segments from the first point on.
    pub segments: Vec<IriSegment>,
    /// What is left after the last whole segment.
    pub left_over_m: f64,
    /// The moving average that was taken; 0 for none.
    pub moving_average_m: f64,
    /// Mean distance of the points.
    pub mean_step_m: f64,
    /// Largest distance of neighbouring points.
    pub largest_step_m: f64,
}

/// The International Roughness Index of one track.
///
/// IRI = (1/L) ∫ |z_s′ − z_u′| dx of the standard's quarter car at 80 km/h, where ′ is per metre of road. Between its points the
/// profile is a straight line, on which the car's motion is exact: Z ← e^{A dt} Z + A⁻¹(e^{A dt} − I) b y′; the integrand
/// is taken at the end of each step, as in the standard. The car starts with the mean slope of the first 11 m, and keeps
/// its motion from one segment to the next.
///
/// `x_m`: distances, ascending, not necessarily even; `height_m`: as many heights.
///
/// # Errors
/// Numbers that do not fit or are not finite, distances that do not ascend, a profile shorter than 11 m or than a segment, a segment
/// or moving average that can't be.
///
/// Source: ASTM E1926; Sayers (1995).
///
/// ```
/// use washboard::metrics::{IriSettings, iri};
/// // a steady slope is no roughness
/// let x: Vec<f64> = (0..200).map(|k| 0.25 * f64::from(k)).collect();
/// let ramp: Vec<f64> = x.iter().map(|x| 0.03 * x).collect();
/// let found = iri(&x, &ramp, &IriSettings::default())?;
/// assert!(found.whole.iri_mm_per_m < 1e-9);
/// # Ok::<(), washboard::metrics::MetricsError>(())
/// ```
pub fn iri(x_m: &[f64], height_m: &[f64], settings: &IriSettings) -> Result<Iri, MetricsError> {
    let length = check(x_m, height_m, settings)?;
    let (start, end) = (x_m[0], x_m[0] + length);
    let mean_step_m = length / (x_m.len() - 1) as f64;
    let largest_step_m = x_m.windows(2).map(|p| p[1] - p[0]).fold(0.0, f64::max);
    let rule = if mean_step_m < MOVING_AVERAGE_M / 1.5 { MOVING_AVERAGE_M } else { 0.0 };
    let moving_average_m = settings.moving_average_m.unwrap_or(rule);
    let smooth =
        if moving_average_m > 0.0 { averaged(x_m, height_m, moving_average_m) } else { height_m.to_vec() };
    // the last point may be a rounding short of a whole segment
    let count = settings.segment_m.map_or(0, |s| ((length + SAME_STEP_M) / s).floor() as usize);
    let edges: Vec<f64> = settings
        .segment_m
        .map_or(Vec::new(), |s| (1..=count).map(|k| (start + k as f64 * s).min(end)).collect());
    let (x, y) = with_points(x_m, &smooth, &edges);
    let share = suspension_speed(&x, &y, &GoldenCar::STANDARD)?;
    let part = |from: f64, to: f64| {
        let first = x.partition_point(|x| *x <= from);
        let last = x.partition_point(|x| *x <= to);
        let sum: f64 = share[first..last].iter().sum();
        IriSegment { start_m: from, end_m: to, iri_mm_per_m: 1e3 * sum / (to - from) }
    };
    let starts = std::iter::once(start).chain(edges.iter().copied());
    let segments: Vec<IriSegment> = starts.zip(&edges).map(|(from, to)| part(from, *to)).collect();
    let left_over_m =
        end - edges.last().copied().unwrap_or(if settings.segment_m.is_some() { start } else { end });
    Ok(Iri { whole: part(start, end), segments, left_over_m, moving_average_m, mean_step_m, largest_step_m })
}

/// The length, of a profile that can be driven on.
fn check(x: &[f64], y: &[f64], settings: &IriSettings) -> Result<f64, MetricsError> {
    let fail = |field, expected: &str, found: String| {
        Err(MetricsError::Field { field, expected: expected.to_owned(), found })
    };
    if x.len() != y.len() {
        return fail("heights", &format!("{}, one a distance", x.len()), y.len().to_string());
    }
    if let Some(k) = (0..x.len()).find(|k| !(x[*k].is_finite() && y[*k].is_finite())) {
        return fail("profile", "finite numbers", format!("({}, {}) at point {k}", x[k], y[k]));
    }
    if let Some(k) = (1..x.len()).find(|k| x[*k] <= x[k - 1]) {
        return fail("distances", "ascending ones", format!("{} after {}", x[k], x[k - 1]));
    }
    let length = x.last().copied().unwrap_or(0.0) - x.first().copied().unwrap_or(0.0);
    if !(length >= FIRST_M) {
        return fail("length", "11 m or more, over which the car starts", format!("{length} m"));
    }
    let step = length / (x.len() - 1).max(1) as f64;
    if let Some(s) = settings.segment_m
        && !(s >= step && s <= length + SAME_STEP_M)
    {
        return fail(
            "segment_m",
            &format!("a length of at least a step ({step:.4} m), at most the profile's {length} m"),
            s.to_string(),
        );
    }
    if let Some(l) = settings.moving_average_m
        && !(0.0..=length).contains(&l)
    {
        return fail(
            "moving_average_m",
            &format!("a length from 0 to the profile's {length} m"),
            l.to_string(),
        );
    }
    Ok(length)
}

/// Mean of the broken line over a window about each point, clipped at the ends.
fn averaged(x: &[f64], y: &[f64], window: f64) -> Vec<f64> {
    let mut area = vec![0.0; x.len()];
    for k in 1..x.len() {
        area[k] = area[k - 1] + 0.5 * (x[k] - x[k - 1]) * (y[k] + y[k - 1] - 2.0 * y[0]);
    }
    // ∫ from the first point; heights are less the first one, so that an altitude costs no digits
    let upto = |at: f64| {
        let k = x.partition_point(|x| *x <= at).clamp(1, x.len() - 1);
        let (h, t) = (at - x[k - 1], (at - x[k - 1]) / (x[k] - x[k - 1]));
        area[k - 1] + h * (y[k - 1] - y[0] + 0.5 * t * (y[k] - y[k - 1]))
    };
    let (first, last) = (x[0], x[x.len() - 1]);
    x.iter()
        .map(|at| {
            // a window that stays about its point, so that a slope stays a slope
            let half = (0.5 * window).min(at - first).min(last - at);
            if half <= 0.0 {
                return y[if *at <= first { 0 } else { x.len() - 1 }];
            }
            y[0] + (upto(at + half) - upto(at - half)) / (2.0 * half)
        })
        .collect()
}

/// The broken line with more points on it.
fn with_points(x: &[f64], y: &[f64], at: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut xs, mut ys) = (Vec::with_capacity(x.len()), Vec::with_capacity(x.len()));
    let mut more = at.iter().copied().peekable();
    for k in 0..x.len() {
        while let Some(edge) = more.peek().copied().filter(|edge| *edge <= x[k]) {
            more.next();
            if edge < x[k] && k > 0 {
                let t = (edge - x[k - 1]) / (x[k] - x[k - 1]);
                xs.push(edge);
                ys.push(y[k - 1] + t * (y[k] - y[k - 1]));
            }
        }
        xs.push(x[k]);
        ys.push(y[k]);
    }
    (xs, ys)
}

/// |z_s′ − z_u′| dx of each step, 0 at the first point; slopes in m/m.
fn suspension_speed(x: &[f64], y: &[f64], car: &GoldenCar) -> Result<Vec<f64>, MetricsError> {
    let first = x.partition_point(|at| *at < x[0] + FIRST_M).clamp(1, x.len() - 1);
    let t = (x[0] + FIRST_M - x[first - 1]) / (x[first] - x[first - 1]);
    let there = y[first - 1] + t.min(1.0) * (y[first] - y[first - 1]);
    let slope = (there - y[0]) / FIRST_M;
    let mut z = [slope, 0.0, slope, 0.0];
    let mut known: HashMap<i64, Step> = HashMap::new();
    let mut share = vec![0.0; x.len()];
    for k in 1..x.len() {
        let dx = x[k] - x[k - 1];
        let key = (dx / SAME_STEP_M).round() as i64;
        let step = match known.get(&key) {
            Some(step) => *step,
            None => {
                let step = Step::new(car, dx)?;
                if known.len() < MOST_STEPS {
                    known.insert(key, step);
                }
                step
            }
        };
        z = step.taken(&z, (y[k] - y[k - 1]) / dx);
        share[k] = (z[0] - z[2]).abs() * dx;
    }
    Ok(share)
}

/// S = e^{A dt} and p = A⁻¹(S − I) b.
#[derive(Debug, Clone, Copy)]
struct Step {
    s: [[f64; 4]; 4],
    p: [f64; 4],
}

impl Step {
    /// Both are blocks of e^{\[A b; 0 0\] dt}.
    fn new(car: &GoldenCar, dx_m: f64) -> Result<Self, MetricsError> {
        let (a, b) = car.matrices();
        let dt = dx_m / car.speed_m_s;
        let block = Mat::from_fn(5, 5, |i, j| match (i, j) {
            (4, _) => 0.0,
            (i, 4) => b[i] * dt,
            (i, j) => a[i][j] * dt,
        });
        let e = expm(&block)?;
        Ok(Step {
            s: std::array::from_fn(|i| std::array::from_fn(|j| e[(i, j)])),
            p: std::array::from_fn(|i| e[(i, 4)]),
        })
    }

    fn taken(&self, z: &[f64; 4], slope: f64) -> [f64; 4] {
        std::array::from_fn(|i| (0..4).map(|j| self.s[i][j] * z[j]).sum::<f64>() + self.p[i] * slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::C64;
    use crate::lti::StateSpace;
    use std::f64::consts::{PI, TAU};

    /// Sayers prints S and p of 0.25 m at 80 km/h to seven digits.
    #[test]
    fn the_matrices_of_a_quarter_metre_are_those_printed() {
        let step = Step::new(&GoldenCar::STANDARD, 0.25).unwrap();
        let s = [
            [0.9966071, 0.01091514, -0.002083274, 0.0003190145],
            [-0.5563044, 0.9438768, -0.8324718, 0.05064701],
            [0.02153176, 0.002126763, 0.7508714, 0.008221888],
            [3.335013, 0.3376467, -39.12762, 0.4347564],
        ];
        let p = [0.005476107, 1.388776, 0.2275968, 35.79262];
        for i in 0..4 {
            for j in 0..4 {
                assert!((step.s[i][j] / s[i][j] - 1.0).abs() < 2e-6, "S{i}{j}: {} {}", step.s[i][j], s[i][j]);
            }
            // p is 1 less sums of S there: no more than the digits of S
            assert!((step.p[i] - p[i]).abs() < 1e-7 + 1e-6 * p[i], "p{i}: {} {}", step.p[i], p[i]);
        }
    }

    /// On a sine the mean of |·| is 2/π of the amplitude that the car's frequency response gives: another route.
    #[test]
    fn a_sine_has_the_index_of_the_frequency_response() {
        let car = GoldenCar::STANDARD;
        let (a, b) = car.matrices();
        let system = StateSpace::continuous(
            Mat::from_fn(4, 4, |i, j| a[i][j]),
            Mat::from_fn(4, 1, |i, _| b[i]),
            Mat::from_fn(1, 4, |_, j| [1.0, 0.0, -1.0, 0.0][j]),
            Mat::zeros(1, 1),
        )
        .unwrap();
        for wavelength in [2.4, 15.4, 40.0] {
            let x: Vec<f64> = (0..=40_000).map(|k| 0.02 * f64::from(k)).collect();
            let y: Vec<f64> = x.iter().map(|x| 0.004 * (TAU * x / wavelength).sin()).collect();
            let settings = IriSettings { segment_m: Some(400.0), moving_average_m: Some(0.0) };
            let found = iri(&x, &y, &settings).unwrap();
            let gain = system.at(C64::new(0.0, TAU * car.speed_m_s / wavelength)).unwrap()[(0, 0)].norm();
            let slope = 0.004 * TAU / wavelength * 1e3;
            // the second segment has no transient; 2/π of a mean over whole and part periods, lines for a sine
            let off = found.segments[1].iri_mm_per_m / (2.0 / PI * gain * slope) - 1.0;
            assert!(off.abs() < 0.01, "{wavelength}: {off}");
        }
    }

    #[test]
    fn the_moving_average_is_that_of_the_broken_line() {
        let x = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
        let y = [583.0, 583.0, 583.01, 583.0, 583.0, 583.0];
        let smooth = averaged(&x, &y, 0.2);
        // the triangle's area, 0.001, over the window
        for (k, expected) in [0.0, 2.5e-3, 5e-3, 2.5e-3, 0.0, 0.0].iter().enumerate() {
            assert!((smooth[k] - 583.0 - expected).abs() < 1e-9, "{k}: {}", smooth[k] - 583.0);
        }
        let ramp: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
        assert!(averaged(&x, &ramp, 0.25).iter().zip(&ramp).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn segments_end_between_points_and_the_rest_is_told() {
        let x: Vec<f64> = (0..400).map(|k| 0.3 * f64::from(k)).collect();
        let y: Vec<f64> = x.iter().map(|x| 0.01 * (1.7 * x).sin()).collect();
        let found = iri(&x, &y, &IriSettings { segment_m: Some(25.0), moving_average_m: None }).unwrap();
        assert_eq!((found.segments.len(), found.moving_average_m), (4, 0.0));
        assert!((found.left_over_m - 19.7).abs() < 1e-9 && (found.mean_step_m - 0.3).abs() < 1e-12);
        // the whole is the mean of its parts, within the points that edges add
        let plain = iri(&x, &y, &IriSettings::default()).unwrap();
        assert_eq!(plain.left_over_m, 0.0);
        assert!((plain.whole.iri_mm_per_m / found.whole.iri_mm_per_m - 1.0).abs() < 1e-2);
        let sum: f64 = found.segments.iter().map(|s| s.iri_mm_per_m * 25.0).sum();
        assert!(sum < found.whole.iri_mm_per_m * 119.7 && sum > 0.8 * found.whole.iri_mm_per_m * 100.0);
        // a rounding short of a whole segment
        let x: Vec<f64> = (0..=1000).map(|k| 0.1 * f64::from(k)).collect();
        let found = iri(&x, &vec![0.0; 1001], &IriSettings { segment_m: Some(20.0), ..Default::default() });
        let found = found.unwrap();
        assert_eq!((found.segments.len(), found.moving_average_m), (5, MOVING_AVERAGE_M));
    }

    #[test]
    fn wrong_profiles_are_refused() {
        let x: Vec<f64> = (0..100).map(|k| 0.25 * f64::from(k)).collect();
        let y = vec![0.0; 100];
        let with = |segment_m, moving_average_m| IriSettings { segment_m, moving_average_m };
        let e = |x: &[f64], y: &[f64], s: IriSettings| iri(x, y, &s).unwrap_err().to_string();
        assert!(e(&x, &y[1..], with(None, None)).contains("expected 100"));
        assert!(e(&x[..20], &y[..20], with(None, None)).contains("11 m or more"));
        assert!(e(&x, &y, with(Some(25.0), None)).contains("24.75 m, found 25"));
        assert!(e(&x, &y, with(Some(f64::NAN), None)).contains("segment_m"));
        assert!(e(&x, &y, with(None, Some(-1.0))).contains("moving_average_m"));
        let mut back = x.clone();
        back[50] = back[49];
        assert!(e(&back, &y, with(None, None)).contains("ascending ones, found 12.25 after 12.25"));
        let mut nan = y.clone();
        nan[3] = f64::NAN;
        assert!(e(&x, &nan, with(None, None)).contains("at point 3"));
        assert!(e(&[], &[], with(None, None)).contains("found 0 m"));
    }
}
