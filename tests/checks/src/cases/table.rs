//! The table of reference cases.

use super::{
    Case, Outcome, Rig, Tier, contact_capsule, contact_impacts, contact_relaxed, contact_stack,
    contact_tube, damping, drum, energy_balance, forces, friction_adhesion, gas_piston, gas_vessel,
    integrators, integrators_contact, invariants, moving_fold, piston_model, sphere_motion,
    static_airbag, static_compliant, static_discs, static_end_state, static_polygon, static_shells,
    static_wrinkling, step_limit, storeys_model,
};

const fn quick(name: &'static str, compares: &'static str, body: fn(&Rig) -> Outcome) -> Case {
    Case { name, compares, tier: Tier::Quick, body }
}

const fn long(name: &'static str, compares: &'static str, body: fn(&Rig) -> Outcome) -> Case {
    Case { name, compares, tier: Tier::Long, body }
}

/// Every case, in the order of the output.
pub const CASES: &[Case] = &[
    quick(
        "tank_filling",
        "temperature of a rigid vessel filled from vacuum, with the first law",
        gas_vessel::tank_filling,
    ),
    quick(
        "blow_down",
        "temperature and pressure of a vessel emptying through a choked orifice, with the closed form",
        gas_vessel::blow_down,
    ),
    quick(
        "cooling",
        "temperature of a vessel cooled by its film, with the exponential",
        gas_vessel::cooling,
    ),
    quick(
        "gas_spring",
        "period of a plate on adiabatic gas, with a quadrature",
        gas_piston::gas_spring,
    ),
    quick(
        "injected_piston",
        "displacement of a plate driven by a constant inflow into vacuum, with the self-similar solution",
        gas_piston::injected_piston,
    ),
    quick(
        "injected_piston_dead_volume",
        "the same from rest on an empty dead volume, with a high-order integration",
        gas_piston::injected_piston_dead_volume,
    ),
    quick(
        "piston_model_tank_filling",
        "tank_filling by the piston model",
        piston_model::tank_filling,
    ),
    quick("piston_model_blow_down", "blow_down by the piston model", piston_model::blow_down),
    quick("piston_model_cooling", "cooling by the piston model", piston_model::cooling),
    quick("piston_model_gas_spring", "gas_spring by the piston model", piston_model::gas_spring),
    quick(
        "piston_model_injected",
        "injected_piston by the piston model",
        piston_model::injected_piston,
    ),
    quick(
        "piston_model_dead_volume",
        "injected_piston_dead_volume by the piston model, with the classical Runge-Kutta rule",
        piston_model::injected_piston_dead_volume,
    ),
    quick(
        "storeys_model_capsule",
        "the paper's capsule by the model storeys, with recorded film at n 8",
        storeys_model::capsule,
    ),
    quick(
        "storeys_model_similarity",
        "times of the model storeys at two flow rates, with the cube root of the rates",
        storeys_model::similarity,
    ),
    quick(
        "stretched_disc",
        "frequencies of a drum, with the zeros of Bessel functions",
        drum::stretched_disc,
    ),
    quick(
        "spinning_disc",
        "frequencies of a free disc held flat by its spin, with the closed form",
        drum::spinning_disc,
    ),
    quick(
        "breathing_sphere",
        "frequency of a sphere on adiabatic gas about its equilibrium, with its linear equation",
        sphere_motion::breathing_sphere,
    ),
    long(
        "breathing_sphere_fine",
        "breathing_sphere on meshes twice as fine",
        sphere_motion::breathing_sphere_fine,
    ),
    quick(
        "integrators_piston",
        "injected_piston with every integrator, within the error of its step",
        integrators::piston,
    ),
    quick(
        "integrators_sphere",
        "breathing_sphere with every integrator, within the error of its step",
        integrators::sphere,
    ),
    quick(
        "integrators_disc",
        "stretched_disc with every integrator, within the error of its step",
        integrators::disc,
    ),
    long(
        "released_sphere",
        "turning points of a sphere released unstretched, with a quadrature",
        sphere_motion::released_sphere,
    ),
    quick(
        "strip_damping",
        "decrement of a strip's mode under numerical damping, with 2 pi zeta omega/omega_e",
        damping::strip_decrement,
    ),
    quick(
        "strip_loss",
        "decrement of a strip's mode under material loss, with the root of its equation",
        damping::strip_loss,
    ),
    quick(
        "free_flight_damping",
        "speed of free flight under mass damping, with exp(-c t)",
        damping::free_flight,
    ),
    quick(
        "moving_fold",
        "energy of a folded strip that unrolls, median of five starts, with the inextensible string's",
        moving_fold::moving_fold,
    ),
    long("moving_fold_fine", "moving_fold on a finer mesh", moving_fold::moving_fold_fine),
    quick(
        "patch",
        "film under a uniform strain, with zero force on inner nodes",
        invariants::patch,
    ),
    quick(
        "rigid_rotation",
        "film in rigid rotation, with zero strain, force and power",
        invariants::rigid_rotation,
    ),
    quick(
        "momentum",
        "linear and angular momentum of free film and gas over 1e5 steps, with those at the start",
        invariants::momenta,
    ),
    quick(
        "force_energy",
        "every conservative force, with finite differences of its energy in each regime",
        forces::force_energy,
    ),
    quick(
        "path_energy",
        "work of film along a path through all regimes, with the change of its energy",
        forces::path_energy,
    ),
    quick(
        "dissipation",
        "power of numerical damping, with the reported power; its net force and moment, with zero",
        forces::dissipation,
    ),
    quick(
        "step_limit",
        "measured limit of the step and the element bound, with 2/omega_max of the assembled stiffness",
        step_limit::step_limit,
    ),
    quick(
        "shear_panel",
        "stress of a wrinkled panel in simple shear, with the tension field's",
        invariants::shear_panel,
    ),
    quick(
        "sphere_ledger",
        "energy of a sphere with every term of the equations, with the work done",
        energy_balance::sphere_ledger,
    ),
    quick(
        "capsule_ledger",
        "energy of the paper's capsule deployed without contact, with the work done",
        energy_balance::capsule_ledger,
    ),
    quick(
        "static_sphere",
        "stretch of a sphere in equilibrium, with the closed form",
        static_shells::sphere,
    ),
    quick(
        "static_cylinder",
        "stretches of a cylinder with closed ends, with the closed form",
        static_shells::cylinder,
    ),
    quick(
        "cone",
        "membrane forces of a cone away from its ends, with the closed form",
        static_shells::cone,
    ),
    quick(
        "clamped_disc",
        "a clamped disc under a pressure that follows it, with a boundary value problem",
        static_discs::clamped_disc,
    ),
    quick(
        "mylar_balloon",
        "two discs sewn together and inflated, with the meridian's equation",
        static_discs::mylar_balloon,
    ),
    quick(
        "compliant_disc",
        "a disc of compliant film under pressure, with an integration along its meridian",
        static_compliant::held_disc,
    ),
    quick(
        "compliant_frustum",
        "a frustum of compliant film between rings, with an integration along its meridian",
        static_compliant::held_frustum,
    ),
    quick(
        "compliant_capsule",
        "the capsule with circular caps of compliant film, with an integration along its meridian",
        static_compliant::capsule,
    ),
    quick(
        "square_airbag",
        "two squares sewn together and inflated, with another program on the same meshes",
        static_airbag::square_airbag,
    ),
    quick(
        "beam",
        "moment of a pulled and bent strip, wrinkled in part, with the closed form",
        static_wrinkling::beam,
    ),
    quick(
        "annulus_torsion",
        "torque and wrinkles of a twisted annulus, with a boundary value problem",
        static_wrinkling::annulus_torsion,
    ),
    long(
        "end_state",
        "end state of the capsule with circular caps, with the axisymmetric tension field",
        static_end_state::aligned,
    ),
    long(
        "end_state_pattern",
        "sizes of the same on the mesh of the fold pattern, whose elements lie oblique to the meridians",
        static_end_state::pattern,
    ),
    quick(
        "end_state_polygon",
        "end state of the capsule with the caps of its design, n 5, with recorded results of billow",
        static_polygon::coarse,
    ),
    quick("end_state_polygon_fine", "the same, n 8", static_polygon::fine),
    quick("end_state_polygon_finest", "the same, n 16", static_polygon::finest),
    quick(
        "stack",
        "pressure between sheets pressed flat, with the pressure on them, at three contact distances",
        contact_stack::stack_of_sheets,
    ),
    quick(
        "tube_between_plates",
        "force and section of a tube squeezed between plates, with the closed form",
        contact_tube::tube_between_plates,
    ),
    quick(
        "films_at_50_m_s",
        "two films that collide at 50 m/s: no node on the wrong side",
        contact_impacts::films_at_50_m_s,
    ),
    quick(
        "squeezed_bag",
        "a closed bag squeezed to a tenth of its height: no passage",
        contact_impacts::squeezed_bag,
    ),
    long(
        "squeezed_bag_stiff",
        "the same bag with compressive stiffness, a tenth of the tensile one and equal: no passage",
        contact_impacts::squeezed_bag_stiff,
    ),
    quick(
        "dropped_sheet",
        "a crumpled sheet thrown on a floor: no passage",
        contact_impacts::dropped_sheet,
    ),
    quick(
        "friction",
        "speed loss of a sliding film, with Coulomb's mu g t",
        friction_adhesion::friction,
    ),
    quick(
        "adhesion",
        "film pulled below and above the pull-off pressure: it adheres, it separates",
        friction_adhesion::adhesion,
    ),
    quick(
        "capsule_every_step",
        "the coarsest capsule deployed with contact, every step monitored: no passage",
        contact_capsule::capsule_every_step,
    ),
    quick(
        "integrators_every_step",
        "the coarsest capsule with explicit, implicit and hybrid, every step monitored: no passage",
        integrators_contact::coarse,
    ),
    long("integrators_every_step_fine", "the same at n 4", integrators_contact::fine),
    quick(
        "capsule_deployed",
        "the paper's capsule deployed with contact, with the ranges of other codes",
        contact_capsule::capsule_deployed,
    ),
    long(
        "capsule_deployed_fine",
        "capsule_deployed on a finer mesh",
        contact_capsule::capsule_deployed_fine,
    ),
    long(
        "contact_distance",
        "end volume of capsule_deployed, with that at half and twice the contact distance",
        contact_capsule::contact_distance,
    ),
    long(
        "deployed_equals_inflated",
        "the folded capsule deployed and relaxed, with the static equilibrium of the erected one",
        contact_relaxed::deployed_equals_inflated,
    ),
    long(
        "deployed_equals_inflated_fine",
        "the same on a finer mesh",
        contact_relaxed::deployed_equals_inflated_fine,
    ),
];
