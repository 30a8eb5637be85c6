//! Numbers with 17 significant digits.

use std::fmt;

const DIGITS: i32 = 17;
/// Below this power of ten the short form of C has an exponent.
const LOWEST_PLAIN: i32 = -4;

/// A number as C's `%.17g` prints it: 17 significant digits without trailing zeros, an exponent of at
/// least two digits outside 1e-4 to 1e17. Reads back to the same bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Digits17(pub(crate) f64);

impl fmt::Display for Digits17 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = self.0;
        if !number.is_finite() {
            let sign = if number.is_sign_negative() && !number.is_nan() { "-" } else { "" };
            return write!(f, "{sign}{}", if number.is_nan() { "nan" } else { "inf" });
        }
        // Rust writes `d.dddde-7`, correctly rounded; only the layout differs from C.
        let scientific = format!("{number:.16e}");
        let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        if (LOWEST_PLAIN..DIGITS).contains(&exponent) {
            let decimals = usize::try_from(DIGITS - 1 - exponent).unwrap_or(0);
            f.write_str(trimmed(&format!("{number:.decimals$}")))
        } else {
            let sign = if exponent < 0 { '-' } else { '+' };
            write!(f, "{}e{sign}{:02}", trimmed(mantissa), exponent.abs())
        }
    }
}

/// Without the zeros, and the point, that say nothing.
fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_crowd::cross::SplitMix64;

    #[test]
    fn numbers_look_as_c_prints_them() {
        let cases = [
            (0.0, "0"),
            (-0.0, "-0"),
            (-5.0, "-5"),
            (0.1, "0.10000000000000001"),
            (-1.520_898_037_669_236e-6, "-1.520898037669236e-06"),
            (1e-4, "0.0001"),
            (9.999e-5, "9.9989999999999996e-05"),
            (1e17, "1e+17"),
            (12_345_678_901_234_568.0, "12345678901234568"),
            (1e300, "1.0000000000000001e+300"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
            (f64::NAN, "nan"),
            (5e-324, "4.9406564584124654e-324"),
        ];
        for (number, text) in cases {
            assert_eq!(Digits17(number).to_string(), text);
        }
    }

    #[test]
    fn every_number_reads_back_to_the_same_bits() {
        let mut random = SplitMix64::new(7);
        for _ in 0..20_000 {
            let number = f64::from_bits(random.next_u64());
            if number.is_finite() {
                let text = Digits17(number).to_string();
                assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
            }
        }
    }
}
