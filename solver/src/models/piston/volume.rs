//! V(z): the volume below the moving top.
//!
//! ```text
//! z ≤ z_s:      V = V_s z/z_s
//! z_s < z < H:  cubic Hermite, dV/dz = V_s/z_s at z_s and V_e/H at H
//! z ≥ H:        V = V_e z/H
//! ```
//!
//! At both ends the shape stretches uniformly along its axis, so dV/dz = V/z there.

/// A volume as a function of one height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VolumeLaw {
    /// V = A z + V0: a piston in a tube; a rigid tank for A = 0.
    Uniform {
        /// A, m².
        area: f64,
        /// V0, m³.
        offset: f64,
    },
    /// From a stowed to an erected capsule: [`Stroke`].
    Stroke(Stroke),
}

impl VolumeLaw {
    /// V(z), m³.
    pub fn volume(&self, z: f64) -> f64 {
        match self {
            Self::Uniform { area, offset } => area * z + offset,
            Self::Stroke(stroke) => stroke.volume(z),
        }
    }

    /// dV/dz, m².
    pub fn slope(&self, z: f64) -> f64 {
        match self {
            Self::Uniform { area, .. } => *area,
            Self::Stroke(stroke) => stroke.slope(z),
        }
    }
}

/// The stroke of a capsule from its stowed to its erected shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    stowed_height: f64,
    erected_height: f64,
    stowed_slope: f64,
    erected_slope: f64,
    /// V − `V_s` in x = (z − `z_s`)/(H − `z_s`): b x + c x² + d x³.
    cubic: [f64; 3],
}

impl Stroke {
    /// The stroke between two shapes, each with its height (m) and volume (m³).
    ///
    /// # Errors
    /// A message if there is no such stroke, or if the volume does not rise throughout.
    pub fn new(
        (stowed_height, stowed_volume): (f64, f64),
        (erected_height, erected_volume): (f64, f64),
    ) -> Result<Self, String> {
        let positive = stowed_height > 0.0 && stowed_volume > 0.0 && erected_volume > 0.0;
        if !(positive && stowed_height < erected_height) {
            return Err(format!(
                "no stroke from {stowed_height} m, {stowed_volume} m³ to {erected_height} m, \
                 {erected_volume} m³; the stowed height must be above 0 and below the erected one"
            ));
        }
        let length = erected_height - stowed_height;
        let stowed_slope = stowed_volume / stowed_height;
        let erected_slope = erected_volume / erected_height;
        let (b, e) = (length * stowed_slope, length * erected_slope);
        let rise = erected_volume - stowed_volume;
        let cubic = [b, 3.0 * rise - 2.0 * b - e, b + e - 2.0 * rise];
        let stroke = Self { stowed_height, erected_height, stowed_slope, erected_slope, cubic };
        let min_slope = stroke.min_slope();
        if min_slope <= 0.0 {
            return Err(format!(
                "the volume does not rise throughout the stroke from {stowed_height} m, \
                 {stowed_volume} m³ to {erected_height} m, {erected_volume} m³: its slope falls to \
                 {min_slope} m²; allowed: a stowed shape nearer to the erected one"
            ));
        }
        Ok(stroke)
    }

    /// Smallest dV/dz between the ends, m².
    fn min_slope(&self) -> f64 {
        let length = self.erected_height - self.stowed_height;
        let ends = self.stowed_slope.min(self.erected_slope);
        let [_, c, d] = self.cubic;
        let extremum = -c / (3.0 * d);
        if d > 0.0 && extremum > 0.0 && extremum < 1.0 {
            ends.min(self.slope(self.stowed_height + extremum * length))
        } else {
            ends
        }
    }

    /// V(z), m³.
    pub fn volume(&self, z: f64) -> f64 {
        if z <= self.stowed_height {
            self.stowed_slope * z
        } else if z >= self.erected_height {
            self.erected_slope * z
        } else {
            let [b, c, d] = self.cubic;
            let x = (z - self.stowed_height) / (self.erected_height - self.stowed_height);
            self.stowed_slope * self.stowed_height + x * (b + x * (c + x * d))
        }
    }

    /// dV/dz, m².
    pub fn slope(&self, z: f64) -> f64 {
        if z <= self.stowed_height {
            self.stowed_slope
        } else if z >= self.erected_height {
            self.erected_slope
        } else {
            let [b, c, d] = self.cubic;
            let length = self.erected_height - self.stowed_height;
            let x = (z - self.stowed_height) / length;
            (b + x * (2.0 * c + x * 3.0 * d)) / length
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_stroke_whose_volume_falls_is_refused() {
        let error = Stroke::new((0.1, 0.5), (1.0, 0.51)).unwrap_err();
        assert!(error.contains("does not rise"), "{error}");
        assert!(Stroke::new((1.0, 0.1), (0.5, 0.2)).is_err());
        assert!(Stroke::new((0.0, 0.1), (0.5, 0.2)).is_err());
        assert!(Stroke::new((0.1, f64::NAN), (0.5, 0.2)).is_err());
    }

    proptest! {
        #[test]
        fn the_volume_is_smooth_and_the_slope_is_its_derivative(
            stowed_height in 0.01..0.2_f64,
            stowed_volume in 0.002..0.05_f64,
            height in 0.5..2.0_f64,
            volume in 0.3..2.0_f64,
            share in 0.0..1.3_f64,
        ) {
            let Ok(stroke) = Stroke::new((stowed_height, stowed_volume), (height, volume)) else {
                return Ok(());
            };
            prop_assert!((stroke.volume(stowed_height) / stowed_volume - 1.0).abs() < 1e-13);
            prop_assert!((stroke.volume(height) / volume - 1.0).abs() < 1e-13);
            for end in [stowed_height, height] {
                let gap = 1e-9 * end;
                prop_assert!((stroke.slope(end - gap) - stroke.slope(end + gap)).abs() < 1e-6);
                prop_assert!((stroke.volume(end - gap) - stroke.volume(end + gap)).abs() < 1e-7);
            }
            let (z, gap) = (share * height, 1e-6);
            let difference = (stroke.volume(z + gap) - stroke.volume(z - gap)) / (2.0 * gap);
            prop_assert!((difference - stroke.slope(z)).abs() < 1e-5);
            prop_assert!(stroke.slope(z) > 0.0);
        }
    }
}
