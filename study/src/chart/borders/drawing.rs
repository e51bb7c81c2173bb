//! The drawing of borders: error bars, columns, arrows, letters, faint points, and their legend.

use std::collections::{BTreeMap, BTreeSet};

use super::vertical::Vertical;
use crate::chart::encoding::Encoding;
use crate::chart::positions::Positions;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Direction, Line, Mark, Panel};
use crate::render::figure::style::{Fill, Series};
use crate::render::figure::unit::Unit;
use crate::study::{Border, Level, Outcome};

/// Distance of lines with equal x, mm.
const SHIFT: f64 = 3.0;
/// Letter of a search whose outcome changes more than once.
const NOT_MONOTONE: &str = "M";
/// Letter of a search whose outcome is decided at no value.
const UNDECIDED: &str = "U";
/// Letter of a search with runs that have not ended.
const OPEN: &str = "P";
/// Letter of a search whose criterion is met at every decided value, where no arrow can be drawn.
const ALL_MET: &str = "A";
/// The same, met at no value.
const NONE_MET: &str = "N";

/// What a search without an interval shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Sign {
    Border,
    /// Met at every decided value; the direction is that of the arrow.
    AllMet(Option<Up>),
    NoneMet(Option<Up>),
    NotMonotone,
    Undecided,
    Open,
}

/// Whether an arrow points upwards.
type Up = bool;

/// The drawing of borders, and how often each sign is used.
pub(super) struct Drawing<'d> {
    axis: &'d Vertical,
    unit: &'d Unit,
    used: BTreeMap<Sign, usize>,
    /// The faint points in use.
    fills: BTreeSet<Fill>,
    /// Whether a search without a border has a value that is not decided.
    partly: bool,
    /// Number of runs of each value.
    replicates: usize,
    pub(super) side: Option<bool>,
}

impl<'d> Drawing<'d> {
    /// Nothing drawn yet; `side` is the side that meets the criterion, below or not, where all borders agree.
    pub(super) fn new(
        axis: &'d Vertical,
        unit: &'d Unit,
        side: Option<bool>,
        replicates: usize,
    ) -> Self {
        let (used, fills) = (BTreeMap::new(), BTreeSet::new());
        Self { axis, unit, used, fills, partly: false, replicates, side }
    }

    /// Adds the lines of a panel.
    pub(super) fn add(
        &mut self,
        panel: &mut Panel,
        rows: &[usize],
        found: &[Option<&Border>],
        encoding: &Encoding<'_>,
        positions: &Positions,
    ) {
        let mut lines: BTreeMap<usize, (Series, Vec<usize>)> = BTreeMap::new();
        for row in rows {
            let (index, series) = encoding.line(*row);
            lines.entry(index).or_insert((series, Vec::new())).1.push(*row);
        }
        let count = lines.len();
        for (number, (series, mut rows)) in lines.into_values().enumerate() {
            rows.sort_by(|a, b| positions.of(*a).total_cmp(&positions.of(*b)));
            let mut line = Line::new(series);
            let place = (number as f64 + 0.5) / count as f64 - 0.5;
            if !positions.names {
                line.shift = SHIFT * count as f64 * place;
            }
            let mut piece = Vec::new();
            for row in rows {
                let Some(border) = found[row] else { continue };
                let x = positions.of(row) + if positions.names { 0.7 * place } else { 0.0 };
                let letter = self.point(&mut line, x, border).map(str::to_owned);
                let x_of_lane = positions.of(row);
                panel.lane.extend(letter.map(|letter| Mark { x: x_of_lane, series, letter }));
                match &border.outcome {
                    Outcome::Border { .. } => piece.extend(line.marks.last().map(|mark| mark.0)),
                    _ => line.pieces.push(std::mem::take(&mut piece)),
                }
            }
            line.pieces.push(piece);
            line.pieces.retain(|piece| piece.len() > 1 && !positions.names);
            panel.lines.push(line);
        }
    }

    /// Adds a search to a line. Returns its letter, if it has neither a border nor an arrow.
    fn point(&mut self, line: &mut Line, x: f64, border: &Border) -> Option<&'static str> {
        for level in border.levels.iter().filter(|level| level.met.of > 0) {
            let fill = fill(level);
            self.fills.insert(fill);
            line.faint.push(([x, self.unit.shown(level.value)], fill));
        }
        let decided = self.decided(border);
        let (sign, letter) = match &border.outcome {
            Outcome::Border { low, high, met_below } => {
                let [low, high] = [*low, *high].map(|value| self.unit.shown(value));
                line.bars.push([x, low, high]);
                line.marks.push(([x, self.axis.middle(low, high)], Fill::Filled));
                // The column ends where the criterion is known to be met.
                let [first, last] = decided.unwrap_or([low, high]);
                let column = if *met_below { [x, first, low] } else { [x, high, last] };
                line.columns.push(column);
                (Sign::Border, None)
            }
            Outcome::NoChange { met } => {
                let arrow = self.arrow(border, *met);
                line.arrows.extend(arrow.map(|(end, up)| ([x, end], direction(up))));
                if let Some([first, last]) = decided.filter(|_| *met) {
                    line.columns.push([x, first, last]);
                }
                self.partly |= border.levels.iter().any(|l| l.outcome(self.replicates).is_none());
                let up = arrow.map(|(_, up)| up);
                let letter = if *met { ALL_MET } else { NONE_MET };
                let sign = if *met { Sign::AllMet(up) } else { Sign::NoneMet(up) };
                (sign, up.is_none().then_some(letter))
            }
            Outcome::NotMonotone(intervals) => {
                let bars = intervals.iter().map(|ends| ends.map(|value| self.unit.shown(value)));
                line.bars.extend(bars.map(|[low, high]| [x, low, high]));
                (Sign::NotMonotone, Some(NOT_MONOTONE))
            }
            Outcome::Undecided => (Sign::Undecided, Some(UNDECIDED)),
            Outcome::Open => (Sign::Open, Some(OPEN)),
        };
        *self.used.entry(sign).or_default() += 1;
        letter
    }

    /// The first and the last value at which the outcome is decided, in the unit of the axis.
    fn decided(&self, border: &Border) -> Option<[f64; 2]> {
        let decided = |level: &&Level| level.outcome(self.replicates).is_some();
        let mut levels = border.levels.iter().filter(decided);
        let first = levels.next()?;
        let last = levels.next_back().unwrap_or(first);
        Some([first, last].map(|level| self.unit.shown(level.value)))
    }

    /// The arrow of a search with one outcome: the border lies beyond the end at which the criterion changes.
    /// `None` unless other borders show that side, and the outcome is decided at this end.
    fn arrow(&self, border: &Border, met: bool) -> Option<(f64, Up)> {
        let up = met == self.side?;
        let end = if up { border.levels.last() } else { border.levels.first() }?;
        end.outcome(self.replicates).map(|_| (self.unit.shown(end.value), up))
    }

    /// The legend of the signs in use.
    pub(super) fn legend(&self, criterion: &str) -> Legend {
        let value = if self.partly { "decided value" } else { "value searched" };
        let one = |up: &Option<Up>, letter: &str, text: String| {
            let letter = || Sample::Letter(letter.to_owned());
            let text = match up {
                Some(_) => format!("{text}: a border, if any, lies beyond"),
                None => text,
            };
            (up.map_or_else(letter, |up| Sample::Arrow(direction(up))), text)
        };
        let entry = |(sign, count): (&Sign, &usize)| {
            let (sample, text) = match sign {
                Sign::Border => (Sample::Bar, "interval of the border".to_owned()),
                Sign::AllMet(up) => one(up, ALL_MET, format!("{criterion} at every {value}")),
                Sign::NoneMet(up) => one(up, NONE_MET, format!("{criterion} at no {value}")),
                Sign::NotMonotone => (
                    Sample::Letter(NOT_MONOTONE.to_owned()),
                    "not monotone: changes more than once".to_owned(),
                ),
                Sign::Undecided => (
                    Sample::Letter(UNDECIDED.to_owned()),
                    "undecided at every value searched".to_owned(),
                ),
                Sign::Open => {
                    (Sample::Letter(OPEN.to_owned()), "pending: runs have not ended".to_owned())
                }
            };
            (sample, format!("{text} ({count})"))
        };
        let mut entries: Vec<(Sample, String)> = self.used.iter().map(entry).collect();
        let side = match self.side {
            Some(true) => "up to the border",
            Some(false) => "from the border on",
            None => "here",
        };
        let runs = |some: &str, meet: &str| {
            let meet = if is_word(criterion) { String::new() } else { format!("{meet} ") };
            format!("value searched: {some} {meet}{criterion}")
        };
        let values = [
            (Sample::Area, format!("{criterion} {side}")),
            (Sample::Faint(Fill::Filled), runs("each run", "meets")),
            (Sample::Faint(Fill::Half), runs("some runs", "meet")),
            (Sample::Faint(Fill::Open), runs("no run", "meets")),
            (Sample::End, "ends of the search".to_owned()),
        ];
        let columns = self.used.keys().any(|sign| matches!(sign, Sign::Border | Sign::AllMet(_)));
        let used = |sample: &Sample| match sample {
            Sample::Area => columns,
            Sample::Faint(fill) => self.fills.contains(fill),
            _ => true,
        };
        entries.extend(values.into_iter().filter(|(sample, _)| used(sample)));
        Legend { heading: "Search (number of searches)".to_owned(), entries }
    }
}

/// Whether a criterion is a word that says what a run is, as `safe`, rather than a limit.
pub(super) fn is_word(criterion: &str) -> bool {
    !criterion.contains(' ')
}

fn direction(up: Up) -> Direction {
    if up { Direction::Up } else { Direction::Down }
}

/// The faint point of a level.
fn fill(level: &Level) -> Fill {
    if level.met.is_mixed() {
        Fill::Half
    } else if level.met.met > 0 {
        Fill::Filled
    } else {
        Fill::Open
    }
}
