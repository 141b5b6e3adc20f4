//! Reads what the control thread has published since the last wake-up: states, records and events.

use franka_proto::RobotMode;
use franka_rt::driver::Event;
use franka_rt::lifecycle::CloseReason;
use franka_rt::supervision::Seen;
use franka_rt::thread::{Notice, Thread};

use super::Bridge;
use crate::{telemetry, world};

impl Bridge {
    pub(super) fn on_wakeup(&mut self) {
        self.publisher.publish();
        // Observe before a motion resolves, so that the next call finds the robot in the reflex.
        self.observe();
        self.telemetry.watch(world::now());
        self.take_notices();
        self.look_for_a_stall();
        if self.thread_has_ended() {
            let text = "it has ended".into();
            self.lose(CloseReason::ThreadEnded { text });
        }
    }

    /// Passes the thread's events on to the lifecycle.
    pub(super) fn take_notices(&mut self) {
        while let Some(notice) = self.notices.pop() {
            match notice {
                Notice::Core(event) => {
                    match &event {
                        Event::Ended(ended) => telemetry::sum_up(ended),
                        Event::Unobserved { motion } => {
                            tracing::error!(
                                motion = motion.0,
                                "the observer panicked and is not called again"
                            );
                        }
                        Event::LinkLost { silence } => {
                            self.publisher.tell_silence(*silence);
                            self.silent_since = Some(self.publisher.state().message_id);
                            self.supervisor.on_silence(*silence);
                        }
                        _ => {}
                    }
                    let now = self.now();
                    self.lifecycle.on_event(event, now);
                }
                Notice::Link(fault) => tracing::warn!(%fault, "control link"),
                // Drop the ring here, because the thread may not free it.
                Notice::Detached(ring) => drop(ring),
            }
        }
    }

    /// Notes whether the thread that runs active control has stopped reading states, or reads
    /// again.
    pub(super) fn look_for_a_stall(&mut self) {
        let stalled = self.thread.as_ref().and_then(Thread::stalled);
        if stalled.is_some() != self.stalled {
            self.stalled = stalled.is_some();
            if let Some(silence) = stalled {
                tracing::error!(?silence, "active control stopped reading states");
                self.publisher.tell_silence(silence);
            }
            self.lifecycle.on_stall(stalled, self.now());
        }
    }

    pub(super) fn thread_has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(Thread::has_ended)
    }

    /// Shows the supervisor the newest state, if that state contains news about the robot as a
    /// whole.
    pub(super) fn observe(&mut self) {
        let (newest, mode, seen) = {
            let state = self.publisher.state();
            (state.message_id, state.robot_mode, Some(Seen::of(&state)))
        };
        let resumed = self.silent_since.is_some_and(|since| newest > since);
        if resumed || self.seen != seen {
            (self.seen, self.silent_since) = (seen, None);
            // A recovery ends soon, and motions wait for that.
            self.publisher
                .watch(mode == RobotMode::AutomaticErrorRecovery);
            self.supervisor.observe();
        }
    }
}
