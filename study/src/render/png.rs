//! PNG files, drawn from the SVG text that is stored beside them.
//!
//! Texts use the embedded font ([`super::font`]) and no system font, so the same SVG gives the same bytes on
//! any machine.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{self, ImageHrefResolver, Options, Tree, fontdb};

use super::font;

/// Resolution for print, pixels per mm: 305 dots per inch.
pub const PRINT_RESOLUTION: f64 = 12.0;
/// Most pixels of a picture. Chosen: 0.8 GB of memory; a larger picture is a mistake.
const MAX_PIXELS: f64 = 2e8;
/// CSS pixels, the unit of `usvg`, per mm.
const CSS_PIXELS_PER_MM: f64 = 96.0 / 25.4;

static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(font::BYTES.to_vec());
    fonts.set_sans_serif_family(font::FAMILY);
    Arc::new(fonts)
});

/// A picture, four bytes a pixel, row by row from the top.
pub struct Pixels {
    /// Pixels of a row.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Red, green, blue, opacity.
    pub rgba: Vec<u8>,
}

/// The pixels of an SVG, as [`encode`] draws it.
///
/// # Errors
/// As [`encode`].
pub fn pixels(svg: &str, dots_per_mm: f64) -> Result<Pixels, String> {
    let drawn = drawn(svg, dots_per_mm)?;
    Ok(Pixels { width: drawn.width(), height: drawn.height(), rgba: drawn.take() })
}

/// Draws an SVG on white with `dots_per_mm` pixels per mm of its `width` and `height`; a length without a
/// unit is 1/96 inch, as in CSS. Texts use the family [`font::FAMILY`] or `sans-serif`; images inside the SVG
/// are ignored.
///
/// # Errors
/// An invalid SVG, a picture without pixels or with too many.
pub fn encode(svg: &str, dots_per_mm: f64) -> Result<Vec<u8>, String> {
    drawn(svg, dots_per_mm)?.encode_png().map_err(|error| error.to_string())
}

fn drawn(svg: &str, dots_per_mm: f64) -> Result<Pixmap, String> {
    let options = Options {
        font_family: font::FAMILY.to_owned(),
        fontdb: Arc::clone(&FONTS),
        // Files are read through `platform::files` only.
        image_href_resolver: ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|error| format!("invalid SVG: {error}"))?;
    draw(&tree, dots_per_mm / CSS_PIXELS_PER_MM)
}

fn draw(tree: &usvg::Tree, scale: f64) -> Result<Pixmap, String> {
    let [width, height] = [tree.size().width(), tree.size().height()]
        .map(|length| (f64::from(length) * scale).round().max(1.0));
    if !(scale > 0.0 && width * height <= MAX_PIXELS) {
        return Err(format!("{width} by {height} pixels, more than {MAX_PIXELS:e}"));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole, and at most MAX_PIXELS"
    )]
    let (columns, rows) = (width as u32, height as u32);
    let mut pixels = Pixmap::new(columns, rows).ok_or("a picture without pixels")?;
    pixels.fill(Color::WHITE);
    #[expect(clippy::cast_possible_truncation, reason = "usvg draws with f32")]
    let scale = scale as f32;
    resvg::render(tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(body: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40mm\" height=\"10mm\" \
             viewBox=\"0 0 40 10\" font-family=\"{}, sans-serif\" font-size=\"4\">{body}</svg>",
            font::FAMILY
        )
    }

    fn decoded(body: &str) -> Pixmap {
        Pixmap::decode_png(&encode(&svg(body), 10.0).unwrap()).unwrap()
    }

    /// Pixels that are not white.
    fn ink(pixels: &Pixmap) -> usize {
        pixels.pixels().iter().filter(|pixel| pixel.red() < 255 || pixel.alpha() < 255).count()
    }

    #[test]
    fn a_picture_has_the_size_of_its_page_a_white_ground_and_the_same_bytes_twice() {
        let pixels = decoded("");
        assert_eq!((pixels.width(), pixels.height()), (400, 100));
        assert_eq!(ink(&pixels), 0);
        let square = "<rect x=\"1\" y=\"1\" width=\"3\" height=\"2\" fill=\"black\"/>";
        assert_eq!(ink(&decoded(square)), 30 * 20);
        assert_eq!(encode(&svg(square), 7.3).unwrap(), encode(&svg(square), 7.3).unwrap());
        assert!(encode("<svg", 10.0).unwrap_err().starts_with("invalid SVG: "));
        assert!(encode(&svg(""), 1e6).unwrap_err().contains("pixels"));
        assert!(encode(&svg(""), f64::NAN).is_err());
    }

    #[test]
    fn text_uses_the_embedded_font_and_has_the_measured_width() {
        let text = "ϕ 12.5 m³/s";
        let pixels = decoded(&format!("<text x=\"2\" y=\"6\">{text}</text>"));
        let columns: Vec<u32> = (0..pixels.width())
            .filter(|x| (0..100).any(|y| pixels.pixel(*x, y).unwrap().red() < 128))
            .collect();
        let measured = f64::from(columns[columns.len() - 1] - columns[0] + 1);
        let expected = 10.0 * font::width(text, 4.0);
        assert!((measured - expected).abs() < 0.06 * expected, "{measured} {expected}");
        // Another family uses the embedded font too, not a system font.
        let generic =
            decoded(&format!("<text x=\"2\" y=\"6\" font-family=\"sans-serif\">{text}</text>"));
        assert!(generic == pixels);
    }
}
