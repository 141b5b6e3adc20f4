//! The control cycle neither allocates nor frees: an allocator counts what target control does over 10^5 cycles.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use franka_tests::lockstep::Wander;

thread_local! {
    static COUNTING: Cell<bool> = const { Cell::new(false) };
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

fn count() {
    if COUNTING.get() {
        CALLS.set(CALLS.get() + 1);
    }
}

// SAFETY: every method hands its arguments to the system's allocator unchanged and returns what that returns; counting
// touches two thread-local cells without destructors, which neither allocates nor unwinds.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's obligations are those of the system's allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: as above; `pointer` came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Calls of the allocator while `work` runs.
fn calls_during(work: &mut dyn FnMut()) -> u64 {
    CALLS.set(0);
    COUNTING.set(true);
    work();
    COUNTING.set(false);
    CALLS.get()
}

#[test]
fn a_hundred_thousand_cycles_of_target_control_allocate_and_free_nothing() {
    let seen = calls_during(&mut || drop(std::hint::black_box(Box::new(1))));
    assert_eq!(seen, 2, "the allocator counts");

    let seed = 7;
    let mut wander = Wander::new(seed);
    let (mut cycles, mut calls) = (0, 0);
    while cycles < 100_000 {
        wander.tick_around(|cycle| {
            calls += calls_during(cycle);
            cycles += 1;
        });
    }
    assert!(
        wander.lockstep.client.record.goal > 100,
        "the arm was sent about"
    );
    assert_eq!(
        calls, 0,
        "seed {seed}: calls of the allocator in {cycles} cycles"
    );
}
