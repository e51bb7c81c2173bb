//! The scenes with an exact answer (or none but their finest mesh) at several meshes and steps, for work-precision
//! diagrams.
//!
//! ```text
//! seconds = wall time on one thread over the simulated time;  of a scene at rest, the wall time
//! ```
//! They run the code of the cases of the same names. Relaxation and set-up before the motion do not count.

use super::Rig;
use crate::exact_scenes::ExactScene;

mod airbag;
mod meter;
mod piston;
mod vibrations;

/// A scene: its name and the function that runs it.
pub struct Scene {
    /// Name.
    pub name: &'static str,
    /// Runs it at every mesh and step, with every integrator that can.
    pub body: fn(&Rig) -> Result<ExactScene, String>,
}

/// Every scene.
pub const SCENES: [Scene; 4] = [
    Scene { name: "injected_piston", body: piston::injected_piston },
    Scene { name: "breathing_sphere", body: vibrations::breathing_sphere },
    Scene { name: "square_airbag", body: airbag::square_airbag },
    Scene { name: "stretched_disc", body: vibrations::stretched_disc },
];
