//! Model `film`: film of any shape, explicit in time, with or without contact.
//!
//! Tension-field triangles ([`crate::mechanics::forces`]), a pressure or one gas volume, an integrator
//! ([`crate::integrators`]), contact of film with film
//! ([`crate::collision::contact`]). A capsule is such a film, with rings. The tunnelling monitor counts
//! passages of film through film, and every sample counts the intersections of the mesh. The first
//! passage or intersection ends the run as `interpenetrated`. Without contact film passes through film,
//! for unfolded shapes and for checks of energy; both counts are then `None`.
//!
//! **Packed film.** With contact the film lies between a base and a lid, two plates at the contact
//! distance from it, and moves between them under the gas; the lid force is the force on the lid plate.
//! Without contact every node is fixed at its stowed position, and the lid force is the force that does
//! the work of a uniform stretch of the stack, Σ `f_z` z/h. Film that is not a capsule then has no lid.

use nalgebra::Vector3;

use super::Cost;
use crate::geometry::field::Field;
use crate::geometry::mesh::{Mesh, Part, Pleat};
use crate::integrators::{FilmSimulation, FilmView, StoredFilm};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::damping;
use crate::mechanics::supports::PrescribedNodes;
use crate::models::run::{CheckpointText, Model, Run};
use crate::output::checkpoint::Checkpoint;
use crate::output::events::Event;
use crate::output::frames::Frame;
use crate::output::history::{Sample, Track};
use crate::output::outcome::Failure;
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::film_scene::{FilmContact, FilmScene};
use crate::scene::timeline::Phase;
use crate::scene::{Scene, Stepping};
use crate::system::PressureLoad;

mod any_mesh;
pub mod capsule;
mod imperfection;
mod ladder;
mod pleats;
pub mod reference_gap;
mod solve;
mod statics;
mod tracks;

pub use crate::statics::Relaxation;
pub use ladder::Ladder;
pub use pleats::{MAX_UNIFORM, PLEATS as PLEAT_COLUMNS};
pub use solve::{at_start, resume_scene, solve, solve_scene};
pub use statics::{Erected, StaticState, erected, reference_scene, static_states};
pub use tracks::{CONTACT as CONTACT_COLUMNS, FILM_STRESS_99};

/// Checks a scene for this model, as far as possible without its fold pattern.
pub fn check(scene: &Scene) -> Result<(), SceneError> {
    scene.validate()?;
    cfl_of(scene).map(|_| ())
}

/// Elements and steps of a run whose film is never quiescent. The steps are those of the film without
/// gas; gas changes them little.
pub fn cost(scene: &Scene) -> Result<Cost, SceneError> {
    // Nothing runs here, and every instruction set gives the same bits.
    let instruction_set = InstructionSet::detect();
    let (film, _) = at_start(instruction_set, scene, cfl_of(scene)?, None)?;
    let model = FilmModel::of_shell(&film.film, &film.shell)
        .map_err(|error| SceneError::invalid("design", error))?;
    let factor = damping::stable_share(scene.film.numerical_damping);
    let step = film.solver.cfl * factor * 2.0 / model.largest_frequency();
    let interval = scene.outputs.sample_interval;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts above 0")]
    let steps = (libm::ceil(interval / step) * (scene.solver.end_time / interval)) as u64;
    Ok(Cost { elements: model.elements() as u64, steps })
}

/// The CFL number of a scene.
fn cfl_of(scene: &Scene) -> Result<f64, SceneError> {
    match scene.solver.stepping {
        Stepping::Stable(cfl) => Ok(cfl),
        Stepping::Adaptive(_) | Stepping::Fixed(_) => {
            let problem = "model `film` steps by a CFL number; allowed: solver.cfl";
            Err(SceneError::invalid("solver.stepping", problem))
        }
    }
}

/// Film during a run.
#[derive(Debug, Clone)]
pub struct FilmRun {
    /// The film.
    pub film: FilmSimulation,
    rings: Option<Rings>,
    nodes: Vec<u32>,
    elements: Vec<u32>,
    /// Boundary loops of an open film, each with the apex (m) of the fan that closes it.
    fans: Vec<(Vector3<f64>, Vec<u32>)>,
    /// `T_film`, K.
    temperature: f64,
}

/// The rings that make a film a capsule.
#[derive(Debug, Clone, PartialEq)]
pub struct Rings {
    /// Nodes of the top ring.
    pub top_ring: Vec<u32>,
    /// Centre node of the top cap.
    pub top_centre: u32,
    /// Storey of each element, as [`crate::output::frames::Frames::storeys`].
    pub storeys: Vec<u32>,
    /// Height of the stack while it is packed, m.
    pub stowed_height: f64,
    /// The pleat of each ring; none where its gas is not followed.
    pub pleats: Vec<Pleat>,
}

impl Rings {
    /// The rings of a capsule's mesh with this stowed height (m).
    pub fn of(mesh: &Mesh, stowed_height: f64) -> Self {
        let lateral = mesh.parts.iter().filter_map(|part| match part {
            Part::Storey(storey) => Some(storey + 1),
            Part::BottomCap | Part::TopCap => None,
        });
        let storeys = lateral.max().unwrap_or(0);
        let storey = |part: &Part| match part {
            Part::BottomCap => 0,
            Part::Storey(storey) => storey + 1,
            Part::TopCap => storeys + 1,
        };
        Self {
            top_ring: mesh.top_ring.clone(),
            top_centre: mesh.top_centre,
            storeys: mesh.parts.iter().map(storey).collect(),
            stowed_height,
            pleats: mesh.pleats.clone(),
        }
    }
}

impl FilmRun {
    /// The film of a scene at time 0; with `rings` a capsule.
    pub fn of(scene: &FilmScene, rings: Option<Rings>) -> Result<Self, SceneError> {
        Self::seated(scene, rings, &[])
    }

    /// [`Self::of`] with further nodes that move as prescribed.
    pub fn seated(
        scene: &FilmScene,
        rings: Option<Rings>,
        seating: &[PrescribedNodes],
    ) -> Result<Self, SceneError> {
        Ok(Self::with(capsule::start(scene, seating)?, scene, rings))
    }

    /// The film of a scene in a stored state, and its run. The run continues with the same bits.
    pub fn resume(
        scene: &FilmScene,
        rings: Option<Rings>,
        seating: &[PrescribedNodes],
        Checkpoint { state, run, .. }: Checkpoint<StoredFilm, Run>,
    ) -> Result<(Self, Run), SceneError> {
        let (mut system, settings, _) = capsule::constants(scene)?;
        system.supports.movers.extend(seating.iter().cloned());
        let other = || SceneError::invalid("mesh", "the stored state belongs to another film");
        let film = FilmSimulation::resume(system, settings, state).ok_or_else(other)?;
        let film = Self::with(film, scene, rings);
        if run.fits(&film) { Ok((film, run)) } else { Err(other()) }
    }

    /// Film in motion that a scene describes, with what the scene records.
    pub fn with(film: FilmSimulation, scene: &FilmScene, rings: Option<Rings>) -> Self {
        let (nodes, elements) = (scene.outputs.nodes.clone(), scene.outputs.elements.clone());
        let temperature = scene.film.temperature;
        let fans = scene.shell.fans();
        Self { film, rings, nodes, elements, fans, temperature }
    }

    /// The film of a scene at time 0, with this contact. Contact without a distance has the default one of the design
    /// or of the mesh.
    pub fn from_scene(
        instruction_set: InstructionSet,
        scene: &Scene,
        cfl: f64,
        contact: Option<FilmContact>,
    ) -> Result<Self, SceneError> {
        let (film, rings) = at_start(instruction_set, scene, cfl, contact)?;
        Self::of(&film, rings)
    }

    /// The film as it is now.
    pub fn view(&self) -> FilmView<'_> {
        self.film.view()
    }

    /// Force on the lid while packed, N; 0 of film without rings and without contact.
    fn lid_force(&self) -> f64 {
        let film = self.view();
        if let Some(contact_model) = &film.system.contact {
            let plates = contact_model.plates.iter().zip(&film.state.contact.plates);
            return plates
                .filter(|(p, _)| p.name == capsule::LID)
                .map(|(_, state)| state.force)
                .sum();
        }
        let Some(rings) = &self.rings else { return 0.0 };
        let lift: f64 = (0..film.system.model.nodes())
            .map(|node| film.force(node).z * film.state.positions.z[node])
            .sum();
        (lift / rings.stowed_height).max(0.0)
    }

    /// Enclosed volume, m³. An open film is closed by fans over its free edges.
    pub fn volume(&self) -> f64 {
        let state = self.view().state;
        let position = |node: u32| state.positions.get(node as usize);
        let fan = |(apex, boundary): &(Vector3<f64>, Vec<u32>)| -> f64 {
            let edge = |k: usize| {
                position(boundary[k]).dot(&position(boundary[(k + 1) % boundary.len()]).cross(apex))
            };
            (0..boundary.len()).map(edge).sum()
        };
        let volume = state.volume;
        if self.fans.is_empty() {
            volume
        } else {
            volume + self.fans.iter().map(fan).sum::<f64>() / 6.0
        }
    }
}

/// Least and largest z of any node with mass, m.
fn heights(model: &FilmModel, positions: &Field) -> [f64; 2] {
    let film = model.mass.iter().zip(positions.z.iter()).filter(|(mass, _)| **mass > 0.0);
    film.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (_, z)| [low.min(*z), high.max(*z)])
}

/// Mean z of these nodes, m.
fn mean_z(field: &Field, nodes: &[u32]) -> f64 {
    nodes.iter().map(|node| field.z[*node as usize]).sum::<f64>() / nodes.len() as f64
}

impl Model for FilmRun {
    fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
    ) -> Result<bool, Failure> {
        self.film.advance_at_most(target, phase, steps)
    }

    fn take_events(&mut self) -> Vec<Event> {
        self.film.take_events()
    }

    fn sample(&self, phase: &Phase) -> Sample {
        let film = self.view();
        let positions = &film.state.positions;
        let [low, high] = heights(&film.system.model, positions);
        let mut sample = Sample { z_max: high, height: high - low, ..Sample::default() };
        if let Some(rings) = &self.rings {
            let centre = rings.top_centre as usize;
            sample.z_centre = positions.z[centre];
            sample.z_rim = mean_z(positions, &rings.top_ring);
            sample.vz = mean_z(&film.state.velocities, &rings.top_ring);
        }
        let nodes = film.system.model.mass.iter().zip(film.state.velocities.z.iter());
        let weight = film.system.gravity.z * film.state.time;
        Sample {
            time: film.state.time,
            passages: self.passages(),
            intersections: film.intersections().unwrap_or(0),
            support_impulse: nodes.map(|(mass, speed)| mass * (speed - weight)).sum(),
            volume: self.volume(),
            pressure: film.state.pressure,
            temperature: match film.system.pressure_load {
                PressureLoad::Gas(gas) => gas.temperature(film.state.gas),
                PressureLoad::Overpressure(_) => self.temperature,
            },
            lid_force: if phase.packed { self.lid_force() } else { 0.0 },
            ledger: film.ledger(),
            gas: film.gas_balance(),
            ..sample
        }
    }

    fn positions(&self) -> Option<Field> {
        Some(self.view().state.positions.clone())
    }

    fn has_rings(&self) -> bool {
        self.rings.is_some()
    }

    fn tracks(&self) -> Vec<Track> {
        tracks::names(self)
    }

    fn follow(&self, values: &mut Vec<f64>) {
        tracks::values(self, values);
    }

    fn frame(&self) -> Option<Frame> {
        Some(tracks::frame(self))
    }

    fn surface(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let triangles = self.view().system.model.triangles.clone();
        let storeys = match &self.rings {
            Some(rings) => rings.storeys.clone(),
            None => vec![0; triangles.len()],
        };
        (triangles, storeys)
    }

    fn film_stress(&self) -> f64 {
        self.view().accounting().film_stress
    }

    fn steps(&self) -> u64 {
        self.view().steps()
    }

    fn elements(&self) -> usize {
        self.view().system.model.elements()
    }

    fn counts_passages(&self) -> bool {
        self.view().system.contact.is_some()
    }

    fn passages(&self) -> u64 {
        self.view().passages().unwrap_or(0)
    }

    fn can_store(&self) -> bool {
        self.film.is_audited()
    }

    fn checkpoint(&self, fingerprint: &str, run: &Run) -> Option<CheckpointText> {
        Some(Checkpoint::text(fingerprint, &self.film.stored()?, run))
    }
}
