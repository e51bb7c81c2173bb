//! The picture of a mesh with what was found about it: `billow solve SCENE --check --picture`.

use std::path::Path;

use billow_solver::mechanics::material::Regime;
use billow_solver::output::frames::Frame;
use nalgebra::Vector3;
use serde_json::Value as Json;

use super::picture;
use crate::platform::error::{Error, Result};
use crate::render::filmstrip::{Colour, Filmstrip};
use crate::render::projection::View;
use crate::scene::check;
use crate::scene::file::SceneFile;

/// Azimuth and elevation of the view, degrees.
const VIEW: f64 = 30.0;

/// Draws the mesh of a scene, with a cross at each place that a message about it names, or that has a free edge.
///
/// # Errors
/// A mesh that cannot be read, a scene without one, a picture that cannot be written.
pub fn write(path: &Path, file: &Path, sets: &[String], scene: &Result<SceneFile>) -> Result<()> {
    let Some(surface) = SceneFile::surface(file, sets)? else {
        let problem = "draws the mesh of a scene; this one has a design";
        let value = path.display().to_string();
        return Err(Error::invalid_option("--picture", &value, problem, "a scene with mesh", ""));
    };
    let mut findings: Vec<String> = match scene {
        Err(error) => vec![error.to_string()],
        Ok(scene) => {
            scene.notes.iter().chain(&free_edges(&check::report(scene))).cloned().collect()
        }
    };
    let mut marks: Vec<[f64; 3]> = Vec::new();
    for finding in &mut findings {
        *finding = finding.replace("\n  ", "; ");
        let mut numbers: Vec<String> = Vec::new();
        for place in places(finding) {
            // A place has one cross, however often it is named.
            let known = marks
                .iter()
                .position(|mark| mark.map(f64::to_bits) == place.map(f64::to_bits))
                .unwrap_or_else(|| {
                    marks.push(place);
                    marks.len() - 1
                });
            let number = (known + 1).to_string();
            if !numbers.contains(&number) {
                numbers.push(number);
            }
        }
        if !numbers.is_empty() {
            *finding = format!("{}: {finding}", numbers.join(", "));
        }
    }
    let middle =
        surface.vertices.iter().sum::<Vector3<f64>>() / surface.vertices.len().max(1) as f64;
    // Single precision is relative to the middle: the film may be far from the origin.
    #[expect(clippy::cast_possible_truncation, reason = "a picture")]
    let near = |place: Vector3<f64>| <[f32; 3]>::from((place - middle).map(|x| x as f32));
    let marks: Vec<[f32; 3]> = marks.into_iter().map(|place| near(place.into())).collect();
    let fan = |corners: &Vec<u32>| {
        (1..corners.len() - 1).map(|k| [corners[0], corners[k], corners[k + 1]]).collect::<Vec<_>>()
    };
    let triangles: Vec<[u32; 3]> =
        surface.faces.iter().flat_map(|face| fan(&face.corners)).collect();
    let frame = Frame {
        time: 0.0,
        positions: surface.vertices.iter().map(|vertex| near(*vertex)).collect(),
        regimes: vec![Regime::Taut; triangles.len()],
        velocities: Vec::new(),
        stresses: Vec::new(),
        gaps: Vec::new(),
    };
    let svg = Filmstrip {
        title: &format!(
            "{}: {} vertices, {} faces",
            file.display(),
            surface.vertices.len(),
            surface.faces.len()
        ),
        triangles: &triangles,
        storeys: &vec![0; triangles.len()],
        frames: &[frame],
        view: View::new(VIEW.to_radians(), VIEW.to_radians()),
        colour: Colour::Plain,
        smooth: false,
        values: &[],
        marks: &marks,
        notes: &findings,
    }
    .svg();
    picture::write(path, &svg)
}

/// The free edges of a report, as messages with places.
fn free_edges(report: &Json) -> Vec<String> {
    let loops = report["free_edges"].as_array().into_iter().flatten();
    let text = |one: &Json| {
        format!(
            "a free edge of {} edges, {} m long, at {} m",
            one["edges"], one["length"], one["position"]
        )
    };
    loops.map(text).collect()
}

/// The positions in a message, as in "at [0.1, 0, 2.5] m", m.
fn places(text: &str) -> Vec<[f64; 3]> {
    let of_list = |rest: &str| -> Option<[f64; 3]> {
        let numbers = rest.split_once(']')?.0.split(',');
        let numbers: Option<Vec<f64>> = numbers.map(|word| word.trim().parse().ok()).collect();
        numbers?.try_into().ok()
    };
    text.split("at [").skip(1).filter_map(of_list).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_found_in_messages() {
        let text = "the face on line 3 (at [1, -2.5, 3e-2] m) and the edge at [0,0,1] m; at [x] m; at [1, 2] m";
        assert_eq!(places(text), [[1.0, -2.5, 0.03], [0.0, 0.0, 1.0]]);
        assert!(places("nothing").is_empty());
    }
}
