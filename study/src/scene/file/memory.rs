//! Refuses a scene for which this process has no memory, before the memory is used.

use billow_solver::geometry::mesh_io::obj_size::ObjSize;
use billow_solver::scene::film_scene::FilmScene;

use crate::input::source::Source;
use crate::job::memory::{FilmSize, film, samples};
use crate::platform::error::InputError;
use crate::platform::memory::{Limit, limits, size, smallest};

/// Memory of a vertex of an OBJ file, of a face and of an element, with the copies of their reading, bytes.
const VERTEX: u64 = 110;
const FACE: u64 = 130;
const ELEMENT: u64 = 110;

/// What decides the memory of a scene, beside its mesh.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Needs {
    /// Whether it has contact.
    pub contact: bool,
    /// Whether its static equilibrium is computed.
    pub statics: bool,
}

impl Needs {
    /// The estimate for film of this number of elements; `stack`: panels and storeys of a folded capsule. Bytes.
    fn film(self, elements: u64, stack: Option<[u32; 2]>) -> u64 {
        let Self { contact, statics } = self;
        let motion = !statics;
        let contact = contact && motion;
        let (samples, frames, tracks) = (0.0, 0, 0);
        film(&FilmSize { elements, stack, contact, statics, motion, samples, frames, tracks }).total
    }

    /// Refuses a capsule of this number of elements.
    pub fn check_capsule(
        self,
        elements: u64,
        stack: Option<[u32; 2]>,
        subdivisions: u32,
        source: &Source,
    ) -> Result<(), InputError> {
        let needed = self.film(elements, stack).saturating_add(ELEMENT.saturating_mul(elements));
        let mesh = || format!("makes a capsule of {elements} elements");
        check(needed, "design.subdivisions", &subdivisions.to_string(), mesh, source)
    }

    /// Refuses an OBJ file of this size.
    pub fn check_file(
        self,
        file: &ObjSize,
        key: &str,
        name: &str,
        source: &Source,
    ) -> Result<(), InputError> {
        let parts = [
            file.bytes,
            file.vertices.saturating_mul(VERTEX),
            file.faces.saturating_mul(FACE),
            file.elements.saturating_mul(ELEMENT),
            if file.elements > 0 { self.film(file.elements, None) } else { 0 },
        ];
        let needed = parts.into_iter().fold(0, u64::saturating_add);
        let ObjSize { lines, vertices, elements, .. } = *file;
        let mesh = || format!("has {lines} lines, {vertices} vertices, {elements} elements");
        check(needed, key, &format!("{name:?}"), mesh, source)
    }
}

/// Refuses a scene whose history and frames do not fit.
pub(super) fn check_outputs(film_scene: &FilmScene, source: &Source) -> Result<(), InputError> {
    let FilmScene { solver, outputs, .. } = film_scene;
    let samples = samples(solver.end_time, outputs.sample_interval);
    let estimate = film(&FilmSize {
        elements: film_scene.shell.triangles.len() as u64,
        stack: None,
        contact: film_scene.contact.is_some(),
        statics: solver.statics,
        motion: !solver.statics,
        samples: if solver.statics { 0.0 } else { samples },
        frames: outputs.frames,
        tracks: 3 * outputs.nodes.len() + 2 * outputs.elements.len(),
    });
    let (key, problem) = if estimate.history > estimate.frames {
        ("outputs.sample_interval", format!("gives {samples} samples"))
    } else {
        ("outputs.frames", format!("gives {} frames", outputs.frames))
    };
    check(estimate.total, key, "", || problem, source)
}

/// Refuses what needs more than this process may use, bytes.
fn check(
    needed: u64,
    key: &str,
    value: &str,
    problem: impl FnOnce() -> String,
    source: &Source,
) -> Result<(), InputError> {
    match smallest(&limits(), 1) {
        Some(limit) if needed > limit.usable_alone() => {
            Err(refused(needed, &limit, key, value, &problem(), source))
        }
        _ => Ok(()),
    }
}

fn refused(
    needed: u64,
    limit: &Limit,
    key: &str,
    value: &str,
    problem: &str,
    source: &Source,
) -> InputError {
    let usable = size(limit.usable_alone());
    let problem = format!("{problem}: about {} of memory needed", size(needed));
    let allowed = format!("up to {usable}, what the program leaves of {limit}");
    let mut error = source.error(key, value, problem, allowed);
    "use a coarser mesh, or a machine or limit with more memory".clone_into(&mut error.hint);
    error
}
