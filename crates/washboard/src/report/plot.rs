//! A plot as data: what `plots.js` draws, and nothing that it would have to compute.

use super::html::{Html, classed, element};
use serde::{Deserialize, Serialize};

/// Digits kept of a plotted number: more than any screen shows, and half the size of the page.
const PLOTTED_DIGITS: usize = 6;

/// The plots of a page in the order of their places.
#[derive(Debug, Default)]
pub(super) struct Plots(pub Vec<Plot>);

impl Plots {
    /// Keeps a plot and returns its place in the page.
    pub fn add(&mut self, plot: Plot) -> Html {
        let place = plot.place(self.0.len());
        self.0.push(plot);
        place
    }
}

/// One plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Plot {
    /// Its heading.
    pub title: String,
    /// Abscissa, ascending.
    pub x: Vec<f64>,
    /// The abscissa's scale.
    pub x_axis: Axis,
    /// The ordinate's scale.
    pub y_axis: Axis,
    /// A second ordinate at the right, for the series that say so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_axis: Option<Axis>,
    /// The curves.
    pub series: Vec<Series>,
    /// Vertical lines: the modes.
    pub marks: Vec<Mark>,
    /// Straight lines through two points: class limits, thresholds.
    pub lines: Vec<Line>,
    /// A text a point, for the plots whose points have a story.
    pub hover: Vec<String>,
    /// Plots of one group share the cursor.
    pub group: String,
    /// Full width, or two side by side.
    pub wide: bool,
}

/// A scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Axis {
    /// Name and unit.
    pub label: String,
    /// The unit alone, for the read-out.
    pub unit: String,
    /// Logarithmic.
    pub log: bool,
    /// Ends; where none are given, those of the data.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A scale whose ends are those of the data.
    pub fn new(name: &str, unit: &str, log: bool) -> Self {
        let label = [name, unit].into_iter().filter(|s| !s.is_empty()).collect::<Vec<_>>().join(", ");
        Axis { label, unit: unit.to_owned(), log, range: None }
    }

    /// The same scale with ends.
    pub fn within(self, low: f64, high: f64) -> Self {
        Axis { range: Some([short(low), short(high)]), ..self }
    }
}

/// What a curve is: it decides colour, width and shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Role {
    /// Measured, a thin line.
    #[default]
    Measured,
    /// Measured, points alone.
    MeasuredPoints,
    /// Fitted: a thick light line below the measured one.
    Fitted,
    /// Fitted, points alone: a phase, whose line would jump at ±180°.
    FittedPoints,
    /// Found, without a measured curve beside it: a dark line.
    Found,
    /// Upper end of an interval; the lower one follows it.
    High,
    /// Lower end of an interval.
    Low,
    /// The truth of a simulation.
    Truth,
    /// Poles, each kind with its own sign and colour.
    Poles,
    /// Estimates with their error bars, each kind with its own sign and colour.
    Estimates,
    /// Singular values, lines behind the poles.
    Singular,
    /// Measured before a change, and after it.
    Before,
    /// The later one.
    After,
    /// One of several computed curves; its sign gives colour and dashes.
    Line,
    /// Without control: grey.
    Passive,
    /// Of the controller of a method, whose colour its sign gives: `demo`'s picture has the same.
    Designed,
    /// Of the one that was designed with the truth: dark and dotted or dashed by its sign.
    DesignedTrue,
    /// Ends of an interval about the measured curve.
    MeasuredHigh,
    /// The lower one.
    MeasuredLow,
}

/// A curve; null where it has a gap.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Series {
    /// For the legend.
    pub label: String,
    /// What it is.
    pub role: Role,
    /// Ordinates, one an abscissa.
    pub y: Vec<Option<f64>>,
    /// Half the length of each point's error bar; empty for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub error: Vec<Option<f64>>,
    /// Which sign and colour, of the roles that have several.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sign: usize,
    /// On the second ordinate.
    #[serde(default, skip_serializing_if = "is_false")]
    pub second: bool,
}

fn is_zero(n: &usize) -> bool {
    *n == 0
}

fn is_false(b: &bool) -> bool {
    !b
}

/// A vertical line with a text at its top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Mark {
    /// Abscissa.
    pub x: f64,
    /// Text; empty for none.
    pub label: String,
}

/// A straight line on the plot's scales, with a text at its left end; a line without length is a text right of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Line {
    /// Both ends' abscissas.
    pub x: [f64; 2],
    /// Both ends' ordinates.
    pub y: [f64; 2],
    /// Text; empty for none.
    pub label: String,
    /// The colour of the points of this sign, to which it belongs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sign: Option<usize>,
}

impl Line {
    /// From one point to another.
    pub fn new(x: [f64; 2], y: [f64; 2], label: impl Into<String>) -> Self {
        Line { x: x.map(short), y: y.map(short), label: label.into(), sign: None }
    }
}

impl Mark {
    /// At an abscissa.
    pub fn new(x: f64, label: impl Into<String>) -> Self {
        Mark { x: short(x), label: label.into() }
    }
}

impl Plot {
    /// A plot of nothing yet.
    pub fn new(title: impl Into<String>, x: &[f64], x_axis: Axis, y_axis: Axis) -> Self {
        Plot {
            title: title.into(),
            x: x.iter().map(|v| short(*v)).collect(),
            x_axis,
            y_axis,
            second_axis: None,
            series: Vec::new(),
            marks: Vec::new(),
            lines: Vec::new(),
            hover: Vec::new(),
            group: String::new(),
            wide: false,
        }
    }

    /// A curve more; one that has not a value an abscissa is left out. Values that the scale cannot show become gaps.
    pub fn curve(mut self, label: &str, role: Role, y: impl IntoIterator<Item = Option<f64>>) -> Self {
        let curve = Series { label: label.to_owned(), role, y: y.into_iter().collect(), ..Series::default() };
        self.push(curve);
        self
    }

    /// The same with error bars, signs or the second ordinate.
    pub fn push(&mut self, mut series: Series) {
        let log =
            if series.second { self.second_axis.as_ref().is_some_and(|a| a.log) } else { self.y_axis.log };
        let shown = |v: &f64| v.is_finite() && (!log || *v > 0.0);
        for y in &mut series.y {
            *y = y.filter(shown).map(short);
        }
        for e in &mut series.error {
            *e = e.filter(|e| e.is_finite()).map(short);
        }
        if series.y.len() == self.x.len() && series.y.iter().any(Option::is_some) {
            self.series.push(series);
        }
    }

    /// Where the plot stands in the page: an empty place that names the plot by its number.
    pub fn place(&self, number: usize) -> Html {
        let class = if self.wide { "plot wide" } else { "plot" };
        let title = element("figcaption", &[], self.title.as_str());
        let canvas = element("div", &[("class", "canvas"), ("data-plot", &number.to_string())], "");
        classed("figure", class, title.and(canvas))
    }
}

/// A number with [`PLOTTED_DIGITS`] digits.
fn short(value: f64) -> f64 {
    format!("{value:.*e}", PLOTTED_DIGITS - 1).parse().unwrap_or(value)
}

/// Positions at which a scale can show the abscissas: finite, and positive where it is logarithmic.
pub(super) fn shown(x: &[f64], log: bool) -> Vec<usize> {
    (0..x.len()).filter(|k| x[*k].is_finite() && (!log || x[*k] > 0.0)).collect()
}

/// The chosen values.
pub(super) fn pick(values: &[f64], keep: &[usize]) -> Vec<Option<f64>> {
    keep.iter().map(|k| values.get(*k).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty() -> Plot {
        Plot::new("p", &[1.0, 2.0], Axis::new("f", "Hz", true), Axis::new("S", "", true))
    }

    #[test]
    fn what_a_scale_cannot_show_is_a_gap_and_no_nan_reaches_the_page() {
        let plot = empty().curve("a", Role::Measured, [Some(0.0), Some(1.0 / 3.0)]);
        assert_eq!(plot.series[0].y, [None, Some(0.333333)]);
        assert!(empty().curve("a", Role::Measured, [Some(f64::NAN), None]).series.is_empty());
        assert!(empty().curve("too short", Role::Measured, [Some(1.0)]).series.is_empty());
    }

    #[test]
    fn a_plot_is_read_back_equal() {
        let plot = empty().curve("a", Role::MeasuredPoints, [Some(1e-9), Some(2.0)]);
        let json = serde_json::to_string(&plot).unwrap();
        assert!(json.contains("\"measured-points\""));
        assert_eq!(serde_json::from_str::<Plot>(&json).unwrap(), plot);
    }

    #[test]
    fn frequencies_from_zero_lose_their_first_on_a_log_scale() {
        assert_eq!(shown(&[0.0, 1.0, f64::NAN, 2.0], true), [1, 3]);
        assert_eq!(pick(&[5.0, 6.0], &[1, 3]), [Some(6.0), None]);
    }
}
