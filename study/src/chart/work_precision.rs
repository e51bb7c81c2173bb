//! Work-precision diagrams: error over cost, both logarithmic. One picture a scene with a panel a quantity, and one
//! overview with a panel a scene.
//!
//! A line joins configurations that differ in the mesh, or in the step. A filled marker is on the front: no other
//! configuration is cheaper and more accurate.

use std::collections::BTreeSet;

use super::names::{Name, capital};
use crate::analysis::work_precision::{Cost, Diagram, Ending, Errors, label, words};
use crate::input::value::{Value, brief_number, short_number};
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Direction, Line, Panel, Plots, Rule};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::{Fill, Series};
use crate::render::figure::ticks::{Tick, minus};
use crate::render::figure::{Sheet, columns};

/// Panels side by side in the overview. Chosen: two scenes beside each other are legible.
const OVERVIEW_COLUMNS: usize = 2;
/// The style of the front.
const FRONT: Series = Series { colour: "#555555", dashes: 2, marker: None };
/// Least error that is drawn. Chosen: rounding.
const MIN_ERROR: f64 = 1e-15;
/// Distance of the crosses of failed configurations from the upper end of an axis, as a part of its length.
const TOP_SHARE: f64 = 0.04;
/// Part of a decade that stays free at the ends of an axis.
const PADDING: f64 = 0.12;

/// Draws the diagram of a scene.
pub fn scene(diagram: &Diagram, cost: Cost) -> String {
    let errors: Vec<&Errors> = diagram.quantities.iter().collect();
    let axes = Axes::of(errors.iter().map(|errors| (diagram, *errors)), cost);
    let drawing = Drawing { diagram, cost, axes, lines: diagram.lines() };
    let title =
        |errors: &Errors| Name::of_quantity(&errors.quantity.name, &errors.quantity.meaning).plain;
    let panels: Vec<Panel> =
        errors.iter().map(|errors| drawing.panel(&title(errors), errors)).collect();
    let usual = label(&diagram.usual(), &[]);
    let mut subtitle = vec![capital(&diagram.meaning.replace('_', " "))];
    if !usual.is_empty() {
        subtitle.push(format!("Unless stated: {usual}"));
    }
    let mut notes = vec![reference_note(diagram)];
    notes.extend(shared_notes(std::slice::from_ref(diagram), cost));
    let sheet = Sheet {
        title: format!("Work and precision: {}", diagram.name.replace('_', " ")),
        subtitle,
        legends: vec![drawing.legend(), marks(&errors, std::slice::from_ref(diagram))],
        notes,
    };
    let across = columns(panels.len());
    Plots { sheet, x: axes.x(diagram.per_simulated_second, cost), across, panels }.svg()
}

/// Draws the largest error of each configuration, one panel a scene.
pub fn overview(diagrams: &[Diagram], cost: Cost) -> String {
    let errors: Vec<Errors> = diagrams.iter().map(Diagram::largest).collect();
    let pairs: Vec<(&Diagram, &Errors)> = diagrams.iter().zip(&errors).collect();
    let axes = Axes::of(pairs.iter().copied(), cost);
    // Panels of a row share the axis of errors.
    let panels = pairs.chunks(OVERVIEW_COLUMNS).flat_map(|row| {
        let axes = Axes { error: Axes::of(row.iter().copied(), cost).error, ..axes };
        row.iter().map(move |(diagram, errors)| {
            let drawing = Drawing { diagram, cost, axes, lines: diagram.lines() };
            drawing.panel(&diagram.name.replace('_', " "), errors)
        })
    });
    let panels: Vec<Panel> = panels.collect();
    let subtitle = "Largest error over the numbers of each scene; courses over time have no part. Colours and shapes \
                    are those of the pictures of the scenes.";
    let sheet = Sheet {
        title: "Work and precision: every scene".to_owned(),
        subtitle: vec![subtitle.to_owned()],
        legends: vec![marks(&errors.iter().collect::<Vec<_>>(), diagrams)],
        notes: shared_notes(diagrams, cost),
    };
    let across = OVERVIEW_COLUMNS.min(panels.len().max(1));
    Plots { sheet, x: axes.x(true, cost), across, panels }.svg()
}

/// The style of a line of configurations.
fn series(index: usize) -> Series {
    Series { dashes: 0, ..Series::nth(index) }
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
        let members = diagrams.iter().flat_map(|diagram| &diagram.members);
        let endings = members.map(|member| member.ending).filter(|ending| !ending.is_trusted());
        let endings = endings.filter(|ending| ending.is_failure() == failed);
        let names: BTreeSet<&str> = endings.map(Ending::name).collect();
        if !names.is_empty() {
            let names = names.into_iter().collect::<Vec<_>>().join(", ");
            entries.push((Sample::Cross, format!("{problem} ({names})")));
        }
    }
    if errors.iter().any(|errors| errors.uncertainty() > 0.0) {
        entries.push((Sample::Closed, "within the reference's uncertainty".to_owned()));
    }
    Legend { heading: String::new(), entries }
}

/// To what the errors of a scene refer.
fn reference_note(diagram: &Diagram) -> String {
    let references: Vec<usize> =
        diagram.quantities.iter().filter_map(|errors| errors.reference.as_ref()?.member).collect();
    let Some(first) = references.first() else {
        return "Reference: the exact value.".to_owned();
    };
    let member = &diagram.members[*first];
    let noun = if member.runs == 1 { "run" } else { "runs" };
    let same = references.iter().all(|other| other == first);
    let other = if same { "" } else { " (of some quantities another one)" };
    let from = if diagram.chains.iter().any(|chain| chain.of_meshes) {
        "the next coarser mesh, or its mesh error if that is known and larger. A method of low order may be further \
         from its limit."
    } else {
        "the next coarser step. Every run has this mesh, so its error has no part."
    };
    format!(
        "Reference: {}, {} {noun}{other}. Its uncertainty: half the range over the runs, and half the difference from {from}",
        label(&member.configuration, &diagram.usual()),
        member.runs
    )
}

/// The notes that scenes and overview have in common.
fn shared_notes(diagrams: &[Diagram], cost: Cost) -> Vec<String> {
    let mut notes = Vec::new();
    // Numbers beside points are the values along the first line of each scene.
    let first = |diagram: &Diagram| {
        let chain = diagram.lines().first().and_then(|(chain, _)| *chain)?;
        Some(words(&diagram.chains[chain].parameter))
    };
    let mut numbers: Vec<String> = diagrams.iter().filter_map(first).collect();
    numbers.dedup();
    if !numbers.is_empty() {
        notes.push(format!("Numbers beside points: {}.", numbers.join(", ")));
    }
    let mut members = diagrams.iter().flat_map(|diagram| &diagram.members);
    notes.push(match cost {
        Cost::Work if members.any(|member| member.elements <= 0.0) => {
            "Element-steps: elements times steps; of the models without elements (piston, storeys), steps.".to_owned()
        }
        Cost::Work => "Element-steps: elements times steps.".to_owned(),
        Cost::Seconds => {
            "Seconds: wall time on one thread, of a scene at rest that of its search; median over the runs. Other jobs \
             on the machine lengthen it."
                .to_owned()
        }
    });
    let mixed = |diagram: &Diagram| {
        let implicit = diagram.members.iter().filter(|member| member.implicit).count();
        implicit > 0 && implicit < diagram.members.len()
    };
    if cost == Cost::Work && diagrams.iter().any(mixed) {
        let text = "An implicit step solves equations for all nodes: it costs as much as hundreds of explicit ones. Here \
                    implicit steps have no part in the front; the pictures over seconds compare them.";
        notes.push(text.to_owned());
    }
    let missing: usize = diagrams.iter().map(|diagram| diagram.without_result).sum();
    if missing > 0 {
        notes.push(format!(
            "Not drawn: {missing} runs that have not ended, or failed beside others of their configuration."
        ));
    }
    notes
}

/// Ranges of both axes: whole decades that hold every point.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axes {
    cost: [f64; 2],
    error: [f64; 2],
}

impl Axes {
    fn of<'a>(pairs: impl Iterator<Item = (&'a Diagram, &'a Errors)>, cost: Cost) -> Self {
        let (mut costs, mut errors) = (Vec::new(), Vec::new());
        for (diagram, of_quantity) in pairs {
            for (point, member) in of_quantity.points.iter().zip(&diagram.members) {
                let Some(cost) = member.cost(cost) else { continue };
                if let Some(point) = point {
                    errors.extend([point.error.median, point.error.largest]);
                }
                if point.is_some() || member.ending.is_failure() {
                    costs.push(cost);
                }
            }
            errors.push(of_quantity.uncertainty());
        }
        Self { cost: padded(&costs, 0.0), error: padded(&errors, MIN_ERROR) }
    }

    fn x(&self, per_simulated_second: bool, cost: Cost) -> Axis {
        let label = match (cost, per_simulated_second) {
            (Cost::Work, _) => "Work, element-steps",
            (Cost::Seconds, true) => "Wall time a simulated second on one thread, s",
            (Cost::Seconds, false) => "Wall time on one thread, s",
        };
        Axis {
            label: label.to_owned(),
            spread: Spread::Logarithmic,
            range: self.cost,
            ticks: decades(self.cost),
            names: false,
        }
    }

    /// An error within the axis.
    fn inside(&self, error: f64) -> f64 {
        error.clamp(self.error[0], self.error[1])
    }
}

/// A tick at every decade, or at every few: at most four.
fn decades([low, high]: [f64; 2]) -> Vec<Tick> {
    let (first, last) = (libm::ceil(libm::log10(low)), libm::floor(libm::log10(high)));
    let stride = libm::ceil((last - first + 1.0) / 4.0).max(1.0);
    let exponents = (0..4).map(|number| first + f64::from(number) * stride);
    let tick = |exponent: f64| {
        let value = libm::pow(10.0, exponent);
        let plain = (-2.0..=3.0).contains(&exponent);
        (value, if plain { short_number(value) } else { minus(&format!("1e{exponent}")) })
    };
    exponents.take_while(|exponent| *exponent <= last).map(tick).collect()
}

/// The range of the positive values above a least one, with padding; a decade if there are none.
fn padded(values: &[f64], least: f64) -> [f64; 2] {
    let used = values.iter().copied().filter(|value| value.is_finite() && *value > least);
    let ends = used.map(|value| [libm::log10(value); 2]);
    let Some([low, high]) =
        ends.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)])
    else {
        return [0.1, 1.0];
    };
    // At least a decade, so that its ticks are numbers of one digit.
    let free = PADDING.max(0.06 * (high - low)) + 0.5 * (1.0 - (high - low)).max(0.0);
    [libm::pow(10.0, low - free), libm::pow(10.0, high + free)]
}

/// How the configurations of a scene are drawn.
struct Drawing<'a> {
    diagram: &'a Diagram,
    cost: Cost,
    axes: Axes,
    lines: Vec<(Option<usize>, Vec<usize>)>,
}

impl Drawing<'_> {
    /// Where a member stands.
    fn position(&self, errors: &Errors, member: usize) -> Option<[f64; 2]> {
        let point = errors.points[member].as_ref()?;
        Some([self.diagram.members[member].cost(self.cost)?, self.axes.inside(point.error.median)])
    }

    /// The panel of the errors of a quantity; its title has the fitted order of the first line that has one.
    fn panel(&self, name: &str, errors: &Errors) -> Panel {
        let order = self.lines.iter().find_map(|(chain, _)| errors.orders[(*chain)?]);
        let order = order.map_or_else(String::new, |order| {
            format!(" (order {})", minus(&brief_number(libm::round(10.0 * order) / 10.0)))
        });
        let uncertainty = errors.uncertainty();
        let rule = Rule { value: uncertainty, text: String::new(), closed: Some(Direction::Down) };
        let mut panel = Panel {
            title: capital(name) + &order,
            label: "Relative error".to_owned(),
            range: self.axes.error,
            spread: Spread::Logarithmic,
            rules: (uncertainty > 0.0).then_some(rule).into_iter().collect(),
            lines: vec![self.front(errors)],
            ..Panel::default()
        };
        for (number, (chain, new)) in self.lines.iter().enumerate() {
            panel.lines.push(self.line(errors, number, (*chain, new)));
        }
        if panel.lines.iter().all(|line| line.marks.is_empty() && line.crosses.is_empty()) {
            let message = match errors.reference {
                None => "no trusted configuration has run",
                Some(_) => "nothing to compare with the reference",
            };
            message.clone_into(&mut panel.message);
            (panel.lines, panel.rules) = (Vec::new(), Vec::new());
        }
        panel
    }

    /// A line of members, and the marks of those that no earlier line has.
    fn line(
        &self,
        errors: &Errors,
        number: usize,
        (chain, new): (Option<usize>, &[usize]),
    ) -> Line {
        let members = &self.diagram.members;
        let mut line = Line::new(series(number));
        let chain = chain.map(|chain| &self.diagram.chains[chain]);
        let joined = chain.into_iter().flat_map(|chain| &chain.members);
        let joined = joined.filter(|index| members[**index].ending.is_trusted());
        line.pieces.push(joined.filter_map(|index| self.position(errors, *index)).collect());
        for index in new {
            let member = &members[*index];
            if let (true, Some(cost)) = (member.ending.is_failure(), member.cost(self.cost)) {
                let [low, high] = self.axes.error;
                line.crosses.push([cost, high * libm::pow(low / high, TOP_SHARE)]);
                continue;
            }
            let point = errors.points[*index].as_ref();
            let Some((point, position)) = point.zip(self.position(errors, *index)) else {
                continue;
            };
            if !member.ending.is_trusted() {
                line.crosses.push(position);
                continue;
            }
            let fill = match point {
                point if point.is_reference => Fill::Crossed,
                point if point.on_front(self.cost) => Fill::Filled,
                _ => Fill::Open,
            };
            line.marks.push((position, fill));
            if point.error.count > 1 {
                let ends = [point.error.least, point.error.largest];
                let [low, high] = ends.map(|error| self.axes.inside(error));
                line.bars.push([position[0], low, high]);
            }
            // The first line says which mesh each of its points has.
            let varied = |(name, _): &&(String, Value)| chain.is_some_and(|c| c.parameter == *name);
            let value = member.configuration.iter().find(varied);
            if let (0, Some((_, value @ (Value::Integer(_) | Value::Number(_))))) = (number, value)
            {
                line.texts.push((position, value.short()));
            }
        }
        line
    }

    /// The points on the front, joined.
    fn front(&self, errors: &Errors) -> Line {
        let members = (0..self.diagram.members.len()).filter(|index| {
            errors.points[*index].as_ref().is_some_and(|point| point.on_front(self.cost))
        });
        let mut piece: Vec<[f64; 2]> =
            members.filter_map(|index| self.position(errors, index)).collect();
        piece.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Line { pieces: vec![piece], ..Line::new(FRONT) }
    }

    /// The legend of the lines.
    fn legend(&self) -> Legend {
        let usual = self.diagram.usual();
        let entry = |(number, (chain, new)): (usize, &(Option<usize>, Vec<usize>))| {
            let first = &self.diagram.members[new[0]].configuration;
            let parameter = chain.map(|chain| &self.diagram.chains[chain].parameter);
            let varied = first.iter().filter(|(name, _)| Some(name) == parameter).cloned();
            let text = label(first, &usual.iter().cloned().chain(varied).collect::<Vec<_>>());
            let over = parameter.map(|name| format!("over {}", words(name)));
            let texts = [Some(text).filter(|text| !text.is_empty()), over];
            let text = texts.into_iter().flatten().collect::<Vec<_>>().join(", ");
            (Sample::Line(series(number)), text)
        };
        let entries = self.lines.iter().enumerate().map(entry).collect();
        Legend { heading: String::new(), entries }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::work_precision::{Outcome, Quantity, Run, SceneRuns};
    use crate::render::figure::check;

    fn run(model: &str, n: Option<i64>, value: f64) -> Run {
        let size = n.map_or(0.0, |n| n as f64);
        let steps = 5000.0 * size.max(0.1);
        Run {
            configuration: vec![
                ("solver.model".to_owned(), Value::Text(model.to_owned())),
                ("subdivisions".to_owned(), n.map_or(Value::Null, Value::Integer)),
            ],
            ending: Ending::Trusted,
            elements: 48.0 * size * size,
            steps,
            implicit: false,
            seconds: Some(1e-6 * (1.0 + size * size) * steps),
            results: vec![Some(Outcome::Number(value)), None],
            mesh_errors: Vec::new(),
        }
    }

    fn diagram(name: &str, exact: Option<f64>) -> Diagram {
        let quantity = |name: &str| Quantity {
            name: name.to_owned(),
            unit: "J".to_owned(),
            meaning: String::new(),
            exact: exact.filter(|_| name != "t_90_z_rim"),
            is_course: false,
        };
        let mut runs = vec![run("piston", None, 24.0)];
        for n in [4, 8, 16] {
            let size = n as f64;
            runs.extend(
                [0.9, 1.1].map(|part| run("film", Some(n), 20.0 * (1.0 + part / (size * size)))),
            );
        }
        Diagram::of(SceneRuns {
            name: name.to_owned(),
            meaning: "an invented scene".to_owned(),
            quantities: vec![quantity("peak_kinetic_energy"), quantity("t_90_z_rim")],
            per_simulated_second: true,
            runs,
            without_result: 2,
        })
    }

    #[test]
    fn a_picture_has_orders_front_reference_and_gaps() {
        let has = |diagram: &Diagram, cost: Cost, wanted: &[&str]| {
            let texts = check::figure(&scene(diagram, cost));
            for text in wanted {
                assert!(texts.iter().any(|shown| shown.contains(text)), "{text}: {texts:?}");
            }
        };
        let wanted = [
            "Work and precision: capsule direct",
            "on the front (dotted line)",
            "reference, at its uncertainty",
            "no trusted configuration",
            "film, over subdivisions",
            "piston",
            "Not drawn: 2 runs",
            "Numbers beside points: subdivisions.",
        ];
        has(&diagram("capsule_direct", None), Cost::Work, &wanted);
        has(&diagram("capsule_direct", None), Cost::Seconds, &["Wall time a simulated second"]);
        let exact = ["order 2", "Reference: the exact value."];
        has(&diagram("disc", Some(20.0)), Cost::Work, &exact);
    }

    #[test]
    fn the_overview_has_a_panel_for_each_scene() {
        // Without the quantity that no run has.
        let diagrams = [("a_scene", None), ("b", Some(20.0)), ("c", Some(20.0))].map(|scene| {
            let mut diagram = diagram(scene.0, scene.1);
            diagram.quantities.truncate(1);
            diagram
        });
        let texts = check::figure(&overview(&diagrams, Cost::Work));
        for wanted in ["A scene", "B (order 2)", "C (order 2)"] {
            assert!(texts.iter().any(|text| text.contains(wanted)), "{wanted}: {texts:?}");
        }
        assert!(!check::figure(&overview(&[], Cost::Seconds)).is_empty());
    }
}
