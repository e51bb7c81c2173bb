//! `billow compare`: compares the values of one parameter, all other parameters being equal.

use std::io::Write;

use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::print::{Heading, print_quantities};
use super::target::{StudyArgs, filtered, find, folder};
use super::{Format, changes, output_error, study_keys};
use crate::analysis::compare::{
    self, Better, Compared, Measure, Pair, Sets, Tally, Tolerance, measures_with,
};
use crate::input::units::{self, Dimension, DisplayUnit};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::BetterSide;
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};

mod notes;

/// Measures that a table compares by default.
const DEFAULT_MEASURES: [&str; 2] = ["t_90_z_rim_since_release", "peak_kinetic_energy"];

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
    /// Measures, comma-separated [default: `t_90_z_rim_since_release,peak_kinetic_energy`; for csv and
    /// json all measures for which smaller or larger is better].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub measures: Vec<String>,
    /// Only rows for which this condition holds, as in `N == 6 and M >= 3`.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// Relative difference up to which a pair is a tie, as in 1% [default: the larger spread of the
    /// measure, by seed or by method; without either the values are lower or higher, not better].
    #[arg(long, value_name = "FRACTION")]
    pub tie: Option<String>,
    /// Print only the summary: one row per value and measure.
    #[arg(long)]
    pub summary: bool,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Outcomes of a pair: column, outcome, and whether a table always shows the column.
const OUTCOMES: [(&str, Better, bool); 10] = [
    ("other_better", Better::Other, true),
    ("base_better", Better::Base, true),
    ("ties", Better::Tie, true),
    ("only_other", Better::OnlyOther, false),
    ("only_base", Better::OnlyBase, false),
    ("neither", Better::Neither, false),
    ("other_lower", Better::Lower, false),
    ("other_higher", Better::Higher, false),
    ("same_job", Better::SameJob, false),
    ("pending", Better::Pending, false),
];

/// The pairs and measures to compare.
struct Comparison<'a> {
    table: &'a Table,
    by: &'a Column,
    sets: Sets,
    pairs: Vec<Pair>,
    measures: Vec<Measure<'a>>,
}

/// Runs `billow compare`: one row per pair, then a summary with one row per value and measure.
///
/// # Errors
/// An unknown parameter, value, measure or column; results that cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let root = folder(&args.study, &args.set.set)?;
    let stored = super::stored::read(&root)?;
    changes::note(&stored.results, args.study.study.as_deref(), &args.set.set)?;
    let table = stored.table();
    let units = args.units.of_table(&table, stored.study.display_units())?;
    let mut table = table.shown_in(&units);
    let names = study_keys::names_in(args.condition.as_deref());
    study_keys::add(&stored.study, &mut table, &units, &names);
    let by = parameter(&table, &args.by)?;
    let base = base(&stored, by, &args.base)?;
    let rows = filtered(&table, args.condition.as_deref())?;
    let format = args.output.format();
    let zipped = |name: &str| stored.study.zipped_with(name);
    let sets = Sets::new(&table, &rows, &by.name, &zipped(&by.name));
    let (pairs, alone) = compare::pairs(&table, &sets, &by.name, &base);
    let given = args.tie.as_deref().map(fraction).transpose()?.map(Tolerance::given);
    let tolerance =
        |column| given.unwrap_or_else(|| Tolerance::of(&table, &rows, column, &zipped("seed")));
    let measures = measures(&table, &args.measures, format)?
        .into_iter()
        .map(|column| Measure { column, tolerance: tolerance(column) })
        .collect();
    let comparison = Comparison { table: &table, by, sets, pairs, measures };
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
        let values: Vec<String> = values.iter().map(|value| by.shown.quantity(value)).collect();
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
        let parameters = self.sets.matched.iter().chain([&self.by.name]).chain(&self.sets.carried);
        let mut columns: Vec<Heading> = parameters
            .map(|name| {
                let shown = self.table.column(name).map(|column| column.shown.clone());
                Heading { name: name.clone(), unit: shown.unwrap_or_else(|| DisplayUnit::si("")) }
            })
            .collect();
        let sides = |name: &&str| [format!("base_{name}"), format!("other_{name}")];
        columns.extend(outcome.iter().flat_map(sides).map(Heading::plain));
        for measure in &self.measures {
            let shown = &measure.column.shown;
            columns.extend(Self::figures(measure, brief).iter().map(|figure| Heading {
                name: format!("{}_{figure}", measure.column.name),
                unit: match *figure {
                    "base" | "other" => shown.clone(),
                    "difference" => shown.of_difference(),
                    _ => DisplayUnit::si(""),
                },
            }));
        }
        let rows: Vec<Vec<Value>> =
            self.pairs.iter().map(|pair| self.row(*pair, outcome, brief)).collect();
        print_quantities(&columns, &rows, format, out)
    }

    /// The figures of a measure. A table has the ratio, or the difference of a signed measure.
    fn figures(measure: &Measure<'_>, brief: bool) -> &'static [&'static str] {
        match (brief, measure.is_signed()) {
            (true, false) => &["base", "other", "ratio", "better"],
            (true, true) => &["base", "other", "difference", "better"],
            (false, _) => &["base", "other", "difference", "ratio", "better"],
        }
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
            let compared = compare::compared(self.table, pair, measure);
            row.extend(Self::figures(measure, brief).iter().map(|figure| match *figure {
                "base" => number(compared.base),
                "other" => number(compared.other),
                "difference" => number(Compared::difference(&compared)),
                "ratio" => number(compared.ratio()),
                _ => Value::Text(compared.better.name().to_owned()),
            }));
        }
        row
    }

    /// Prints one row per value and measure. A table has no columns for outcomes that no pair has.
    fn print_tallies(&self, format: Format, out: &mut dyn Write) -> Result<()> {
        let tallies = compare::tallies(self.table, &self.pairs, &self.by.name, &self.measures);
        let occurs = |outcome| tallies.iter().any(|tally| tally.count(outcome) > 0);
        let outcomes: Vec<(&str, Better)> = OUTCOMES
            .into_iter()
            .filter(|(_, outcome, always)| *always || format != Format::Table || occurs(*outcome))
            .map(|(name, outcome, _)| (name, outcome))
            .collect();
        // A table shows differences only where a measure has no ratio.
        let with_differences =
            format != Format::Table || self.measures.iter().any(Measure::is_signed);
        let differences: &[&str] = if with_differences {
            &["median_difference", "least_difference", "largest_difference"]
        } else {
            &[]
        };
        let by = Heading { name: self.by.name.clone(), unit: self.by.shown.clone() };
        let others = ["measure", "pairs"].into_iter();
        let others = others
            .chain(outcomes.iter().map(|(name, _)| *name))
            .chain(["median_ratio", "least_ratio", "largest_ratio"])
            .chain(differences.iter().copied());
        let columns: Vec<Heading> = [by].into_iter().chain(others.map(Heading::plain)).collect();
        // Rows of the differences have the units of different measures, so a cell says its own.
        let in_unit = |measure: &str, value: f64| {
            let shown = self.measures.iter().find(|known| known.column.name == measure);
            let unit = shown.map(|known| known.column.shown.of_difference());
            match unit.filter(|_| format == Format::Table) {
                Some(unit) => Value::Text(unit.brief(value)),
                None => Value::Number(value),
            }
        };
        let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        let row = |tally: &Tally| {
            let mut row = vec![tally.value.clone(), Value::Text(tally.measure.clone())];
            row.push(number(tally.pairs()));
            row.extend(outcomes.iter().map(|(_, outcome)| number(tally.count(*outcome))));
            row.extend(tally.ratio.map_or([const { Value::Null }; 3], |spread| {
                [spread.median, spread.least, spread.largest].map(Value::Number)
            }));
            if with_differences {
                row.extend(tally.difference.map_or([const { Value::Null }; 3], |spread| {
                    [spread.median, spread.least, spread.largest]
                        .map(|value| in_unit(&tally.measure, value))
                }));
            }
            row
        };
        let rows: Vec<Vec<Value>> = tallies.iter().map(row).collect();
        print_quantities(&columns, &rows, format, out)
    }
}
