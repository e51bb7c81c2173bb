//! Prescribed motion of supports and plates.
//!
//! ```text
//! x(t) = c + R(s α) (x0 − c) + s u          s = profile(τ),  τ = (t − from)/(to − from) in [0, 1]
//! ```
//!
//! Symbols: x0 initial position, u translation, R rotation about an axis through the centre c by the
//! angle α.

use nalgebra::Vector3;

/// A prescribed motion: a rotation and a translation that grow from zero at `from` to their full size
/// at `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Start, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// Growth between start and end.
    pub profile: Profile,
    /// Translation, m.
    pub translation: Vector3<f64>,
    /// Rotation about an axis.
    pub rotation: Option<Rotation>,
}

/// Growth of a prescribed motion, s(τ).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// τ: constant velocity.
    Linear,
    /// 3τ² − 2τ³: starts and ends at rest.
    Smooth,
}

/// A rotation about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Unit axis.
    pub axis: Vector3<f64>,
    /// A point on it, m.
    pub centre: Vector3<f64>,
    /// Angle, rad.
    pub angle: f64,
}

impl Motion {
    /// s, the completed fraction of the motion at `time` (s), 0 to 1.
    pub fn fraction(&self, time: f64) -> f64 {
        let tau = ((time - self.from) / (self.to - self.from)).clamp(0.0, 1.0);
        match self.profile {
            Profile::Linear => tau,
            Profile::Smooth => tau * tau * (3.0 - 2.0 * tau),
        }
    }

    /// Position (m) at `time` (s) of a point with this initial position (m).
    pub fn position(&self, initial: Vector3<f64>, time: f64) -> Vector3<f64> {
        let fraction = self.fraction(time);
        let rotated = self.rotation.map_or(initial, |rotation| rotation.apply(fraction, initial));
        rotated + self.translation * fraction
    }
}

impl Rotation {
    /// A point (m) rotated by this fraction of the angle (Rodrigues' formula).
    fn apply(&self, fraction: f64, point: Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(fraction * self.angle);
        let arm = point - self.centre;
        let along = self.axis * self.axis.dot(&arm);
        let across = arm - along;
        self.centre + along + across * cos + self.axis.cross(&across) * sin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_ends_at_its_full_rotation_and_translation() {
        let rotation = Rotation {
            axis: Vector3::z(),
            centre: Vector3::new(1.0, 0.0, 0.0),
            angle: core::f64::consts::FRAC_PI_2,
        };
        let motion = Motion {
            from: 1.0,
            to: 3.0,
            profile: Profile::Smooth,
            translation: Vector3::new(0.0, 0.0, 2.0),
            rotation: Some(rotation),
        };
        let start = Vector3::new(2.0, 0.0, 5.0);
        assert!((motion.position(start, 0.5) - start).norm() < 1e-15);
        let half = motion.position(start, 2.0);
        let cos = 0.5_f64.sqrt();
        assert!((half - Vector3::new(1.0 + cos, cos, 6.0)).norm() < 1e-15, "{half}");
        assert!((motion.position(start, 9.0) - Vector3::new(1.0, 1.0, 7.0)).norm() < 1e-15);
    }
}
