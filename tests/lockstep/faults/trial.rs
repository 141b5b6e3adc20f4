//! One motion of one variant, and its faults.

use std::time::Duration;

use franka_lockstep::{Link, Lockstep, Outcome};
use franka_model::READY;
use franka_proto::{General, MoveGeneratorMode, MoveRequest, Request, RobotMode};
use franka_rt::control::{
    ActiveControl, AsynchronousPositions, AsynchronousTarget, Shaper, WriteError,
};
use franka_rt::driver::{Activity, Program};
use franka_rt::session::{GoalId, OnArrival, Target};
use franka_rt::triple_buffer::Writer;
use nalgebra::{Isometry3, Translation3};

use crate::faults::course;
use crate::faults::program::{CourseFollower, Misbehaviour, callback};
use crate::faults::variant::{Channel, Gesture, Variant, Way};

/// A moment of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Moment {
    /// This many milliseconds after the start, before the client has seen the motion in a state.
    Armed(u64),
    /// This many states have been answered.
    Cycle(u64),
    /// The finishing command has been sent for this many milliseconds and lost each time; with 0 it
    /// has just been sent.
    Finishing(u64),
}

/// An active motion, and the external actions on it.
pub(crate) struct Trial {
    pub(crate) lockstep: Lockstep,
    /// The id under which the motion resolves.
    pub(crate) work: GoalId,
    pub(crate) variant: Variant,
    /// States answered before the finish.
    pub(crate) cycles: u64,
    /// States answered with the finishing command.
    pub(crate) finishing: u64,
    /// Errors of commands written under active control.
    pub(crate) refused: Vec<WriteError>,
    external: ExternalControl,
    /// `message_id` and success rate of the last two states of the motion, the newer one last.
    seen: [Option<(u64, f64)>; 2],
    ended: bool,
}

/// Control of the motion from outside the real-time thread.
enum ExternalControl {
    /// Nothing.
    None,
    /// Active control: states are read and commands written.
    Writer {
        channel: Channel,
        follower: CourseFollower,
        previous: Option<u64>,
    },
    /// One sparse target, and a finish there.
    Targets {
        targets: Writer<AsynchronousTarget>,
        q: [f64; 7],
    },
    /// A held goal whose target moves, from its start.
    Leader { start: Isometry3<f64> },
}

impl Trial {
    /// Begins a motion along the course; the robot has not received the request yet.
    pub(crate) fn begin(variant: Variant, misbehaviour: Misbehaviour) -> Self {
        Self::begin_on(Lockstep::ready_of(variant.kind), variant, misbehaviour)
    }

    /// Like [`Self::begin`], on a robot prepared by the test.
    pub(crate) fn begin_on(
        lockstep: Lockstep,
        variant: Variant,
        misbehaviour: Misbehaviour,
    ) -> Self {
        let shaper = Shaper::new(lockstep.client.version(), false, 1000.0);
        Self::begin_shaped(lockstep, variant, misbehaviour, shaper)
    }

    /// Like [`Self::begin_on`], with the commands of control functions shaped by `shaper`.
    pub(crate) fn begin_shaped(
        mut lockstep: Lockstep,
        variant: Variant,
        misbehaviour: Misbehaviour,
        shaper: Shaper,
    ) -> Self {
        let version = lockstep.client.version();
        let (work, external) = match variant.way {
            Way::Callback(channel) => {
                let callback = callback(version, channel, misbehaviour).with_shaper(shaper);
                let request = callback.request(version, channel.controller);
                let program = Program::Callback(Box::new(callback));
                (lockstep.control(program, request), ExternalControl::None)
            }
            Way::Active(channel) => {
                let request = match channel.generator {
                    MoveGeneratorMode::None => {
                        MoveRequest::new(channel.controller, version.torque_generator())
                    }
                    generator => MoveRequest::new(channel.controller, generator),
                };
                let external = ExternalControl::Writer {
                    channel,
                    follower: CourseFollower::new(misbehaviour),
                    previous: None,
                };
                (
                    lockstep.control(Program::Active(ActiveControl), request),
                    external,
                )
            }
            Way::Asynchronous => {
                let (program, targets) = AsynchronousPositions::new();
                let request = AsynchronousPositions::request([0.655; 7]);
                let mut q: [f64; 7] = READY.into();
                q[course::JOINT] += 0.003;
                let external = ExternalControl::Targets { targets, q };
                (
                    lockstep.control(Program::Asynchronous(program), request),
                    external,
                )
            }
            Way::Target(gesture) => {
                let start = lockstep.arm_pose();
                let mut q: [f64; 7] = READY.into();
                q[course::JOINT] += 0.02;
                let (target, on_arrival, external) = match gesture {
                    Gesture::MoveTo => {
                        let up = Translation3::new(0.0, 0.0, 0.01) * start;
                        (
                            Target::Pose(up),
                            OnArrival::ReportAndFinish,
                            ExternalControl::None,
                        )
                    }
                    Gesture::MoveJoints => (
                        Target::Joints(q),
                        OnArrival::ReportAndFinish,
                        ExternalControl::None,
                    ),
                    Gesture::Follow => (
                        Target::Pose(start),
                        OnArrival::Hold,
                        ExternalControl::Leader { start },
                    ),
                };
                let goal = lockstep.goal(target, on_arrival);
                (lockstep.submit(goal), external)
            }
        };
        Self {
            lockstep,
            work: work.expect("nothing moves"),
            variant,
            cycles: 0,
            finishing: 0,
            refused: Vec::new(),
            external,
            seen: [None; 2],
            ended: false,
        }
    }

    /// Advances by one millisecond.
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
            external,
            cycles,
            ..
        } = self;
        match external {
            ExternalControl::None => {}
            ExternalControl::Writer {
                channel,
                follower,
                previous,
            } => {
                let state = lockstep.client.state;
                let previous = previous.replace(state.message_id);
                let step = state.message_id - previous.unwrap_or(state.message_id);
                let version = lockstep.client.version();
                let step = Duration::from_millis(step);
                let (command, finished) = follower.command(version, *channel, &state, step);
                match lockstep.write(&command, finished) {
                    Ok(()) if finished => {
                        // The state was read before it was known to be the last.
                        *cycles -= 1;
                        self.finishing += 1;
                    }
                    Ok(()) => {}
                    Err(error) => self.refused.push(error),
                }
            }
            ExternalControl::Targets { targets, q } => {
                let finished = match *cycles {
                    course::REST => false,
                    course::END => true,
                    _ => return,
                };
                targets.write(AsynchronousTarget { q: *q, finished });
            }
            ExternalControl::Leader { start } => {
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

    /// Sets another sparse target.
    pub(crate) fn give_target(&mut self, target: &AsynchronousTarget) {
        let ExternalControl::Targets { targets, .. } = &mut self.external else {
            panic!("{} has no sparse targets", self.variant);
        };
        targets.write(*target);
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

    /// True if the thread knows that the motion has run and ended.
    pub(crate) fn has_ended(&self) -> bool {
        self.ended
    }

    /// Runs until everything has ended, and returns the outcome.
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

    /// The text that libfranka appends to a reflex: the rate of the last state but one, lowered by
    /// the losses after it.
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

    /// Asserts that the next motion works, after a recovery if necessary, and that every request
    /// was answered.
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
        let mut next = Self::begin_on(self.lockstep, variant, Misbehaviour::FinishesAt(2));
        let outcome = next.outcome();
        assert!(outcome.is_ok(), "the next motion: {outcome:?}");
        let Lockstep { client, .. } = &next.lockstep;
        assert_eq!(client.resolved(), resolved + 1);
        assert_eq!(client.pending(), 0, "every request has been answered");
        assert_eq!(client.state.robot_mode, RobotMode::Idle);
    }
}

/// Milliseconds in which every motion has ended; the end of a followed goal takes half a second.
const MOST: u64 = 3000;
