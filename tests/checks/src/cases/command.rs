//! `billow-checks validate`: runs the reference cases and compares their errors with their tolerances.

use std::io::Write;
use std::path::Path;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use rayon::ThreadPool;

use super::{CASES, Case, Judged, Rig, Tier, costs, run_all};
use crate::output::chosen;
use billow_study::cli::options::{OutputOptions, QuietOption, ThreadsOption};
use billow_study::cli::print::{count, duration, print_rows};
use billow_study::cli::{Format, instruction_set};
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::disk_error;
use billow_study::platform::stop::Stop;

/// Interval at which a signal is checked for. Chosen: short for a user, long for a processor.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// Arguments of `billow-checks validate`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Run only this case; can be repeated.
    #[arg(long = "case", value_name = "NAME")]
    pub cases: Vec<String>,
    /// Skip the long cases. The first line on stderr estimates the time.
    #[arg(long)]
    pub quick: bool,
    /// List the cases, about how long each takes and what it compares; run nothing.
    #[arg(long)]
    pub list: bool,
    #[command(flatten)]
    threads: ThreadsOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow-checks validate`.
///
/// # Errors
/// An unknown case; a case that is out of tolerance; a signal, after the rows of the finished cases.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let chosen = chosen("--case", &args.cases, CASES, |case| case.name)?;
    if args.list {
        return list(&chosen, args.output.format(), out);
    }
    let skip = |case: &&Case| args.quick && case.tier == Tier::Long;
    let (skipped, cases): (Vec<&Case>, Vec<&Case>) = chosen.into_iter().partition(skip);
    if cases.is_empty() {
        let problem = "skips every case that --case names";
        return Err(Error::invalid_option(
            "--quick",
            "",
            problem,
            "long cases without --quick",
            "",
        ));
    }
    let rig = Rig { instruction_set: instruction_set::selected()?, ..Rig::default() };
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let total = cases.len();
    let pool = args.threads.pool()?;
    if !args.quiet.quiet {
        let threads = pool.current_num_threads();
        eprintln!(
            "billow-checks: {}, about {} with {} on an idle machine",
            count(total, "case"),
            duration(costs::total_seconds(&cases, threads).ceil()),
            count(threads, "thread")
        );
    }
    let mut judged = judge(pool, cases.clone(), rig, &stop, &|number, judged| {
        if !args.quiet.quiet {
            let verdict = if judged.pass() { "in tolerance" } else { "OUT OF TOLERANCE" };
            let Judged { name, seconds, .. } = judged;
            eprintln!("billow-checks: {number}/{total} {name}: {verdict}, {seconds:.1} s");
        }
    });
    let position = |judged: &Judged| cases.iter().position(|case| case.name == judged.name);
    judged.sort_by_key(position);
    if !skipped.is_empty() && !args.quiet.quiet {
        let names: Vec<&str> = skipped.iter().map(|case| case.name).collect();
        eprintln!("billow-checks: skipped by --quick: {}", names.join(", "));
    }
    print(&judged, args.output.format(), out)?;
    match stop.requested().filter(|_| judged.len() < total) {
        Some(signal) => {
            let next = format!(
                "{} of {total} cases finished, their rows are above; --case NAME runs one case",
                judged.len()
            );
            Err(Error::Interrupted { signal, next })
        }
        None => verdict(&judged),
    }
}

/// Runs cases and returns them as judged. Calls `report` with a running number for each case that ends.
/// After a signal it returns the cases that have ended; the others end with the program, because a case
/// cannot be interrupted.
fn judge(
    pool: ThreadPool,
    cases: Vec<&'static Case>,
    rig: Rig,
    stop: &Stop,
    report: &dyn Fn(usize, &Judged),
) -> Vec<Judged> {
    let (sender, ended) = mpsc::channel();
    let _running = thread::spawn(move || {
        // After a signal the receiver is gone and the send fails.
        let send = |judged: &Judged| drop(sender.send(judged.clone()));
        run_all(&pool, &cases, &rig, &send)
    });
    let mut judged = Vec::new();
    while stop.requested().is_none() {
        match ended.recv_timeout(SIGNAL_INTERVAL) {
            Ok(case) => {
                report(judged.len() + 1, &case);
                judged.push(case);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    judged
}

/// The error of the command.
///
/// # Errors
/// When a case is out of tolerance.
pub fn verdict(judged: &[Judged]) -> Result<()> {
    let outside: Vec<&str> = judged.iter().filter(|j| !j.pass()).map(|j| j.name).collect();
    if outside.is_empty() {
        return Ok(());
    }
    Err(Error::JobsFailed(format!(
        "{} of {} cases out of tolerance: {}",
        outside.len(),
        judged.len(),
        outside.join(", ")
    )))
}

fn list(cases: &[&Case], format: Format, out: &mut dyn Write) -> Result<()> {
    let text = |text: &str| Value::Text(text.to_owned());
    let tier = |case: &Case| if case.tier == Tier::Quick { "quick" } else { "long" };
    let rows: Vec<Vec<Value>> = cases
        .iter()
        .map(|case| {
            let seconds = Value::Number(costs::seconds(case));
            vec![text(case.name), text(tier(case)), seconds, text(case.compares)]
        })
        .collect();
    print_rows(&["case", "tier", "seconds", "compares"], &rows, format, out)
}

/// Prints one row per quantity of the cases. `seconds` is the time of the whole case.
///
/// # Errors
/// When the output cannot be written.
pub fn print(judged: &[Judged], format: Format, out: &mut dyn Write) -> Result<()> {
    let rows: Vec<Vec<Value>> = judged
        .iter()
        .flat_map(|case| case.rows.iter().map(move |row| (case, row)))
        .map(|(case, row)| {
            let number = |value: f64| {
                if value.is_finite() { Value::Number(value) } else { Value::Null }
            };
            let maybe = |value: Option<f64>| value.map_or(Value::Null, number);
            vec![
                Value::Text(case.name.to_owned()),
                Value::Text(row.quantity.clone()),
                number(row.value),
                maybe(row.reference),
                number(row.error),
                maybe(row.order),
                number(row.band),
                if format == Format::Table {
                    Value::Text(if row.pass { "yes" } else { "NO" }.to_owned())
                } else {
                    Value::Bool(row.pass)
                },
                number(case.seconds),
                Value::Text(row.note.clone()),
            ]
        })
        .collect();
    let value = if format == Format::Table { "billow" } else { "value" };
    let columns = [
        "case",
        "quantity",
        value,
        "reference",
        "error",
        "order",
        "tolerance",
        "pass",
        "seconds",
        "note",
    ];
    print_rows(&columns, &rows, format, out)
}
