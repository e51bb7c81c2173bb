//! The table of columns: one entry per column of a row.
//!
//! Everything else follows from this table: the row of a job, the summary table and its Parquet
//! metadata, `billow job --all`, the better side in `billow compare`, and
//! docs/reference/columns.md. CONTRIBUTING.md says how to add one. The entry takes its value
//! from a [`JobEnd`]: from the history, the tracks, or a field of
//! [`billow_solver::output::measures::Measures`], which the solver computes.
//!
//! In the summary table, the job id and the parameters of the study stand before these columns.

use std::collections::HashMap;
use std::sync::LazyLock;

use billow_solver::models::film::FILM_STRESS_99;
use billow_solver::models::run::FILM_SPEED;
use billow_solver::output::measures::Verdict;

use super::job_end::{JobEnd, integer};
use crate::input::value::Value;
use crate::platform::provenance;

/// Name, type, unit, meaning and source of a column.
#[derive(Debug, Clone, Copy)]
pub struct RowColumn {
    /// Identifier in the code.
    pub id: ColumnId,
    /// Name in the table.
    pub name: &'static str,
    /// Type of its cells. Any cell may be null.
    pub cell_type: CellType,
    /// SI unit; "1" for a dimensionless number, empty for text and true/false.
    pub unit: &'static str,
    /// Part of a row that it belongs to.
    pub group: ColumnGroup,
    /// Which of two values is the better one.
    pub better: BetterSide,
    /// Whether a value can be negative or zero: values are then compared by their difference, not by
    /// their ratio.
    pub signed: bool,
    /// Meaning, one line.
    pub meaning: &'static str,
    /// Takes the cell from a job that ended.
    pub take: fn(&JobEnd<'_>) -> Value,
}

/// Type of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellType {
    /// True or false.
    Bool,
    /// Whole number.
    Integer,
    /// Number.
    Number,
    /// Text.
    Text,
}

impl CellType {
    /// Name for documents and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bool => "true or false",
            Self::Integer => "whole number",
            Self::Number => "number",
            Self::Text => "text",
        }
    }
}

/// Part of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnGroup {
    /// How the job ended.
    Outcome,
    /// What the run measured.
    Measures,
    /// How far the run can be trusted.
    Audit,
    /// The solved fold pattern.
    Pattern,
    /// What the run took.
    Cost,
    /// Which program computed it.
    Provenance,
}

impl ColumnGroup {
    /// Name, as the reference of the columns has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outcome => "outcome",
            Self::Measures => "measures",
            Self::Audit => "audit",
            Self::Pattern => "pattern",
            Self::Cost => "cost",
            Self::Provenance => "provenance",
        }
    }
}

/// Which of two values of a column is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BetterSide {
    /// The smaller one: sooner, or a lower load.
    Smaller,
    /// The larger one.
    Larger,
    /// Neither: the values are only different.
    Neither,
}

/// Whether the word `Signed` stands in a row of the table.
macro_rules! is_signed {
    () => {
        false
    };
    (Signed) => {
        true
    };
}

macro_rules! columns {
    ($($id:ident $name:literal $type:ident [$unit:literal] $group:ident $better:ident $($signed:ident)?
       $meaning:literal $end:ident => $value:expr;)+) => {
        /// Identifies a column of [`COLUMNS`]. A wrong name does not compile.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        pub enum ColumnId {
            $(#[doc = concat!("The column `", $name, "`.")] $id),+
        }

        /// Every column after the parameters, in stored order.
        pub const COLUMNS: &[RowColumn] = &[$(RowColumn {
            id: ColumnId::$id,
            name: $name,
            cell_type: CellType::$type,
            unit: $unit,
            group: ColumnGroup::$group,
            better: BetterSide::$better,
            signed: is_signed!($($signed)?),
            meaning: $meaning,
            take: |$end| Value::from($value),
        }),+];
    };
}

// identifier, name, type, [unit], group, better side, whether it is signed; meaning; how it is taken.
columns! {
    Status "status" Text [""] Outcome Neither
        "done, infeasible, pending, or how the job failed"
        end => end.status.name();
    Verdict "verdict" Text [""] Outcome Neither
        "deployed, partial or stalled; null unless done"
        end => end.verdict().map(Verdict::name);
    NearThreshold "near_threshold" Bool [""] Outcome Neither
        "whether a change of the ratios by less than near_threshold_margin would change the verdict"
        end => end.verdict().and_then(|_| end.deployment().map(|run| run.measures.near_threshold));
    VolumeRatio "volume_ratio" Number ["1"] Outcome Larger
        "mean volume of the last tenth of the run over reference_volume"
        end => end.measure(|measures| measures.volume_ratio);
    HeightRatio "height_ratio" Number ["1"] Outcome Larger
        "least z_rim (of film without rings: height) of the last tenth of the run over reference_height"
        end => end.measure(|measures| measures.height_ratio);
    T50ZRim "t_50_z_rim" Number ["s"] Measures Smaller
        "first time at half of design_height that holds 5 ms"
        end => end.measure(|measures| measures.t_50_z_rim);
    T90ZRim "t_90_z_rim" Number ["s"] Measures Smaller
        "first time at which the smoothed z_rim reaches nine tenths of design_height"
        end => end.measure(|measures| measures.t_90_z_rim);
    T50Volume "t_50_volume" Number ["s"] Measures Smaller
        "first time at half of design_volume that holds 5 ms"
        end => end.measure(|measures| measures.t_50_volume);
    T90Volume "t_90_volume" Number ["s"] Measures Smaller
        "first time at which the smoothed volume reaches nine tenths of design_volume"
        end => end.measure(|measures| measures.t_90_volume);
    TDeployed "t_deployed" Number ["s"] Measures Smaller
        "first time at which smoothed volume and z_rim are at both deployed thresholds; of film without rings the volume"
        end => end.measure(|measures| measures.t_deployed);
    T50ZRimSinceRelease "t_50_z_rim_since_release" Number ["s"] Measures Smaller
        "t_50_z_rim minus the time at which the lid is released; equal to t_50_z_rim without a lid"
        end => end.since_release(|measures| measures.t_50_z_rim);
    T90ZRimSinceRelease "t_90_z_rim_since_release" Number ["s"] Measures Smaller
        "t_90_z_rim minus the time at which the lid is released; equal to t_90_z_rim without a lid"
        end => end.since_release(|measures| measures.t_90_z_rim);
    T50VolumeSinceRelease "t_50_volume_since_release" Number ["s"] Measures Smaller
        "t_50_volume minus the time at which the lid is released; equal to t_50_volume without a lid"
        end => end.since_release(|measures| measures.t_50_volume);
    T90VolumeSinceRelease "t_90_volume_since_release" Number ["s"] Measures Smaller
        "t_90_volume minus the time at which the lid is released; equal to t_90_volume without a lid"
        end => end.since_release(|measures| measures.t_90_volume);
    TDeployedSinceRelease "t_deployed_since_release" Number ["s"] Measures Smaller
        "t_deployed minus the time at which the lid is released; equal to t_deployed without a lid"
        end => end.since_release(|measures| measures.t_deployed);
    PeakSpeed "peak_speed" Number ["m/s"] Measures Smaller
        "largest speed of the top ring, up or down: mean over 5 ms"
        end => end.measure(|measures| measures.peak_speed);
    PeakAcceleration "peak_acceleration" Number ["m/s2"] Measures Smaller
        "largest acceleration of the top ring, up or down: change of its mean speed from 5 ms to the next, over 5 ms"
        end => end.measure(|measures| measures.peak_acceleration);
    PeakFilmSpeed "peak_film_speed" Number ["m/s"] Measures Smaller
        "largest speed of any node of the film: mean over 5 ms; null for the model piston, and for film that rests or a run below 5 ms"
        end => end.largest(FILM_SPEED.0).map(|[speed, _]| speed).filter(|speed| *speed > 0.0);
    PeakBaseForce "peak_base_force" Number ["N"] Measures Smaller
        "largest force along z of the film on what holds it (supports, lid, floor together), up or down: mean over 5 ms"
        end => end.measure(|measures| measures.peak_base_force);
    PeakVz "peak_vz" Number ["m/s"] Measures Smaller
        "largest upward velocity of the top ring: mean of its nodes along z"
        end => end.measure(|measures| measures.peak_vz);
    PeakDownwardVz "peak_downward_vz" Number ["m/s"] Measures Smaller
        "largest downward velocity of the top ring: minus the least mean of its nodes along z"
        end => end.measure(|measures| measures.peak_downward_vz);
    TPeakVz "t_peak_vz" Number ["s"] Measures Neither
        "time of peak_vz"
        end => end.measure(|measures| measures.t_peak_vz);
    PeakKineticEnergy "peak_kinetic_energy" Number ["J"] Measures Smaller
        "largest kinetic energy of the film"
        end => end.measure(|measures| measures.peak_kinetic_energy);
    FirstPeakZRim "first_peak_z_rim" Number ["m"] Measures Neither
        "z_rim at its first peak"
        end => end.measure(|measures| measures.first_peak_z_rim);
    FirstMinimumZRim "first_minimum_z_rim" Number ["m"] Measures Neither
        "z_rim at the first minimum after its first peak"
        end => end.measure(|measures| measures.first_minimum_z_rim);
    Overshoot "overshoot" Number ["1"] Measures Smaller Signed
        "largest z_rim (of film without rings: height) over reference_height, minus 1"
        end => end.measure(|measures| measures.overshoot);
    RingingRms "ringing_rms" Number ["m/s"] Measures Smaller
        "root mean square of vz over 0.2 s after t_deployed"
        end => end.measure(|measures| measures.ringing_rms);
    RingingFrequency "ringing_frequency" Number ["Hz"] Measures Neither
        "largest spectral line of vz over 0.2 s after t_deployed"
        end => end.measure(|measures| measures.ringing_frequency);
    TSettled "t_settled" Number ["s"] Measures Smaller
        "first time from which the kinetic energy stays below 1e-4 of its peak for 50 ms"
        end => end.measure(|measures| measures.t_settled);
    LargestZRim "largest_z_rim" Number ["m"] Measures Neither
        "largest z_rim"
        end => end.measure(|measures| measures.largest_z_rim);
    LowestZRim "lowest_z_rim" Number ["m"] Measures Neither
        "least z_rim after its first peak: how far it falls back"
        end => end.measure(|measures| measures.lowest_z_rim);
    FinalZRim "final_z_rim" Number ["m"] Measures Neither
        "last mean height of the top ring"
        end => end.measure(|measures| measures.final_z_rim);
    LargestHeight "largest_height" Number ["m"] Measures Neither
        "largest height of film without rings, from its lowest to its highest node"
        end => end.measure(|measures| measures.largest_height);
    FinalHeight "final_height" Number ["m"] Measures Neither
        "last height of film without rings"
        end => end.measure(|measures| measures.final_height);
    FinalVolume "final_volume" Number ["m3"] Measures Neither
        "last volume"
        end => end.measure(|measures| measures.final_volume);
    PeakPressure "peak_pressure" Number ["Pa"] Measures Smaller
        "largest gas pressure"
        end => end.measure(|measures| measures.peak_pressure);
    FinalPressure "final_pressure" Number ["Pa"] Measures Neither
        "last gas pressure"
        end => end.measure(|measures| measures.final_pressure);
    FinalTemperature "final_temperature" Number ["K"] Measures Neither
        "last gas temperature"
        end => end.measure(|measures| measures.final_temperature);
    VentedMass "vented_mass" Number ["kg"] Measures Neither
        "gas that left through leak and vent by the end; negative where gas entered there"
        end => end.measure(|measures| measures.vented_mass);
    FilmStress "film_stress" Number ["Pa"] Measures Smaller
        "largest principal second Piola-Kirchhoff stress of the film"
        end => end.measure(|measures| measures.film_stress);
    FilmStress99 "film_stress_99" Number ["Pa"] Measures Smaller
        "largest value over the samples of the stress that 99 % of the film's area does not exceed"
        end => end.largest(FILM_STRESS_99.0).map(|[stress, _]| stress);
    TFilmStress99 "t_film_stress_99" Number ["s"] Measures Neither
        "time of film_stress_99"
        end => end.largest(FILM_STRESS_99.0).map(|[_, time]| time);
    PeakLidForce "peak_lid_force" Number ["N"] Measures Smaller
        "largest force on the packing lid"
        end => end.measure(|measures| measures.peak_lid_force);
    Passages "passages" Integer ["1"] Audit Neither
        "passages of film through film in the whole run; null for a model without contact"
        end => end.audit(|audit| audit.passages).flatten().map(integer);
    Intersections "intersections" Integer ["1"] Audit Neither
        "intersections at the sample with the most; null for a model without contact"
        end => end.audit(|audit| audit.intersections).flatten().map(integer);
    InterlayerPressure "interlayer_pressure" Number ["Pa"] Measures Smaller
        "largest pressure of film on film at a sample; null for a model without contact"
        end => end.extreme("interlayer_pressure", f64::max);
    ContactAreaFraction "contact_area_fraction" Number ["1"] Measures Neither
        "largest fraction of the film's area in contact at a sample; null for a model without contact"
        end => end.extreme("contact_area_fraction", f64::max);
    SmallestGap "smallest_gap" Number ["m"] Measures Neither
        "smallest distance of film from film at a sample, at most the contact distance; null for a model without contact"
        end => end.extreme("smallest_gap", f64::min);
    LedgerResidual "ledger_residual" Number ["1"] Audit Neither
        "largest energy ledger residual"
        end => end.audit(|audit| audit.ledger_residual);
    GasResidual "gas_residual" Number ["1"] Audit Neither
        "largest gas balance residual"
        end => end.audit(|audit| audit.gas_residual);
    MaterialLossFraction "material_loss_fraction" Number ["1"] Audit Neither
        "energy lost in the film's material over the work of the gas"
        end => end.audit(|audit| audit.material_loss_fraction);
    NumericalFraction "numerical_fraction" Number ["1"] Audit Neither Signed
        "numerical dissipation over the work of the gas until the first peak of z_rim (of film without rings: of the kinetic energy)"
        end => end.audit(|audit| audit.numerical_fraction);
    NumericallyDamped "numerically_damped" Bool [""] Audit Neither
        "whether numerical_fraction is above 0.05: kinetic energies and rebounds are damped by the numerics"
        end => end.audit(billow_solver::output::audit::Audit::numerically_damped);
    FinalOverpressure "final_overpressure" Number ["Pa"] Measures Neither
        "mean of gas pressure minus ambient pressure over the last tenth of the run"
        end => end.measure(|measures| measures.final_overpressure);
    ReferenceOverpressure "reference_overpressure" Number ["Pa"] Outcome Neither
        "overpressure of the static equilibrium of the verdict: final_overpressure, or the lowest one computed if that is higher"
        end => end.measure(|measures| measures.reference.map(|shape| shape.overpressure));
    ReferenceVolume "reference_volume" Number ["m3"] Outcome Neither
        "volume of the static equilibrium at reference_overpressure"
        end => end.measure(|measures| measures.reference.map(|shape| shape.volume));
    ReferenceHeight "reference_height" Number ["m"] Outcome Neither
        "z_rim of the static equilibrium at reference_overpressure"
        end => end.measure(|measures| measures.reference.map(|shape| shape.height));
    DesignVolume "design_volume" Number ["m3"] Outcome Neither
        "volume of the static equilibrium at p r/(E t) = 1e-4, r mean radius"
        end => end.measure(|measures| measures.design_volume);
    DesignHeight "design_height" Number ["m"] Outcome Neither
        "z_rim of the static equilibrium at p r/(E t) = 1e-4, r mean radius"
        end => end.measure(|measures| measures.design_height);
    DeployedVolumeThreshold "deployed_volume_threshold" Number ["1"] Outcome Neither
        "V/V_ref that a deployed run keeps throughout its last tenth"
        end => end.threshold(|thresholds| thresholds.deployed_volume);
    DeployedHeightThreshold "deployed_height_threshold" Number ["1"] Outcome Neither
        "z_rim/H_ref that a deployed run keeps throughout its last tenth"
        end => end.threshold(|thresholds| thresholds.deployed_height);
    StalledVolumeThreshold "stalled_volume_threshold" Number ["1"] Outcome Neither
        "volume_ratio below which a run is stalled"
        end => end.threshold(|thresholds| thresholds.stalled_volume);
    NearThresholdMargin "near_threshold_margin" Number ["1"] Outcome Neither
        "change of the ratios up to which a verdict is near a threshold"
        end => end.threshold(|thresholds| thresholds.near_threshold_margin);
    Phi "phi" Number ["rad"] Pattern Neither
        "angle KAD of the solved pattern"
        end => end.pattern(|pattern| pattern.angles.phi);
    HalfAngle "half_angle" Number ["rad"] Pattern Neither Signed
        "half top angle of the solved pattern"
        end => end.pattern(|pattern| pattern.half_angle);
    TopRadius "top_radius" Number ["m"] Pattern Neither
        "radius of the top ring of the solved pattern"
        end => end.pattern(|pattern| pattern.top_radius);
    Height "height" Number ["m"] Pattern Neither
        "height of the solved pattern, erected"
        end => end.pattern(|pattern| pattern.height);
    Reason "reason" Text [""] Outcome Neither
        "why the point is infeasible, the job has no result, or a done job has no verdict"
        end => end.reason();
    Nearest "nearest" Text [""] Outcome Neither
        "nearest feasible values (SI), each for a change of that key alone"
        _end => None::<String>;
    StopTime "stop_time" Number ["s"] Outcome Neither
        "simulated time at which a failed run stopped"
        end => end.failure().map(|failure| failure.time);
    StopLocation "stop_location" Text [""] Outcome Neither
        "element, node or part of the model at which a failed run stopped"
        end => end.failure().map(|failure| failure.place.as_str());
    StopAudit "stop_audit" Text [""] Outcome Neither
        "audit that ended a failed run: finite_motion, energy_source, energy_ledger, …"
        end => end.failure().map(|failure| failure.audit.name());
    Steps "steps" Integer ["1"] Cost Neither
        "accepted steps"
        end => end.deployment().map(|run| integer(run.steps));
    Elements "elements" Integer ["1"] Cost Neither
        "elements of the mesh; 0 for a model without a mesh"
        end => end.deployment().map(|run| integer(run.elements as u64));
    ContentHash "content_hash" Text [""] Provenance Neither
        "SHA-256 of names, lengths and values of history and frames"
        end => end.content_hash.map(str::to_owned);
    WallSeconds "wall_seconds" Number ["s"] Cost Neither
        "wall time of the job without its static equilibria; of a resumed job, since it was resumed"
        end => end.seconds();
    TimePerZoneCycle "time_per_zone_cycle" Number ["ns"] Cost Neither
        "wall time over elements and steps, of all that a step takes with its audit; null without elements"
        end => end.time_per_zone_cycle();
    ProgramVersion "program_version" Text [""] Provenance Neither
        "version of the program that ran the job"
        _end => provenance::PROGRAM_VERSION;
    Commit "commit" Text [""] Provenance Neither
        "commit of the program that ran the job"
        _end => provenance::COMMIT;
    PhysicsVersion "physics_version" Integer ["1"] Provenance Neither
        "version of the physics, part of the job id"
        _end => i64::from(provenance::PHYSICS_VERSION);
}

impl ColumnId {
    /// The entry of this column.
    pub fn column(self) -> &'static RowColumn {
        &COLUMNS[self.index()]
    }

    /// Index in [`COLUMNS`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// Name in the table.
    pub fn name(self) -> &'static str {
        self.column().name
    }

    /// Whether its values can be negative or zero.
    pub fn is_signed(self) -> bool {
        self.column().signed
    }

    /// The column with that name.
    pub fn from_name(name: &str) -> Option<Self> {
        static NAMES: LazyLock<HashMap<&str, ColumnId>> =
            LazyLock::new(|| COLUMNS.iter().map(|column| (column.name, column.id)).collect());
        NAMES.get(name).copied()
    }
}
