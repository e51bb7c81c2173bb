//! The fold lines of the lateral film and their fold directions.
//!
//! Seen from outside, ring lines and panel sides AD are mountains (they fold outward), diagonals AE are
//! valleys (they fold inward): four mountains and two valleys at every interior vertex. The bottom ring,
//! the top ring and the seam along the side of the first panel are the boundary of the sheet.

use super::{Corner, FoldPattern};

/// Fold direction of a line of the pattern, seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Assignment {
    /// The crest points outward.
    Mountain,
    /// The crest points inward.
    Valley,
    /// Boundary of the sheet: bottom ring, top ring, seam.
    Boundary,
}

/// One line of the crease pattern; the sheet is cut open along the seam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crease {
    /// Its ends; corner N of a ring is corner 0 across the seam.
    pub ends: [Corner; 2],
    /// Fold direction.
    pub assignment: Assignment,
}

impl FoldPattern {
    /// Every line of the sheet once: for each ring its lines, then the sides and the diagonals of the
    /// storey above it.
    pub fn creases(&self) -> Vec<Crease> {
        let (panels, storeys) = (self.design.panels, self.design.storeys);
        let mut creases = Vec::new();
        for ring in 0..=storeys {
            let boundary = ring == 0 || ring == storeys;
            for corner in 0..panels {
                creases.push(Crease {
                    ends: [corner, corner + 1].map(|corner| Corner { ring, corner }),
                    assignment: if boundary { Assignment::Boundary } else { Assignment::Mountain },
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
                let (from, to) = if self.twist_sign(ring) > 0.0 {
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

    /// The polar angle on the erected cone, rad, that is drawn as the vertical centre line of the sheet.
    pub fn sheet_middle(&self) -> f64 {
        let storeys = self.design.storeys;
        let corner = |ring, corner| self.erected_angle(Corner { ring, corner });
        let panels = self.design.panels;
        0.25 * (corner(0, 0) + corner(0, panels) + corner(storeys, 0) + corner(storeys, panels))
    }
}
