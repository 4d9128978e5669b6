//! washboard turns what a vehicle *feels* into what its suspension should *do*: a recording of a drive → the vehicle's
//! modes and the road's roughness → (to come) a road filter → a suspension controller → what it buys.
//!
//! # The modes of a published car
//! Vehicles are built from files, or taken from [`cases`]; every matrix is at hand.
//! ```
//! let car = washboard::cases::vehicle("guiggiani-full-car")?;
//! let modes = car.modes()?;
//! let (heave, name) = &modes[0];
//! assert_eq!(name, "heave");
//! assert!((heave.freq_hz - 1.064).abs() < 5e-4 && (heave.damping - 0.280).abs() < 5e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What reaches its occupants on a road
//! Variances come by Lyapunov equations where the road is rational and by adaptive quadrature elsewhere, front-to-rear
//! delays and left-right coherence included; what is infinite says so.
//! ```
//! use washboard::{cases, vehicle::Ride};
//! let car = cases::vehicle("guiggiani-full-car")?;
//! let road = cases::road("iso8608-c")?;
//! let ride = Ride::new(&car, &road, 20.0)?;
//! let rms = ride.variances(&[car.output("heave_acceleration")?])?[0].rms();
//! assert!(rms.is_some_and(|m_s2| (m_s2 - 0.758).abs() < 1e-3));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A drive, and its spectra
//! A [`signal::Recording`] knows its rate, units, directions and places: declared, never guessed.
//! ```
//! use washboard::signal::{Channel, Direction, Place, Quantity, Segment, WelchSettings, welch};
//! use washboard::vehicle::{DriveSettings, Flaws, simulate};
//! use washboard::cases;
//! let hub = Channel {
//!     name: "hub_fl".into(),
//!     quantity: Quantity::Acceleration,
//!     direction: Direction::PlusZ,
//!     place: Place::Hub,
//!     wheel: Some(0),
//!     at_m: None,
//! };
//! let (car, road) = (cases::vehicle("guiggiani-full-car")?, cases::road("iso8608-c")?);
//! let settings = DriveSettings { speed_m_s: 20.0, duration_s: 60.0, rate_hz: 100.0, seed: 0 };
//! let drive = simulate(&car, &road, &[(hub, Flaws::default())], &settings)?;
//! let spectra = welch(&drive, &WelchSettings::hann(Segment::Seconds(2.0)))?;
//! let loudest = (0..spectra.s.len()).max_by(|a, b| {
//!     spectra.s[*a][(0, 0)].re.total_cmp(&spectra.s[*b][(0, 0)].re)
//! });
//! let freq_hz = spectra.freq_hz[loudest.unwrap_or(0)];
//! assert!((6.0..16.0).contains(&freq_hz), "wheel hop, and not {freq_hz} Hz");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Jobs as data
//! [`study`] holds each job of the command line as a specification and an outcome, both serialisable.
//! The layers are in `ARCHITECTURE.md`, every file and key in `docs/interface.md`, what is known not to work in
//! `KNOWN_LIMITS.md`.

pub mod cases;
pub mod files;
pub mod identify;
pub mod linalg;
pub mod lti;
pub mod metrics;
pub mod optimize;
pub mod report;
pub mod road;
pub mod signal;
pub mod study;
pub mod subspace;
pub mod synthesis;
pub mod units;
pub mod vehicle;
