//! A byte of a checkpoint changes on disk: its checksum refuses it, whatever the integrator.

use super::scenes;
use crate::prelude::*;

/// Where the byte is: after the first of these texts.
const PLACES: [&str; 6] = [
    "\"format\":\"",
    "\"scene\":\"",
    "\"positions\":{\"x\":[",
    "\"velocities\":{\"x\":[",
    "\"internal_energy\":",
    "\"samples\":[",
];

#[test]
fn a_flipped_byte_of_a_checkpoint_is_refused() {
    for kind in IntegratorKind::ALL {
        let (mut film, timeline) = scenes::bag(kind, 0);
        let mut run = Run::default();
        assert!(run.advance(&mut film, &timeline, 30, &mut Unobserved).is_none(), "paused");
        let text = film.checkpoint("scene", &run).expect("film has checkpoints").expect("finite");
        let read = |text: &str| Checkpoint::<StoredFilm, Run>::from_text(text, "scene");
        assert!(read(&text).is_ok(), "{kind:?}");
        for place in PLACES {
            let at = text.find(place).unwrap_or_else(|| panic!("no {place}")) + place.len() + 2;
            for bit in [0, 1, 2] {
                let mut bytes = text.clone().into_bytes();
                bytes[at] ^= 1 << bit;
                let changed = String::from_utf8(bytes).expect("ASCII");
                let refused = read(&changed);
                let invalid = matches!(refused, Err(CheckpointError::Invalid(_)));
                assert!(invalid, "{kind:?}, {place}, bit {bit}: {:?}", refused.err());
            }
        }
    }
}
