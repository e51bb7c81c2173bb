//! What billow costs: what `billow bench` measures, on this machine, in this run.
//!
//! ```text
//! cost = wall time / (steps × elements)        ns per element and step
//! ```
//!
//! The paper's capsule under 5 g/s ([`capsule`]), in three states: stowed, rising, at the end of its
//! way. Stage by stage ([`stages`]), the whole way ([`capsule::Case`]), film alone beside a plain
//! scalar reference ([`kernels`]), many jobs ([`jobs`]), the machine itself ([`machine`]); and what is
//! asked of all that ([`targets`]). Speed is a figure: no target that is missed is an error.

use billow_solver::platform::simd::InstructionSet;

use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::platform::stop::Stop;

pub mod capsule;
pub mod clock;
pub mod jobs;
pub mod kernels;
pub mod machine;
pub mod stages;
pub mod targets;

use capsule::{Capsule, Case, Mark};
use jobs::JobsRow;
use kernels::KernelRow;
use machine::Machine;
use stages::StageRow;
use targets::Target;

/// A row: names and values.
pub type Line = Vec<(&'static str, Value)>;

/// Name of the state at time 0.
pub const STOWED: &str = "stowed";
/// Time of the state on the way up, s.
pub const RISING: f64 = 0.03;
/// Time to which meshes of every size are run, s: the growth of the cost is told of it.
pub const EARLY: f64 = 0.005;
/// Wall time of a way that is gone more than once, s: at most this.
const BRIEF: f64 = 0.5;
/// Times a case is told at, s.
const CASES: [f64; 4] = [EARLY, 0.1, 0.3, 1.5];
/// Meshes timed unless others are asked for: n.
const MESHES: [u32; 4] = [5, 8, 16, 32];
/// The same where it is to be quick.
const QUICK_MESHES: [u32; 1] = [5];
/// Largest mesh whose kernels are timed and which is run beyond [`EARLY`]: n.
pub const LARGEST_RUN: u32 = 16;

/// What is told of a bench that a signal ends.
const INTERRUPTED: &str = "no figure is kept";

/// A part of the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// What the machine can do.
    Machine,
    /// Film alone, beside the scalar reference.
    Kernels,
    /// Each stage of a step, in three states.
    Stages,
    /// Whole runs.
    Cases,
    /// A study of 64 jobs.
    Jobs,
}

impl Part {
    /// Every part, in the order they are run.
    pub const ALL: [Self; 5] =
        [Self::Machine, Self::Kernels, Self::Stages, Self::Cases, Self::Jobs];
}

/// How long it may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Seconds: n 5 for a short way.
    Quick,
    /// Minutes.
    Usual,
    /// With the whole cases.
    Full,
}

impl Effort {
    /// Name, as in JSON.
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

    /// How far a mesh is run, s: as far as it goes in a bearable time.
    fn reach(self, subdivisions: u32) -> f64 {
        match (self, subdivisions) {
            (Self::Quick, n) if n > LARGEST_RUN => 0.0,
            (Self::Quick, _) => 0.05,
            (_, n) if n > LARGEST_RUN => EARLY,
            (Self::Usual, 0..=8) | (Self::Full, 9..) => 0.3,
            (Self::Usual, _) => 0.1,
            (Self::Full, _) => 1.5,
        }
    }

    /// Where a run is looked at.
    fn marks(self, subdivisions: u32) -> Vec<Mark> {
        let reach = self.reach(subdivisions);
        let mut marks = vec![Mark { time: 0.0, state: Some(STOWED), case: false }];
        let case = |time| Mark { time, state: None, case: true };
        let early = CASES.into_iter().filter(|time| *time < reach && self != Self::Quick);
        marks.extend(early.map(case));
        if subdivisions <= LARGEST_RUN {
            marks.push(Mark { time: RISING, state: Some("rising"), case: false });
            marks.push(Mark { time: reach, state: Some("end"), case: true });
        } else if reach > 0.0 {
            marks.push(case(reach));
        }
        marks.sort_by(|one, other| one.time.total_cmp(&other.time));
        marks
    }
}

/// What to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Which parts.
    pub parts: Vec<Part>,
    /// Which meshes, n; the usual ones where none is named.
    pub subdivisions: Vec<u32>,
    /// How long it may take.
    pub effort: Effort,
    /// Instruction set.
    pub path: InstructionSet,
}

impl Plan {
    /// The meshes to time, rising.
    fn meshes(&self) -> Vec<u32> {
        let mut meshes = match (self.subdivisions.as_slice(), self.effort) {
            ([], Effort::Quick) => QUICK_MESHES.to_vec(),
            ([], _) => MESHES.to_vec(),
            (asked, _) => asked.to_vec(),
        };
        meshes.sort_unstable();
        meshes.dedup();
        meshes
    }
}

/// What was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// How long it was allowed to take.
    pub effort: Effort,
    /// The machine.
    pub machine: Machine,
    /// Film alone.
    pub kernels: Vec<KernelRow>,
    /// Stages of a step.
    pub stages: Vec<StageRow>,
    /// Whole runs.
    pub cases: Vec<Case>,
    /// Many jobs.
    pub jobs: Vec<JobsRow>,
}

impl Report {
    /// Before anything is measured.
    pub fn empty(effort: Effort, path: InstructionSet) -> Self {
        Self {
            effort,
            machine: Machine::named(path),
            kernels: Vec::new(),
            stages: Vec::new(),
            cases: Vec::new(),
            jobs: Vec::new(),
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

    /// Least share of its wall time that a run was on a core; `None` where nothing says.
    pub fn least_core_share(&self) -> Option<f64> {
        let stages = self.stages.iter().filter_map(|row| row.core_share);
        stages.chain(self.cases.iter().filter_map(Case::core_share)).reduce(f64::min)
    }

    /// Names of the targets nothing was measured of.
    pub fn not_measured(&self) -> Vec<&'static str> {
        let open = |target: &Target| target.measured.is_none().then_some(target.name);
        self.targets().iter().filter_map(open).collect()
    }
}

/// Measures; `tell` hears what comes next.
///
/// # Errors
/// A run that stops short, a disk that fails, a signal.
pub fn run(plan: &Plan, stop: &Stop, tell: &mut dyn FnMut(&str)) -> Result<Report> {
    let mut report = Report::empty(plan.effort, plan.path);
    let has = |part: Part| plan.parts.contains(&part);
    if has(Part::Machine) {
        tell("machine");
        report.machine.measure(plan.effort, stop)?;
    }
    let meshes = plan.meshes();
    for n in &meshes {
        if has(Part::Kernels) && *n <= LARGEST_RUN {
            tell(&format!("kernels, n {n}"));
            report.kernels.extend(kernels::measure(*n, plan.path, plan.effort, stop)?);
        }
    }
    for n in &meshes {
        if has(Part::Stages) || has(Part::Cases) {
            capsule_of(*n, plan, stop, tell, &mut report)?;
        }
    }
    if has(Part::Jobs) {
        for threads in jobs::THREADS {
            tell(&format!("64 jobs, threads {threads}"));
            report.jobs.push(jobs::measure(threads, plan.path, plan.effort, stop)?);
        }
    }
    report.machine.peak_memory = machine::peak_memory();
    Ok(report)
}

/// The run of one mesh, and the stages from its states on.
fn capsule_of(
    subdivisions: u32,
    plan: &Plan,
    stop: &Stop,
    tell: &mut dyn FnMut(&str),
    report: &mut Report,
) -> Result<()> {
    let marks = plan.effort.marks(subdivisions);
    let reach = marks.last().map_or(0.0, |mark| mark.time);
    if reach > 0.0 {
        tell(&format!("run, n {subdivisions}, {reach} s"));
    }
    let capsule = Capsule::new(subdivisions, plan.path)?;
    let (states, cases) = capsule::travel(&capsule, &marks, stop)?;
    if plan.parts.contains(&Part::Cases) {
        for case in cases {
            report.cases.push(least(case, &capsule, plan.effort, stop)?);
        }
    }
    if !plan.parts.contains(&Part::Stages) {
        return Ok(());
    }
    for state in &states {
        tell(&format!("stages, n {subdivisions}, {}", state.name));
        report.stages.push(stages::measure(&capsule, state, plan.effort, stop)?);
    }
    Ok(())
}

/// A way so short that a moment of somebody else's shows in it is gone again from the start, and the
/// least kept.
fn least(mut case: Case, capsule: &Capsule, effort: Effort, stop: &Stop) -> Result<Case> {
    let way = [Mark { time: case.end_time, state: None, case: true }];
    for _ in 1..effort.repeats() {
        if case.wall_seconds > BRIEF {
            break;
        }
        for again in capsule::travel(capsule, &way, stop)?.1 {
            if again.wall_seconds < case.wall_seconds {
                case = again;
            }
        }
    }
    Ok(case)
}

/// Whether a signal ends the bench.
fn interrupted(stop: &Stop) -> Result<()> {
    stop.requested()
        .map_or(Ok(()), |signal| Err(Error::Interrupted { signal, next: INTERRUPTED.to_owned() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_rise_and_the_whole_cases_are_of_a_full_bench_only() {
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
            path: InstructionSet::detect(),
        };
        let error = run(&plan, &stop, &mut |_| ()).expect_err("a signal came");
        assert!(matches!(error, Error::Interrupted { signal: 2, .. }), "{error}");
    }
}
