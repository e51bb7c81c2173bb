//! What the study of some results asks: its limits, replicates and search.

use super::{Args, Asked};
use crate::chart::borders::Searched;
use crate::chart::standard::ChartKind;
use crate::job::result_limit::ResultLimit;
use crate::platform::error::Result;
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::study::{Border, Study};

/// What a study asks.
#[derive(Debug, Default)]
pub struct Question {
    /// What its results must meet to be safe.
    pub limits: Vec<ResultLimit>,
    replicates: Vec<String>,
    /// The meshes from which its values are extrapolated, coarsest first; empty without any.
    pub meshes: Vec<u32>,
    search: Option<Search>,
}

/// Its search, and what it found.
#[derive(Debug)]
struct Search {
    parameter: String,
    criterion: String,
    replicates: usize,
    borders: Vec<Border>,
}

impl Question {
    /// That of a study, with what its search found in some results; nothing for results without their study.
    ///
    /// # Errors
    /// Results that cannot be read.
    pub fn read(results: &Results<'static>, study: Option<&Study>) -> Result<Self> {
        let Some(study) = study else { return Ok(Self::default()) };
        let search = match study.searched() {
            None => None,
            Some((parameter, criterion)) => Some(Search {
                parameter: parameter.to_owned(),
                criterion: criterion.text(study.result_limits()),
                replicates: study.replicate_count(),
                borders: Stored::read(results.clone())?.asked(study.clone()).borders(),
            }),
        };
        let (limits, replicates) = (study.result_limits().to_vec(), study.replicates());
        Ok(Self { limits, replicates, meshes: study.meshes(), search })
    }

    /// The search, for a chart.
    pub fn search(&self) -> Option<Searched<'_>> {
        let search = self.search.as_ref()?;
        let (parameter, criterion) = (&search.parameter, &search.criterion);
        let (replicates, borders) = (&self.replicates, &search.borders);
        let replicate_count = search.replicates;
        Some(Searched { parameter, criterion, replicates, replicate_count, borders })
    }

    /// Whether it has any of them.
    pub fn is_asked(&self) -> bool {
        !self.limits.is_empty() || !self.replicates.is_empty() || self.search.is_some()
    }

    /// The parameters whose runs a chart condenses: the replicates that it does not name. Chosen jobs and
    /// `--runs` are drawn one by one.
    pub fn replicates(&self, args: &Args, asked: Option<&Asked>) -> Vec<String> {
        if args.runs || !args.jobs.is_empty() {
            return Vec::new();
        }
        let named: Vec<&String> = match asked {
            Some(Asked::One(ChartKind::Over(_, over, by))) => by.iter().chain([over]).collect(),
            Some(Asked::One(ChartKind::Map(_, axes))) => axes.iter().collect(),
            Some(Asked::Outcome(axes)) => axes.iter().collect(),
            _ => Vec::new(),
        };
        self.replicates.iter().filter(|name| !named.contains(name)).cloned().collect()
    }
}
