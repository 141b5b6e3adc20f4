//! Formats numbers as libfranka does.

use core::fmt::{self, Write};

/// Prints a number in the default format of a C++ stream: six significant digits, as `%g` in C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct General(pub f64);

impl fmt::Display for General {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if !value.is_finite() {
            let sign = if value.is_sign_negative() { "-" } else { "" };
            let name = if value.is_nan() { "nan" } else { "inf" };
            return write!(f, "{sign}{name}");
        }
        let mut text = Scientific::default();
        write!(text, "{:.*e}", DIGITS - 1, value.abs())?;
        let (digits, exponent) = text.parse().ok_or(fmt::Error)?;
        // C drops trailing zeros, but keeps the first digit.
        let kept = digits.iter().rposition(|&digit| digit != b'0').unwrap_or(0) + 1;
        let digits = core::str::from_utf8(&digits[..kept]).map_err(|_| fmt::Error)?;
        if value.is_sign_negative() {
            f.write_char('-')?;
        }
        match exponent {
            0..DIGITS_I32 => {
                let point = exponent as usize + 1;
                match digits.split_at_checked(point) {
                    Some((whole, "")) => f.write_str(whole),
                    Some((whole, fraction)) => write!(f, "{whole}.{fraction}"),
                    None => write!(f, "{digits:0<point$}"),
                }
            }
            -4..0 => {
                let zeros = (-exponent - 1) as usize;
                write!(f, "0.{:0<zeros$}{digits}", "")
            }
            _ => {
                let (first, rest) = digits.split_at(1);
                let point = if rest.is_empty() { "" } else { "." };
                let sign = if exponent < 0 { '-' } else { '+' };
                write!(f, "{first}{point}{rest}e{sign}{:02}", exponent.abs())
            }
        }
    }
}

/// Number of significant digits of a C++ stream.
const DIGITS: usize = 6;
const DIGITS_I32: i32 = DIGITS as i32;

/// Buffer for the scientific notation of a number with [`DIGITS`] digits, such as `1.23457e-308`.
#[derive(Default)]
struct Scientific {
    bytes: [u8; DIGITS + 8],
    len: usize,
}

impl Scientific {
    /// Returns the digits without the point, and the exponent of the first digit.
    fn parse(&self) -> Option<([u8; DIGITS], i32)> {
        let text = core::str::from_utf8(&self.bytes[..self.len]).ok()?;
        let (mantissa, exponent) = text.split_once('e')?;
        let mut digits = [b'0'; DIGITS];
        let written = mantissa.bytes().filter(u8::is_ascii_digit);
        for (digit, written) in digits.iter_mut().zip(written) {
            *digit = written;
        }
        Some((digits, exponent.parse().ok()?))
    }
}

impl Write for Scientific {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let end = self.len + text.len();
        let room = self.bytes.get_mut(self.len..end).ok_or(fmt::Error)?;
        room.copy_from_slice(text.as_bytes());
        self.len = end;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    /// The expected texts come from C's `printf("%g")`.
    #[test]
    fn numbers_print_as_in_c() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (0.97, "0.97"),
            (0.123456789, "0.123457"),
            (0.0987654312, "0.0987654"),
            (123456.0, "123456"),
            (1234567.0, "1.23457e+06"),
            (100000.0, "100000"),
            (999999.5, "1e+06"),
            (99.999951, "100"),
            (1000.5, "1000.5"),
            (0.0001, "0.0001"),
            (0.00001234, "1.234e-05"),
            (0.0000999999999, "0.0001"),
            (-2.5, "-2.5"),
            (1e100, "1e+100"),
            (5e-324, "4.94066e-324"),
            (-1.7976931348623157e308, "-1.79769e+308"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(General(value).to_string(), expected);
        }
        assert_eq!(General(f64::NAN).to_string(), "nan");
    }
}
