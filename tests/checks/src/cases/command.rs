//! `billow-checks validate`: runs the reference cases and compares their errors with their tolerances.

use std::io::Write;

use billow_study::cli::options::ThreadsOption;
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::print::Format;
use billow_study::print::print_rows;

use super::{CASES, Case, Judged, Rig, Row, run_all};
use crate::output::{Options, chosen};

/// Arguments of `billow-checks validate`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Run only this case; can be repeated.
    #[arg(long = "case", value_name = "NAME")]
    cases: Vec<String>,
    /// Skip the long cases.
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    threads: ThreadsOption,
    #[command(flatten)]
    options: Options,
}

/// Runs `billow-checks validate`.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let chosen = chosen("--case", &args.cases, CASES, |case| case.name)?;
    let skip = |case: &&Case| args.quick && case.long;
    let (skipped, cases): (Vec<&Case>, Vec<&Case>) = chosen.into_iter().partition(skip);
    let rig = Rig::selected()?;
    let pool = args.threads.pool()?;
    if !skipped.is_empty() {
        let names: Vec<&str> = skipped.iter().map(|case| case.name).collect();
        args.options.note(&format!("skipped by --quick: {}", names.join(", ")));
    }
    let judged = run_all(&pool, &cases, &rig, &|judged| {
        let verdict = if judged.pass() { "in tolerance" } else { "OUT OF TOLERANCE" };
        args.options.note(&format!("{}: {verdict}, {:.1} s", judged.name, judged.seconds));
    });
    print(&judged, args.options.format(), out)?;
    verdict(&judged)
}

/// The error of the command.
pub fn verdict(judged: &[Judged]) -> Result<()> {
    let outside = judged.iter().filter(|judged| !judged.pass());
    let outside: Vec<&str> = outside.map(|judged| judged.name).collect();
    if outside.is_empty() {
        return Ok(());
    }
    let (number, all) = (outside.len(), judged.len());
    let names = outside.join(", ");
    Err(Error::JobsFailed(format!("{number} of {all} cases out of tolerance: {names}")))
}

/// Columns of the output. `seconds` is the time of the whole case.
const COLUMNS: &str = "case,quantity,value,reference,error,order,tolerance,pass,seconds,note";

/// Prints one row per quantity of the cases.
pub fn print(judged: &[Judged], format: Format, out: &mut dyn Write) -> Result<()> {
    let number = |value: f64| Value::from(Some(value).filter(|value| value.is_finite()));
    let of_row = |case: &Judged, row: &Row| -> Vec<Value> {
        vec![
            case.name.into(),
            row.quantity.as_str().into(),
            number(row.value),
            row.reference.map_or(Value::Null, number),
            number(row.error),
            row.order.map_or(Value::Null, number),
            number(row.band),
            row.pass.into(),
            number(case.seconds),
            row.note.as_str().into(),
        ]
    };
    let rows = judged.iter().flat_map(|case| case.rows.iter().map(move |row| of_row(case, row)));
    let columns: Vec<&str> = COLUMNS.split(',').collect();
    print_rows(&columns, &rows.collect::<Vec<_>>(), format, out)
}
