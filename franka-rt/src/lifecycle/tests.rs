//! The lifecycle, with a driver whose states the test supplies.

mod product;
mod stops;

use franka_model::READY;
use franka_proto::{CommandId, MotionGeneratorMode, MoveStatus, RobotMode, RobotState, Violation};

use super::ending::STILL_SHOWN;
use super::goal_progress::Verdict;
use super::*;
use crate::control::{Failure, Modes};
use crate::driver::{Driver, Event};
use crate::session::{Chunk, Goal, OnArrival, SessionEvent, Target, Waypoint};
use crate::shaping::InvalidCommand;

const NOW: Duration = Duration::ZERO;

struct LifecycleAndDriver {
    lifecycle: Lifecycle,
    driver: Driver,
    sent: Vec<Request>,
    resolved: Vec<(GoalId, Outcome)>,
    state: RobotState,
}

impl LifecycleAndDriver {
    fn new() -> Self {
        let state = RobotState {
            q: READY.into(),
            q_d: READY.into(),
            ..RobotState::default()
        };
        Self {
            lifecycle: Lifecycle::new(Model::fr3().clone().into(), Version::V10),
            driver: Driver::new(Version::V10),
            sent: Vec::new(),
            resolved: Vec::new(),
            state,
        }
    }

    /// Passes outputs of the lifecycle to the driver and events of the driver to the lifecycle,
    /// until none are left.
    fn settle(&mut self) {
        loop {
            self.lifecycle.on_state(&self.state, NOW);
            while let Some(output) = self.lifecycle.poll() {
                match output {
                    Output::Order(order) => self.driver.on_order(order),
                    Output::Send { request, .. } => self.sent.push(request),
                    Output::Began { .. } => {}
                    Output::Resolve { goal, result } => self.resolved.push((goal, result)),
                }
            }
            let Some(event) = self.driver.take_event() else {
                break;
            };
            self.lifecycle.on_event(event, NOW);
        }
    }

    /// Runs a cycle of the robot in this mode. Returns true if the cycle is answered.
    fn cycle(&mut self, robot_mode: RobotMode) -> bool {
        self.state.message_id += 1;
        self.state.robot_mode = robot_mode;
        let answered = self.driver.on_state(&self.state).is_some();
        self.settle();
        answered
    }

    /// Returns a motion to a joint target that the robot has started, and its goal.
    fn moving() -> (Self, MotionId, GoalId) {
        let mut pair = Self::new();
        let mut target: [f64; 7] = READY.into();
        target[0] += 0.3;
        let id = GoalId(1);
        let limits = Model::fr3().joint_limits();
        let goal = Goal::new(
            id,
            Target::Joints(target),
            OnArrival::ReportAndFinish,
            limits,
        );
        let begun = pair.lifecycle.begin(NewMotion::to(goal), &pair.state, NOW);
        begun.expect("it is accepted");
        pair.settle();
        let motion = MotionId(1);
        pair.run_started(motion);
        (pair, motion, id)
    }

    fn run_started(&mut self, motion: MotionId) {
        let Some(Request::Move(request)) = self.sent.last() else {
            panic!("{:?}", self.sent)
        };
        let modes = Modes::of(request);
        self.state.motion_generator_mode = modes.generator;
        self.state.controller_mode = modes.controller;
        let started = MoveStatus::MotionStarted;
        self.lifecycle.on_move_reply(motion, started, NOW);
        for _ in 0..20 {
            assert!(self.cycle(RobotMode::Move));
        }
    }
}

#[test]
fn a_goal_whose_program_fails_has_the_robot_stop_and_says_why() {
    let (mut pair, motion, goal) = LifecycleAndDriver::moving();
    let failure = Failure::Invalid(InvalidCommand::NotFinite);
    pair.lifecycle
        .on_event(Event::Failed { motion, failure }, NOW);
    pair.settle();
    assert_eq!(pair.sent.last(), Some(&Request::StopMove));
    assert_eq!(pair.resolved, [], "the motion has not ended yet");
    pair.lifecycle
        .on_move_reply(motion, MoveStatus::Preempted, NOW);
    pair.cycle(RobotMode::Idle);
    let reason = MotionError::Invalid(InvalidCommand::NotFinite);
    assert_eq!(pair.resolved, [(goal, Err(reason))]);
    assert!(pair.lifecycle.is_idle());
}

#[test]
fn an_arm_on_its_way_is_braked_after_the_connection_is_gone() {
    let (mut pair, _, goal) = LifecycleAndDriver::moving();
    pair.lifecycle
        .on_connection_closed(CloseReason::ClosedByPeer);
    pair.lifecycle.on_connection_closed(CloseReason::ClosedByUs);
    pair.settle();
    let reason = CloseReason::ClosedByPeer;
    let closed = Err(MotionError::ConnectionClosed { reason });
    assert_eq!(pair.resolved, [(goal, closed)], "at once");
    assert!(pair.lifecycle.is_braking());
    assert!(pair.cycle(RobotMode::Move), "the thread goes on");
    assert!(pair.lifecycle.is_braking());
    pair.cycle(RobotMode::Idle);
    assert!(!pair.lifecycle.is_braking(), "the motion has ended");

    let mut idle = LifecycleAndDriver::new();
    idle.lifecycle
        .on_connection_closed(CloseReason::ClosedByPeer);
    assert!(!idle.lifecycle.is_braking(), "nothing moves");
}

#[test]
fn stalled_borrower_ends_motion_and_blocks_new_ones() {
    let (mut pair, _, goal) = LifecycleAndDriver::moving();
    let silence = Duration::from_millis(100);
    pair.lifecycle.on_stall(Some(silence), NOW);
    pair.settle();
    assert_eq!(pair.sent.last(), Some(&Request::StopMove));
    assert_eq!(
        pair.resolved,
        [(goal, Err(MotionError::Stalled { silence }))]
    );
    let state = pair.state;
    let submit = |lifecycle: &mut Lifecycle, id| {
        let limits = Model::fr3().joint_limits();
        let target = Target::Joints(READY.into());
        let goal = Goal::new(GoalId(id), target, OnArrival::ReportAndFinish, limits);
        lifecycle.begin(NewMotion::to(goal), &state, NOW)
    };
    assert_eq!(submit(&mut pair.lifecycle, 2), Err(MotionError::Busy));
    pair.lifecycle.on_stall(None, NOW);
    assert_eq!(submit(&mut pair.lifecycle, 3), Ok(()), "it waits");
    assert_eq!(pair.lifecycle.poll().map(drop), None, "the robot moves");
    pair.cycle(RobotMode::Idle);
    assert!(matches!(pair.sent.last(), Some(Request::Move(_))));
}

/// The robot is asked to stop the first motion, but continues to show it.
#[test]
fn motion_waits_for_end_of_an_abandoned_one_or_fails() {
    let (mut pair, motion, first) = LifecycleAndDriver::moving();
    let violation = Violation::SecondMotionStarted { id: CommandId(1) };
    pair.lifecycle.on_move_violation(motion, violation, NOW);
    let begin = |pair: &mut LifecycleAndDriver, id| {
        let limits = Model::fr3().joint_limits();
        let goal = Goal::new(GoalId(id), Target::Rest, OnArrival::Hold, limits);
        let begun = pair.lifecycle.begin(NewMotion::to(goal), &pair.state, NOW);
        pair.settle();
        begun
    };
    assert_eq!(begin(&mut pair, 2), Ok(()));
    assert_eq!(begin(&mut pair, 3), Ok(()));
    let moves = |pair: &LifecycleAndDriver| {
        let sent = pair.sent.iter();
        sent.filter(|sent| matches!(sent, Request::Move(_))).count()
    };
    assert_eq!(moves(&pair), 1);
    assert!(!pair.lifecycle.is_idle());
    let deadline = pair
        .lifecycle
        .deadline()
        .expect("it does not wait for ever");
    pair.lifecycle.on_time(deadline, None);
    assert_eq!(begin(&mut pair, 4), Err(STILL_SHOWN));
    assert_eq!(
        pair.resolved,
        [
            (first, Err(MotionError::Violation(violation))),
            (GoalId(2), Err(MotionError::Superseded)),
            (GoalId(3), Err(STILL_SHOWN)),
        ]
    );
    assert!(pair.lifecycle.is_idle(), "it is not waited for any more");
    pair.cycle(RobotMode::Idle);
    assert_eq!(begin(&mut pair, 5), Ok(()));
    assert_eq!(moves(&pair), 2);
}

/// A session ends, but its outcome is not known yet. A separate path waits for the outcome. A path
/// for the session resolves with the outcome.
#[test]
fn two_paths_that_wait_for_the_same_end_do_not_change_places() {
    let mut pair = LifecycleAndDriver::new();
    let model = Model::fr3();
    let goal = |id, on_arrival| {
        let target = Target::Rest;
        Box::new(Goal::new(
            GoalId(id),
            target,
            on_arrival,
            model.joint_limits(),
        ))
    };
    let engaged = GoalId(1);
    let session = NewMotion::Session {
        goal: goal(1, OnArrival::Hold),
        engagement: Engagement::default(),
    };
    assert_eq!(pair.lifecycle.begin(session, &pair.state, NOW), Ok(()));
    pair.settle();
    pair.run_started(MotionId(1));
    pair.cycle(RobotMode::UserStopped);
    let along = |pair: &mut LifecycleAndDriver, id, by: f64, session| {
        let goal = goal(id, OnArrival::ReportAndFinish);
        let mut q: [f64; 7] = READY.into();
        q[0] += by;
        let (way, state) = ([Waypoint::new(q)], &pair.state);
        let path = Chunk::through(&way, &state.q, &goal, model, state).expect("it is reachable");
        let motion = NewMotion::Goal {
            goal,
            path: Some(Box::new(path)),
            ticket: None,
            session,
        };
        pair.lifecycle.begin(motion, &pair.state, NOW)
    };
    assert_eq!(along(&mut pair, 2, 0.3, None), Ok(()));
    assert_eq!(along(&mut pair, 3, -0.3, Some(engaged)), Ok(()));
    pair.lifecycle
        .on_move_reply(MotionId(1), MoveStatus::Preempted, NOW);
    pair.settle();
    assert!(matches!(
        &pair.resolved[..],
        [(GoalId(3), Err(_)), (GoalId(1), Err(_))]
    ));
    pair.run_started(MotionId(2));
    let heading = pair.lifecycle.heading();
    assert!(matches!(heading, Some((GoalId(2), Target::Joints(q))) if q[0] == READY[0] + 0.3));
    for _ in 0..200 {
        pair.cycle(RobotMode::Move);
    }
    assert!(
        pair.driver.record().q_ref[0] > READY[0] + 0.001,
        "it follows its own path"
    );
}

#[test]
fn robot_that_runs_a_motion_and_answers_no_move_is_blamed_for_that() {
    let mut pair = LifecycleAndDriver::new();
    let limits = Model::fr3().joint_limits();
    let goal = Goal::new(GoalId(1), Target::Rest, OnArrival::Hold, limits);
    let begun = pair.lifecycle.begin(NewMotion::to(goal), &pair.state, NOW);
    assert_eq!(begun, Ok(()));
    pair.settle();
    let Some(Request::Move(request)) = pair.sent.last() else {
        panic!("{:?}", pair.sent)
    };
    let modes = Modes::of(request);
    pair.state.motion_generator_mode = modes.generator;
    pair.state.controller_mode = modes.controller;
    assert!(pair.cycle(RobotMode::Move));
    pair.lifecycle.on_time(NOW + START_TIMEOUT, None);
    pair.settle();
    assert_eq!(pair.sent.last(), Some(&Request::StopMove));
    pair.lifecycle
        .on_move_reply(MotionId(1), MoveStatus::Preempted, NOW);
    pair.state.motion_generator_mode = MotionGeneratorMode::Idle;
    pair.cycle(RobotMode::Idle);
    let what = "the robot never answered the Move command";
    let blamed = Err(MotionError::Protocol { what });
    assert_eq!(pair.resolved, [(GoalId(1), blamed)]);
}

/// The arm has settled and is being released when the next goal comes.
#[test]
fn goal_that_has_settled_is_not_superseded() {
    let (mut pair, _, goal) = LifecycleAndDriver::moving();
    let has_settled = |pair: &LifecycleAndDriver| {
        let goals = pair.lifecycle.goals();
        matches!(goals.map(|it| &it.verdict), Some(Verdict::Settled(_)))
    };
    let settles = (0..5000).any(|_| {
        let record = pair.driver.record();
        (pair.state.q, pair.state.dq) = (record.q_ref, record.dq_ref);
        pair.cycle(RobotMode::Move);
        has_settled(&pair)
    });
    assert!(settles && pair.resolved.is_empty());
    let limits = Model::fr3().joint_limits();
    let next = Goal::new(GoalId(2), Target::Rest, OnArrival::Hold, limits);
    let begun = pair.lifecycle.begin(NewMotion::to(next), &pair.state, NOW);
    assert_eq!(begun, Ok(()));
    pair.settle();
    assert!(
        matches!(&pair.resolved[..], [(id, Ok(_))] if *id == goal),
        "{:?}",
        pair.resolved
    );
}

#[test]
fn cancelled_goal_leaves_the_goal_that_waits_as_it_is() {
    let (mut pair, motion, goal) = LifecycleAndDriver::moving();
    pair.lifecycle
        .on_move_reply(motion, MoveStatus::Preempted, NOW);
    let mut q: [f64; 7] = READY.into();
    q[0] += 0.1;
    let (target, limits) = (Target::Joints(q), Model::fr3().joint_limits());
    let next = Goal::new(GoalId(2), target, OnArrival::ReportAndFinish, limits);
    let begun = pair.lifecycle.begin(NewMotion::to(next), &pair.state, NOW);
    assert_eq!(begun, Ok(()));
    pair.lifecycle.cancel(goal, NOW);
    assert_eq!(pair.lifecycle.heading(), Some((GoalId(2), target)));
}
