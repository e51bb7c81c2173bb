//! The end state of the capsule: a cone with circular caps, a free body at a fixed pressure, against the axisymmetric
//! tension field; of the paper's film and of compliant film.
//!
//! Differences between two pressures are judged on a mesh along the meridians. Elements of the fold
//! pattern's mesh lie oblique to the tension of the wrinkled film: its sizes are near those of the
//! table, but the mesh error is larger than the small differences.

use billow_solver::geometry::fold::{Caps, FoldDesign, FoldPattern};
use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::statics::StaticSolution;

use super::prelude::*;
use super::shapes::{CappedFrustum, capped_frustum};

/// Names of the sizes, in the order of the table.
const SIZES: [&str; 5] = [
    "volume, m3",
    "bottom rim radius, m",
    "top rim radius, m",
    "rim to rim height, m",
    "pole to pole height, m",
];

/// Volume, rim radii, height between rims and between poles.
fn sizes(state: &StaticSolution, capsule: &CappedFrustum) -> [f64; 5] {
    let middle = |rim: &Vec<u32>| {
        let along = [0, 1, 2].map(|axis: usize| mean(state, rim, |x| x[axis]));
        Vector3::from(along)
    };
    let centres = capsule.rims.each_ref().map(middle);
    let radius = |rim: usize| mean(state, &capsule.rims[rim], |x| (x - centres[rim]).xy().norm());
    let pole = state.positions.at(capsule.poles);
    [
        state.volume,
        radius(0),
        radius(1),
        (centres[1] - centres[0]).norm(),
        (pole[1] - pole[0]).norm(),
    ]
}

/// Sizes at both pressures of the table. The higher pressure is solved first, the lower one from it.
fn inflate(rig: &Rig, capsule: &CappedFrustum) -> Result<[[f64; 5]; 2]> {
    let pressures = rows("end_state").into_iter().rev().map(|row| row[0]);
    let mut found = Vec::new();
    let mut last: Option<(StaticSolution, f64)> = None;
    for pressure in pressures {
        let filling = Filling::Pressure(pressure);
        let scene = FilmScene { filling, ..free_film(capsule.shell.clone(), Film::PAPER_ELASTIC) };
        let start = last.as_ref().map(|(state, pressure)| (state, *pressure));
        let state = equilibrium(rig, &scene, start)?;
        found.push(sizes(&state, capsule));
        last = Some((state, pressure));
    }
    Ok([found[1], found[0]])
}

/// Rows of three meshes against the table, and of the differences between its pressures if they are judged.
fn judge(rig: &Rig, mesh: impl Fn(u32) -> Result<CappedFrustum>, differences: bool) -> Outcome {
    let (rows, bands) = (rows("end_state"), numbers("end_state/bands"));
    let band = if differences { number("end_state/difference_band") } else { f64::INFINITY };
    let quantities: [(String, f64, f64); 15] = core::array::from_fn(|index| {
        let (size, [low, high]) = (index % 5, [0, 1].map(|row: usize| rows[row][1 + index % 5]));
        let at = |row: usize| format!("{}, at {} Pa", SIZES[size], rows[row][0]);
        match index / 5 {
            0 => (at(0), low, bands[size]),
            1 => (at(1), high, bands[size]),
            _ => (
                format!("{}, {} less {} Pa", SIZES[size], rows[1][0], rows[0][0]),
                high - low,
                band,
            ),
        }
    });
    let mut judged = refined([8, 16, 32], quantities, None, |fine| {
        let [low, high] = inflate(rig, &mesh(fine)?)?;
        Ok(core::array::from_fn(|index| match index {
            0..5 => low[index],
            5..10 => high[index - 5],
            _ => high[index - 10] - low[index - 10],
        }))
    })?;
    judged.truncate(if differences { 15 } else { 10 });
    Ok(judged)
}

/// On a mesh along the meridians.
pub fn aligned(rig: &Rig) -> Outcome {
    let [bottom, top, height] = entry("end_state", ["bottom_radius", "top_radius", "height"]);
    judge(rig, |fine| Ok(capped_frustum(fine, [bottom, top], height)), true)
}

/// On the mesh of the fold pattern, erected.
pub fn pattern(rig: &Rig) -> Outcome {
    let mesh = |subdivisions: u32| {
        let design = FoldDesign { caps: Caps::Circular, ..paper::design(subdivisions) };
        let pattern = FoldPattern::new(&design)?;
        let mesh = Mesh::new(&pattern, subdivisions, Shape::Erected);
        let mesh = mesh?;
        Ok(CappedFrustum {
            shell: Shell::of_mesh(&mesh),
            rims: [mesh.bottom_ring.clone(), mesh.top_ring.clone()],
            poles: [mesh.bottom_centre, mesh.top_centre],
        })
    };
    judge(rig, mesh, false)
}

/// Volume and heights of the capsule of compliant film.
pub fn compliant_capsule(rig: &Rig) -> Outcome {
    let [bottom, top, height] = entry("compliant", ["bottom_radius", "top_radius", "height"]);
    let band = number("compliant/band");
    each("compliant/capsule", |row| {
        let (film, pressure, name) = compliant(&row);
        let quantities = [(0, row[3]), (3, row[4]), (4, row[5])]
            .map(|(size, value): (usize, f64)| (format!("{}, {name}", SIZES[size]), value, band));
        refined([4, 8, 16], quantities, None, |fine| {
            let capsule = capped_frustum(fine, [bottom, top], height);
            let state = inflated(rig, capsule.shell.clone(), film, pressure, Vec::new())?;
            let [volume, _, _, rims, poles] = sizes(&state, &capsule);
            Ok([volume, rims, poles])
        })
    })
}
