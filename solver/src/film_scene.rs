//! What a run of film needs, of any shape: a capsule's scene becomes one, and so does any mesh.
//!
//! Plain data, resolved: nodes by number, SI, nothing called "auto". [`crate::ladder::film`] runs
//! it.

use nalgebra::Vector3;

use crate::audit::watch::Watchfulness;
use crate::contact::plates::Plate;
use crate::scene::{Contact, Film, GasSupply};
use crate::shell::Shell;
use crate::simd::Path;

/// Everything one run of film needs.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmScene {
    /// The film: where it starts, where it is free of stress.
    pub shell: Shell,
    /// Velocity of each node at the start, m/s; none for a start at rest.
    pub velocities: Vec<Vector3<f64>>,
    /// Material.
    pub film: Film,
    /// What presses from inside.
    pub filling: Filling,
    /// What holds the film, or moves it.
    pub supports: Vec<FilmSupport>,
    /// Film against film; `None` lets film pass through film.
    pub contact: Option<FilmContact>,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Until when every node is held where it starts and only the gas goes on, s.
    pub release_time: f64,
    /// How it is computed.
    pub solver: FilmSolver,
    /// What is followed.
    pub outputs: FilmOutputs,
}

/// What presses from inside.
#[derive(Debug, Clone, PartialEq)]
pub enum Filling {
    /// This overpressure, Pa, whatever the volume; the film may be open.
    Pressure(f64),
    /// Gas in the closed volume.
    Gas {
        /// The gas, and what enters and leaves it.
        supply: GasSupply,
        /// Its temperature at the start, K.
        initial_temperature: f64,
    },
}

/// How film meets film.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmContact {
    /// Contact distance, m; `None`: 0.4 of the smallest gap at the start
    /// ([`crate::contact::Law::of_film`]).
    pub distance: Option<f64>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Pull-off pressure of adhesion, Pa.
    pub adhesion: f64,
    /// Its range beyond the contact distance, m; `None`: the contact distance.
    pub adhesion_range: Option<f64>,
    /// Rigid plates the film lies against.
    pub plates: Vec<Plate>,
    /// How closely passages are watched for.
    pub watch: Watchfulness,
}

impl FilmContact {
    /// The contact a capsule's scene names.
    pub fn of(contact: &Contact) -> Self {
        let Contact { distance, friction, adhesion } = *contact;
        Self { distance, friction, adhesion, ..Self::default() }
    }
}

impl Default for FilmContact {
    fn default() -> Self {
        Self {
            distance: None,
            friction: 0.0,
            adhesion: 0.0,
            adhesion_range: None,
            plates: Vec::new(),
            watch: Watchfulness::FRAMES,
        }
    }
}

/// One support.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmSupport {
    /// Name, as reactions are told by.
    pub name: String,
    /// Nodes, in ascending order.
    pub nodes: Vec<u32>,
    /// What is held.
    pub hold: Hold,
    /// How what is held moves; `None` stands.
    pub motion: Option<Motion>,
}

/// What a support holds of its nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// These displacement components: x, y, z.
    Components([bool; 3]),
    /// The component along this unit normal: a rigid plane that stands.
    Plane(Vector3<f64>),
    /// The component along a rigid plane's normal; the plane moves along it as a free body.
    Body(PlaneBody),
}

/// A rigid plane that moves along its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneBody {
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// Its mass without the film bound to it, kg.
    pub mass: f64,
    /// Its velocity along the normal at the start, m/s.
    pub velocity: f64,
    /// A constant force on it along the normal, N (weight included, where there is any).
    pub force: f64,
}

/// A prescribed motion: translation and turn, growing from nothing at `from` to the whole at `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Start, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// How it grows in between.
    pub profile: Profile,
    /// Translation, m.
    pub translation: Vector3<f64>,
    /// Turn about an axis.
    pub turn: Option<Turn>,
}

/// How a prescribed motion grows, τ = (t − from)/(to − from).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// τ: constant velocity.
    Linear,
    /// 3τ² − 2τ³: starts and ends at rest.
    Smooth,
}

/// A turn about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Unit axis.
    pub axis: Vector3<f64>,
    /// A point on it, m.
    pub centre: Vector3<f64>,
    /// Angle, rad.
    pub angle: f64,
}

/// How film is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSolver {
    /// Share of the stable step, above 0, at most 1.
    pub cfl: f64,
    /// Simulated time, s; no meaning for statics.
    pub end_time: f64,
    /// Look for the state of rest under the pressure instead of moving; needs [`Filling::Pressure`].
    pub statics: bool,
    /// Mass damping c, 1/s.
    pub mass_damping: f64,
    /// Accepted steps after which a run stops with `step_limit`.
    pub step_limit: u64,
    /// Instruction set; the bits are the same on each.
    pub path: Path,
}

/// What is followed of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmOutputs {
    /// Time between samples, s.
    pub sample_interval: f64,
    /// Nodes whose places are followed.
    pub nodes: Vec<u32>,
    /// Elements whose stress resultants are followed.
    pub elements: Vec<u32>,
    /// Shapes kept ([`crate::frames`]); 0 for none.
    pub frames: u32,
}

impl Motion {
    /// How much of the motion is done at `time` (s), 0 to 1.
    pub fn part(&self, time: f64) -> f64 {
        let part = ((time - self.from) / (self.to - self.from)).clamp(0.0, 1.0);
        match self.profile {
            Profile::Linear => part,
            Profile::Smooth => part * part * (3.0 - 2.0 * part),
        }
    }

    /// Where a point that starts at `place` (m) is at `time` (s).
    pub fn place(&self, place: Vector3<f64>, time: f64) -> Vector3<f64> {
        let part = self.part(time);
        let turned = self.turn.map_or(place, |turn| turn.by(part, place));
        turned + self.translation * part
    }
}

impl Turn {
    /// A point (m) turned by this part of the angle (Rodrigues' formula).
    fn by(&self, part: f64, place: Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(part * self.angle);
        let arm = place - self.centre;
        let along = self.axis * self.axis.dot(&arm);
        let across = arm - along;
        self.centre + along + across * cos + self.axis.cross(&across) * sin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_ends_where_it_says() {
        let turn = Turn {
            axis: Vector3::z(),
            centre: Vector3::new(1.0, 0.0, 0.0),
            angle: core::f64::consts::FRAC_PI_2,
        };
        let motion = Motion {
            from: 1.0,
            to: 3.0,
            profile: Profile::Smooth,
            translation: Vector3::new(0.0, 0.0, 2.0),
            turn: Some(turn),
        };
        let start = Vector3::new(2.0, 0.0, 5.0);
        assert!((motion.place(start, 0.5) - start).norm() < 1e-15);
        let half = motion.place(start, 2.0);
        let cos = 0.5_f64.sqrt();
        assert!((half - Vector3::new(1.0 + cos, cos, 6.0)).norm() < 1e-15, "{half}");
        assert!((motion.place(start, 9.0) - Vector3::new(1.0, 1.0, 7.0)).norm() < 1e-15);
    }
}
