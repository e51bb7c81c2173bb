//! The chart that the options ask for.

use super::Args;
use crate::chart::standard::ChartKind;
use crate::cli::picture::refused;
use crate::platform::error::{Error, Result};

/// What the options ask for.
pub enum Asked {
    /// One chart.
    One(ChartKind),
    /// The map of outcomes over these parameters; without any over those that change them the most.
    Outcome(Vec<String>),
}

/// The chart that the options ask for; `None` for the standard charts.
///
/// # Errors
/// A measure without axes, axes that are not two, a file or title for several charts.
pub fn kind(args: &Args) -> Result<Option<Asked>> {
    let one = |kind| Ok(Some(Asked::One(kind)));
    let by = args.by.iter().map(|name| name.trim().to_owned()).collect();
    if !args.history.is_empty() {
        let names = args.history.iter().map(|name| name.trim().to_owned());
        return one(ChartKind::History(names.collect()));
    }
    if args.borders {
        return one(ChartKind::Borders(args.over.clone(), by));
    }
    let measure = args.measure.as_deref().map(|name| name.trim().to_owned());
    let axes: Vec<String> = args.map.iter().map(|name| name.trim().to_owned()).collect();
    if args.outcome && matches!(axes.len(), 0 | 2) {
        return Ok(Some(Asked::Outcome(axes)));
    }
    let map = |measure: String| match axes.as_slice() {
        [x, y] => one(ChartKind::Map(measure, [x.clone(), y.clone()])),
        [] => Err(refused(
            "--measure",
            &measure,
            "needs a parameter to be drawn over",
            "--over PARAMETER, or --map X,Y",
        )),
        several => Err(refused("--map", &several.join(","), "not two parameters", "--map X,Y")),
    };
    match (measure, &args.over) {
        (None, _) if args.outcome => map(String::new()),
        (Some(measure), Some(over)) => one(ChartKind::Over(measure, over.clone(), by)),
        (Some(measure), None) => map(measure),
        (None, _) => several(args),
    }
}

/// The error of a map whose axes the command chose: it names `--outcome`, the option that was given.
pub fn of_outcome(error: Error) -> Error {
    match error {
        Error::Input(mut error) if error.file == "--map" => {
            error.problem = format!("{}: {}", error.value, error.problem);
            error.hint = format!("{}, or choose axes with --map X,Y", error.hint);
            (error.file, error.value) = ("--outcome".to_owned(), String::new());
            Error::Input(error)
        }
        error => error,
    }
}

/// The standard charts, which have no file and no title together.
fn several(args: &Args) -> Result<Option<Asked>> {
    let one = "one chart: --history, --measure … --over, --measure … --map, --outcome or --borders";
    match (&args.out, &args.title) {
        (None, None) => Ok(None),
        (Some(path), _) => {
            let path = path.display().to_string();
            Err(refused("--out", &path, "one file for several charts", one))
        }
        (None, Some(title)) => Err(refused("--title", title, "one title for several charts", one)),
    }
}
