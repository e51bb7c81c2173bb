//! Lines of the answer on the search of an optimum.

use std::fmt::Write as _;

use super::parameters_text;
use crate::analysis::answer::{Best, Optimum, Small};
use crate::input::value::brief_number;
use crate::job::result_limit::Safety;
use crate::print::{count, range};

/// Most points of a front that the answer names.
const MAX_FRONT: usize = 12;

/// The front between two measures, and how the search went on. A single best point is the headline.
pub(super) fn lines(found: &Optimum) -> Vec<String> {
    let [ended, budget] = found.points;
    let mut lines = Vec::new();
    if found.best.len() > 1 {
        let names = found.minimise.join(" and ");
        lines.push(format!("the front between {names} has {}:", count(found.best.len(), "point")));
        lines.extend(found.best.iter().take(MAX_FRONT).map(of_point));
    }
    if found.best.is_empty() {
        lines.push(format!("none of {} keeps every limit", count(ended, "point")));
    }
    if ended < budget {
        lines.push(format!(
            "the search is not at its end: {ended} of {} have run",
            count(budget, "point")
        ));
    }
    if found.best.len() == 1 {
        lines.extend(course(found));
    }
    lines
}

/// As in `peak_vz 8.1 [7.9 to 8.4] ± 0.3 m/s at from=0.1 s, …; safe; nearest limit t_deployed, 2 % away; point 31 of 5 runs`.
pub(super) fn of_point(best: &Best) -> String {
    let measures: Vec<String> = best.measures.iter().map(small).collect();
    let mut text = format!("{} at {}", measures.join(", "), parameters_text(&best.parameters));
    match best.safety {
        Some(Safety::Safe) => text.push_str("; safe"),
        Some(Safety::Uncertain) => text.push_str("; within the uncertainty of its limits"),
        Some(Safety::Unsafe) => text.push_str("; does not keep its limits on the finest mesh"),
        None => {}
    }
    if let Some(n) = best.confirmed_on {
        let values: Vec<String> =
            best.measures.iter().map(|one| one.shown.brief(one.value)).collect();
        let _ =
            write!(text, " (ran on n {n} too; {} on the mesh of the search)", values.join(", "));
    }
    let ends = best.at_end.iter().map(|(name, upper)| {
        format!("{name} at the {} end of its range", if *upper { "upper" } else { "lower" })
    });
    let limit = best.limit.as_ref().map(|(measure, margin)| {
        format!("nearest limit {measure}, {} % away", brief_number(100.0 * margin))
    });
    for part in limit.into_iter().chain(ends) {
        let _ = write!(text, "; {part}");
    }
    let _ = write!(
        text,
        "; {} of {}, the first is job {}",
        format_args!("point {}", best.number),
        count(best.runs, "run"),
        &best.job[..8.min(best.job.len())]
    );
    text
}

fn small(one: &Small) -> String {
    let [value, least, largest] = one.stands_for.unwrap_or([one.value; 3]);
    let number = range::text(value, Some((least, largest)), one.uncertainty, &one.shown);
    let text = format!("{} {number} {}", one.measure, one.shown.symbol());
    let unknown = if one.uncertainty.is_none() { " (its error is not known)" } else { "" };
    format!("{}{unknown}", text.trim_end())
}

/// How much better than the first points, which are spread evenly, and when nothing better came any more.
fn course(found: &Optimum) -> Option<String> {
    let shown = &found.best[0].measures.first()?.shown;
    let (first, of_first) = found.course.first()?;
    let (_, last) = found.course.last()?;
    let last = last[0]?;
    let since = found.course.iter().find(|(_, smallest)| smallest[0] == Some(last))?.0;
    let before = match of_first[0] {
        None => format!(
            "none of the first {}, spread evenly, keeps every limit",
            count(*first, "point")
        ),
        Some(value) => format!(
            "the best of the first {}, spread evenly, has {}",
            count(*first, "point"),
            shown.brief(value)
        ),
    };
    Some(format!("{before}; after {} none was better", count(since, "point")))
}
