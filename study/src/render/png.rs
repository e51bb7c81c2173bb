//! PNG files, drawn from the very SVG text that is stored beside them.
//!
//! One embedded font ([`super::font`]) and no other, no system fonts, no files: the same SVG gives the
//! same bytes on any machine.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{self, ImageHrefResolver, Options, Tree, fontdb};

use super::font;

/// Pixels a millimetre fit for print: 305 dots per inch.
pub const PRINT: f64 = 12.0;
/// Pixels a picture may have: a larger one is asked for by mistake.
const PIXELS: f64 = 2e8;
/// Units of `usvg` (CSS pixels) a millimetre.
const CSS: f64 = 96.0 / 25.4;

static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(font::BYTES.to_vec());
    fonts.set_sans_serif_family(font::FAMILY);
    Arc::new(fonts)
});

/// Draws an SVG, on white, `dots_per_mm` pixels a millimetre of its `width` and `height` (a length
/// without a unit is 1/96 inch, as in CSS). Texts are set in the family [`font::FAMILY`] or
/// `sans-serif`; images inside the SVG are left out.
///
/// # Errors
/// What is wrong with the SVG, or a picture without pixels or with far too many, in words.
pub fn encode(svg: &str, dots_per_mm: f64) -> Result<Vec<u8>, String> {
    let options = Options {
        font_family: font::FAMILY.to_owned(),
        fontdb: Arc::clone(&FONTS),
        // The disk has one door, and it is not here.
        image_href_resolver: ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|error| format!("no SVG: {error}"))?;
    draw(&tree, dots_per_mm / CSS)
}

fn draw(tree: &usvg::Tree, scale: f64) -> Result<Vec<u8>, String> {
    let [width, height] = [tree.size().width(), tree.size().height()]
        .map(|length| (f64::from(length) * scale).round().max(1.0));
    if !(scale > 0.0 && width * height <= PIXELS) {
        return Err(format!("{width} by {height} pixels, more than {PIXELS:e}"));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole, and at most PIXELS"
    )]
    let (columns, rows) = (width as u32, height as u32);
    let mut pixels = Pixmap::new(columns, rows).ok_or("no pixels")?;
    pixels.fill(Color::WHITE);
    #[expect(clippy::cast_possible_truncation, reason = "f32 is what usvg draws with")]
    let scale = scale as f32;
    resvg::render(tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| error.to_string())
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

    fn drawn(body: &str) -> Pixmap {
        Pixmap::decode_png(&encode(&svg(body), 10.0).unwrap()).unwrap()
    }

    /// Pixels that are not white.
    fn ink(pixels: &Pixmap) -> usize {
        pixels.pixels().iter().filter(|pixel| pixel.red() < 255 || pixel.alpha() < 255).count()
    }

    #[test]
    fn a_picture_has_the_size_of_its_page_and_is_white_where_nothing_is() {
        let pixels = drawn("");
        assert_eq!((pixels.width(), pixels.height()), (400, 100));
        assert_eq!(ink(&pixels), 0);
        let square = drawn("<rect x=\"1\" y=\"1\" width=\"3\" height=\"2\" fill=\"black\"/>");
        assert_eq!(ink(&square), 30 * 20);
    }

    #[test]
    fn text_is_set_in_the_embedded_font_and_as_wide_as_measured() {
        let text = "ϕ 12.5 m³/s";
        let pixels = drawn(&format!("<text x=\"2\" y=\"6\">{text}</text>"));
        let columns: Vec<u32> = (0..pixels.width())
            .filter(|x| (0..100).any(|y| pixels.pixel(*x, y).unwrap().red() < 128))
            .collect();
        let (first, last) = (columns[0], columns[columns.len() - 1]);
        let expected = 10.0 * font::width(text, 4.0);
        let measured = f64::from(last - first + 1);
        assert!((measured - expected).abs() < 0.06 * expected, "{measured} {expected}");
        // Another family is set in the embedded font too, never in one of the machine's.
        let generic =
            drawn(&format!("<text x=\"2\" y=\"6\" font-family=\"sans-serif\">{text}</text>"));
        assert!(generic == pixels);
    }

    #[test]
    fn the_bytes_are_the_same_each_time() {
        let svg = svg(
            "<circle cx=\"20\" cy=\"5\" r=\"4.3\" fill=\"#0072b2\"/><text x=\"1\" y=\"9\">m</text>",
        );
        assert_eq!(encode(&svg, 7.3).unwrap(), encode(&svg, 7.3).unwrap());
    }

    #[test]
    fn what_is_no_picture_is_said() {
        assert!(encode("<svg", 10.0).unwrap_err().starts_with("no SVG: "));
        assert!(encode(&svg(""), 1e6).unwrap_err().contains("pixels"));
        assert!(encode(&svg(""), f64::NAN).is_err());
    }
}
