//! Numbers as people read them.

/// A number with so many significant digits, zeros at its end left out; a thin space before every third digit from five
/// digits on, powers of ten where there would be many zeros.
pub(crate) fn digits(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return if value.is_nan() { "none" } else { "infinite" }.to_string();
    }
    if value == 0.0 {
        return "0".to_string();
    }
    let digits = digits.max(1);
    let scientific = format!("{:.*e}", digits - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let power: i32 = exponent.parse().unwrap_or(0);
    if !(-4..9).contains(&power) {
        return format!("{} × 10{}", trimmed(mantissa), superscript(power));
    }
    let rounded: f64 = scientific.parse().unwrap_or(value);
    let decimals = (digits as i32 - 1 - power).max(0) as usize;
    grouped(trimmed(&format!("{rounded:.decimals$}")))
}

/// A count.
pub(crate) fn count(value: u64) -> String {
    grouped(&value.to_string())
}

/// A relative number in percent, e.g. "0.32 %".
pub(crate) fn percent(value: f64) -> String {
    format!("{} %", digits(100.0 * value, 2))
}

/// Seconds, in the unit that suits.
pub(crate) fn seconds(value: f64) -> String {
    let figures = |v: f64| if v >= 99.5 { 3 } else { 2 };
    let (value, unit) = match value {
        v if v >= 7200.0 => (v / 3600.0, "h"),
        v if v >= 600.0 => (v / 60.0, "min"),
        v if v < 1e-3 => (v * 1e3, "ms"),
        v => (v, "s"),
    };
    format!("{} {unit}", digits(value, figures(value)))
}

/// A power in raised digits.
pub(crate) fn superscript(power: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        other => {
            char::from_u32('⁴' as u32 + (other as u32).saturating_sub('4' as u32)).unwrap_or(other)
        }
    };
    power.to_string().chars().map(raised).collect()
}

/// "2 runs", "1 run".
pub(crate) fn several(n: usize, what: &str) -> String {
    let ending = if n == 1 { "" } else { "s" };
    format!("{} {what}{ending}", count(n as u64))
}

/// "a", "a and b", "a, b and c".
pub(crate) fn listed(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

fn trimmed(number: &str) -> &str {
    if number.contains('.') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

/// Thin spaces in the part before the point.
fn grouped(number: &str) -> String {
    let (sign, rest) = match number.strip_prefix('-') {
        Some(rest) => ("−", rest),
        None => ("", number),
    };
    let (whole, fraction) = match rest.split_once('.') {
        Some((whole, fraction)) => (whole, format!(".{fraction}")),
        None => (rest, String::new()),
    };
    let mut out = String::from(sign);
    for (i, c) in whole.chars().enumerate() {
        if i > 0 && whole.len() > 4 && (whole.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(c);
    }
    out + &fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_words() {
        assert_eq!(digits(0.8, 2), "0.8");
        assert_eq!(digits(0.0996, 2), "0.1");
        assert_eq!(digits(31.4, 2), "31");
        assert_eq!(digits(31.4, 3), "31.4");
        assert_eq!(digits(12_345.0, 2), "12\u{202f}000");
        assert_eq!(digits(-1234.5, 5), "−1234.5");
        assert_eq!(digits(3.14e-9, 2), "3.1 × 10⁻⁹");
        assert_eq!(digits(6.0e23, 2), "6 × 10²³");
        assert_eq!(digits(f64::NAN, 2), "none");
        assert_eq!(percent(0.01), "1 %");
        assert_eq!(percent(0.000_321), "0.032 %");
        assert_eq!(seconds(0.000_45), "0.45 ms");
        assert_eq!(seconds(0.8), "0.8 s");
        assert_eq!(seconds(123.4), "123 s");
        assert_eq!(seconds(900.0), "15 min");
        assert_eq!(seconds(9000.0), "2.5 h");
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(superscript(-14), "⁻¹⁴");
        assert_eq!(listed(&["a".into(), "b".into(), "c".into()]), "a, b and c");
        assert_eq!(several(1, "run"), "1 run");
    }
}
