//! `billow chart --work-precision`: the front, and one picture a scene with an overview.

use std::io::Write;
use std::sync::Arc;

use billow_solver::output::events::EventKind;

use super::super::results::Opened;
use super::super::{Format, output_error};
use crate::analysis::work_precision::table::{COURSES, Histories, scenes};
use crate::analysis::work_precision::{Cost, Course, Diagram, Errors, label};
use crate::chart::kinds::file_name;
use crate::chart::work_precision as pictures;
use crate::input::keys::numerical::MESH_PARAMETER;
use crate::input::value::Value;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::print::print_rows;
use crate::store::history_file::StoredHistory;

/// The cost of a diagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum CostName {
    /// Element-steps; the same on every machine.
    #[default]
    Work,
    /// Wall time of this machine.
    Seconds,
}

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

/// Prints the front, in CSV and JSON every configuration, and draws the pictures.
///
/// # Errors
/// A history that cannot be read; a picture that cannot be written.
pub fn run(opened: &Opened, cost: CostName, format: Format, out: &mut dyn Write) -> Result<()> {
    let Opened { stored, table } = opened;
    let (results, study) = (&stored.results, &stored.study);
    let read = |job: &str| {
        let id = JobId::from_digits(job)?;
        match results.read_history(&id, stored.record(&id)) {
            Ok(history) => Some(of_history(&history)),
            Err(error) => {
                eprintln!("billow: {error}");
                None
            }
        }
    };
    // The meshes of solver.meshes are configurations here.
    let mut replicates = study.replicates();
    replicates.retain(|name| name != MESH_PARAMETER);
    let scenes = scenes(&study.name, table, &replicates, &read);
    let diagrams: Vec<Diagram> = scenes.into_iter().map(Diagram::of).collect();
    let mut points =
        diagrams.iter().flat_map(|diagram| &diagram.quantities).flat_map(|q| &q.points);
    if !points.any(|point| point.as_ref().is_some_and(|point| !point.is_reference)) {
        let problem = "compares methods, and no scene of this study has results of two";
        let allowed = "a study that varies solver.model, solver.integrator, solver.cfl or design.subdivisions";
        let next = "studies/pareto.json is an example";
        return Err(Error::invalid_option("--work-precision", &study.name, problem, allowed, next));
    }
    let (cost, ending) = match cost {
        CostName::Work => (Cost::Work, ""),
        CostName::Seconds => (Cost::Seconds, "-seconds"),
    };
    print_front(&diagrams, cost, format, out)?;
    let mut write = |name: &str, svg: &str| -> Result<()> {
        let name = file_name(&format!("work-precision{name}{ending}"));
        for path in super::write(&results.charts_path(), &name, svg)? {
            if format == Format::Table {
                writeln!(out, "{}", path.display()).map_err(output_error)?;
            }
        }
        Ok(())
    };
    write("", &pictures::overview(&diagrams, cost))?;
    for diagram in &diagrams {
        write(&format!("-{}", diagram.name), &pictures::scene(diagram, cost))?;
    }
    Ok(())
}

/// What the history of a job says.
fn of_history(history: &StoredHistory) -> Histories {
    let times = history.history.column("time");
    let course = |(name, _, _): (&str, &str, &str)| {
        Course::new(times, history.history.column(name)).map(Arc::new)
    };
    Histories {
        courses: COURSES.map(course),
        simulated: times.last().copied().unwrap_or(0.0),
        implicit: history.events.iter().any(|event| event.kind == EventKind::Implicit),
    }
}

/// Prints the configurations by scene, quantity and cost: of a table those on the front, with two digits.
///
/// # Errors
/// When the output cannot be written.
pub fn print_front(
    diagrams: &[Diagram],
    cost: Cost,
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    let mut rows: Vec<Vec<Value>> = Vec::new();
    for diagram in diagrams {
        for errors in &diagram.quantities {
            let mut members: Vec<usize> = (0..diagram.members.len()).collect();
            let place =
                |member: &usize| diagram.members[*member].cost(cost).unwrap_or(f64::INFINITY);
            members.sort_by(|a, b| place(a).total_cmp(&place(b)));
            rows.extend(
                members.into_iter().filter_map(|member| row(diagram, errors, member, cost, format)),
            );
        }
    }
    print_rows(&COLUMNS, &rows, format, out)
}

/// The row of a configuration; `None` for one that is not listed.
fn row(
    diagram: &Diagram,
    errors: &Errors,
    index: usize,
    cost: Cost,
    format: Format,
) -> Option<Vec<Value>> {
    let (point, member) = (errors.points[index].as_ref(), &diagram.members[index]);
    let reference = errors.reference.as_ref()?;
    let on_front = point.is_some_and(|point| point.on_front(cost));
    let is_listed = format != Format::Table && (point.is_some() || member.ending.is_failure());
    if !on_front && !is_listed {
        return None;
    }
    let shown = |value: f64| match format {
        Format::Table => format!("{value:.1e}").parse().unwrap_or(value),
        _ => value,
    };
    let number =
        |value: Option<f64>| value.map_or(Value::Null, |value| Value::Number(shown(value)));
    let error = point.filter(|point| !point.is_reference).map(|point| point.error);
    let of = match reference.member {
        None => "exact".to_owned(),
        Some(member) => label(&diagram.members[member].configuration, &diagram.usual()),
    };
    Some(vec![
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
    ])
}
