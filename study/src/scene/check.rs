//! What `billow solve --check` prints of a scene that it does not run: the film, its pieces, its free edges, its step.

use std::collections::BTreeSet;

use billow_solver::geometry::field::Field;
use billow_solver::geometry::shell::Shell;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::resultants::stretches;
use billow_solver::scene::IntegratorKind;
use nalgebra::Vector3;
use serde_json::{Value as Json, json};

use crate::job::cost::film_seconds;

use super::file::SceneFile;
use super::file::components::{Piece, pieces};

/// The film of a scene, SI. A scene that is refused has an error instead.
pub fn report(scene: &SceneFile) -> Json {
    let shell = &scene.film.shell;
    let at = |node: u32| shell.positions[node as usize] + scene.numbering.origin;
    let vertex = |node: u32| scene.numbering.obj_vertex(node);
    let loops = shell.boundary();
    let rims: BTreeSet<u32> = loops.iter().flatten().copied().collect();
    let of_loop = |nodes: &Vec<u32>| {
        let edges = (0..nodes.len()).map(|k| [nodes[k], nodes[(k + 1) % nodes.len()]]);
        let length: f64 = edges.map(|[a, b]| (at(a) - at(b)).norm()).sum();
        let first = nodes.first().copied().unwrap_or_default();
        json!({
            "edges": nodes.len(), "length": length, "vertex": vertex(first),
            "position": <[f64; 3]>::from(at(first)),
        })
    };
    let of_piece = |piece: &Piece| {
        let first = piece.faces[0][0];
        let closed = !piece.faces.iter().flatten().any(|node| rims.contains(node));
        json!({
            "faces": piece.faces.len(), "volume": closed.then_some(piece.volume),
            "vertex": vertex(first), "position": <[f64; 3]>::from(at(first)),
        })
    };
    let mut report = json!({
        "status": "checked",
        "nodes": shell.positions.len(),
        "elements": shell.triangles.len(),
        "closing_faces": shell.closure.len(),
        "area": shell.reference_area(),
        "volume": shell.volume(|node| shell.positions[node as usize]),
        "edge_length": edge_lengths(shell),
        "pieces": pieces(shell).iter().map(of_piece).collect::<Vec<_>>(),
        "free_edges": shell.rims().iter().map(of_loop).collect::<Vec<_>>(),
        "notes": scene.notes,
    });
    if let Ok(model) = FilmModel::of_shell(&scene.film.film.elastic(), shell) {
        let stretch = stretches(&model, &Field::of(&shell.positions)).map(|(stretch, _)| stretch);
        report["stretch"] = json!({"start": stretch});
        if let Some([step, steps]) = steps(scene, &model) {
            report["step"] = json!(step);
            report["steps"] = json!(steps);
        }
    }
    report
}

/// Length (s) and number of the steps of explicit motion, at most 2 cfl/ω each, ω the largest frequency of an element.
fn steps(scene: &SceneFile, model: &FilmModel) -> Option<[f64; 2]> {
    let solver = &scene.film.solver;
    let step = 2.0 * solver.cfl / model.largest_frequency();
    let is_explicit = !solver.statics && solver.integrator == IntegratorKind::Explicit;
    // A step ends at each sample.
    let interval = scene.film.outputs.sample_interval.min(solver.end_time);
    let steps = libm::ceil(interval / step) * (solver.end_time / interval);
    is_explicit.then(|| [step.min(interval), libm::ceil(steps)])
}

/// Length (s) and number of the steps of a run, and its time on one core, s; `None` where they are not known before.
pub fn forecast(scene: &SceneFile) -> Option<[f64; 3]> {
    let shell = &scene.film.shell;
    let model = FilmModel::of_shell(&scene.film.film.elastic(), shell).ok()?;
    let [step, steps] = steps(scene, &model)?;
    let elements = shell.triangles.len() as f64;
    Some([step, steps, film_seconds(elements, steps, scene.film.solver.end_time)])
}

/// Smallest, mean and largest length of an edge of the film at the start, m.
fn edge_lengths(shell: &Shell) -> [f64; 3] {
    let at = |node: u32| -> Vector3<f64> { shell.positions[node as usize] };
    let edges = shell.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let lengths: Vec<f64> = edges.map(|[a, b]| (at(a) - at(b)).norm()).collect();
    let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
    let (least, most) = lengths.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), length| {
        (least.min(*length), most.max(*length))
    });
    [least, mean, most]
}
