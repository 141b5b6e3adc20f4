//! Counts the passes of the searches, for the test that compares them with their bounds. Outside of
//! tests, the functions do nothing.

#[cfg(test)]
use core::cell::Cell;

#[cfg(test)]
std::thread_local! {
    static MOST: Cell<usize> = const { Cell::new(0) };
}

/// Records that a search of at most `ceiling` passes is in pass number `pass`, counted from zero.
#[cfg_attr(not(test), expect(unused_variables, reason = "only tests count"))]
pub(crate) fn count(pass: usize, ceiling: usize) {
    #[cfg(test)]
    MOST.set(MOST.get().max(100 * (pass + 1) / ceiling));
}

/// Returns the largest number of passes of a search in this thread since the last call, in percent
/// of the search's bound.
#[cfg(test)]
pub(crate) fn take_most() -> usize {
    MOST.replace(0)
}
