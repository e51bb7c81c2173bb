//! The runs behind the points of a chart, where replicates repeat a point: median, range, k of n.

use super::{Source, names};
use crate::accuracy::{MeshErrors, NO_ERROR_REASON, together};
use crate::analysis::compare::{columns_of_assumed, columns_of_error, error_at, measured};
use crate::analysis::replicates::{self, Condensed, Runs, is_mesh};
use crate::input::value::Value;
use crate::job::row::DerivedColumn;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Line, Panel};
use crate::store::table::{Column, Table};
use crate::study::{Meshes, meshes_text};

/// The runs behind the rows of a condensed table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replicated<'a> {
    /// The condensed table, which is that of the source.
    pub condensed: &'a Condensed,
    /// The table of the single runs.
    pub single: &'a Table,
    /// The parameters whose values repeat a point.
    pub names: &'a [String],
    /// The meshes from which values are extrapolated.
    pub meshes: &'a Meshes,
}

impl<'a> Source<'a> {
    /// Whether a point has several runs, on one mesh.
    pub(super) fn has_replicates(&self) -> bool {
        self.runs.is_some_and(|runs| runs.names.iter().any(|name| !is_mesh(name, runs.meshes)))
    }

    /// The runs of a row; `None` where each row is one job.
    pub(super) fn runs_of(&self, row: usize) -> Option<&'a Runs> {
        Some(&self.runs?.condensed.runs[row])
    }

    /// Least and largest value of a measure at a row; `None` where its runs do not differ.
    pub(super) fn range(&self, measure: &Column, row: usize) -> Option<[f64; 2]> {
        let [least, _, largest] = self.runs?.condensed.spread(&measure.name, row)?;
        (least < largest).then_some([least, largest])
    }

    /// Value less and plus its uncertainty (mesh error and what is assumed) at a row; of several runs of their medians.
    pub(super) fn uncertainty(&self, measure: &Column, row: usize) -> Option<[f64; 2]> {
        let errors = columns_of_error(self.table, &measure.name)?;
        let value = measured(self.table, measure, row)?;
        let error = error_at(self.table, errors, row)?;
        let assumed = columns_of_assumed(self.table, &measure.name)
            .and_then(|columns| error_at(self.table, columns, row));
        let [below, above] = together(error, assumed);
        Some([value - below, value + above])
    }

    /// The legend of uncertainties; `None` where no row has one.
    pub(super) fn uncertainty_legend(&self, measure: &Column) -> Option<Legend> {
        let has_error = self.rows.iter().any(|row| self.uncertainty(measure, *row).is_some());
        let finest = MeshErrors::shipped().finest;
        let of_file = self.runs.is_some_and(|runs| runs.meshes.of_file);
        let meaning = if of_file {
            "mesh (grid convergence index) and what is assumed".to_owned()
        } else {
            format!("mesh (to n {finest}, 19 of 20 runs) and what is assumed")
        };
        let outside = !of_file
            && self.table.column(NO_ERROR_REASON).is_some_and(|reasons| {
                let has_error = |row: &&usize| self.uncertainty(measure, **row).is_some();
                self.rows.iter().filter(has_error).any(|row| reasons.cells[*row] != Value::Null)
            });
        let other = "; outside the table from three meshes, or pilots";
        let meaning = format!("{meaning}{}", if outside { other } else { "" });
        let entries = vec![(Sample::Error, meaning)];
        has_error.then(|| Legend { heading: "Uncertainty".to_owned(), entries })
    }

    /// The single runs of the chart; of several meshes those on the finest one.
    pub(super) fn single(&self) -> Self {
        let Some(runs) = self.runs else { return self.clone() };
        let rows = self.rows.iter().flat_map(|row| runs.condensed.runs[*row].finest.clone());
        Self { table: runs.single, rows: rows.collect(), runs: None, ..self.clone() }
    }

    /// The rows of the single runs of a row; of several meshes those on the finest one.
    pub(super) fn single_rows(&self, row: usize) -> &[usize] {
        self.runs_of(row).map_or(&[], |runs| &runs.finest)
    }

    /// " of 5 runs each (seed)", for the subtitle; of several meshes the runs on each.
    pub(super) fn runs_text(&self) -> String {
        let Some(runs) = self.runs else { return String::new() };
        let counts = || self.rows.iter().map(|row| self.single_rows(*row).len());
        let (Some(least), Some(most)) = (counts().min(), counts().max()) else {
            return String::new();
        };
        let on_meshes = match runs.meshes {
            Meshes { list, of_pilots: false, .. } if !list.is_empty() => {
                format!(" on n {}", meshes_text(list))
            }
            _ => String::new(),
        };
        let replicates = runs.names.iter().filter(|name| !is_mesh(name, runs.meshes));
        let names: Vec<String> =
            replicates.map(|name| names::Name::of_parameter(name).plain).collect();
        if names.is_empty() {
            return on_meshes;
        }
        let number = if least == most { most.to_string() } else { format!("{least} to {most}") };
        let noun = if most == 1 { "run" } else { "runs" };
        format!(" of {number} {noun} each ({}){on_meshes}", names.join(", "))
    }

    /// Notes on the runs that medians and ranges do not contain.
    pub(super) fn runs_notes(&self, measure: Option<&Column>) -> Vec<String> {
        let Some(Replicated { condensed, single, .. }) = self.runs else { return Vec::new() };
        let all = || self.rows.iter().map(|row| &condensed.runs[*row]);
        let sum = |count: fn(&Runs) -> usize| all().map(count).sum::<usize>();
        let not_trusted = sum(|runs| if runs.has_trusted { runs.not_trusted } else { 0 });
        let counts = [
            (not_trusted, "cannot be trusted"),
            (sum(|runs| runs.failed + runs.infeasible), "failed or are infeasible"),
            (sum(|runs| runs.pending), "have not ended"),
        ];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        let texts: Vec<String> = counts.map(|(count, text)| format!("{count} {text}")).collect();
        let mut notes = Vec::new();
        notes.extend(self.meshes_note(measure));
        if !texts.is_empty() {
            notes.push(format!(
                "Of {} runs {}: medians, ranges and k/n are those of the others.",
                sum(|runs| runs.rows.len()),
                texts.join(", ")
            ));
        }
        let column = measure.and_then(|measure| single.column(&measure.name));
        let partly = column.map_or(0, |column| {
            let count = |runs: &Runs| {
                runs.measured.iter().filter(|row| measured(single, column, **row).is_some()).count()
            };
            all().filter(|runs| (1..runs.measured.len()).contains(&count(runs))).count()
        });
        if partly > 0 {
            let noun = if partly == 1 { "point" } else { "points" };
            notes.push(format!(
                "At {partly} {noun} not every run has a value: median and range are of those that have one."
            ));
        }
        notes
    }

    /// From which meshes the values of a measure come; without one, the histories.
    pub(super) fn meshes_note(&self, measure: Option<&Column>) -> Option<String> {
        let Replicated { single, meshes, .. } = self.runs?;
        let [.., second, finest] = &meshes.list[..] else { return None };
        let extrapolated = measure.is_some_and(|measure| {
            let values = single.column(&measure.name);
            values.is_some_and(|values| replicates::source(single, values) != values)
        });
        Some(if meshes.of_pilots {
            format!(
                "A point whose runs all ran on n {} (pilots, nearest to a limit) shows these alone.",
                meshes_text(&meshes.list)
            )
        } else if extrapolated && !meshes.of_file {
            format!(
                "Values are extrapolated from n {second} and {finest}; outcomes are those on n {finest}."
            )
        } else {
            format!("Only the runs on the finest mesh, n {finest}, are shown.")
        })
    }

    /// The legend of the values of points and their ranges, with this sample; `None` where no panel has a range.
    pub(super) fn runs_legend(
        &self,
        measure: &str,
        sample: Sample,
        panels: &[Panel],
    ) -> Option<Legend> {
        let mut lines = panels.iter().flat_map(|panel| &panel.lines);
        let ranges = |line: &Line| {
            let mut ranges = line.bands.iter().flatten().chain(&line.bars);
            ranges.any(|[_, least, largest]| least < largest)
        };
        if !self.has_replicates() || !lines.any(ranges) {
            return None;
        }
        // The smallest margin of a point is the least of its runs.
        let value =
            if measure == DerivedColumn::SmallestMargin.name() { "least" } else { "median" };
        let entries = vec![(sample, format!("{value}, and range from least to largest"))];
        Some(Legend { heading: "Runs of a point".to_owned(), entries })
    }
}
