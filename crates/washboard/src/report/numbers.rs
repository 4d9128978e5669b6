//! Numbers as people write them: rounded to their uncertainty.

/// A factor of the standard deviation: a 95 % interval of a normal distribution.
pub(super) const FACTOR_95: f64 = 1.96;
/// Values from here up to [`LARGE`] are written without a power of ten.
const SMALL: f64 = 1e-3;
const LARGE: f64 = 1e6;

/// `value ± sd` to the last digit that the standard deviation leaves, or the value alone where that is unknown or zero.
pub(super) fn with_sd(value: f64, sd: Option<f64>) -> String {
    match usable(sd) {
        Some(sd) if written_plainly(value.abs().max(sd)) => plain_with_sd(value, sd),
        Some(sd) => with_sd_in(value, sd, exponent_of(value.abs().max(sd))),
        None => significant(value, 4),
    }
}

/// `(value ± sd)·10ⁿ`.
pub(super) fn with_sd_in(value: f64, sd: f64, exponent: i32) -> String {
    let scale = 10f64.powi(-exponent);
    match usable(Some(sd)) {
        Some(sd) => format!("({})·{}", plain_with_sd(value * scale, sd * scale), power_of_ten(exponent)),
        None => format!("{}·{}", significant(value * scale, 4), power_of_ten(exponent)),
    }
}

/// A value to the digit that a standard deviation leaves: what stands beside [`with_sd`].
pub(super) fn to_digit_of(value: f64, sd: Option<f64>) -> String {
    match usable(sd) {
        Some(sd) if written_plainly(value.abs().max(sd)) => fixed(value, decimals_for(sd)),
        _ => significant(value, 4),
    }
}

/// The 95 % interval, `low to high`; nothing where the standard deviation is unknown.
pub(super) fn interval(value: f64, sd: Option<f64>) -> Option<String> {
    let sd = usable(sd)?;
    let decimals = decimals_for(sd);
    let end = |sign: f64| fixed(value + sign * FACTOR_95 * sd, decimals);
    Some(format!("{} to {}", end(-1.0), end(1.0)))
}

/// So many significant digits, with a power of ten where the number is small or large.
pub(super) fn significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = exponent_of(value.abs());
    if written_plainly(value.abs()) {
        fixed(value, digits - 1 - exponent)
    } else {
        format!("{}·{}", fixed(value / 10f64.powi(exponent), digits - 1), power_of_ten(exponent))
    }
}

/// A setting as people write it: up to four significant digits, no zeros at the end.
pub(super) fn plain(value: f64) -> String {
    let text = significant(value, 4);
    if text.contains('.') && !text.contains('·') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// So many decimals; negative ones round to tens, hundreds …
pub(super) fn fixed(value: f64, decimals: i32) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = if decimals >= 0 {
        format!("{value:.*}", usize::try_from(decimals.min(12)).unwrap_or(0))
    } else {
        let unit = 10f64.powi(-decimals);
        format!("{:.0}", (value / unit).round() * unit)
    };
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    match text.strip_prefix('-') {
        Some(size) if is_zero => size.to_owned(),
        Some(size) => format!("−{size}"),
        None => text,
    }
}

/// The same with its sign always.
pub(super) fn signed(value: f64, decimals: i32) -> String {
    let text = fixed(value, decimals);
    let is_zero = text.chars().all(|c| matches!(c, '0' | '.'));
    if value > 0.0 && !is_zero { format!("+{text}") } else { text }
}

/// 10⁻⁶ …
pub(super) fn power_of_ten(exponent: i32) -> String {
    let raised: String = exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            // ⁰ and ⁴ to ⁹ stand in a row
            c => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
        })
        .collect();
    format!("10{raised}")
}

/// How many decimals a standard deviation leaves: two digits of it where it starts with a one, else one digit.
fn decimals_for(sd: f64) -> i32 {
    let exponent = exponent_of(sd);
    if sd / 10f64.powi(exponent) < 1.95 { 1 - exponent } else { -exponent }
}

fn plain_with_sd(value: f64, sd: f64) -> String {
    let decimals = decimals_for(sd);
    format!("{} ± {}", fixed(value, decimals), fixed(sd, decimals))
}

fn usable(sd: Option<f64>) -> Option<f64> {
    sd.filter(|s| s.is_finite() && *s > 0.0)
}

fn written_plainly(size: f64) -> bool {
    (SMALL..LARGE).contains(&size)
}

fn exponent_of(size: f64) -> i32 {
    if size > 0.0 && size.is_finite() { size.log10().floor() as i32 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_rounded_to_its_uncertainty() {
        assert_eq!(with_sd(8.04421, Some(0.0123)), "8.044 ± 0.012");
        assert_eq!(with_sd(8.04421, Some(0.04)), "8.04 ± 0.04");
        assert_eq!(with_sd(15743.2, Some(38.0)), "15740 ± 40");
        assert_eq!(with_sd(-0.5, Some(0.2)), "−0.5 ± 0.2");
        assert_eq!(with_sd(3.2e-7, Some(1.1e-8)), "(3.20 ± 0.11)·10⁻⁷");
        assert_eq!(with_sd_in(14.91e-6, 0.2e-6, -6), "(14.9 ± 0.2)·10⁻⁶");
        assert_eq!(with_sd(1.06384, None), "1.064");
        assert_eq!(with_sd(1.06384, Some(0.0)), "1.064");
        assert_eq!(with_sd(1.0, Some(f64::NAN)), "1.000");
    }

    #[test]
    fn an_interval_is_twice_nearly_the_deviation() {
        assert_eq!(interval(8.044, Some(0.012)).as_deref(), Some("8.020 to 8.068"));
        assert_eq!(interval(8.044, None), None);
    }

    #[test]
    fn small_large_and_no_numbers() {
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(f64::NAN, 3), "–");
        assert_eq!(significant(4.567e-9, 3), "4.57·10⁻⁹");
        assert_eq!(significant(-1.5e12, 2), "−1.5·10¹²");
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!([plain(200.0), plain(0.4), plain(5.12)], ["200", "0.4", "5.12"]);
        assert_eq!(signed(0.25, 1), "+0.2");
        assert_eq!(power_of_ten(-106), "10⁻¹⁰⁶");
        assert_eq!(power_of_ten(45789), "10⁴⁵⁷⁸⁹");
    }
}
