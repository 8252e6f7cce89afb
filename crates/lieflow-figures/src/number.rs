//! Numbers formatted for people.

/// `x` rounded to `digits` significant digits: `0.0123`, `4560`, `1.23×10⁻⁸`, `−2.50`.
///
/// Magnitudes below 10⁻³ or from 10⁶ on are written with a power of ten. Infinities become `∞`,
/// an undefined value becomes `n/a`.
pub fn sig(x: f64, digits: usize) -> String {
    if x.is_nan() {
        return "n/a".to_string();
    }
    let sign = if x < 0.0 { "−" } else { "" };
    if x.is_infinite() {
        return format!("{sign}∞");
    }
    if x == 0.0 {
        return "0".to_string();
    }
    let (mantissa, exponent) = decimal_parts(x.abs(), digits.max(1));
    if (-3..6).contains(&exponent) {
        format!("{sign}{}", plain(&mantissa, exponent))
    } else {
        format!("{sign}{mantissa}×{}", power_of_ten(exponent))
    }
}

/// `x` to at most `digits` significant digits, without zeros at the end: `0.5`, `240`, `1.2×10⁻⁸`.
pub fn short(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return sig(x, digits);
    }
    let text = typed(x, digits).replacen('-', if x < 0.0 { "−" } else { "-" }, 1);
    match text.split_once('e') {
        Some((mantissa, exponent)) => {
            format!("{mantissa}×{}", power_of_ten(exponent.parse().unwrap_or(0)))
        }
        None => text,
    }
}

/// The number of [`short`] as a reader can type it: `0.5`, `240`, `1.2e-8`, `-2.5`.
pub fn typed(x: f64, digits: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", digits.max(1) - 1).parse().unwrap_or(x);
    let plain = rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) || !x.is_finite();
    if plain { format!("{}", rounded + 0.0) } else { format!("{rounded:e}") }
}

/// A number as people write it, with six digits at most: `0.05`, `77.6073`, `1.2e-6`.
pub fn number(x: f64) -> String {
    typed(x, 6)
}

/// A time of a run between these times, with six digits of their distance: `40`, `1700000012.5`.
pub fn time(t: f64, span: [f64; 2]) -> String {
    time_or(t, span, number)
}

/// As [`time`], in another format where the distance is not small beside the times.
pub fn time_or(t: f64, [start, end]: [f64; 2], usual: impl Fn(f64) -> String) -> String {
    let lost = (start.abs().max(end.abs()) / (end - start).abs()).log10().floor();
    if lost.is_nan() || lost < 1.0 {
        return usual(t);
    }
    let digits = 6 + lost.min(11.0) as usize;
    match (1e-3..1e15).contains(&t.abs()) {
        true => format!("{t:.*e}", digits - 1).parse().unwrap_or(t).to_string(),
        false => typed(t, digits),
    }
}

/// A number rounded to two digits, or to a whole number below a million: `144`, `2.7`, `0.0021`, `1.2e-6`.
pub fn rough(x: f64) -> String {
    if (100.0..1e6).contains(&x.abs()) { format!("{x:.0}") } else { typed(x, 2) }
}

/// A duration as people say it: `20 ms`, `1.5 s`, `12 minutes`, `5 years`.
pub fn duration(seconds: f64) -> String {
    const LONG: [(f64, &str); 4] =
        [(365.25 * 86400.0, "years"), (86400.0, "days"), (3600.0, "hours"), (60.0, "minutes")];
    const SHORT: [(f64, &str); 3] = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs")];
    if let Some((unit, name)) = LONG.iter().find(|(unit, _)| seconds >= 2.0 * unit) {
        return format!("{} {name}", rough((seconds / unit).round()));
    }
    let (unit, name) = SHORT.iter().find(|(unit, _)| seconds >= *unit).unwrap_or(&SHORT[2]);
    format!("{} {name}", rough(seconds / unit))
}

/// A number of bytes as people say it: `300 bytes`, `2.1 GB`.
pub fn size(bytes: u64) -> String {
    const UNITS: [(f64, &str); 5] =
        [(1e15, "PB"), (1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    let bytes = bytes as f64;
    let (unit, name) = UNITS.iter().find(|(unit, _)| bytes >= *unit).unwrap_or(&(1.0, "bytes"));
    format!("{} {name}", rough(bytes / unit))
}

/// A number in scientific notation with two digits after the point, as `1.23e-4`; a dash for none.
pub fn scientific(x: f64) -> String {
    if x.is_nan() { DASH.into() } else { format!("{x:.2e}") }
}

/// What stands for no value.
pub const DASH: &str = "–";

/// A value in its format; a dash for none.
pub fn or_dash<T>(x: Option<T>, format: impl FnOnce(T) -> String) -> String {
    x.map_or_else(|| DASH.into(), format)
}

/// The power of ten with a superscript exponent: `10⁻⁸`.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    format!("10{}", superscript(exponent))
}

/// A duration of `t` seconds in engineering units with three significant digits: `1.32 ms`.
pub fn seconds(t: f64) -> String {
    in_units_of_time(t, |t| sig(t, 3))
}

/// A time in a fitting unit, without zeros at the end: `500 ns`, `1.5 ms`.
pub(crate) fn seconds_short(t: f64) -> String {
    in_units_of_time(t, |t| short(t, 6))
}

fn in_units_of_time(t: f64, format: impl FnOnce(f64) -> String) -> String {
    // A power of ten that is computed may be less than it by rounding.
    let size = t.abs() * (1.0 + 1e-12);
    let (factor, unit) = if t == 0.0 || size >= 1.0 || !size.is_finite() {
        (1.0, "s")
    } else if size >= 1e-3 {
        (1e3, "ms")
    } else if size >= 1e-6 {
        (1e6, "µs")
    } else {
        (1e9, "ns")
    };
    format!("{}\u{a0}{unit}", format(t * factor))
}

/// `value` with exactly `decimals` digits after the point and a true minus sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let zero = text.chars().all(|c| c == '0' || c == '.');
    if value < 0.0 && !zero { format!("−{text}") } else { text }
}

/// The text of a number with its digits before the point in groups of three, where they are five or more.
pub(crate) fn grouped(text: &str) -> String {
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let digits = whole.chars().filter(char::is_ascii_digit).count();
    if digits < 5 {
        return text.into();
    }
    let mut out = String::new();
    let mut left = digits;
    for c in whole.chars() {
        if c.is_ascii_digit() {
            if left < digits && left.is_multiple_of(3) {
                out.push('\u{202f}');
            }
            left -= 1;
        }
        out.push(c);
    }
    out + rest
}

/// The digits of a positive number as `d.ddd` and its decimal exponent after rounding.
fn decimal_parts(x: f64, digits: usize) -> (String, i32) {
    let text = format!("{x:.*e}", digits - 1);
    match text.split_once('e') {
        Some((mantissa, exponent)) => (mantissa.to_string(), exponent.parse().unwrap_or(0)),
        None => (text, 0),
    }
}

/// `mantissa · 10^exponent` written without a power of ten.
fn plain(mantissa: &str, exponent: i32) -> String {
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let Ok(whole) = usize::try_from(exponent + 1) else {
        return format!("0.{}{digits}", "0".repeat(exponent.unsigned_abs() as usize - 1));
    };
    match whole {
        0 => format!("0.{digits}"),
        n if n >= digits.len() => format!("{digits}{}", "0".repeat(n - digits.len())),
        n => format!("{}.{}", &digits[..n], &digits[n..]),
    }
}

fn superscript(n: i32) -> String {
    let digits = n.to_string();
    digits
        .chars()
        .map(|c| match c.to_digit(10) {
            Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
            None => '⁻',
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits() {
        assert_eq!(sig(0.012345, 3), "0.0123");
        assert_eq!(sig(0.12345, 3), "0.123");
        assert_eq!(sig(9.999, 3), "10.0");
        assert_eq!(sig(4561.0, 3), "4560");
        assert_eq!(sig(-2.5, 3), "−2.50");
        assert_eq!(sig(1.234e-8, 3), "1.23×10⁻⁸");
        assert_eq!(sig(1.0e6, 1), "1×10⁶");
        assert_eq!(sig(0.0, 3), "0");
        assert_eq!(sig(f64::NAN, 3), "n/a");
        assert_eq!(sig(f64::NEG_INFINITY, 3), "−∞");
    }

    #[test]
    fn short_numbers_have_no_zeros_at_the_end() {
        let short: Vec<String> = [0.5, 240.0, 1.2e-8, -2e9, 0.0].map(|x| short(x, 6)).into();
        assert_eq!(short, ["0.5", "240", "1.2×10⁻⁸", "−2×10⁹", "0"]);
        let typed: Vec<String> = [0.5, 240.0, 1.2e-8, -2e9, -0.0].map(|x| typed(x, 6)).into();
        assert_eq!(typed, ["0.5", "240", "1.2e-8", "-2e9", "0"]);
        assert_eq!([f64::NAN, -f64::INFINITY].map(|x| super::short(x, 6)), ["n/a", "−∞"]);
    }

    #[test]
    fn times_have_the_digits_of_their_span() {
        let span = [1.7e9, 1.7e9 + 40.0];
        assert_eq!(span.map(|t| time(t, span)), ["1700000000", "1700000040"]);
        assert_eq!(time(1.7e9 + 0.125, span), "1700000000.125");
        assert_eq!(time(100.0 / 3.0, [0.0, 40.0]), "33.3333");
        assert_eq!(time(-100.0 / 3.0, [-33.5, -33.0]), "-33.33333");
        assert_eq!(time(1.0 / 3.0, [1.0 / 3.0; 2]), (1.0f64 / 3.0).to_string());
        assert_eq!([0.0, 1e-300].map(|t| time(t, [1e-300, 1.01e-300])), ["0", "1e-300"]);
        assert_eq!(time(1e300, [0.0, f64::INFINITY]), "1e300");
    }

    #[test]
    fn long_numbers_are_in_groups() {
        let grouped = ["1234", "12345.5", "−1000000", "0.00001"].map(super::grouped);
        assert_eq!(grouped, ["1234", "12\u{202f}345.5", "−1\u{202f}000\u{202f}000", "0.00001"]);
    }

    #[test]
    fn powers_and_times() {
        assert_eq!(power_of_ten(-13), "10⁻¹³");
        assert_eq!(power_of_ten(0), "10⁰");
        assert_eq!(seconds(1.3249e-3), "1.32\u{a0}ms");
        assert_eq!(seconds(2.5e-9), "2.50\u{a0}ns");
        assert_eq!(seconds(42e-6), "42.0\u{a0}µs");
        assert_eq!(seconds(0.0), "0\u{a0}s");
        assert_eq!(["500\u{a0}ns", "1\u{a0}µs"], [5e-7, 10f64.powi(-6)].map(seconds_short));
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(fixed(-1.25, 1), "−1.2");
    }

    #[test]
    fn numbers_are_written_as_people_write_them() {
        let numbers = [0.05, 600.0, 77.607_325_78, 1.0 / 33.0, 1.2e-6, 3e9, 0.0, -0.0];
        let written = numbers.map(number);
        assert_eq!(written, ["0.05", "600", "77.6073", "0.030303", "1.2e-6", "3e9", "0", "0"]);
        let written = [143.7, 2.69, 0.002_14, 9.96e-9, 0.0].map(rough);
        assert_eq!(written, ["144", "2.7", "0.0021", "1e-8", "0"]);
        let written = [9.8e-4, 0.021, 90.0, 700.0, 1e5, 1.6e8].map(duration);
        assert_eq!(written, ["980 µs", "21 ms", "90 s", "12 minutes", "28 hours", "5 years"]);
        let written = [0, 320, 2_110_000_000, 1 << 50].map(size);
        assert_eq!(written, ["0 bytes", "320 bytes", "2.1 GB", "1.1 PB"]);
    }
}
