//! `washboard road`: shaping filters of roads, random profiles, the roughness index, analytic functions.

mod analytic;
mod fit;
mod iri;
mod profile;

use crate::output::{Failure, Output};
use crate::table::wrapped;
use clap::{Args, Subcommand};
use std::process::ExitCode;
use washboard::study::Flag;

/// Roads: a shaping filter of a measured spectrum or profile, random profiles, the roughness index.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Fit(fit::Arguments),
    Profile(profile::Arguments),
    Iri(iri::Arguments),
    Analytic(analytic::Arguments),
}

/// Runs the one that is named.
pub fn run(arguments: Arguments, output: Output) -> Result<ExitCode, Failure> {
    match arguments.command {
        Command::Fit(a) => fit::run(a, output),
        Command::Profile(a) => profile::run(a, output),
        Command::Iri(a) => iri::run(a, output),
        Command::Analytic(a) => analytic::run(a, output),
    }
}

/// Notes as sentences, one a line.
fn said(notes: &[Flag]) -> String {
    notes.iter().map(|n| wrapped(&format!("note: {}", n.text))).collect()
}

/// What was written.
fn wrote(file: Option<&String>) -> String {
    file.map_or_else(String::new, |f| format!("wrote {f}\n"))
}

/// Imaginary parts below this share of a root are those that rounding gives repeated real ones.
const REAL: f64 = 1e-6;

/// Poles and zeros: a conjugate pair in one, by its upper half; those that read alike once, with their number.
fn roots(roots: &[[f64; 2]]) -> String {
    let number = crate::table::number;
    let mut said: Vec<(String, usize)> = Vec::new();
    for [re, im] in roots {
        let real = im.abs() <= REAL * re.hypot(*im);
        if *im < 0.0 && !real {
            continue;
        }
        let text = if real { number(*re) } else { format!("{} ± {}i", number(*re), number(*im)) };
        match said.iter_mut().find(|(known, _)| *known == text) {
            Some((_, count)) => *count += 1,
            None => said.push((text, 1)),
        }
    }
    let text: Vec<String> =
        said.into_iter().map(|(text, n)| if n == 1 { text } else { format!("{text} ({n} times)") }).collect();
    if text.is_empty() { "none".to_owned() } else { text.join(", ") }
}

/// Singular values beside the orders that they speak for.
fn values(values: &[f64], shown: usize) -> String {
    let text: Vec<String> = values.iter().take(shown).map(|v| crate::table::number(*v)).collect();
    let more = if values.len() > shown { ", …" } else { "" };
    format!("{}{more}", text.join(", "))
}
