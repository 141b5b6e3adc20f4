//! The timing and the output of the player's robot side.

use std::time::Duration;

use super::{Matching, Mismatch, Output, Pace, Player, Step, counter};

impl Player {
    /// Decides whether the playback may continue although a command is missing.
    pub(super) fn command_gate(&mut self, now: Duration) -> Result<Gate, Mismatch> {
        if self.position < self.commanded {
            return Ok(Gate::Open);
        }
        if self.is_unfinished_motion(self.position) {
            return Ok(Gate::Hold);
        }
        // A client that has already sent its next request must not send commands until the robot
        // has answered the request.
        let ahead = self.requested > self.position;
        if self.options.pace == Pace::Recorded || self.silent || ahead {
            return Ok(Gate::Open);
        }
        self.blocked.get_or_insert(now);
        let waits = self.given_up_at().is_some_and(|at| now < at);
        if self.options.pace == Pace::Lockstep || waits {
            return Ok(Gate::Wait);
        }
        match self.options.matching {
            Matching::Lenient => self.silent = true,
            Matching::Strict => {
                let expected = self.expected(self.position);
                self.fail(format!("none within {:?}", self.options.patience), expected)?;
            }
        }
        Ok(Gate::Open)
    }

    /// Returns true if a step is the last command of a motion. Lenient playback must wait for this
    /// command as it waits for a request.
    pub(super) fn is_unfinished_motion(&self, step: usize) -> bool {
        let waits = self.options.matching == Matching::Lenient && step >= self.commanded;
        waits
            && matches!(&self.script.steps[step].1, Step::Command(bytes) if self.script.finishes(bytes))
    }

    /// Advances to the next step, which is due after the recorded interval. A client's delay
    /// postpones all later steps.
    pub(super) fn pass(&mut self, now: Duration) {
        let steps = &self.script.steps;
        let (at, step) = &steps[self.position];
        let next = steps.get(self.position + 1).map_or(*at, |(next, _)| *next);
        let waited = self.blocked.take().is_some();
        let answered = matches!(step, Step::Command(_)) && self.position < self.commanded;
        if answered && self.options.pace == Pace::Answered {
            self.due = now;
        } else {
            let base = if waited { now } else { self.due };
            self.due = base + next.saturating_sub(*at);
        }
        self.position += 1;
    }

    /// Performs the robot's part of this step.
    pub(super) fn perform(&mut self, now: Duration) -> Output {
        match self.script.steps[self.position].1.clone() {
            Step::Reply(mut bytes) => {
                let range = self.script.device.id_range();
                if let Some(id) = bytes.get_mut(range)
                    && let Some(actual) = self.ids.get(&*id)
                {
                    id.copy_from_slice(actual);
                }
                Output::Stream(bytes)
            }
            Step::State(bytes) => {
                let recorded = counter(self.script.device, &bytes);
                self.send_state(now, bytes, recorded, self.shift)
            }
            _ => Output::End,
        }
    }

    /// Repeats the last state if a state is due and the client's step is missing.
    pub(super) fn hold(&mut self, now: Duration) -> Option<Output> {
        self.blocked.get_or_insert(now);
        if self.options.pace == Pace::Lockstep {
            return None;
        }
        let (at, state) = self.last_state.take()?;
        if now < at + self.script.interval {
            self.last_state = Some((at, state));
            return None;
        }
        self.shift = self.shift.wrapping_add(1);
        self.tally.held += 1;
        Some(self.send_state(now, state, None, 1))
    }

    /// Returns a state whose id is increased by `ahead`.
    fn send_state(
        &mut self,
        now: Duration,
        mut state: Vec<u8>,
        recorded: Option<u64>,
        ahead: u64,
    ) -> Output {
        let size = self.script.device.counter_size();
        if let Some(id) = counter(self.script.device, &state) {
            let id = id.wrapping_add(ahead);
            state[..size].copy_from_slice(&id.to_le_bytes()[..size]);
            if self.sent.len() == REMEMBERED {
                self.sent.pop_front();
            }
            self.sent.push_back((id, recorded));
        }
        self.tally.states += 1;
        self.last_state = Some((now, state.clone()));
        Output::Datagram(state)
    }
}

/// Decision about a missing step of the client.
pub(super) enum Gate {
    Open,
    /// Wait, and repeat states meanwhile.
    Hold,
    /// Wait, and send no states.
    Wait,
}

/// Number of state ids that the player remembers: four seconds of states. Clients do not answer
/// older states.
const REMEMBERED: usize = 4096;
