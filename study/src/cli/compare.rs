//! `billow compare`: what one parameter does, all else equal.

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use super::print::count;
use super::print::print_rows;
use super::target::{filtered, find, folder};
use super::{Format, Global, output_error};
use crate::analysis::compare::{
    self, Better, Compared, DEFAULT_TIE, Pair, Sets, Tally, measures_with,
};
use crate::input::keys;
use crate::input::units::{self, Dimension};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::BetterSide;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::Disk;
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};

/// Measures compared where nobody names any, on a terminal.
const SHOWN: [&str; 2] = ["t_90_z_rim", "peak_vz"];

/// Arguments of `billow compare`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file, or folder of its results [default: the only one under results].
    pub study: Option<PathBuf>,
    /// The parameter to compare by.
    #[arg(long, value_name = "PARAM")]
    pub by: String,
    /// Its value that the others are held against, with a unit if it has one, as in "1 g/s".
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true)]
    pub base: String,
    /// Measures, comma-separated [default: `t_90_z_rim,peak_vz`; all with a better side for csv and
    /// json].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub measures: Vec<String>,
    /// Only rows of which this holds, as in `N == 6 and M >= 3`.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// Relative difference up to which a pair is a tie, as in 1% [default: 1e-9, rounding].
    #[arg(long, value_name = "SHARE")]
    pub tie: Option<String>,
    /// Print the summary alone, one row a value and measure.
    #[arg(long)]
    pub summary: bool,
}

/// What is compared with what.
struct Question<'a> {
    table: &'a Table,
    by: &'a Column,
    sets: Sets,
    pairs: Vec<Pair>,
    measures: Vec<&'a Column>,
    tie: f64,
}

/// Runs `billow compare`: one row a pair, then (or alone, with --summary) one a value and measure.
///
/// # Errors
/// A parameter, value, measure or condition that the study does not have; results that cannot be
/// read.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let root = folder(args.study.as_deref(), global)?;
    let stored = Stored::read(Results::new(&Disk, &root))?;
    let table = stored.table_of_all_points();
    let by = parameter(&table, &args.by)?;
    let base = base(&stored, by, &args.base)?;
    let rows = filtered(&table, args.condition.as_deref())?;
    let format = global.format();
    let sets = Sets::new(&table, &rows, &by.name, &stored.study.zipped_with(&by.name));
    let (pairs, alone) = compare::pairs(&table, &sets, &by.name, &base);
    let measures = measures(&table, &args.measures, format)?;
    let tie = args.tie.as_deref().map_or(Ok(DEFAULT_TIE), share)?;
    let question = Question { table: &table, by, sets, pairs, measures, tie };
    if !args.summary {
        question.print_pairs(format, out)?;
    }
    if args.summary || format == Format::Table {
        if !args.summary {
            writeln!(out).map_err(output_error)?;
        }
        question.print_tallies(format, out)?;
    }
    if !global.quiet {
        question.tell(&base, &alone);
    }
    Ok(())
}

fn refused(flag: &str, value: &str, problem: &str, allowed: String, hint: String) -> Error {
    InputError {
        file: flag.to_owned(),
        key: String::new(),
        value: value.to_owned(),
        problem: problem.to_owned(),
        allowed,
        hint,
    }
    .into()
}

fn parameter<'a>(table: &'a Table, name: &str) -> Result<&'a Column> {
    let names = || table.parameters().map(|column| column.name.as_str());
    table.parameters().find(|column| column.name == name).ok_or_else(|| {
        let near = keys::nearest(name, names()).map(|near| format!("did you mean {near}?"));
        let mut allowed = names().collect::<Vec<_>>().join(", ");
        if allowed.is_empty() {
            "nothing: the study varies no parameter".clone_into(&mut allowed);
        }
        let problem = "not a parameter the study varies";
        refused("--by", name, problem, allowed, near.unwrap_or_default())
    })
}

/// The base value, as the table has it.
fn base(stored: &Stored<'_>, by: &Column, text: &str) -> Result<Value> {
    let there = compare::values(by, &(0..by.cells.len()).collect::<Vec<_>>());
    let wanted = stored.study.parameter_value(&by.name, text);
    let found = there.iter().find(|value| {
        // A column that holds words and numbers holds the numbers as text.
        value.to_string() == text.trim()
            || wanted.as_ref().is_some_and(|wanted| {
                compare::canonical(value) == compare::canonical(wanted)
                    || value.to_string() == wanted.to_string()
            })
    });
    found.cloned().ok_or_else(|| {
        let unit = if matches!(by.unit.as_str(), "" | "1") { "" } else { &by.unit };
        let values: Vec<String> =
            there.iter().map(|value| format!("{value} {unit}").trim_end().to_owned()).collect();
        let problem = format!("not a value {} has in this study", by.name);
        refused("--base", text, &problem, values.join(", "), String::new())
    })
}

fn measures<'a>(table: &'a Table, names: &[String], format: Format) -> Result<Vec<&'a Column>> {
    let some = |names: &[&str]| -> Vec<&'a Column> {
        names.iter().filter_map(|name| table.column(name)).collect()
    };
    match names {
        [] if format == Format::Table => Ok(some(&SHOWN)),
        [] => Ok(some(
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
    Err(refused("--measures", name, problem, numbers.join(", "), String::new()))
}

/// A share, as 0.01 or "1%".
fn share(text: &str) -> Result<f64> {
    let number = text.trim().parse().ok();
    let number = number.or_else(|| units::parse(text, Dimension::Number).ok());
    number.filter(|number| (0.0..1.0).contains(number)).ok_or_else(|| {
        let allowed = "from 0 to below 1, as 0.01 or 1%".to_owned();
        refused("--tie", text, "not a relative difference", allowed, String::new())
    })
}

impl Question<'_> {
    /// One row a pair. A line has no room for everything; csv and json have.
    fn print_pairs(&self, format: Format, out: &mut dyn Write) -> Result<()> {
        let brief = format == Format::Table;
        let all_done = self.pairs.iter().all(|pair| {
            [pair.base, pair.other].iter().all(|row| self.table.status(*row) == Some(Status::Done))
        });
        let ends: &[&str] = match (brief, all_done) {
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
        columns.extend(ends.iter().flat_map(|end| [format!("base_{end}"), format!("other_{end}")]));
        for measure in &self.measures {
            columns.extend(figures.iter().map(|figure| format!("{}_{figure}", measure.name)));
        }
        let rows: Vec<Vec<Value>> =
            self.pairs.iter().map(|pair| self.row(*pair, ends, brief)).collect();
        print_rows(&columns, &rows, format, out)
    }

    fn row(&self, pair: Pair, ends: &[&str], brief: bool) -> Vec<Value> {
        let cell = |name: &str, row: usize| {
            self.table.column(name).map_or(Value::Null, |column| column.cells[row].clone())
        };
        let parameters = self.sets.matched.iter().chain([&self.by.name]).chain(&self.sets.carried);
        let mut row: Vec<Value> = parameters.map(|name| cell(name, pair.other)).collect();
        for end in ends {
            row.extend([cell(end, pair.base), cell(end, pair.other)]);
        }
        let number = |number: Option<f64>| number.map_or(Value::Null, Value::Number);
        for measure in &self.measures {
            let own = compare::compared(self.table, pair, measure, self.tie);
            row.extend([number(own.base), number(own.other)]);
            if !brief {
                row.push(number(Compared::difference(&own)));
            }
            row.extend([number(own.ratio()), Value::Text(own.better.name().to_owned())]);
        }
        row
    }

    /// One row a value and measure. Outcomes no pair had are left out where people read.
    fn print_tallies(&self, format: Format, out: &mut dyn Write) -> Result<()> {
        const KINDS: [(&str, Better, bool); 8] = [
            ("other_better", Better::Other, true),
            ("base_better", Better::Base, true),
            ("ties", Better::Tie, true),
            ("only_other", Better::OnlyOther, false),
            ("only_base", Better::OnlyBase, false),
            ("neither", Better::Neither, false),
            ("differ", Better::Differ, false),
            ("pending", Better::Pending, false),
        ];
        let tallies =
            compare::tallies(self.table, &self.pairs, &self.by.name, &self.measures, self.tie);
        let kinds: Vec<(&str, Better)> = KINDS
            .into_iter()
            .filter(|(_, kind, always)| {
                *always
                    || format != Format::Table
                    || tallies.iter().any(|tally| tally.count(*kind) > 0)
            })
            .map(|(name, kind, _)| (name, kind))
            .collect();
        let columns: Vec<&str> = [self.by.name.as_str(), "measure", "pairs"]
            .into_iter()
            .chain(kinds.iter().map(|(name, _)| *name))
            .chain(["median_ratio", "least_ratio", "largest_ratio"])
            .collect();
        let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        let row = |tally: &Tally| {
            let mut row = vec![tally.value.clone(), Value::Text(tally.measure.clone())];
            row.push(number(tally.pairs()));
            row.extend(kinds.iter().map(|(_, kind)| number(tally.count(*kind))));
            row.extend(tally.ratio.map_or([const { Value::Null }; 3], |ratio| {
                [ratio.median, ratio.least, ratio.largest].map(Value::Number)
            }));
            row
        };
        let rows: Vec<Vec<Value>> = tallies.iter().map(row).collect();
        print_rows(&columns, &rows, format, out)
    }

    /// What a reader should know beside the rows.
    fn tell(&self, base: &Value, alone: &[usize]) {
        let by = &self.by.name;
        let unit = match base {
            Value::Number(_) if self.by.unit != "1" => format!(" {}", self.by.unit),
            _ => String::new(),
        };
        let mut text = format!("base: {by} = {base}{unit}; ratio: other over base");
        for (word, side) in [("less", BetterSide::Smaller), ("more", BetterSide::Larger)] {
            let list = measures_with(side);
            let own = self.measures.iter().map(|measure| measure.name.as_str());
            let names: Vec<&str> = own.filter(|name| list.contains(name)).collect();
            if !names.is_empty() {
                let _ = write!(text, "; better: {word} {}", names.join(", "));
            }
        }
        eprintln!("{text}");
        for carried in &self.sets.carried {
            eprintln!("note: {carried} changes with {by}, so it is not matched");
        }
        if !alone.is_empty() {
            eprintln!(
                "note: {} without a partner that is equal in all else",
                count(alone.len(), "row")
            );
        }
    }
}
