//! The thread that keeps the millisecond.

use std::time::{Duration, Instant};

use super::seat::Seat;
use crate::end_effector::{Hand, VacuumGripper};
use crate::robot::{Awaited, Robot};

/// How well a simulation has kept its millisecond.
///
/// The thread has ordinary priority, unless [`Sim::realtime`](super::Sim::realtime) asks for
/// another. When the host lets it sleep over deadlines, it publishes the states that are due in a
/// burst, as a robot's network does after a stall; when more than [`Pace::BURST`] are due, it lets
/// the rest of the lost time go. `message_id` advances by one per state in any case, so robot time
/// then runs behind the clock on the wall.
///
/// In [virtual time](super::Sim::virtual_time) there is no such clock, and nothing is late.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pace {
    /// States due so far.
    pub cycles: u64,
    /// Those that followed another one in a burst: the client had no time to answer the one before.
    pub burst: u64,
    /// Milliseconds let go.
    pub skipped: u64,
}

impl Pace {
    /// States published at once, at most.
    pub const BURST: u32 = 4;
}

const PERIOD: Duration = Duration::from_millis(1);

/// Time on the wall between two states that take no answer, in virtual time: a client has to be
/// able to read them.
const HASTE: Duration = Duration::from_micros(100);

/// The devices, which share one clock.
pub(super) struct Cycle {
    pub(super) robot: Seat<Robot>,
    pub(super) hand: Option<Seat<Hand>>,
    pub(super) vacuum: Option<Seat<VacuumGripper>>,
}

impl Cycle {
    /// Runs until nobody can give orders to the robot any more.
    pub(super) fn run(mut self) {
        let mut pace = Pace::default();
        let mut deadline = Instant::now() + PERIOD;
        loop {
            self.wait(deadline);
            let late = deadline.elapsed().as_micros() / PERIOD.as_micros();
            let due = 1 + u32::try_from(late).unwrap_or(u32::MAX - 1);
            for n in 0..due.min(Pace::BURST) {
                pace.cycles += 1;
                pace.burst += u64::from(n > 0);
                if !self.cycle(pace) {
                    return;
                }
            }
            pace.skipped += u64::from(due.saturating_sub(Pace::BURST));
            deadline += PERIOD * due;
        }
    }

    /// Runs on the client's time instead, until the same end: see
    /// [`Sim::virtual_time`](super::Sim::virtual_time).
    pub(super) fn run_on_answers(mut self, patience: Duration) {
        let mut pace = Pace::default();
        let mut attempts = 0;
        loop {
            pace.cycles += 1;
            if !self.cycle(pace) {
                return;
            }
            let patience = match self.robot.awaits() {
                Awaited::Nothing => {
                    attempts = 0;
                    let period = if self.robot.is_taken() { HASTE } else { PERIOD };
                    self.wait(Instant::now() + period);
                    continue;
                }
                // A client that looks at a state before it begins is soon shown the next one; one
                // that is slow gets its time.
                Awaited::First => {
                    attempts += 1;
                    patience.min(PERIOD * 2_u32.saturating_pow(attempts))
                }
                Awaited::Next => {
                    attempts = 0;
                    patience
                }
            };
            if !self.robot.await_command(patience, pace) {
                return;
            }
        }
    }

    /// Sleeps, and relays what passes a network meanwhile.
    fn wait(&mut self, deadline: Instant) {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.robot.pause() {
                Some(pause) if !left.is_zero() => {
                    std::thread::sleep(pause.min(left));
                    self.robot.relay();
                }
                _ => return std::thread::sleep(left),
            }
        }
    }

    /// One millisecond of every device. False at the end.
    fn cycle(&mut self, pace: Pace) -> bool {
        // The robot's ends the thread; the others live and die with it.
        let goes_on = self.robot.cycle(pace);
        if let Some(hand) = &mut self.hand {
            self.robot.device_mut().couple(hand.device_mut());
            hand.cycle(pace);
        }
        if let Some(vacuum) = &mut self.vacuum {
            vacuum.cycle(pace);
        }
        goes_on
    }
}
