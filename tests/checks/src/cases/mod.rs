//! The reference cases of `billow-checks validate`: results against closed forms, series and quadratures.
//!
//! ```text
//! error = |value/reference − 1|        in band: error ≤ band and order ≥ least order
//! ```
//!
//! A case is an entry of [`CASES`] and a function that gives one [`Row`] for each quantity. Cases run
//! the same code as a capsule: the scene of a film, its explicit step, its gas, its model. Numbers and
//! bands come from `tests/reference`. A case that fails or panics gives a row out of band with the
//! reason.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use rayon::ThreadPool;
use rayon::prelude::{
    IndexedParallelIterator as _, IntoParallelRefIterator as _, ParallelIterator as _,
};

pub mod command;
pub mod prelude;
pub(crate) mod reference;
pub mod rig;
mod row;

mod bending;
pub mod contact_capsule;
mod contact_impacts;
mod contact_plates;
mod contact_relaxed;
mod contact_rig;
mod creases;
mod damping;
pub(crate) mod drum;
pub(crate) mod gas;
mod integrators;
mod invariants;
mod moving_fold;
mod oscillation;
pub mod shapes;
pub(crate) mod sphere_motion;
mod static_discs;
mod static_end_state;
mod static_shells;
mod static_wrinkling;
mod storeys_model;
mod wrinkles;

pub use rig::Rig;
pub use row::Row;

/// A result, or the reason why there is none.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// The rows of a case.
pub type Outcome = Result<Vec<Row>>;

/// One reference case.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// Whether `--quick` skips it.
    pub long: bool,
    /// The function that runs it.
    pub body: fn(&Rig) -> Outcome,
}

const fn quick(name: &'static str, body: fn(&Rig) -> Outcome) -> Case {
    Case { name, long: false, body }
}

const fn long(name: &'static str, body: fn(&Rig) -> Outcome) -> Case {
    Case { name, long: true, body }
}

/// Every case, in the order of the output.
pub const CASES: &[Case] = &[
    quick("tank_filling", gas::tank_filling),
    quick("blow_down", gas::blow_down),
    quick("cooling", gas::cooling),
    quick("gas_spring", gas::gas_spring),
    quick("injected_piston", gas::injected_piston),
    quick("injected_piston_dead_volume", gas::injected_piston_dead_volume),
    quick("storeys_model_capsule", storeys_model::capsule),
    quick("storeys_model_similarity", storeys_model::similarity),
    quick("stretched_disc", drum::stretched_disc),
    quick("spinning_disc", drum::spinning_disc),
    quick("breathing_sphere", |rig| sphere_motion::breathing_sphere(rig, [2, 3, 4])),
    long("breathing_sphere_fine", |rig| sphere_motion::breathing_sphere(rig, [3, 4, 5])),
    quick("integrators_piston", integrators::piston),
    quick("integrators_sphere", integrators::sphere),
    quick("integrators_disc", integrators::disc),
    long("released_sphere", sphere_motion::released_sphere),
    quick("strip_damping", damping::strip_decrement),
    quick("strip_loss", damping::strip_loss),
    quick("free_flight_damping", damping::free_flight),
    quick("moving_fold", |rig| moving_fold::moving_fold(rig, 20, "coherent_share")),
    long("moving_fold_fine", |rig| moving_fold::moving_fold(rig, 40, "coherent_share_fine")),
    quick("rigid_rotation", invariants::rigid_rotation),
    quick("momentum", invariants::momenta),
    quick("shear_panel", invariants::shear_panel),
    quick("sphere_ledger", invariants::sphere_ledger),
    quick("static_sphere", static_shells::sphere),
    quick("static_cylinder", static_shells::cylinder),
    quick("cone", static_shells::cone),
    quick("clamped_disc", static_discs::clamped_disc),
    quick("mylar_balloon", static_discs::mylar_balloon),
    quick("compliant_disc", static_discs::compliant_disc),
    quick("compliant_frustum", static_shells::compliant_frustum),
    quick("compliant_capsule", static_end_state::compliant_capsule),
    quick("square_airbag", static_discs::square_airbag),
    quick("beam", static_wrinkling::beam),
    quick("annulus_torsion", static_wrinkling::annulus_torsion),
    long("end_state", static_end_state::aligned),
    long("end_state_pattern", static_end_state::pattern),
    quick("end_state_polygon", contact_relaxed::end_state_polygon),
    quick("heavy_strip", |rig| bending::heavy_strip(rig, &[0], 0..2)),
    long("heavy_strip_meshes", |rig| bending::heavy_strip(rig, &[1, 2], 0..2)),
    long("heavy_strip_heaviest", |rig| bending::heavy_strip(rig, &[0, 1, 2], 2..3)),
    quick("end_shear", bending::end_shear),
    quick("circle", |rig| bending::circle(rig, 0..1)),
    long("circle_meshes", |rig| bending::circle(rig, 1..3)),
    quick("column", bending::column),
    quick("clamped_plate", |rig| bending::clamped_plate(rig, false)),
    long("clamped_plate_fine", |rig| bending::clamped_plate(rig, true)),
    quick("plate_frequency", bending::plate_frequency),
    quick("opened_crease", |rig| creases::opened_crease(rig, 0..1)),
    long("opened_crease_meshes", |rig| creases::opened_crease(rig, 1..3)),
    quick("creased_panels", |rig| creases::creased_panels(rig, 0..1)),
    long("creased_panels_meshes", |rig| creases::creased_panels(rig, 1..3)),
    quick("yielding_crease", creases::yielding_crease),
    long("wrinkles", wrinkles::stretched_sheet),
    quick("stack", contact_plates::stack_of_sheets),
    quick("tube_between_plates", contact_plates::tube_between_plates),
    quick("films_at_50_m_s", contact_impacts::films_at_50_m_s),
    quick("squeezed_bag", |rig| contact_impacts::squeezed_bag(rig, &[0.0])),
    long("squeezed_bag_stiff", |rig| contact_impacts::squeezed_bag(rig, &[0.1, 1.0])),
    quick("friction", contact_impacts::friction),
    quick("adhesion", contact_impacts::adhesion),
    quick("capsule_friction", contact_capsule::friction),
    quick("capsule_every_step", |rig| contact_capsule::every_step(rig, 2)),
    long("capsule_every_step_fine", |rig| contact_capsule::every_step(rig, 4)),
    quick("capsule_deployed", |rig| contact_capsule::deployed(rig, 5)),
    long("capsule_deployed_fine", |rig| contact_capsule::deployed(rig, 8)),
    long("contact_distance", contact_capsule::contact_distance),
    long("deployed_equals_inflated", |rig| contact_relaxed::deployed_equals_inflated(rig, 5)),
    long("deployed_equals_inflated_fine", |rig| contact_relaxed::deployed_equals_inflated(rig, 8)),
];

/// The result of a case.
pub struct Judged {
    /// Its name.
    pub name: &'static str,
    /// Its rows; at least one.
    pub rows: Vec<Row>,
    /// Wall time of the whole case, s.
    pub seconds: f64,
}

impl Judged {
    /// Whether every row is in band.
    pub fn pass(&self) -> bool {
        self.rows.iter().all(|row| row.pass)
    }
}

impl Case {
    /// Runs the case. An error or a panic gives a row out of band.
    pub fn run(&self, rig: &Rig) -> Judged {
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (self.body)(rig)));
        let rows = match outcome {
            Ok(Ok(rows)) if !rows.is_empty() => rows,
            Ok(Ok(_)) => vec![Row::failed("the case has no rows")],
            Ok(Err(reason)) => vec![Row::failed(&reason.to_string())],
            Err(panic) => vec![Row::failed(&format!("panicked: {}", message(panic.as_ref())))],
        };
        Judged { name: self.name, rows, seconds: start.elapsed().as_secs_f64() }
    }
}

/// The message of a panic.
fn message(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message")
}

/// Runs cases on a pool and reports each as it ends. The results are in the given order, whatever the
/// number of threads.
pub fn run_all(
    pool: &ThreadPool,
    cases: &[&Case],
    rig: &Rig,
    report: &(dyn Fn(&Judged) + Sync),
) -> Vec<Judged> {
    let run = |case: &&Case| {
        let judged = case.run(rig);
        report(&judged);
        judged
    };
    // One case at a time: the long ones stand beside each other.
    pool.install(|| cases.par_iter().with_max_len(1).map(run).collect())
}

#[cfg(test)]
mod tests;
