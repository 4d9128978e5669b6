//! What is drawn of a vehicle, from the points that are there.

use super::*;

fn point(place: &str, at_m: [f64; 2], re: f64, im: f64) -> ShapePoint {
    ShapePoint { name: "<p>".into(), place: place.into(), at_m, re, im }
}

fn classes(points: &[ShapePoint]) -> Vec<&'static str> {
    let points = drawable(points);
    elements(&points, Frame::of(&points)).iter().map(|e| e.class).collect()
}

fn count(classes: &[&str], class: &str) -> usize {
    classes.iter().filter(|c| **c == class).count()
}

#[test]
fn what_is_drawn_follows_from_the_points_that_are_there() {
    let corners = [[1.0, 0.7], [1.0, -0.7], [-1.5, 0.7], [-1.5, -0.7]];
    let mut car: Vec<_> = corners.map(|c| point("body", c, 1.0, 0.0)).to_vec();
    car.extend(corners.map(|c| point("hub", c, 0.1, 0.2)));
    let all = classes(&car);
    assert_eq!(["plate", "wheel", "spring", "axle", "dot"].map(|c| count(&all, c)), [1, 4, 4, 2, 8]);
    // two wheels in a line: a beam and no plate
    let bike: Vec<_> =
        [0.7, -0.7].iter().flat_map(|x| ["body", "hub"].map(|p| point(p, [*x, 0.0], 1.0, 0.0))).collect();
    let all = classes(&bike);
    assert_eq!(["plate", "beam", "wheel", "spring", "axle"].map(|c| count(&all, c)), [0, 1, 2, 2, 0]);
    // sensors on hubs only
    let all = classes(&car[4..]);
    assert_eq!(["plate", "beam", "wheel", "spring"].map(|c| count(&all, c)), [0, 0, 4, 0]);
    // a quarter car, all at one place
    let all = classes(&[point("body", [0.0; 2], 1.0, 0.0), point("hub", [0.0; 2], 0.5, 0.0)]);
    assert_eq!(["plate", "wheel", "spring"].map(|c| count(&all, c)), [1, 1, 1]);
    assert!(svg(&[], "").is_none() && svg(&[point("body", [f64::NAN, 0.0], 1.0, 0.0)], "").is_none());
}

#[test]
fn the_plate_goes_round_its_corners_and_leaves_out_what_is_inside() {
    let at = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [0.5, 0.0], [0.0, 0.0]];
    let points = at.map(|at_m| point("body", at_m, 1.0, 0.0));
    let points: Vec<&ShapePoint> = points.iter().collect();
    let round: Vec<[f64; 2]> = hull(&points).iter().map(|p| p.at_m).collect();
    assert_eq!(round, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let line: Vec<ShapePoint> = [0.0, 1.0, 2.0].map(|x| point("body", [x, 0.0], 1.0, 0.0)).to_vec();
    assert_eq!(hull(&line.iter().collect::<Vec<_>>()).len(), 2);
    assert_eq!(count(&classes(&line), "beam"), 1);
}

#[test]
fn a_spring_moves_at_each_end_with_what_it_is_fixed_to() {
    let points = [point("hub", [0.0; 2], 0.2, 0.4), point("body", [0.0; 2], 1.0, 0.0)];
    let points: Vec<&ShapePoint> = points.iter().collect();
    let spring = spring(points[0], &points, "body", Frame::of(&points)).unwrap().vertices;
    assert_eq!((spring[0].moves, spring[ZIGZAG].moves), ([0.2, 0.4], [1.0, 0.0]));
    assert!(spring[0].at[1] < spring[ZIGZAG].at[1], "the hub is below the body");
}

#[test]
fn everything_stays_in_the_picture_and_up_is_up() {
    let points = [point("body", [0.0; 2], 1.0, 0.0), point("hub", [0.0; 2], 0.0, 1.0)];
    let points: Vec<&ShapePoint> = points.iter().collect();
    for e in fitted(elements(&points, Frame::of(&points)), Frame::of(&points)) {
        for v in &e.vertices {
            let size = v.moves[0].hypot(v.moves[1]);
            assert!(v.at[0] >= 0.0 && v.at[0] <= SIZE[0], "{e:?}");
            assert!(v.at[1] - size >= 0.0 && v.at[1] + size <= SIZE[1], "{e:?}");
        }
    }
    let html = svg(&[point("hub", [0.0; 2], 1.0, 0.0)], "a\"b").unwrap();
    let circle = html.as_str().split("<circle ").find(|c| c.contains("\"wheel\"")).unwrap();
    let number = |name: &str| -> f64 {
        circle.split_once(&format!("{name}=\"")).unwrap().1.split(['"', ' ']).next().unwrap().parse().unwrap()
    };
    let data: Vec<f64> = circle
        .split_once("data-v=\"")
        .unwrap()
        .1
        .split('"')
        .next()
        .unwrap()
        .split(' ')
        .map(|v| v.parse().unwrap())
        .collect();
    assert!((number("cy") - (data[1] - data[2])).abs() < 0.11 && data[2] > 0.0 && data[3] == 0.0);
}

#[test]
fn wheels_of_a_tandem_axle_do_not_overlap() {
    let wheels = [0.0, 1.3, 6.0].map(|x| point("hub", [x, 0.0], 1.0, 0.0));
    let frame = Frame::of(&wheels.iter().collect::<Vec<_>>());
    assert!(2.0 * frame.wheel < 1.3 && frame.size == 6.0, "{frame:?}");
    // a single wheel has its usual size
    assert_eq!(Frame::of(&wheels[..1].iter().collect::<Vec<_>>()).wheel, WHEEL);
}
