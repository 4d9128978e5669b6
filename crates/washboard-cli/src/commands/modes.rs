//! `washboard modes`: frequencies, damping and shapes of a vehicle.

use crate::output::{Failure, Output};
use crate::table::{Table, number, percent};
use clap::Args;
use std::process::ExitCode;
use washboard::study::{Envelope, ModesOutcome, ModesSpec, modes};

/// Frequencies, damping ratios and shapes of a vehicle's modes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// A TOML file or case:NAME.
    vehicle: String,
    /// Print the shapes too: magnitude and phase in degrees.
    #[arg(long)]
    shapes: bool,
}

/// Prints the modes.
pub fn run(arguments: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let (outcome, inputs) = modes(&ModesSpec { vehicle: arguments.vehicle })?;
    output.print(&Envelope::new("modes", inputs, outcome), |o| {
        table(o) + &if arguments.shapes { shapes(o) } else { String::new() }
    })?;
    Ok(ExitCode::SUCCESS)
}

fn table(outcome: &ModesOutcome) -> String {
    let header = ["", "<mode", "frequency (Hz)", "damped (Hz)", "damping (%)", "pole (1/s)", "<kind"];
    let mut table = Table::new(&header);
    for (index, mode) in outcome.modes.iter().enumerate() {
        let [re, im] = mode.pole;
        table.row([
            (index + 1).to_string(),
            mode.label.clone(),
            number(mode.freq_hz),
            number(mode.damped_hz),
            percent(mode.damping),
            if im == 0.0 { format!("{re:.3}") } else { format!("{re:.3} ± {im:.3}i") },
            mode.kind.name().to_owned(),
        ]);
    }
    table.text()
}

fn shapes(outcome: &ModesOutcome) -> String {
    let names: Vec<String> = (1..=outcome.modes.len()).map(|i| format!("mode {i}")).collect();
    let header: Vec<&str> = std::iter::once("<shape").chain(names.iter().map(String::as_str)).collect();
    let mut table = Table::new(&header);
    let dofs = outcome.modes.first().map_or(0, |m| m.shape.len());
    for dof in 0..dofs {
        let cells = outcome.modes.iter().map(|m| {
            let s = &m.shape[dof];
            match s.re.hypot(s.im) {
                size if size < 5e-4 => "0".to_owned(),
                // adding 0.0 makes a zero of a negative one
                size => format!("{size:.3} ∠{:.0}°", s.im.atan2(s.re).to_degrees().round() + 0.0),
            }
        });
        table.row(std::iter::once(outcome.modes[0].shape[dof].dof.clone()).chain(cells));
    }
    format!("\n{}", table.text())
}
