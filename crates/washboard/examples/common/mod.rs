//! What the studies share: the cars of the notes, sensors, starts that are off.

#![allow(dead_code, clippy::unwrap_used)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use washboard::cases;
use washboard::lti::{Mode, Parametric};
use washboard::road::{CoherenceSpec, Road, RoadSpec};
use washboard::signal::{Channel, Direction, Place, Quantity, WheelPlace};
use washboard::study::{IdentifiedMode, IdentifyMethod, IdentifyOutcome, IdentifySpec};
use washboard::vehicle::{Axle, Flaws, FullCar, LeftRight, ParametricVehicle, VehicleSpec};

/// Published, light, SUV, sports, van, asymmetric.
pub fn cars() -> Vec<(&'static str, VehicleSpec)> {
    let axle = |m: f64, k: f64, c: f64, kt: f64, ct: f64, bar: f64| Axle {
        unsprung_mass_kg: LeftRight::Both(m),
        suspension_stiffness_n_per_m: LeftRight::Both(k),
        suspension_damping_n_s_per_m: LeftRight::Both(c),
        tire_stiffness_n_per_m: LeftRight::Both(kt),
        tire_damping_n_s_per_m: LeftRight::Both(ct),
        anti_roll_stiffness_n_m_per_rad: bar,
        damper_curve: None,
    };
    let car = |w: f64, a: f64, b: f64, m: f64, jx: f64, jy: f64, front: Axle, rear: Axle| FullCar {
        sprung_mass_kg: m,
        roll_inertia_kg_m2: jx,
        pitch_inertia_kg_m2: jy,
        front_axle_m: a,
        rear_axle_m: b,
        front_track_m: w,
        rear_track_m: w,
        cg_left_m: 0.0,
        driver_m: None,
        front,
        rear,
    };
    let light = car(
        1.40,
        0.90,
        1.40,
        750.0,
        280.0,
        850.0,
        axle(32.0, 17000.0, 1150.0, 150e3, 80.0, 3000.0),
        axle(28.0, 15500.0, 1050.0, 150e3, 80.0, 0.0),
    );
    let suv = car(
        1.62,
        1.35,
        1.45,
        1900.0,
        850.0,
        3100.0,
        axle(60.0, 32000.0, 3000.0, 260e3, 200.0, 14000.0),
        axle(65.0, 34000.0, 2900.0, 270e3, 200.0, 8000.0),
    );
    let sports = car(
        1.58,
        1.20,
        1.25,
        1250.0,
        380.0,
        1400.0,
        axle(38.0, 45000.0, 2700.0, 280e3, 120.0, 20000.0),
        axle(42.0, 52000.0, 2900.0, 300e3, 120.0, 12000.0),
    );
    let van = car(
        1.70,
        1.25,
        1.95,
        2300.0,
        1300.0,
        5600.0,
        axle(60.0, 38000.0, 2800.0, 240e3, 150.0, 12000.0),
        axle(110.0, 60000.0, 3600.0, 330e3, 200.0, 0.0),
    );
    // corners (front right, front left, rear right, rear left) × (1.06, .94, .97, 1.042), c.g. 3 cm off centre
    let pair = |v: f64, left: f64, right: f64| LeftRight::Each([v * left, v * right]);
    let uneven = |m: f64, k: f64, c: f64, kt: f64, ct: f64, bar: f64, l: f64, r: f64| Axle {
        unsprung_mass_kg: pair(m, l, r),
        suspension_stiffness_n_per_m: pair(k, l, r),
        suspension_damping_n_s_per_m: pair(c, l, r),
        tire_stiffness_n_per_m: pair(kt, l, r),
        tire_damping_n_s_per_m: pair(ct, l, r),
        anti_roll_stiffness_n_m_per_rad: bar,
        damper_curve: None,
    };
    let mut asymmetric = car(
        1.49,
        1.20,
        1.46,
        1150.0,
        530.0,
        1630.0,
        uneven(40.0, 19000.0, 1500.0, 190e3, 150.0, 9000.0, 0.94, 1.06),
        uneven(45.0, 22000.0, 1500.0, 180e3, 150.0, 4000.0, 1.042, 0.97),
    );
    asymmetric.cg_left_m = 0.03;
    vec![
        ("published", cases::vehicle_spec("guiggiani-full-car").unwrap()),
        ("light", light.into()),
        ("suv", suv.into()),
        ("sports", sports.into()),
        ("van", van.into()),
        ("asymmetric", asymmetric.into()),
    ]
}

/// Vertical accelerometers: `all`, `body`, `hub`, or `side` (front hub and rear body of each side).
pub fn sensors(which: &str, noise_ratio: f64) -> Vec<(Channel, Flaws)> {
    [(Place::Body, "body"), (Place::Hub, "hub")]
        .into_iter()
        .flat_map(|(place, name)| (0..4).map(move |w| (place, name, w)))
        .filter(|(_, name, w)| match which {
            "all" => true,
            "side" => (*name == "hub") == (*w < 2),
            other => *name == other,
        })
        .map(|(place, name, w)| {
            let channel = Channel {
                name: format!("{name}_{w}"),
                quantity: Quantity::Acceleration,
                direction: Direction::PlusZ,
                place,
                wheel: Some(w),
                at_m: None,
            };
            (channel, Flaws { noise_ratio, ..Flaws::default() })
        })
        .collect()
}

/// Every free parameter off by up to `share`.
pub fn perturbed(
    spec: &VehicleSpec,
    channels: &[Channel],
    wheels: &[WheelPlace],
    seed: u64,
    share: f64,
) -> VehicleSpec {
    let (family, _) = ParametricVehicle::new(spec, channels, wheels, &[]).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
    let values: Vec<f64> =
        family.start().iter().map(|v| v * (1.0 + share * rng.random_range(-1.0..=1.0))).collect();
    family.spec_at(&values).unwrap()
}

/// The settings of `identify` without options.
pub fn settings(method: IdentifyMethod) -> IdentifySpec {
    IdentifySpec { recording: "simulated".into(), method, ..IdentifySpec::default() }
}

/// Errors of identifications: f in %, ζ in points, S₀ in %, e, μ in %, and each over its standard deviation.
#[derive(Debug, Clone, Default)]
pub struct Errors {
    pub f: Vec<f64>,
    pub zeta: Vec<f64>,
    pub s0: Vec<f64>,
    pub e: Vec<f64>,
    pub mu: Vec<f64>,
    pub scores: Vec<f64>,
    /// Scores of f, ζ, S₀, e, μ apart.
    pub by_kind: [Vec<f64>; 5],
}

impl Errors {
    pub fn of(found: &IdentifyOutcome, truth: &[(Mode, String)], s0: f64, e: f64, mu: f64) -> Self {
        let mut out = Errors::default();
        for (t, _) in truth {
            // the nearest mode that was found, once each mode is near its truth
            let near = |m: &&IdentifiedMode| (m.pole[0] - t.pole.re).hypot(m.pole[1] - t.pole.im);
            let Some(m) = found.modes.iter().min_by(|a, b| near(a).total_cmp(&near(b))) else { continue };
            out.f.push(100.0 * (m.freq_hz / t.freq_hz - 1.0));
            out.zeta.push(100.0 * (m.damping - t.damping));
            out.by_kind[0].push((m.freq_hz - t.freq_hz) / m.freq_sd_hz.unwrap_or(f64::NAN));
            out.by_kind[1].push((m.damping - t.damping) / m.damping_sd.unwrap_or(f64::NAN));
        }
        if let Some(r) = &found.road {
            out.s0.push(100.0 * (r.roughness_m3 / s0 - 1.0));
            out.e.push(r.exponent - e);
            out.by_kind[2].push((r.roughness_m3 - s0) / r.roughness_sd_m3);
            out.by_kind[3].push((r.exponent - e) / r.exponent_sd);
        }
        if let Some(c) = &found.coherence {
            out.mu.push(100.0 * (c.mu / mu - 1.0));
            out.by_kind[4].push((c.mu - mu) / c.mu_sd);
        }
        out.scores = out.by_kind.concat();
        out
    }

    pub fn add(&mut self, other: &Errors) {
        self.f.extend(&other.f);
        self.zeta.extend(&other.zeta);
        self.s0.extend(&other.s0);
        self.e.extend(&other.e);
        self.mu.extend(&other.mu);
        self.scores.extend(&other.scores);
        for (mine, theirs) in self.by_kind.iter_mut().zip(&other.by_kind) {
            mine.extend(theirs);
        }
    }

    fn words(of: impl Fn(&[f64]) -> f64, e: &Errors) -> String {
        format!(
            "f {:.3} % zeta {:.3} points S0 {:.2} % e {:.4} mu {:.2} %",
            of(&e.f),
            of(&e.zeta),
            of(&e.s0),
            of(&e.e),
            of(&e.mu)
        )
    }

    pub fn line(&self) -> String {
        self.worst_line()
    }

    pub fn rms_line(&self) -> String {
        Self::words(rms, self)
    }

    pub fn worst_line(&self) -> String {
        Self::words(|v| v.iter().fold(0.0, |a: f64, b| a.max(b.abs())), self)
    }

    pub fn score_line(&self) -> String {
        let [f, zeta, s0, e, mu] = &self.by_kind;
        format!("f {:.2} zeta {:.2} S0 {:.2} e {:.2} mu {:.2}", rms(f), rms(zeta), rms(s0), rms(e), rms(mu))
    }
}

pub fn rms(v: &[f64]) -> f64 {
    (v.iter().map(|x| x * x).sum::<f64>() / v.len() as f64).sqrt()
}

/// A car of [`cars`] with an engine on mounts: `mass_kg` of the body becomes a mass of its own at `at_m` (from the c.g.),
/// at `freq_hz` on mounts damped by 5 %.
pub fn with_engine(spec: &VehicleSpec, mass_kg: f64, freq_hz: f64, at_m: [f64; 2]) -> VehicleSpec {
    let mut lighter = spec.clone();
    lighter.full_car.as_mut().unwrap().sprung_mass_kg -= mass_kg;
    let car = lighter.build_alone().unwrap();
    let n = car.system().order();
    let row = |base: &str| car.output(base).unwrap().q[0].clone();
    // z(x, y) = z_G − xθ + yφ
    let (heave, pitch, roll) =
        (row("heave_displacement"), row("pitch_displacement"), row("roll_displacement"));
    let mut stretch: Vec<f64> = (0..n).map(|j| heave[j] - at_m[0] * pitch[j] + at_m[1] * roll[j]).collect();
    stretch.push(-1.0);
    let omega = std::f64::consts::TAU * freq_hz;
    let (k, c) = (mass_kg * omega * omega, 2.0 * 0.05 * mass_kg * omega);
    let wide = |a: &washboard::linalg::Mat, more: f64| -> Vec<Vec<f64>> {
        (0..=n)
            .map(|i| {
                (0..=n)
                    .map(|j| {
                        let old = if i < n && j < n { a[(i, j)] } else { 0.0 };
                        old + more * stretch[i] * stretch[j]
                    })
                    .collect()
            })
            .collect()
    };
    let mut m = wide(car.system().m(), 0.0);
    m[n][n] = mass_kg;
    let rows = |a: &washboard::linalg::Mat| -> Vec<Vec<f64>> {
        (0..=n).map(|i| (0..a.ncols()).map(|j| if i < n { a[(i, j)] } else { 0.0 }).collect()).collect()
    };
    let corners = car.wheels().iter().map(|w| w.name.clone()).collect::<Vec<_>>();
    let output = |base: &str, corner: &str| {
        let name = format!("{base}_displacement_{corner}");
        let mut q = row(&name);
        q.push(0.0);
        washboard::vehicle::OutputRow {
            name,
            displacement: Some(q),
            velocity: None,
            acceleration: None,
            road: None,
        }
    };
    let matrices = washboard::vehicle::Matrices {
        m,
        c: wide(car.system().c(), c),
        k: wide(car.system().k(), k),
        wheel_stiffness: rows(car.wheel_stiffness()),
        wheel_damping: rows(car.wheel_damping()),
        dofs: Vec::new(),
        wheel: car
            .wheels()
            .iter()
            .map(|w| washboard::vehicle::WheelRow { name: w.name.clone(), at_m: w.at_m })
            .collect(),
        output: ["body", "unsprung"].iter().flat_map(|b| corners.iter().map(|c| output(b, c))).collect(),
        actuator: Vec::new(),
    };
    VehicleSpec::from(matrices)
}

/// A level of classes A to E (m³ at 1 rad/m), an exponent, a μ.
pub fn road_values(rng: &mut ChaCha8Rng) -> (f64, f64, f64) {
    let level = 1e-6 * 4f64.powi(rng.random_range(0..5));
    (level, rng.random_range(1.7..=2.5), rng.random_range(2.0..=8.0))
}

/// A power law in the band of ISO 8608 with Bogsjö's coherence.
pub fn road(level: f64, exponent: f64, mu: f64) -> Road {
    let spec = RoadSpec {
        roughness_m3: Some(level),
        exponent: Some(exponent),
        coherence: Some(CoherenceSpec::bogsjo(mu)),
        band_rad_per_m: Some([0.063, 17.77]),
        ..RoadSpec::default()
    };
    spec.build().unwrap()
}

/// What of a result is further off than 3 standard deviations and `slack` (of itself; points for ζ and e).
pub fn wrong(
    found: &IdentifyOutcome,
    truth: &[(Mode, String)],
    s0: f64,
    e: f64,
    mu: f64,
    slack: f64,
) -> Vec<String> {
    let mut off = Vec::new();
    let mut check = |what: String, value: f64, truth: f64, sd: f64, slack: f64| {
        if !((value - truth).abs() <= 3.0 * sd + slack) {
            off.push(format!("{what} {value:.5} for {truth:.5} ± {sd:.5}"));
        }
    };
    for m in &found.modes {
        let near = |t: &&(Mode, String)| (m.pole[0] - t.0.pole.re).hypot(m.pole[1] - t.0.pole.im);
        let Some((t, label)) = truth.iter().min_by(|a, b| near(a).total_cmp(&near(b))) else { continue };
        check(format!("f {label}"), m.freq_hz, t.freq_hz, m.freq_sd_hz.unwrap(), slack * t.freq_hz);
        check(format!("zeta {label}"), m.damping, t.damping, m.damping_sd.unwrap(), slack);
    }
    if let Some(r) = &found.road {
        check("S0".into(), r.roughness_m3, s0, r.roughness_sd_m3, slack * s0);
        check("e".into(), r.exponent, e, r.exponent_sd, slack * e);
    }
    if let Some(c) = &found.coherence {
        check("mu".into(), c.mu, mu, c.mu_sd, slack * mu);
    }
    off
}
