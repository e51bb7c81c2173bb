//! All angles of a panel (Eqs. 3-14).

/// The angles of one panel, rad; the same in every storey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PanelAngles {
    /// ∠KAD, from the radial line to AD.
    pub phi: f64,
    /// ∠EAB.
    pub alpha1: f64,
    /// ∠DEA.
    pub alpha2: f64,
    /// ∠DAE.
    pub beta1: f64,
    /// ∠AEB.
    pub beta2: f64,
    /// Sector angle at an outer vertex between AD and the ring line behind it.
    pub gamma1: f64,
    /// Sector angle at an inner vertex between EB and the ring line ahead of it.
    pub gamma2: f64,
    /// Panel's share of the developed sector.
    pub theta1: f64,
    /// Turn of the inner ring against the outer, developed.
    pub theta2: f64,
    /// ρ, `R_inner`/`R_outer`.
    pub ring_ratio: f64,
}
