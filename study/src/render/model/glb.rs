//! A motion as glTF 2.0 in one binary file: the first shape, every other one as a morph target, and an animation that
//! goes from one to the next. Blender, `PowerPoint` and browsers play it.
//!
//! ```text
//! header "glTF" 2 length | chunk JSON | chunk BIN: triangles of each storey, positions, displacements, times, weights
//! ```
//!
//! Source: "glTF 2.0 Specification", Khronos Group. Its y axis points up: (x, z, −y) of the film.

use std::collections::BTreeMap;

use billow_solver::output::frames::Frame;
use serde_json::{Value as Json, json};

/// Colours of storeys, linear: caps grey, then Okabe and Ito.
const COLOURS: [[f64; 3]; 5] = [
    [0.0, 0.168, 0.445],
    [0.791, 0.347, 0.0],
    [0.0, 0.342, 0.171],
    [0.871, 0.776, 0.054],
    [0.665, 0.112, 0.0],
];
const GREY: [f64; 3] = [0.694, 0.694, 0.694];
/// Codes of glTF: types of numbers, and what a part of the buffer is for.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34_962;
const ELEMENTS: u32 = 34_963;

/// The buffer and its descriptions.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Json>,
    accessors: Vec<Json>,
}

impl Buffer {
    /// Adds an array with its description; returns its number.
    fn add(&mut self, bytes: &[u8], target: Option<u32>, mut accessor: Json) -> usize {
        let mut view =
            json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        accessor["bufferView"] = self.views.len().into();
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let bytes: Vec<u8> = vectors.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        let bound = |of: fn(f32, f32) -> f32| {
            [0, 1, 2].map(|k| vectors.iter().map(|vector| vector[k]).fold(vectors[0][k], of))
        };
        let accessor = json!({
            "componentType": FLOAT, "count": vectors.len(), "type": "VEC3",
            "min": bound(f32::min), "max": bound(f32::max),
        });
        self.add(&bytes, Some(VERTICES), accessor)
    }

    fn scalars(&mut self, scalars: &[f32]) -> usize {
        let bytes: Vec<u8> = scalars.iter().flat_map(|x| x.to_le_bytes()).collect();
        let bound = |of: fn(f32, f32) -> f32| [scalars.iter().copied().fold(scalars[0], of)];
        let accessor = json!({
            "componentType": FLOAT, "count": scalars.len(), "type": "SCALAR",
            "min": bound(f32::min), "max": bound(f32::max),
        });
        self.add(&bytes, None, accessor)
    }

    fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let nodes = triangles.as_flattened();
        let bytes: Vec<u8> = nodes.iter().flat_map(|node| node.to_le_bytes()).collect();
        let accessor =
            json!({"componentType": UNSIGNED_INT, "count": nodes.len(), "type": "SCALAR"});
        self.add(&bytes, Some(ELEMENTS), accessor)
    }
}

/// A motion of at least one frame, which lasts this time (s).
#[expect(clippy::cast_possible_truncation, reason = "the format has single precision")]
pub fn glb(
    triangles: &[[u32; 3]],
    storeys: &[u32],
    frames: &[Frame],
    duration: f64,
    title: &str,
) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let up = |[x, y, z]: [f32; 3]| [x, z, -y];
    let positions = |frame: &Frame| frame.positions.iter().copied().map(up).collect::<Vec<_>>();
    let first = positions(&frames[0]);
    let position = buffer.vectors(&first);
    let moved = frames.iter().skip(1).map(|frame| {
        let moved = positions(frame);
        let from = first.iter().zip(&moved);
        from.map(|(a, b)| [0, 1, 2].map(|k| b[k] - a[k])).collect::<Vec<_>>()
    });
    let targets: Vec<Json> =
        moved.map(|moved| json!({"POSITION": buffer.vectors(&moved)})).collect();
    let mut parts: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for (triangle, storey) in triangles.iter().zip(storeys) {
        parts.entry(*storey).or_default().push(*triangle);
    }
    let top = parts.keys().copied().max().unwrap_or(0);
    let mut primitives = Vec::new();
    let mut materials = Vec::new();
    for (storey, part) in &parts {
        let is_cap = *storey == 0 || *storey == top;
        let [r, g, b] = if is_cap { GREY } else { COLOURS[(*storey as usize - 1) % COLOURS.len()] };
        primitives.push(json!({
            "attributes": {"POSITION": position}, "indices": buffer.triangles(part),
            "material": materials.len(), "targets": targets,
        }));
        materials.push(json!({
            "name": format!("storey {storey}"), "doubleSided": true,
            "pbrMetallicRoughness": {
                "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8,
            },
        }));
    }
    let mut model = json!({
        "asset": {"version": "2.0", "generator": "billow"},
        "scene": 0, "scenes": [{"name": title, "nodes": [0]}], "nodes": [{"mesh": 0, "name": "film"}],
        "materials": materials,
    });
    let mut mesh = json!({"name": "film", "primitives": primitives});
    if !targets.is_empty() {
        let (from, to) = (frames[0].time, frames[targets.len()].time);
        let slow = duration / (to - from).max(f64::MIN_POSITIVE);
        let times: Vec<f32> =
            frames.iter().map(|frame| (slow * (frame.time - from)) as f32).collect();
        // At frame k the target k has its whole weight; the first shape has none.
        let mut weights = vec![0.0_f32; frames.len() * targets.len()];
        for frame in 1..frames.len() {
            weights[frame * targets.len() + frame - 1] = 1.0;
        }
        let (input, output) = (buffer.scalars(&times), buffer.scalars(&weights));
        mesh["weights"] = vec![0.0; targets.len()].into();
        model["animations"] = json!([{
            "name": "motion",
            "samplers": [{"input": input, "output": output, "interpolation": "LINEAR"}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
            "extras": {"simulated_seconds": to - from, "slower": slow},
        }]);
    }
    model["meshes"] = json!([mesh]);
    model["bufferViews"] = buffer.views.into();
    model["accessors"] = buffer.accessors.into();
    model["buffers"] = json!([{"byteLength": buffer.bytes.len()}]);
    container(model.to_string().into_bytes(), buffer.bytes)
}

/// Both chunks in one file, each a multiple of four bytes.
fn container(mut text: Vec<u8>, mut bytes: Vec<u8>) -> Vec<u8> {
    text.resize(text.len().next_multiple_of(4), b' ');
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let size = |bytes: &[u8]| u32::try_from(bytes.len()).unwrap_or(u32::MAX).to_le_bytes();
    let mut file = Vec::with_capacity(28 + text.len() + bytes.len());
    file.extend_from_slice(b"glTF");
    file.extend_from_slice(&2_u32.to_le_bytes());
    let length = u32::try_from(28 + text.len() + bytes.len()).unwrap_or(u32::MAX);
    file.extend_from_slice(&length.to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bytes)] {
        file.extend_from_slice(&size(chunk));
        file.extend_from_slice(kind);
        file.extend_from_slice(chunk);
    }
    file
}

#[cfg(test)]
mod tests {
    use super::super::tests::{TRIANGLES, frame};
    use super::*;

    #[test]
    fn a_motion_has_a_target_a_frame_and_weights_that_move_from_one_to_the_next() {
        let frames = [frame(0.1, 1.0), frame(0.2, 2.0), frame(0.4, 5.0)];
        let file = glb(&TRIANGLES, &[0, 1, 1, 2], &frames, 6.0, "a \"title\"");
        assert_eq!(&file[..4], b"glTF");
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(word(8), file.len());
        let text: Json = serde_json::from_slice(&file[20..20 + word(12)]).unwrap();
        let binary = &file[28 + word(12)..];
        assert_eq!(binary.len(), word(20 + word(12)));
        let whole = |number: &Json| usize::try_from(number.as_u64().unwrap()).unwrap();
        let numbers = |accessor: &Json| -> Vec<f32> {
            let accessor = &text["accessors"][whole(accessor)];
            let view = &text["bufferViews"][whole(&accessor["bufferView"])];
            let [from, length] = ["byteOffset", "byteLength"].map(|name| whole(&view[name]));
            let (numbers, _) = binary[from..from + length].as_chunks::<4>();
            numbers.iter().map(|bits| f32::from_le_bytes(*bits)).collect()
        };
        let primitives = text["meshes"][0]["primitives"].as_array().unwrap();
        assert_eq!(primitives.len(), 3);
        let targets = primitives[0]["targets"].as_array().unwrap();
        assert_eq!(targets.len(), 2);
        // The top of the last frame is 4 m higher than that of the first, along y.
        assert_eq!(numbers(&targets[1]["POSITION"])[9..], [0.0, 4.0, 0.0]);
        let sampler = &text["animations"][0]["samplers"][0];
        let times = numbers(&sampler["input"]);
        assert!((times[1] - 2.0).abs() < 1e-6 && (times[2] - 6.0).abs() < 1e-6, "{times:?}");
        assert_eq!(numbers(&sampler["output"]), [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        let still = glb(&TRIANGLES, &[0; 4], &frames[..1], 6.0, "");
        assert!(!String::from_utf8_lossy(&still).contains("animations"));
    }
}
