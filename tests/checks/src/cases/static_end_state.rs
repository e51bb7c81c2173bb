//! The end state of the capsule: a cone with circular caps, a free body at a fixed pressure, against
//! the axisymmetric tension field.
//!
//! Differences between two pressures are judged on a mesh along the meridians. Elements of the fold
//! pattern's mesh lie oblique to the tension of the wrinkled film: its sizes are near those of the
//! table, but the mesh error is larger than the small differences, which are notes there.

use billow_solver::geometry::fold::{Caps, FoldDesign, FoldPattern};
use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::geometry::shell::Shell;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::paper::{self, free_film};
use billow_solver::statics::StaticSolution;
use nalgebra::Vector3;

use super::reference::{entry, number, numbers, rows};
use super::shapes::capped_frustum;
use super::static_equilibrium::{equilibrium_from, mean};
use super::{Outcome, Rig, Row};

/// The paper's design with circular caps on this mesh.
fn design(subdivisions: u32) -> FoldDesign {
    FoldDesign { caps: Caps::Circular, ..paper::design(subdivisions) }
}

/// A shell with its rims and poles.
struct Marked {
    shell: Shell,
    rims: [Vec<u32>; 2],
    poles: [u32; 2],
}

/// Volume, rim radii, height between rims and between poles.
fn sizes(state: &StaticSolution, marked: &Marked) -> [f64; 5] {
    let [low, high] = &marked.rims;
    let middle = |rim: &[u32]| {
        Vector3::new(
            mean(state, rim, |x| x.x),
            mean(state, rim, |x| x.y),
            mean(state, rim, |x| x.z),
        )
    };
    let centres = [middle(low), middle(high)];
    let radius = |rim: usize| mean(state, &marked.rims[rim], |x| (x - centres[rim]).xy().norm());
    let pole = marked.poles.map(|node| state.positions.get(node as usize));
    [
        state.volume,
        radius(0),
        radius(1),
        (centres[1] - centres[0]).norm(),
        (pole[1] - pole[0]).norm(),
    ]
}

/// Sizes at both pressures in the order of the table, and a note on the cost. The higher pressure is
/// solved first, the lower one from it.
fn inflate(rig: &Rig, marked: &Marked) -> Result<([[f64; 5]; 2], String), String> {
    let pressures = rows("end_state").into_iter().rev().map(|row| row[0]);
    let (mut found, mut last): (Vec<[f64; 5]>, Option<(StaticSolution, f64)>) = (Vec::new(), None);
    let mut notes = Vec::new();
    for pressure in pressures {
        let filling = Filling::Pressure(pressure);
        let scene = FilmScene { filling, ..free_film(marked.shell.clone(), Film::PAPER_ELASTIC) };
        let start = last.as_ref().map(|(state, pressure)| (state, *pressure));
        let (state, note) = equilibrium_from(rig, &scene, start)?;
        found.push(sizes(&state, marked));
        notes.push(note);
        last = Some((state, pressure));
    }
    Ok(([found[1], found[0]], notes.join(", ")))
}

/// Rows of three meshes against the table; differences between the pressures are judged, or notes.
fn judge(rig: &Rig, meshes: &[Marked; 3], differences: bool) -> Outcome {
    let (rows, bands) = (rows("end_state"), numbers("end_state/bands"));
    let difference_band = number("end_state/difference_band");
    let mut found = Vec::new();
    let mut notes = Vec::new();
    for marked in meshes {
        let (sizes, note) = inflate(rig, marked)?;
        found.push(sizes);
        notes.push(note);
    }
    let names = [
        "volume, m3",
        "bottom rim radius, m",
        "top rim radius, m",
        "rim to rim height, m",
        "pole to pole height, m",
    ];
    let mut judged = Vec::new();
    for (index, name) in names.into_iter().enumerate() {
        for (which, row) in rows.iter().enumerate() {
            let values = [0, 1, 2].map(|mesh: usize| found[mesh][which][index]);
            let quantity = format!("{name}, at {} Pa", row[0]);
            judged.push(Row::refined(&quantity, values, row[1 + index], bands[index]));
        }
        let expected = rows[1][1 + index] - rows[0][1 + index];
        let values = [0, 1, 2].map(|mesh: usize| found[mesh][1][index] - found[mesh][0][index]);
        if differences {
            let name = format!("{name}, {} less {} Pa", rows[1][0], rows[0][0]);
            let row = Row::refined(&name, values, expected, difference_band);
            judged.push(row.with_note(&notes[2]));
        } else if let Some(row) = judged.pop() {
            let [a, b, c] = values.map(|value| value / expected - 1.0);
            let note =
                format!("errors of the difference between pressures {a:.2e} {b:.2e} {c:.2e}");
            judged.push(row.with_note(&note).with_note(&notes[2]));
        }
    }
    Ok(judged)
}

/// Circular caps, on the mesh of the fold pattern.
pub fn pattern(rig: &Rig) -> Outcome {
    judge(rig, &[pattern_mesh(8)?, pattern_mesh(16)?, pattern_mesh(32)?], false)
}

/// The mesh of the fold pattern, erected.
fn pattern_mesh(subdivisions: u32) -> Result<Marked, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let pattern = FoldPattern::new(&design(subdivisions)).map_err(|e| text(&e))?;
    let mesh = Mesh::new(&pattern, subdivisions, Shape::Erected).map_err(|e| text(&e))?;
    Ok(Marked {
        shell: Shell::of_mesh(&mesh),
        rims: [mesh.bottom_ring.clone(), mesh.top_ring.clone()],
        poles: [mesh.bottom_centre, mesh.top_centre],
    })
}

/// Circular caps, on a mesh along the meridians.
pub fn aligned(rig: &Rig) -> Outcome {
    let [bottom, top, height] = entry("end_state", ["bottom_radius", "top_radius", "height"]);
    let meshes = [8, 16, 32].map(|fine| {
        let capped = capped_frustum(fine, [bottom, top], height);
        Marked { shell: capped.shell, rims: capped.rims, poles: capped.poles }
    });
    judge(rig, &meshes, true)
}
