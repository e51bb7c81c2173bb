//! Outcomes of runs: each has a ground, a shape and the colour of what is drawn on it. Grounds are those of Okabe and
//! Ito, which colour-blind readers can distinguish; shapes distinguish outcomes in black and white.

use super::marker::draw_shape;
use super::{Fill, MARKER_SIZE};
use crate::render::page::{Page, Position, Stroke};

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// It reached its end.
    Done,
    /// A step was unstable.
    Unstable,
    /// Film stretched beyond its law.
    Overstretched,
    /// The energy ledger does not close.
    EnergyDrift,
    /// No volume.
    InvertedVolume,
    /// Too many steps, or too short ones.
    StepLimit,
    /// Film in film.
    Interpenetrated,
    /// The state contradicts itself.
    Inconsistent,
    /// No static equilibrium.
    NoEquilibrium,
    /// Refused before it began.
    Refused,
    /// Any other end.
    Other,
}

/// The look of an outcome.
struct Look {
    ground: &'static str,
    ink: &'static str,
    shape: Shape,
}

/// What is drawn on the ground.
enum Shape {
    /// A marker of this number, filled.
    Marker(usize),
    /// A small circle.
    Dot,
    /// A diagonal cross.
    Cross,
    /// A bar.
    Bar,
}

impl Outcome {
    /// Every outcome.
    pub const ALL: [Self; 11] = [
        Self::Done,
        Self::Unstable,
        Self::Overstretched,
        Self::EnergyDrift,
        Self::InvertedVolume,
        Self::StepLimit,
        Self::Interpenetrated,
        Self::Inconsistent,
        Self::NoEquilibrium,
        Self::Refused,
        Self::Other,
    ];

    fn look(self) -> Look {
        let (ground, shape) = match self {
            Self::Done => ("#f3f3f3", Shape::Dot),
            Self::Unstable => ("#d55e00", Shape::Cross),
            Self::Overstretched => ("#009e73", Shape::Marker(1)),
            Self::EnergyDrift => ("#e69f00", Shape::Marker(2)),
            Self::InvertedVolume => ("#cc79a7", Shape::Marker(4)),
            Self::StepLimit => ("#56b4e9", Shape::Marker(6)),
            Self::Interpenetrated => ("#0072b2", Shape::Marker(3)),
            Self::Inconsistent => ("#8c510a", Shape::Marker(0)),
            Self::NoEquilibrium => ("#f0e442", Shape::Marker(5)),
            Self::Refused => ("#b0b0b0", Shape::Bar),
            Self::Other => ("#000000", Shape::Cross),
        };
        let dark = matches!(self, Self::Interpenetrated | Self::Inconsistent | Self::Other);
        Look { ground, ink: if dark { "#ffffff" } else { "#000000" }, shape }
    }

    /// Colour of the ground.
    pub fn ground(self) -> &'static str {
        self.look().ground
    }

    /// Colour of texts on the ground.
    pub fn ink(self) -> &'static str {
        self.look().ink
    }

    /// Draws the shape.
    pub fn draw(self, page: &mut Page, centre: Position) {
        let Look { ink, shape, .. } = self.look();
        let arm = 0.42 * MARKER_SIZE;
        let stroke = Stroke::solid(ink, 0.5);
        let [x, y] = centre;
        match shape {
            Shape::Marker(number) => {
                draw_shape(page, centre, number, ink, (ink, Fill::Filled), MARKER_SIZE);
            }
            Shape::Dot => page.circle(centre, 0.22 * MARKER_SIZE, ink, &Stroke::solid(ink, 0.1)),
            Shape::Cross => {
                page.line([x - arm, y - arm], [x + arm, y + arm], &stroke);
                page.line([x - arm, y + arm], [x + arm, y - arm], &stroke);
            }
            Shape::Bar => page.line([x - arm, y], [x + arm, y], &stroke),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::figure::style::tests::{luminance_of, rgb};

    #[test]
    fn texts_are_legible_on_every_ground_and_grounds_differ() {
        for (index, outcome) in Outcome::ALL.into_iter().enumerate() {
            let [ground, ink] = [outcome.ground(), outcome.ink()].map(luminance_of);
            let contrast = (f64::max(ground, ink) + 0.05) / (f64::min(ground, ink) + 0.05);
            assert!(contrast >= 4.5, "{outcome:?} {contrast}");
            for other in &Outcome::ALL[..index] {
                let apart: f64 = rgb(outcome.ground())
                    .iter()
                    .zip(rgb(other.ground()))
                    .map(|(a, b)| (a - b).abs())
                    .sum();
                assert!(apart > 75.0, "{outcome:?} {other:?}");
            }
        }
    }

    #[test]
    fn shapes_differ() {
        let drawn = Outcome::ALL.map(|outcome| {
            let mut page = Page::new();
            outcome.draw(&mut page, [5.0, 5.0]);
            page.finish(10.0, 10.0, "").replace("#ffffff", "#000000")
        });
        // Unstable and any other end have the same cross on grounds of orange and black.
        let different: std::collections::BTreeSet<&String> = drawn.iter().collect();
        assert_eq!(different.len(), Outcome::ALL.len() - 1);
    }
}
