//! Readers of arguments that clap does not know.

use washboard::study::{Shard, Stretch};

/// `A,B`.
pub fn pair(text: &str) -> Result<[f64; 2], String> {
    let wrong = || format!("expected two numbers such as 0.5,25, found {text:?}");
    let (a, b) = text.split_once(',').ok_or_else(wrong)?;
    let number = |s: &str| s.trim().parse::<f64>().map_err(|_| wrong());
    Ok([number(a)?, number(b)?])
}

/// A word that serde knows as a value of `T`; its names come from serde's own message.
pub fn word<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_value(serde_json::Value::String(text.to_owned())).map_err(|e| e.to_string())
}

/// A whole number.
pub fn count(text: &str) -> Result<usize, String> {
    text.trim().parse().map_err(|_| "expected a whole number above 0".to_owned())
}

/// `NAME=VALUE` of a positive number.
pub fn assignment(text: &str) -> Result<(String, f64), String> {
    let wrong =
        || format!("expected a name and a positive number such as sprung_mass_kg=1150, found {text:?}");
    let (name, value) = text.split_once('=').ok_or_else(wrong)?;
    let value = value.trim().parse::<f64>().map_err(|_| wrong())?;
    if value.is_finite() && value > 0.0 && !name.trim().is_empty() {
        Ok((name.trim().to_owned(), value))
    } else {
        Err(wrong())
    }
}

/// `V:T`, a stretch at V m/s for T s.
pub fn stretch(text: &str) -> Result<Stretch, String> {
    let wrong = || format!("expected a speed in m/s and a time in s such as 10:300, found {text:?}");
    let (speed, duration) = text.split_once(':').ok_or_else(wrong)?;
    let number = |s: &str| s.trim().parse::<f64>().map_err(|_| wrong());
    Ok(Stretch { speed_m_s: number(speed)?, duration_s: number(duration)? })
}

/// `I/N`, part I of N, from 1.
pub fn shard(text: &str) -> Result<Shard, String> {
    let wrong = || format!("expected a part such as 2/3, from 1/N to N/N, found {text:?}");
    let (number, of) = text.split_once('/').ok_or_else(wrong)?;
    let whole = |s: &str| s.trim().parse::<usize>().map_err(|_| wrong());
    let (number, of) = (whole(number)?, whole(of)?);
    if (1..=of).contains(&number) { Ok(Shard { number, of }) } else { Err(wrong()) }
}
