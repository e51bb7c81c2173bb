//! Refuses a scene for which this process has no memory, before the memory is used.

use billow_solver::geometry::mesh_io::obj_reader::Surface;
use billow_solver::scene::film_scene::FilmScene;

use crate::input::source::Source;
use crate::job::memory::{FilmSize, bending, film, samples};
use crate::platform::error::InputError;
use crate::platform::memory::{limits, size, smallest};

/// Memory of the vertices and faces that a byte of an OBJ file describes, at most, with the copies of their
/// reading, bytes: the shortest line of a face has 8 bytes, and its face takes 130.
const OBJ_BYTE: u64 = 17;
/// Memory of an element of a surface, bytes.
const ELEMENT: u64 = 110;

/// What decides the memory of a scene, beside its mesh.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Needs {
    /// Whether it has contact.
    pub contact: bool,
    /// Whether its static equilibrium is computed.
    pub statics: bool,
    /// [`FilmSize::bending`].
    pub bending: Option<bool>,
    /// Pieces into which each triangle of a mesh is cut; 0 counts as 1.
    pub pieces: u64,
}

impl Needs {
    /// The estimate for film of this number of elements; `stack`: panels and storeys of a folded capsule. Bytes.
    fn film(self, elements: u64, stack: Option<[u32; 2]>) -> u64 {
        let Self { contact, statics, bending, .. } = self;
        let motion = !statics;
        let contact = contact && motion;
        let (samples, frames, tracks) = (0.0, 0, 0);
        let size = FilmSize {
            elements,
            stack,
            contact,
            statics,
            motion,
            bending,
            samples,
            frames,
            tracks,
        };
        film(&size).total
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
        let mesh = format!("makes a capsule of {elements} elements");
        check(needed, "design.subdivisions", &subdivisions.to_string(), &mesh, source)
    }

    /// Refuses the surface of an OBJ file.
    pub fn check_surface(
        self,
        surface: &Surface,
        key: &str,
        name: &str,
        source: &Source,
    ) -> Result<(), InputError> {
        let elements = surface.faces.iter().map(|face| face.corners.len() as u64 - 2).sum::<u64>();
        let elements = elements.saturating_mul(self.pieces.max(1));
        let film = if elements > 0 { self.film(elements, None) } else { 0 };
        let needed = film.saturating_add(ELEMENT.saturating_mul(elements));
        check(needed, key, &format!("{name:?}"), &format!("has {elements} elements"), source)
    }
}

/// Refuses an OBJ file of this size, bytes.
pub(super) fn check_file(
    bytes: usize,
    key: &str,
    name: &str,
    source: &Source,
) -> Result<(), InputError> {
    let needed = OBJ_BYTE.saturating_mul(bytes as u64);
    check(needed, key, &format!("{name:?}"), &format!("has {}", size(bytes as u64)), source)
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
        bending: bending(&film_scene.film, solver.integrator).map(|stiff| stiff || solver.statics),
        samples: if solver.statics { 0.0 } else { samples },
        frames: outputs.frames,
        tracks: 3 * outputs.nodes.len() + 2 * outputs.elements.len(),
    });
    let (key, problem) = if estimate.history > estimate.frames {
        ("outputs.sample_interval", format!("gives {samples} samples"))
    } else {
        ("outputs.frames", format!("gives {} frames", outputs.frames))
    };
    check(estimate.total, key, "", &problem, source)
}

/// Refuses what needs more than this process may use, bytes.
fn check(
    needed: u64,
    key: &str,
    value: &str,
    problem: &str,
    source: &Source,
) -> Result<(), InputError> {
    let limit = smallest(&limits(), 1).filter(|limit| needed > limit.usable_alone());
    let Some(limit) = limit else { return Ok(()) };
    let usable = size(limit.usable_alone());
    let problem = format!("{problem}: about {} of memory needed", size(needed));
    let allowed = format!("up to {usable}, what the program leaves of {limit}");
    let next = "use a coarser mesh, or a machine or limit with more memory";
    Err(source.error(key, value, problem, allowed).with_hint(next))
}
