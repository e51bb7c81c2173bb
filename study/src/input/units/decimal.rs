//! Decimal arithmetic on the digits as written, so that a conversion rounds once.

use super::symbol::Scale;

/// Sign and digits as a whole number, and its power of ten. `None` with more than 38 digits, or when
/// the exponent overflows.
fn exact(number: &str) -> Option<(i128, i32)> {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
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

fn float(whole: i128, exponent: i32) -> Option<f64> {
    format!("{whole}e{exponent}").parse().ok()
}

/// `number` × `scale`, rounded once if the scale is decimal.
pub(super) fn scaled(number: &str, scale: &Scale) -> Option<f64> {
    let product = exact(number).and_then(|(whole, exponent)| {
        float(whole.checked_mul(i128::from(scale.factor))?, exponent.checked_add(scale.exponent)?)
    });
    let product = match product {
        Some(product) => product,
        None => number.parse::<f64>().ok()? * scale.factor as f64 * float(1, scale.exponent)?,
    };
    // A division by 1 changes no bit.
    Some(scale.apply_degrees(product / scale.divisor as f64))
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
