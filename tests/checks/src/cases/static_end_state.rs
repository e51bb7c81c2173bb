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
    let pole = capsule.poles.map(|node| state.positions.get(node as usize));
    [
        state.volume,
        radius(0),
        radius(1),
        (centres[1] - centres[0]).norm(),
        (pole[1] - pole[0]).norm(),
    ]
}

/// Sizes at both pressures of the table. The higher pressure is solved first, the lower one from it.
fn inflate(rig: &Rig, capsule: &CappedFrustum) -> Result<[[f64; 5]; 2], String> {
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
fn judge(
    rig: &Rig,
    mesh: impl Fn(u32) -> Result<CappedFrustum, String>,
    differences: bool,
) -> Outcome {
    let (rows, bands) = (rows("end_state"), numbers("end_state/bands"));
    let mut names = Vec::new();
    for (which, row) in rows.iter().enumerate() {
        let at = |index: usize| format!("{}, at {} Pa", SIZES[index], row[0]);
        names.extend((0..5).map(|index| (at(index), rows[which][1 + index], bands[index])));
    }
    let band = if differences { number("end_state/difference_band") } else { f64::INFINITY };
    let name = |index: usize| format!("{}, {} less {} Pa", SIZES[index], rows[1][0], rows[0][0]);
    names.extend((0..5).map(|index| (name(index), rows[1][1 + index] - rows[0][1 + index], band)));
    let quantities: [(&str, f64, f64); 15] = core::array::from_fn(|index| {
        let (name, expected, band) = &names[index];
        (&**name, *expected, *band)
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
        let pattern = FoldPattern::new(&design).map_err(|error| error.to_string())?;
        let mesh = Mesh::new(&pattern, subdivisions, Shape::Erected);
        let mesh = mesh.map_err(|error| error.to_string())?;
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
    let mut judged = Vec::new();
    for row in rows("compliant/capsule") {
        let (film, pressure, name) = compliant(&row);
        let names = [0, 3, 4].map(|index: usize| format!("{}, {name}", SIZES[index]));
        let quantities = [0, 1, 2].map(|index| (&*names[index], row[3 + index], band));
        judged.extend(refined([4, 8, 16], quantities, None, |fine| {
            let capsule = capped_frustum(fine, [bottom, top], height);
            let state = inflated(rig, capsule.shell.clone(), film, pressure, Vec::new())?;
            let [volume, _, _, rims, poles] = sizes(&state, &capsule);
            Ok([volume, rims, poles])
        })?);
    }
    Ok(judged)
}
