//! Lines of the answer on the search of an optimum.

use std::fmt::Write as _;

use super::{parameters_text, short_id};
use crate::analysis::answer::{Best, Optimum, Small};
use crate::input::value::brief_number;
use crate::job::result_limit::Safety;
use crate::print::{count, range};
use crate::study::MAX_CONFIRMED;

/// Most points of a front that the answer names.
const MAX_FRONT: usize = 12;

/// The front between two measures, better points that the finest mesh refutes, and how the search went on. A single best
/// point is the headline.
pub(super) fn lines(found: &Optimum) -> Vec<String> {
    let [tried, budget] = found.points;
    let mut lines = Vec::new();
    if found.minimise.len() > 1 && !found.best.is_empty() {
        let (names, all) = (found.minimise.join(" and "), found.best.len());
        // Spread along the front, both ends among them.
        let shown = all.min(MAX_FRONT);
        let some = if shown < all { format!(", {shown} of them") } else { String::new() };
        lines.push(format!("the front between {names} has {}{some}:", count(all, "point")));
        let place = |k: usize| if shown > 1 { k * (all - 1) / (shown - 1) } else { 0 };
        let shown: Vec<&Best> = (0..shown).map(|k| &found.best[place(k)]).collect();
        lines.extend(shown.iter().map(|point| of_point(point)));
        lines.extend(not_separate(&shown));
    }
    for point in &found.refuted {
        lines.push(format!("better, but not on the finest mesh: {}", of_point(point)));
    }
    let unconfirmed = found.best.iter().all(|best| best.confirmed_on.is_none());
    if found.refuted.len() == MAX_CONFIRMED && unconfirmed {
        lines.push(
            "no other point runs on finer meshes: that of the search is too coarse for it"
                .to_owned(),
        );
    }
    if found.best.is_empty() {
        let limits = if found.tried.iter().any(|one| one.measures.iter().all(Option::is_some)) {
            "keeps every limit"
        } else {
            "has a result"
        };
        lines.push(format!("none of {} {limits}", count(tried, "point")));
    }
    if tried < budget {
        lines.push(if found.ended {
            format!(
                "{} tried of {budget}: all others are refused, or are the same jobs",
                count(tried, "point")
            )
        } else {
            format!("the search goes on: {tried} of {} have run", count(budget, "point"))
        });
    }
    if let [best] = found.best.as_slice() {
        lines.extend(course(found, best));
    }
    lines
}

/// As in `peak_vz 8.1 [7.9 to 8.4] ± 0.3 m/s at from=0.1 s, …; safe; nearest limit t_deployed, 2 % away; 5 runs, …`.
pub(super) fn of_point(best: &Best) -> String {
    let measures: Vec<String> = best.measures.iter().map(small).collect();
    let mut text = format!("{} at {}", measures.join(", "), parameters_text(&best.parameters));
    match best.safety {
        Some(Safety::Safe) => text.push_str("; safe"),
        Some(_) if best.keeps_limits => text.push_str("; within the uncertainty of its limits"),
        Some(_) => text.push_str("; does not keep its limits"),
        None => {}
    }
    if let Some(n) = best.confirmed_on {
        let values: Vec<String> =
            best.measures.iter().map(|one| one.shown.brief(one.value)).collect();
        let _ =
            write!(text, " (ran on n {n} too; {} on the mesh of the search)", values.join(", "));
    }
    let limit = best.limit.as_ref().map(|(measure, margin)| {
        let percent = brief_number(100.0 * margin.abs());
        if *margin < 0.0 {
            format!("misses the limit of {measure} by {percent} %")
        } else {
            format!("nearest limit {measure}, {percent} % away")
        }
    });
    let ends = best.at_end.iter().map(|(name, upper)| {
        format!("{name} at the {} end of its range", if *upper { "upper" } else { "lower" })
    });
    for part in limit.into_iter().chain(ends) {
        let _ = write!(text, "; {part}");
    }
    let job = short_id(&best.job);
    let first = if best.runs > 1 { ", the first is" } else { "," };
    let _ = write!(text, "; {}{first} job {job}", count(best.runs, "run"));
    text
}

/// Neighbours of a front that their uncertainty does not separate: the one costs nothing that is known.
fn not_separate(points: &[&Best]) -> Option<String> {
    let measures = points.first()?.measures.len();
    let pairs = points.windows(2).flat_map(|pair| (0..measures).map(move |k| (pair, k)));
    let texts = pairs.filter_map(|(pair, k)| {
        let [one, other] = [pair[0], pair[1]].map(|point| &point.measures[k]);
        let [a, b] = [one, other].map(|small| brief_number(small.shown.number(small.stands())));
        let text = || format!("{} {a} and {b} {}", one.measure, one.shown.symbol());
        (one.is_separate_from(other) == Some(false)).then(text)
    });
    let texts: Vec<String> = texts.map(|text| text.trim_end().to_owned()).collect();
    (!texts.is_empty()).then(|| format!("the uncertainty does not separate {}", texts.join(", ")))
}

fn small(one: &Small) -> String {
    let [value, least, largest] = one.stands_for.unwrap_or([one.value; 3]);
    let number = range::text(value, Some((least, largest)), one.uncertainty, &one.shown);
    let text = format!("{} {number} {}", one.measure, one.shown.symbol());
    let unknown = if one.uncertainty.is_none() { " (its error is not known)" } else { "" };
    format!("{}{unknown}", text.trim_end())
}

/// How much better than the first points, which are spread evenly, and when it was found.
fn course(found: &Optimum, best: &Best) -> Option<String> {
    let shown = &best.measures.first()?.shown;
    let (first, of_first) = found.course.first()?;
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
    let all = found.points[0];
    let even = found.of_even_points.map_or_else(String::new, |value| {
        format!("; of {all} points spread evenly about {}, by a surrogate", shown.brief(value))
    });
    Some(format!("{before}{even}; this is point {} of {all}", best.number))
}
