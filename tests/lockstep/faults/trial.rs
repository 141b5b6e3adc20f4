//! One motion in one way, with whatever befalls it.

use std::time::Duration;

use franka_model::READY;
use franka_proto::{General, MoveGeneratorMode, MoveRequest, Request, RobotMode};
use franka_rt::control::{ActiveControl, AsynchronousPositions, AsynchronousTarget, WriteError};
use franka_rt::driver::{Activity, Program};
use franka_rt::session::{GoalId, OnArrival, Target};
use franka_rt::shaping::Shaper;
use franka_rt::slot::SlotWriter;
use franka_tests::lockstep::{Link, Lockstep, Outcome};
use nalgebra::{Isometry3, Translation3};

use crate::faults::course;
use crate::faults::program::{Deed, Pilot, callback};
use crate::faults::variant::{Channel, Gesture, Variant, Way};

/// A moment in the life of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Moment {
    /// So many milliseconds after it was begun, of which the client has heard nothing.
    Armed(u64),
    /// This many states have been answered.
    Cycle(u64),
    /// The finishing command is out for as many milliseconds, and has been lost each time; with 0
    /// it is on its way.
    Finishing(u64),
}

/// A motion under way, and what is done to it.
pub(crate) struct Trial {
    pub(crate) lockstep: Lockstep,
    /// Whom it resolves for.
    pub(crate) work: GoalId,
    pub(crate) variant: Variant,
    /// States answered before the finish.
    pub(crate) cycles: u64,
    /// States answered with the finishing command.
    pub(crate) finishing: u64,
    /// Refusals of what was written under active control.
    pub(crate) refused: Vec<WriteError>,
    hand: Hand,
    /// `message_id` and success rate of the last two states of the motion, the newer one last.
    seen: [Option<(u64, f64)>; 2],
    ended: bool,
}

/// What acts on the motion from outside the thread.
enum Hand {
    /// Nothing.
    None,
    /// Somebody who reads states and writes commands.
    Writer {
        channel: Channel,
        pilot: Pilot,
        previous: Option<u64>,
    },
    /// Somebody who gives one target and then finishes there.
    Targets {
        slot: SlotWriter<AsynchronousTarget>,
        q: [f64; 7],
    },
    /// Somebody who leads a goal that is held, from where it began.
    Leader { start: Isometry3<f64> },
}

impl Trial {
    /// A motion along the course, of which the robot has not heard yet.
    pub(crate) fn begin(variant: Variant, deed: Deed) -> Self {
        Self::begin_on(Lockstep::ready_of(variant.kind), variant, deed)
    }

    /// The same on a robot that something has been done to.
    pub(crate) fn begin_on(lockstep: Lockstep, variant: Variant, deed: Deed) -> Self {
        let shaper = Shaper::new(lockstep.client.version(), false, 1000.0);
        Self::begin_shaped(lockstep, variant, deed, shaper)
    }

    /// The same with what control functions command shaped by `shaper`.
    pub(crate) fn begin_shaped(
        mut lockstep: Lockstep,
        variant: Variant,
        deed: Deed,
        shaper: Shaper,
    ) -> Self {
        let version = lockstep.client.version();
        let (work, hand) = match variant.way {
            Way::Callback(channel) => {
                let callback = callback(version, channel, deed).with_shaper(shaper);
                let request = callback.request(version, channel.controller);
                let program = Program::Callback(Box::new(callback));
                (lockstep.control(program, request), Hand::None)
            }
            Way::Active(channel) => {
                let request = match channel.generator {
                    MoveGeneratorMode::None => {
                        MoveRequest::new(channel.controller, version.torque_generator())
                    }
                    generator => MoveRequest::new(channel.controller, generator),
                };
                let hand = Hand::Writer {
                    channel,
                    pilot: Pilot::new(deed),
                    previous: None,
                };
                (
                    lockstep.control(Program::Active(ActiveControl), request),
                    hand,
                )
            }
            Way::Asynchronous => {
                let (program, slot) = AsynchronousPositions::new();
                let request = AsynchronousPositions::request([0.655; 7]);
                let mut q: [f64; 7] = READY.into();
                q[course::JOINT] += 0.003;
                let hand = Hand::Targets { slot, q };
                (
                    lockstep.control(Program::Asynchronous(program), request),
                    hand,
                )
            }
            Way::Target(gesture) => {
                let start = lockstep.true_pose();
                let mut q: [f64; 7] = READY.into();
                q[course::JOINT] += 0.02;
                let (target, on_arrival, hand) = match gesture {
                    Gesture::MoveTo => {
                        let up = Translation3::new(0.0, 0.0, 0.01) * start;
                        (Target::Pose(up), OnArrival::ReportAndFinish, Hand::None)
                    }
                    Gesture::MoveJoints => {
                        (Target::Joints(q), OnArrival::ReportAndFinish, Hand::None)
                    }
                    Gesture::Follow => {
                        (Target::Pose(start), OnArrival::Hold, Hand::Leader { start })
                    }
                };
                let goal = lockstep.goal(target, on_arrival);
                (lockstep.submit(goal), hand)
            }
        };
        Self {
            lockstep,
            work: work.expect("nothing moves"),
            variant,
            cycles: 0,
            finishing: 0,
            refused: Vec::new(),
            hand,
            seen: [None; 2],
            ended: false,
        }
    }

    /// One millisecond.
    pub(crate) fn tick(&mut self) {
        let newest = self.lockstep.client.state.message_id;
        self.lockstep.tick();
        let client = &self.lockstep.client;
        if client.state.message_id == newest {
            return;
        }
        let activity = client.record.activity;
        let begun = self.cycles + self.finishing > 0;
        match activity {
            Activity::Running | Activity::Silent => self.cycles += 1,
            Activity::Finishing => self.finishing += 1,
            _ => {}
        }
        let runs = !matches!(activity, Activity::Watching | Activity::Armed);
        if !self.ended && (begun || runs) {
            let rate = client.state.control_command_success_rate;
            self.seen = [self.seen[1], Some((client.state.message_id, rate))];
            self.ended = !runs;
        }
        if activity == Activity::Running {
            self.act();
        }
    }

    fn act(&mut self) {
        let Self {
            lockstep,
            hand,
            cycles,
            ..
        } = self;
        match hand {
            Hand::None => {}
            Hand::Writer {
                channel,
                pilot,
                previous,
            } => {
                let state = lockstep.client.state;
                let previous = previous.replace(state.message_id);
                let step = state.message_id - previous.unwrap_or(state.message_id);
                let version = lockstep.client.version();
                let step = Duration::from_millis(step);
                let (command, finished) = pilot.command(version, *channel, &state, step);
                match lockstep.write(&command, finished) {
                    Ok(()) if finished => {
                        // The state was read before anybody knew that it is the last.
                        *cycles -= 1;
                        self.finishing += 1;
                    }
                    Ok(()) => {}
                    Err(error) => self.refused.push(error),
                }
            }
            Hand::Targets { slot, q } => {
                let finished = match *cycles {
                    course::REST => false,
                    course::END => true,
                    _ => return,
                };
                slot.write(&AsynchronousTarget { q: *q, finished });
            }
            Hand::Leader { start } => {
                let goal = self.work;
                if *cycles == course::END {
                    lockstep.client.lifecycle.close(goal);
                } else if *cycles < course::END && cycles.is_multiple_of(20) {
                    let up = Translation3::new(0.0, 0.0, 1e-4 * *cycles as f64);
                    let target = Target::Pose(up * *start);
                    lockstep.update(goal, target).expect("a pose nearby");
                }
            }
        }
    }

    /// Gives the robot another sparse target.
    pub(crate) fn give_target(&mut self, target: &AsynchronousTarget) {
        let Hand::Targets { slot, .. } = &mut self.hand else {
            panic!("{} has no sparse targets", self.variant);
        };
        slot.write(target);
    }

    /// Runs up to `moment`.
    pub(crate) fn until(&mut self, moment: Moment) {
        match moment {
            Moment::Armed(milliseconds) => self.lockstep.link.drop_states(milliseconds),
            Moment::Cycle(_) => {}
            Moment::Finishing(lost) => self.lockstep.link.drop_finishing(lost),
        }
        for after in 0..MOST {
            let there = match moment {
                Moment::Armed(milliseconds) => after == milliseconds,
                Moment::Cycle(count) => self.cycles == count,
                Moment::Finishing(lost) => self.finishing == lost + 1,
            };
            if there {
                return;
            }
            let outcome = self.lockstep.client.outcome(self.work);
            assert_eq!(outcome, None, "before {moment:?}");
            self.tick();
        }
        panic!("{moment:?} does not come");
    }

    /// Whether it has run and does so no more, as far as the thread knows.
    pub(crate) fn has_ended(&self) -> bool {
        self.ended
    }

    /// How it turns out, everything having come to its end.
    pub(crate) fn outcome(&mut self) -> Outcome {
        for _ in 0..MOST {
            let Lockstep { client, .. } = &self.lockstep;
            if client.lifecycle.is_idle() && client.driver.is_watching() {
                let outcome = client.outcome(self.work);
                return outcome.expect("idle, and unresolved").clone();
            }
            self.tick();
        }
        let lifecycle = &self.lockstep.client.lifecycle;
        panic!("it does not end: {lifecycle:?}");
    }

    /// What libfranka appends to the text of a reflex: the rate of the last state but one, lowered
    /// by what was lost after it.
    pub(crate) fn success_rate(&self) -> String {
        let [Some((before, rate)), Some((last, _))] = self.seen else {
            return String::new();
        };
        let lost = last - before - 1;
        let rate = General(rate * (1.0 - lost as f64 / 100.0));
        let mut text = format!("\ncontrol_command_success_rate: {rate}");
        if lost > 0 {
            text += &format!(" packets lost in a row in the last sample: {lost}");
        }
        text
    }

    /// Whatever happened, the next motion works, after a recovery if need be. No request is left
    /// without an answer.
    pub(crate) fn works_again(mut self) {
        let lockstep = &mut self.lockstep;
        let resolved = lockstep.client.resolved();
        lockstep.link = Link::perfect();
        lockstep.robot.press_user_stop(false);
        lockstep.run(1);
        if lockstep.client.state.robot_mode != RobotMode::Idle {
            lockstep.request(&Request::AutomaticErrorRecovery);
        }
        for _ in 0..MOST {
            if lockstep.client.state.robot_mode == RobotMode::Idle {
                break;
            }
            lockstep.tick();
        }
        let way = match self.variant.channel() {
            Some(_) => self.variant.way,
            None => Way::Callback(Channel::ALL[0]),
        };
        let variant = Variant {
            way,
            ..self.variant
        };
        let mut next = Self::begin_on(self.lockstep, variant, Deed::FinishesAt(2));
        let outcome = next.outcome();
        assert!(outcome.is_ok(), "the next motion: {outcome:?}");
        let Lockstep { client, .. } = &next.lockstep;
        assert_eq!(client.resolved(), resolved + 1);
        assert_eq!(client.pending(), 0, "every request has been answered");
        assert_eq!(client.state.robot_mode, RobotMode::Idle);
    }
}

/// Milliseconds in which whatever ends has ended: letting go of an arm that was led takes half a
/// second.
const MOST: u64 = 3000;
