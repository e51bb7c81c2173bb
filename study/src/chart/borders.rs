//! The borders that a search found, over another parameter.
//!
//! A border is the interval between the last value at which the criterion is met and the first at which it is
//! not. Its middle is a marker, the interval an error bar; the side that meets the criterion is shaded.

use std::collections::BTreeMap;

use super::encoding::{Encoding, PREFERRED_LINES};
use super::names::{self, capital};
use super::parameters::{self, Parameter};
use super::positions::Positions;
use super::tornado::OneFactor;
use super::{Source, invalid_option, number};
use crate::analysis::compare::canonical;
use crate::analysis::replicates::Condensed;
use crate::input::value::{Value, brief_number};
use crate::job::row::CellType;
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Direction, Line, Mark, Panel, Plots, Rule};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::Fill;
use crate::render::figure::unit::Unit;
use crate::render::figure::{Sheet, columns};
use crate::store::table::Column;
use crate::study::{Border, Level, SearchResult};

/// Distance of lines with equal x, mm.
const SHIFT: f64 = 3.0;
/// Space at both ends of the vertical axis, as a fraction of its length: arrows stand there.
const PADDING: f64 = 0.12;
/// The criterion of all limits.
const SAFE: &str = "safe";
/// Fewest parameters that vary in searches that change one factor at a time. Two are an axis and its lines.
const MIN_FACTORS: usize = 3;

/// The search of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Searched<'a> {
    /// The parameter along which it searches.
    pub parameter: &'a str,
    /// What changes at a border: "safe", "deployed", or a limit as `peak_vz < 25 m/s`.
    pub criterion: &'a str,
    /// The parameters whose values repeat a point.
    pub replicates: &'a [String],
    /// Number of runs of each value.
    pub replicate_count: usize,
    /// What it found.
    pub borders: &'a [Border],
}

/// Draws the borders over a parameter; without one over the first parameter with numbers that varies.
///
/// # Errors
/// A study without a search, an unknown parameter, too many lines or panels.
pub fn svg(source: &Source<'_>, over: Option<&str>, by: &[String]) -> Result<String> {
    let search = source.search.ok_or_else(|| {
        let problem = "the study has no search";
        let hint = "give an axis {\"bisect\": [low, high], \"on\": \"verdict\"}";
        invalid_option("--borders", "", problem, "a study with a search", hint)
    })?;
    if over == Some(search.parameter) {
        let problem = "is the parameter along which the study searches";
        return Err(invalid_option("--over", search.parameter, problem, "another parameter", ""));
    }
    // One row per search.
    let single = source.single();
    let mut free = search.replicates.to_vec();
    free.push(search.parameter.to_owned());
    let condensed = Condensed::of(single.table, &single.rows, &free);
    let table = &condensed.table;
    let rows: Vec<usize> = (0..table.rows()).collect();
    let points = Source { table, rows, runs: None, ..single.clone() };
    let found = of_rows(&points, search.borders);

    let none = Column::plain("", CellType::Text, vec![Value::Text(String::new()); table.rows()]);
    let (varying, _) = parameters::varying(table, &points.rows, &[]);
    let one_factor = match over {
        None if by.is_empty() => one_factor(&points),
        _ => None,
    };
    let first = varying.iter().find(|parameter| parameter.is_number(&points.rows));
    let x = match (over, &one_factor) {
        (Some(name), _) => points.parameter("--over", name)?,
        (None, Some((names, _))) => names,
        (None, None) => first.or(varying.first()).map_or(&none, |parameter| parameter.column),
    };
    let x = Parameter::new(x, &points.rows);
    let (others, notes) = match one_factor {
        Some(_) => (Vec::new(), Vec::new()),
        None => parameters::varying(table, &points.rows, &[x.column]),
    };
    let others = parameters::strategy_first(others);
    let positions = Positions::new(&x, &points.rows);
    let asked = ("--borders", search.parameter);
    let encoding = Encoding::new(&points, &others, by, PREFERRED_LINES, positions.names, asked)?;
    let mut drawing =
        Drawing::new(source.parameter("--borders", search.parameter)?, search, &found);
    let panels = encoding.panels.panels.iter();
    let mut panels: Vec<Panel> = panels
        .map(|(title, rows)| drawing.panel(title, rows, &found, &encoding, &positions))
        .collect();
    let mut axis = positions.axis();
    if let ([panel], true) = (&mut panels[..], varying.is_empty()) {
        axis = drawing.number_line(panel);
    }
    let mut legends = encoding.legends(axis.names);
    legends.push(drawing.legend());
    let mut subtitle = points.subtitle();
    let count = |count: usize, one: &str, many: &str| {
        format!("{count} {}", if count == 1 { one } else { many })
    };
    if let Some(first) = subtitle.first_mut() {
        let searches = count(points.rows.len(), "search", "searches");
        let runs = count(single.rows.len(), "run", "runs");
        *first = format!("study {}: {searches}, {runs} {}", points.study, points.choice);
        *first = first.trim_end().to_owned();
    }
    if search.criterion == SAFE && !single.limits.is_empty() {
        let limits: Vec<String> = single.limits.iter().map(ToString::to_string).collect();
        subtitle.push(format!("Safe: {}", limits.join(", ")));
    }
    subtitle.extend(one_factor.iter().map(|(_, base)| base.clone()));
    let over = if x.name().is_empty() { "" } else { " over " };
    let title = format!("{}{over}{}", drawing.title(), x.plain().plain);
    let sheet = Sheet { title: source.title_or(&title), subtitle, legends, notes };
    Ok(Plots { sheet, x: axis, across: columns(panels.len()), panels }.svg())
}

/// The border of each row: the search whose parameters it has.
fn of_rows<'b>(points: &Source<'_>, borders: &'b [Border]) -> Vec<Option<&'b Border>> {
    let of = |border: &'b Border, column: &Column| {
        border.parameters.iter().find(|(name, _)| *name == column.name).map(|(_, value)| value)
    };
    let columns: Vec<&Column> = points.table.parameters().collect();
    let columns: Vec<&Column> = columns
        .into_iter()
        .filter(|column| borders.first().is_some_and(|border| of(border, column).is_some()))
        .collect();
    // A column of texts stores numbers as text.
    let key = |column: &Column, value: &Value| match (column.cell_type, value) {
        (CellType::Text, value) if *value != Value::Null => value.to_string(),
        _ => canonical(value),
    };
    let mut known: BTreeMap<Vec<String>, &Border> = BTreeMap::new();
    for border in borders {
        let value =
            |column: &&Column| of(border, column).map_or_else(String::new, |v| key(column, v));
        known.entry(columns.iter().map(value).collect()).or_insert(border);
    }
    let of_row = |row: &usize| {
        let key = columns.iter().map(|column| key(column, &column.cells[*row]));
        known.get(&key.collect::<Vec<String>>()).copied()
    };
    points.rows.iter().map(of_row).collect()
}

/// Searches that change one factor at a time stand side by side under their names: the names as a parameter, and the
/// base in words.
fn one_factor(points: &Source<'_>) -> Option<(Column, String)> {
    let one = OneFactor::of(points, MIN_FACTORS)?;
    let name = |row| match one.of_rows.get(&row)? {
        None => Some(Value::Text("base".to_owned())),
        Some(factor) => Some(Value::Text(one.factors[*factor].named(row))),
    };
    let cells = (0..points.table.rows()).map(|row| name(row).unwrap_or(Value::Null));
    Some((Column::plain("", CellType::Text, cells.collect()), one.base_text()))
}

/// The drawing of borders, and what its legend says.
struct Drawing<'d> {
    search: Searched<'d>,
    unit: Unit,
    spread: Spread,
    /// Ends of the search.
    ends: [f64; 2],
    /// The side that meets the criterion, below or not, where all borders agree.
    side: Option<bool>,
    /// Samples and texts in their order, and how often each is used.
    entries: BTreeMap<(u8, String), (Sample, usize)>,
}

impl<'d> Drawing<'d> {
    fn new(column: &Column, search: Searched<'d>, found: &[Option<&Border>]) -> Self {
        let levels = || found.iter().flatten().flat_map(|border| &border.levels);
        let unit = parameters::shown_unit(column, levels().map(|level| level.value));
        let ends = levels().map(|level| [unit.shown(level.value); 2]);
        let ends = ends.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)]);
        let ends = ends.filter(|[low, high]| low < high).unwrap_or([0.0, 1.0]);
        let of_first = found.iter().flatten().next().map_or(&[][..], |border| &border.levels);
        let logarithmic = is_logarithmic(of_first) && ends[0] > 0.0;
        let spread = if logarithmic { Spread::Logarithmic } else { Spread::Linear };
        let mut sides = found.iter().flatten().filter_map(|border| match border.outcome {
            SearchResult::Border { met_below, .. } => Some(met_below),
            _ => None,
        });
        let side = sides.next().filter(|first| sides.all(|side| side == *first));
        Self { search, unit, spread, ends, side, entries: BTreeMap::new() }
    }

    /// What the borders are: "largest safe mass flow rate".
    fn title(&self) -> String {
        let name = names::Name::of_parameter(self.search.parameter).plain;
        let criterion = self.search.criterion;
        let most = match self.side {
            Some(true) => "largest",
            Some(false) => "smallest",
            None if is_word(criterion) => {
                return format!("{name} at the border between {criterion} and not {criterion}");
            }
            None => return format!("{name} at the border of {criterion}"),
        };
        match criterion {
            SAFE => format!("{most} safe {name}"),
            "deployed" => format!("{most} {name} that deploys"),
            limit => format!("{most} {name} with {limit}"),
        }
    }

    /// The panel of some searches.
    fn panel(
        &mut self,
        title: &str,
        rows: &[usize],
        found: &[Option<&Border>],
        encoding: &Encoding<'_>,
        positions: &Positions,
    ) -> Panel {
        let name = names::Name::of_parameter(self.search.parameter);
        let [low, high] = self.ends;
        let range = match self.spread {
            Spread::Linear => {
                let padding = PADDING * (high - low);
                [low - padding, high + padding]
            }
            Spread::Logarithmic => {
                let padding = libm::pow(high / low, PADDING);
                [low / padding, high * padding]
            }
        };
        let end = |value: f64| Rule { value, text: String::new(), closed: None };
        let mut panel = Panel {
            title: capital(title),
            label: self.unit.label(&capital(&name.with_symbol())),
            range,
            spread: self.spread,
            rules: self.ends.map(end).to_vec(),
            ..Panel::default()
        };
        let lines = encoding.rows_by_line(rows);
        let count = lines.len() as f64;
        for (number, (series, mut rows)) in lines.into_values().enumerate() {
            rows.sort_by(|a, b| positions.of(*a).total_cmp(&positions.of(*b)));
            let mut line = Line::new(series);
            // Lines stand side by side.
            let place = (number as f64 + 0.5) / count - 0.5;
            line.shift = if positions.names { 0.0 } else { SHIFT * count * place };
            let mut piece = Vec::new();
            for row in rows {
                let Some(border) = found[row] else { continue };
                let x = positions.of(row) + if positions.names { 0.7 * place } else { 0.0 };
                if let Some(letter) = self.point(&mut line, x, border) {
                    panel.lane.push(Mark { x: positions.of(row), series, letter });
                }
                match &border.outcome {
                    SearchResult::Border { .. } => {
                        piece.extend(line.marks.last().map(|mark| mark.0));
                    }
                    _ => line.pieces.push(std::mem::take(&mut piece)),
                }
            }
            line.pieces.push(piece);
            line.pieces.retain(|piece| piece.len() > 1 && !positions.names);
            panel.lines.push(line);
        }
        if rows.iter().all(|row| found[*row].is_none()) {
            "nothing to draw: no search is chosen".clone_into(&mut panel.message);
            panel.rules.clear();
        }
        panel
    }

    /// Makes the panel of a single search a number line. Returns its axis.
    fn number_line(&self, panel: &mut Panel) -> Axis {
        let axis = Axis {
            label: std::mem::take(&mut panel.label),
            spread: std::mem::take(&mut panel.spread),
            range: std::mem::replace(&mut panel.range, [-0.5, 0.5]),
            ticks: Vec::new(),
            names: false,
        };
        panel.names = vec![(0.0, String::new())];
        for line in &mut panel.lines {
            let text = |[_, low, high]: &[f64; 3]| {
                let [low, high] = [*low, *high].map(brief_number);
                format!("{low} to {}", self.unit.after(&high))
            };
            line.texts
                .extend(line.bars.iter().zip(&line.marks).map(|(bar, mark)| (mark.0, text(bar))));
            let end = [0.0, self.ends[0]];
            line.texts.extend(panel.lane.drain(..).map(|mark| (end, mark.letter)));
        }
        axis
    }

    /// Adds a search to a line. Returns its letter, if it has neither a border nor an arrow.
    fn point(&mut self, line: &mut Line, x: f64, border: &Border) -> Option<String> {
        let criterion = self.search.criterion;
        for level in border.levels.iter().filter(|level| level.met.of > 0) {
            let (order, fill, some, meet) = match (level.met.met, level.uncertain) {
                (0, 0) => (12, Fill::Open, "no run", "meets "),
                (met, _) if met == level.met.of => (10, Fill::Filled, "each run", "meets "),
                (_, 0) => (11, Fill::Half, "some runs", "meet "),
                _ => (11, Fill::Half, "some runs perhaps", "meet "),
            };
            line.faint.push(([x, self.unit.shown(level.value)], fill));
            let meet = if is_word(criterion) { "" } else { meet };
            self.enter(
                order,
                Sample::Faint(fill),
                format!("value searched: {some} {meet}{criterion}"),
            );
        }
        let decided = self.decided(border);
        let letter = |letter: &str| Sample::Letter(letter.to_owned());
        let (order, sample, text) = match &border.outcome {
            SearchResult::Border { low, high, met_below } => {
                let [low, high] = [*low, *high].map(|value| self.unit.shown(value));
                line.bars.push([x, low, high]);
                let middle = match self.spread {
                    Spread::Logarithmic if low > 0.0 => libm::sqrt(low) * libm::sqrt(high),
                    _ => 0.5 * (low + high),
                };
                line.marks.push(([x, middle], Fill::Filled));
                // The column ends where the criterion is known to be met.
                let [first, last] = decided.unwrap_or([low, high]);
                self.column(line, if *met_below { [x, first, low] } else { [x, high, last] });
                (0, Sample::Bar, "interval of the border".to_owned())
            }
            SearchResult::NoChange { met } => {
                if let Some([first, last]) = decided.filter(|_| *met) {
                    self.column(line, [x, first, last]);
                }
                let (order, sign, every) = if *met { (1, "A", "every") } else { (2, "N", "no") };
                let text = format!("{criterion} at {every} value that is decided");
                match self.arrow(border, *met) {
                    Some((end, direction)) => {
                        line.arrows.push(([x, end], direction));
                        let text = format!("{text}: a border, if any, lies beyond");
                        (order, Sample::Arrow(direction), text)
                    }
                    None => (order, letter(sign), text),
                }
            }
            SearchResult::NotMonotone(intervals) => {
                let bars = intervals.iter().map(|ends| ends.map(|value| self.unit.shown(value)));
                line.bars.extend(bars.map(|[low, high]| [x, low, high]));
                (3, letter("M"), "not monotone: changes more than once".to_owned())
            }
            SearchResult::Undecided => {
                (4, letter("U"), "undecided at every value searched".to_owned())
            }
            SearchResult::Open => (5, letter("P"), "pending: runs have not ended".to_owned()),
        };
        let sign = match &sample {
            Sample::Letter(letter) => Some(letter.clone()),
            _ => None,
        };
        self.enter(order, sample, text);
        sign
    }

    fn column(&mut self, line: &mut Line, column: [f64; 3]) {
        line.columns.push(column);
        let side = match self.side {
            Some(true) => "up to the border",
            Some(false) => "from the border on",
            None => "here",
        };
        self.enter(9, Sample::Area, format!("{} {side}", self.search.criterion));
    }

    fn enter(&mut self, order: u8, sample: Sample, text: String) {
        self.entries.entry((order, text)).or_insert((sample, 0)).1 += 1;
    }

    /// The first and the last value at which the outcome is decided, in the unit of the axis.
    fn decided(&self, border: &Border) -> Option<[f64; 2]> {
        let decided = |level: &&Level| level.outcome(self.search.replicate_count).is_some();
        let mut levels = border.levels.iter().filter(decided);
        let first = levels.next()?;
        let last = levels.next_back().unwrap_or(first);
        Some([first, last].map(|level| self.unit.shown(level.value)))
    }

    /// The arrow of a search with one outcome: the border lies beyond the end at which the criterion changes.
    /// `None` unless other borders show that side, and the outcome is decided at this end.
    fn arrow(&self, border: &Border, met: bool) -> Option<(f64, Direction)> {
        let up = met == self.side?;
        let end = if up { border.levels.last() } else { border.levels.first() }?;
        let direction = if up { Direction::Up } else { Direction::Down };
        end.outcome(self.search.replicate_count).map(|_| (self.unit.shown(end.value), direction))
    }

    fn legend(&self) -> Legend {
        let entry = |((order, text), (sample, count)): (&(u8, String), &(Sample, usize))| {
            let text = if *order < 9 { format!("{text} ({count})") } else { text.clone() };
            (sample.clone(), text)
        };
        let mut entries: Vec<(Sample, String)> = self.entries.iter().map(entry).collect();
        entries.push((Sample::End, "ends of the search".to_owned()));
        Legend { heading: "Search (number of searches)".to_owned(), entries }
    }
}

/// Whether a criterion is a word that says what a run is, as `safe`, rather than a limit.
fn is_word(criterion: &str) -> bool {
    !criterion.contains(' ')
}

/// Whether the levels of a search are spaced evenly in their logarithm: the geometric mean of its ends is a
/// level rather than the arithmetic mean.
fn is_logarithmic(levels: &[Level]) -> bool {
    let (Some(first), Some(last)) = (levels.first(), levels.last()) else { return false };
    let (low, high) = (first.value, last.value);
    let distance = |mean: f64| {
        let gaps = levels.iter().map(|level| (level.value - mean).abs() / mean);
        gaps.fold(f64::INFINITY, f64::min)
    };
    low > 0.0 && distance(libm::sqrt(low * high)) < distance(0.5 * (low + high))
}

impl Source<'_> {
    /// The rows at the values that every search has, where one of these parameters is the searched one; `None`
    /// where these are all rows. Near its border a search has values of its own.
    pub(super) fn common_values(&self, axes: &[&str]) -> Option<Self> {
        let search = self.search.filter(|search| axes.contains(&search.parameter))?;
        let column = self.table.parameters().find(|column| column.name == search.parameter)?;
        let key = |value: f64| (value + 0.0).to_bits();
        let mut searches: BTreeMap<u64, usize> = BTreeMap::new();
        for level in search.borders.iter().flat_map(|border| &border.levels) {
            *searches.entry(key(level.value)).or_default() += 1;
        }
        let is_common = |row: &usize| {
            let value = match &column.cells[*row] {
                // A column of texts stores numbers as text.
                Value::Text(text) => text.parse().ok(),
                cell => number(cell),
            };
            value.and_then(|value| searches.get(&key(value))) == Some(&search.borders.len())
        };
        let rows: Vec<usize> = self.rows.iter().copied().filter(is_common).collect();
        if rows.is_empty() || rows.len() == self.rows.len() {
            return None;
        }
        let parameter = Parameter::new(column, &self.rows);
        let [common, all] = [&rows, &self.rows].map(|rows| parameter.values(rows).len());
        let name = parameter.plain().plain;
        let choice = &self.choice;
        let choice =
            format!("{choice} at the {common} of {all} values of {name} that every search has");
        Some(Self { rows, choice: choice.trim().to_owned(), ..self.clone() })
    }
}
