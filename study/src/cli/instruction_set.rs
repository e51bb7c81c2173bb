//! The instruction set that `BILLOW_SIMD` selects.

use billow_solver::platform::simd::InstructionSet;

use crate::platform::error::{Error, Result};

/// Environment variable that selects the instruction set.
const VARIABLE: &str = "BILLOW_SIMD";

/// The instruction set of `BILLOW_SIMD`; without it the widest one of this machine.
///
/// # Errors
/// [`Error::Input`] for an unknown name, or one that this machine does not have.
pub fn selected() -> Result<InstructionSet> {
    let Some(name) = std::env::var_os(VARIABLE).filter(|name| !name.is_empty()) else {
        return Ok(InstructionSet::detect());
    };
    let name = name.to_string_lossy();
    let problem = match InstructionSet::ALL.into_iter().find(|known| known.name() == name) {
        Some(known) if known.available() => return Ok(known),
        Some(_) => "this machine does not have this instruction set",
        None => "unknown instruction set",
    };
    let available = InstructionSet::ALL.into_iter().filter(|known| known.available());
    let allowed: Vec<&str> = available.map(InstructionSet::name).collect();
    let hint = "leave it unset: every instruction set gives the same bits";
    Err(Error::invalid_option(VARIABLE, &name, problem, allowed.join(", "), hint))
}
