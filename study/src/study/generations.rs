//! What the finished rows of a study decide: searches, of borders and of an optimum, and pilots.

use super::finished::{FinishedRow, Judging};
use super::grid::Axis;
use super::optimise::PRIOR_POINTS;
use super::search::Criterion;
use super::{Study, pilots};
use crate::job::JobId;
use crate::job::point::Point;
use crate::job::row::ColumnId;

impl Study {
    /// Whether its finished rows decide about further points.
    pub fn has_generations(&self) -> bool {
        self.grid.search.is_some() || self.grid.optimise.is_some() || self.pilots.is_some()
    }

    /// The parameter along which it searches a border, and what changes there; `None` without a search.
    pub fn searched(&self) -> Option<(&str, Criterion)> {
        let search = self.grid.search.as_ref()?;
        Some((&self.grid.columns[search.column].name, search.criterion))
    }

    /// The parameters whose values its searches choose, of borders or of an optimum, or its samples.
    pub fn names_chosen(&self) -> Vec<&str> {
        let border = self.grid.search.iter().map(|search| search.column);
        let optimum = self.grid.optimise.iter().flat_map(|optimise| &optimise.columns).copied();
        let searched = border.chain(optimum).map(|column| &self.grid.columns[column]);
        let all = searched.chain(self.grid.columns_sampled());
        all.map(|column| column.name.as_str()).collect()
    }

    /// Largest number of values that one of its searches can take; `None` without a search.
    pub fn most_search_values(&self) -> Option<usize> {
        let search = self.grid.search.as_ref()?;
        // With replicates, or where an uncertainty decides, both ends of the border move.
        let one = self.replicate_count() == 1 && search.criterion == Criterion::Deployed;
        let ends = if one { 1 } else { 2 };
        Some(search.scan().len() + ends * search.most_values_after_scan())
    }

    /// The measures that it makes small; none without a search of an optimum.
    pub fn minimised(&self) -> &[ColumnId] {
        self.grid.optimise.as_ref().map_or(&[], |optimise| &optimise.minimise)
    }

    /// Number of points of the search of an optimum in all, and of a generation after the first; `None` without one.
    pub fn budget(&self) -> Option<[usize; 2]> {
        self.grid.optimise.as_ref().map(|optimise| [optimise.budget, optimise.batch])
    }

    /// Number of points of the model of storeys that its search looks at, beside those that run; 0 where it has no such prior.
    pub fn points_of_prior(&self) -> usize {
        let has_prior = self.grid.optimise.as_ref().is_some_and(|optimise| optimise.has_prior);
        if has_prior { PRIOR_POINTS } else { 0 }
    }

    /// What its results are judged by.
    pub fn judging(&self) -> Judging<'_> {
        let (limits, assumed) = (self.result_limits(), self.assumed());
        Judging { limits, assumed, minimised: self.minimised() }
    }

    /// Whether its points are every combination of axes of one key each: then each key takes its values whatever the others
    /// are.
    pub fn is_product(&self) -> bool {
        let grid = &self.grid;
        let alone = |axis: &Axis| axis.kind.repeats() || axis.columns.len() == 1;
        let whole = grid.points.is_empty() && grid.filter.is_none() && grid.search.is_none();
        whole && grid.sample_count() == 1 && grid.optimise.is_none() && grid.axes.iter().all(alone)
    }

    /// Whether its answer says more than its rows: it has samples, searches an optimum, or varies several parameters.
    pub fn asks_beyond_rows(&self) -> bool {
        self.grid.sample_count() > 1 || self.grid.optimise.is_some() || self.is_product()
    }

    /// The runs of its pilots, generation after generation, once these planned points are finished; none where it needs no
    /// pilots. `best` are the jobs of the best points of a search, the best first.
    pub(crate) fn pilots(
        &self,
        planned: &[Point],
        finished: &[FinishedRow],
        best: Option<&[Vec<JobId>]>,
    ) -> Vec<Vec<Point>> {
        let Some(meshes) = &self.pilots else { return Vec::new() };
        if let Some(best) = best {
            let best = (best, self.minimised().len() > 1);
            return pilots::confirming((&self.settings, meshes), best, planned, finished);
        }
        let of = (&self.settings, &self.grid);
        vec![pilots::points(of, meshes, &self.result_limits, planned, finished)]
    }

    /// Which of its points its pilots are, in words.
    pub fn pilots_are(&self) -> &'static str {
        match self.minimised() {
            [] => "the points nearest to a limit",
            [_] => "the best point",
            _ => "ends and middle of the front",
        }
    }

    /// Whether a planned point is the run of a pilot on another mesh than that of the study.
    pub(crate) fn is_pilot(&self, point: &Point) -> bool {
        self.mesh_of_pilots().is_some_and(|mesh| point.job.scene.design.subdivisions() != mesh)
    }

    /// The mesh of its points, where it has pilots.
    pub(crate) fn mesh_of_pilots(&self) -> Option<u32> {
        self.pilots.map(|_| self.points[0].job.scene.design.subdivisions())
    }

    /// The most pilots that it can have, one for each run of a point.
    pub fn most_pilots(&self) -> usize {
        let samples = self.grid.sample_count();
        if self.grid.optimise.is_some() {
            return pilots::MAX_CONFIRMED * self.replicate_count();
        }
        (self.point_count() * samples).min(2 * pilots::NEAREST) * (self.replicate_count() / samples)
    }
}
