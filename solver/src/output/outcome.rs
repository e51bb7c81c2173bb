//! The result of a run: its history and measures, and how it ended.

use super::audit::Audit;
use super::events::Event;
use super::frames::Frames;
use super::history::{History, Track};
use super::measures::{self, Measures, Reference};
use crate::scene::timeline::Timeline;

/// The result of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Deployment {
    /// Time series, up to the end or to the moment the run stopped.
    pub history: History,
    /// Further time series: followed nodes and elements, contact, plates.
    pub tracks: Vec<Track>,
    /// Decisions of the step controller, in order of time.
    pub events: Vec<Event>,
    /// Stored shapes of the film; `None` for a model without a mesh, or if the scene asks for none.
    pub frames: Option<Frames>,
    /// Measures: single numbers computed from the history.
    pub measures: Measures,
    /// Audit: how far the history can be trusted.
    pub audit: Audit,
    /// How the run ended.
    pub stop: Stop,
    /// Accepted steps.
    pub steps: u64,
    /// Elements of the mesh; 0 for a model without a mesh.
    pub elements: usize,
}

impl Deployment {
    /// A run that was ended before its first sample.
    pub fn cancelled() -> Self {
        Self {
            history: History::new(),
            tracks: Vec::new(),
            events: Vec::new(),
            frames: None,
            measures: Measures::default(),
            audit: Audit::default(),
            stop: Stop::Cancelled,
            steps: 0,
            elements: 0,
        }
    }

    /// The values of the track of that name; empty if there is none.
    pub fn followed(&self, name: &str) -> &[f64] {
        let track = self.tracks.iter().find(|track| track.name == name);
        track.map_or(&[], |track| track.values.as_slice())
    }

    /// Compares the run with the static equilibria of its design: adds the measures that need them.
    pub fn judge(&mut self, reference: &Reference, timeline: &Timeline) {
        let film_stress = self.measures.film_stress.unwrap_or(0.0);
        let done = self.stop == Stop::Done;
        self.measures =
            measures::measure(&self.history, Some(reference), timeline, film_stress, done);
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Stop {
    /// The run reached its end time.
    Done,
    /// The observer ended the run; nothing of it is a result.
    Cancelled,
    /// The run stopped early for this reason. The job stores it as its status.
    Failed(Failure),
}

/// Why, when and where a run stopped early.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// Kind.
    pub kind: FailureKind,
    /// The audit that ended the run.
    pub audit: AuditKind,
    /// Simulated time, s.
    pub time: f64,
    /// Where: a node, an element or a part of the model, in words.
    pub place: String,
}

impl Failure {
    /// What an audit found at this time (s) and place. The kind is that of the audit.
    pub fn new(audit: AuditKind, time: f64, place: impl Into<String>) -> Self {
        Self { kind: audit.failure_kind(), audit, time, place: place.into() }
    }
}

/// The kinds of failure a run can end in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailureKind {
    /// A step was unstable: the state is not finite, or its energy grew without a source.
    Unstable,
    /// The film is stretched beyond the validity of its material model; its energy balances.
    Overstretched,
    /// The energy ledger residual is above its bound
    /// ([`MAX_LEDGER_RESIDUAL`](super::audit::MAX_LEDGER_RESIDUAL)).
    EnergyDrift,
    /// The enclosed volume is zero or negative.
    InvertedVolume,
    /// The run needs more steps than allowed, or a step is too small to advance time.
    StepLimit,
    /// Film passed through film.
    Interpenetrated,
    /// The state contradicts itself: a defect of the program or of the machine.
    Inconsistent,
}

impl FailureKind {
    /// Every kind, in the order of the documentation.
    pub const ALL: [Self; 7] = [
        Self::Unstable,
        Self::Overstretched,
        Self::EnergyDrift,
        Self::InvertedVolume,
        Self::StepLimit,
        Self::Interpenetrated,
        Self::Inconsistent,
    ];

    /// Name, as in the `status` column of the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unstable => "unstable",
            Self::Overstretched => "overstretched",
            Self::EnergyDrift => "energy_drift",
            Self::InvertedVolume => "inverted_volume",
            Self::StepLimit => "step_limit",
            Self::Interpenetrated => "interpenetrated",
            Self::Inconsistent => "inconsistent",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// An audit. Each ends a run when what it checks is out of its bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AuditKind {
    /// Positions and volume are finite, and no node moves farther than the size of the film in a step.
    FiniteMotion,
    /// No energy comes without a source.
    EnergySource,
    /// The film is stretched within the validity of its material model.
    Stretch,
    /// The energy ledger of the film closes.
    EnergyLedger,
    /// Mass and energy of the gas add up.
    GasBalance,
    /// The gas volume is above zero.
    Volume,
    /// The run has steps, and a step that advances time.
    StepLimit,
    /// Nodes move as the velocities of the method say.
    Motion,
    /// Nodes keep their masses.
    Mass,
    /// Volume, pressure and the force of the pressure are those of positions and gas.
    Pressure,
    /// Contact forces are the derivative of the energy of the contacts.
    Contact,
    /// No film passes through film.
    Passages,
    /// No film is in film at a sample.
    Intersections,
}

impl AuditKind {
    /// Every audit, in the order of the documentation.
    pub const ALL: [Self; 13] = [
        Self::FiniteMotion,
        Self::EnergySource,
        Self::Stretch,
        Self::EnergyLedger,
        Self::GasBalance,
        Self::Volume,
        Self::StepLimit,
        Self::Motion,
        Self::Mass,
        Self::Pressure,
        Self::Contact,
        Self::Passages,
        Self::Intersections,
    ];

    /// Name, as in maps of stability.
    pub fn name(self) -> &'static str {
        match self {
            Self::FiniteMotion => "finite_motion",
            Self::EnergySource => "energy_source",
            Self::Stretch => "stretch",
            Self::EnergyLedger => "energy_ledger",
            Self::GasBalance => "gas_balance",
            Self::Volume => "volume",
            Self::StepLimit => "step_limit",
            Self::Motion => "motion",
            Self::Mass => "mass",
            Self::Pressure => "pressure",
            Self::Contact => "contact",
            Self::Passages => "passages",
            Self::Intersections => "intersections",
        }
    }

    /// The kind of failure that it reports. [`Self::Stretch`] reports [`FailureKind::Unstable`] where the
    /// energy does not balance.
    pub fn failure_kind(self) -> FailureKind {
        match self {
            Self::FiniteMotion | Self::EnergySource => FailureKind::Unstable,
            Self::Stretch => FailureKind::Overstretched,
            Self::EnergyLedger => FailureKind::EnergyDrift,
            Self::Volume => FailureKind::InvertedVolume,
            Self::StepLimit => FailureKind::StepLimit,
            Self::GasBalance | Self::Motion | Self::Mass | Self::Pressure | Self::Contact => {
                FailureKind::Inconsistent
            }
            Self::Passages | Self::Intersections => FailureKind::Interpenetrated,
        }
    }
}
