//! Synchronisation of robots that begin each millisecond together.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Barrier at which the threads of robots in step meet once per millisecond.
#[derive(Debug)]
struct Meeting {
    state: Mutex<State>,
    complete: Condvar,
}

#[derive(Debug)]
struct State {
    /// Number of robots that have not ended.
    members: usize,
    /// Number of members that wait for the other members.
    waiting: usize,
    /// Number of milliseconds that have begun.
    begun: u64,
}

/// Membership of one robot in the meeting. After the membership is dropped, no robot waits for this
/// robot.
#[derive(Debug)]
pub(super) struct InStep(Arc<Meeting>);

pub(super) fn in_step<const N: usize>() -> [InStep; N] {
    let state = State {
        members: N,
        waiting: 0,
        begun: 0,
    };
    let meeting = Arc::new(Meeting {
        state: Mutex::new(state),
        complete: Condvar::new(),
    });
    core::array::from_fn(|_| InStep(meeting.clone()))
}

impl InStep {
    /// Waits until all other members have also called this function.
    pub(super) fn meet(&self) {
        let mut state = self.0.state();
        state.waiting += 1;
        let begun = state.begun;
        self.0.begin_if_complete(&mut state);
        while state.begun == begun {
            let waiting = self.0.complete.wait(state);
            state = waiting.unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl Drop for InStep {
    fn drop(&mut self) {
        let mut state = self.0.state();
        state.members -= 1;
        self.0.begin_if_complete(&mut state);
    }
}

impl Meeting {
    fn state(&self) -> MutexGuard<'_, State> {
        // No code panics while it holds the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn begin_if_complete(&self, state: &mut State) {
        if state.waiting == state.members {
            state.waiting = 0;
            state.begun += 1;
            self.complete.notify_all();
        }
    }
}
