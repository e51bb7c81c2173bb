use super::*;
use crate::output::history::Sample;
use crate::output::ledger::Ledger;
use crate::scene::Thresholds;
use crate::scene::inflow::Schedule;

fn timeline() -> Timeline {
    Timeline {
        end_time: 1.0,
        sample_interval: 1e-3,
        release_time: 0.0,
        schedule: Schedule::new(&[]),
        ambient_pressure: 0.0,
        frames: 0,
        thresholds: Thresholds::default(),
    }
}

/// `V_ref` 2 m³, `H_ref` 1 m at any pressure.
fn reference() -> Reference {
    Reference::new(vec![[1.0, 2.0, 1.0]])
}

/// One second at 1 ms: volume ratio and height ratio as functions of time.
fn history(volume: impl Fn(f64) -> f64, height: impl Fn(f64) -> f64) -> History {
    let sample = |k: i32| {
        let time = f64::from(k) * 1e-3;
        let (z, before) = (height(time), height(time - 1e-3));
        let vz = (z - before) / 1e-3;
        let ledger =
            Ledger { kinetic: 0.5 * vz * vz, gas_work: 0.5 * vz * vz, ..Ledger::default() };
        Sample {
            time,
            volume: 2.0 * volume(time),
            z_rim: z,
            z_centre: z,
            z_max: z,
            vz,
            ledger,
            pressure: 5.0,
            temperature: 290.0,
            lid_force: if k < 10 { f64::from(k) } else { 0.0 },
            ..Sample::default()
        }
    };
    History::of(&(0..=1000).map(sample).collect::<Vec<_>>())
}

fn measured(volume: impl Fn(f64) -> f64, height: impl Fn(f64) -> f64) -> Measures {
    measure(&history(volume, height), Some(&reference()), &timeline(), 1e6, true)
}

fn ramp(time: f64) -> f64 {
    (time / 0.1).clamp(0.0, 1.0)
}

#[test]
fn a_ramp_has_the_expected_measures() {
    let m = measured(ramp, ramp);
    assert_eq!((m.verdict, m.near_threshold), (Some(Verdict::Deployed), false));
    let near = |value: Option<f64>, expected: f64| {
        assert!((value.unwrap() - expected).abs() < 1e-9, "{value:?} {expected}");
    };
    near(m.t_50_z_rim, 0.05);
    near(m.t_90_z_rim, 0.09);
    near(m.t_50_volume, 0.05);
    near(m.t_90_volume, 0.09);
    near(m.t_deployed, 0.095);
    near(m.volume_ratio, 1.0);
    near(m.height_ratio, 1.0);
    near(m.overshoot, 0.0);
    near(m.peak_vz, 10.0);
    near(m.peak_kinetic_energy, 50.0);
    near(m.final_z_rim, 1.0);
    near(m.final_volume, 2.0);
    near(m.final_pressure, 5.0);
    near(m.final_temperature, 290.0);
    near(m.reference_volume, 2.0);
    near(m.reference_height, 1.0);
    near(m.film_stress, 1e6);
    near(m.peak_lid_force, 9.0);
    assert!(m.t_peak_vz.unwrap() <= 0.1 && m.t_settled.unwrap() > 0.0995);
    // It stops dead at 0.1 s, so 5 of the 200 ms from 95 ms on move, at 10 m/s.
    let rms = 10.0 * (5.0_f64 / 200.0).sqrt();
    assert!((m.ringing_rms.unwrap() - rms).abs() < 0.2, "{:?}", m.ringing_rms);
}

#[test]
fn a_height_held_less_than_five_milliseconds_is_not_reached() {
    let peak = |width: f64| move |t: f64| if (t - 0.2).abs() < 0.5 * width { 0.6 } else { 0.1 };
    assert_eq!(measured(peak(0.003), peak(0.003)).t_50_z_rim, None);
    assert!(measured(peak(0.007), peak(0.007)).t_50_z_rim.is_some());
}

#[test]
fn t_deployed_needs_both_thresholds_for_twenty_milliseconds() {
    let late = |t: f64| if t < 0.3 { 0.5 } else { 1.0 };
    let t = measured(ramp, late).t_deployed.unwrap();
    assert!((0.299..=0.3).contains(&t), "{t}");
    let t = measured(late, ramp).t_deployed.unwrap();
    assert!((0.299..=0.3).contains(&t), "{t}");
    let visit = |until: f64| move |t: f64| if (0.1..until).contains(&t) { 1.0 } else { 0.0 };
    assert_eq!(measured(visit(0.115), visit(0.115)).t_deployed, None);
    assert!(measured(visit(0.125), visit(0.125)).t_deployed.is_some());
}

#[test]
fn events_that_do_not_happen_are_none() {
    let m = measured(|_| 0.01, |_| 0.04);
    assert_eq!((m.verdict, m.near_threshold), (Some(Verdict::Stalled), false));
    assert_eq!([m.t_50_z_rim, m.t_90_z_rim, m.t_50_volume, m.t_90_volume], [None; 4]);
    assert_eq!([m.t_deployed, m.ringing_rms, m.ringing_frequency, m.t_settled], [None; 4]);
    assert!((m.overshoot.unwrap() + 0.96).abs() < 1e-12);
}

#[test]
fn a_run_that_is_not_done_has_no_verdict() {
    let m = measure(&history(ramp, ramp), Some(&reference()), &timeline(), 0.0, false);
    assert_eq!((m.verdict, m.near_threshold), (None, false));
    assert_eq!([m.volume_ratio, m.height_ratio], [None; 2]);
    assert!(m.t_90_z_rim.is_some() && m.final_z_rim.is_some());
    let empty = measure(&History::new(), Some(&reference()), &timeline(), 0.0, false);
    assert_eq!(empty, Measures::default());
}

#[test]
fn partial_and_near_threshold_verdicts() {
    assert_eq!(measured(|_| 0.9, |_| 1.0).verdict, Some(Verdict::Partial));
    let m = measured(|_| 0.935, |_| 1.0);
    assert_eq!((m.verdict, m.near_threshold), (Some(Verdict::Deployed), true));
    let m = measured(|_| 0.845, |_| 1.0);
    assert_eq!((m.verdict, m.near_threshold), (Some(Verdict::Stalled), true));
}

#[test]
fn the_reference_depends_on_the_overpressure() {
    let table = Reference::new(vec![[1.0, 2.0, 1.0], [10.0, 4.0, 2.0]]);
    let mut ground = timeline();
    let history = history(ramp, ramp);
    let orbit = measure(&history, Some(&table), &ground, 0.0, true);
    assert!(orbit.reference_volume.unwrap() > 2.0);
    ground.ambient_pressure = 1e5;
    let on_ground = measure(&history, Some(&table), &ground, 0.0, true);
    assert_eq!(on_ground.reference_volume, Some(2.0));
}

#[test]
fn ringing_is_measured_after_deployment() {
    let ring = |t: f64| {
        if t < 0.1 {
            t / 0.1
        } else {
            1.0 + 0.01 * libm::sin(2.0 * std::f64::consts::PI * 40.0 * (t - 0.1))
        }
    };
    let m = measured(|t| ramp(t).min(1.0), ring);
    assert!((m.ringing_frequency.unwrap() - 40.0).abs() <= 5.0, "{:?}", m.ringing_frequency);
    assert!((m.overshoot.unwrap() - 0.01).abs() < 1e-3);
    assert_eq!(m.t_settled, None);
}
