//! The audits that can end a run, by name.

use super::failure_kind::FailureKind;

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
