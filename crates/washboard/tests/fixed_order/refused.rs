//! What is refused.

use super::quarter::quarter;
use super::structure::square;
use super::*;

#[test]
fn wrong_calls_are_typed_errors() {
    let plant = square(5);
    let good = || target(0, Measure::Hinf(all_outputs(&plant)), Aim::Goal(1.0));
    let ask = || asked(vec![plant.clone()], vec![good()], Structure::full(1, 2, 2));
    let refused = |of: &FixedOrder| match fixed_order(of, &few(1)) {
        Err(SynthesisError::Lti(e)) => e,
        other => panic!("not refused: {other:?}"),
    };
    let joins = |of: FixedOrder, which: &str| match refused(&of) {
        LtiError::Join { what, .. } => assert_eq!(what, which),
        other => panic!("{which}: {other:?}"),
    };
    joins(FixedOrder { plants: Vec::new(), ..ask() }, "a fixed-order design");
    joins(FixedOrder { targets: Vec::new(), ..ask() }, "a fixed-order design");
    joins(FixedOrder { structure: Structure::full(1, 1, 2), ..ask() }, "a controller's structure");
    joins(FixedOrder { plants: vec![plant.clone(), quarter(98.0)], ..ask() }, "a controller's structure");
    let fewer = plant.select(&["z1"], &["y1", "y2"]).unwrap();
    joins(FixedOrder { plants: vec![plant.clone(), fewer], ..ask() }, "plants of one design");
    joins(FixedOrder { targets: vec![Target { plant: 1, ..good() }], ..ask() }, "a target's plant");
    let of_channel = |outputs: Vec<(usize, f64)>, disturbances: Vec<usize>| {
        let measure = Measure::Hinf(Channel { outputs, disturbances });
        FixedOrder { targets: vec![Target { measure, ..good() }], ..ask() }
    };
    joins(of_channel(vec![], vec![]), "a target's outputs");
    joins(of_channel(vec![(0, 0.0)], vec![]), "a target's outputs");
    joins(of_channel(vec![(4, 1.0)], vec![]), "a target's output");
    joins(of_channel(vec![(0, 1.0)], vec![2]), "a target's disturbance");

    let fields = |of: FixedOrder, which: &str, value: f64| match refused(&of) {
        LtiError::Field { field, found, .. } => {
            assert_eq!((field, found.to_bits()), (which, value.to_bits()));
        }
        other => panic!("{which}: {other:?}"),
    };
    fields(of_channel(vec![(0, 1.0), (1, -1.0)], vec![]), "a target's weight", -1.0);
    for number in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        for aim in [Aim::Goal(number), Aim::Bound(number)] {
            let targets = vec![Target { aim, ..good() }];
            fields(FixedOrder { targets, ..ask() }, "a target's unit or bound", number);
        }
        fields(FixedOrder { max_pole_rad_s: Some(number), ..ask() }, "max_pole", number);
        fields(FixedOrder { max_gain: Some(number), ..ask() }, "max_gain", number);
    }
    for number in [-1.0, f64::INFINITY, f64::NAN] {
        fields(FixedOrder { margin_rad_s: number, ..ask() }, "margin", number);
    }
    // an abscissa's bound may be negative, its unit may not
    let abscissa = |aim: Aim| FixedOrder { targets: vec![target(0, Measure::Abscissa, aim)], ..ask() };
    fields(abscissa(Aim::Goal(-1.0)), "a target's unit or bound", -1.0);
    assert!(fixed_order(&abscissa(Aim::Bound(-0.01)), &few(1)).is_ok());
}

#[test]
fn structures_that_are_none_are_typed_errors() {
    let join = |r: Result<Structure, LtiError>, which: &str| match r {
        Err(LtiError::Join { what, .. }) => assert_eq!(what, which),
        other => panic!("{which}: {other:?}"),
    };
    join(Structure::of_entries(1, 1, 1, vec![Entry::Free; 3]), "a controller's structure");
    let part =
        |controls: &[usize], y: usize| Local { order: 1, measurements: vec![y], controls: controls.to_vec() };
    for parts in [vec![part(&[0], 0)], vec![part(&[0, 1], 0), part(&[1], 1)], vec![part(&[0, 1, 2], 0)]] {
        join(Structure::decentralised(2, 2, &parts), "a decentralised structure");
    }
    join(Structure::decentralised(2, 2, &[part(&[0, 1], 2)]), "a decentralised structure");
    let field = |r: Result<Structure, LtiError>, value: f64| match r {
        Err(LtiError::Field { found, .. }) => assert_eq!(found.to_bits(), value.to_bits()),
        other => panic!("{other:?}"),
    };
    field(Structure::of_entries(0, 1, 1, vec![Entry::Fixed(f64::NAN)]), f64::NAN);
    for filter in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        field(Structure::pid(filter), filter);
    }
}
