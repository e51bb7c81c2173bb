//! What the contact cases share: monitored contact, plates, and runs that count passages.
//!
//! ```text
//! unrecovered = |work into contact − energy stored in contact + energy change by impulses|
//!               / largest kinetic energy
//! ```

use billow_solver::collision::monitor::intersections::intersections;
use billow_solver::output::ledger::{Ledger, residuals};
use billow_solver::scene::monitor_settings::MonitorSettings;
use billow_solver::scene::plate::Plate;

use super::prelude::*;

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

/// What was recorded of a run.
pub struct RunRecord {
    /// Most intersections at a sample.
    intersections: usize,
    /// Most pairs with contact force at a sample.
    pairs: usize,
    /// Energy ledger at every sample.
    ledgers: Vec<Ledger>,
}

/// Advances film to `end` (s) and records it at this number of samples.
pub fn run_recorded(
    film: &mut FilmSimulation,
    end: f64,
    samples: u32,
    phase: &Phase,
) -> Result<RunRecord> {
    let mut record = RunRecord { intersections: 0, pairs: 0, ledgers: vec![film.view().ledger()] };
    for sample in 1..=samples {
        advance(film, end * f64::from(sample) / f64::from(samples), phase)?;
        record.intersections = record.intersections.max(intersection_count(&film.view()));
        let contacts = &film.view().state.contact.contacts;
        let pairs = contacts.iter().filter(|contact| contact.energy > 0.0).count();
        record.pairs = record.pairs.max(pairs);
        record.ledgers.push(film.view().ledger());
    }
    Ok(record)
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

impl RunRecord {
    /// Largest kinetic energy, J.
    pub fn peak_kinetic(&self) -> f64 {
        self.ledgers.iter().map(|ledger| ledger.kinetic).fold(0.0, worse)
    }

    /// Rows of passages and intersections.
    pub fn counts(&self, film: &FilmView<'_>, run: &str) -> Vec<Row> {
        let passages = film.passages().map_or(f64::NAN, |passages| passages as f64);
        vec![
            Row::at_most(&format!("{run}passages"), passages, 0.0).with_note(&format!(
                "{} steps monitored, at most {} pairs in contact, {} collision impulses; ledger residual {:.1e}",
                film.steps(),
                self.pairs,
                film.accounting().collision_impulses,
                self.residual()
            )),
            Row::at_most(&format!("{run}intersections"), self.intersections as f64, 0.0),
        ]
    }

    /// Largest ledger residual.
    fn residual(&self) -> f64 {
        residuals(&self.ledgers).into_iter().fold(0.0, worse)
    }

    /// Rows of passages, intersections and ledger residual.
    pub fn rows(&self, film: &FilmView<'_>, run: &str, ledger_band: f64) -> Vec<Row> {
        let mut rows = self.counts(film, run);
        rows.push(Row::at_most(
            &format!("{run}film energy residual"),
            self.residual(),
            ledger_band,
        ));
        rows
    }

    /// Row of the unrecovered contact energy over the largest kinetic energy.
    pub fn unrecovered(&self, film: &FilmView<'_>, run: &str) -> Row {
        let share = unrecovered_contact_energy(film) / self.peak_kinetic();
        Row::at_most(
            &format!("{run}unrecovered contact energy"),
            share,
            number("contact/not_returned_band"),
        )
    }
}
