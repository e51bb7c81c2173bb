//! Decimal arithmetic on the digits as written, so that a conversion rounds once.

use super::symbol::Scale;

/// Sign and digits as a whole number, and its power of ten. `None` with more than 38 digits, or when
/// the exponent overflows.
fn exact(number: &str) -> Option<(i128, i32)> {
    let (mantissa, exponent) = split(number);
    let mut exponent: i32 = exponent.parse().ok()?;
    let mut whole: i128 = 0;
    let mut after_point = false;
    for c in mantissa.bytes() {
        match c {
            b'.' => after_point = true,
            b'0'..=b'9' => {
                whole = whole.checked_mul(10)?.checked_add(i128::from(c - b'0'))?;
                exponent = exponent.checked_sub(i32::from(after_point))?;
            }
            _ => {}
        }
    }
    Some((if mantissa.starts_with('-') { -whole } else { whole }, exponent))
}

/// Texts of mantissa and exponent.
fn split(number: &str) -> (&str, &str) {
    number.split_once(['e', 'E']).unwrap_or((number, "0"))
}

fn float(whole: i128, exponent: i32) -> Option<f64> {
    format!("{whole}e{exponent}").parse().ok()
}

/// `number` × `scale`, rounded once if the scale is decimal.
pub(super) fn scaled(number: &str, scale: &Scale) -> Option<f64> {
    if scale.factor == 1 && scale.divisor == 1 {
        // For a power of ten, only the exponent of the text changes.
        let (mantissa, exponent) = split(number);
        let moved = match exponent.parse::<i64>() {
            Ok(exponent) => exponent.saturating_add(i64::from(scale.exponent)),
            // With an exponent that overflows i64 the number is 0 or infinite in any unit.
            Err(_) => return number.parse::<f64>().ok().map(|value| scale.apply_degrees(value)),
        };
        return format!("{mantissa}e{moved}")
            .parse::<f64>()
            .ok()
            .map(|value| scale.apply_degrees(value));
    }
    let product = exact(number).and_then(|(whole, exponent)| {
        float(whole.checked_mul(i128::from(scale.factor))?, exponent.checked_add(scale.exponent)?)
    });
    let product = if let Some(product) = product {
        product
    } else {
        let value: f64 = number.parse().ok()?;
        let shift: f64 = format!("1e{}", scale.exponent).parse().ok()?;
        value * scale.factor as f64 * shift
    };
    let quotient = if scale.divisor == 1 { product } else { product / scale.divisor as f64 };
    Some(scale.apply_degrees(quotient))
}

/// `number` + `offset`, rounded once. The offset is a whole number and a power of ten.
pub(super) fn shifted(number: &str, offset: (i128, i32)) -> Option<f64> {
    let sum = exact(number).and_then(|(whole, exponent)| {
        let low = exponent.min(offset.1);
        let raise = |whole: i128, exponent: i32| {
            whole.checked_mul(10_i128.checked_pow(u32::try_from(exponent.checked_sub(low)?).ok()?)?)
        };
        float(raise(whole, exponent)?.checked_add(raise(offset.0, offset.1)?)?, low)
    });
    match sum {
        Some(sum) => Some(sum),
        None => Some(number.parse::<f64>().ok()? + float(offset.0, offset.1)?),
    }
}
