//! Lines of the answer on the mesh that a study with `"model": "auto"` chose.

use std::fmt::Write as _;

use crate::accuracy::PROMISED;
use crate::analysis::answer::{AutoAnswer, Kept};
use crate::cli::print::count;
use crate::input::value::brief_number;
use crate::job::point::label;
use crate::study::auto::Check;

/// Most broken checks that the answer names.
const MAX_BROKEN: usize = 5;

/// What ran on which mesh, what it promises, what the checks found, what it cost.
pub fn lines(auto: &AutoAnswer) -> Vec<String> {
    let reference = auto.reference;
    let pilots = count(auto.pilots, "pilot");
    let Some(chosen) = auto.chosen else {
        return vec![format!("{pilots} on n {reference} and coarser meshes: not all have ended")];
    };
    let asked: Vec<String> = auto.kept.iter().map(promise).collect();
    let others = count(auto.others, "point");
    let mut lines = Vec::new();
    if chosen == reference {
        lines.push(format!(
            "no coarser mesh keeps the accuracy: {others} beside {pilots} run on n {reference} too"
        ));
        lines.push(format!("n {} would have {}", auto.finest_rung, asked.join(", ")));
    } else {
        lines.push(format!(
            "n {chosen} instead of n {reference} for {others}, after {pilots} on both"
        ));
        lines.push(format!("corrected; errors against n {reference}: {}", asked.join(", ")));
        lines.extend(checks(auto));
    }
    if let Some(cost) = auto.cost {
        let cost = 100.0 * cost;
        let so_far = if auto.is_complete { "" } else { " so far" };
        lines.push(format!(
            "cost{so_far} {cost:.1} % of all points on n {reference} (element-steps; pilots, points and checks)"
        ));
    }
    lines
}

/// A measure with its error after the correction, and its tolerance.
fn promise(kept: &Kept) -> String {
    let asked = brief_number(100.0 * kept.tolerance);
    let error = kept
        .error
        .map_or_else(|| "not known".to_owned(), |error| format!("{:.1} %", 100.0 * error));
    format!("{} {error} (asked {asked} %)", kept.measure)
}

fn checks(auto: &AutoAnswer) -> Vec<String> {
    let (ended, planned, mesh) = (auto.checks.len(), auto.planned_checks, auto.check_mesh);
    let checks = count(planned, "check");
    let open =
        if ended < planned { format!(", {} not run", planned - ended) } else { String::new() };
    let broken: Vec<&Check> = auto.broken().collect();
    if ended == 0 {
        return vec![format!("{checks} on n {mesh}: none has ended")];
    }
    if broken.is_empty() {
        let kept =
            if ended < planned { "none differs by more so far" } else { "the promise is kept" };
        let mut text = format!("{checks} on n {mesh}{open}: {kept}");
        let largest = PROMISED.iter().enumerate().filter_map(|(index, promised)| {
            let differences = auto.checks.iter().filter_map(|check| check.differences[index]);
            let largest = 100.0 * differences.reduce(f64::max)?;
            Some(format!("{} {largest:.1} %", promised.measure.name()))
        });
        let largest: Vec<String> = largest.collect();
        if !largest.is_empty() {
            let list = largest.join(", ");
            let reference = auto.reference;
            let _ = write!(text, "; largest differences, both corrected to n {reference}: {list}");
        }
        return vec![text];
    }
    let mut lines =
        vec![format!("PROMISE BROKEN in {} of {checks} on n {mesh}{open}", broken.len())];
    lines.extend(broken.iter().take(MAX_BROKEN).map(|check| broken_text(check)));
    let more = broken.len().saturating_sub(MAX_BROKEN);
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    lines.push(
        "next: a smaller accuracy chooses a finer mesh; billow table --runs shows the runs"
            .to_owned(),
    );
    lines
}

fn broken_text(check: &Check) -> String {
    let measures = check.broken.iter().filter_map(|index| {
        let difference = 100.0 * check.differences[*index]?;
        Some(format!("{} differs by {difference:.1} %", PROMISED[*index].measure.name()))
    });
    let mut parts: Vec<String> = measures.collect();
    if check.other_verdict {
        parts.push("another verdict".to_owned());
    }
    format!("{}: {}", label(&check.parameters), parts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A promise is kept once every check has ended, and no cost is final before.
    #[test]
    fn nothing_is_promised_before_the_checks_have_ended() {
        let answer = AutoAnswer {
            reference: 12,
            chosen: Some(6),
            pilots: 4,
            others: 56,
            kept: Vec::new(),
            finest_rung: 6,
            planned_checks: 6,
            check_mesh: 8,
            checks: Vec::new(),
            is_complete: false,
            cost: Some(0.1),
        };
        let text = lines(&answer).join("\n");
        assert!(text.contains("6 checks on n 8: none has ended"), "{text}");
        assert!(text.contains("cost so far 10.0 %") && !text.contains("kept"), "{text}");
    }
}
