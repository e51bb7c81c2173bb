//! Which jobs a run takes, and whether it shares its folder: `--points`, `--shared`, `--chunk`.

use crate::cluster::submission;
use crate::platform::error::{Error, Result};
use crate::platform::files;
use crate::run::runner::Shared;
use crate::run::selection::{Part, Selection};
use crate::store::claims::LEASE;
use crate::store::results::Results;

/// Options of a run that is one of several.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ScopeOptions {
    /// Run a part of the jobs, as in --points 2/8: the second of eight parts. `billow merge` joins the folders of the parts.
    #[arg(long, value_name = "K/N", conflicts_with = "chunk")]
    points: Option<String>,
    /// Share the results folder with other runs, also on other machines: each run claims a job before it starts it.
    #[arg(long)]
    shared: bool,
    /// Run the jobs of one task of a submission, as in --chunk 0001/3; what `billow submit` gives to its tasks.
    #[arg(long, value_name = "SUBMISSION/TASK", requires = "shared")]
    chunk: Option<String>,
}

/// What a run takes, and how it shares its folder.
#[derive(Debug, Clone, Default)]
pub struct Scope {
    /// The jobs.
    pub selection: Selection,
    /// How other runs work in the folder at the same time; `None` for a run that is alone.
    pub shared: Option<Shared>,
    /// Whether it is a task of a submission, which another task ends.
    pub is_task: bool,
}

impl ScopeOptions {
    /// What the options say for a results folder.
    ///
    /// # Errors
    /// A part or a chunk that there is not.
    pub fn scope(&self, results: &Results<'_>) -> Result<Scope> {
        let selection = match (&self.points, &self.chunk) {
            (Some(text), _) => Selection::Part(Part::parse(text).ok_or_else(|| no_part(text))?),
            (None, Some(name)) => {
                Selection::Listed(submission::chunk(results, name)?.into_iter().collect())
            }
            (None, None) => Selection::All,
        };
        let shared = self.shared.then(|| Shared { owner: owner(), lease: LEASE });
        Ok(Scope { selection, shared, is_task: self.chunk.is_some() })
    }
}

fn no_part(text: &str) -> Error {
    let allowed = "K/N: part K of N, from 1/N to N/N, as in --points 2/8";
    let next = "run every part in a folder of its own (--results), then billow merge FOLDER… --results FOLDER";
    Error::invalid_option("--points", text, "is no part", allowed, next)
}

/// Whose run this is. A task that Slurm starts again is the same owner; any other process is one of its own.
fn owner() -> String {
    let variable = |name: &str| {
        std::env::var(name).ok().filter(|text| text.bytes().all(|byte| byte.is_ascii_digit()))
    };
    match (variable("SLURM_ARRAY_JOB_ID"), variable("SLURM_ARRAY_TASK_ID")) {
        (Some(array), Some(task)) if !array.is_empty() => format!("slurm-{array}-{task}"),
        _ => format!("{}-{}", files::host_name(), std::process::id()),
    }
}
