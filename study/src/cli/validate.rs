//! `billow validate`: the reference cases, judged.

use std::io::Write;
use std::path::Path;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use rayon::ThreadPool;

use super::instruction_set::instruction_set;
use super::print::print_rows;
use super::{Format, Global};
use crate::cases::{self, CASES, Case, Judged, Rig, Tier};
use crate::input::keys;
use crate::input::value::Value;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::disk_error;
use crate::platform::stop::Stop;

/// How long a signal may go unseen.
const LOOK: Duration = Duration::from_millis(50);

/// Arguments of `billow validate`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Run this case only; may be given again.
    #[arg(long = "case", value_name = "NAME")]
    pub cases: Vec<String>,
    /// Leave out the long cases.
    #[arg(long)]
    pub quick: bool,
    /// List the cases and what each compares; run nothing.
    #[arg(long)]
    pub list: bool,
}

/// Runs `billow validate`.
///
/// # Errors
/// When a case is not known, or one is out of band; a signal, after the rows of what has ended.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let chosen = chosen(&args.cases)?;
    if args.list {
        return list(&chosen, global.format(), out);
    }
    let skip = |case: &&Case| args.quick && case.tier == Tier::Long;
    let (skipped, cases): (Vec<&Case>, Vec<&Case>) = chosen.into_iter().partition(skip);
    if cases.is_empty() {
        return Err(Error::Input(InputError {
            file: "--quick".to_owned(),
            key: String::new(),
            value: String::new(),
            problem: "leaves out every case asked for".to_owned(),
            allowed: "long cases without --quick".to_owned(),
            hint: String::new(),
        }));
    }
    let rig = Rig { instruction_set: instruction_set()?, ..Rig::default() };
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let total = cases.len();
    let mut judged =
        judge(super::run::pool(global)?, cases.clone(), rig, &stop, &|number, judged| {
            if !global.quiet {
                let verdict = if judged.pass() { "in band" } else { "OUT OF BAND" };
                let Judged { name, seconds, .. } = judged;
                eprintln!("billow: {number}/{total} {name}: {verdict}, {seconds:.1} s");
            }
        });
    let place = |judged: &Judged| cases.iter().position(|case| case.name == judged.name);
    judged.sort_by_key(place);
    if !skipped.is_empty() && !global.quiet {
        let names: Vec<&str> = skipped.iter().map(|case| case.name).collect();
        eprintln!("billow: skipped by --quick: {}", names.join(", "));
    }
    print(&judged, global.format(), out)?;
    match stop.requested().filter(|_| judged.len() < total) {
        Some(signal) => {
            let next = format!(
                "{} of {total} cases were judged, above; --case NAME runs one alone",
                judged.len()
            );
            Err(Error::Interrupted { signal, next })
        }
        None => verdict(&judged),
    }
}

/// Runs cases, each told with its number as it ends; those that have ended when a signal asks to stop.
/// A case cannot be stopped in its midst: it is left, and ends with the program.
fn judge(
    pool: ThreadPool,
    cases: Vec<&'static Case>,
    rig: Rig,
    stop: &Stop,
    tell: &dyn Fn(usize, &Judged),
) -> Vec<Judged> {
    let (told, ended) = mpsc::channel();
    let _running = thread::spawn(move || {
        // Nobody listens once a signal has come.
        cases::run_all(&pool, &cases, &rig, &|judged| drop(told.send(judged.clone())))
    });
    let mut judged = Vec::new();
    while stop.requested().is_none() {
        match ended.recv_timeout(LOOK) {
            Ok(case) => {
                tell(judged.len() + 1, &case);
                judged.push(case);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    judged
}

/// What the program ends with.
///
/// # Errors
/// When a case is out of band.
pub fn verdict(judged: &[Judged]) -> Result<()> {
    let outside: Vec<&str> = judged.iter().filter(|j| !j.pass()).map(|j| j.name).collect();
    if outside.is_empty() {
        return Ok(());
    }
    Err(Error::JobsFailed(format!(
        "{} of {} cases out of band: {}",
        outside.len(),
        judged.len(),
        outside.join(", ")
    )))
}

/// The cases of these names, in the table's order; all where none is named.
fn chosen(names: &[String]) -> Result<Vec<&'static Case>> {
    for name in names {
        if !CASES.iter().any(|case| case.name == name) {
            let known = || CASES.iter().map(|case| case.name);
            let near = keys::nearest(name, known());
            return Err(Error::Input(InputError {
                file: "--case".to_owned(),
                key: String::new(),
                value: name.clone(),
                problem: "there is no such case".to_owned(),
                allowed: known().collect::<Vec<_>>().join(", "),
                hint: near.map(|near| format!("did you mean {near}?")).unwrap_or_default(),
            }));
        }
    }
    let named = |case: &&Case| names.is_empty() || names.iter().any(|name| name == case.name);
    Ok(CASES.iter().filter(named).collect())
}

fn list(cases: &[&Case], format: Format, out: &mut dyn Write) -> Result<()> {
    let text = |text: &str| Value::Text(text.to_owned());
    let tier = |case: &Case| if case.tier == Tier::Quick { "quick" } else { "long" };
    let rows: Vec<Vec<Value>> = cases
        .iter()
        .map(|case| vec![text(case.name), text(tier(case)), text(case.compares)])
        .collect();
    print_rows(&["case", "tier", "compares"], &rows, format, out)
}

/// Prints the rows of the cases, one a quantity; the seconds are those of the whole case.
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
        "band",
        "pass",
        "seconds",
        "note",
    ];
    print_rows(&columns, &rows, format, out)
}
