//! No step allocates memory. A counting allocator proves it.

use crate::counting::allocations;
use crate::film_rig::pressed_sheets;
use crate::prelude::*;
use crate::rig::paper_scene;

#[test]
fn the_counter_counts_allocations() {
    let before = allocations();
    drop(vec![0_u8; 100]);
    assert!(allocations() > before);
}

#[test]
fn a_step_without_contact_allocates_nothing() {
    let mut scene = paper_scene();
    scene.design.folded_mut().unwrap().subdivisions = 2;
    scene.gas.leak_area = 1e-4;
    let mut run = FilmRun::from_scene(InstructionSet::detect(), &scene, DEFAULT_CFL, None).unwrap();
    let inflow =
        Inflow { mass_flow_rate: 0.005, temperature_flow: 0.005 * 293.0, ..Inflow::default() };
    for packed in [true, false] {
        let before = allocations();
        let until = run.film.view().state.time + 2e-3;
        run.advance(until, &Phase { packed, inflow, ..Phase::default() }).unwrap();
        assert_eq!(allocations(), before, "packed {packed}");
    }
    assert!(run.steps() > 100);
}

/// Two sheets at rest on each other and on a floor, with this monitor; after 200 ms.
fn settled_sheets(monitor: MonitorSettings) -> FilmSimulation {
    let mut film = pressed_sheets(monitor, 300.0);
    film.advance(0.2, &Phase::default()).unwrap();
    film
}

/// Allocations of one call that takes this number of steps. Each call allocates a little at its end,
/// whatever the number of steps.
fn allocations_of(film: &mut FilmSimulation, steps: u64) -> u64 {
    let (before, mut remaining) = (allocations(), steps);
    let target = film.view().state.time + 1.0;
    assert!(!film.advance_at_most(target, &Phase::default(), &mut remaining).unwrap());
    allocations() - before
}

/// Allocations in 2000 steps by which lists of pairs may still grow: sheets that tremble bring new pairs
/// within reach. Chosen: a hundredth of one a step.
const MAX_GROWTH: u64 = 20;

/// The block of the monitor is longer than the run.
#[test]
fn a_step_with_contact_allocates_nothing() {
    let mut film = settled_sheets(MonitorSettings { block: 50_000, ..MonitorSettings::FRAMES });
    let contacts = &film.view().state.contact.contacts;
    let pressed = contacts.iter().filter(|contact| contact.energy > 0.0).count();
    assert!(pressed > 4, "{pressed} pairs in contact");
    // The first call lets scratch memory grow.
    let _ = allocations_of(&mut film, 1000);
    let of_one = allocations_of(&mut film, 1);
    let of_many = allocations_of(&mut film, 2000);
    assert!(of_many <= of_one + MAX_GROWTH, "{of_many} in 2000 steps, {of_one} in one");
}

/// Allocations of a step that the monitor checks, at most: k-DOPs and buffers of its own broad phase.
/// Measured; none is necessary.
const MAX_MONITOR_ALLOCATIONS: u64 = 10;

#[test]
fn a_monitored_step_allocates_only_the_buffers_of_the_monitor() {
    let mut film = settled_sheets(MonitorSettings::EVERY_STEP);
    let of_one = allocations_of(&mut film, 1);
    let more = allocations_of(&mut film, 1001) - of_one;
    assert!(more <= 1000 * MAX_MONITOR_ALLOCATIONS, "{more} in 1000 steps");
}
