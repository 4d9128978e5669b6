//! Where results go: JSON or a table to standard output, progress to a terminal, one message for what went wrong.

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::io::{ErrorKind, IsTerminal, Write};
use std::process::ExitCode;
use std::time::Duration;
use washboard::cases::CaseError;
use washboard::files::FileError;
use washboard::study::{Envelope, SCHEMA_VERSION, StudyError};

/// Options of every command.
#[derive(Debug, Clone, Copy, Args)]
pub struct Output {
    /// Print one JSON object and nothing else.
    #[arg(long, global = true, display_order = 900)]
    pub json: bool,
    /// No progress on standard error.
    #[arg(long, global = true, display_order = 900)]
    pub quiet: bool,
}

impl Output {
    /// Prints an envelope as JSON, or its table.
    pub fn print<T: Serialize>(
        self,
        envelope: &Envelope<T>,
        table: impl FnOnce(&T) -> String,
    ) -> Result<(), Failure> {
        let text = if self.json { envelope.to_json() } else { plain(&table(&envelope.outcome), true) };
        print(&text)
    }

    /// A spinner on standard error, where that is a terminal.
    pub fn progress(self, what: &str) -> Progress {
        if self.quiet || !std::io::stderr().is_terminal() {
            return Progress(None);
        }
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {elapsed}") {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        Progress(Some(bar))
    }
}

impl Output {
    /// A bar with the time left on standard error, where that is a terminal.
    pub fn bar(self) -> Bar {
        if self.quiet || !std::io::stderr().is_terminal() {
            return Bar(None);
        }
        let bar = ProgressBar::new(0);
        if let Ok(style) =
            ProgressStyle::with_template("{wide_bar} {pos}/{len} points, {elapsed}, {eta} left")
        {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        Bar(Some(bar))
    }
}

/// A bar that is gone when it is dropped.
pub struct Bar(Option<ProgressBar>);

impl Bar {
    /// How much is done; what was `found` at the beginning took no time.
    pub fn show(&self, done: usize, found: usize, total: usize) {
        let Some(bar) = &self.0 else { return };
        bar.set_length(total as u64);
        if done == found {
            bar.set_position(found as u64);
            bar.reset_eta();
        } else {
            bar.inc(1);
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// A spinner that is gone when it is dropped.
pub struct Progress(Option<ProgressBar>);

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// Text in which names from files cannot steer a terminal: control and direction characters are written as escapes.
fn plain(text: &str, lines: bool) -> String {
    let steers = |c: char| {
        (c.is_control() && !(lines && c == '\n'))
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if steers(c) { out.extend(c.escape_default()) } else { out.push(c) }
    }
    out
}

/// Text to standard output; a reader that has gone away is no error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure { message: format!("standard output: cannot write: {e}"), wrong_input: true })
        }
        _ => Ok(()),
    }
}

/// Why a command has no result.
#[derive(Debug)]
pub struct Failure {
    message: String,
    wrong_input: bool,
}

impl Failure {
    /// Of a computation.
    #[cfg(feature = "parquet")]
    pub fn of_computation(message: String) -> Self {
        Failure { message, wrong_input: false }
    }

    /// Says it once: exit status 2 for wrong input, 1 where the computation failed.
    pub fn exit(self, output: Output) -> ExitCode {
        if output.json && !self.wrong_input {
            let answer = serde_json::json!({
                "schema_version": SCHEMA_VERSION, "status": "failed", "why": self.message,
            });
            let _ = print(&format!("{answer:#}\n"));
        }
        eprintln!("error: {}", plain(&self.message, false));
        ExitCode::from(if self.wrong_input { 2 } else { 1 })
    }
}

impl From<StudyError> for Failure {
    fn from(e: StudyError) -> Self {
        Failure { wrong_input: e.is_wrong_input(), message: e.to_string() }
    }
}

impl From<FileError> for Failure {
    fn from(e: FileError) -> Self {
        StudyError::from(e).into()
    }
}

impl From<CaseError> for Failure {
    fn from(e: CaseError) -> Self {
        StudyError::from(e).into()
    }
}
