//! What the contact cases share: monitored contact, plates, and runs that count passages.
//!
//! ```text
//! unrecovered = |work into contact − energy stored in contact + energy change by impulses|
//!               / largest kinetic energy
//! ```

use billow_solver::collision::monitor::intersections::intersections;
use billow_solver::integrators::{FilmSimulation, FilmView};
use billow_solver::output::ledger::residuals;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::monitor_settings::MonitorSettings;
use billow_solver::scene::motion::{Motion, Profile};
use billow_solver::scene::plate::Plate;
use billow_solver::scene::timeline::Phase;
use nalgebra::Vector3;

use super::Result;
use super::reference::number;
use super::rig::advance;
use super::row::{Row, worse};

/// Contact at this distance (m), with the tunnelling monitor at every step.
pub fn monitored_contact(distance: f64) -> FilmContact {
    FilmContact {
        distance: Some(distance),
        monitor: MonitorSettings::EVERY_STEP,
        ..FilmContact::default()
    }
}

/// A plate through this point (m), its normal towards the film. It is fixed, or moves by a
/// displacement (m) until a time (s), from rest to rest.
pub fn plate(
    point: Vector3<f64>,
    normal: Vector3<f64>,
    motion: Option<(Vector3<f64>, f64)>,
) -> Plate {
    let motion_of = |(translation, to): (Vector3<f64>, f64)| Motion {
        from: 0.0,
        to,
        profile: Profile::Smooth,
        translation,
        rotation: None,
    };
    let name = "plate".to_owned();
    Plate { name, point, normal, motion: motion.map(motion_of), removal_time: f64::INFINITY }
}

/// What is judged of every run with contact.
pub struct ContactRecord {
    pub passages: Option<u64>,
    pub intersections: Option<u64>,
    /// Largest residual of the energy ledger.
    pub residual: f64,
    /// Unrecovered contact energy over the largest kinetic energy.
    pub unrecovered: f64,
}

impl ContactRecord {
    /// Rows of passages and intersections.
    pub fn counts(&self, run: &str) -> Vec<Row> {
        let row = |name: &str, counted: Option<u64>| {
            let counted = counted.map_or(f64::NAN, |counted| counted as f64);
            Row::at_most(&format!("{run}{name}"), counted, 0.0)
        };
        vec![row("passages", self.passages), row("intersections", self.intersections)]
    }

    /// Rows of passages, intersections and ledger residual.
    pub fn rows(&self, run: &str, ledger_band: f64) -> Vec<Row> {
        let name = format!("{run}film energy residual");
        [self.counts(run), vec![Row::at_most(&name, self.residual, ledger_band)]].concat()
    }

    /// Row of the unrecovered contact energy.
    pub fn unrecovered(&self, run: &str) -> Row {
        let band = number("contact/not_returned_band");
        Row::at_most(&format!("{run}unrecovered contact energy"), self.unrecovered, band)
    }
}

/// Advances film to `end` (s), and counts intersections at this number of samples.
pub fn run_recorded(
    film: &mut FilmSimulation,
    end: f64,
    samples: u32,
    phase: &Phase,
) -> Result<ContactRecord> {
    let (mut found, mut ledgers) = (0, vec![film.view().ledger()]);
    for sample in 1..=samples {
        advance(film, end * f64::from(sample) / f64::from(samples), phase)?;
        found = found.max(intersection_count(&film.view()));
        ledgers.push(film.view().ledger());
    }
    let peak = ledgers.iter().map(|ledger| ledger.kinetic).fold(0.0, worse);
    let now = film.view();
    Ok(ContactRecord {
        passages: now.passages(),
        intersections: Some(found as u64),
        residual: residuals(&ledgers).into_iter().fold(0.0, worse),
        unrecovered: unrecovered_contact_energy(&now) / peak,
    })
}

/// Number of intersections of the whole film in its present state.
pub fn intersection_count(film: &FilmView<'_>) -> usize {
    let model = film.system.contact.as_ref();
    model.map_or(0, |model| intersections(&model.mesh.topology, &film.state.positions).len())
}

/// Work into contact that is neither stored in contact nor accounted for by impulses, J.
pub fn unrecovered_contact_energy(film: &FilmView<'_>) -> f64 {
    let contact_state = &film.state.contact;
    let pairs: f64 = contact_state.contacts.iter().map(|contact| contact.energy).sum();
    let plates: f64 = contact_state.plates.iter().map(|plate| plate.energy).sum();
    (film.ledger().contact - pairs - plates + film.accounting().collision_dissipation).abs()
}
