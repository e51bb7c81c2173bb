//! What the limits of a study say of one job: for each limit its value with its uncertainty, and its margin.
//!
//! In a study with several meshes the table judges the value extrapolated from them; here it is that of the run.

use crate::analysis::at_limit::AtLimit;
use crate::job::JobId;
use crate::job::result_limit::Safety;
use crate::print::at_limit::at_limit;
use crate::store::stored::Stored;

/// What is known of the job, and each limit; none for a job that is no longer in the study.
fn judged(stored: &Stored<'_>, id: &JobId) -> Option<(Option<Safety>, Vec<AtLimit>)> {
    let table = stored.table_of(id)?;
    let limits = stored.study.result_limits().iter();
    Some((table.safety(0), limits.map(|limit| AtLimit::of(&table, limit, 0)).collect()))
}

/// The lines of `billow job`: whether the job is safe, and each limit; none for a study without limits, or a job that is not done.
pub(super) fn lines(stored: &Stored<'_>, id: &JobId) -> Vec<(&'static str, String)> {
    let (safety, limits) = judged(stored, id).unwrap_or_default();
    if limits.iter().all(|one| one.judged.is_none()) {
        return Vec::new();
    }
    let answer = match safety {
        None => "not known: a measure with a limit has no value",
        Some(Safety::Safe) => "yes: every limit is met, by more than the uncertainty",
        Some(Safety::Uncertain) => {
            "not certain: within the uncertainty of a measure, or its error is not known"
        }
        Some(Safety::Unsafe) => "no",
    };
    let mut lines = vec![("safe", answer.to_owned())];
    lines.extend(limits.iter().map(|one| ("limit", at_limit(one, None))));
    lines
}

/// The keys of `billow job` as JSON: `safety` (null where it is not known), and `limits`.
pub(super) fn keys(stored: &Stored<'_>, id: &JobId) -> [(&'static str, serde_json::Value); 2] {
    let (safety, limits) = judged(stored, id).unwrap_or_default();
    [("safety", safety.map(Safety::name).into()), ("limits", serde_json::json!(limits))]
}
