//! Film of revolution under pressure, by integration along its meridian. It shares no code with the
//! elements.
//!
//! ```text
//! (R t S1 r')' = t S2 r/R ∓ p r z'          R t S1 z' = ± p r²/2 + C
//! e1 = (r'² + z'² − 1)/2,  e2 = ((r/R)² − 1)/2
//! S1 = E/(1−ν²) (e1 + ν e2), S2 = E/(1−ν²) (e2 + ν e1);   S1 = E e1, S2 = 0 where e2 + ν e1 ≤ 0
//! ```
//!
//! Symbols: s arc length and R radius of the meridian free of stress; r, z where it is, ' = d/ds; p
//! overpressure; C an axial force over 2π, N. The upper sign holds where the meridian rises, seen with the
//! gas on its left. Classical Runge-Kutta rule in x = √(s/L), whose steps are short near a pole; unknown
//! values at the ends by bisection or Newton's method ("shooting").

use core::f64::consts::PI;

/// Film of one material.
#[derive(Debug, Clone, Copy)]
pub struct Film {
    /// E, Pa.
    pub youngs_modulus: f64,
    /// ν.
    pub poisson_ratio: f64,
    /// t, m.
    pub thickness: f64,
}

/// A meridian with a straight reference.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// R at s = 0, m.
    radius: f64,
    /// dR/ds.
    slope: f64,
    /// Length, m.
    length: f64,
    /// ±p, Pa: the sign of the direction.
    pressure: f64,
    /// C, N.
    axial: f64,
}

/// State at a point of a meridian.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// r, m.
    pub radius: f64,
    /// z, m.
    pub height: f64,
    /// R t S1 r', N.
    pub radial_force: f64,
    /// Volume enclosed since s = 0, m³.
    pub volume: f64,
}

/// Length before the integration from a pole begins, in steps of x. Chosen: short enough to be flat, long
/// enough that the first step is accurate.
const POLE_STEPS: f64 = 4.0;
/// Upper bound of the number of iterations of a search. Chosen: far above what any needs.
const MAX_ITERATIONS: u32 = 200;
/// Relative change at which a search ends. Chosen: near the rounding error.
const TOLERANCE: f64 = 1e-12;

impl Film {
    fn plane_modulus(&self) -> f64 {
        self.youngs_modulus / (1.0 - self.poisson_ratio * self.poisson_ratio)
    }

    /// Meridional stretch and S2 (Pa) at a nominal meridional stress S1 λ1 (Pa) and e2.
    fn stretch(&self, nominal: f64, hoop: f64) -> (f64, f64) {
        let (full, nu) = (self.plane_modulus(), self.poisson_ratio);
        // S1, its derivative by e1, S2.
        let response = |stretch: f64| {
            let strain = 0.5 * (stretch * stretch - 1.0);
            if hoop + nu * strain > 0.0 {
                (full * (strain + nu * hoop), full, full * (hoop + nu * strain))
            } else {
                (self.youngs_modulus * strain, self.youngs_modulus, 0.0)
            }
        };
        let mut stretch = 1.0;
        while response(stretch).0 * stretch < nominal {
            stretch *= 2.0;
        }
        // Newton's method from above: S1 λ1 is convex.
        for _ in 0..MAX_ITERATIONS {
            let (stress, modulus, _) = response(stretch);
            let step = (stress * stretch - nominal) / (modulus * stretch * stretch + stress);
            stretch -= step;
            if step.abs() < 1e-15 * stretch {
                break;
            }
        }
        (stretch, response(stretch).2)
    }
}

impl Line {
    /// Derivatives by s of r, z, radial force and volume.
    fn derivatives(&self, film: &Film, s: f64, [r, _, radial, _]: [f64; 4]) -> [f64; 4] {
        let reference = self.radius + self.slope * s;
        let vertical = 0.5 * self.pressure * r * r + self.axial;
        let force = (radial * radial + vertical * vertical).sqrt();
        let hoop = r / reference;
        let (stretch, stress) =
            film.stretch(force / (reference * film.thickness), 0.5 * (hoop * hoop - 1.0));
        let (outward, upward) = (stretch * radial / force, stretch * vertical / force);
        let rising = self.pressure.signum();
        [
            outward,
            upward,
            film.thickness * stress * hoop - self.pressure * r * upward,
            rising * PI * r * r * upward,
        ]
    }

    /// State at the end from the state at x = `from`.
    fn integrate(&self, film: &Film, from: f64, start: Point, steps: u32) -> Point {
        let mut y = [start.radius, start.height, start.radial_force, start.volume];
        let h = (1.0 - from) / f64::from(steps);
        let slope = |x: f64, y: [f64; 4]| {
            let factor = 2.0 * x * self.length;
            self.derivatives(film, x * x * self.length, y).map(|entry| factor * entry)
        };
        let along = |y: [f64; 4], k: [f64; 4], h: f64| {
            core::array::from_fn::<f64, 4, _>(|index| y[index] + h * k[index])
        };
        for step in 0..steps {
            let x = from + f64::from(step) * h;
            let a = slope(x, y);
            let b = slope(x + 0.5 * h, along(y, a, 0.5 * h));
            let c = slope(x + 0.5 * h, along(y, b, 0.5 * h));
            let d = slope(x + h, along(y, c, h));
            for index in 0..4 {
                y[index] += h / 6.0 * (a[index] + 2.0 * (b[index] + c[index]) + d[index]);
            }
        }
        Point { radius: y[0], height: y[1], radial_force: y[2], volume: y[3] }
    }
}

/// A flat disc of this radius (m) from its pole with this stretch, outward; its height counts from the
/// pole. `pressure` (Pa): positive where the film rises from the pole.
fn disc_from_pole(film: &Film, radius: f64, pressure: f64, stretch: f64, steps: u32) -> Point {
    let line = Line { radius: 0.0, slope: 1.0, length: radius, pressure, axial: 0.0 };
    let from = POLE_STEPS / f64::from(steps);
    let s = radius * from * from;
    let strain = 0.5 * (stretch * stretch - 1.0);
    let stress = film.youngs_modulus / (1.0 - film.poisson_ratio) * strain;
    let force = s * film.thickness * stress * stretch;
    let start = Point { radius: stretch * s, height: 0.0, radial_force: force, volume: 0.0 };
    line.integrate(film, from, start, steps)
}

/// Stretch at the pole, height (m) and volume (m³) of a disc of this radius (m), held at its rim.
pub fn held_disc(film: &Film, radius: f64, pressure: f64, steps: u32) -> [f64; 3] {
    let at = |stretch: f64| disc_from_pole(film, radius, -pressure, stretch, steps);
    let (mut low, mut high) = (1.0 + 1e-6, 2.0);
    while high - low > TOLERANCE {
        let middle = 0.5 * (low + high);
        if at(middle).radius > radius { high = middle } else { low = middle }
    }
    let rim = at(low);
    [low, -rim.height, rim.volume]
}

/// A frustum free of stress.
#[derive(Debug, Clone, Copy)]
pub struct Frustum {
    /// Radius at the bottom, m.
    pub bottom: f64,
    /// Radius at the top, m.
    pub top: f64,
    /// Height, m.
    pub height: f64,
}

impl Frustum {
    /// Its side under an overpressure (Pa), with an axial force C (N).
    fn side(&self, pressure: f64, axial: f64) -> Line {
        let inward = self.bottom - self.top;
        let length = (self.height * self.height + inward * inward).sqrt();
        Line { radius: self.bottom, slope: -inward / length, length, pressure, axial }
    }
}

/// Largest radius (m), and volume (m³), of the side of a frustum that is held at both rims.
///
/// # Errors
/// If the search does not converge.
pub fn held_frustum(
    film: &Film,
    shape: &Frustum,
    pressure: f64,
    steps: u32,
) -> Result<[f64; 2], String> {
    let unit = film.youngs_modulus * film.thickness;
    let radius = shape.bottom;
    // Unknowns: radial and axial force at the bottom over E t R.
    let line = |pressure: f64, [_, axial]: [f64; 2]| {
        shape.side(pressure, axial * unit * radius - 0.5 * pressure * radius * radius)
    };
    let start = |[radial, _]: [f64; 2]| Point {
        radius,
        height: 0.0,
        radial_force: radial * unit * radius,
        volume: 0.0,
    };
    let miss = |pressure: f64, unknown: [f64; 2]| {
        let end = line(pressure, unknown).integrate(film, 0.0, start(unknown), steps);
        [end.radius / shape.top - 1.0, end.height / shape.height - 1.0]
    };
    let unknown = follow([0.1, 0.2], 0.5 * unit / radius, pressure, miss)?;
    let whole = line(pressure, unknown);
    // The largest radius: the end of the part whose radial force is positive.
    let part = |fraction: f64| {
        Line { length: fraction * whole.length, ..whole }.integrate(
            film,
            0.0,
            start(unknown),
            steps,
        )
    };
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if part(middle).radial_force > 0.0 { low = middle } else { high = middle }
    }
    Ok([part(low).radius, part(1.0).volume])
}

/// Volume (m³), rim radii (m, bottom and top), height between rims and between poles (m) of a frustum
/// with flat caps, a free body.
///
/// # Errors
/// If the search does not converge.
pub fn capped_frustum(
    film: &Film,
    shape: &Frustum,
    pressure: f64,
    steps: u32,
) -> Result<[f64; 5], String> {
    let unit = film.youngs_modulus * film.thickness;
    // Unknowns: stretches at both poles. Film and radial force continue over both rims.
    let parts = |pressure: f64, [bottom, top]: [f64; 2]| {
        let bottom = disc_from_pole(film, shape.bottom, pressure, bottom, steps);
        let side = shape.side(pressure, 0.0).integrate(film, 0.0, bottom, steps);
        (bottom, side, disc_from_pole(film, shape.top, -pressure, top, steps))
    };
    let miss = |pressure: f64, unknown: [f64; 2]| {
        let (_, side, top) = parts(pressure, unknown);
        let force = side.radial_force + top.radial_force;
        [(side.radius - top.radius) / shape.top, force / (unit * shape.bottom)]
    };
    let unknown = follow([1.1, 1.1], 0.2 * unit / shape.bottom, pressure, miss)?;
    let (bottom, side, top) = parts(pressure, unknown);
    Ok([
        side.volume + top.volume,
        bottom.radius,
        side.radius,
        side.height - bottom.height,
        side.height - top.height,
    ])
}

/// Two unknowns for which both misses vanish at a pressure (Pa), followed from a guess at another pressure by
/// factors of at most 1.1.
fn follow(
    guess: [f64; 2],
    from: f64,
    to: f64,
    miss: impl Fn(f64, [f64; 2]) -> [f64; 2],
) -> Result<[f64; 2], String> {
    let (mut pressure, mut unknown) = (from, guess);
    loop {
        unknown = shoot(unknown, |unknown| miss(pressure, unknown))?;
        if (pressure - to).abs() <= 0.0 {
            return Ok(unknown);
        }
        pressure = to.clamp(pressure / 1.1, pressure * 1.1);
    }
}

/// Two unknowns for which both misses vanish: Newton's method with differences, halving steps that do not
/// lower the misses.
fn shoot(start: [f64; 2], miss: impl Fn([f64; 2]) -> [f64; 2]) -> Result<[f64; 2], String> {
    let size = |[a, b]: [f64; 2]| (a * a + b * b).sqrt();
    let (mut at, mut missed) = (start, miss(start));
    for _ in 0..MAX_ITERATIONS {
        let h = [0, 1].map(|index: usize| 1e-7 * at[index].abs());
        let [[a, c], [b, d]] = [0, 1].map(|index: usize| {
            let mut moved = at;
            moved[index] += h[index];
            let moved = miss(moved);
            [0, 1].map(|row: usize| (moved[row] - missed[row]) / h[index])
        });
        let determinant = a * d - b * c;
        let step = [
            (b * missed[1] - d * missed[0]) / determinant,
            (c * missed[0] - a * missed[1]) / determinant,
        ];
        let mut fraction = 1.0;
        loop {
            let trial = [at[0] + fraction * step[0], at[1] + fraction * step[1]];
            let found = miss(trial);
            if size(found) < size(missed) {
                (at, missed) = (trial, found);
                break;
            }
            fraction *= 0.5;
            if fraction < 1e-6 {
                // Rounding errors end the descent.
                return if size(missed) < 1e-9 { Ok(at) } else { Err(lost(at)) };
            }
        }
        if size(missed) < TOLERANCE {
            return Ok(at);
        }
    }
    Err(lost(at))
}

fn lost(at: [f64; 2]) -> String {
    format!("the meridian does not meet its ends: last tried {at:?}")
}
