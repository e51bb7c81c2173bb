//! Prescribed motion of supports and plates.

use nalgebra::Vector3;

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
