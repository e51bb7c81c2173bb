//! The group `/events` of a history file: what the step controller decided, and when.
//!
//! ```text
//! /events/time   f64, s, ascending      /events/kind   f64, the place of its word in flag_meanings
//! ```
//!
//! A file without the group has no events: an older file, or a model that decides nothing.

use billow_solver::output::events::{Event, EventKind};
use hdf5::dataset::DatasetCreate;
use hdf5::{File, Location};

use super::{raw, read_text};

/// Name of the group.
const GROUP: &str = "events";

/// Writes the events of a run; no group where there are none.
pub(super) fn write(writer: &raw::Writer, file: &File, events: &[Event]) -> hdf5::Result<()> {
    if events.is_empty() {
        return Ok(());
    }
    let group = file.create_group(GROUP)?;
    let mut create = DatasetCreate::build();
    create.obj_track_times(false);
    let columns = raw::Columns::new(events.len(), create.finish()?)?;
    let times: Vec<f64> = events.iter().map(|event| event.time).collect();
    let place = |event: &Event| {
        let kinds = EventKind::ALL.iter().take_while(|kind| **kind != event.kind);
        kinds.count() as f64
    };
    let kinds: Vec<f64> = events.iter().map(place).collect();
    let time = columns.write(&group, "time", &times)?;
    writer.text(&time, "units", "s")?;
    writer.text(&time, "long_name", "time of the decision")?;
    let kind = columns.write(&group, "kind", &kinds)?;
    let words = EventKind::ALL.map(EventKind::name).join(" ");
    writer.text(&kind, "flag_meanings", &words)?;
    writer.text(
        &kind,
        "long_name",
        "decision of the step controller, by its place in flag_meanings",
    )
}

/// Reads the events of a run.
pub(super) fn read(file: &File) -> hdf5::Result<Vec<Event>> {
    if !file.link_exists(GROUP) {
        return Ok(Vec::new());
    }
    let group = file.group(GROUP)?;
    let times = group.dataset("time")?.read_raw::<f64>()?;
    let kind = group.dataset("kind")?;
    let location: &Location = &kind;
    let words = read_text(location, "flag_meanings")?;
    let words: Vec<&str> = words.split(' ').collect();
    let event = |(time, place): (f64, f64)| {
        let word =
            (0_u32..).zip(&words).find(|(index, _)| f64::from(*index).to_bits() == place.to_bits());
        let named =
            word.and_then(|(_, word)| EventKind::ALL.into_iter().find(|k| k.name() == *word));
        named
            .map(|kind| Event { time, kind })
            .ok_or_else(|| "an event that this billow does not know".into())
    };
    times.into_iter().zip(kind.read_raw::<f64>()?).map(event).collect()
}
