//! Section 4.4: rms values of the LQG designs, and what they save.

use super::ReproduceError;
use super::context::{BOTH, Context, DAMPED, OVERDAMPED, TRAVEL, three};
use super::item::{INPUT, Sheet};
use super::{chapter_4_car, chapter_4_hybrid};

/// Everything that §4.4 says in numbers.
pub(super) fn section(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    chapter_4_car::modes_and_rms(context, sheet)?;
    designs(context, sheet)?;
    chapter_4_hybrid::claims(context, sheet)
}

fn designs(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    for (ct, y2, both) in [
        (0.0, ["0.5240", "0.0034", "0.0016"], ["0.5234", "0.0034", "0.0016"]),
        (OVERDAMPED, ["0.2834", "0.0036", "0.0010"], ["0.2724", "0.0037", "0.0010"]),
        (DAMPED, ["0.4895", "0.0034", "0.0016"], ["0.4900", "0.0034", "0.0016"]),
    ] {
        for (name, y, printed) in [("y₂", &TRAVEL[..], y2), ("[y₁ y₂]", &BOTH[..], both)] {
            let first = sheet.checks.len();
            three(sheet, &format!("LQG with {name}, c_t = {ct}"), printed, context.lqg_rms(ct, y)?);
            if ct == 0.0 {
                sheet.checks[first].excused_by("E4.1");
            }
        }
    }
    let passive = [context.passive_rms(0.0)?[0], context.passive_rms(DAMPED)?[0]];
    let drop = |k: usize, active: f64| 100.0 * (1.0 - active / passive[k]);
    let alone = context.lqg_rms(0.0, &TRAVEL)?[0];
    sheet.printed("drop of rms z₁, c_t = 0, %", "3.5", drop(0, alone)).noted("of the design with y₂");
    let both = context.lqg_rms(DAMPED, &BOTH)?[0];
    sheet.printed("drop of rms z₁, c_t = 98, %", "6.83", drop(1, both)).excused_by("E4.11");
    let ratio = drop(1, both) / drop(0, context.lqg_rms(0.0, &BOTH)?[0]);
    sheet.within("ratio of the two drops", "2", ratio, (0.1, "\"about twice\"; designs with [y₁ y₂]"));
    let decades = [DAMPED / context.numbers.cs, OVERDAMPED / context.numbers.cs];
    sheet.within("c_t of the realistic tire over c_s", "0.1", decades[0], (0.0, INPUT));
    sheet.within("c_t of the overdamped tire over c_s", "2", decades[1], (0.0, INPUT));
    Ok(())
}
