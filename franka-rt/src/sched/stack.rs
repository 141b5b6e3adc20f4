//! The stack of the thread: its size, and how much of it is touched before the loop starts.

use core::hint::black_box;

/// Default number of bytes of stack to touch before the loop starts. A cycle of target control uses
/// some tens of kilobytes. A control function of the user may use any amount.
pub const DEFAULT: usize = 512 * 1024;

/// Largest stack that can be requested, in bytes. Larger buffers belong on the heap, allocated
/// before the loop.
pub const MAX: usize = 64 * 1024 * 1024;

/// Size of the stack beyond the touched part, in bytes. Unoptimised builds need it for their larger
/// frames.
const RESERVE: usize = 1536 * 1024;

/// Number of bytes that one frame of [`touch`] covers: a few pages, so that it touches little more
/// than requested.
const FRAME: usize = 16 * 1024;

/// Returns the size of the stack for a thread that touches `touched` bytes, in bytes.
pub(super) const fn size(touched: usize) -> usize {
    touched + RESERVE
}

/// Writes to `bytes` of stack below the caller, rounded up to whole frames. A written page stays
/// mapped, so no later cycle causes a page fault on it.
#[inline(never)]
pub(super) fn touch(bytes: usize) {
    if bytes == 0 {
        return;
    }
    let mut frame = [0u8; FRAME];
    black_box(&mut frame);
    touch(bytes.saturating_sub(FRAME));
    // Use the frame after the call, so that the compiler cannot reuse its memory for the next
    // frame.
    black_box(&mut frame);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the minor page faults of the calling thread so far: field 10 of proc_pid_stat(5).
    fn faults() -> u64 {
        let stat = std::fs::read_to_string("/proc/thread-self/stat").expect("Linux has /proc");
        let fields = &stat[stat.rfind(')').expect("a name") + 1..];
        let field = fields.split_whitespace().nth(10 - 3);
        field.and_then(|count| count.parse().ok()).expect("a count")
    }

    /// Returns the page faults while `used` bytes of stack are used, in a thread that has touched
    /// `touched` bytes before.
    fn faults_of(touched: usize, used: usize) -> u64 {
        let thread = std::thread::Builder::new().stack_size(size(MAX / 16));
        let run = move || {
            faults(); // Maps the pages that reading the count needs.
            touch(touched);
            let before = faults();
            touch(used);
            faults() - before
        };
        let thread = thread.spawn(run).expect("a thread");
        thread.join().expect("touching does not panic")
    }

    #[test]
    fn touched_stack_costs_no_page_fault() {
        for touched in [DEFAULT, 4 * DEFAULT] {
            let used = touched - 4 * FRAME;
            let met = faults_of(touched, used);
            assert!(met <= 8, "{met} faults within {touched} bytes touched");
        }
        // Under transparent huge pages a fault brings up to 2 MiB at once.
        let met = faults_of(0, 4 * DEFAULT + DEFAULT);
        assert!(met >= 1, "{met} faults in a stack never used before");
        assert!(met > faults_of(6 * DEFAULT, 5 * DEFAULT), "{met}");
    }
}
