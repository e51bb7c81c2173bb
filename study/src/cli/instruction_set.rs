//! The instruction set of every command that simulates.

use billow_solver::platform::simd::InstructionSet;

use crate::platform::error::{Error, InputError, Result};

/// Name of the environment variable.
const VARIABLE: &str = "BILLOW_SIMD";

/// The instruction set that `BILLOW_SIMD` names, or the widest of this machine. Every one gives the
/// same bits; tests choose one to prove that.
///
/// # Errors
/// An unknown name, or an instruction set that this machine does not have.
pub(super) fn instruction_set() -> Result<InstructionSet> {
    let Some(word) = std::env::var_os(VARIABLE).filter(|word| !word.is_empty()) else {
        return Ok(InstructionSet::detect());
    };
    let word = word.to_string_lossy();
    let named = InstructionSet::ALL.into_iter().find(|set| set.name() == word);
    let problem = match named {
        Some(set) if set.available() => return Ok(set),
        Some(_) => "this machine does not have this instruction set",
        None => "unknown instruction set",
    };
    let available = InstructionSet::ALL.into_iter().filter(|set| set.available());
    Err(Error::Input(InputError {
        file: VARIABLE.to_owned(),
        key: String::new(),
        value: word.into_owned(),
        problem: problem.to_owned(),
        allowed: available.map(InstructionSet::name).collect::<Vec<_>>().join(", "),
        hint: "leave it unset: every instruction set gives the same bits".to_owned(),
    }))
}
