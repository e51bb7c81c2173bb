//! The three fits: solves ϕ and the half angle φh of a design.
//!
//! All of them use one function, the height of M storeys on a bottom ring of radius r2,
//!
//! ```text
//! H(ϕ, φh) = r2 cos φh · u(ϕ, φh) · (1 + ρ + … + ρ^(M−1)),    u = (1 − ρ)/sin φh
//! ```
//!
//! which decreases with ϕ (from its maximum at ϕ → 0 to 0 at α1 → 0) and with φh.

use core::f64::consts::{FRAC_PI_2, PI};

use super::{Fit, FoldDesign, FoldError, PanelAngles};

/// ϕ and half angle of a design, rad.
pub(super) struct Solved {
    pub(super) phi: f64,
    pub(super) half_angle: f64,
}

/// Solves a design that passed [`check`] and has no [`infeasibility`].
pub(super) fn solve(design: &FoldDesign) -> Solved {
    match design.fit {
        Fit::Cone => {
            let (half_angle, height) = nominal_cone(design);
            let phi = decreasing_root(0.0, max_phi(design), |phi| {
                storeys_height(design, phi, half_angle) - height
            });
            Solved { phi, half_angle }
        }
        Fit::Angles => Solved { phi: phi_of_ratio(design), half_angle: nominal_cone(design).0 },
        Fit::Height => {
            let phi = phi_of_ratio(design);
            let height = given(design.height);
            let half_angle = if storeys_height(design, phi, 0.0) <= height {
                0.0 // a smaller height is an `infeasibility`
            } else {
                decreasing_root(0.0, FRAC_PI_2, |half_angle| {
                    storeys_height(design, phi, half_angle) - height
                })
            };
            Solved { phi, half_angle }
        }
    }
}

/// Why no pattern fits a design; `None` where one does. Needs no root search.
pub(super) fn infeasibility(design: &FoldDesign) -> Option<String> {
    let (tallest, height) = height_shortfall(design)?;
    let storeys = if design.storeys == 1 { "storey" } else { "storeys" };
    let stack = format!("{} {storeys} of {} panels", design.storeys, design.panels);
    Some(match design.fit {
        Fit::Cone => format!(
            "{stack} on this cone reach at most {tallest:.4} m (phi towards 0), the cone is \
             {height:.4} m high: no phi closes on the top radius"
        ),
        Fit::Angles | Fit::Height => format!(
            "{stack} at this alpha1_over_phi reach at most {tallest:.4} m (as a cylinder), \
             {height:.4} m is requested: no half angle of 0 or more closes"
        ),
    })
}

/// The maximum height a design can reach and its requested height, m; `None` where the design reaches
/// it.
pub(super) fn height_shortfall(design: &FoldDesign) -> Option<(f64, f64)> {
    match design.fit {
        Fit::Cone => {
            let (half_angle, height) = nominal_cone(design);
            let (slant, ratio) = PanelAngles::tallest(design.panels, half_angle);
            let tallest = stack_height(design, half_angle, slant, ratio);
            (tallest <= height).then_some((tallest, height))
        }
        Fit::Angles => None,
        Fit::Height => {
            let tallest = storeys_height(design, phi_of_ratio(design), 0.0);
            let height = given(design.height);
            (tallest < height).then_some((tallest, height))
        }
    }
}

/// Checks that every value is in range, and that exactly the values of the fit are given.
pub(super) fn check(design: &FoldDesign) -> Result<(), FoldError> {
    let invalid = |key, problem: String| Err(FoldError::Invalid { key, problem });
    if !(MIN_PANELS..=MAX_COUNT).contains(&design.panels) {
        return invalid(
            "N",
            format!("{} panels; allowed: {MIN_PANELS} to {MAX_COUNT}", design.panels),
        );
    }
    if !(1..=MAX_COUNT).contains(&design.storeys) {
        return invalid("M", format!("{} storeys; allowed: 1 to {MAX_COUNT}", design.storeys));
    }
    if !(1..=MAX_COUNT).contains(&design.subdivisions) {
        return invalid(
            "subdivisions",
            format!("{}; allowed: 1 to {MAX_COUNT}", design.subdivisions),
        );
    }
    for (key, value) in [
        ("bottom_radius", Some(design.bottom_radius)),
        ("top_radius", design.top_radius),
        ("height", design.height),
        ("alpha1_over_phi", design.alpha1_over_phi),
        ("stowed_height", Some(design.stowed_height)),
    ] {
        if let Some(value) = value
            && !(value.is_finite() && value > 0.0)
        {
            let hint = if key == "top_radius" && value == 0.0 {
                " (a pointed cone has no top ring to fold)"
            } else {
                ""
            };
            return invalid(key, format!("{value} is not a positive number{hint}"));
        }
    }
    if let Some(half_angle) = design.half_angle
        && half_angle.abs().partial_cmp(&FRAC_PI_2) != Some(core::cmp::Ordering::Less)
    {
        return invalid("half_angle", format!("{half_angle} rad; allowed: between −π/2 and π/2"));
    }
    check_given(design)
}

/// Maximum number of panels, storeys and subdivisions. Chosen: above any capsule, and small enough that
/// counts of nodes and elements do not overflow.
const MAX_COUNT: u32 = 1000;

/// Minimum number of panels. Chosen: the pattern is tested from four panels on.
const MIN_PANELS: u32 = 4;

fn check_given(design: &FoldDesign) -> Result<(), FoldError> {
    let given = [
        ("top_radius", design.top_radius.is_some()),
        ("height", design.height.is_some()),
        ("half_angle", design.half_angle.is_some()),
        ("alpha1_over_phi", design.alpha1_over_phi.is_some()),
    ];
    let nominal = design.half_angle.is_none();
    // In the order of `given`: whether the fit needs the key. A key it does not need is refused.
    let (name, needed, why) = match design.fit {
        Fit::Cone => (
            "cone",
            [true, true, false, false],
            "fit `cone` solves phi from top_radius and height, and that fixes the half angle and \
             alpha1/phi; leave it out, or choose fit `angles` or `height`",
        ),
        Fit::Angles => (
            "angles",
            [nominal, nominal, !nominal, true],
            "fit `angles` takes the half angle either itself or from a nominal top_radius and \
             height, not both; top_radius and height of the pattern follow",
        ),
        Fit::Height => (
            "height",
            [false, true, false, true],
            "fit `height` solves the half angle from height and alpha1_over_phi, and top_radius \
             follows; leave it out, or choose fit `cone` or `angles`",
        ),
    };
    for ((key, present), needed) in given.into_iter().zip(needed) {
        let problem = match (present, needed) {
            (false, true) if name == "angles" && key != "alpha1_over_phi" => {
                "missing: fit `angles` needs half_angle, or a nominal top_radius and height".into()
            }
            (false, true) => format!("missing: fit `{name}` needs it"),
            (true, false) => format!("given, but {why}"),
            _ => continue,
        };
        return Err(FoldError::Invalid { key, problem });
    }
    Ok(())
}

/// Half angle (rad) and height (m) of the cone of a `cone` or `angles` design. The height is NaN, and
/// unused, where `angles` gives the half angle itself.
fn nominal_cone(design: &FoldDesign) -> (f64, f64) {
    if let Some(half_angle) = design.half_angle {
        return (half_angle, f64::NAN);
    }
    let height = given(design.height);
    (libm::atan2(design.bottom_radius - given(design.top_radius), height), height)
}

/// A value that [`check`] requires to be given.
fn given(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}

/// Upper bound of ϕ, rad: π/2 − π/N = α1 + ϕ (Eq. 14).
fn max_phi(design: &FoldDesign) -> f64 {
    FRAC_PI_2 - PI / f64::from(design.panels)
}

fn phi_of_ratio(design: &FoldDesign) -> f64 {
    max_phi(design) / (1.0 + given(design.alpha1_over_phi))
}

fn storeys_height(design: &FoldDesign, phi: f64, half_angle: f64) -> f64 {
    let angles = PanelAngles::closing(design.panels, phi, half_angle);
    stack_height(design, half_angle, angles.unit_slant, angles.ring_ratio)
}

fn stack_height(design: &FoldDesign, half_angle: f64, slant: f64, ratio: f64) -> f64 {
    design.bottom_radius * libm::cos(half_angle) * slant * geometric_sum(ratio, design.storeys)
}

/// 1 + ρ + … + ρ^(terms−1).
pub(super) fn geometric_sum(ratio: f64, terms: u32) -> f64 {
    (0..terms).fold(0.0, |sum, _| 1.0 + ratio * sum)
}

/// The root of a function that is positive at `low` and negative at `high`, by bisection to the last
/// bit.
fn decreasing_root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
}
