//! Chapter 3: example 3.3, every printed decimal, and how many nodes an order takes (§3.1.3).

use super::ReproduceError;
use super::context::Context;
use super::item::Sheet;
use crate::linalg::{C64, CMat, Mat};
use crate::lti::{Discrete, StateSpace};
use crate::subspace::{
    Domain, InterpolationData, Node, Point, PrintedForm, Realisation, SubspaceError, interpolate,
    printed_steps,
};
use std::f64::consts::PI;

/// q of the example.
pub(super) const BLOCK_ROWS: usize = 5;
/// Rounding of a recovered function: the thesis's own maximum error is 6e-14.
const RECOVERED: (f64, &str) = (1e-11, "equal but for rounding");
/// A model that a node too few gives is off by far more.
const SAME_FUNCTION: f64 = 1e-6;

/// Conjugate nodes and data of the example: the values at z₁ and z₃.
const W10: [[(&str, &str); 3]; 2] = [
    [("1.9333", "-0.5333"), ("-0.8667", "0.4000"), ("0", "0")],
    [("0.8878", "-0.5236"), ("1.9545", "-0.6569"), ("1.4878", "-0.3902")],
];
const W3: [[[&str; 3]; 2]; 5] = [
    [["1.7692", "-1.2051", "0"], ["0.7521", "1.8291", "1.4444"]],
    [["-0.2840", "0.2433", "0"], ["-0.2804", "-0.3395", "-0.1975"]],
    [["0.2003", "-0.4251", "0"], ["0.2084", "0.2757", "0.1756"]],
    [["-0.2000", "0.9844", "0"], ["-0.2333", "-0.3341", "-0.2341"]],
    [["0.2456", "-2.8518", "0"], ["0.3531", "0.5390", "0.4162"]],
];
const SINGULAR_VALUES: [&str; 4] = ["0.5460", "0.0609", "0.0249", "0.0098"];
/// The lower triangle of R₂₂ that is not zero.
const R22: [&[&str]; 10] = [
    &["-0.4622"],
    &["0.0381", "-0.0518"],
    &["-0.2544", "0.0203", "-0.0240"],
    &["-0.0176", "0.0194", "-0.0075", "-0.0009"],
    &["-0.1144", "-0.0070", "0.0091", "-0.0089"],
    &["0.0094", "-0.0110", "0.0094", "-0.0025"],
    &["-0.0583", "0.0035", "-0.0045", "0.0045"],
    &["-0.0033", "0.0057", "-0.0061", "0.0037"],
    &["-0.0344", "0.0033", "-0.0037", "-0.0022"],
    &["-0.0007", "-0.0013", "0.0015", "-0.0027"],
];
const A_HAT: [&[&str]; 4] = [
    &["0.5204", "-0.1361", "0.3199", "0.5352"],
    &["0.0882", "-0.4983", "0.4848", "-0.1035"],
    &["0.0052", "0.0820", "-0.4810", "0.7195"],
    &["-0.0295", "0.1919", "-0.3546", "-0.2911"],
];
const B_HAT: [&[&str]; 4] = [
    &["1.0502", "-0.5390", "-0.0816"],
    &["2.8626", "1.8321", "0.9041"],
    &["-0.1545", "1.0984", "0.4896"],
    &["-1.4555", "-0.9375", "0.0547"],
];
const C_HAT: [&[&str]; 2] =
    [&["0.8460", "0.2123", "-0.2149", "-0.3233"], &["-0.0721", "0.8069", "0.5289", "0.1046"]];
const D_HAT: [&[&str]; 2] = [&["1.0000", "-1.0000", "-0.0000"], &["-0.0000", "1.0000", "1.0000"]];

/// The system that is to be found.
pub(super) fn system() -> Result<StateSpace<Discrete>, ReproduceError> {
    let a = [[-0.5, 0.5, 0.0, 0.0], [-0.5, -0.5, 0.0, 0.0], [0.0, 0.0, 0.5, 0.0], [0.0, 0.0, 0.0, -0.25]];
    let b = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 1.0, 1.0]];
    let c = [[1.0, 1.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0]];
    let d = [[1.0, -1.0, 0.0], [0.0, 1.0, 1.0]];
    Ok(StateSpace::discrete(
        Mat::from_fn(4, 4, |i, j| a[i][j]),
        Mat::from_fn(4, 3, |i, j| b[i][j]),
        Mat::from_fn(2, 4, |i, j| c[i][j]),
        Mat::from_fn(2, 3, |i, j| d[i][j]),
        1.0,
    )?)
}

/// G(z) as it is printed.
fn printed_function(z: C64) -> CMat {
    let p = |c: &[f64]| c.iter().fold(C64::new(0.0, 0.0), |v, c| v * z + c);
    let g = [
        [
            p(&[1.0, 3.0, 1.5]) / p(&[1.0, 1.0, 0.5]),
            -p(&[1.0, 0.5, 0.5, 0.75]) / p(&[1.0, 0.5, 0.0, -0.25]),
            C64::new(0.0, 0.0),
        ],
        [
            p(&[2.0, 1.25, 0.5]) / p(&[1.0, 1.25, 0.75, 0.125]),
            p(&[1.0, 3.25, 2.5, 0.75]) / p(&[1.0, 1.25, 0.75, 0.125]),
            p(&[1.0, 1.25]) / p(&[1.0, 0.25]),
        ],
    ];
    CMat::from_fn(2, 3, |i, j| g[i][j])
}

/// Nodes, their number of derivatives, and the data of the example by the resolvent of A, B, C, D.
pub(super) fn data() -> Result<InterpolationData, ReproduceError> {
    let g = Realisation::Discrete(system()?);
    let nodes = [(C64::new(1.0, 1.0), 1), (C64::new(1.0, -1.0), 1), (C64::new(2.0, 0.0), 5)];
    let node = |(z, count): (C64, usize)| Ok(Node::full(z, g.derivatives(Point::Finite(z), count)?));
    let nodes = nodes.into_iter().map(node).collect::<Result<Vec<_>, SubspaceError>>()?;
    Ok(InterpolationData::new(Domain::Disk, nodes)?)
}

/// Real columns of the data matrices, mN of (3.43): each node by itself, twice where it is complex.
pub(super) fn columns(nodes: &[Node], inputs: usize) -> usize {
    let complex = |n: &Node| matches!(n.z, Point::Finite(z) if z.im != 0.0);
    nodes.iter().map(|n| inputs * n.values.len() * if complex(n) { 2 } else { 1 }).sum()
}

/// Example 3.3.
pub(super) fn example(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let (system, data) = (system()?, data()?);
    let apart = [C64::new(1.0, 1.0), C64::new(2.0, 0.0), C64::new(-0.3, 1.2)]
        .into_iter()
        .map(|z| Ok((printed_function(z) - system.at(z)?).norm_l2()))
        .collect::<Result<Vec<f64>, ReproduceError>>()?;
    let worst = apart.into_iter().fold(0.0, f64::max);
    sheet.within("G(z) as printed less D + C(zI − A)⁻¹B, largest at three z", "0", worst, RECOVERED);
    values(&data, sheet);
    steps(&data, sheet)?;
    let found = interpolate(&data, None)?;
    sheet.count("order found by the rank", 4, found.order);
    sheet.within("largest error of the data by the model", "5.9746e-14", found.max_error, RECOVERED);
    let (p, m, n) = (data.outputs, data.inputs, found.order);
    let all = columns(&data.nodes, m);
    sheet.count("N of (3.43), the conjugate node counted", 9, all / m).noted("as printed: see erratum E3.1");
    sheet.count("rows of Ĥ, pq", 10, p * BLOCK_ROWS);
    sheet.count("columns of Ĥ and F, mN", 27, all);
    sheet.count("rows of F, mq", 15, m * BLOCK_ROWS);
    sheet.count("columns of R₂₂, m(N − q)", 12, all - m * BLOCK_ROWS);
    sheet.count("rows of Ĝ, pN", 18, p * all / m);
    sheet.count("columns of Ŷ, n + p", 6, n + p);
    Ok(())
}

/// The interpolation data.
fn values(data: &InterpolationData, sheet: &mut Sheet) {
    for (i, row) in W10.iter().enumerate() {
        for (j, (re, im)) in row.iter().enumerate().filter(|(_, w)| w.0 != "0") {
            let found = data.nodes[0].values[0][(i, j)];
            sheet.printed(format!("Re w₁₀[{},{}]", i + 1, j + 1), re, found.re);
            sheet.printed(format!("Im w₁₀[{},{}]", i + 1, j + 1), im, found.im);
        }
    }
    for (l, w) in W3.iter().enumerate() {
        for (i, row) in w.iter().enumerate() {
            for (j, digits) in row.iter().enumerate().filter(|(_, d)| **d != "0") {
                let found = data.nodes[2].values[l][(i, j)].re;
                sheet.printed(format!("w₃{l}[{},{}]", i + 1, j + 1), digits, found);
            }
        }
    }
}

/// R₂₂, its singular values, and the realisation, with the signs of singular vectors as printed.
fn steps(data: &InterpolationData, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let found = printed_steps(data, BLOCK_ROWS, 4, PrintedForm::AsPrinted)?;
    for (k, digits) in SINGULAR_VALUES.iter().enumerate() {
        sheet.printed(format!("singular value {}", k + 1), digits, found.singular_values[k]);
    }
    // signs of columns of a triangular factor and of singular vectors are free
    let of_column = |j: usize| -found.r22[(j, j)].signum();
    entries("R₂₂", &R22, &|i, j| of_column(j) * found.r22[(i, j)], sheet);
    let g = &found.system;
    let as_printed = |j: usize| if C_HAT[0][j].starts_with('-') { -1.0 } else { 1.0 };
    let sign: Vec<f64> = (0..4).map(|j| as_printed(j) * g.c()[(0, j)].signum()).collect();
    entries("Â", &A_HAT, &|i, j| sign[i] * g.a()[(i, j)] * sign[j], sheet);
    entries("Ĉ", &C_HAT, &|i, j| g.c()[(i, j)] * sign[j], sheet);
    entries("B̂", &B_HAT, &|i, j| sign[i] * g.b()[(i, j)], sheet);
    entries("D̂", &D_HAT, &|i, j| g.d()[(i, j)], sheet);
    Ok(())
}

fn entries(name: &str, printed: &[&[&str]], found: &dyn Fn(usize, usize) -> f64, sheet: &mut Sheet) {
    for (i, row) in printed.iter().enumerate() {
        for (j, digits) in row.iter().enumerate() {
            sheet.printed(format!("{name}[{},{}]", i + 1, j + 1), digits, found(i, j));
        }
    }
}

/// §3.1.3: the least numbers of nodes that give a scalar system of order 4 back.
pub(super) fn node_counts(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let simple = |count: usize| {
        (0..count).map(|k| C64::from_polar(1.1, PI * (k as f64 + 0.5) / count as f64)).collect()
    };
    let with_zero =
        |count: usize| (0..count).map(|k| C64::from_polar(1.0, PI * k as f64 / count as f64)).collect();
    let with_both = |count: usize| {
        let step = PI / (count.max(2) - 1) as f64;
        (0..count)
            .map(|k| if k + 1 == count { C64::new(-1.0, 0.0) } else { C64::from_polar(1.0, step * k as f64) })
            .collect()
    };
    type Nodes<'a> = &'a dyn Fn(usize) -> Vec<C64>;
    let ways: [(&str, usize, Nodes<'_>); 3] = [
        ("simple complex nodes, n + 1", 5, &simple),
        ("frequencies on the circle, 0 among them, n + 1", 5, &with_zero),
        ("frequencies on the circle, 0 and π among them, n + 2", 6, &with_both),
    ];
    for (what, printed, nodes) in ways {
        let mut least = 0;
        for count in 1..=9 {
            if comes_back(&nodes(count))? {
                least = count;
                break;
            }
        }
        sheet.count(format!("n = 4: {what}"), printed, least);
    }
    Ok(())
}

/// Whether values at these nodes give the first input's second output of the example back, of order 4.
fn comes_back(nodes: &[C64]) -> Result<bool, ReproduceError> {
    let g = Realisation::Discrete(scalar()?);
    let node = |z: &C64| Ok(Node::full(*z, g.derivatives(Point::Finite(*z), 1)?));
    let nodes = nodes.iter().map(node).collect::<Result<Vec<_>, SubspaceError>>()?;
    let Ok(found) = InterpolationData::new(Domain::Disk, nodes).and_then(|d| interpolate(&d, None)) else {
        return Ok(false);
    };
    let elsewhere = Point::Finite(C64::new(0.3, 1.4));
    let off = &found.system.derivatives(elsewhere, 1)?[0] - &g.derivatives(elsewhere, 1)?[0];
    Ok(found.order == 4 && off.norm_l2() < SAME_FUNCTION)
}

/// A scalar system of order 4: A of the example, all of it reached and seen.
fn scalar() -> Result<StateSpace<Discrete>, ReproduceError> {
    let a = system()?.a().clone();
    let one = |rows: usize, columns: usize| Mat::from_fn(rows, columns, |_, _| 1.0);
    Ok(StateSpace::discrete(a, one(4, 1), one(1, 4), one(1, 1), 1.0)?)
}
