//! `billow run` where nothing is to do: the answer comes from the index of the results, without planning the study and
//! without its records.

use std::io::Write;
use std::path::Path;

use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::{Args, Ended, RunOptions, result};
use crate::analysis::answer::Answer;
use crate::cli::memory::{self, Memory};
use crate::cli::remedies::Applicable;
use crate::cli::stored::write_index_file;
use crate::cli::target::results_folder;
use crate::cli::{instruction_set, notes, output_error};
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::platform::files::{Disk, Stamp};
use crate::run::event::Event;
use crate::run::progress;
use crate::run::runner::Summary;
use crate::store::index::{Index, Key};
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::Table;
use crate::study::Study;
use crate::study::job_limits::with_options;

/// What a run prints when nothing is to do, beside the numbers of jobs.
#[derive(Serialize, Deserialize)]
struct Finished {
    /// The notes on the points of the study.
    notes: Vec<String>,
    /// Memory of the largest job, bytes.
    largest_memory: u64,
    answer: Answer,
}

/// Prints the result of a run in which nothing is to do. `None`, and nothing printed, where the index cannot say that:
/// the study or a file has changed, a job is missing, something must be repaired, or an option asks for more.
pub(super) fn run(
    args: &Args,
    file: &Path,
    folder: Option<&Path>,
    out: &mut dyn Write,
) -> Option<Result<()>> {
    let options = &args.options;
    let study = Study::sketch(file, &args.set.set).ok()?.filter(|_| !options.changes_units())?;
    let root = folder
        .filter(|_| args.results.results.is_none())
        .map_or_else(|| results_folder(&args.results, &study), Path::to_owned);
    let results = Results::new(&Disk, &root);
    let index = Index::of_study(&results, &study)?;
    let finished: Finished = serde_json::from_value(index.finished.clone()).ok()?;
    let limits = with_options(study.job_limits(), &options.job_limit).ok()?;
    let (threads, note) = memory::threads(options.threads.count().ok()?);
    instruction_set::selected().ok()?;
    let memory = Memory::new(threads);
    let has_memory = memory.check().is_ok()
        && memory.has_room_for(finished.largest_memory)
        && study.job_limits().memory.is_none_or(|limit| finished.largest_memory <= limit);
    if !has_memory || index.counts.of(Status::Pending) > 0 {
        return None;
    }
    let _lock = results.lock().ok()?;
    if !is_intact(&results, &index) {
        return None;
    }
    let failed = index.stored(&results, &index.failed)?;
    if !options.progress.quiet {
        notes::print_warnings(&study);
        notes::print_of_file(&study);
        finished.notes.iter().chain(&note).for_each(|line| eprintln!("{line}"));
    }
    let mut reporter = progress::reporter(options.progress.loudness(), threads);
    let jobs = index.counts.jobs();
    reporter.event(&Event::GenerationStarted { number: 0, jobs, finished: jobs });
    reporter.event(&Event::Ended);
    let summary = Summary { counts: index.counts.clone(), ..Summary::default() };
    let study = study.counted(index.runs, index.points);
    let ended = Ended { study: &study, root: &root, summary: &summary, points: index.runs };
    let printed = ended.print(&finished.answer, options.output.format(), out);
    Some(
        printed
            .map_err(output_error)
            .and_then(|()| result(&study, &summary, &limits, &root, &Applicable::of(&failed))),
    )
}

/// Whether a run that holds the lock would change no file: the files of the index are as they were, each history has the
/// size and the time of its record, and no earlier run has left something.
fn is_intact(results: &Results<'_>, index: &Index) -> bool {
    let files: Vec<(&JobId, &Stamp)> = index.files().collect();
    let is_there = |(id, stamp): (&JobId, &Stamp)| {
        results.files().stamp(&results.job_path(id)).is_ok_and(|found| found == *stamp)
    };
    !results.attempts_path().exists()
        && results.checkpoints().is_ok_and(|checkpoints| checkpoints.is_empty())
        && results.references().unread.is_empty()
        && results.remove_temporary_files().is_ok()
        && index.is_current(results)
        && files.into_par_iter().all(is_there)
}

/// Writes the index of results that were read whole. `key` is that of the folder before they were read, `table` their
/// table.
pub(super) fn write_index(
    study: &Study,
    (stored, table): (&Stored<'_>, &Table),
    key: Option<Key>,
    answer: &Answer,
    options: &RunOptions,
) {
    let results = &stored.results;
    let has_answer = !options.changes_units() && !study.warns_of_points();
    let known = Index::read(results);
    if known.is_some_and(|known| !known.finished.is_null() || !has_answer) {
        return;
    }
    let Some(mut index) = key.and_then(|key| Index::of(stored, key, table)) else { return };
    if has_answer {
        let largest_memory = memory::largest(study);
        let finished =
            Finished { notes: notes::of_points(study), largest_memory, answer: answer.clone() };
        index.finished = serde_json::to_value(finished).unwrap_or_default();
    }
    write_index_file(&index, results);
}
