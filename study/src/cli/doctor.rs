//! `billow doctor`: checks a results folder, and repairs it.

use std::io::Write;
use std::path::PathBuf;

use super::options::OutputOptions;
use super::results::{StudyArgs, folder};
use super::{Format, output_error};
use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, Files, disk_error};
use crate::print::{count, print_rows};
use crate::store::doctor::repair::Repaired;
use crate::store::doctor::{self, Finding};
use crate::store::results::{RESULT_NAMES, Results};

/// Arguments of `billow doctor`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Repair what is damaged: restore study.json from the journal, remove invalid journal lines, set damaged
    /// files aside in the folder `damaged` so that their jobs run again, write the table again.
    #[arg(long)]
    repair: bool,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs `billow doctor`: one line per finding, faults first.
///
/// # Errors
/// [`Error::JobsFailed`] (exit code 1) when something is broken.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let root = folder(&args.study)?;
    let names = Disk.list(&root).map_err(|error| disk_error(&root, &error))?;
    let is_ours = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        RESULT_NAMES.contains(&name.as_ref())
    };
    if !names.iter().any(is_ours) {
        return Err(Error::Disk {
            path: root,
            problem: "not a results folder: it holds no file of a study\n  next: name a results folder, or \
                      run `billow run STUDY` first"
                .to_owned(),
        });
    }
    let results = Results::new(&Disk, &root);
    if args.repair {
        for Repaired { path, action } in doctor::repair::repair(&results)? {
            eprintln!("billow: repaired: {}: {action}", path.display());
        }
    }
    let health = doctor::examine(&results);
    let faults = health.faults();
    match args.output.format() {
        Format::Table => {
            for finding in &health.findings {
                writeln!(out, "{}", line(finding)).map_err(output_error)?;
            }
            let running = if health.running { "; a run is active" } else { "" };
            let state = if faults == 0 { "no faults".to_owned() } else { count(faults, "fault") };
            writeln!(
                out,
                "{}: {state}: {} recorded, {} checked, {}{running}",
                root.display(),
                count(health.records, "job"),
                if health.histories == 1 {
                    "1 history".to_owned()
                } else {
                    format!("{} histories", health.histories)
                } + &match health.checkpoints {
                    0 => String::new(),
                    number => format!(", {}", count(number, "checkpoint")),
                },
                count(health.findings.len(), "finding"),
            )
            .map_err(output_error)?;
        }
        format => {
            let rows: Vec<Vec<Value>> = health.findings.iter().map(row).collect();
            print_rows(&["level", "path", "problem", "next"], &rows, format, out)?;
        }
    }
    if faults == 0 {
        return Ok(());
    }
    Err(Error::JobsFailed(format!("{}: {}", root.display(), count(faults, "fault"))))
}

fn level(finding: &Finding) -> &'static str {
    if finding.fault { "fault" } else { "note" }
}

fn line(finding: &Finding) -> String {
    let next = if finding.next.is_empty() {
        String::new()
    } else {
        format!("; next: {}", finding.next.replace('\n', " "))
    };
    format!("{:<5}  {}: {}{next}", level(finding), finding.path.display(), finding.problem)
}

fn row(finding: &Finding) -> Vec<Value> {
    let text = |text: &str| Value::Text(text.to_owned());
    vec![
        text(level(finding)),
        text(&finding.path.display().to_string()),
        text(&finding.problem),
        text(&finding.next),
    ]
}
