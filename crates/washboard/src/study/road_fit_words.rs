//! What a fitted filter's reader must know, in words.

use super::identify_outcome::Flag;
use super::road_fit::RoadFitOutcome;
use super::road_fit_filter::RoadFilter;
use super::road_fit_order::ACCURATE;
use super::road_fit_source::FitSource;
use crate::road::FilterOutput;

/// Singular values that fall by more than this at once tell signal from noise.
const SHARP: f64 = 100.0;
/// Densities of fewer averages than this are called raw.
const RAW: f64 = 4.0;
/// Of fewer than this they are those of one periodogram, and smoothing helps: of 3 averages it makes the level .94 of the true.
const PERIODOGRAM: f64 = 1.5;
/// Averages after which the logarithm is as good as the density: 0.1 in its mean.
const LEAST_AVERAGES: usize = 5;
/// Poles far beyond the band are told where their part of the filter has more than this share of its variance.
const CARRIED: f64 = 1e-8;
/// Or than this over the root of the averages that noisy samples are worth: log₁₀ of e, and a fifth more.
const NOISY: f64 = 0.52;
/// A minimum at more than this many times the band's upper end has no frequency worth telling.
const FAR_BEYOND: f64 = 100.0;
/// A fit further off than this (log₁₀, rms) is called rough.
const ROUGH: f64 = 0.1;

/// Choice of the order, repairs, foldings, roll-off, and where the filter may be believed.
pub(super) fn notes(
    o: &RoadFitOutcome,
    filter: &RoadFilter,
    asked: Option<usize>,
    averages: Option<f64>,
) -> Vec<Flag> {
    let mut notes = Vec::new();
    let mut note = |name: &str, text: String| notes.push(Flag { name: name.to_owned(), text });
    if let Some(asked) = asked.filter(|n| *n > o.order) {
        let surplus = asked - o.order;
        note(
            "order-lowered",
            format!(
                "order {} comes nearest to the samples; {asked} were asked for, and {} more would be noise",
                o.order,
                if surplus == 1 { "one state".to_owned() } else { format!("{surplus} states") }
            ),
        );
    }
    if let Some(k) = averages.filter(|k| o.source == FitSource::Spectrum && *k < RAW) {
        let smooth = if k < PERIODOGRAM {
            "; or --smooth 3 averages them in thirds of an octave first, which takes coherence from channels with a delay between them"
        } else {
            ""
        };
        note(
            "raw",
            format!(
                "neighbouring densities scatter as those of {k:.1} averages do: the logarithm of such densities is low, and an order is hard to tell. Give the mean of {LEAST_AVERAGES} spectra or more{smooth}"
            ),
        );
    }
    if let Some(k) = averages.filter(|_| o.weight.starts_with("relative")) {
        note(
            "averages",
            format!(
                "neighbouring densities scatter as those of {k:.1} averages do: weights are of local means about each sample, so that noise does not draw the level down, and the criterion is that of such noise"
            ),
        );
    }
    if !o.orders.is_empty() {
        let tried = o.orders.last().map_or(0, |t| t.order);
        let sharp = drop(&o.singular_values).map_or_else(String::new, |n| {
            format!(
                "; the singular values' largest drop is after {n}, where 2n of an exact order n stand out"
            )
        });
        let text = if o.source == FitSource::Road {
            if o.log10_rms_error < ACCURATE {
                format!(
                    "order {} is the lowest that follows the road to a log10 error of {ACCURATE} (--order gives another){sharp}",
                    o.order
                )
            } else {
                format!(
                    "order {} of 1 to {tried} follows the road best (--max-order tries more){sharp}",
                    o.order
                )
            }
        } else {
            let more = if o.order == tried && drop(&o.singular_values) != Some(2 * o.order) {
                ", the largest that was tried (--max-order tries more)"
            } else {
                ""
            };
            format!("order {} of 1 to {tried} has the smallest Bayes' criterion{more}{sharp}", o.order)
        };
        note("order-chosen", text);
    }
    if let Some(repair) = &filter.fit.model.repair {
        let at = filter.fit.lambda_rad * (0.5 * repair.theta_rad).tan();
        let [_, high] = filter.fit.band_rad;
        let at = if at > FAR_BEYOND * high {
            "far beyond the band".to_owned()
        } else {
            format!("lowest near {at:.4} {}", o.unit)
        };
        note(
            "positivity-repaired",
            format!(
                "the fit fell below zero ({at}) and was lifted by least squares under constraints, in {} round(s); its misfit grew by a factor {:.3}",
                repair.rounds,
                repair.misfit[1] / repair.misfit[0]
            ),
        );
    }
    if o.folded > 0 {
        note(
            "folded",
            format!(
                "{} had no mirror image and {} folded into the stable half plane: another order may fit better",
                if o.folded == 1 { "one pole".to_owned() } else { format!("{} poles", o.folded) },
                if o.folded == 1 { "was" } else { "were" },
            ),
        );
    }
    match (o.roll_off_rad, o.of) {
        (Some(corner), of) => {
            let what = if of == FilterOutput::Velocity { "velocity" } else { "height" };
            let (more, times) = (o.states - o.order, if o.roll_off_order > 1 { " passed twice" } else { "" });
            let often = if o.c.len() > 1 { ", --roll-off-order says how often it is passed" } else { "" };
            let states = if more == 1 { "one state".to_owned() } else { format!("{more} states") };
            note(
                "roll-off",
                format!(
                    "the fit of order {} has feedthrough, white noise in the {what}: a low-pass at {corner:.4} {}{times} makes it strictly proper, {states} more; the fit allows for it, so that it bends nothing within the band, and beyond it the {what} falls (--roll-off moves it{often}, --proper leaves the feedthrough)",
                    o.order, o.unit,
                ),
            );
        }
        (None, FilterOutput::Displacement) if filter.system.d().norm_l2() > 0.0 => {
            note(
                "proper",
                "the filter has feedthrough: white noise in the height, and accelerations are infinite on it"
                    .into(),
            );
        }
        _ => {}
    }
    if o.c.len() > 1 && o.roll_off_order == 1 {
        note(
            "once",
            "heights fall as 1/ω² beyond the band (one pass of the low-pass is nearer to the samples than two, or was asked for): their velocities are white there, and accelerations of what stands on a point by a damper are infinite; --roll-off-order 2 makes them finite"
                .into(),
        );
    }
    if let Some(text) = far_poles(filter, o) {
        note("far-poles", text);
    }
    if !o.usable {
        note(
            "not-followed",
            format!(
                "no filter that follows the samples was found: densities are off by a factor {:.2} (rms). Nothing is written; narrow --band, give --order, smooth the spectrum, or weigh it otherwise (--weight)",
                10f64.powf(o.log10_rms_error)
            ),
        );
    } else if !(o.log10_rms_error <= averages.map_or(ROUGH, |k| ROUGH.max(NOISY / k.sqrt()))) {
        note(
            "rough",
            format!(
                "densities are off by a factor {:.2} (rms), {:.2} at most: try another --order or --band",
                10f64.powf(o.log10_rms_error),
                10f64.powf(o.log10_max_error)
            ),
        );
    }
    note(
        "band",
        format!(
            "fitted from {:.4e} to {:.4e} {}; what the filter has beyond is its own continuation",
            o.band[0], o.band[1], o.unit
        ),
    );
    notes
}

/// Poles far beyond the band that carry more than [`CARRIED`] of what the filter has within it.
fn far_poles(filter: &RoadFilter, o: &RoadFitOutcome) -> Option<String> {
    let far = filter.far_poles();
    let lowest = far.iter().map(|p| p.norm()).min_by(f64::total_cmp)?;
    let share = filter.share_of(&far)?;
    if !(share > CARRIED) {
        return None;
    }
    let many = if far.len() == 1 { "one pole is".to_owned() } else { format!("{} poles are", far.len()) };
    Some(format!(
        "{many} at {lowest:.3e} {} and beyond, {:.0} times the band's upper end or more, and carry {:.2e} of the rms: no sample shows them, and tire forces and deflections on this filter may be far too large; a lower --order, another --roll-off-order or --max-order leaves them out",
        o.unit,
        lowest / o.band[1],
        share.sqrt()
    ))
}

/// After how many singular values the next one falls by the largest factor, where that is a drop indeed.
pub(super) fn drop(values: &[f64]) -> Option<usize> {
    let largest = values.first().copied()?;
    let ratio = |k: usize| values[k - 1] / values[k].max(1e-14 * largest);
    (1..values.len()).max_by(|a, b| ratio(*a).total_cmp(&ratio(*b))).filter(|k| ratio(*k) > SHARP)
}
