//! Whether bending may change the results of a study, and whether creases without `film.yield_moment` would yield.
//!
//! ```text
//! l = (D/p)^(1/3)              length over which gas of pressure p bends film
//! σ = E t θ/(2 L*)             stress of the surface of a crease that is turned by θ
//! ```

use core::f64::consts::PI;

use billow_solver::scene::inflow::Schedule;
use billow_solver::scene::{Film, ModelKind};

use crate::input::value::brief_number;
use crate::job::point::Point;
use crate::study::Study;

/// Length over which gas bends film, over the bottom radius, from which on bending may change results. Between what was
/// measured: nothing beyond the seed up to 0.035, up to a tenth of the volume from 0.07 on (`docs/experiments.md`).
const LONG_BEND: f64 = 0.05;

fn film_points(study: &Study) -> impl Iterator<Item = &Point> {
    study.points().iter().filter(|point| point.job.scene.solver.model == ModelKind::Film)
}

/// The largest length over which the gas of a point bends its film while no gas flows in, m, and over the bottom radius.
/// `None` without gas, where the ambient pressure is higher, or without a pattern.
fn bend(point: &Point) -> Option<[f64; 2]> {
    let (scene, solved) = (&point.job.scene, point.solved?);
    let (gas, end) = (&scene.gas, scene.solver.end_time);
    let schedule = Schedule::new(&gas.windows);
    let times = schedule.change_times().iter().copied().filter(|time| *time > 0.0 && *time < end);
    let masses = times.chain([end]).map(|time| gas.initial_mass + schedule.mass_until(time));
    let mass = masses.filter(|mass| *mass > 0.0).reduce(f64::min)?;
    let temperature = scene.film.temperature;
    let pressure = mass * gas.species.gas_constant * temperature / solved.erected_volume
        - gas.ambient_pressure;
    let length = libm::cbrt(scene.film.bending_stiffness() / pressure);
    let radius = scene.design.folded().ok()?.bottom_radius;
    (pressure > 0.0).then(|| [length, length / radius])
}

/// Whether bending may change the results of film, or not.
pub(super) fn need(study: &Study) -> Option<String> {
    let film: Vec<_> =
        film_points(study).map(|point| (&point.job.scene.film, bend(point))).collect();
    let longest = |chosen: &dyn Fn(&Film, f64) -> bool| {
        let bends =
            film.iter().filter_map(|(film, bend)| bend.filter(|bend| chosen(film, bend[1])));
        bends.max_by(|a, b| a[1].total_cmp(&b[1])).map(|[length, over_radius]| {
            format!(
                "(D/p)^(1/3) is up to {} mm, {} % of the bottom radius; in the paper's capsule bending changed nothing \
                 beyond the seed up to 3.5 %, and the volume by up to a tenth from 7 % on",
                brief_number(1e3 * length),
                brief_number(100.0 * over_radius)
            )
        })
    };
    let missing = |film: &Film, bend: f64| bend >= LONG_BEND && !film.bending;
    if let Some(size) = longest(&missing) {
        return Some(format!(
            "note: bending may change results: {size}; film.bending needs film.compression 1"
        ));
    }
    let short = |(film, bend): &(&Film, Option<[f64; 2]>)| {
        film.compression < 1.0 || bend.is_some_and(|bend| bend[1] < LONG_BEND)
    };
    let size = longest(&|film, _| film.compression >= 1.0).filter(|_| film.iter().all(short))?;
    Some(format!("note: film.bending is not needed: {size}"))
}

/// Stress at which polymer film yields, Pa: that of Kapton.
const YIELD_STRESS: f64 = 69e6;

/// A note on creases that would yield.
pub(super) fn yielding_creases(study: &Study) -> Option<String> {
    let stress = |point: &Point| {
        let film = &point.job.scene.film;
        film.creases.map_or(0.0, |creases| {
            let rest = creases.rest_angle.unwrap_or(PI);
            let turn = rest.max(PI - rest);
            0.5 * film.youngs_modulus * film.thickness * turn / creases.length_scale
        })
    };
    let elastic = film_points(study).filter(|point| point.job.scene.film.yield_moment.is_none());
    let largest = elastic.max_by(|a, b| stress(a).total_cmp(&stress(b)))?;
    let thickness = largest.job.scene.film.thickness;
    (stress(largest) > YIELD_STRESS).then(|| {
        format!(
            "note: creases stress the surface of the film by up to {} MPa; Kapton yields at {} MPa: set \
             film.yield_moment, {} N for that stress and film, or a longer creases.length_scale",
            brief_number(1e-6 * stress(largest)),
            brief_number(1e-6 * YIELD_STRESS),
            brief_number(0.25 * YIELD_STRESS * thickness * thickness)
        )
    })
}
