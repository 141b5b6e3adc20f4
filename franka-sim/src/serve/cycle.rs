//! The simulator's thread: one state per millisecond or, in virtual time, one state per answer.

use std::time::{Duration, Instant};

use super::Hook;
use super::clock::{Clock, PERIOD, Pace};
use super::device_server::DeviceServer;
use super::in_step::InStep;
use super::speed::{Pacer, Speed};
use crate::end_effector::{Hand, VacuumGripper};
use crate::robot::{Awaited, Robot};

/// Real time between two states that need no answer, in virtual time. A client can read the states
/// at this rate.
const VIRTUAL_IDLE_PERIOD: Duration = Duration::from_micros(100);

/// Time for which the first state of a motion waits for a first command. A busy host may delay a
/// thread of the client by about 10 ms.
const FIRST_WAIT: Duration = Duration::from_millis(16);

/// Result of a wait for the answer to a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// The answer was available, or no answer was due.
    NotAwaited,
    /// The simulator waited for the answer.
    Awaited,
    /// No client or task remains that could control the robot.
    End,
}

/// The devices, which share one clock.
pub(super) struct Cycle {
    pub(super) robot: DeviceServer<Robot>,
    pub(super) hand: Option<DeviceServer<Hand>>,
    pub(super) vacuum: Option<DeviceServer<VacuumGripper>>,
    pub(super) every_millisecond: Option<Hook>,
    pub(super) after_each_state: Option<Hook>,
    pub(super) in_step: Option<InStep>,
}

impl Cycle {
    /// Runs until no client or task remains that could control the robot. Waits up to `patience`
    /// for each late command.
    pub(super) fn run(mut self, strict: bool, patience: Duration) {
        let mut clock = Clock::new(Instant::now(), strict);
        let mut attempts = 0;
        loop {
            let due = clock.due();
            self.sleep_until(due, &mut clock);
            self.robot.relay(clock.at(Instant::now()));
            if self.robot.awaits() == Awaited::Next {
                let due = clock.wait_for_answer();
                self.sleep_until(due, &mut clock);
            }
            if !patience.is_zero() {
                let now = clock.at(Instant::now());
                match self.await_answer(now, patience, &mut attempts, clock.pace()) {
                    // If this thread was late, the client did not cause the delay.
                    Answer::NotAwaited => {}
                    Answer::Awaited => clock.waited(Instant::now()),
                    Answer::End => return clock.pace().log(),
                }
                while let Some(arrival) = self.robot.answer_arrives(clock.at(Instant::now())) {
                    self.sleep_until(arrival, &mut clock);
                    self.robot.relay(clock.at(Instant::now()));
                    clock.waited(Instant::now());
                }
            }
            for _ in 0..clock.begin(Instant::now()) {
                let now = clock.at(Instant::now());
                if !self.cycle(now, clock.pace()) {
                    return clock.pace().log();
                }
                clock.published(Instant::now());
            }
        }
    }

    /// Runs in virtual time until no client or task remains. After each state, waits for the
    /// client's answer: see [`Sim::virtual_time`](super::Sim::virtual_time).
    pub(super) fn run_on_answers(mut self, patience: Duration, speed: Speed) {
        // In virtual time no state is late, so the clock does not slip.
        let mut clock = Clock::new(Instant::now(), true);
        let mut attempts = 0;
        let mut pacer = Pacer::new(speed);
        // Current time of the robot and of its network.
        let mut now = Instant::now();
        loop {
            if !self.cycle(now, clock.pace()) {
                return;
            }
            clock.published(Instant::now());
            let asks = self.robot.awaits() != Awaited::Nothing;
            let next = now + PERIOD;
            loop {
                let answer = self.await_answer(now, patience, &mut attempts, clock.pace());
                if answer == Answer::End {
                    return;
                }
                let arrival = self.robot.next_arrival();
                let Some(arrival) = arrival.filter(|arrival| *arrival < next) else {
                    break;
                };
                now = arrival;
                self.robot.relay(now);
            }
            now = next;
            if !pacer.wait() && !asks {
                std::thread::sleep(match self.has_client() {
                    true => VIRTUAL_IDLE_PERIOD,
                    false => PERIOD,
                });
            }
        }
    }

    /// Waits for the client's answer, if the newest state requires one. A client may read several
    /// states before its first command. The first wait for the first command lasts [`FIRST_WAIT`],
    /// and doubles with each of the `attempts`, up to `patience`.
    fn await_answer(
        &mut self,
        now: Instant,
        patience: Duration,
        attempts: &mut u32,
        pace: Pace,
    ) -> Answer {
        let patience = match self.robot.awaits_answer() {
            Awaited::Nothing => return Answer::NotAwaited,
            Awaited::First => {
                let wait = FIRST_WAIT.saturating_mul(2_u32.saturating_pow(*attempts));
                *attempts += 1;
                patience.min(wait)
            }
            Awaited::Next => {
                *attempts = 0;
                patience
            }
        };
        match self.robot.await_command(now, patience, pace) {
            true => Answer::Awaited,
            false => Answer::End,
        }
    }

    /// True if a client is connected to any device.
    fn has_client(&self) -> bool {
        let hand = self.hand.as_ref().is_some_and(DeviceServer::has_client);
        let vacuum = self.vacuum.as_ref().is_some_and(DeviceServer::has_client);
        self.robot.has_client() || hand || vacuum
    }

    /// Sleeps until the clock reaches `end`, and passes datagrams through a simulated network.
    fn sleep_until(&mut self, end: Instant, clock: &mut Clock) {
        loop {
            let now = clock.at(Instant::now());
            let left = end.saturating_duration_since(now);
            if left.is_zero() {
                return;
            }
            let pause = self.robot.pause(now).map_or(left, |pause| pause.min(left));
            std::thread::sleep(pause);
            clock.woke(Instant::now(), now + pause);
            if pause < left {
                self.robot.relay(clock.at(Instant::now()));
            }
        }
    }

    /// Advances every device by one millisecond. Returns false if the robot's service has ended.
    fn cycle(&mut self, now: Instant, pace: Pace) -> bool {
        if let Some(others) = &self.in_step {
            others.meet();
        }
        if let Some(Hook(job)) = &mut self.every_millisecond {
            job(self.robot.device_mut());
        }
        // When the robot's service ends, this thread and the other devices end.
        let goes_on = self.robot.cycle(now, pace);
        if let Some(Hook(job)) = &mut self.after_each_state {
            job(self.robot.device_mut());
        }
        if let Some(hand) = &mut self.hand {
            self.robot.device_mut().couple(hand.device_mut());
            hand.cycle(now, pace);
        }
        if let Some(vacuum) = &mut self.vacuum {
            vacuum.cycle(now, pace);
        }
        goes_on
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;
    use std::net::{Ipv4Addr, SocketAddr, TcpStream};

    use franka_proto::{client, gripper};

    use super::*;
    use crate::config::Config;
    use crate::end_effector::Fingers;
    use crate::serve::{service, tests::SOON};

    #[test]
    fn a_client_of_the_hand_is_a_client() {
        let runtime = tokio::runtime::Runtime::new().expect("a runtime");
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let robot = service::open(address, Box::new(Robot::new(Config::default())));
        let (_robot, robot) = runtime.block_on(robot).expect("a robot");
        let hand = service::open(address, Box::new(Hand::new(Fingers::new())));
        let (hand, hand_server) = runtime.block_on(hand).expect("a hand");
        let mut cycle = Cycle {
            robot,
            hand: Some(hand_server),
            vacuum: None,
            every_millisecond: None,
            after_each_state: None,
            in_step: None,
        };
        assert!(!cycle.has_client());
        let answer = cycle.await_answer(Instant::now(), SOON, &mut 0, Pace::default());
        assert_eq!(answer, Answer::NotAwaited);
        let mut stream = TcpStream::connect(hand.addr()).expect("a listener");
        let hello = client::Session::new(gripper::Version::default()).connect(1);
        stream.write_all(hello.as_bytes()).expect("an open stream");
        let begun = Instant::now();
        while !cycle.hand.as_ref().is_some_and(DeviceServer::has_client) {
            assert!(begun.elapsed() < SOON, "no session");
            assert!(cycle.cycle(Instant::now(), Pace::default()));
        }
        assert!(cycle.has_client());
    }
}
