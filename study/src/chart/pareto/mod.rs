//! Work-precision diagrams: error over cost, both logarithmic. One picture a scene with a panel a quantity, and one
//! overview with a panel a scene.
//!
//! A line joins configurations that differ in the mesh, or in the step. A filled marker is on the front: no other
//! configuration is cheaper and more accurate.

use std::collections::BTreeSet;

use self::axes::{Axes, nothing};
use self::lines::Drawing;
use super::names::{self, Name};
use crate::analysis::work_precision::peer::Peer;
use crate::analysis::work_precision::{Cost, Diagram, Ending, Errors, label, words};
use crate::input::value::brief_number;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::Direction;
use crate::render::figure::plot::Rule;
use crate::render::figure::plot::{Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::{Fill, Series};
use crate::render::figure::ticks::minus;
use crate::render::figure::{Sheet, columns};

mod axes;
mod lines;
#[cfg(test)]
mod tests;

/// Panels side by side in the overview. Chosen: scenes with and without an exact answer stand in different rows.
const OVERVIEW_COLUMNS: usize = 2;

/// Draws the diagram of a scene. A peer stands on the chart of seconds.
pub fn scene(diagram: &Diagram, cost: Cost, peer: Option<&Peer>) -> String {
    let peer = peer.filter(|peer| cost == Cost::Seconds && !peer.points(diagram).is_empty());
    let errors: Vec<&Errors> = diagram.quantities.iter().collect();
    let axes = Axes::of(&[(diagram, errors.clone())], cost, peer);
    let drawing = Drawing::of(diagram, cost, axes);
    let panels: Vec<Panel> = errors
        .iter()
        .map(|errors| {
            let mut panel = drawing.panel(errors);
            panel.title = title(diagram, errors);
            if let Some(peer) = peer {
                panel.lines.extend(drawing.peer(peer, errors));
            }
            panel
        })
        .collect();
    let mut legends = vec![drawing.legend(), marks(&errors, std::slice::from_ref(diagram))];
    let mut notes = notes(diagram, cost);
    if let Some(peer) = peer {
        let entry = (Sample::Point(lines::PEER), format!("{}, difference", peer.name));
        legends.push(Legend { heading: String::new(), entries: vec![entry] });
        notes.extend(peer_notes(peer));
    }
    let usual = label(&diagram.usual(), &[]);
    let mut subtitle = vec![names::capital(&diagram.meaning.replace('_', " "))];
    if !usual.is_empty() {
        subtitle.push(format!("Unless stated: {usual}"));
    }
    let title = format!("Work and precision: {}", diagram.name.replace('_', " "));
    Plots {
        sheet: Sheet { title, subtitle, legends, notes },
        x: axes.x(&axes::label_of(diagram.per_simulated_second, cost)),
        across: columns(panels.len()),
        panels,
    }
    .svg()
}

/// Draws the largest error of each configuration, one panel a scene.
pub fn overview(diagrams: &[Diagram], cost: Cost) -> String {
    let errors: Vec<Errors> = diagrams.iter().map(Diagram::largest).collect();
    let pairs: Vec<(&Diagram, Vec<&Errors>)> =
        diagrams.iter().zip(&errors).map(|(diagram, errors)| (diagram, vec![errors])).collect();
    let axes = Axes::of(&pairs, cost, None);
    // Panels of a row share the axis of errors.
    let panels: Vec<Panel> = pairs
        .chunks(OVERVIEW_COLUMNS)
        .flat_map(|row| {
            let axes = axes.with_errors_of(&Axes::of(row, cost, None));
            row.iter().map(move |(diagram, errors)| {
                let mut panel = Drawing::of(diagram, cost, axes).panel(errors[0]);
                panel.title = names::capital(&diagram.name.replace('_', " "));
                panel.title.push_str(&order(diagram, errors[0]));
                panel
            })
        })
        .collect();
    let all: Vec<&Errors> = errors.iter().collect();
    let subtitle = "Largest error over the numbers of each scene; courses over time have no part. Colours and shapes \
                    are those of the pictures of the scenes.";
    let mixed = diagrams.iter().any(|diagram| !diagram.per_simulated_second);
    let mut notes = Vec::new();
    if cost == Cost::Seconds && mixed {
        notes.push("Of a scene at rest: seconds of its search, on one thread.".to_owned());
    }
    notes.extend(numbers(diagrams));
    notes.push(cost_note(cost, diagrams).to_owned());
    notes.extend(implicit_note(cost, diagrams));
    Plots {
        sheet: Sheet {
            title: "Work and precision: every scene".to_owned(),
            subtitle: vec![subtitle.to_owned()],
            legends: vec![marks(&all, diagrams)],
            notes,
        },
        x: axes.x(&axes::label_of(true, cost)),
        across: OVERVIEW_COLUMNS.min(panels.len().max(1)),
        panels,
    }
    .svg()
}

/// Title of a panel: the quantity, and the order of its longest chain.
fn title(diagram: &Diagram, errors: &Errors) -> String {
    let quantity = &errors.quantity;
    let name = if quantity.is_course {
        Name::of_history(&quantity.name, &quantity.meaning).plain + " over time"
    } else {
        Name::of_measure(&quantity.name, &quantity.meaning).plain
    };
    names::capital(&name) + &order(diagram, errors)
}

/// Text of the fitted order of the first line that has one.
fn order(diagram: &Diagram, errors: &Errors) -> String {
    let lines = diagram.lines();
    let order = lines.iter().find_map(|(chain, _)| errors.orders[(*chain)?]);
    order.map_or_else(String::new, |order| {
        format!(" (order {})", minus(&brief_number(libm::round(10.0 * order) / 10.0)))
    })
}

/// The legend of the marks.
fn marks(errors: &[&Errors], diagrams: &[Diagram]) -> Legend {
    let points = || errors.iter().flat_map(|errors| errors.points.iter().flatten());
    let mut entries = vec![
        (Sample::Marker(Fill::Filled), "on the front (dotted line)".to_owned()),
        (Sample::Marker(Fill::Open), "another one is cheaper and as good or better".to_owned()),
    ];
    if points().any(|point| point.is_reference) {
        let text = "reference, at its uncertainty".to_owned();
        entries.push((Sample::Marker(Fill::Crossed), text));
    }
    if points().any(|point| point.error.count > 1) {
        entries.push((Sample::Bar, "range over the runs (seeds)".to_owned()));
    }
    for (problem, failed) in [("no run passes its audit", false), ("at the top: failed", true)] {
        let names = endings(diagrams, failed);
        if !names.is_empty() {
            entries.push((Sample::Cross, format!("{problem} ({})", names.join(", "))));
        }
    }
    if errors.iter().any(|errors| errors.uncertainty() > 0.0) {
        entries.push((Sample::Closed, "within the reference's uncertainty".to_owned()));
    }
    Legend { heading: String::new(), entries }
}

/// What speaks against configurations that cannot be trusted: failures, or findings of the audit. Each once.
fn endings(diagrams: &[Diagram], failed: bool) -> Vec<&'static str> {
    let members = diagrams.iter().flat_map(|diagram| &diagram.members);
    let endings = members.map(|member| member.ending).filter(|ending| !ending.is_trusted());
    let names = endings.filter(|ending| ending.is_failure() == failed).map(Ending::name);
    names.collect::<BTreeSet<_>>().into_iter().collect()
}

/// The notes below the pictures of a scene.
fn notes(diagram: &Diagram, cost: Cost) -> Vec<String> {
    let mut notes = Vec::new();
    let references: Vec<usize> =
        diagram.quantities.iter().filter_map(|errors| errors.reference.as_ref()?.member).collect();
    if let Some(first) = references.first() {
        let member = &diagram.members[*first];
        let has_meshes = diagram.chains.iter().any(|chain| chain.of_meshes);
        let same = references.iter().all(|other| other == first);
        let runs =
            if member.runs == 1 { "1 run".to_owned() } else { format!("{} runs", member.runs) };
        let other = if same { "" } else { " (of some quantities another one)" };
        let from = if has_meshes {
            "the next coarser mesh, or its mesh error if that is known and larger. A method of low order may be further \
             from its limit."
        } else {
            "the next coarser step. Every run has this mesh, so its error has no part."
        };
        notes.push(format!(
            "Reference: {}, {runs}{other}. Its uncertainty: half the range over the runs, and half the difference from {from}",
            label(&member.configuration, &diagram.usual())
        ));
    } else {
        notes.push("Reference: the exact value.".to_owned());
    }
    notes.extend(numbers(std::slice::from_ref(diagram)));
    notes.push(cost_note(cost, std::slice::from_ref(diagram)).to_owned());
    notes.extend(implicit_note(cost, std::slice::from_ref(diagram)));
    if diagram.without_result > 0 {
        notes.push(match diagram.without_result {
            1 => "1 run has not ended, or failed beside others of its configuration; it is not drawn."
                .to_owned(),
            number => format!(
                "{number} runs have not ended, or failed beside others of their configuration; they are not drawn."
            ),
        });
    }
    notes
}

/// What the numbers beside points are: the values along the first line of each scene.
fn numbers(diagrams: &[Diagram]) -> Option<String> {
    let mut found: Vec<String> = Vec::new();
    for diagram in diagrams {
        let first = diagram.lines().first().and_then(|(chain, _)| *chain);
        let text = first.map(|chain| words(&diagram.chains[chain].parameter));
        found.extend(text.filter(|text| !found.contains(text)));
    }
    (!found.is_empty()).then(|| format!("Numbers beside points: {}.", found.join(", ")))
}

fn cost_note(cost: Cost, diagrams: &[Diagram]) -> &'static str {
    let mut members = diagrams.iter().flat_map(|diagram| &diagram.members);
    match cost {
        Cost::Work if members.any(|member| member.elements <= 0.0) => {
            "Element-steps: elements times steps; of the models without elements (piston, storeys), steps."
        }
        Cost::Work => "Element-steps: elements times steps.",
        Cost::Seconds => {
            "Seconds: wall time of a job, which runs on one thread, median over the runs. Other jobs on the machine \
             lengthen it."
        }
    }
}

/// Why implicit steps are not on the front of work.
fn implicit_note(cost: Cost, diagrams: &[Diagram]) -> Option<String> {
    let mixed = |diagram: &Diagram| {
        let implicit = diagram.members.iter().filter(|member| member.implicit).count();
        implicit > 0 && implicit < diagram.members.len()
    };
    (cost == Cost::Work && diagrams.iter().any(mixed)).then(|| {
        "An implicit step solves equations for all nodes: it costs as much as hundreds of explicit ones. Here implicit \
         steps have no part in the front; the pictures over seconds compare them."
            .to_owned()
    })
}

/// What is known of a peer.
fn peer_notes(peer: &Peer) -> Vec<String> {
    let times = peer.times.iter().map(|time| {
        format!(
            "{} to {} times at {} {} for {} s",
            time.ratio[0], time.ratio[1], time.model, time.subdivisions, time.simulated
        )
    });
    let times: Vec<String> = times.collect();
    let mut notes = vec![format!(
        "{}: {}. Time over that of billow: {}; drawn as these ratios times the seconds above.",
        names::capital(&peer.name),
        peer.provenance,
        times.join("; ")
    )];
    notes
        .extend(peer.measures.iter().map(|measure| format!("{}: {}.", measure.name, measure.note)));
    notes
}

/// The shaded range below the uncertainty of a reference.
fn uncertain(errors: &Errors) -> Option<Rule> {
    let value = errors.uncertainty();
    (value > 0.0).then(|| Rule { value, text: String::new(), closed: Some(Direction::Down) })
}

/// A panel without points.
fn empty(errors: &Errors) -> Panel {
    Panel {
        message: nothing(errors).to_owned(),
        label: axes::ERROR.to_owned(),
        spread: Spread::Logarithmic,
        ..Panel::default()
    }
}

/// The series of a line.
fn series(index: usize) -> Series {
    Series { dashes: 0, ..Series::nth(index) }
}
