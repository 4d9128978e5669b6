//! Methods that fail when they must: the window's kernel switched off in the model.

use super::common::{cars, sensors};
use washboard::cases;
use washboard::identify::{ANNEALING_NONE, CHI_LIMIT, PhysicalDrive, PhysicalSettings, fit_physical};
use washboard::lti::Parametric;
use washboard::signal::{HannWindow, Segment, WelchSettings, welch};
use washboard::units::Convention;
use washboard::vehicle::{DriveSettings, ParametricVehicle, simulate};

/// Ten minutes in segments of 5 s, from the truth: with the kernel the model explains the spectra, without it nothing does.
#[test]
fn without_the_windows_kernel_the_physical_fit_is_a_misfit() {
    let (_, spec) = &cars()[0];
    let road = cases::road("iso8608-c").unwrap();
    let settings = DriveSettings { speed_m_s: 20.0, duration_s: 600.0, rate_hz: 200.0, seed: 5 };
    let recording = simulate(&spec.build_alone().unwrap(), &road, &sensors("all", 0.02), &settings).unwrap();
    let (family, derivatives) =
        ParametricVehicle::new(spec, recording.channels(), recording.wheels(), &[]).unwrap();
    assert!(!family.names().is_empty());
    let spectra = welch(&recording, &WelchSettings::hann(Segment::Samples(1000))).unwrap();
    let fit = |window: HannWindow| {
        let spectra = washboard::signal::CrossSpectra { window, ..spectra.clone() };
        let drive = PhysicalDrive {
            vehicle: &family,
            derivatives: &derivatives,
            spectra: &spectra,
            blocks: &[],
            speed_m_s: 20.0,
            band_hz: [0.4, 20.0],
        };
        let settings = PhysicalSettings {
            annealing: ANNEALING_NONE.to_vec(),
            clocks: false,
            ..PhysicalSettings::new(Convention::default())
        };
        fit_physical(&[drive], &settings).unwrap()
    };
    let sound = fit(spectra.window.clone());
    assert!(sound.problems.is_empty() && sound.chi < CHI_LIMIT, "{} {:?}", sound.chi, sound.problems);
    let blind = fit(spectra.window.clone().without_kernel());
    assert!(blind.chi > 10.0 * CHI_LIMIT, "{}", blind.chi);
    assert!(blind.problems.iter().any(|(name, _)| *name == "misfit"), "{:?}", blind.problems);
}
