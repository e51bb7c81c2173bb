//! A study whose points are known to be valid, because they ran before: its points are not resolved until
//! something asks for them.
//!
//! ```text
//! number of a point = its place in the product of the axes before the filter (the last axis varies fastest),
//!                     then the single points, each with all its replicates
//! ```
//! A plain grid, also with replicates and several meshes, can be read so. A search, `accuracy` and the model
//! `auto` plan by the scenes of all their points: they are read whole.

use std::path::Path;

use super::plan::{self, Generation};
use super::plan_size::PlanSize;
use super::{Study, StudyPoint, expand};
use crate::input::source::Source;
use crate::input::study_file;
use crate::platform::error::Result as BillowResult;

impl Study {
    /// Reads a study file without its points, with `--set key=value` overrides applied to it. The points must be known
    /// to be valid: those of the same resolved study planned by the same program. `None` for a study that cannot be
    /// read so.
    ///
    /// # Errors
    /// As [`Study::load`], without the errors of single points.
    pub fn sketch(path: &Path, sets: &[String]) -> BillowResult<Option<Self>> {
        let bytes = study_file::read(path, "study file", "studies/first.json")?;
        let file = path.display().to_string();
        let text = study_file::text_of(&bytes, &file)?;
        let stem =
            path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let tree = study_file::parse(text, &file)?;
        let read = Self::read_tree(tree, &file, &stem, sets, PlanSize::default(), false);
        Ok(Some(read.map_err(|error| study_file::with_place(error, text, &file))?)
            .filter(Self::is_plain_grid))
    }

    /// Whether its points follow from its axes alone.
    pub fn is_plain_grid(&self) -> bool {
        self.auto.is_none() && self.accuracy.is_none() && self.grid.search.is_none()
    }

    /// The same study with its numbers of runs and of points, so that neither is counted.
    #[must_use]
    pub fn counted(self, runs: usize, points: usize) -> Self {
        Self { known: Some([runs, points]), ..self }
    }

    /// The points with these numbers as one generation; `None` where one of them is no point.
    pub fn generation_of(&self, numbers: &[usize]) -> Option<Generation> {
        let source = Source::new(&self.name);
        let points = expand::numbered(&self.base, &self.grid, &source, numbers).ok()?;
        Some(plan::generation(0, &points))
    }

    /// Number of runs, without those of searches.
    pub(crate) fn run_count(&self) -> usize {
        self.known.map_or_else(|| self.points().len(), |[runs, _]| runs)
    }

    /// For each of its points its number.
    pub fn point_numbers(&self) -> Vec<usize> {
        self.points().iter().map(|point: &StudyPoint| point.number).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::files::{Disk, Files};

    /// Two axes, replicates, a filter and a single point.
    const TEXT: &str = r#"{
        "design": {"fit": "height", "bottom_radius": 0.5, "height": 1, "alpha1_over_phi": 0.8},
        "gas": {"mass_flow_rate": 0.002},
        "solver": {"model": "piston", "end_time": 0.3},
        "replicates": {"seed": 2},
        "grid": {"N": [5, 6, 7], "M": [2, 3], "filter": "N != 6 or M == 3", "points": [{"N": 9, "M": 2}]}
    }"#;

    #[test]
    fn a_point_by_its_number_is_the_point_of_the_whole_plan() {
        let whole = Study::from_text(TEXT, "a.json", "a", &[], PlanSize::default()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        Disk.write_new(&path, TEXT.as_bytes()).unwrap();
        let sketch = Study::sketch(&path, &[]).unwrap().unwrap();
        let planned = plan::next_jobs(&whole, &[]).unwrap().points;
        let numbers = whole.point_numbers();
        assert_eq!(numbers.len(), 12);
        for (number, point) in numbers.iter().zip(&planned) {
            assert_eq!(
                sketch.generation_of(&[*number]).unwrap().points,
                std::slice::from_ref(point)
            );
        }
        assert_eq!(sketch.resolved(), whole.resolved());
        assert_eq!(sketch.generation_of(&[14]), None, "there are 14 numbers");
        let counted = sketch.counted(whole.points().len(), whole.point_count());
        assert_eq!((counted.run_count(), counted.point_count()), (12, 6));
    }

    #[test]
    fn a_study_that_plans_by_its_scenes_is_no_sketch() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        let text = TEXT.replacen("[2, 3]", "{\"border\": \"deployed\", \"from\": 2, \"to\": 3}", 1);
        Disk.write_new(&path, text.as_bytes()).unwrap();
        assert!(!matches!(Study::sketch(&path, &[]), Ok(Some(_))));
    }
}
