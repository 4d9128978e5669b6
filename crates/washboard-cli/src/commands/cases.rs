//! `washboard cases`: published vehicles and roads.

use crate::output::{Failure, Output};
use crate::table::Table;
use clap::Args;
use serde::Serialize;
use std::process::ExitCode;
use washboard::cases::{Case, all, named};
use washboard::study::Envelope;

/// List the published vehicles and roads, or print one as TOML to start from.
#[derive(Debug, Args)]
pub struct Arguments {
    /// A name, with or without `case:`.
    name: Option<String>,
}

#[derive(Serialize)]
struct List {
    cases: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    name: String,
    kind: &'static str,
    citation: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    toml: Option<String>,
}

fn row(case: &Case) -> Row {
    Row { name: case.name.clone(), kind: case.kind.name(), citation: case.citation(), toml: None }
}

/// Lists or prints.
pub fn run(arguments: Arguments, output: Output) -> Result<ExitCode, Failure> {
    match arguments.name {
        Some(name) => {
            let case = named(name.strip_prefix("case:").unwrap_or(&name))?;
            let one = Row { toml: Some(case.toml.clone()), ..row(&case) };
            output.print(&Envelope::new("cases", vec![], one), |_| case.toml)?;
        }
        None => {
            let list = List { cases: all().iter().map(row).collect() };
            output.print(&Envelope::new("cases", vec![], list), table)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn table(list: &List) -> String {
    let mut table = Table::new(&["<name", "<kind", "<source"]);
    for case in &list.cases {
        for (i, line) in wrapped(&case.citation).into_iter().enumerate() {
            let [name, kind] = if i == 0 {
                [format!("case:{}", case.name), case.kind.to_owned()]
            } else {
                [String::new(), String::new()]
            };
            table.row([name, kind, line]);
        }
    }
    table.text()
}

/// Lines of at most 80 letters.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        match lines[last].chars().count() {
            0 => lines[last] += word,
            n if n + word.chars().count() < 80 => lines[last] += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
