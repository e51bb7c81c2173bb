//! The end state of the capsule: its cone with circular caps, a free body inflated at a fixed pressure,
//! against the axisymmetric tension field.
//!
//! It is judged on a mesh along its meridians. On the pattern's own mesh the elements lie aslant to
//! the tension of wrinkled caps and side; its sizes come near the table's, but the small differences
//! between two pressures drown in what the mesh does to each: they are told there, not judged.

use billow_solver::geometry::fold::{Caps, FoldDesign, FoldPattern};
use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::geometry::shapes::capped_frustum;
use billow_solver::geometry::shell::Shell;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::paper::{self, free_film};
use billow_solver::statics::StaticSolution;
use nalgebra::Vector3;

use super::reference::{number, numbers, rows};
use super::row::order;
use super::static_equilibrium::{equilibrium_from, mean};
use super::{Outcome, Rig, Row};

/// The paper's design with circular caps on this mesh.
fn design(subdivisions: u32) -> FoldDesign {
    FoldDesign { caps: Caps::Circular, ..paper::design(subdivisions) }
}

/// A shell whose rims and poles are known.
struct Known {
    shell: Shell,
    rims: [Vec<u32>; 2],
    poles: [u32; 2],
}

/// Volume, rim radii, height between rims and between poles.
fn sizes(state: &StaticSolution, known: &Known) -> [f64; 5] {
    let [low, high] = &known.rims;
    let middle = |rim: &[u32]| {
        Vector3::new(
            mean(state, rim, |x| x.x),
            mean(state, rim, |x| x.y),
            mean(state, rim, |x| x.z),
        )
    };
    let centres = [middle(low), middle(high)];
    let radius = |at: usize| mean(state, &known.rims[at], |x| (x - centres[at]).xy().norm());
    let pole = known.poles.map(|node| state.places.get(node as usize));
    [
        state.volume,
        radius(0),
        radius(1),
        (centres[1] - centres[0]).norm(),
        (pole[1] - pole[0]).norm(),
    ]
}

/// Sizes at both pressures, the higher first, and what they took.
fn inflate(known: &Known) -> Result<([[f64; 5]; 2], String), String> {
    let pressures = rows("end_state").into_iter().rev().map(|row| row[0]);
    let (mut found, mut last): (Vec<[f64; 5]>, Option<(StaticSolution, f64)>) = (Vec::new(), None);
    let mut words = Vec::new();
    for pressure in pressures {
        let filling = Filling::Pressure(pressure);
        let scene = FilmScene { filling, ..free_film(known.shell.clone(), Film::PAPER_ELASTIC) };
        let (state, word) =
            equilibrium_from(&scene, last.as_ref().map(|(state, at)| (state, *at)))?;
        found.push(sizes(&state, known));
        words.push(word);
        last = Some((state, pressure));
    }
    Ok(([found[1], found[0]], words.join(", ")))
}

/// Rows of three meshes against the table; differences between the pressures judged or told.
fn judge(meshes: &[Known; 3], differences: bool) -> Outcome {
    let (rows, bands) = (rows("end_state"), numbers("end_state/bands"));
    let difference_band = number("end_state/difference_band");
    let mut found = Vec::new();
    let mut words = Vec::new();
    for known in meshes {
        let (sizes, word) = inflate(known)?;
        found.push(sizes);
        words.push(word);
    }
    let names = [
        "volume, m3",
        "bottom rim radius, m",
        "top rim radius, m",
        "rim to rim height, m",
        "pole to pole height, m",
    ];
    let mut judged = Vec::new();
    for (at, name) in names.into_iter().enumerate() {
        for (which, row) in rows.iter().enumerate() {
            let values = [0, 1, 2].map(|mesh: usize| found[mesh][which][at]);
            let errors = values.map(|value| value / row[1 + at] - 1.0);
            judged.push(
                Row::new(&format!("{name}, at {} Pa", row[0]), values[2], row[1 + at], bands[at])
                    .with_order(order(errors[1], errors[2]))
                    .with_errors(errors),
            );
        }
        let expected = rows[1][1 + at] - rows[0][1 + at];
        let values = [0, 1, 2].map(|mesh: usize| found[mesh][1][at] - found[mesh][0][at]);
        let errors = values.map(|value| value / expected - 1.0);
        if differences {
            let name = format!("{name}, {} less {} Pa", rows[1][0], rows[0][0]);
            judged.push(
                Row::new(&name, values[2], expected, difference_band)
                    .with_order(order(errors[1], errors[2]))
                    .with_errors(errors)
                    .with_note(&words[2]),
            );
        } else if let Some(row) = judged.pop() {
            let [a, b, c] = errors;
            let told = format!("difference between pressures off by {a:.2e} {b:.2e} {c:.2e}");
            judged.push(row.with_note(&told).with_note(&words[2]));
        }
    }
    Ok(judged)
}

/// Circular caps, on the pattern's own mesh.
pub fn pattern(_: &Rig) -> Outcome {
    judge(&[own_mesh(8)?, own_mesh(16)?, own_mesh(32)?], false)
}

/// The pattern's own mesh, erected.
fn own_mesh(subdivisions: u32) -> Result<Known, String> {
    let told = |error: &dyn std::fmt::Display| error.to_string();
    let pattern = FoldPattern::new(&design(subdivisions)).map_err(|e| told(&e))?;
    let mesh = Mesh::new(&pattern, subdivisions, Shape::Erected).map_err(|e| told(&e))?;
    Ok(Known {
        shell: Shell::of_mesh(&mesh),
        rims: [mesh.bottom_ring.clone(), mesh.top_ring.clone()],
        poles: [mesh.bottom_centre, mesh.top_centre],
    })
}

/// Circular caps, on a mesh along the meridians.
pub fn aligned(_: &Rig) -> Outcome {
    let [bottom, top, height] =
        ["bottom_radius", "top_radius", "height"].map(|key| number(&format!("end_state/{key}")));
    let meshes = [8, 16, 32].map(|fine| {
        let capped = capped_frustum(fine, [bottom, top], height);
        Known { shell: capped.shell, rims: capped.rims, poles: capped.poles }
    });
    judge(&meshes, true)
}
