use super::*;
use crate::output::ledger::{GasBalance, Ledger};
use crate::output::measures::StaticShape;
use crate::scene::InflowWindow;
use crate::scene::Thresholds;
use crate::scene::inflow::Schedule;

/// A model that computes nothing: it records the calls and returns a given energy.
struct Recorder {
    calls: Vec<(f64, Phase)>,
    energy: fn(f64) -> f64,
    fails_after: f64,
    /// Mass of the gas over the mass let in.
    mass_factor: f64,
}

impl Recorder {
    fn new(energy: fn(f64) -> f64) -> Self {
        Self { calls: Vec::new(), energy, fails_after: f64::INFINITY, mass_factor: 1.0 }
    }

    fn time(&self) -> f64 {
        self.calls.last().map_or(0.0, |(time, _)| *time)
    }
}

impl Model for Recorder {
    fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        _: &mut u64,
    ) -> Result<bool, Failure> {
        assert!(target > self.time(), "time increases");
        if target > self.fails_after {
            return Err(Failure::new(AuditKind::FiniteMotion, self.fails_after, "a test"));
        }
        self.calls.push((target, *phase));
        Ok(true)
    }

    fn sample(&self, _: &Phase) -> Sample {
        let (time, kinetic) = (self.time(), (self.energy)(self.time()));
        let gas_work = time;
        let ledger = Ledger { kinetic, gas_work, ..Ledger::default() };
        let mass = timeline().schedule.mass_until(time) * self.mass_factor;
        let gas =
            GasBalance { mass, internal_energy: -gas_work, gas_work, ..GasBalance::default() };
        Sample { time, volume: 1.0, z_rim: 1.0, ledger, gas, ..Sample::default() }
    }

    fn reference(&self, overpressure: f64) -> Option<Reference> {
        let shape = StaticShape { overpressure, volume: 1.0, height: 1.0 };
        Some(Reference::constant(shape))
    }

    fn film_stress(&self) -> f64 {
        0.0
    }

    fn steps(&self) -> u64 {
        self.calls.len() as u64
    }

    fn elements(&self) -> usize {
        7
    }

    fn counts_passages(&self) -> bool {
        true
    }
}

fn timeline() -> Timeline {
    let window =
        |from, to, rate| InflowWindow { from, to, mass_flow_rate: rate, temperature: 300.0 };
    Timeline {
        end_time: 1.05,
        sample_interval: 0.1,
        release_time: 0.25,
        schedule: Schedule::new(&[window(0.0, 0.5, 1.0), window(0.33, 2.0, 0.5)]),
        ambient_pressure: 0.0,
        frames: 0,
        thresholds: Thresholds::default(),
    }
}

#[test]
fn samples_are_evenly_spaced_and_breakpoints_are_reached() {
    let mut model = Recorder::new(|time| time);
    let deployment = run(&mut model, &timeline(), &mut Unobserved);
    assert_eq!(deployment.stop, Stop::Done);
    let mut samples: Vec<f64> = (0..=10).map(|k| f64::from(k) * 0.1).collect();
    samples.push(1.05);
    assert_eq!(deployment.history.column("time"), samples);

    let targets: Vec<f64> = model.calls.iter().map(|(target, _)| *target).collect();
    for expected in samples[1..].iter().chain(&[0.25, 0.33]) {
        assert!(targets.contains(expected), "{expected} {targets:?}");
    }
    for (target, phase) in &model.calls {
        assert_eq!(phase.packed, *target <= 0.25, "{target}");
        let first = if *target <= 0.5 { 1.0 } else { 0.0 };
        let second = if *target > 0.33 { 0.5 } else { 0.0 };
        assert!(
            (phase.inflow.mass_flow_rate - first - second).abs() < 1e-15,
            "{target}: {phase:?}"
        );
    }
    assert_eq!((deployment.steps, deployment.elements), (targets.len() as u64, 7));
    assert_eq!(deployment.audit.passages, Some(0));
}

#[test]
fn an_end_at_a_sample_time_is_sampled_once() {
    let exact = Timeline { end_time: 0.3, ..timeline() };
    let deployment = run(&mut Recorder::new(|time| time), &exact, &mut Unobserved);
    assert_eq!(deployment.history.len(), 4);
    assert_eq!(deployment.history.column("time")[3].to_bits(), 0.3_f64.to_bits());
}

#[test]
fn a_failed_run_keeps_its_history_and_has_no_verdict() {
    let drifting = |time: f64| if time > 0.45 { 1.1 * time } else { time };
    let cases = [
        (
            Recorder { fails_after: 0.61, ..Recorder::new(|time| time) },
            AuditKind::FiniteMotion,
            0.61,
            7,
        ),
        (
            Recorder { mass_factor: 1.0 + 1e-6, ..Recorder::new(|time| time) },
            AuditKind::GasBalance,
            0.1,
            12,
        ),
        (Recorder::new(drifting), AuditKind::EnergyLedger, 0.5, 12),
    ];
    for (mut model, audit, time, samples) in cases {
        let deployment = run(&mut model, &timeline(), &mut Unobserved);
        let Stop::Failed(failure) = &deployment.stop else { panic!("{:?}", deployment.stop) };
        assert_eq!((failure.audit, failure.time.to_bits()), (audit, f64::to_bits(time)));
        assert_eq!((deployment.history.len(), deployment.measures.verdict), (samples, None));
        assert!(deployment.measures.final_volume.is_some());
    }
}
