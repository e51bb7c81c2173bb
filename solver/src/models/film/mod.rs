//! Film of any shape, explicit in time, with contact or without.
//!
//! Tension-field triangles ([`crate::mechanics::forces`]), a pressure or one gas volume, central differences
//! ([`crate::integrators::explicit`]), film against film ([`crate::collision::contact`]). A capsule is one such
//! film, with rings. Passages are counted by an audit of its own and intersections at every sample;
//! the first of either ends the run as `interpenetrated`. Without contact film passes through film:
//! for unfolded shapes and for checks of energy; both counts come out as `None`.
//!
//! While packed, film with contact lies between a base and a lid, two plates at the contact distance
//! from it, and moves between them as the gas lets it; the lid's force is what it bears. Without
//! contact every node is held where it is stowed, and the lid's force is the one that does the work of
//! a uniform stretch of the stack, Σ `f_z` z/h; film that is no capsule has then no lid to press on.

use nalgebra::Vector3;

use super::Cost;
use crate::geometry::field::Field;
use crate::geometry::mesh::{Mesh, Part, Shape};
use crate::integrators::explicit::{Explicit, PressureLoad, State};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::damping;
use crate::models::run::{self, Model, Observer};
use crate::output::frames::Frame;
use crate::output::history::{Sample, Track};
use crate::output::measures::Reference;
use crate::output::outcome::{Deployment, Failure};
use crate::platform::workers::Workers;
use crate::scene::error::SceneError;
use crate::scene::film_scene::{FilmContact, FilmScene};
use crate::scene::timeline::{Phase, Timeline};
use crate::scene::{Scene, Stepping};

pub mod capsule;
mod imperfection;
mod statics;
mod tracks;

pub use crate::statics::Relaxation;
pub use statics::{
    Erected, StaticState, erected, reference_scene, static_reference, static_reference_while,
    static_states,
};
pub use tracks::CONTACT as CONTACT_COLUMNS;

/// Runs a scene as film with this contact, at this share of the stable step, judged against
/// `reference` ([`static_reference`], or a stored one of the same design, film and supports).
///
/// # Errors
/// [`SceneError`] when the scene cannot be started.
pub fn solve(
    scene: &Scene,
    cfl: f64,
    contact: Option<FilmContact>,
    reference: Option<Reference>,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    let mut run = FilmRun::from_scene(scene, cfl, contact, reference)?;
    Ok(run::run(&mut run, &Timeline::new(scene), observer))
}

/// Runs a scene with the contact and the share of the stable step it names, by these workers.
///
/// # Errors
/// As [`check`], and what shows only with the capsule made.
pub fn solve_scene(
    workers: Workers,
    scene: &Scene,
    reference: Option<Reference>,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    let contact = FilmContact::of(&scene.contact);
    let mut run = FilmRun::from_scene(scene, stable_share(scene)?, Some(contact), reference)?;
    run.film.share_with(workers);
    Ok(run::run(&mut run, &Timeline::new(scene), observer))
}

/// Whether a scene is sound for this model, as far as that shows without its pattern.
///
/// # Errors
/// [`SceneError::Invalid`].
pub fn check(scene: &Scene) -> Result<(), SceneError> {
    scene.validate()?;
    stable_share(scene).map(|_| ())
}

/// Elements and steps of a run whose film never gets calm: the stable step of the film alone, to which
/// gas adds little.
///
/// # Errors
/// As [`solve_scene`].
pub fn cost(scene: &Scene) -> Result<Cost, SceneError> {
    let stowed = Shape::Stowed(scene.design.stowed_height);
    let (film, _) = capsule::film_scene(scene, stowed, stable_share(scene)?)?;
    let model = FilmModel::of_shell(&film.film, &film.shell).map_err(|error| {
        SceneError::Invalid { key: "design".to_owned(), problem: error.to_string() }
    })?;
    let share = damping::stable_share(scene.film.viscosity);
    let step = film.solver.cfl * share * 2.0 / model.largest_frequency();
    let interval = scene.outputs.sample_interval;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts above 0")]
    let steps = (libm::ceil(interval / step) * (scene.solver.end_time / interval)) as u64;
    Ok(Cost { elements: model.elements() as u64, steps })
}

fn stable_share(scene: &Scene) -> Result<f64, SceneError> {
    match scene.solver.stepping {
        Stepping::Stable(share) => Ok(share),
        Stepping::Adaptive(_) | Stepping::Fixed(_) => Err(SceneError::Invalid {
            key: "solver.stepping".to_owned(),
            problem: "model `film` takes a share of its stable step; allowed: solver.cfl"
                .to_owned(),
        }),
    }
}

/// Film in the middle of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmRun {
    /// The film.
    pub film: Explicit,
    rings: Option<Rings>,
    reference: Option<Reference>,
    nodes: Vec<u32>,
    elements: Vec<u32>,
    /// Boundary loops of an open film with what their fans are spun about, m.
    fans: Vec<(Vector3<f64>, Vec<u32>)>,
    /// `T_film`, K.
    temperature: f64,
}

/// What makes film a capsule.
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
}

impl Rings {
    /// The rings of a capsule's mesh, packed at this height (m).
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
        }
    }
}

impl FilmRun {
    /// A scene's film at time 0; with `rings` a capsule.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] when the film is none, or a number is out of range.
    pub fn of(scene: &FilmScene, rings: Option<Rings>) -> Result<Self, SceneError> {
        Ok(Self::with(capsule::start(scene)?, scene, rings))
    }

    /// A scene's film in a state stored of it, to go on bit for bit.
    ///
    /// # Errors
    /// As [`Self::of`]; a state of another film.
    pub fn resume(
        scene: &FilmScene,
        rings: Option<Rings>,
        state: State,
    ) -> Result<Self, SceneError> {
        let (model, setting, _) = capsule::constants(scene)?;
        let bodies = setting.supports.bodies.len();
        let fits = [&state.places, &state.velocities].iter().all(|field| {
            [&field.x, &field.y, &field.z].iter().all(|column| column.len() == model.nodes())
        });
        let fits = fits && state.past.len() == model.constants.len();
        if !fits || state.planes.len() != bodies {
            let problem = "the state is that of another film".to_owned();
            return Err(SceneError::Invalid { key: "mesh".to_owned(), problem });
        }
        Ok(Self::with(Explicit::resume(model, setting, state), scene, rings))
    }

    fn with(film: Explicit, scene: &FilmScene, rings: Option<Rings>) -> Self {
        let (nodes, elements) = (scene.outputs.nodes.clone(), scene.outputs.elements.clone());
        let temperature = scene.film.temperature;
        let fans = scene.shell.fans();
        Self { film, rings, reference: None, nodes, elements, fans, temperature }
    }

    /// The scene's capsule, stowed, at time 0, with this contact.
    ///
    /// # Errors
    /// As [`solve`].
    pub fn from_scene(
        scene: &Scene,
        cfl: f64,
        contact: Option<FilmContact>,
        reference: Option<Reference>,
    ) -> Result<Self, SceneError> {
        let stowed = Shape::Stowed(scene.design.stowed_height);
        let (film, mesh) = capsule::film_scene(scene, stowed, cfl)?;
        let film = FilmScene { contact, ..film };
        let run = Self::of(&film, Some(Rings::of(&mesh, scene.design.stowed_height)))?;
        Ok(Self { reference, ..run })
    }

    /// Force on the lid while packed, N.
    fn lid_force(&self, rings: &Rings) -> f64 {
        if let Some(law) = &self.film.setting.contact {
            let plates = law.plates.iter().zip(&self.film.state.meeting.plates);
            return plates.filter(|(p, _)| p.name == capsule::LID).map(|(_, own)| own.force).sum();
        }
        let lift: f64 = (0..self.film.model.nodes())
            .map(|node| self.film.force(node).z * self.film.state.places.z[node])
            .sum();
        (lift / rings.stowed_height).max(0.0)
    }

    /// Enclosed volume, m³; that of an open film between it and the fans over its free edges.
    pub fn volume(&self) -> f64 {
        let place = |node: u32| self.film.state.places.get(node as usize);
        let fan = |(apex, path): &(Vector3<f64>, Vec<u32>)| -> f64 {
            let edge =
                |k: usize| place(path[k]).dot(&place(path[(k + 1) % path.len()]).cross(apex));
            (0..path.len()).map(edge).sum()
        };
        let own = self.film.state.volume;
        if self.fans.is_empty() { own } else { own + self.fans.iter().map(fan).sum::<f64>() / 6.0 }
    }

    /// Largest height of any node with mass, m.
    fn largest_height(&self) -> f64 {
        let masses = self.film.model.mass.iter().zip(self.film.state.places.z.iter());
        masses.filter(|(mass, _)| **mass > 0.0).map(|(_, z)| *z).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Mean of a field's z over these nodes.
fn mean_z(field: &Field, nodes: &[u32]) -> f64 {
    nodes.iter().map(|node| field.z[*node as usize]).sum::<f64>() / nodes.len() as f64
}

impl Model for FilmRun {
    fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure> {
        self.film.advance(target, phase)
    }

    fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
    ) -> Result<bool, Failure> {
        self.film.advance_at_most(target, phase, steps)
    }

    fn sample(&self, phase: &Phase) -> Sample {
        let film = &self.film;
        let places = &film.state.places;
        let (mut sample, mut lid_force) = (Sample::default(), 0.0);
        if let Some(rings) = &self.rings {
            let centre = rings.top_centre as usize;
            sample.z_centre = places.z[centre];
            sample.z_rim = mean_z(places, &rings.top_ring);
            sample.vz = mean_z(&film.velocities(), &rings.top_ring);
            lid_force = if phase.packed { self.lid_force(rings) } else { 0.0 };
        }
        Sample {
            time: film.state.time,
            passages: self.passages(),
            intersections: film.intersections(),
            z_max: self.largest_height(),
            volume: self.volume(),
            pressure: film.state.pressure,
            temperature: match film.setting.interior {
                PressureLoad::Gas(gas) => gas.temperature(film.state.gas),
                PressureLoad::Overpressure(_) => self.temperature,
            },
            lid_force,
            ledger: film.ledger(),
            gas: film.books(),
            ..sample
        }
    }

    fn reference(&self) -> Option<Reference> {
        self.reference.clone()
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
        let triangles = self.film.model.triangles.clone();
        let storeys = match &self.rings {
            Some(rings) => rings.storeys.clone(),
            None => vec![0; triangles.len()],
        };
        (triangles, storeys)
    }

    fn film_stress(&self) -> f64 {
        self.film.state.film_stress
    }

    fn steps(&self) -> u64 {
        self.film.state.steps
    }

    fn elements(&self) -> usize {
        self.film.model.elements()
    }

    fn counts_passages(&self) -> bool {
        self.film.setting.contact.is_some()
    }

    fn passages(&self) -> u64 {
        self.film.watch.as_ref().map_or(0, |watch| watch.passages)
    }
}
