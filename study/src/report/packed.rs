//! Numbers for a page, in few bytes: whole steps between the least and the largest one, deltas, deflate, base64.
//!
//! ```text
//! q_i = round((x_i − low)/(high − low) levels)     missing: levels + 1
//! d_i = q_i − q_(i − stride) modulo 2^16           low bytes of all, then high bytes of all
//! ```

use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};

/// Levels of values that are read: an error of 1/131,068 of their range.
pub const FINE: u16 = 65_534;
/// Levels of values that are colours.
pub const COLOURS: u16 = 254;

/// Bytes, deflated, as base64.
pub fn deflated(bytes: &[u8]) -> String {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // A vector takes every byte.
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    STANDARD.encode(written.unwrap_or_default())
}

/// Numbers in single precision; those that are not finite are missing.
pub fn singles(values: impl Iterator<Item = Option<f64>>) -> String {
    #[expect(clippy::cast_possible_truncation, reason = "seven digits are enough to read")]
    let bits = values.flat_map(|value| (value.unwrap_or(f64::NAN) as f32).to_le_bytes());
    deflated(&bits.collect::<Vec<u8>>())
}

/// Whole numbers below 2^32.
pub fn indices(values: impl Iterator<Item = u32>) -> String {
    deflated(&values.flat_map(u32::to_le_bytes).collect::<Vec<u8>>())
}

/// Numbers in steps, each as a difference from the one `stride` before it.
pub fn steps(values: &[f64], stride: usize, levels: u16) -> Value {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) =
        (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let range = high - low;
    let scale = if range > 0.0 { f64::from(levels) / range } else { 0.0 };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to the number of levels"
    )]
    let step = |value: f64| {
        if value.is_finite() { libm::round((value - low) * scale) as u16 } else { levels + 1 }
    };
    let steps: Vec<u16> = values.iter().map(|value| step(*value)).collect();
    let before = |index: usize| if index < stride { 0 } else { steps[index - stride] };
    let differences: Vec<u16> =
        steps.iter().enumerate().map(|(index, step)| step.wrapping_sub(before(index))).collect();
    let bytes =
        |place: usize| differences.iter().map(move |difference| difference.to_le_bytes()[place]);
    let data = deflated(&bytes(0).chain(bytes(1)).collect::<Vec<u8>>());
    let bound = |value: f64| if value.is_finite() { value } else { 0.0 };
    json!({"low": bound(low), "high": bound(high), "levels": levels, "stride": stride, "data": data})
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use flate2::read::ZlibDecoder;

    use super::*;

    fn inflated(text: &str) -> Vec<u8> {
        let mut bytes = Vec::new();
        let packed = STANDARD.decode(text).unwrap();
        ZlibDecoder::new(packed.as_slice()).read_to_end(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn steps_are_read_back_within_half_a_step() {
        let values: Vec<f64> =
            (0..301).map(|k| if k == 7 { f64::NAN } else { libm::sin(f64::from(k)) }).collect();
        for (stride, levels) in [(1, FINE), (3, FINE), (3, COLOURS)] {
            let packed = steps(&values, stride, levels);
            let number = |name: &str| packed[name].as_f64().unwrap();
            let bytes = inflated(packed["data"].as_str().unwrap());
            let mut found: Vec<u16> = Vec::new();
            for index in 0..values.len() {
                let difference = u16::from_le_bytes([bytes[index], bytes[index + values.len()]]);
                let before = if index < stride { 0 } else { found[index - stride] };
                found.push(before.wrapping_add(difference));
            }
            let size = (number("high") - number("low")) / f64::from(levels);
            for (step, value) in found.iter().zip(&values) {
                if value.is_nan() {
                    assert_eq!(*step, levels + 1);
                } else {
                    let read = number("low") + size * f64::from(*step);
                    assert!((read - value).abs() < 0.5001 * size, "{read} {value}");
                }
            }
        }
        // Equal values, and none.
        assert_eq!(steps(&[2.0; 3], 1, FINE)["low"], 2.0);
        assert_eq!(steps(&[], 1, FINE)["high"], 0.0);
    }

    #[test]
    fn single_precision_keeps_missing_values_apart() {
        let bytes = inflated(&singles([Some(1.5), None, Some(-2e-7)].into_iter()));
        let (numbers, _) = bytes.as_chunks::<4>();
        let read: Vec<f32> = numbers.iter().map(|bits| f32::from_le_bytes(*bits)).collect();
        assert!(read[1].is_nan() && (read[0] - 1.5).abs() < 1e-9 && (read[2] + 2e-7).abs() < 1e-13);
        assert_eq!(inflated(&indices([70_000].into_iter())), 70_000_u32.to_le_bytes());
    }
}
