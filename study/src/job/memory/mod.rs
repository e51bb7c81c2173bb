//! Memory of a job, estimated from its scene. Nothing is built: counts and formulas only.
//!
//! ```text
//! run      mesh + contact + samples + frames
//! after    static equilibria + history file
//! job      the larger of the two, and of the mesh that gives the default contact distance
//!
//! contact  7 MB + (3.4 + 2.8 log2(1 + M/4) + 0.06 (N - 6)) kB e
//! statics  (2.8 + 0.19 log2(e/48)) kB e
//! ```
//!
//! Symbols: e elements, M storeys, N panels. Source: peaks of a counting allocator, `tests/reference/memory.json`. The
//! number of layers, and of panels that overlap in a layer, decide how many pairs of elements are near each
//! other.

use billow_solver::geometry::fold::FoldDesign;
use billow_solver::scene::{Film, IntegratorKind, ModelKind, Scene};

/// Mesh, film model and state, bytes per element.
const MESH: f64 = 800.0;
/// Checkpoint of a run as text, bytes per element and per sample.
const CHECKPOINT: [f64; 2] = [300.0, 900.0];
/// Queues of contact, whatever the mesh, bytes.
const CONTACT_QUEUES: f64 = 7e6;
/// Contact of a film that is not folded, bytes per element; 1600 of them are the frames of a block of the
/// monitor.
const CONTACT: f64 = 3400.0;
/// Contact for each doubling of the number of layers, bytes per element.
const CONTACT_LAYERS: f64 = 2800.0;
/// The mesh of 4 subdivisions that gives the default contact distance, bytes per element of it.
const REFERENCE_GAP: f64 = 1100.0;
/// Contact and static equilibria for each panel beyond 6, bytes per element.
const PANELS: [f64; 2] = [60.0, 8.0];
/// Static equilibria, bytes per element: of a small mesh, and for each doubling of its elements.
const STATICS: [f64; 2] = [2800.0, 190.0];
/// Bending, bytes per element: of energy and forces; with its stiffness, of a small mesh, and for each doubling of its
/// elements.
const BENDING: f64 = 1000.0;
const BENDING_STIFFNESS: [f64; 2] = [3000.0, 950.0];
/// Elements of the small mesh of [`STATICS`] and [`BENDING_STIFFNESS`].
const SMALL_MESH: f64 = 48.0;
/// Quantities and tracks of a capsule's history, per sample.
const COLUMNS: f64 = 46.0;
/// Bytes of one number of a sample: during a run, with growing lists; and afterwards, with the history file
/// and its copy.
const NUMBER: [f64; 2] = [30.0, 36.0];
/// A frame, bytes per element: during a run, and afterwards with the history file and its copy.
const FRAME: [f64; 2] = [24.0, 75.0];
/// A job without its film, bytes.
const JOB: f64 = 1e6;
/// Panels and storeys for which contact is estimated in film that is not a folded capsule. Chosen: film packed in
/// some layers.
const OTHER_STACK: [u32; 2] = [6, 8];

/// Estimated memory of a job and its parts, bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Estimate {
    /// Mesh, film model with its bending, state.
    pub mesh: u64,
    /// Contact: candidate pairs, queues, monitor.
    pub contact: u64,
    /// Static equilibria, after the run.
    pub statics: u64,
    /// Samples, history file, checkpoint.
    pub history: u64,
    /// Frames, during the run and in the history file.
    pub frames: u64,
    /// The job: some parts are never in memory together.
    pub total: u64,
}

/// What decides the memory of a film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSize {
    /// Number of elements.
    pub elements: u64,
    /// Panels and storeys of a folded capsule; `None` for other film.
    pub stack: Option<[u32; 2]>,
    /// Whether it has contact.
    pub contact: bool,
    /// Whether static equilibria are computed.
    pub statics: bool,
    /// Whether it moves.
    pub motion: bool,
    /// Bending: `None` without, else whether its stiffness is needed (all but central differences).
    pub bending: Option<bool>,
    /// Numbers of samples and of frames.
    pub samples: f64,
    /// Number of frames.
    pub frames: u32,
    /// Series recorded beside those of a capsule.
    pub tracks: usize,
}

/// The estimate for a job of this scene. It is not below the peak of the job.
pub fn estimate(scene: &Scene) -> Estimate {
    let samples = samples(scene.solver.end_time, scene.outputs.sample_interval);
    match scene.solver.model {
        ModelKind::Piston | ModelKind::Storeys => {
            let history = bytes(samples * COLUMNS * NUMBER[0].max(NUMBER[1]));
            Estimate { history, total: bytes(JOB).saturating_add(history), ..Estimate::default() }
        }
        ModelKind::Film => {
            let folded = scene.design.folded().ok();
            let film = film(&FilmSize {
                elements: scene.design.elements(),
                stack: folded.map(|design| [design.panels, design.storeys]),
                contact: true,
                statics: true,
                motion: true,
                bending: bending(&scene.film, scene.solver.integrator),
                samples,
                frames: scene.outputs.frames,
                tracks: 0,
            });
            let gap =
                folded.map(|design| FoldDesign { subdivisions: 4, ..design.clone() }.elements());
            let gap = gap.unwrap_or(0);
            let gap = bytes(JOB + REFERENCE_GAP * gap as f64);
            Estimate { total: film.total.max(gap), ..film }
        }
    }
}

/// [`FilmSize::bending`] of film in motion.
pub fn bending(film: &Film, integrator: IntegratorKind) -> Option<bool> {
    film.bending.then_some(integrator != IntegratorKind::Explicit)
}

/// The estimate for film of this size.
pub fn film(size: &FilmSize) -> Estimate {
    let elements = size.elements as f64;
    let when = |condition: bool, bytes: f64| if condition { bytes } else { 0.0 };
    let [panels, storeys] = size.stack.unwrap_or(OTHER_STACK).map(f64::from);
    let layers = CONTACT_LAYERS * libm::log2(1.0 + storeys / 4.0);
    let panels = PANELS.map(|bytes| bytes * (panels - 6.0).max(0.0));
    let contact = CONTACT_QUEUES + elements * (CONTACT + layers + panels[0]);
    let doublings = libm::log2((elements / SMALL_MESH).max(1.0));
    let statics = elements * (STATICS[0] + STATICS[1] * doublings + panels[1]);
    let columns = COLUMNS + size.tracks as f64;
    let frames = elements * f64::from(size.frames);
    let bending = match size.bending {
        None => 0.0,
        Some(false) => BENDING,
        Some(true) => BENDING_STIFFNESS[0] + BENDING_STIFFNESS[1] * doublings,
    };
    let mesh = (MESH + bending) * elements;
    let contact = when(size.contact, contact);
    let statics = when(size.statics, statics);
    let checkpoint = CHECKPOINT[0] * elements + CHECKPOINT[1] * size.samples;
    let run = mesh
        + contact
        + when(size.motion, checkpoint)
        + size.samples * columns * NUMBER[0]
        + frames * FRAME[0];
    let still = when(!size.motion, mesh);
    let after = still + statics + size.samples * columns * NUMBER[1] + frames * FRAME[1];
    Estimate {
        mesh: bytes(mesh),
        contact: bytes(contact),
        statics: bytes(statics),
        history: bytes(size.samples * (columns * NUMBER[0].max(NUMBER[1]) + CHECKPOINT[1])),
        frames: bytes(frames * FRAME[1]),
        total: bytes(JOB + run.max(after)),
    }
}

/// Number of samples of a run.
pub fn samples(end_time: f64, interval: f64) -> f64 {
    libm::ceil(end_time / interval) + 1.0
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
fn bytes(number: f64) -> u64 {
    libm::ceil(number) as u64
}

#[cfg(test)]
mod tests;
