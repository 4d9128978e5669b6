//! STUB, to be replaced on merge by `washboard::report::identify_page`.

use washboard::study::IdentifyOutcome;

/// The page of an identification.
pub fn identify_page(outcome: &IdentifyOutcome, title: &str) -> String {
    format!("<!doctype html><title>{title}</title><p>{} modes\n", outcome.modes.len())
}
