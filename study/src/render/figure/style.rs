//! Styles that distinguish series: colour, dashes and marker.
//!
//! A series is given by one index, and then each part alone is sufficient; or by the values of two
//! parameters, and then colour and marker show the first one and dashes the second one.
//!
//! The colours are those of Okabe and Ito, which colour-blind readers can distinguish; their yellow is not
//! used, because it is not visible on white. Dashes and markers distinguish series in black and white. Maps
//! use viridis, whose lightness increases evenly, so that they are readable in grey.

use crate::render::page::{Page, Position, Stroke};

/// Size of the numbers of axes, legends and notes, mm: 8 pt and more.
pub const SMALL: f64 = 2.9;
/// Size of the labels of axes and panels, mm: 9 pt.
pub const MEDIUM: f64 = 3.2;
/// Size of the title, mm: 11 pt.
pub const LARGE: f64 = 3.9;
/// Width of every figure, mm: a column of text on A4.
pub const PAGE_WIDTH: f64 = 160.0;
/// Margin round a figure, mm.
pub const MARGIN: f64 = 4.0;

/// Colours of series.
const COLOURS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];
/// Dashes of series, mm.
const DASHES: [&[f64]; 5] =
    [&[], &[2.8, 1.1], &[0.7, 0.8], &[3.2, 0.9, 0.7, 0.9], &[5.0, 0.9, 1.4, 0.9, 1.4, 0.9]];
/// Width of the line of a series, mm.
const LINE: f64 = 0.45;
/// Width of the line of a quantity that oscillates, mm.
const THIN_LINE: f64 = 0.25;
/// Colour of samples that stand for no series.
pub const PLAIN: &str = "#333333";
/// Lines of axes and frames.
pub const AXIS: Stroke = Stroke::solid("#333333", 0.25);
/// Grid lines.
pub const GRID: Stroke = Stroke::solid("#dddddd", 0.15);
/// Colour of notes.
pub const GREY: &str = "#444444";
/// Ground of cells without a value, and of lanes.
pub const EMPTY: &str = "#e8e8e8";
/// Hatch of cells without a value.
pub const HATCH: Stroke = Stroke::solid("#b0b0b0", 0.2);

/// Colours of an ordered series with more values than [`COLOURS`]: viridis without its light end, which is
/// not visible on white.
const SEQUENCE: [&str; 20] = [
    "#440154", "#470e61", "#481b6d", "#482878", "#46337f", "#423f85", "#3e4989", "#39558c",
    "#355f8d", "#31688e", "#2d718e", "#297a8e", "#25848e", "#218d8d", "#1e978a", "#20a386",
    "#2bad80", "#3bb976", "#51c369", "#6ccd59",
];
/// Number of values of a parameter that colours can show.
pub const MAX_COLOURS: usize = SEQUENCE.len();
/// Number of values of a parameter that dashes can show.
pub const MAX_DASHES: usize = DASHES.len();

/// The style of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Series {
    /// Colour.
    pub colour: &'static str,
    /// Index of the dashes; 0 is a solid line.
    pub dashes: usize,
    /// Index of the marker shape; `None` for a line without markers.
    pub marker: Option<usize>,
}

impl Default for Series {
    /// No series: a solid line in one colour.
    fn default() -> Self {
        Self::dashes_only(0)
    }
}

impl Series {
    /// The style of the series with this index.
    pub fn nth(index: usize) -> Self {
        Self {
            colour: COLOURS[index % COLOURS.len()],
            dashes: index % DASHES.len(),
            // When the colours repeat, each one gets the shape of the next colour.
            marker: Some((index + index / COLOURS.len()) % COLOURS.len()),
        }
    }

    /// The style of value `colour` of `colours` of one parameter, and value `dashes` of another one.
    pub fn of_values((colour, colours): (usize, usize), dashes: usize) -> Self {
        let shade = if colours <= COLOURS.len() {
            COLOURS[colour % COLOURS.len()]
        } else {
            let last = SEQUENCE.len() - 1;
            SEQUENCE[(colour * last / (colours - 1)).min(last)]
        };
        let marker = Some(colour % COLOURS.len());
        Self { colour: shade, dashes: dashes % DASHES.len(), marker }
    }

    /// Dashes alone, for a legend.
    pub fn dashes_only(dashes: usize) -> Self {
        Self { colour: PLAIN, dashes: dashes % DASHES.len(), marker: None }
    }

    /// The line.
    pub fn line(self) -> Stroke {
        Stroke { colour: self.colour, width: LINE, dashes: DASHES[self.dashes] }
    }

    /// A thinner line, for a quantity that rings.
    pub fn thin_line(self) -> Stroke {
        Stroke { width: THIN_LINE, ..self.line() }
    }
}

/// How the inside of a marker is filled: it shows the outcome of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fill {
    /// Filled: deployed.
    Filled,
    /// Its left half filled: some of several runs deployed.
    Half,
    /// White inside: partial.
    Open,
    /// White inside, with a cross: stalled, or no run deployed.
    Crossed,
}

/// The sign of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// A circle, filled as the marker of a job.
    Circle(Fill),
    /// The filled marker with this index.
    Marker(usize),
    /// A small circle.
    Dot,
    /// A diagonal cross.
    Cross,
    /// A bar.
    Bar,
}

/// Size of a sign, mm.
const SIGN: f64 = 2.0;

impl Sign {
    /// Draws the sign in a colour on a coloured ground.
    pub fn draw(self, page: &mut Page, centre: Position, ink: &'static str) {
        let [x, y] = centre;
        match self {
            Self::Circle(fill) => shape(page, centre, 0, (ink, "none", fill), SIGN),
            Self::Marker(number) => shape(page, centre, number, (ink, "none", Fill::Filled), SIGN),
            Self::Dot => page.circle(centre, 0.25 * SIGN, ink, &Stroke::solid(ink, 0.1)),
            Self::Cross => cross(page, centre, &Stroke::solid(ink, 0.5), SIGN),
            Self::Bar => {
                page.line([x - 0.5 * SIGN, y], [x + 0.5 * SIGN, y], &Stroke::solid(ink, 0.5));
            }
        }
    }
}

/// Draws the marker of a series, about `size` mm wide; a circle for a series without one.
pub fn marker(page: &mut Page, centre: Position, series: Series, fill: Fill, size: f64) {
    let number = series.marker.unwrap_or(0);
    shape(page, centre, number, (series.colour, "#ffffff", fill), size);
}

/// Draws a diagonal cross, `size` mm wide.
pub fn cross(page: &mut Page, [x, y]: Position, stroke: &Stroke, size: f64) {
    let arm = 0.5 * size;
    page.line([x - arm, y - arm], [x + arm, y + arm], stroke);
    page.line([x - arm, y + arm], [x + arm, y - arm], stroke);
}

/// Corners of the markers after the circle, over half of their size.
const SHAPES: [&[Position]; 6] = [
    &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
    &[[0.0, -1.15], [1.1, 0.8], [-1.1, 0.8]],
    &[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]],
    &[[0.0, 1.15], [1.1, -0.8], [-1.1, -0.8]],
    &[[1.15, 0.0], [-0.8, 1.1], [-0.8, -1.1]],
    &[[-1.15, 0.0], [0.8, 1.1], [0.8, -1.1]],
];

/// Draws a marker with its outline in a colour; `ground` is the colour inside one that is not filled.
fn shape(
    page: &mut Page,
    centre: Position,
    number: usize,
    (colour, ground, fill): (&'static str, &str, Fill),
    size: f64,
) {
    let half = 0.5 * size;
    let inside = if fill == Fill::Filled { colour } else { ground };
    let stroke = Stroke::solid(colour, 0.35);
    if number == 0 {
        page.circle(centre, half, inside, &stroke);
    } else {
        let corners = SHAPES[(number - 1) % SHAPES.len()].iter();
        let corners = corners.map(|[x, y]| [centre[0] + half * x, centre[1] + half * y]);
        page.polygon(&corners.collect::<Vec<_>>(), inside, &stroke);
    }
    match fill {
        Fill::Half => {
            page.clip(centre.map(|end| end - 1.3 * half), [1.3 * half, 2.6 * half]);
            shape(page, centre, number, (colour, ground, Fill::Filled), size);
            page.close();
        }
        Fill::Crossed => cross(page, centre, &Stroke::solid(colour, 0.25), 0.55 * size),
        Fill::Filled | Fill::Open => {}
    }
}

/// Viridis (S. van der Walt, N. Smith; CC0) at 17 equal intervals, sRGB.
const VIRIDIS: [[f64; 3]; 17] = [
    [68.0, 1.0, 84.0],
    [72.0, 24.0, 106.0],
    [71.0, 45.0, 123.0],
    [66.0, 64.0, 134.0],
    [59.0, 82.0, 139.0],
    [51.0, 99.0, 141.0],
    [44.0, 114.0, 142.0],
    [38.0, 130.0, 142.0],
    [33.0, 145.0, 140.0],
    [31.0, 160.0, 136.0],
    [40.0, 174.0, 128.0],
    [63.0, 188.0, 115.0],
    [94.0, 201.0, 98.0],
    [132.0, 212.0, 75.0],
    [173.0, 220.0, 48.0],
    [216.0, 226.0, 25.0],
    [253.0, 231.0, 37.0],
];

/// Colour of a fraction (0 to 1) of the range of a map, and black or white for text on it.
pub fn map_colour(fraction: f64) -> (String, &'static str) {
    let mixed = viridis(fraction);
    let [red, green, blue] = mixed.map(libm::round);
    let letters = if luminance(mixed) > 0.2 { "#000000" } else { "#ffffff" };
    (format!("rgb({red},{green},{blue})"), letters)
}

/// The same colour as sRGB bytes.
pub fn map_rgb(fraction: f64) -> [u8; 3] {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
    viridis(fraction).map(|channel| libm::round(channel) as u8)
}

/// Fills a rectangle with the colours of a map, the lowest value at the left, or at the bottom of a rectangle that is higher
/// than wide.
pub fn colour_bar(page: &mut Page, corner: Position, size: [f64; 2]) {
    const STEPS: u8 = 64;
    let along = usize::from(size[1] > size[0]);
    let step = size[along] / f64::from(STEPS);
    for number in 0..STEPS {
        let (colour, _) = map_colour((f64::from(number) + 0.5) / f64::from(STEPS));
        let (mut at, mut piece) = (corner, size);
        let from = if along == 0 { number } else { STEPS - 1 - number };
        at[along] += f64::from(from) * step;
        // Each step overlaps the next one, so that no white line shows between them.
        let last = f64::from(from + 1) >= f64::from(STEPS);
        piece[along] = if last { step } else { 1.5 * step };
        page.fill(at, piece, &colour);
    }
    page.frame(corner, size, &AXIS);
}

/// Viridis at a fraction (0 to 1), sRGB channels from 0 to 255.
fn viridis(fraction: f64) -> [f64; 3] {
    let position = fraction.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 15")]
    let below = (position as usize).min(VIRIDIS.len() - 2);
    let rest = position - below as f64;
    std::array::from_fn(|channel| {
        VIRIDIS[below][channel] * (1.0 - rest) + VIRIDIS[below + 1][channel] * rest
    })
}

/// Relative luminance of an sRGB colour, 0 to 1. Source: WCAG 2.1.
fn luminance(colour: [f64; 3]) -> f64 {
    let [red, green, blue] = colour.map(|channel| {
        let c = channel / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
    });
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rgb(text: &str) -> [f64; 3] {
        let channel = |i| f64::from(u8::from_str_radix(&text[i..i + 2], 16).unwrap());
        [channel(1), channel(3), channel(5)]
    }

    #[test]
    fn the_first_20_series_differ_without_colour() {
        let styles = (0..20).map(Series::nth);
        let pairs: std::collections::BTreeSet<_> =
            styles.map(|series| (series.marker, series.dashes)).collect();
        assert_eq!(pairs.len(), 20);
    }

    #[test]
    fn values_of_two_parameters_give_colours_and_dashes() {
        for colours in [2, 7, 8, MAX_COLOURS] {
            let styles: Vec<Series> = (0..colours)
                .flat_map(|colour| {
                    (0..MAX_DASHES).map(move |dashes| Series::of_values((colour, colours), dashes))
                })
                .collect();
            for (index, style) in styles.iter().enumerate() {
                assert!(!styles[..index].contains(style), "{colours}: {style:?}");
            }
        }
        assert!(SEQUENCE.windows(2).all(|pair| luminance(rgb(pair[0])) < luminance(rgb(pair[1]))));
    }

    #[test]
    fn colours_differ_from_white_and_from_each_other() {
        let contrast = |a: f64, b: f64| (f64::max(a, b) + 0.05) / (f64::min(a, b) + 0.05);
        for (index, colour) in COLOURS.iter().enumerate() {
            assert!(contrast(luminance(rgb(colour)), 1.0) > 2.0, "{colour}");
            for other in &COLOURS[..index] {
                let apart: f64 =
                    (0..3).map(|channel| (rgb(colour)[channel] - rgb(other)[channel]).abs()).sum();
                assert!(apart > 75.0, "{colour} {other}");
            }
        }
    }

    #[test]
    fn map_colours_get_lighter_and_their_text_is_legible() {
        let mut last = -1.0;
        for step in 0..=200 {
            let (colour, letters) = map_colour(f64::from(step) / 200.0);
            let channels: Vec<f64> = colour[4..colour.len() - 1]
                .split(',')
                .map(|channel| channel.parse().unwrap())
                .collect();
            let light = luminance([channels[0], channels[1], channels[2]]);
            assert!(light > last - 0.002, "{colour}");
            last = light;
            let ink = luminance(rgb(letters));
            let contrast = (f64::max(ink, light) + 0.05) / (f64::min(ink, light) + 0.05);
            assert!(contrast >= 4.0, "{colour} {letters} {contrast}");
        }
        assert_eq!(map_colour(f64::INFINITY).0, map_colour(1.0).0);
    }
}
