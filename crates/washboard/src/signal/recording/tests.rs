//! What a recording keeps and refuses.

use super::super::{Direction, Place, Quantity};
use super::*;

fn channel(name: &str, direction: Direction) -> Channel {
    let (quantity, place) = (Quantity::Acceleration, Place::Body);
    Channel { name: name.to_owned(), quantity, direction, place, wheel: None, at_m: None }
}

fn two(samples: Vec<Vec<f64>>) -> Result<Recording, SignalError> {
    let channels = vec![channel("a", Direction::PlusZ), channel("b", Direction::MinusZ)];
    Recording::new(100.0, Some(20.0), vec![], channels, samples)
}

#[test]
fn a_downward_channel_is_stored_upward() {
    let r = two(vec![vec![1.0, 2.0], vec![1.0, 2.0]]).unwrap();
    assert_eq!(r.samples()[0], [1.0, 2.0]);
    assert_eq!(r.samples()[1], [-1.0, -2.0]);
    assert_eq!(r.channels()[1].direction, Direction::PlusZ);
    assert_eq!(r.select(&["b"]).unwrap().samples()[0], [-1.0, -2.0]);
    assert!((r.duration_s() - 0.02).abs() < 1e-15);
}

#[test]
fn what_breaks_the_rules_cannot_be_built() {
    let message = |r: Result<Recording, SignalError>| r.unwrap_err().to_string();
    assert!(message(two(vec![vec![1.0, 2.0], vec![1.0]])).contains("`b`: expected 2, found 1"));
    assert!(message(two(vec![vec![1.0], vec![f64::NAN]])).contains("`b`: sample 0 is NaN"));
    assert!(message(two(vec![vec![1.0]])).contains("expected 2, found 1"));
    assert!(message(two(vec![vec![], vec![]])).contains("at least 1"));
    let one = || vec![channel("a", Direction::PlusZ)];
    assert!(Recording::new(0.0, None, vec![], one(), vec![vec![1.0]]).is_err());
    assert!(Recording::new(f64::NAN, None, vec![], one(), vec![vec![1.0]]).is_err());
    assert!(Recording::new(1.0, Some(-1.0), vec![], one(), vec![vec![1.0]]).is_err());
    assert!(Recording::new(1.0, None, vec![], vec![], vec![]).is_err());
    let twice = vec![channel("a", Direction::PlusZ), channel("a", Direction::PlusZ)];
    assert!(Recording::new(1.0, None, vec![], twice, vec![vec![1.0]; 2]).is_err());
    let mut at_wheel = one();
    at_wheel[0].wheel = Some(0);
    assert!(Recording::new(1.0, None, vec![], at_wheel, vec![vec![1.0]]).is_err());
}

#[test]
fn selection_suggests_and_cuts_where_asked() {
    let r = two(vec![(0..100).map(f64::from).collect(), vec![0.5; 100]]).unwrap();
    assert!(matches!(r.select(&["a", "a"]), Err(SignalError::DuplicateChannel { .. })));
    assert!(r.select(&["bb"]).is_err() && r.select_where(|_| false).is_err());
    let part = r.between(0.1, 0.3).unwrap();
    assert_eq!((part.len(), part.samples()[0][0]), (20, 10.0));
    assert!(r.between(2.0, 3.0).is_err());
}

#[test]
fn the_speed_stays_with_its_samples() {
    // channel a counts samples, and the speed is a tenth of it: they can only part together
    let count: Vec<f64> = (0..2000).map(f64::from).collect();
    let r = two(vec![count.clone(), vec![0.5; 2000]]).unwrap();
    assert!(r.clone().with_speed_series(vec![1.0; 1999]).is_err());
    assert!(r.clone().with_speed_series(vec![f64::INFINITY; 2000]).is_err());
    let r = r.with_speed_series(count.iter().map(|k| k / 10.0).collect()).unwrap();
    assert_eq!((r.speed_m_s(), r.speed_spread_m_s()), (Some(20.0), None), "as declared");
    let together = |r: &Recording| {
        let speed = r.speed_series().unwrap();
        assert_eq!(speed.len(), r.len());
        // a decimating filter passes a straight line as it is
        assert!(r.samples()[0].iter().zip(speed).all(|(k, v)| (k / 10.0 - v).abs() < 1e-9));
    };
    for changed in [
        r.between(1.0, 2.0).unwrap(),
        r.part(3..1700).unwrap(),
        r.decimated(4).unwrap(),
        r.select(&["a"]).unwrap(),
        r.select_where(|c| c.name == "a").unwrap(),
    ] {
        together(&changed);
    }
    assert_eq!(r.detrended().speed_series(), r.speed_series());
    // samples 100 to 199: 10 to 19.9 m/s
    let part = r.between(1.0, 2.0).unwrap();
    assert!((part.speed_m_s().unwrap() - 14.95).abs() < 1e-12);
    assert!((part.speed_spread_m_s().unwrap() - 0.1 * (9999.0_f64 / 12.0).sqrt()).abs() < 1e-12);
    assert!(r.part(5..5).is_err() && r.part(5..2001).is_err());
}

#[test]
fn detrending_leaves_nothing_of_a_line_and_all_of_what_is_orthogonal_to_one() {
    let line: Vec<f64> = (0..101).map(|k| 3.0 - 0.2 * f64::from(k)).collect();
    let hump: Vec<f64> = (0..101).map(|k| (f64::from(k) - 50.0).powi(2)).collect();
    let mean = hump.iter().sum::<f64>() / 101.0;
    let sum: Vec<f64> = line.iter().zip(&hump).map(|(a, b)| a + b).collect();
    let r = two(vec![line, sum]).unwrap().detrended();
    assert!(r.samples()[0].iter().all(|x| x.abs() < 1e-12));
    assert!(r.samples()[1].iter().zip(&hump).all(|(x, h)| (x + h - mean).abs() < 1e-9));
}
