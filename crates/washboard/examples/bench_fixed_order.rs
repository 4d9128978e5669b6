//! What the quarter car's controllers of orders 1 to 4 take (section 5.3 of the thesis), lower orders included: the least time of
//! several runs, loops (each the norms of one plant), factorisations of iωI − A, eigenvalue problems.
//!
//! `cargo run --release -p washboard --example bench_fixed_order [RUNS]`

#![allow(clippy::print_stdout, clippy::indexing_slicing, dead_code)]

#[path = "common/fixed.rs"]
mod fixed;

use fixed::{asked, quarter, quarter_targets};
use std::error::Error;
use std::time::Instant;
use washboard::synthesis::{FixedOrderEnd, FixedOrderSettings, fixed_order};

fn main() -> Result<(), Box<dyn Error>> {
    let runs: usize = std::env::args().nth(1).and_then(|w| w.parse().ok()).unwrap_or(3);
    let plant = quarter(98.0)?;
    let targets = quarter_targets(0, &plant.passive(), [1.0, 1.0])?;
    println!("order  goal      least time   loops  factorisations  eigenproblems  lyapunov");
    for order in 1..=4 {
        let of = asked(vec![plant.clone()], targets.clone(), order);
        let mut least = f64::INFINITY;
        let mut last = None;
        for _ in 0..runs.max(1) {
            let begun = Instant::now();
            last = Some(fixed_order(&of, &FixedOrderSettings::default())?);
            least = least.min(begun.elapsed().as_secs_f64());
        }
        let Some(FixedOrderEnd::Designed(d)) = last else {
            println!("{order:<6} no design");
            continue;
        };
        let w = d.work;
        println!(
            "{order:<6} {:.6}  {least:>8.2} s {:>8} {:>15} {:>14} {:>9}",
            d.verified_goal.unwrap_or(f64::NAN),
            w.loops,
            w.factorisations,
            w.eigenproblems,
            w.lyapunov
        );
    }
    Ok(())
}
