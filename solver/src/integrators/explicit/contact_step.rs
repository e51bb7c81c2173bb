//! The step's part that keeps film off film and off plates, and lets the audit see it.

use super::update::largest_squared_speed;
use super::{Explicit, State};
use crate::collision::contact::collision_response::{Impulses, taken};
use crate::collision::contact::{Kind, Pair};
use crate::geometry::field::Field;
use crate::output::outcome::{Failure, FailureKind};
use crate::platform::stopwatch::{Stage, Stopwatch};

/// How often pairs and plates take turns in a step, at most.
const MOST_TURNS: u32 = 50;

/// A pair that could not be kept apart, in words.
fn unkept(pair: Pair) -> String {
    let [one, other] = match pair.kind {
        Kind::NodeTriangle => ["node", "element"],
        Kind::EdgeEdge => ["edge", "edge"],
    };
    format!("{one} {} and {other} {} could not be kept apart", pair.first, pair.second)
}

impl Explicit {
    /// The plates of the start.
    pub(super) fn initialise_contact(&mut self) {
        let Some(law) = &self.parameters.contact else { return };
        let positions = &self.state.positions;
        self.state.contact_state.searches = 1;
        let start = law.plates.iter().map(|plate| plate.start(positions, law.distance));
        self.state.contact_state.plates = start.collect();
    }

    /// Forces of contact at the positions now, which are those of `time` (s).
    pub(super) fn update_contact_forces(&mut self, time: f64) {
        let Some(law) = &self.parameters.contact else { return };
        let (positions, contact_state) = (&self.state.positions, &mut self.state.contact_state);
        let search = self.candidates.get_or_insert_with(|| law.look(positions, contact_state.path));
        if search.pushed {
            let Field { x, y, z } = &mut self.forces.contact;
            for column in [x, y, z] {
                column.fill(0.0);
            }
        }
        law.meet(positions, &self.model.mass, &mut self.forces.contact, contact_state, search);
        search.pushed = !contact_state.contacts.is_empty() || !law.plates.is_empty();
        let (forces, stiffness) = (&mut self.forces.contact, law.stiffness);
        for (plate, pressed) in law.plates.iter().zip(&mut contact_state.plates) {
            plate.push(positions, &self.model, time, law.distance, stiffness, pressed, forces);
        }
    }

    /// Looks for pairs the drift to come could bring together, and keeps them apart, and off the plates:
    /// in turn, until neither changes anything and no node is faster than the pairs were looked for.
    pub(super) fn collision_step(
        &mut self,
        kick: f64,
        length: f64,
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<(), Failure> {
        let Some(law) = &self.parameters.contact else { return Ok(()) };
        let (model, supports, time) = (&self.model, &self.parameters.supports, self.state.time);
        let State { positions, velocities, contact_state, .. } = &mut self.state;
        let instruction_set = self.parameters.instruction_set;
        let fastest =
            |velocities: &Field| largest_squared_speed(instruction_set, velocities).sqrt();
        let search = self.candidates.get_or_insert_with(|| law.look(positions, contact_state.path));
        let speed = fastest(velocities);
        if speed >= model.wave_speed() {
            // The step ends the run; nothing is near or far for film that fast.
            return Ok(());
        }
        let mut way = speed * length;
        stopwatch.begins(Stage::Search);
        law.prepare(positions, contact_state, search, way);
        stopwatch.begins(Stage::Pairs);
        law.rub(model, supports, positions, &self.next, velocities, kick, contact_state);
        // Friction may have made a node faster.
        let rubbed = if law.friction > 0.0 { fastest(velocities) * length } else { way };
        let mut own_way = way.max(rubbed);
        let mut stopped = Impulses::new();
        for turn in 0..MOST_TURNS {
            let kept = law.guard(
                model,
                supports,
                positions,
                &self.next,
                velocities,
                length,
                &search.near,
                own_way,
                contact_state,
                turn,
                &mut stopped,
            );
            if let Err(pair) = kept {
                return Err(self.failure(FailureKind::Interpenetrated, &unkept(pair)));
            }
            let before = stopped.len();
            for plate in &law.plates {
                plate.guard(positions, model, supports, velocities, time, length, &mut stopped);
            }
            let now = fastest(velocities) * length;
            let farther = now > way;
            if farther {
                contact_state.path -= way;
                law.prepare(positions, contact_state, search, now);
                way = now;
                own_way = now;
            }
            if !farther && stopped.len() == before {
                contact_state.taken += taken(&stopped, &self.next, velocities);
                return Ok(());
            }
        }
        Err(self
            .failure(FailureKind::Interpenetrated, "film between plates could not be kept apart"))
    }

    /// Smallest distance of film that is held apart, m; infinite where none is.
    pub fn smallest_gap(&self) -> f64 {
        self.candidates.as_ref().map_or(f64::INFINITY, |search| search.smallest_gap)
    }

    /// Intersections of the mesh now, or when it last came to a target.
    pub fn intersections(&self) -> u64 {
        self.monitor.as_ref().map_or(0, |watch| watch.piercings.count)
    }

    /// Whether contact or a plate pushes, or may.
    pub(super) fn contact_active(&self) -> bool {
        let none = self.parameters.contact.is_none();
        !none && self.candidates.as_ref().is_none_or(|search| search.pushed)
    }

    /// Half a step's work of the plates, by their force now, on the way to `until` (s).
    pub(super) fn add_plate_work(&mut self, until: f64) {
        let Some(law) = &self.parameters.contact else { return };
        let state = &mut self.state;
        for (plate, pressed) in law.plates.iter().zip(&state.contact_state.plates) {
            let work = 0.5 * pressed.force * plate.way(state.time, until);
            state.works.support += work;
            state.works.contact -= work;
        }
    }

    /// Lets the audit see the positions after a step.
    pub(super) fn monitor_step(&mut self) -> Result<(), Failure> {
        if let (Some(watch), Some(law)) = (&mut self.monitor, &self.parameters.contact) {
            watch.step(&law.topology, &self.state.positions);
        }
        self.nothing_passed()
    }

    /// Has the audit look at all steps it has seen.
    pub(super) fn monitor_interval(&mut self) -> Result<(), Failure> {
        if let (Some(watch), Some(law)) = (&mut self.monitor, &self.parameters.contact) {
            watch.look(&law.topology);
            watch.piercings.look(&law.topology, &self.state.positions);
        }
        self.nothing_passed()
    }

    fn nothing_passed(&self) -> Result<(), Failure> {
        match self.monitor.as_ref().and_then(|watch| watch.first) {
            None => Ok(()),
            Some((passage, at)) => {
                let [x, y, z] = [at.x, at.y, at.z];
                let place = format!("{passage}, near ({x:.4}, {y:.4}, {z:.4}) m");
                Err(self.failure(FailureKind::Interpenetrated, &place))
            }
        }
    }
}
