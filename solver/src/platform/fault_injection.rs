//! Deliberate faults, for the tests that ask whether the ledger or a case would notice one.
//!
//! A fault multiplies one term of the equations by a factor: 1.01, or −1 for a lost sign. Nothing but
//! tests sets one; without it no term is touched.

/// One fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault {
    /// Which term.
    pub term: Term,
    /// What it is multiplied by.
    pub factor: f64,
}

/// The terms a fault can touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Term {
    /// Elastic force of the film.
    Elastic,
    /// Viscous force of the film.
    Viscous,
    /// Work the viscosity takes, as the ledger hears of it.
    ViscousWork,
    /// ∂V/∂x: the force of pressure on the film.
    PressureForce,
    /// The enclosed volume.
    Volume,
    /// Weight.
    Gravity,
    /// Force of the ambient pressure.
    Ambient,
    /// What a force gives to a velocity.
    Kick,
    /// What a velocity gives to a place.
    Drift,
    /// Mass damping.
    MassDamping,
    /// Force on a rigid plane.
    PlaneForce,
    /// The film's stiffness E/(1−ν²), in stress and energy alike.
    PlaneModulus,
    /// Young's modulus where film is wrinkled, in stress and energy alike.
    WrinkledModulus,
    /// Poisson's coupling of the two principal directions.
    PoissonRatio,
    /// Mass of the film.
    Mass,
    /// Work the gas does, in its own balance.
    GasWork,
    /// Heat from the film, in the gas's balance.
    GasHeat,
    /// Mass let in.
    GasMassIn,
    /// Enthalpy let in.
    GasEnthalpyIn,
    /// Mass leaked.
    GasMassOut,
    /// Enthalpy leaked.
    GasEnthalpyOut,
    /// p = (γ − 1) U/V.
    GasPressure,
}

impl Term {
    /// Every term.
    pub const ALL: [Self; 22] = [
        Self::Elastic,
        Self::Viscous,
        Self::ViscousWork,
        Self::PressureForce,
        Self::Volume,
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
