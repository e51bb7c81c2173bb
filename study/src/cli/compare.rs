//! `billow compare`: compares the values of one parameter, all other parameters being equal.

use std::fmt::Write as _;
use std::io::Write;

use super::options::{OutputOptions, QuietOption};
use super::print::{count, print_rows};
use super::target::{StudyArgs, filtered, find, folder};
use super::{Format, output_error};
use crate::analysis::compare::{
    self, Better, Compared, DEFAULT_TIE, Pair, Sets, Tally, measures_with,
};
use crate::input::units::{self, Dimension};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::BetterSide;
use crate::platform::error::{Error, Result};
use crate::platform::files::Disk;
use crate::platform::nearest::did_you_mean;
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};

/// Measures that a table compares by default.
const DEFAULT_MEASURES: [&str; 2] = ["t_90_z_rim", "peak_vz"];

/// Arguments of `billow compare`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// The parameter to compare by.
    #[arg(long, value_name = "PARAM")]
    pub by: String,
    /// The value that the other values are compared with; with its unit, as in "1 g/s".
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true)]
    pub base: String,
    /// Measures, comma-separated [default: `t_90_z_rim,peak_vz`; for csv and json all measures for
    /// which smaller or larger is better].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub measures: Vec<String>,
    /// Only rows for which this condition holds, as in `N == 6 and M >= 3`.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// Relative difference up to which a pair is a tie, as in 1% [default: 1e-9, for rounding].
    #[arg(long, value_name = "FRACTION")]
    pub tie: Option<String>,
    /// Print only the summary: one row per value and measure.
    #[arg(long)]
    pub summary: bool,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Outcomes of a pair: column, outcome, and whether a table always shows the column.
const OUTCOMES: [(&str, Better, bool); 8] = [
    ("other_better", Better::Other, true),
    ("base_better", Better::Base, true),
    ("ties", Better::Tie, true),
    ("only_other", Better::OnlyOther, false),
    ("only_base", Better::OnlyBase, false),
    ("neither", Better::Neither, false),
    ("differ", Better::Differ, false),
    ("pending", Better::Pending, false),
];

/// The pairs and measures to compare.
struct Comparison<'a> {
    table: &'a Table,
    by: &'a Column,
    sets: Sets,
    pairs: Vec<Pair>,
    measures: Vec<&'a Column>,
    tie: f64,
}

/// Runs `billow compare`: one row per pair, then a summary with one row per value and measure.
///
/// # Errors
/// An unknown parameter, value, measure or column; results that cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let root = folder(&args.study, &[])?;
    let stored = Stored::read(Results::new(&Disk, &root))?;
    let table = stored.table_of_all_points();
    let by = parameter(&table, &args.by)?;
    let base = base(&stored, by, &args.base)?;
    let rows = filtered(&table, args.condition.as_deref())?;
    let format = args.output.format();
    let sets = Sets::new(&table, &rows, &by.name, &stored.study.zipped_with(&by.name));
    let (pairs, alone) = compare::pairs(&table, &sets, &by.name, &base);
    let measures = measures(&table, &args.measures, format)?;
    let tie = args.tie.as_deref().map_or(Ok(DEFAULT_TIE), fraction)?;
    let comparison = Comparison { table: &table, by, sets, pairs, measures, tie };
    if !args.summary {
        comparison.print_pairs(format, out)?;
    }
    if args.summary || format == Format::Table {
        if !args.summary {
            writeln!(out).map_err(output_error)?;
        }
        comparison.print_tallies(format, out)?;
    }
    if !args.quiet.quiet {
        comparison.print_notes(&base, &alone);
    }
    Ok(())
}

fn parameter<'a>(table: &'a Table, name: &str) -> Result<&'a Column> {
    let names = || table.parameters().map(|column| column.name.as_str());
    table.parameters().find(|column| column.name == name).ok_or_else(|| {
        let near = did_you_mean(name, names());
        let mut allowed = names().collect::<Vec<_>>().join(", ");
        if allowed.is_empty() {
            "none: the study varies no parameter".clone_into(&mut allowed);
        }
        let problem = "not a parameter the study varies";
        Error::invalid_option("--by", name, problem, allowed, near.unwrap_or_default())
    })
}

/// The base value, as in the table.
fn base(stored: &Stored<'_>, by: &Column, text: &str) -> Result<Value> {
    let values = compare::values(by, &(0..by.cells.len()).collect::<Vec<_>>());
    let wanted = stored.study.parameter_value(&by.name, text);
    let found = values.iter().find(|value| {
        // A column of texts and numbers stores its numbers as text.
        value.to_string() == text.trim()
            || wanted.as_ref().is_some_and(|wanted| {
                compare::canonical(value) == compare::canonical(wanted)
                    || value.to_string() == wanted.to_string()
            })
    });
    found.cloned().ok_or_else(|| {
        let unit = if matches!(by.unit.as_str(), "" | "1") { "" } else { &by.unit };
        let values: Vec<String> =
            values.iter().map(|value| format!("{value} {unit}").trim_end().to_owned()).collect();
        let problem = format!("not a value of {} in this study", by.name);
        let near = did_you_mean(text, values.iter().map(String::as_str)).unwrap_or_default();
        Error::invalid_option("--base", text, problem, values.join(", "), near)
    })
}

fn measures<'a>(table: &'a Table, names: &[String], format: Format) -> Result<Vec<&'a Column>> {
    let existing = |names: &[&str]| -> Vec<&'a Column> {
        names.iter().filter_map(|name| table.column(name)).collect()
    };
    match names {
        [] if format == Format::Table => Ok(existing(&DEFAULT_MEASURES)),
        [] => Ok(existing(
            &[measures_with(BetterSide::Smaller), measures_with(BetterSide::Larger)].concat(),
        )),
        names => names.iter().map(|name| measure(table, name.trim())).collect(),
    }
}

fn measure<'a>(table: &'a Table, name: &str) -> Result<&'a Column> {
    let column = find(table, "--measures", name)?;
    if compare::is_measure(column) {
        return Ok(column);
    }
    let numbers = table.columns.iter().filter(|column| compare::is_measure(column));
    let numbers: Vec<&str> = numbers.map(|column| column.name.as_str()).collect();
    let problem = "holds no numbers to compare";
    Err(Error::invalid_option("--measures", name, problem, numbers.join(", "), ""))
}

/// A fraction, as 0.01 or "1%".
fn fraction(text: &str) -> Result<f64> {
    let number = text.trim().parse().ok();
    let number = number.or_else(|| units::parse(text, Dimension::Number).ok());
    number.filter(|number| (0.0..1.0).contains(number)).ok_or_else(|| {
        let allowed = "at least 0 and less than 1, as 0.01 or 1%";
        Error::invalid_option("--tie", text, "not a relative difference", allowed, "")
    })
}

impl Comparison<'_> {
    /// Prints one row per pair. A table has fewer columns than csv and json.
    fn print_pairs(&self, format: Format, out: &mut dyn Write) -> Result<()> {
        let brief = format == Format::Table;
        let all_done = self.pairs.iter().all(|pair| {
            [pair.base, pair.other].iter().all(|row| self.table.status(*row) == Some(Status::Done))
        });
        let outcome: &[&str] = match (brief, all_done) {
            (true, true) => &[],
            (true, false) => &["status"],
            (false, _) => &["job", "status", "verdict"],
        };
        let figures: &[&str] = if brief {
            &["base", "other", "ratio", "better"]
        } else {
            &["base", "other", "difference", "ratio", "better"]
        };
        let mut columns: Vec<String> = self.sets.matched.clone();
        columns.push(self.by.name.clone());
        columns.extend(self.sets.carried.iter().cloned());
        let sides = |name: &&str| [format!("base_{name}"), format!("other_{name}")];
        columns.extend(outcome.iter().flat_map(sides));
        for measure in &self.measures {
            columns.extend(figures.iter().map(|figure| format!("{}_{figure}", measure.name)));
        }
        let rows: Vec<Vec<Value>> =
            self.pairs.iter().map(|pair| self.row(*pair, outcome, brief)).collect();
        print_rows(&columns, &rows, format, out)
    }

    fn row(&self, pair: Pair, outcome: &[&str], brief: bool) -> Vec<Value> {
        let cell = |name: &str, row: usize| {
            self.table.column(name).map_or(Value::Null, |column| column.cells[row].clone())
        };
        let parameters = self.sets.matched.iter().chain([&self.by.name]).chain(&self.sets.carried);
        let mut row: Vec<Value> = parameters.map(|name| cell(name, pair.other)).collect();
        for name in outcome {
            row.extend([cell(name, pair.base), cell(name, pair.other)]);
        }
        let number = |number: Option<f64>| number.map_or(Value::Null, Value::Number);
        for measure in &self.measures {
            let compared = compare::compared(self.table, pair, measure, self.tie);
            row.extend([number(compared.base), number(compared.other)]);
            if !brief {
                row.push(number(Compared::difference(&compared)));
            }
            row.extend([number(compared.ratio()), Value::Text(compared.better.name().to_owned())]);
        }
        row
    }

    /// Prints one row per value and measure. A table has no columns for outcomes that no pair has.
    fn print_tallies(&self, format: Format, out: &mut dyn Write) -> Result<()> {
        let tallies =
            compare::tallies(self.table, &self.pairs, &self.by.name, &self.measures, self.tie);
        let occurs = |outcome| tallies.iter().any(|tally| tally.count(outcome) > 0);
        let outcomes: Vec<(&str, Better)> = OUTCOMES
            .into_iter()
            .filter(|(_, outcome, always)| *always || format != Format::Table || occurs(*outcome))
            .map(|(name, outcome, _)| (name, outcome))
            .collect();
        let columns: Vec<&str> = [self.by.name.as_str(), "measure", "pairs"]
            .into_iter()
            .chain(outcomes.iter().map(|(name, _)| *name))
            .chain(["median_ratio", "least_ratio", "largest_ratio"])
            .collect();
        let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        let row = |tally: &Tally| {
            let mut row = vec![tally.value.clone(), Value::Text(tally.measure.clone())];
            row.push(number(tally.pairs()));
            row.extend(outcomes.iter().map(|(_, outcome)| number(tally.count(*outcome))));
            row.extend(tally.ratio.map_or([const { Value::Null }; 3], |ratio| {
                [ratio.median, ratio.least, ratio.largest].map(Value::Number)
            }));
            row
        };
        let rows: Vec<Vec<Value>> = tallies.iter().map(row).collect();
        print_rows(&columns, &rows, format, out)
    }

    /// Prints, on stderr, which value is the base, which ratios are better, and what is not compared.
    fn print_notes(&self, base: &Value, alone: &[usize]) {
        let by = &self.by.name;
        let unit = match base {
            Value::Number(_) if self.by.unit != "1" => format!(" {}", self.by.unit),
            _ => String::new(),
        };
        let mut text = format!("base: {by} = {base}{unit}; ratio: other / base");
        for (noun, side) in [("smaller", BetterSide::Smaller), ("larger", BetterSide::Larger)] {
            let list = measures_with(side);
            let measures = self.measures.iter().map(|measure| measure.name.as_str());
            let names: Vec<&str> = measures.filter(|name| list.contains(name)).collect();
            if !names.is_empty() {
                let _ = write!(text, "; better: {noun} {}", names.join(", "));
            }
        }
        eprintln!("{text}");
        for carried in &self.sets.carried {
            eprintln!("note: {carried} changes with {by}, so it is not matched");
        }
        if !alone.is_empty() {
            eprintln!(
                "note: {} without a partner that has the same other parameters",
                count(alone.len(), "row")
            );
        }
    }
}
