//! The meaning of the colours of a picture.

use billow_solver::output::frames::Frame;

use super::{ColourArg, values};
use crate::cli::picture::refused;
use crate::platform::error::Result;
use crate::render::filmstrip::Colour;
use crate::store::history_file::StoredFrames;

/// The meaning of the colours: the one asked for, or storeys if the film has some. A quantity that the file
/// does not have gives one colour and a note.
pub(super) fn colour(
    asked: Option<ColourArg>,
    stored: &StoredFrames,
    frames: &[Frame],
) -> Result<(Colour, Vec<String>)> {
    let capsule = stored.storeys().iter().any(|storey| *storey > 0);
    let quantity = match asked {
        Some(ColourArg::Stress) => values::stress(frames),
        Some(ColourArg::Speed) => values::speed(frames, stored.triangles()),
        _ => None,
    };
    let colour = match asked {
        Some(ColourArg::Regime) => Colour::Regime,
        Some(ColourArg::None) => Colour::Plain,
        Some(ColourArg::Stress | ColourArg::Speed) => {
            if let Some(quantity) = quantity {
                Colour::Quantity(quantity)
            } else {
                let name = if asked == Some(ColourArg::Speed) { "speed" } else { "stress" };
                let note = format!(
                    "No {name}: the file has no {name} of the film, because an earlier version of billow \
                     wrote it. Run its study or scene again with this version."
                );
                return Ok((Colour::Plain, vec![note]));
            }
        }
        Some(ColourArg::Storey) if !capsule => {
            return Err(refused(
                "--colour",
                "storey",
                "this film is not a capsule and has no storeys",
                "regime, stress, speed, none",
            ));
        }
        Some(ColourArg::Storey) => Colour::Storey,
        None => {
            if capsule {
                Colour::Storey
            } else {
                Colour::Plain
            }
        }
    };
    Ok((colour, Vec::new()))
}
