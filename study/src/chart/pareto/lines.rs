//! The lines and marks of a panel.

use super::axes::{self, Axes};
use super::{empty, series, uncertain};
use crate::analysis::work_precision::peer::Peer;
use crate::analysis::work_precision::{Cost, Diagram, Errors, label, words};
use crate::input::value::Value;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Line, Panel};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::{Fill, Series};

/// The style of a peer.
pub(super) const PEER: Series = Series { colour: "#000000", dashes: 0, marker: Some(3) };
/// The style of the front.
const FRONT: Series = Series { colour: "#555555", dashes: 2, marker: None };

/// How the configurations of a scene are drawn.
pub(super) struct Drawing<'a> {
    diagram: &'a Diagram,
    cost: Cost,
    axes: Axes,
    lines: Vec<(Option<usize>, Vec<usize>)>,
}

impl<'a> Drawing<'a> {
    pub(super) fn of(diagram: &'a Diagram, cost: Cost, axes: Axes) -> Self {
        Self { diagram, cost, axes, lines: diagram.lines() }
    }

    /// Where a member stands.
    fn position(&self, errors: &Errors, member: usize) -> Option<[f64; 2]> {
        let point = errors.points[member].as_ref()?;
        Some([self.diagram.members[member].cost(self.cost)?, self.axes.inside(point.error.median)])
    }

    /// The panel of the errors of a quantity.
    pub(super) fn panel(&self, errors: &Errors) -> Panel {
        let front = self.front(errors);
        let mut lines: Vec<Line> = Vec::new();
        for (number, (chain, new)) in self.lines.iter().enumerate() {
            lines.push(self.line(errors, number, (*chain, new)));
        }
        if lines.iter().all(|line| line.marks.is_empty() && line.crosses.is_empty()) {
            return Panel { range: self.axes.error, ..empty(errors) };
        }
        lines.insert(0, front);
        Panel {
            label: axes::ERROR.to_owned(),
            range: self.axes.error,
            spread: Spread::Logarithmic,
            rules: uncertain(errors).into_iter().collect(),
            lines,
            ..Panel::default()
        }
    }

    /// A line of members, and the marks of those that no earlier line has.
    fn line(
        &self,
        errors: &Errors,
        number: usize,
        (chain, new): (Option<usize>, &[usize]),
    ) -> Line {
        let diagram = self.diagram;
        let mut line = Line::new(series(number));
        let joined = chain.map_or(&[][..], |chain| diagram.chains[chain].members.as_slice());
        let joined = joined.iter().filter(|index| diagram.members[**index].ending.is_trusted());
        let piece: Vec<[f64; 2]> =
            joined.filter_map(|index| self.position(errors, *index)).collect();
        if piece.len() > 1 {
            line.pieces.push(piece);
        }
        let parameter = chain.map(|chain| diagram.chains[chain].parameter.as_str());
        for index in new {
            let member = &diagram.members[*index];
            if let (true, Some(cost)) = (member.ending.is_failure(), member.cost(self.cost)) {
                line.crosses.push([cost, self.axes.top()]);
                continue;
            }
            let (Some(point), Some(position)) =
                (&errors.points[*index], self.position(errors, *index))
            else {
                continue;
            };
            if !member.ending.is_trusted() {
                line.crosses.push(position);
                continue;
            }
            let fill = if point.is_reference {
                Fill::Crossed
            } else if point.on_front(self.cost) {
                Fill::Filled
            } else {
                Fill::Open
            };
            line.marks.push((position, fill));
            if point.error.count > 1 {
                let [low, high] =
                    [point.error.least, point.error.largest].map(|error| self.axes.inside(error));
                line.bars.push([position[0], low, high]);
            }
            // The first line says which mesh each of its points has.
            let value =
                member.configuration.iter().find(|(name, _)| Some(name.as_str()) == parameter);
            if let (0, Some((_, value @ (Value::Integer(_) | Value::Number(_))))) = (number, value)
            {
                line.texts.push((position, value.short()));
            }
        }
        line
    }

    /// The points on the front, joined.
    fn front(&self, errors: &Errors) -> Line {
        let mut line = Line::new(FRONT);
        let on_front = |index: &usize| {
            errors.points[*index].as_ref().is_some_and(|point| point.on_front(self.cost))
        };
        let members = (0..self.diagram.members.len()).filter(on_front);
        let mut piece: Vec<[f64; 2]> =
            members.filter_map(|index| self.position(errors, index)).collect();
        piece.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if piece.len() > 1 {
            line.pieces.push(piece);
        }
        line
    }

    /// The points of a peer in the panel of a quantity.
    pub(super) fn peer(&self, peer: &Peer, errors: &Errors) -> Option<Line> {
        let value = errors.reference.as_ref()?.value?;
        let [low, high] = peer.difference(&errors.quantity.name, value)?;
        let mut line = Line::new(PEER);
        let [low, high] = [low, high].map(|difference| self.axes.inside(difference));
        for point in peer.points(self.diagram) {
            let [least, largest] = point.seconds;
            line.pieces.push(vec![[least, high], [largest, high]]);
            let middle = (least * largest).sqrt();
            line.marks.push(([middle, high], Fill::Open));
            line.bars.push([middle, low, high]);
        }
        (!line.marks.is_empty()).then_some(line)
    }

    /// The legend of the lines.
    pub(super) fn legend(&self) -> Legend {
        let usual = self.diagram.usual();
        let entry = |(number, (chain, new)): (usize, &(Option<usize>, Vec<usize>))| {
            let first = &self.diagram.members[new[0]].configuration;
            let parameter = chain.map(|chain| self.diagram.chains[chain].parameter.clone());
            let varied: Vec<(String, Value)> = first
                .iter()
                .filter(|(name, _)| Some(name) == parameter.as_ref())
                .cloned()
                .collect();
            let text = label(first, &[usual.clone(), varied].concat());
            let over = parameter.map(|name| words(&name));
            let text = match (text.as_str(), over) {
                (_, None) => text,
                ("", Some(over)) => format!("over {over}"),
                (_, Some(over)) => format!("{text}, over {over}"),
            };
            (Sample::Line(series(number)), text)
        };
        let entries = self.lines.iter().enumerate().map(entry).collect();
        Legend { heading: String::new(), entries }
    }
}
