//! A damaged length does not make the reader allocate memory. An allocator notes the largest
//! allocation of each thread.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use franka_record::cassette::Cassette;

use crate::any_bytes;

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

struct Noting;

// SAFETY: every method passes its arguments to the system's allocator unchanged and returns its
// result; the value of the thread has no destructor, and noting neither allocates nor fails.
unsafe impl GlobalAlloc for Noting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.set(LARGEST.get().max(layout.size()));
        // SAFETY: the caller's obligations are the same as for the system's allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above; `pointer` came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static NOTING: Noting = Noting;

#[test]
fn a_damaged_length_allocates_no_memory() {
    for (name, seed) in any_bytes::seeds() {
        assert!(seed.len() < 4096, "{name}: {}", seed.len());
        for at in 8..seed.len() - 4 {
            let mut bytes = seed.clone();
            // 64 MiB, wherever the file contains a length.
            bytes[at..at + 4].copy_from_slice(&[0, 0, 0, 0x04]);
            LARGEST.set(0);
            any_bytes::read(&bytes);
            let _ = Cassette::read(&bytes);
            let largest = LARGEST.get();
            assert!(largest < 1 << 20, "{name}, byte {at}: {largest}");
        }
    }
}
