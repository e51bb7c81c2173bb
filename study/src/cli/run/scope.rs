//! Which jobs a run takes: `--points`.

use crate::platform::error::{Error, Result};
use crate::run::selection::{Part, Selection};

/// Options of a run that is one of several.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ScopeOptions {
    /// Run a part of the jobs, as in --points 2/8: the second of eight parts. `billow merge` joins the folders of the parts.
    #[arg(long, value_name = "K/N")]
    pub points: Option<String>,
}

impl ScopeOptions {
    /// The jobs that the run takes.
    ///
    /// # Errors
    /// A part that there is not.
    pub fn selection(&self) -> Result<Selection> {
        let Some(text) = &self.points else { return Ok(Selection::All) };
        let part = Part::parse(text).ok_or_else(|| {
            let allowed = "K/N: part K of N, from 1/N to N/N, as in --points 2/8";
            let next = "run every part in a folder of its own (--results), then billow merge FOLDER… --results FOLDER";
            Error::invalid_option("--points", text, "is no part", allowed, next)
        })?;
        Ok(Selection::Part(part))
    }
}
