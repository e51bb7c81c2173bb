//! Nothing is allocated inside a step: a counting allocator says so.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use billow_solver::integrators::explicit::DEFAULT_CFL;
use billow_solver::models::film::FilmRun;
use billow_solver::models::run::Model;
use billow_solver::output::measures::Reference;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::Phase;

use crate::rig::paper_scene;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

#[expect(unsafe_code, reason = "an allocator is unsafe by nature; it only counts and passes on")]
// SAFETY: every call goes to `System` unchanged, which is an allocator; the counter allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`, which is that of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` comes from `alloc` above, so from `System`, with the same layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_step_allocates_nothing() {
    let count = || ALLOCATIONS.with(Cell::get);
    let before = count();
    drop(vec![0_u8; 100]);
    assert!(count() > before);

    let mut scene = paper_scene();
    scene.design.subdivisions = 2;
    scene.gas.leak_area = 1e-4;
    let reference = Reference::new(vec![[1.0, 1.0, 1.0]]);
    let mut run =
        FilmRun::from_scene(InstructionSet::detect(), &scene, DEFAULT_CFL, None, Some(reference))
            .unwrap();
    let inflow = Inflow { mass_flow_rate: 0.005, temperature_flow: 0.005 * 293.0 };
    for packed in [true, false] {
        let before = count();
        let until = run.film.state.time + 2e-3;
        run.advance(until, &Phase { packed, inflow }).unwrap();
        assert_eq!(count(), before, "packed {packed}");
    }
    assert!(run.steps() > 100);
}
