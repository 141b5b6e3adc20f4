//! Work that the driver does after a command has left.

use franka_proto::RobotState;

use super::motion::{Execution, Phase};
use super::{Driver, Event};
use crate::stats::{Arrival, CycleTimes, MotionStatistics};

impl Driver {
    /// Does the work for a state that can wait until the command has left. Call it once after each
    /// [`Self::on_state`]: after the command was sent, or at once if no command was due. `sent`
    /// contains the times of the sent command that are known so far.
    pub fn after_send(&mut self, state: &RobotState, arrival: &Arrival, sent: Option<&CycleTimes>) {
        self.references.write(&self.record);
        self.record.late = arrival.late;
        if let Some(sent) = sent {
            self.record.turnaround = sent.turnaround;
            self.record.slack = Some(sent.slack);
        }
        if let Some(motion) = self.motion.as_mut().filter(|motion| motion.has_begun()) {
            motion.log.note_state(state);
            motion.log.note_command(&motion.sent);
            if let Some(interval) = arrival.interval {
                motion.times.interval.note(interval);
            }
            if let Some(observer) = &mut motion.observer
                && observer.see(&self.record, state)
            {
                let motion = motion.id;
                self.events.push(Event::Unobserved { motion });
            }
        }
    }

    /// Computes the parts of the next answer that do not need the next state: the program's next
    /// goal, plan and reference. Call it after all other work of the cycle.
    pub fn prepare(&mut self) {
        if let Some(motion) = &mut self.motion
            && motion.phase == Phase::Running
        {
            motion.program.prepare();
        }
    }

    /// Notes the times of a cycle whose command has left. Call it once all times are known. Returns
    /// the counts of the running motion; `None` if no motion runs.
    pub fn note_cycle(&mut self, cycle: &CycleTimes) -> Option<&MotionStatistics> {
        let motion = self.motion.as_ref().filter(|motion| motion.has_begun())?;
        self.statistics.note_cycle(cycle);
        motion.times.turnaround.note(cycle.turnaround);
        Some(&self.statistics)
    }

    /// Returns the counts of the running motion; `None` if no motion runs.
    pub fn statistics(&self) -> Option<&MotionStatistics> {
        let begun = self.motion.as_ref().is_some_and(Execution::has_begun);
        begun.then_some(&self.statistics)
    }
}
