//! Maps over two parameters: a measure, or the proportion of runs that are safe or deployed. One cell per point, one
//! panel per combination of the other parameters.

use billow_solver::output::measures::Verdict;

use super::limits::Bound;
use super::names::{self, Name};
use super::outcome::{self, Outcomes};
use super::parameters::{self, Parameter};
use super::{Source, invalid_option};
use crate::job::proportion::Proportion;
use crate::job::result_limit::Safety;
use crate::job::row::ColumnId;
use crate::platform::error::Result;
use crate::render::figure::Sheet;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::map::{Cell, Ground, Maps, Panel};
use crate::render::figure::style::Sign;
use crate::render::figure::unit::Unit;
use crate::store::table::Column;

/// Most panels in one figure. Chosen: more do not fit on a page.
const MAX_PANELS: usize = 18;
/// Most values along an axis. Chosen: the numbers in narrower cells are not legible.
pub const MAX_VALUES: usize = 16;
/// Sign after a proportion that does not count every run.
const NOT_ALL: &str = "*";

/// The runs that a map of outcomes counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judged {
    /// Runs that meet every limit.
    Safe,
    /// Runs that deployed.
    Deployed,
}

impl Judged {
    /// That of a column of the table: `safe` or `verdict`.
    pub fn of_name(name: &str) -> Option<Self> {
        [Self::Safe, Self::Deployed].into_iter().find(|judged| judged.name() == name)
    }

    /// Name of its column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Safe => "safe",
            Self::Deployed => ColumnId::Verdict.name(),
        }
    }

    /// What a study is judged by: its limits, else the verdict.
    pub fn of(source: &Source<'_>) -> Self {
        if source.limits.is_empty() { Self::Deployed } else { Self::Safe }
    }

    /// Adjective of a run that is counted, and its meaning.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::Safe => ["safe", "safe: every limit is met for certain"],
            Self::Deployed => ["deployed", "deployed: the verdict"],
        }
    }

    /// The proportion as a colour: a run within its uncertainty is halfway between a safe and an unsafe one.
    pub(super) fn value(self, source: &Source<'_>, row: usize, counted: Proportion) -> f64 {
        let not_safe = match (self, source.runs_of(row)) {
            (Self::Deployed, _) => counted.of - counted.met,
            (Self::Safe, Some(runs)) => runs.not_safe,
            (Self::Safe, None) => usize::from(source.table.safety(row) == Some(Safety::Unsafe)),
        };
        0.5 * (1.0 + (counted.met as f64 - not_safe as f64) / counted.of as f64)
    }

    /// How many runs of a row can be judged, and how many of these are counted.
    pub fn proportion(self, source: &Source<'_>, row: usize) -> Proportion {
        if let Some(runs) = source.runs_of(row) {
            return if self == Self::Safe { runs.safe } else { runs.deployed };
        }
        Proportion::count(match self {
            Self::Safe => source.table.safety(row).map(|safety| safety == Safety::Safe),
            Self::Deployed => {
                outcome::verdict(source, row).map(|verdict| verdict == Verdict::Deployed)
            }
        })
    }
}

/// What the cells show.
enum Quantity<'a> {
    /// A measure in a unit, and its limit.
    Measure(&'a Column, Unit, Option<Bound>),
    /// A proportion of runs.
    Proportion(Judged),
}

/// Draws a measure over the parameters `axes[0]` (to the right) and `axes[1]` (upwards); `safe` and `verdict` are
/// proportions of runs. A searched parameter has the values that every search has.
///
/// # Errors
/// Unknown names, a measure that is not a number, `safe` of a study without limits, one parameter on both axes, too many
/// panels or cells.
pub fn svg(source: &Source<'_>, measure: &str, axes: [&str; 2]) -> Result<String> {
    let common = source.common_values(&axes);
    let source = common.as_ref().unwrap_or(source);
    let quantity = Quantity::of(source, measure)?;
    let asked = axes.join(",");
    let refused = |problem: String, allowed: String, hint: String| {
        Err(invalid_option("--map", &asked, problem, allowed, hint))
    };
    if axes[0] == axes[1] {
        let allowed = "two different parameters: X,Y".to_owned();
        return refused("one parameter on both axes".to_owned(), allowed, String::new());
    }
    let [x, y] = [source.parameter("--map", axes[0])?, source.parameter("--map", axes[1])?];
    let (others, mut notes) = parameters::varying(source.table, &source.rows, &[x, y]);
    let facets = parameters::facets(others, &source.rows);
    if facets.panels.len() > MAX_PANELS {
        let problem = format!("the map needs {} panels; nothing is averaged", facets.panels.len());
        let fix = parameters::fix(facets.parameters.iter());
        return refused(problem, format!("{MAX_PANELS} panels at most"), fix);
    }
    let [x, y] = [x, y].map(|column| Parameter::new(column, &source.rows));
    let [right, up] = [&x, &y].map(|parameter| parameter.values(&source.rows));
    for (parameter, values) in [(&x, &right), (&y, &up)] {
        if values.len() > MAX_VALUES {
            let problem = format!("{} values along one axis", values.len());
            let allowed = format!("{MAX_VALUES} values at most");
            let hint = "choose some with --where CONDITION, or draw it with --over";
            return Err(invalid_option("--map", parameter.name(), problem, allowed, hint));
        }
    }
    let mut cells = Cells::new(source, &quantity);
    let mut panels = Vec::with_capacity(facets.panels.len());
    for (title, rows) in &facets.panels {
        let mut of_panel = Vec::with_capacity(right.len() * up.len());
        for (up, right) in up.iter().flat_map(|up| right.iter().map(move |right| (up, right))) {
            let at = |row: &usize| x.column.cells[*row] == *right && y.column.cells[*row] == *up;
            let here: Vec<usize> = rows.iter().copied().filter(at).collect();
            of_panel.push(match here.as_slice() {
                [] => Cell::default(),
                [row] => cells.cell(*row),
                several => {
                    let problem = format!("{} points of the study share one cell", several.len());
                    let hint = "choose some with --where CONDITION".to_owned();
                    return refused(problem, "one point per cell".to_owned(), hint);
                }
            });
        }
        panels.push(Panel { title: names::capital(title), cells: of_panel });
    }
    let legend = cells.legend(&panels);
    notes.splice(0..0, cells.notes());
    let (plain, scale) = quantity.scale(source);
    let title = format!("{plain} over {} and {}", x.plain().plain, y.plain().plain);
    let maps = Maps {
        sheet: Sheet {
            title: source.title_or(&title),
            subtitle: source.subtitle(),
            legends: vec![legend],
            notes,
        },
        x: x.along(&right, &source.rows),
        y: y.along(&up, &source.rows),
        scale,
        panels,
    };
    Ok(maps.svg())
}

impl<'a> Quantity<'a> {
    fn of(source: &Source<'a>, measure: &str) -> Result<Self> {
        let Some(judged) = Judged::of_name(measure) else {
            let column = source.measure("--measure", measure)?;
            let values = source.rows.iter().filter_map(|row| outcome::value(source, column, *row));
            let unit = parameters::shown_unit(column, values);
            return Ok(Self::Measure(column, unit, source.bound(column)));
        };
        if judged == Judged::Safe && source.limits.is_empty() {
            let problem = "the study has no limits, so no run is safe or not";
            let hint = "give the study \"limits\", as in {\"peak_vz\": \"< 25 m/s\"}";
            return Err(invalid_option("--measure", measure, problem, "verdict", hint));
        }
        Ok(Self::Proportion(judged))
    }

    /// Its plain name; label and ends of its scale, unless no row has a value.
    fn scale(&self, source: &Source<'_>) -> (String, Option<(String, [f64; 2])>) {
        match self {
            Self::Measure(column, unit, _) => {
                let name = Name::of_quantity(&column.name, &column.meaning);
                let values = source.rows.iter();
                let values = values.filter_map(|row| outcome::value(source, column, *row));
                let range = values.map(|value| [unit.shown(value); 2]);
                let range =
                    range.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)]);
                (name.plain.clone(), range.map(|range| (name.label(unit), range)))
            }
            Self::Proportion(judged) => {
                let name = format!("proportion of {} runs", judged.words()[0]);
                let half = if *judged == Judged::Safe { ", uncertain ones one half" } else { "" };
                (name.clone(), Some((format!("{}{half}", names::capital(&name)), [0.0, 1.0])))
            }
        }
    }
}

/// The cells of a map, and what their legend and notes say.
struct Cells<'s, 'a> {
    source: &'s Source<'a>,
    quantity: &'s Quantity<'a>,
    outcomes: Outcomes<'s>,
    /// Number of points that miss each limit, where several limits have a letter each.
    missed: Vec<usize>,
    /// Whether a point has several runs, and whether one of them is not counted.
    several: bool,
    not_all: bool,
}

impl<'s, 'a> Cells<'s, 'a> {
    fn new(source: &'s Source<'a>, quantity: &'s Quantity<'a>) -> Self {
        let lettered = matches!(quantity, Quantity::Proportion(Judged::Safe));
        let missed = if lettered && source.limits.len() > 1 { source.limits.len() } else { 0 };
        Self {
            source,
            quantity,
            outcomes: Outcomes::new(source),
            missed: vec![0; missed],
            several: false,
            not_all: false,
        }
    }

    fn cell(&mut self, row: usize) -> Cell {
        let source = self.source;
        match self.quantity {
            Quantity::Measure(column, unit, bound) => {
                let Some(value) = outcome::value(source, column, row) else {
                    return Cell::letter(self.outcomes.letter(row));
                };
                Cell {
                    below: outcome::mixed_text(source, row),
                    framed: bound.as_ref().is_some_and(|bound| bound.is_missed(source, row, value)),
                    ..Cell::of(unit.shown(value), Sign::Circle(self.outcomes.mark(row)))
                }
            }
            Quantity::Proportion(judged) => {
                let proportion = judged.proportion(source, row);
                if proportion.of == 0 {
                    return Cell::letter(self.outcomes.letter(row));
                }
                Cell {
                    ground: Ground::Value(judged.value(source, row, proportion)),
                    sign: Some(Sign::Circle(self.outcomes.mark(row))),
                    text: self.text(*judged, row, proportion),
                    below: self.letters(row),
                    ..Cell::default()
                }
            }
        }
    }

    /// The text of a proportion: k/n of several runs; of one run what it is.
    fn text(&mut self, judged: Judged, row: usize, proportion: Proportion) -> String {
        let runs = self.source.single_rows(row).len().max(1);
        self.several |= runs > 1;
        self.not_all |= proportion.of < runs;
        if runs > 1 {
            let sign = if proportion.of < runs { NOT_ALL } else { "" };
            return format!("{}/{}{sign}", proportion.met, proportion.of);
        }
        let text = match (judged, proportion.met) {
            (Judged::Safe, _) => self.source.table.safety(row).map_or("", Safety::name),
            (Judged::Deployed, _) => outcome::verdict(self.source, row).map_or("", Verdict::name),
        };
        text.to_owned()
    }

    /// The letters of the limits that a run of a row misses.
    fn letters(&mut self, row: usize) -> String {
        let mut letters = Vec::new();
        for ((letter, count), limit) in ('a'..='z').zip(&mut self.missed).zip(self.source.limits) {
            if self.source.misses(limit, row) {
                *count += 1;
                letters.push(letter.to_string());
            }
        }
        letters.join(" ")
    }

    fn legend(&self, panels: &[Panel]) -> Legend {
        let mut legend = self.outcomes.legend(true);
        for ((letter, count), limit) in ('a'..='z').zip(&self.missed).zip(self.source.limits) {
            let misses = if limit.measure == ColumnId::Verdict { "not" } else { "misses" };
            let text = format!("{misses} {limit} ({count})");
            legend.entries.push((Sample::Letter(letter.to_string()), text));
        }
        let cells = || panels.iter().flat_map(|panel| &panel.cells);
        if let Quantity::Measure(_, _, Some(bound)) = self.quantity
            && cells().any(|cell| cell.framed)
        {
            let framed = Cell { framed: true, ..Cell::default() };
            legend.entries.push((Sample::Cell(framed), bound.text()));
        }
        if cells().any(|cell| cell.ground == Ground::Absent) {
            let text = "no such point in the study".to_owned();
            legend.entries.push((Sample::Cell(Cell::default()), text));
        }
        legend
    }

    fn notes(&self) -> Vec<String> {
        let source = self.source;
        let mut notes = Vec::new();
        match self.quantity {
            Quantity::Measure(column, ..) => {
                if source.rows.iter().all(|row| outcome::value(source, column, *row).is_none()) {
                    notes.push(format!("No job here has a value of {}.", column.name));
                }
                if source.has_replicates() {
                    notes.push("Numbers are medians of the runs of a point.".to_owned());
                }
                notes.extend(source.runs_notes(Some(column)));
            }
            Quantity::Proportion(judged) => {
                let [word, meaning] = judged.words();
                let runs = if self.several { "k/n: k of n runs are " } else { "" };
                let word = if self.several { format!("{word}; ") } else { String::new() };
                notes.push(format!("{runs}{word}{meaning}."));
                if *judged == Judged::Safe && self.missed.is_empty() {
                    notes.extend(source.limits.iter().map(|limit| format!("Limit: {limit}.")));
                }
                if self.not_all {
                    let text =
                        "a run failed, is infeasible or has not ended; it is not counted in k/n";
                    notes.push(format!("{NOT_ALL}: {text}."));
                }
                notes.extend(source.meshes_note(None));
            }
        }
        notes
    }
}
