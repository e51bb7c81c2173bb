//! The font of the pictures: `DejaVu Sans`, embedded in the program, so that a picture is the same on any
//! machine.
//!
//! `assets/DejaVuSans-subset.ttf` is a subset (Latin, Greek, mathematical signs) of `DejaVu Sans` 2.37;
//! its licence is in the same folder. SVG files name the font, and [`super::png`] draws with it. The widths
//! of texts come from the tables `cmap` and `hmtx` of the font (OpenType specification).

use std::sync::LazyLock;

/// The font file.
pub const BYTES: &[u8] = include_bytes!("../../assets/DejaVuSans-subset.ttf");
/// Font family, as an SVG file names it.
pub const FAMILY: &str = "DejaVu Sans";

static METRICS: LazyLock<Metrics> =
    LazyLock::new(|| Metrics::read(BYTES).unwrap_or_else(|| panic!("the embedded font is valid")));

/// Width of a text at a font size, in the unit of `size`. A character that the font does not have counts as
/// one font size.
pub fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|letter| METRICS.advance(letter).unwrap_or(1.0)).sum::<f64>() * size
}

/// Whether the font has this character.
pub fn has(letter: char) -> bool {
    METRICS.advance(letter).is_some()
}

/// Advance widths of the characters of the Basic Multilingual Plane, in font sizes.
struct Metrics {
    /// Sorted by character.
    advances: Vec<(u16, f64)>,
}

impl Metrics {
    fn read(font: &'static [u8]) -> Option<Self> {
        let units = f64::from(u16_at(table(font, *b"head")?, 18)?);
        let measured = usize::from(u16_at(table(font, *b"hhea")?, 34)?);
        let hmtx = table(font, *b"hmtx")?;
        let advance = |glyph: u16| {
            // Glyphs after the last measured one have its advance.
            let entry = usize::from(glyph).min(measured.checked_sub(1)?);
            Some(f64::from(u16_at(hmtx, 4 * entry)?) / units)
        };
        let cmap = table(font, *b"cmap")?;
        let subtables = usize::from(u16_at(cmap, 2)?);
        let segments = (0..subtables).find_map(|number| {
            let subtable = cmap.get(u32_at(cmap, 8 + 8 * number)?..)?;
            (u16_at(subtable, 0)? == 4).then_some(subtable)
        })?;
        let advances = Self::glyphs(segments)?
            .into_iter()
            .filter_map(|(letter, glyph)| Some((letter, advance(glyph)?)))
            .collect();
        Some(Self { advances })
    }

    /// Characters and their glyphs, of a `cmap` subtable of format 4.
    fn glyphs(subtable: &[u8]) -> Option<Vec<(u16, u16)>> {
        let doubled = usize::from(u16_at(subtable, 6)?);
        let (ends, starts) = (14, 16 + doubled);
        let (deltas, offsets) = (starts + doubled, starts + 2 * doubled);
        let mut glyphs = Vec::new();
        for segment in (0..doubled).step_by(2) {
            let start = u16_at(subtable, starts + segment)?;
            let end = u16_at(subtable, ends + segment)?;
            let delta = u16_at(subtable, deltas + segment)?;
            let offset = usize::from(u16_at(subtable, offsets + segment)?);
            for letter in (start..=end).filter(|letter| *letter != u16::MAX) {
                let glyph = if offset == 0 {
                    letter.wrapping_add(delta)
                } else {
                    let index = offsets + segment + offset + 2 * usize::from(letter - start);
                    match u16_at(subtable, index)? {
                        0 => 0,
                        glyph => glyph.wrapping_add(delta),
                    }
                };
                if glyph != 0 {
                    glyphs.push((letter, glyph));
                }
            }
        }
        Some(glyphs)
    }

    fn advance(&self, letter: char) -> Option<f64> {
        let letter = u16::try_from(u32::from(letter)).ok()?;
        let index = self.advances.binary_search_by_key(&letter, |(known, _)| *known).ok()?;
        Some(self.advances[index].1)
    }
}

/// A table of the font file, from its directory.
fn table(font: &'static [u8], tag: [u8; 4]) -> Option<&'static [u8]> {
    let tables = usize::from(u16_at(font, 4)?);
    (0..tables).map(|number| 12 + 16 * number).find_map(|entry| {
        if font.get(entry..entry + 4)? != tag {
            return None;
        }
        let start = u32_at(font, entry + 8)?;
        font.get(start..start + u32_at(font, entry + 12)?)
    })
}

fn u16_at(bytes: &[u8], offset: usize) -> Option<u16> {
    Some(u16::from_be_bytes(bytes.get(offset..offset + 2)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], offset: usize) -> Option<usize> {
    let number = u32::from_be_bytes(bytes.get(offset..offset + 4)?.try_into().ok()?);
    usize::try_from(number).ok()
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
            assert!(has(letter), "{letter}");
        }
        assert!(!has('速'));
    }
}
