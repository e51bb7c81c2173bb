//! The table of the front, the lines on a peer, and notes.

use std::io::Write;

use super::super::print::print_rows;
use super::super::{Format, output_error};
use crate::analysis::work_precision::peer::Peer;
use crate::analysis::work_precision::{Cost, Diagram, label};
use crate::input::value::{Value, brief_number};
use crate::platform::error::Result;

/// Columns of the output.
const COLUMNS: [&str; 16] = [
    "scene",
    "quantity",
    "configuration",
    "front",
    "status",
    "error",
    "least",
    "largest",
    "uncertainty",
    "order",
    "element_steps",
    "seconds",
    "runs",
    "value",
    "reference",
    "of",
];

/// Columns that only a table of every configuration needs.
const OF_ALL: [&str; 2] = ["front", "status"];

/// Prints one row per configuration on the front, by scene and quantity; with `all` one per configuration, those
/// without a result too.
///
/// # Errors
/// When the output cannot be written.
pub(super) fn front(
    diagrams: &[Diagram],
    cost: Cost,
    all: bool,
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    let mut rows: Vec<Vec<Value>> = Vec::new();
    for diagram in diagrams {
        for errors in &diagram.quantities {
            let mut of_quantity = Vec::new();
            for (point, member) in errors.points.iter().zip(&diagram.members) {
                let on_front = point.is_some_and(|point| point.on_front(cost));
                let listed = on_front || all && (point.is_some() || member.ending.is_failure());
                let Some(reference) = errors.reference.as_ref().filter(|_| listed) else {
                    continue;
                };
                let error = point.filter(|point| !point.is_reference).map(|point| point.error);
                let number =
                    |value: Option<f64>| value.map_or(Value::Null, |value| shown(value, format));
                let of = match reference.member {
                    None => "exact".to_owned(),
                    Some(member) => label(&diagram.members[member].configuration, &diagram.usual()),
                };
                let row = vec![
                    Value::Text(diagram.name.clone()),
                    Value::Text(errors.quantity.name.clone()),
                    Value::Text(label(&member.configuration, &[])),
                    Value::Bool(on_front),
                    Value::Text(member.ending.name().to_owned()),
                    number(error.map(|error| error.median)),
                    number(error.map(|error| error.least)),
                    number(error.map(|error| error.largest)),
                    number(reference.uncertainty),
                    number(point.and_then(|point| point.order)),
                    Value::Number(member.work()),
                    number(member.seconds),
                    Value::Integer(i64::try_from(member.runs).unwrap_or(i64::MAX)),
                    point.and_then(|point| point.value).map_or(Value::Null, Value::Number),
                    reference.value.map_or(Value::Null, Value::Number),
                    Value::Text(of),
                ];
                of_quantity.push((member.cost(cost).unwrap_or(f64::INFINITY), row));
            }
            of_quantity.sort_by(|a, b| a.0.total_cmp(&b.0));
            rows.extend(of_quantity.into_iter().map(|(_, row)| row));
        }
    }
    if all {
        return print_rows(&COLUMNS, &rows, format, out);
    }
    let kept = |index: &usize| !OF_ALL.contains(&COLUMNS[*index]);
    let columns: Vec<&str> = (0..COLUMNS.len()).filter(kept).map(|index| COLUMNS[index]).collect();
    let rows: Vec<Vec<Value>> = rows
        .into_iter()
        .map(|row| {
            row.into_iter()
                .enumerate()
                .filter(|(index, _)| kept(index))
                .map(|(_, cell)| cell)
                .collect()
        })
        .collect();
    print_rows(&columns, &rows, format, out)
}

/// A number as printed: of a table two digits.
fn shown(value: f64, format: Format) -> Value {
    if format != Format::Table {
        return Value::Number(value);
    }
    Value::Number(format!("{value:.1e}").parse().unwrap_or(value))
}

/// Prints what is known of a peer beside what billow computes.
///
/// # Errors
/// When the output cannot be written.
pub(super) fn peer(peer: &Peer, diagrams: &[Diagram], out: &mut dyn Write) -> Result<()> {
    let Some(diagram) = diagrams.iter().find(|diagram| diagram.name == peer.scene) else {
        return Ok(());
    };
    let mut lines = vec![String::new(), format!("{} ({})", peer.name, peer.provenance)];
    for point in peer.points(diagram) {
        let time = point.time;
        let [least, largest] = point.seconds.map(brief_number);
        lines.push(format!(
            "  {} {}, {} s: {} to {} times the time of billow; times the {} here: {least} to {largest} s a simulated \
             second",
            time.model,
            time.subdivisions,
            time.simulated,
            time.ratio[0],
            time.ratio[1],
            diagram.name
        ));
    }
    for measure in &peer.measures {
        let errors = diagram.quantities.iter().find(|errors| errors.quantity.name == measure.name);
        let value = errors.and_then(|errors| errors.reference.as_ref()?.value);
        let ours = value.map_or("unknown".to_owned(), brief_number);
        let [low, high] = measure.range;
        lines.push(format!("  {} {low} to {high}, billow {ours}: {}", measure.name, measure.note));
    }
    for event in &peer.events {
        lines.push(format!("  {} {} at {} s", event.quantity, event.value, event.time));
    }
    for line in lines {
        writeln!(out, "{line}").map_err(output_error)?;
    }
    Ok(())
}

/// Prints how to read the table on stderr.
pub(super) fn notes(diagrams: &[Diagram], cost: Cost) {
    let by = if cost == Cost::Seconds { "seconds" } else { "element-steps" };
    eprintln!(
        "note: front by {by}; error: median over the runs, relative to the exact value or to the finest trusted \
         configuration, whose uncertainty is beside it: an error below that counts as equal to it; a model without elements \
         costs its steps"
    );
    let implicit = |diagram: &Diagram| diagram.members.iter().any(|member| member.implicit);
    if cost == Cost::Work && diagrams.iter().any(implicit) {
        eprintln!(
            "note: an implicit step solves equations for all nodes and costs as much as hundreds of explicit ones: by \
             element-steps it is not on the front beside them; --cost seconds compares them"
        );
    }
    eprintln!(
        "note: seconds: wall time for a simulated second (at rest: of the search) on one thread; other jobs on the \
         machine lengthen it"
    );
    for diagram in diagrams {
        if let Some(note) = reference(diagram) {
            eprintln!("note: {}: {note}", diagram.name);
        }
    }
    for diagram in diagrams.iter().filter(|diagram| diagram.without_result > 0) {
        eprintln!("note: {}: {} runs without a result", diagram.name, diagram.without_result);
    }
}

/// To what the errors of a diagram refer, where that is a run.
fn reference(diagram: &Diagram) -> Option<String> {
    let mut references = diagram.quantities.iter().filter_map(|errors| errors.reference.as_ref());
    let member = references.find_map(|reference| reference.member)?;
    let name = label(&diagram.members[member].configuration, &[]);
    Some(format!(
        "errors refer to {name}, the finest that ran; its uncertainty holds its mesh error where that is known"
    ))
}
