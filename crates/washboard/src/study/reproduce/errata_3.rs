//! Evidence for the errata of chapter 3.

use super::ReproduceError;
use super::chapter_3::{BLOCK_ROWS, columns, data};
use super::context::Context;
use super::errata::shown;
use super::item::Evidence;
use crate::lti::{Polynomial, RationalFunction};
use crate::subspace::{
    Domain, InterpolationData, Node, Point, PrintedForm, interpolate, projected_singular_values,
};

type Shown = Result<Vec<Evidence>, ReproduceError>;

/// Below this, singular values of data of order 1 are rounding.
const ROUNDING: f64 = 1e-10;

/// Real columns, singular values and ranks with the conjugate and without it.
pub(super) fn double_count(_: &Context) -> Shown {
    let data = data()?;
    let above: Vec<Node> =
        data.nodes.iter().filter(|n| matches!(n.z, Point::Finite(z) if z.im >= 0.0)).cloned().collect();
    let m = data.inputs;
    let mut all = vec![shown(
        "N: distinct real columns over m",
        (columns(&data.nodes, m) / m) as f64,
        (columns(&above, m) / m) as f64,
    )];
    let values = |form| projected_singular_values(&data, BLOCK_ROWS, form);
    let (printed, right) = (values(PrintedForm::AsPrinted)?, values(PrintedForm::Deduplicated)?);
    for k in 0..4 {
        all.push(shown(format!("singular value {}", k + 1), printed[k], right[k]));
    }
    let rank = |values: &[f64]| values.iter().filter(|s| **s > ROUNDING).count() as f64;
    all.push(shown("rank", rank(&printed), rank(&right)));
    Ok(all)
}

/// The order that N = 7 < q + n = 9 gives back.
pub(super) fn fewer_nodes(_: &Context) -> Shown {
    let data = data()?;
    let above: Vec<Node> =
        data.nodes.iter().filter(|n| matches!(n.z, Point::Finite(z) if z.im >= 0.0)).cloned().collect();
    let enough = columns(&above, data.inputs) / data.inputs;
    let found = interpolate(&InterpolationData::new(Domain::Disk, above)?, None)?;
    let needed = BLOCK_ROWS + found.order;
    Ok(vec![shown(format!("N that gives order {} with q = 5", found.order), needed as f64, enough as f64)])
}

/// G = 1/(s + 1), s = (z − 1)/(z + 1): its value and slope at z = −1, of which the text wants the slope to vanish.
pub(super) fn relative_degree(_: &Context) -> Shown {
    // 1/((z − 1)/(z + 1) + 1) = (z + 1)/(2z), expanded about z = −1: z = −1 + t
    let g = RationalFunction::new(Polynomial::integers(&[0, 1]), Polynomial::integers(&[-2, 2]))?;
    let series = g.taylor(2)?;
    let at = |k: usize| crate::lti::to_f64(&series[k]);
    Ok(vec![shown("1/(s + 1), τ = 1: what is asked to vanish at z = −1", at(1), at(0))])
}

/// Gain at 0 of the filter, μ = 100, τ = 2.
pub(super) fn low_pass(_: &Context) -> Shown {
    let filter = |gain: i64, omega: f64| -> Result<f64, ReproduceError> {
        let pole = Polynomial::integers(&[100, 1]);
        Ok(RationalFunction::new(Polynomial::integers(&[gain]), &pole * &pole)?.at_frequency(omega)?.norm())
    };
    Ok(vec![
        shown("μ = 100, τ = 2: gain at 0", filter(1, 0.0)?, filter(10_000, 0.0)?),
        shown("μ = 100, τ = 2: gain at 10⁴ rad/s", filter(1, 1e4)?, filter(10_000, 1e4)?),
    ])
}
