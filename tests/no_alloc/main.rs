//! Code on the real-time thread neither allocates nor frees: an allocator counts the calls of each
//! thread.

mod control;
mod endings;
mod engaged;
mod generator;
mod guards;
mod laws;
mod team;
mod thread;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

/// The number of calls of the allocator by this thread so far.
fn calls() -> u64 {
    CALLS.get()
}

/// The number of calls of the allocator while `work` runs.
fn calls_during(work: impl FnOnce()) -> u64 {
    let before = calls();
    work();
    calls() - before
}

fn count() {
    CALLS.set(CALLS.get() + 1);
}

// SAFETY: every method passes its arguments to the system's allocator unchanged and returns the
// result unchanged. Counting touches a thread-local cell that is initialised at compile time and
// has no destructor, so it neither allocates nor fails in any phase of a thread's life.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's obligations are equal to the system allocator's.
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

#[test]
fn the_allocator_counts() {
    let seen = calls_during(|| drop(std::hint::black_box(Box::new(1))));
    assert_eq!(seen, 2);
}
