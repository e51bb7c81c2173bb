//! The answer in one line: which choice is safest, or how many points are safe.

use super::comparisons::{listed, value};
use super::optimum::of_point;
use super::parameters_text;
use super::tolerances::probability;
use crate::analysis::answer::{Answer, Best, SafeCounts, Tolerance};
use crate::analysis::ranking::{Basis, Ranking};
use crate::job::row::CellType;
use crate::print::count;

/// Points of samples in the line, at most.
const MAX_POINTS: usize = 4;

/// The line; `None` for a study without limits, and for one that searches a border: its borders say it.
pub(super) fn headline(answer: &Answer) -> Option<String> {
    match answer.optimum.as_ref().map(|found| found.best.as_slice()) {
        Some([best]) => return Some(of_point(best)),
        Some([first, .., last]) => return Some(of_front(first, last)),
        _ => {}
    }
    let safety = answer.safety.as_ref().filter(|_| answer.searches.is_none())?;
    if !answer.tolerances.is_empty() {
        return Some(of_samples(&answer.tolerances));
    }
    Some(choice(answer).unwrap_or_else(|| of_points(&safety.counts)))
}

/// Which choice, as of strategies, is safe at most of its points; `None` where none is compared by the limits.
pub fn choice(answer: &Answer) -> Option<String> {
    let safety = answer.safety.as_ref()?;
    let is_choice = |ranking: &&Ranking| {
        ranking.basis == Basis::Limits
            && ranking.candidates.len() > 1
            && matches!(ranking.by.as_slice(), [by] if by.cell_type == CellType::Text)
    };
    let mut ranked = answer.comparisons.iter().filter_map(|(_, ranking)| ranking.as_ref().ok());
    ranked.find(is_choice).map(|choice| of_choice(choice, &safety.counts))
}

/// "preinflate is safe at 3 of 4 points, rapid at 1 of 4".
fn of_choice(choice: &Ranking, counts: &SafeCounts) -> String {
    let name = choice.by.first().map_or("value", |by| by.name.as_str());
    let candidates = &choice.candidates;
    let most = candidates.iter().map(|candidate| candidate.safe).max().unwrap_or(0);
    if most == 0 {
        return format!("no {name} is safe at any of its points; {}", not_safe(counts));
    }
    let mut order: Vec<_> = candidates.iter().collect();
    order.sort_by_key(|candidate| std::cmp::Reverse(candidate.safe));
    let texts = order.iter().enumerate().map(|(index, candidate)| {
        let (value, safe, points) = (value(choice, candidate), candidate.safe, candidate.points);
        match index {
            0 => format!("{name} {value} is safe at {safe} of {}", count(points, "point")),
            _ => format!("{value} at {safe} of {points}"),
        }
    });
    let texts = listed(texts);
    if candidates.iter().all(|candidate| candidate.safe == most) {
        format!("{texts}: equally safe")
    } else {
        texts
    }
}

/// "strategy=delayed: safe with a probability of 92 to 100 % (…); strategy=rapid: …", the safest first.
fn of_samples(points: &[Tolerance]) -> String {
    let mut order: Vec<&Tolerance> = points.iter().collect();
    order.sort_by(|a, b| {
        let (a, b) = (a.safe_between, b.safe_between);
        b[0].total_cmp(&a[0]).then(b[1].total_cmp(&a[1]))
    });
    let text = |point: &&Tolerance| match parameters_text(&point.parameters) {
        name if name.is_empty() => probability(point),
        name => format!("{name}: {}", probability(point)),
    };
    let mut texts: Vec<String> = order.iter().take(MAX_POINTS).map(text).collect();
    if order.len() > MAX_POINTS {
        texts.push(format!("and {} more", count(order.len() - MAX_POINTS, "point")));
    }
    texts.join("; ")
}

/// `the smallest peak_vz 16.7 m/s with t_deployed 0.79 s; the smallest t_deployed 0.204 s with peak_vz 19.9 m/s`.
fn of_front(first: &Best, last: &Best) -> String {
    let of = |point: &Best, least: usize, other: usize| {
        let [least, other] = [least, other].map(|k| {
            let one = &point.measures[k];
            format!("{} {}", one.measure, one.shown.brief(one.stands()))
        });
        format!("{least} with {other}")
    };
    format!("the smallest {}; the smallest {}", of(first, 0, 1), of(last, 1, 0))
}

fn of_points(counts: &SafeCounts) -> String {
    match counts.safe {
        0 => format!("no point is safe; {}", not_safe(counts)),
        safe if safe == counts.points => format!("safe at all of {}", count(safe, "point")),
        safe => {
            format!("safe at {safe} of {}; {}", count(counts.points, "point"), not_safe(counts))
        }
    }
}

/// How the other points stand.
fn not_safe(counts: &SafeCounts) -> String {
    let known = counts.safe + counts.uncertain + counts.not_judged;
    let others = [
        (counts.points - known, "unsafe"),
        (counts.uncertain, "within the uncertainty"),
        (counts.not_judged, "not judged"),
    ];
    let others = others.iter().filter(|(points, _)| *points > 0);
    others.map(|(points, what)| format!("{points} {what}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_points_are_counted_by_what_is_known_of_them() {
        let counts = |points, safe, uncertain, not_judged| SafeCounts {
            points,
            safe,
            uncertain,
            not_judged,
        };
        assert_eq!(of_points(&counts(4, 4, 0, 0)), "safe at all of 4 points");
        let some = "safe at 1 of 8 points; 4 unsafe, 2 within the uncertainty, 1 not judged";
        assert_eq!(of_points(&counts(8, 1, 2, 1)), some);
        assert_eq!(of_points(&counts(2, 0, 0, 0)), "no point is safe; 2 unsafe");
    }
}
