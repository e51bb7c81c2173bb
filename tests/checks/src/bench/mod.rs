//! Speed of billow on this machine: the measurements of `billow-checks bench`.
//!
//! ```text
//! cost = wall time / (steps × elements)        ns per element and step
//! ```
//!
//! The paper's capsule under 5 g/s ([`capsule`]) is measured in three states: stowed, rising, at the
//! end. Parts: stages of a step ([`stages`]), whole runs ([`capsule::Case`]), the step without contact
//! and a plain scalar reference ([`kernels`]), quiet filling with `explicit` and `hybrid`
//! ([`quiet_filling`]), static equilibria ([`statics`]), the machine itself ([`machine`]). [`targets`] compares the results with the goals of the project; a missed target is not an error.

use billow_solver::platform::simd::InstructionSet;

use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::memory;
use billow_study::platform::stop::Stop;

pub mod capsule;
pub mod clock;
pub mod command;
pub mod kernels;
pub mod machine;
pub mod quiet_filling;
pub mod stages;
pub mod statics;
pub mod targets;

use capsule::{Capsule, Case, Mark};
use kernels::KernelRow;
use machine::Machine;
use quiet_filling::QuietRow;
use stages::StageRow;
use statics::StaticsRow;
use targets::Target;

/// A row: names and values.
pub type Line = Vec<(&'static str, Value)>;

/// Name of the state at time 0.
pub const STOWED: &str = "stowed";
/// Time of the state `rising`, s.
pub const RISING: f64 = 0.03;
/// Time to which meshes of every size are run, s, to compare their costs.
pub const EARLY: f64 = 0.005;
/// Longest wall time of a run that is repeated, s. Chosen.
const MAX_REPEATED_WALL_TIME: f64 = 0.5;
/// End times of the cases, s.
const CASE_END_TIMES: [f64; 4] = [EARLY, 0.1, 0.3, 1.5];
/// Default meshes, n.
const MESHES: [u32; 4] = [5, 8, 16, 32];
/// Default meshes with `--quick`, n.
const QUICK_MESHES: [u32; 1] = [5];
/// Largest mesh whose kernels are timed and which runs beyond [`EARLY`], n.
pub const LARGEST_RUN: u32 = 16;

/// Message of a bench that a signal ends.
const INTERRUPTED: &str = "no figure is kept";

/// A part of the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// Speed of the machine.
    Machine,
    /// Steps without contact, and the scalar reference.
    Kernels,
    /// Stages of a step, in three states.
    Stages,
    /// Whole runs.
    Cases,
    /// Quiet filling, explicit against hybrid.
    Hybrid,
    /// Static equilibria.
    Statics,
}

impl Part {
    /// Every part, in the order of measurement.
    pub const ALL: [Self; 6] =
        [Self::Machine, Self::Kernels, Self::Stages, Self::Cases, Self::Hybrid, Self::Statics];
}

/// Extent of a bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Seconds: n 5, short runs.
    Quick,
    /// Minutes.
    Usual,
    /// As usual, and the whole cases.
    Full,
}

impl Effort {
    /// Name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Usual => "usual",
            Self::Full => "full",
        }
    }

    fn repeats(self) -> usize {
        if self == Self::Quick { 2 } else { 3 }
    }

    fn kernel_repeats(self) -> usize {
        if self == Self::Quick { 2 } else { 7 }
    }

    fn kernel_steps(self) -> u64 {
        if self == Self::Quick { 50 } else { 200 }
    }

    /// End time of a mesh's run, s. Chosen: the run takes minutes at most.
    fn end_time(self, subdivisions: u32) -> f64 {
        match (self, subdivisions) {
            (Self::Quick, n) if n > LARGEST_RUN => 0.0,
            (Self::Quick, _) => 0.05,
            (_, n) if n > LARGEST_RUN => EARLY,
            (Self::Usual, 0..=8) | (Self::Full, 9..) => 0.3,
            (Self::Usual, _) => 0.1,
            (Self::Full, _) => 1.5,
        }
    }

    /// Times at which a run is interrupted.
    fn marks(self, subdivisions: u32) -> Vec<Mark> {
        let end_time = self.end_time(subdivisions);
        let mut marks = vec![Mark { time: 0.0, state: Some(STOWED), case: false }];
        let case = |time| Mark { time, state: None, case: true };
        let early =
            CASE_END_TIMES.into_iter().filter(|time| *time < end_time && self != Self::Quick);
        marks.extend(early.map(case));
        if subdivisions <= LARGEST_RUN {
            marks.push(Mark { time: RISING, state: Some("rising"), case: false });
            marks.push(Mark { time: end_time, state: Some("end"), case: true });
        } else if end_time > 0.0 {
            marks.push(case(end_time));
        }
        marks.sort_by(|a, b| a.time.total_cmp(&b.time));
        marks
    }
}

/// What to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Which parts.
    pub parts: Vec<Part>,
    /// Which meshes, n; empty for the default ones.
    pub subdivisions: Vec<u32>,
    /// Extent.
    pub effort: Effort,
    /// Instruction set.
    pub instruction_set: InstructionSet,
}

impl Plan {
    /// Whether a part measures anything of a mesh.
    pub fn measures(&self, part: Part, subdivisions: u32) -> bool {
        match part {
            Part::Machine | Part::Stages => true,
            Part::Kernels => subdivisions <= LARGEST_RUN,
            Part::Cases => subdivisions <= LARGEST_RUN || self.effort != Effort::Quick,
            Part::Hybrid => quiet_filling::meshes(self).contains(&subdivisions),
            Part::Statics => statics::meshes(self).contains(&subdivisions),
        }
    }

    /// The meshes to time, in ascending order.
    fn meshes(&self) -> Vec<u32> {
        let mut meshes = match (self.subdivisions.as_slice(), self.effort) {
            ([], Effort::Quick) => QUICK_MESHES.to_vec(),
            ([], _) => MESHES.to_vec(),
            (requested, _) => requested.to_vec(),
        };
        meshes.sort_unstable();
        meshes.dedup();
        meshes
    }
}

/// Results of a bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Its extent.
    pub effort: Effort,
    /// The machine.
    pub machine: Machine,
    /// Steps without contact.
    pub kernels: Vec<KernelRow>,
    /// Stages of a step.
    pub stages: Vec<StageRow>,
    /// Whole runs.
    pub cases: Vec<Case>,
    /// Quiet filling.
    pub hybrid: Vec<QuietRow>,
    /// Static equilibria.
    pub statics: Vec<StaticsRow>,
}

impl Report {
    /// A report without measurements.
    pub fn empty(effort: Effort, instruction_set: InstructionSet) -> Self {
        Self {
            effort,
            machine: Machine::named(instruction_set),
            kernels: Vec::new(),
            stages: Vec::new(),
            cases: Vec::new(),
            hybrid: Vec::new(),
            statics: Vec::new(),
        }
    }

    /// Every target.
    pub fn targets(&self) -> Vec<Target> {
        targets::of(self)
    }

    /// Whether every target was measured and met.
    pub fn targets_met(&self) -> bool {
        self.targets().iter().all(|target| target.met() == Some(true))
    }

    /// Smallest fraction of its wall time that a run was on a core; `None` if unknown.
    pub fn least_core_share(&self) -> Option<f64> {
        let stages = self.stages.iter().filter_map(|row| row.core_share);
        let cases = self.cases.iter().filter_map(Case::core_share);
        let hybrid = self.hybrid.iter().filter_map(QuietRow::core_share);
        stages.chain(cases).chain(hybrid).reduce(f64::min)
    }

    /// Names of the targets without a measurement.
    pub fn not_measured(&self) -> Vec<&'static str> {
        let unmeasured = |target: &Target| target.measured.is_none().then_some(target.name);
        self.targets().iter().filter_map(unmeasured).collect()
    }
}

/// Runs the bench; `progress` receives the name of each measurement before it starts.
///
/// # Errors
/// A failure of a run, a disk error, a signal.
pub fn run(plan: &Plan, stop: &Stop, progress: &mut dyn FnMut(&str)) -> Result<Report> {
    let mut report = Report::empty(plan.effort, plan.instruction_set);
    let has = |part: Part| plan.parts.contains(&part);
    if has(Part::Machine) {
        progress("machine");
        report.machine.measure(plan.effort, stop)?;
    }
    let meshes = plan.meshes();
    for n in &meshes {
        if has(Part::Kernels) && *n <= LARGEST_RUN {
            progress(&format!("kernels, n {n}"));
            report.kernels.extend(kernels::measure(*n, plan.instruction_set, plan.effort, stop)?);
        }
    }
    for n in &meshes {
        if has(Part::Stages) || has(Part::Cases) {
            measure_capsule(*n, plan, stop, progress, &mut report)?;
        }
    }
    let (set, effort) = (plan.instruction_set, plan.effort);
    if has(Part::Hybrid) {
        for n in quiet_filling::meshes(plan) {
            report.hybrid.extend(quiet_filling::measure(n, set, effort, stop, progress)?);
        }
    }
    if has(Part::Statics) {
        for n in statics::meshes(plan) {
            progress(&format!("static equilibria, n {n}"));
            report.statics.push(statics::measure(n, set, effort, stop)?);
        }
    }
    report.machine.peak_memory = memory::peak_resident();
    Ok(report)
}

/// Runs one mesh and times the stages from its states.
fn measure_capsule(
    subdivisions: u32,
    plan: &Plan,
    stop: &Stop,
    progress: &mut dyn FnMut(&str),
    report: &mut Report,
) -> Result<()> {
    let marks = plan.effort.marks(subdivisions);
    let end_time = marks.last().map_or(0.0, |mark| mark.time);
    if end_time > 0.0 {
        progress(&format!("run, n {subdivisions}, {end_time} s"));
    }
    let capsule = Capsule::new(subdivisions, plan.instruction_set)?;
    let (states, cases) = capsule::run_to_marks(&capsule, &marks, stop)?;
    if plan.parts.contains(&Part::Cases) {
        for case in cases {
            report.cases.push(fastest(case, &capsule, plan.effort, stop)?);
        }
    }
    if !plan.parts.contains(&Part::Stages) {
        return Ok(());
    }
    for state in &states {
        progress(&format!("stages, n {subdivisions}, {}", state.name));
        report.stages.push(stages::measure(&capsule, state, plan.effort, stop)?);
    }
    Ok(())
}

/// Repeats a short run, which other processes disturb most, and keeps the fastest.
fn fastest(mut case: Case, capsule: &Capsule, effort: Effort, stop: &Stop) -> Result<Case> {
    let mark = [Mark { time: case.end_time, state: None, case: true }];
    for _ in 1..effort.repeats() {
        if case.wall_seconds > MAX_REPEATED_WALL_TIME {
            break;
        }
        for repeat in capsule::run_to_marks(capsule, &mark, stop)?.1 {
            if repeat.wall_seconds < case.wall_seconds {
                case = repeat;
            }
        }
    }
    Ok(case)
}

/// An error if a signal ends the bench.
fn interrupted(stop: &Stop) -> Result<()> {
    stop.requested()
        .map_or(Ok(()), |signal| Err(Error::Interrupted { signal, next: INTERRUPTED.to_owned() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_ascend_and_only_a_full_bench_has_the_whole_cases() {
        for effort in [Effort::Quick, Effort::Usual, Effort::Full] {
            for n in [1, 5, 8, 16, 17, 32] {
                let marks = effort.marks(n);
                assert!(marks.windows(2).all(|pair| pair[0].time < pair[1].time), "{marks:?}");
                let times = |case| -> Vec<f64> {
                    marks.iter().filter(|mark| mark.case == case).map(|mark| mark.time).collect()
                };
                let cases = match (effort, n) {
                    (Effort::Quick, 17..) => vec![],
                    (Effort::Quick, _) => vec![0.05],
                    (_, 17..) => vec![EARLY],
                    (Effort::Usual, 16) => vec![EARLY, 0.1],
                    (Effort::Usual, _) | (Effort::Full, 16) => vec![EARLY, 0.1, 0.3],
                    (Effort::Full, _) => vec![EARLY, 0.1, 0.3, 1.5],
                };
                assert_eq!(times(true), cases);
            }
        }
    }

    #[test]
    fn a_signal_ends_the_bench() {
        let stop = Stop::new();
        stop.request(2);
        let plan = Plan {
            parts: vec![Part::Cases],
            subdivisions: vec![1],
            effort: Effort::Full,
            instruction_set: InstructionSet::detect(),
        };
        let error = run(&plan, &stop, &mut |_| ()).expect_err("a signal came");
        assert!(matches!(error, Error::Interrupted { signal: 2, .. }), "{error}");
    }
}
