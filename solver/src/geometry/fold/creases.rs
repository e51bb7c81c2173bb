//! The fold lines of the lateral film and how each folds.
//!
//! Seen from outside, ring lines and panel sides AD fold outward (mountain), diagonals AE inward
//! (valley): four mountains and two valleys at every interior vertex. The bottom and top ring and
//! the seam along the first panel's side are the edge of the sheet.

use super::{Corner, FoldPattern};

/// How a line of the pattern folds, seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Assignment {
    /// The crest points outward.
    Mountain,
    /// The crest points inward.
    Valley,
    /// Edge of the sheet: bottom ring, top ring, seam.
    Boundary,
}

/// One line of the crease pattern, as a sheet cut open along the seam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crease {
    /// Its ends; corner N of a ring is corner 0 across the seam.
    pub ends: [Corner; 2],
    /// How it folds.
    pub assignment: Assignment,
}

impl FoldPattern {
    /// Every line of the sheet, once: ring by ring the ring's lines, then the sides and diagonals of
    /// the storey above it.
    pub fn creases(&self) -> Vec<Crease> {
        let (panels, storeys) = (self.design.panels, self.design.storeys);
        let mut creases = Vec::new();
        for ring in 0..=storeys {
            let rim = ring == 0 || ring == storeys;
            for corner in 0..panels {
                creases.push(Crease {
                    ends: [corner, corner + 1].map(|corner| Corner { ring, corner }),
                    assignment: if rim { Assignment::Boundary } else { Assignment::Mountain },
                });
            }
            if ring == storeys {
                break;
            }
            for corner in 0..=panels {
                let seam = corner == 0 || corner == panels;
                creases.push(Crease {
                    ends: [Corner { ring, corner }, Corner { ring: ring + 1, corner }],
                    assignment: if seam { Assignment::Boundary } else { Assignment::Mountain },
                });
            }
            for panel in 0..panels {
                let (from, to) = if self.turn_sign(ring) > 0.0 {
                    (panel, panel + 1)
                } else {
                    (panel + 1, panel)
                };
                creases.push(Crease {
                    ends: [Corner { ring, corner: from }, Corner { ring: ring + 1, corner: to }],
                    assignment: Assignment::Valley,
                });
            }
        }
        creases
    }

    /// The polar angle on the erected cone about which the sheet is drawn upright.
    pub fn sheet_middle(&self) -> f64 {
        let storeys = self.design.storeys;
        let corner = |ring, corner| self.erected_angle(Corner { ring, corner });
        let panels = self.design.panels;
        0.25 * (corner(0, 0) + corner(0, panels) + corner(storeys, 0) + corner(storeys, panels))
    }
}
