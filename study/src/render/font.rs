//! The font of the pictures: `DejaVu Sans`, embedded in the program, so that a picture is the same on any
//! machine.
//!
//! `assets/DejaVuSans-subset.ttf` is a subset (Latin, Greek, mathematical signs) of `DejaVu Sans` 2.37;
//! its licence is in the same folder. SVG files name the font, and [`super::png`] draws with it.

use std::sync::LazyLock;

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};

/// The font file.
pub const BYTES: &[u8] = include_bytes!("../../assets/DejaVuSans-subset.ttf");
/// Font family, as an SVG file names it.
pub const FAMILY: &str = "DejaVu Sans";

static FONT: LazyLock<FontRef<'_>> =
    LazyLock::new(|| FontRef::new(BYTES).unwrap_or_else(|_| panic!("the embedded font is valid")));

/// Width of a text at a font size, in the unit of `size`. A character that the font does not have counts as
/// one font size.
pub fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|letter| advance(letter).unwrap_or(1.0)).sum::<f64>() * size
}

/// Advance width of a character, in font sizes; `None` if the font does not have it.
fn advance(letter: char) -> Option<f64> {
    let glyph = FONT.charmap().map(letter)?;
    let (size, location) = (Size::unscaled(), LocationRef::default());
    let units = f64::from(FONT.metrics(size, location).units_per_em);
    Some(f64::from(FONT.glyph_metrics(size, location).advance_width(glyph)?) / units)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_dejavu_sans() {
        // Advances of DejaVu Sans over 2048 units: i 569, W 2025, 0 1303, α 1350, space 651.
        for (letter, units) in
            [("i", 569.0), ("W", 2025.0), ("0", 1303.0), ("α", 1350.0), (" ", 651.0)]
        {
            assert!((width(letter, 2048.0) - units).abs() < 1e-9, "{letter}");
        }
        assert!((width("Wi", 2.0) - 2.0 * (2025.0 + 569.0) / 2048.0).abs() < 1e-12);
    }

    #[test]
    fn the_font_has_units_and_signs() {
        for letter in "AZaz09 .,·×−–²³°µϕα∠≥≤…₀⁻¹½√→←∞≈∅()/%&<>\"'_".chars()
        {
            assert!(advance(letter).is_some(), "{letter}");
        }
        assert!(advance('速').is_none());
    }
}
