//! The command line of washboard: arguments → [`washboard::study`] → tables and files. No science lives here.

// a command line prints: results to standard output, one message to standard error
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod args;
mod commands;
mod output;
mod table;
#[cfg(feature = "parquet")]
mod table_parquet;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Identify a vehicle and its road from a drive, ride on models of them, and design their suspension.
///
/// A VEHICLE or ROAD is a TOML file or case:NAME (`washboard cases` lists them). Exit status: 0 success; 1 it ran and the
/// answer is no; 2 wrong input.
#[derive(Debug, Parser)]
#[command(name = "washboard", version, propagate_version = true)]
struct Cli {
    #[command(flatten)]
    output: output::Output,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(commands::demo::Arguments),
    Cases(commands::cases::Arguments),
    Modes(commands::modes::Arguments),
    Damping(commands::damping::Arguments),
    Ride(commands::ride::Arguments),
    Road(commands::road::Arguments),
    Respond(commands::respond::Arguments),
    Simulate(commands::simulate::Arguments),
    Identify(commands::identify::Arguments),
    Compare(commands::compare::Arguments),
    Design(commands::design::Arguments),
    Sweep(commands::sweep::Arguments),
    Merge(commands::merge::Arguments),
    Interpolate(commands::interpolate::Arguments),
    Reproduce(commands::reproduce::Arguments),
    Report(commands::report::Arguments),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let run = match cli.command {
        Command::Demo(a) => commands::demo::run(a, cli.output),
        Command::Cases(a) => commands::cases::run(a, cli.output),
        Command::Damping(a) => commands::damping::run(a, cli.output),
        Command::Modes(a) => commands::modes::run(a, cli.output),
        Command::Respond(a) => commands::respond::run(a, cli.output),
        Command::Ride(a) => commands::ride::run(a, cli.output),
        Command::Road(a) => commands::road::run(a, cli.output),
        Command::Simulate(a) => commands::simulate::run(a, cli.output),
        Command::Identify(a) => commands::identify::run(a, cli.output),
        Command::Design(a) => commands::design::run(a, cli.output),
        Command::Compare(a) => commands::compare::run(a, cli.output),
        Command::Sweep(a) => commands::sweep::run(a, cli.output),
        Command::Merge(a) => commands::merge::run(a, cli.output),
        Command::Interpolate(a) => commands::interpolate::run(a, cli.output),
        Command::Reproduce(a) => commands::reproduce::run(a, cli.output),
        Command::Report(a) => commands::report::run(a, cli.output),
    };
    run.unwrap_or_else(|failure| failure.exit(cli.output))
}
