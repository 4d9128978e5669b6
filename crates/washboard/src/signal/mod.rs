//! From a file to spectra: recordings whose channels, units, places and speed are declared, the repairs that real files
//! need, and Welch's cross-spectra.
//!
//! ```no_run
//! use washboard::signal::{Segment, WelchSettings, read_recording, welch};
//! let recording = read_recording(std::path::Path::new("RUN.toml"))?;
//! for repair in recording.repairs() {
//!     eprintln!("{}", repair.text);
//! }
//! let spectra = welch(&recording, &WelchSettings::hann(Segment::Seconds(5.0)))?;
//! assert_eq!(spectra.freq_hz.len(), spectra.s.len());
//! # Ok::<(), washboard::signal::SignalError>(())
//! ```

mod by_speed;
mod channel;
mod clock;
mod condition;
mod correlation;
mod csv;
mod decimate;
mod declared;
mod description;
mod error;
mod npy;
mod read;
mod recording;
mod resample;
mod spectra;
mod sst;
mod time_base;
mod unit;
mod window;

pub use by_speed::{SPEED_SMOOTHING_S, SpeedClass, SpeedCut, SpeedCutSettings, by_speed};
pub use channel::{Channel, Direction, Place, Quantity, WheelPlace};
pub use clock::Clock;
pub use condition::{CLIPPED_RUN, Repair, RepairKind};
pub use correlation::{CorrelationError, Correlations, correlations};
pub use csv::{CsvLayout, parse_csv, read_csv};
pub use decimate::{PASSBAND, STOPBAND};
pub use description::{
    Calibration, ChannelDescription, Column, Format, RecordingDescription, SpeedFile, Stamps, TimeUnit,
};
pub use error::SignalError;
pub use npy::{parse_npy, read_npy};
pub use read::{MAX_SPEED_GAP_S, MAX_VALUES, read_description, read_recording};
pub use recording::Recording;
pub(crate) use spectra::averaged;
pub use spectra::{CrossSpectra, Segment, WelchSettings, welch};
pub use sst::{SstRecord, parse_sst, read_sst};
pub use time_base::{MAX_FILL_S, MAX_FILL_SAMPLES};
pub use unit::{SpeedUnit, Unit};
pub use window::{HannWindow, KERNEL_HALF_WIDTH};
