//! What the contact cases share: pieces of film as one, plates, and runs whose passages are counted.
//!
//! ```text
//! not returned = |energy that went into contact − energy it stores now + energy impulses took|
//!                / largest kinetic energy
//! ```

use billow_solver::collision::contact::intersections::intersections;
use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::explicit::Explicit;
use billow_solver::output::ledger::{Ledger, residuals};
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::monitor_settings::MonitorSettings;
use billow_solver::scene::motion::{Motion, Profile};
use billow_solver::scene::plate::Plate;
use billow_solver::scene::timeline::Phase;
use nalgebra::Vector3;

use super::Row;
use super::reference::number;
use super::rig::advance;
use super::row::worse;

/// Contact at this distance (m), the audit looking at every step.
pub fn watched(distance: f64) -> FilmContact {
    FilmContact {
        distance: Some(distance),
        monitor: MonitorSettings::EVERY_STEP,
        ..FilmContact::default()
    }
}

/// Several pieces of film as one, without closing faces.
///
/// # Panics
/// Beyond 2^32 nodes.
pub fn together(pieces: &[Shell]) -> Shell {
    let mut whole = Shell::default();
    for piece in pieces {
        let first = u32::try_from(whole.positions.len()).expect("under 2^32 nodes");
        whole.positions.extend(&piece.positions);
        whole.triangles.extend(piece.triangles.iter().map(|t| t.map(|node| node + first)));
        whole.reference.extend(&piece.reference);
    }
    whole
}

/// A piece elsewhere, its reference as it was.
pub fn moved(mut piece: Shell, map: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Shell {
    piece.positions.iter_mut().for_each(|place| *place = map(*place));
    piece
}

/// A plate through this point (m), its normal towards the film, that stands or moves by `way` (m)
/// until `to` (s), from rest to rest.
pub fn plate(
    point: Vector3<f64>,
    normal: Vector3<f64>,
    motion: Option<(Vector3<f64>, f64)>,
) -> Plate {
    let moves = |(translation, to): (Vector3<f64>, f64)| Motion {
        from: 0.0,
        to,
        profile: Profile::Smooth,
        translation,
        rotation: None,
    };
    let name = "plate".to_owned();
    Plate { name, point, normal, motion: motion.map(moves), removal_time: f64::INFINITY }
}

/// What was seen of a run.
#[derive(Debug, Clone)]
pub struct Seen {
    /// Intersections at the worst sample.
    intersections: usize,
    /// Pairs of film pressed together, at the sample with most.
    pairs: usize,
    /// The film's ledger at every sample.
    ledgers: Vec<Ledger>,
}

/// Advances film to `end` (s), looking at it so many times on the way.
///
/// # Errors
/// What stopped it; a passage does.
pub fn follow(film: &mut Explicit, end: f64, samples: u32, phase: &Phase) -> Result<Seen, String> {
    let mut seen = Seen { intersections: 0, pairs: 0, ledgers: vec![film.ledger()] };
    for sample in 1..=samples {
        advance(film, end * f64::from(sample) / f64::from(samples), phase)?;
        seen.intersections = seen.intersections.max(crossings(film));
        let contacts = &film.state.contact_state.contacts;
        let pressed = contacts.iter().filter(|contact| contact.energy > 0.0).count();
        seen.pairs = seen.pairs.max(pressed);
        seen.ledgers.push(film.ledger());
    }
    Ok(seen)
}

/// Intersections of the whole film now.
pub fn crossings(film: &Explicit) -> usize {
    let law = film.parameters.contact.as_ref();
    law.map_or(0, |law| intersections(&law.mesh, &film.state.positions).len())
}

/// Energy that went into contact and neither is stored nor was taken by impulses, J.
pub fn not_returned(film: &Explicit) -> f64 {
    let meeting = &film.state.contact_state;
    let pairs: f64 = meeting.contacts.iter().map(|contact| contact.energy).sum();
    let plates: f64 = meeting.plates.iter().map(|plate| plate.energy).sum();
    (film.ledger().contact - pairs - plates + meeting.collision_dissipation).abs()
}

impl Seen {
    /// Largest kinetic energy, J.
    pub fn peak_kinetic(&self) -> f64 {
        self.ledgers.iter().map(|ledger| ledger.kinetic).fold(0.0, worse)
    }

    /// Passages at any step, and intersections.
    pub fn counts(&self, film: &Explicit, run: &str) -> Vec<Row> {
        let passages = film.monitor.as_ref().map_or(f64::NAN, |watch| watch.passages as f64);
        vec![
            Row::at_most(&format!("{run}passages"), passages, 0.0).with_note(&format!(
                "{} steps looked at, {} pairs pressed at most, {} approaches taken out; film residual \
                 {:.1e}",
                film.state.steps,
                self.pairs,
                film.state.contact_state.collision_impulses,
                self.residual()
            )),
            Row::at_most(&format!("{run}intersections"), self.intersections as f64, 0.0),
        ]
    }

    /// Largest ledger residual.
    fn residual(&self) -> f64 {
        residuals(&self.ledgers).into_iter().fold(0.0, worse)
    }

    /// The same and the ledger.
    pub fn rows(&self, film: &Explicit, run: &str, ledger_band: f64) -> Vec<Row> {
        let mut rows = self.counts(film, run);
        rows.push(Row::at_most(&format!("{run}film residual"), self.residual(), ledger_band));
        rows
    }

    /// What contact did not return, over the largest kinetic energy.
    pub fn returned(&self, film: &Explicit, run: &str) -> Row {
        let share = not_returned(film) / self.peak_kinetic();
        Row::at_most(
            &format!("{run}contact energy not returned"),
            share,
            number("contact/not_returned_band"),
        )
    }
}
