//! What most of the tests use.

pub use billow_solver::collision::contact::BroadPhaseFault;
pub use billow_solver::geometry::field::Field;
pub use billow_solver::geometry::fold::{Chirality, Fit, FoldDesign, FoldPattern};
pub use billow_solver::geometry::mesh::{Mesh, Shape};
pub use billow_solver::geometry::shell::Shell;
pub use billow_solver::integrators::dormand_prince::Control;
pub use billow_solver::integrators::explicit::StoredExplicit;
pub use billow_solver::integrators::{
    FilmSimulation, SimulationSettings, StoredFilm, StoredIntegrator,
};
pub use billow_solver::mechanics::film_model::FilmModel;
pub use billow_solver::mechanics::gas::{Gas, GasState};
pub use billow_solver::mechanics::supports::Supports;
pub use billow_solver::models::Stored;
pub use billow_solver::models::film::FilmRun;
pub use billow_solver::models::piston::{EndFilm, Piston, PistonRun, PistonState};
pub use billow_solver::models::run::{Answer, Model, Observer, Pause, Progress, Run, Unobserved};
pub use billow_solver::output::checkpoint::{Checkpoint, CheckpointError};
pub use billow_solver::output::events::EventKind;
pub use billow_solver::output::ledger::Ledger;
pub use billow_solver::output::outcome::{Deployment, FailureKind, Stop};
pub use billow_solver::platform::simd::InstructionSet;
pub use billow_solver::scene::error::SceneError;
pub use billow_solver::scene::film_scene::{Filling, FilmContact, FilmScene};
pub use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
pub use billow_solver::scene::inflow::Inflow;
pub use billow_solver::scene::monitor_settings::MonitorSettings;
pub use billow_solver::scene::motion::{Motion, Profile};
pub use billow_solver::scene::plate::Plate;
pub use billow_solver::scene::timeline::{Phase, Timeline};
pub use billow_solver::scene::{
    Creases, DEFAULT_CFL, Film, GasSupply, HeatTransfer, IntegratorKind, ModelKind, Scene, Species,
    Stepping, Support, SupportLocation,
};
pub use billow_solver::system::{FilmState, FilmSystem, PressureLoad, Workspace};
pub use nalgebra::{DMatrix, Matrix3, Vector3};
