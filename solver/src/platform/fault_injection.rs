//! Fault injection, for tests only: a term of the equations is multiplied by a wrong factor, and a test
//! asks whether the energy ledger or a validation case notices.
//!
//! Factors are, for example, 1.01, or −1 for a wrong sign. Without a fault no term changes.

/// One fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault {
    /// The term that is wrong.
    pub term: Term,
    /// Factor on that term.
    pub factor: f64,
}

/// The terms a fault can change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Term {
    /// Elastic force of the film.
    Elastic,
    /// Bending force of the film, and that of any further energy.
    Bending,
    /// Energy dissipated by yielding in the energy ledger.
    YieldWork,
    /// Numerical stress of the film.
    NumericalStress,
    /// Numerical dissipation in the energy ledger.
    NumericalWork,
    /// Creep rate of the film.
    Creep,
    /// ∂V/∂x: force of the pressure on the film.
    PressureForce,
    /// Enclosed volume.
    Volume,
    /// Force of contact, of film and of plates.
    Contact,
    /// Weight.
    Gravity,
    /// Force of the ambient pressure.
    Ambient,
    /// Velocity change by the forces.
    Kick,
    /// Position change by the velocity.
    Drift,
    /// Mass damping.
    MassDamping,
    /// Force on a rigid plane.
    PlaneForce,
    /// E/(1−ν²), in stress and energy alike.
    PlaneModulus,
    /// Young's modulus of wrinkled film, in stress and energy alike.
    WrinkledModulus,
    /// Poisson's ratio.
    PoissonRatio,
    /// Mass of the film.
    Mass,
    /// Work of the gas in the gas balance.
    GasWork,
    /// Heat from the film in the gas balance.
    GasHeat,
    /// Inflow mass.
    GasMassIn,
    /// Inflow enthalpy.
    GasEnthalpyIn,
    /// Leak mass.
    GasMassOut,
    /// Leak enthalpy.
    GasEnthalpyOut,
    /// p = (γ − 1) U/V.
    GasPressure,
}

impl Term {
    /// Every term.
    pub const ALL: [Self; 26] = [
        Self::Elastic,
        Self::Bending,
        Self::YieldWork,
        Self::NumericalStress,
        Self::NumericalWork,
        Self::Creep,
        Self::PressureForce,
        Self::Volume,
        Self::Contact,
        Self::Gravity,
        Self::Ambient,
        Self::Kick,
        Self::Drift,
        Self::MassDamping,
        Self::PlaneForce,
        Self::PlaneModulus,
        Self::WrinkledModulus,
        Self::PoissonRatio,
        Self::Mass,
        Self::GasWork,
        Self::GasHeat,
        Self::GasMassIn,
        Self::GasEnthalpyIn,
        Self::GasMassOut,
        Self::GasEnthalpyOut,
        Self::GasPressure,
    ];
}
