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
    pub(super) fn meet_first(&mut self) {
        let Some(law) = &self.setting.contact else { return };
        let places = &self.state.places;
        self.state.meeting.searches = 1;
        let start = law.plates.iter().map(|plate| plate.start(places, law.distance));
        self.state.meeting.plates = start.collect();
    }

    /// Forces of contact at the places now, which are those of `time` (s).
    pub(super) fn press(&mut self, time: f64) {
        let Some(law) = &self.setting.contact else { return };
        let (places, meeting) = (&self.state.places, &mut self.state.meeting);
        let search = self.search.get_or_insert_with(|| law.look(places, meeting.path));
        if search.pushed {
            let Field { x, y, z } = &mut self.forces.contact;
            for column in [x, y, z] {
                column.fill(0.0);
            }
        }
        law.meet(places, &self.model.mass, &mut self.forces.contact, meeting, search);
        search.pushed = !meeting.contacts.is_empty() || !law.plates.is_empty();
        let (forces, stiffness) = (&mut self.forces.contact, law.stiffness);
        for (plate, pressed) in law.plates.iter().zip(&mut meeting.plates) {
            plate.push(places, &self.model, time, law.distance, stiffness, pressed, forces);
        }
    }

    /// Looks for pairs the drift to come could bring together, and keeps them apart, and off the plates:
    /// in turn, until neither changes anything and no node is faster than the pairs were looked for.
    pub(super) fn keep_apart(
        &mut self,
        kick: f64,
        length: f64,
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<(), Failure> {
        let Some(law) = &self.setting.contact else { return Ok(()) };
        let (model, supports, time) = (&self.model, &self.setting.supports, self.state.time);
        let State { places, velocities, meeting, .. } = &mut self.state;
        let path = self.setting.path;
        let fastest = |velocities: &Field| largest_squared_speed(path, velocities).sqrt();
        let search = self.search.get_or_insert_with(|| law.look(places, meeting.path));
        let speed = fastest(velocities);
        if speed >= model.wave_speed() {
            // The step ends the run; nothing is near or far for film that fast.
            return Ok(());
        }
        let mut way = speed * length;
        stopwatch.begins(Stage::Search);
        law.prepare(places, meeting, search, way);
        stopwatch.begins(Stage::Pairs);
        law.rub(model, supports, places, &self.next, velocities, kick, meeting);
        // Friction may have made a node faster.
        let rubbed = if law.friction > 0.0 { fastest(velocities) * length } else { way };
        let mut own_way = way.max(rubbed);
        let mut stopped = Impulses::new();
        for turn in 0..MOST_TURNS {
            let kept = law.guard(
                model,
                supports,
                places,
                &self.next,
                velocities,
                length,
                &search.near,
                own_way,
                meeting,
                turn,
                &mut stopped,
            );
            if let Err(pair) = kept {
                return Err(self.failure(FailureKind::Interpenetrated, &unkept(pair)));
            }
            let before = stopped.len();
            for plate in &law.plates {
                plate.guard(places, model, supports, velocities, time, length, &mut stopped);
            }
            let now = fastest(velocities) * length;
            let farther = now > way;
            if farther {
                meeting.path -= way;
                law.prepare(places, meeting, search, now);
                way = now;
                own_way = now;
            }
            if !farther && stopped.len() == before {
                meeting.taken += taken(&stopped, &self.next, velocities);
                return Ok(());
            }
        }
        Err(self
            .failure(FailureKind::Interpenetrated, "film between plates could not be kept apart"))
    }

    /// Smallest distance of film that is held apart, m; infinite where none is.
    pub fn smallest_gap(&self) -> f64 {
        self.search.as_ref().map_or(f64::INFINITY, |search| search.smallest_gap)
    }

    /// Intersections of the mesh now, or when it last came to a target.
    pub fn intersections(&self) -> u64 {
        self.watch.as_ref().map_or(0, |watch| watch.piercings.count)
    }

    /// Whether contact or a plate pushes, or may.
    pub(super) fn pushed(&self) -> bool {
        let none = self.setting.contact.is_none();
        !none && self.search.as_ref().is_none_or(|search| search.pushed)
    }

    /// Half a step's work of the plates, by their force now, on the way to `until` (s).
    pub(super) fn plate_work(&mut self, until: f64) {
        let Some(law) = &self.setting.contact else { return };
        let state = &mut self.state;
        for (plate, pressed) in law.plates.iter().zip(&state.meeting.plates) {
            let work = 0.5 * pressed.force * plate.way(state.time, until);
            state.works.support += work;
            state.works.contact -= work;
        }
    }

    /// Lets the audit see the places after a step.
    pub(super) fn seen(&mut self) -> Result<(), Failure> {
        if let (Some(watch), Some(law)) = (&mut self.watch, &self.setting.contact) {
            watch.step(&law.topology, &self.state.places);
        }
        self.nothing_passed()
    }

    /// Has the audit look at all steps it has seen.
    pub(super) fn look(&mut self) -> Result<(), Failure> {
        if let (Some(watch), Some(law)) = (&mut self.watch, &self.setting.contact) {
            watch.look(&law.topology);
            watch.piercings.look(&law.topology, &self.state.places);
        }
        self.nothing_passed()
    }

    fn nothing_passed(&self) -> Result<(), Failure> {
        match self.watch.as_ref().and_then(|watch| watch.first) {
            None => Ok(()),
            Some((passage, at)) => {
                let [x, y, z] = [at.x, at.y, at.z];
                let place = format!("{passage}, near ({x:.4}, {y:.4}, {z:.4}) m");
                Err(self.failure(FailureKind::Interpenetrated, &place))
            }
        }
    }
}
