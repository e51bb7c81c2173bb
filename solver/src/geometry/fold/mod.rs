//! The six-fold-line pattern of a conical shell (paper, section 2).
//!
//! A cone of bottom radius r2, top radius r1 and height H has the half top angle φh,
//! tan φh = (r2 − r1)/H. Developed, it is a sector whose ring of radius r lies at R = r / sin φh
//! (Eq. 2). N panels in a ring, M storeys; θ1 = 2π sin φh/N is the sector angle of a panel, θ2 the
//! rotation of the inner ring relative to the outer one.
//!
//! ```text
//!        D ───────── E          inner ring, radius ρ R, rotated by θ2
//!         \  α2.·'    \
//!       AD \ .·'AE     \ BE     ϕ  = between the radial line at A and AD
//!          .·' α1       \       β1 = ∠DAE,  α1 = ∠EAB
//!        A ───────────── B      outer ring, radius R
//!
//!   ϕ + β1 + α1 = π/2 − θ1/2     (Eqs. 3, 6)       α2 = α1 − θ2             (Eq. 9)
//!   β2 = π/2 + θ1/2 − α1 − ϕ     (Eq. 5)           γ1 = π/2 − θ1/2 + ϕ      (Eq. 4)
//!   γ2 = π/2 + θ1/2 + θ2 + ϕ     (Eq. 7)           β1 − α1 = β2 − α2 − (θ1 + θ2)   (Eqs. 10, 11)
//!   α1 + ϕ = π/2 − π/N           (closure, Eq. 14)
//! ```
//!
//! With closure, N, ϕ and φh determine the ring ratio ρ = `R_inner`/`R_outer`, the same in every storey.
//! The top radius of M storeys is r2 ρ^M, so α1/ϕ cannot be varied on a given cone. A design therefore
//! chooses one of three [`Fit`]s.

use serde::{Deserialize, Serialize};

mod angles;
mod creases;
mod fit;
mod nearest;
mod packed;
mod pattern;
mod scan;
mod states;

pub use angles::PanelAngles;
pub use creases::{Assignment, Crease};
pub use pattern::{FoldPattern, Lengths};
pub use states::{Corner, Facet, Polygon};

/// Which of the coupled quantities are given; the others follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fit {
    /// r1, r2, H, N, M given; ϕ is solved.
    Cone,
    /// r2, half angle (itself, or from a nominal r1 and H), N, M, α1/ϕ given; r1 and H follow.
    Angles,
    /// r2, H, N, M, α1/ϕ given; the half angle is solved, r1 follows.
    Height,
}

/// Twist directions of successive storeys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Chirality {
    /// All storeys twist in the same direction.
    Same,
    /// Storeys twist in alternate directions.
    Alternate,
}

/// Shape of the end caps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Caps {
    /// Flat N-gons joined to the ring fold lines.
    Polygon,
    /// Circular discs, for the erected shape only: a disc cannot be joined to a flat-folded N-gon
    /// without strain.
    Circular,
}

/// A requested fold design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FoldDesign {
    /// Which quantities are given.
    pub fit: Fit,
    /// N, number of panels in a ring, at least 4.
    #[serde(rename = "N")]
    pub panels: u32,
    /// M, number of storeys, at least 1.
    #[serde(rename = "M")]
    pub storeys: u32,
    /// r2, radius of the bottom ring, m.
    pub bottom_radius: f64,
    /// r1, radius of the top ring, m: given for `cone`, nominal for `angles`.
    pub top_radius: Option<f64>,
    /// H, height of the erected cone, m: given for `cone` and `height`, nominal for `angles`.
    pub height: Option<f64>,
    /// φh, half top angle, rad: `angles` only, instead of `top_radius` and `height`.
    pub half_angle: Option<f64>,
    /// α1/ϕ: given for `angles` and `height`.
    pub alpha1_over_phi: Option<f64>,
    /// Twist directions of successive storeys.
    pub chirality: Chirality,
    /// Height of the stowed stack, m.
    pub stowed_height: f64,
    /// n, number of mesh subdivisions of every facet edge.
    pub subdivisions: u32,
    /// Shape of the caps.
    pub caps: Caps,
}

impl FoldDesign {
    /// Number of elements of its mesh, 2 N (M + 1) n².
    pub fn elements(&self) -> u64 {
        let [panels, storeys, n] = [self.panels, self.storeys, self.subdivisions].map(u64::from);
        2 * panels * (storeys + 1) * n * n
    }
}

/// A change of one key that makes an infeasible design feasible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Key of [`crate::geometry::fold::FoldDesign`], as in JSON.
    pub key: &'static str,
    /// Nearest feasible value, SI.
    pub value: f64,
}

/// Why a design has no pattern.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FoldError {
    /// A value is out of range, missing, or contradicts another.
    #[error("{key}: {problem}")]
    Invalid {
        /// Key of [`FoldDesign`], as in JSON.
        key: &'static str,
        /// What is wrong and what is allowed.
        problem: String,
    },
    /// The request is valid, but no pattern fits it. This is a result, not an input error.
    #[error("infeasible: {reason}")]
    Infeasible {
        /// Why.
        reason: String,
        /// Nearest feasible values, each for a change of its key alone.
        nearest: Vec<Nearest>,
    },
}

impl FoldPattern {
    /// Solves a design.
    ///
    /// # Errors
    /// [`FoldError::Invalid`] for a value out of range or a contradiction,
    /// [`FoldError::Infeasible`] where no pattern fits.
    pub fn new(design: &FoldDesign) -> Result<Self, FoldError> {
        fit::check(design)?;
        if let Some(reason) = fit::infeasibility(design) {
            return Err(FoldError::Infeasible {
                reason,
                nearest: nearest::feasible_values(design),
            });
        }
        Self::close(design)
    }
}
