//! The front: configurations that no other one dominates in cost and error.

use super::{Cost, Member, Point};

/// Members on the front. Errors below the uncertainty of the reference count as equal to it. The reference itself and
/// configurations without trusted runs have no part. By work, implicit steps have none beside explicit ones.
pub(super) fn of(
    points: &[Option<Point>],
    members: &[Member],
    cost: Cost,
    floor: f64,
) -> Vec<usize> {
    let all_comparable = cost == Cost::Seconds || members.iter().all(|member| member.implicit);
    let candidate = |index: usize| -> Option<(usize, [f64; 2])> {
        let point = points[index].as_ref().filter(|point| !point.is_reference)?;
        let member = &members[index];
        let comparable = all_comparable || !member.implicit;
        (comparable && member.ending.is_trusted())
            .then_some((index, [member.cost(cost)?, point.error.median.max(floor)]))
    };
    let candidates: Vec<(usize, [f64; 2])> = (0..members.len()).filter_map(candidate).collect();
    let dominates =
        |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && (a[0] < b[0] || a[1] < b[1]);
    let free =
        |one: &&(usize, [f64; 2])| !candidates.iter().any(|other| dominates(&other.1, &one.1));
    candidates.iter().filter(free).map(|(index, _)| *index).collect()
}
