//! The shapes of a report: the stored frames of some jobs, in steps of 1/65,534 of the size of the film.

use std::collections::BTreeMap;

use billow_solver::output::frames::Frame;
use serde_json::{Value as Json, json};

use super::Budget;
use super::packed::{self, COLOURS, FINE};
use crate::job::JobId;
use crate::platform::error::Result;
use crate::store::history_file::{self, StoredFrames};
use crate::store::stored::Stored;

/// Most jobs with shapes. Chosen: a reader plays back no more.
const MAX_JOBS: usize = 50;

/// Meshes, and the frames of jobs: first those of the rows `named` by the answer, then the others, spread over the plan.
/// Where all frames have no room, every second, third, … stays.
pub fn shapes(
    stored: &Stored<'_>,
    jobs: &[(usize, JobId)],
    named: &[usize],
    budget: &mut Budget,
) -> Json {
    let is_named = |(row, _): &&(usize, JobId)| named.contains(row);
    let mut wanted: Vec<(usize, JobId)> = jobs.iter().filter(is_named).cloned().collect();
    let others: Vec<(usize, JobId)> = jobs.iter().filter(|job| !is_named(job)).cloned().collect();
    wanted.extend(super::spread(&others, MAX_JOBS.saturating_sub(wanted.len())));
    wanted.truncate(MAX_JOBS);
    let mut found = Vec::new();
    for (row, id) in wanted {
        // A damaged history is named by `billow doctor`; its job is one without shapes.
        if let Ok(Some(frames)) = history_file::read_frames(&stored.results.job_path(&id)) {
            found.push((row, frames));
        }
    }
    let mut meshes = Meshes::default();
    let mut every = 1;
    let mut all = Vec::new();
    let room = budget.free();
    if let Some((row, first)) = found.first() {
        let size = job(*row, first, 1).map_or(0, |shape| shape.to_string().len()) as f64;
        let nodes =
            |frames: &StoredFrames| (frames.triangles().len() * frames.times().len()) as f64;
        let sum: f64 = found.iter().map(|(_, frames)| nodes(frames)).sum();
        let whole = size * sum / nodes(first).max(1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
        let thinned = (whole / room.max(1.0)).ceil() as usize;
        every = thinned.clamp(1, MAX_THINNING);
    }
    for (row, frames) in &found {
        let Ok(mut shape) = job(*row, frames, every) else { continue };
        let mesh = meshes.unknown(frames);
        let size =
            [Some(&shape), mesh.as_ref()].into_iter().flatten().map(|json| json.to_string().len());
        let size = size.sum::<usize>() as f64;
        if size > budget.free() {
            break;
        }
        budget.use_up(size);
        shape["mesh"] = meshes.number(frames, mesh).into();
        all.push(shape);
    }
    let (without, jobs) = (jobs.len() - all.len(), all);
    let meshes = meshes.all;
    json!({"meshes": meshes, "jobs": jobs, "every": every, "without": without})
}

/// Most thinning of frames: beyond it jobs go. Chosen: a motion needs a dozen of the frames that are stored by default.
const MAX_THINNING: usize = 8;

/// The meshes of the jobs, each once.
#[derive(Default)]
struct Meshes {
    known: BTreeMap<Vec<[u32; 3]>, usize>,
    all: Vec<Json>,
}

impl Meshes {
    /// The mesh of a job, if no job before it has the same one.
    fn unknown(&self, frames: &StoredFrames) -> Option<Json> {
        let triangles = frames.triangles();
        (!self.known.contains_key(triangles)).then(|| {
            json!({
                "elements": triangles.len(),
                "triangles": packed::indices(triangles.as_flattened().iter().copied()),
                "storeys": packed::indices(frames.storeys().iter().copied()),
            })
        })
    }

    /// The number of the mesh of a job, which is added where it is new.
    fn number(&mut self, frames: &StoredFrames, new: Option<Json>) -> usize {
        if let Some(mesh) = new {
            self.known.insert(frames.triangles().to_vec(), self.all.len());
            self.all.push(mesh);
        }
        self.known.get(frames.triangles()).copied().unwrap_or(0)
    }
}

/// Every first, second, … of the frames of a job, and the last.
fn job(row: usize, stored: &StoredFrames, every: usize) -> Result<Json> {
    let last = stored.times().len() - 1;
    let numbers = (0..=last).filter(|number| number % every == 0 || *number == last);
    let frames: Vec<Frame> = numbers.map(|number| stored.frame(number)).collect::<Result<_>>()?;
    let nodes = frames[0].positions.len();
    let positions: Vec<f64> = frames
        .iter()
        .flat_map(|frame| frame.positions.as_flattened().iter().map(|x| f64::from(*x)))
        .collect();
    let elements = stored.triangles().len();
    let stress: Vec<f64> =
        frames.iter().flat_map(|frame| frame.stresses.iter().map(|s| f64::from(s[0]))).collect();
    let square = |v: &[f32; 3]| v.iter().map(|x| f64::from(*x) * f64::from(*x)).sum::<f64>();
    let speed: Vec<f64> =
        frames.iter().flat_map(|frame| frame.velocities.iter().map(|v| square(v).sqrt())).collect();
    let gaps: Vec<f64> =
        frames.iter().flat_map(|frame| frame.gaps.iter().map(|gap| f64::from(*gap))).collect();
    let mut json = json!({
        "row": row, "nodes": nodes,
        "times": frames.iter().map(|frame| frame.time).collect::<Vec<f64>>(),
        "positions": packed::steps(&positions, 3 * nodes, FINE),
    });
    for (name, values, size) in
        [("stress", stress, elements), ("speed", speed, nodes), ("gap", gaps, nodes)]
    {
        if values.len() == size * frames.len() {
            json[name] = packed::steps(&values, size, COLOURS);
        }
    }
    Ok(json)
}
