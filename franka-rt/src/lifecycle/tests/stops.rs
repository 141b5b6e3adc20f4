//! Stops, with states that show a motion for longer than they should.

use super::*;

/// Returns the outcome of a stop, without the report of a success.
fn ended(pair: &LifecycleAndDriver, id: u64) -> Option<Result<(), MotionError>> {
    let mut of_id = pair.resolved.iter().filter(|(goal, _)| *goal == GoalId(id));
    let outcome = of_id.next().map(|(_, result)| result.clone().map(drop));
    assert!(of_id.next().is_none(), "it resolves once");
    outcome
}

impl LifecycleAndDriver {
    fn stop(&mut self, id: u64) -> bool {
        let stops = self.lifecycle.stop(GoalId(id), &self.state, NOW);
        self.settle();
        stops
    }

    fn stop_requests(&self) -> usize {
        let sent = self.sent.iter();
        sent.filter(|sent| **sent == Request::StopMove).count()
    }

    /// Lets the next deadline pass.
    fn time_passes(&mut self, unseen: Option<MotionError>) {
        let deadline = self.lifecycle.deadline().expect("it does not wait forever");
        self.lifecycle.on_time(deadline, unseen);
        self.settle();
    }

    /// The robot shows no motion, and this velocity of joint 1.
    fn comes_to(&mut self, dq: f64) {
        self.state.motion_generator_mode = MotionGeneratorMode::Idle;
        self.state.dq[0] = dq;
        self.cycle(RobotMode::Idle);
    }
}

/// The robot was asked to stop, but still shows the motion after the deadline.
fn given_up() -> LifecycleAndDriver {
    let (mut pair, motion, _) = LifecycleAndDriver::moving();
    let violation = Violation::SecondMotionStarted { id: CommandId(1) };
    pair.lifecycle.on_move_violation(motion, violation, NOW);
    pair.settle();
    pair.time_passes(None);
    assert!(pair.lifecycle.is_idle());
    pair
}

#[test]
fn stop_of_a_motion_given_up_fails_while_the_robot_shows_it() {
    let mut pair = given_up();
    for (id, requests) in [(10, 2), (11, 3)] {
        assert!(pair.stop(id), "the robot may still run it");
        assert_eq!(pair.stop_requests(), requests, "told once more");
        assert!(!pair.lifecycle.is_idle());
        pair.cycle(RobotMode::Move);
        assert_eq!(ended(&pair, id), None);
        pair.time_passes(None);
        assert_eq!(ended(&pair, id), Some(Err(STILL_SHOWN)));
        assert!(pair.lifecycle.is_idle());
    }
}

#[test]
fn stop_of_abandoned_motion_resolves_with_the_arm_at_rest() {
    let mut pair = given_up();
    assert!(pair.stop(10) && pair.stop(11));
    pair.comes_to(0.2);
    assert_eq!((ended(&pair, 10), ended(&pair, 11)), (None, None));
    pair.comes_to(0.002);
    assert_eq!(
        (ended(&pair, 10), ended(&pair, 11)),
        (Some(Ok(())), Some(Ok(())))
    );
    assert!(!pair.stop(12), "the arm rests already");
}

#[test]
fn stop_while_the_cycle_is_lent_and_not_run_waits_for_a_state() {
    let silence = Duration::from_millis(100);
    let (mut pair, _, _) = LifecycleAndDriver::moving();
    pair.lifecycle.on_stall(Some(silence), NOW);
    pair.settle();
    assert!(pair.stop(10));
    assert_eq!(pair.stop_requests(), 2);
    let hung = MotionError::Hung { silence };
    pair.time_passes(Some(hung.clone()));
    assert_eq!(ended(&pair, 10), Some(Err(hung)));
    assert!(pair.stop(11));
    pair.lifecycle.on_stall(None, NOW);
    pair.cycle(RobotMode::Move);
    assert_eq!(ended(&pair, 11), None);
    pair.comes_to(0.0);
    assert_eq!(ended(&pair, 11), Some(Ok(())));
}

#[test]
fn stop_without_own_motion_waits_for_a_moving_arm() {
    let mut pair = LifecycleAndDriver::new();
    assert!(!pair.stop(10), "it rests");
    pair.cycle(RobotMode::Move);
    assert!(pair.stop(11));
    assert_eq!(pair.sent, [Request::StopMove]);
    pair.comes_to(0.2);
    pair.time_passes(None);
    let moves = MotionError::NotAtRest {
        joint: 1,
        velocity: 0.2,
    };
    assert_eq!(ended(&pair, 11), Some(Err(moves)));
    // A state that is not finite does not show rest.
    pair.comes_to(f64::NAN);
    assert!(pair.stop(12));
    pair.comes_to(0.0);
    assert_eq!(ended(&pair, 12), Some(Ok(())));
}

#[test]
fn stop_waiting_for_a_state_is_superseded_by_a_motion() {
    let mut pair = LifecycleAndDriver::new();
    pair.comes_to(0.2);
    assert!(pair.stop(10));
    let limits = Model::fr3().joint_limits();
    let goal = Goal::new(GoalId(1), Target::Rest, OnArrival::Hold, limits);
    let begun = pair.lifecycle.begin(NewMotion::to(goal), &pair.state, NOW);
    pair.settle();
    assert_eq!(begun, Ok(()));
    assert_eq!(ended(&pair, 10), Some(Err(MotionError::Superseded)));
}

#[test]
fn stop_that_waits_for_a_state_ends_with_the_connection() {
    let mut pair = given_up();
    assert!(pair.stop(10));
    pair.lifecycle
        .on_connection_closed(CloseReason::ClosedByPeer);
    pair.settle();
    let reason = CloseReason::ClosedByPeer;
    let closed = Some(Err(MotionError::ConnectionClosed { reason }));
    assert_eq!(ended(&pair, 10), closed);
    assert!(!pair.stop(11));
}

#[test]
fn stops_at_the_same_time_share_one_brake() {
    let (mut pair, motion, goal) = LifecycleAndDriver::moving();
    assert!(pair.stop(10) && pair.stop(11));
    assert_eq!(pair.resolved, [(goal, Err(MotionError::Stopped))]);
    for _ in 0..2000 {
        pair.cycle(RobotMode::Move);
    }
    pair.lifecycle
        .on_move_reply(motion, MoveStatus::Success, NOW);
    pair.settle();
    pair.comes_to(0.2);
    assert_eq!((ended(&pair, 10), ended(&pair, 11)), (None, None));
    pair.comes_to(0.0);
    assert_eq!(
        (ended(&pair, 10), ended(&pair, 11)),
        (Some(Ok(())), Some(Ok(())))
    );
}

#[test]
fn stop_of_an_arm_that_does_not_rest_has_the_robot_stop_it() {
    let (mut pair, motion, _) = LifecycleAndDriver::moving();
    assert!(pair.stop(10));
    pair.state.dq[0] = 0.2;
    for _ in 0..500 {
        pair.cycle(RobotMode::Move);
    }
    assert_eq!(pair.lifecycle.deadline(), Some(NOW + BRAKE_TIMEOUT));
    assert_eq!(pair.stop_requests(), 0);
    pair.time_passes(None);
    assert_eq!(pair.stop_requests(), 1);
    // A new motion waits, and is not stopped with the first one.
    let limits = Model::fr3().joint_limits();
    let goal = Goal::new(GoalId(2), Target::Rest, OnArrival::Hold, limits);
    let begun = pair.lifecycle.begin(NewMotion::to(goal), &pair.state, NOW);
    assert_eq!(begun, Ok(()));
    pair.lifecycle
        .on_move_reply(motion, MoveStatus::Preempted, NOW);
    assert_eq!(ended(&pair, 10), None, "the robot shows the motion");
    pair.comes_to(0.2);
    assert!(matches!(pair.sent.last(), Some(Request::Move(_))));
    assert_eq!(ended(&pair, 10), Some(Err(MotionError::Superseded)));
    assert_eq!(ended(&pair, 2), None);
}

#[test]
fn stop_by_the_robot_resolves_with_the_arm_at_rest() {
    let (mut pair, motion, _) = LifecycleAndDriver::moving();
    assert!(pair.stop(10) && pair.stop(11));
    pair.state.dq[0] = 0.2;
    pair.cycle(RobotMode::Move);
    pair.time_passes(None);
    pair.lifecycle
        .on_move_reply(motion, MoveStatus::Preempted, NOW);
    pair.comes_to(0.2);
    assert_eq!((ended(&pair, 10), ended(&pair, 11)), (None, None));
    pair.comes_to(0.0);
    assert_eq!(
        (ended(&pair, 10), ended(&pair, 11)),
        (Some(Ok(())), Some(Ok(())))
    );
    assert_eq!(pair.stop_requests(), 1);
}

#[test]
fn goal_sent_during_a_robot_stop_gets_its_own_motion() {
    let (mut pair, motion, goal) = LifecycleAndDriver::moving();
    pair.lifecycle.cancel(goal, NOW);
    pair.settle();
    pair.state.dq[0] = 0.2;
    let limits = Model::fr3().joint_limits();
    let next = Goal::new(GoalId(2), Target::Rest, OnArrival::Hold, limits);
    let mut events = Vec::new();
    for _ in 0..5000 {
        pair.state.message_id += 1;
        pair.driver.on_state(&pair.state);
        while let Some(event) = pair.driver.take_event() {
            events.push(event);
        }
    }
    assert!(matches!(
        events.last(),
        Some(Event::Program {
            event: SessionEvent::Restless,
            ..
        })
    ));
    let begun = pair.lifecycle.begin(NewMotion::to(next), &pair.state, NOW);
    assert_eq!(begun, Ok(()));
    assert_eq!(ended(&pair, 1), None);
    for event in events {
        pair.lifecycle.on_event(event, NOW);
    }
    pair.settle();
    assert_eq!(pair.stop_requests(), 1);
    pair.lifecycle
        .on_move_reply(motion, MoveStatus::Preempted, NOW);
    pair.comes_to(0.2);
    assert!(matches!(pair.sent.last(), Some(Request::Move(_))));
    assert_eq!(ended(&pair, 1), Some(Err(MotionError::Superseded)));
    assert_eq!(ended(&pair, 2), None);
}

/// The robot is silent for less than the link timeout when deadlines pass: nothing is known yet.
#[test]
fn deadlines_that_pass_in_a_short_silence_move_to_the_link_timeout() {
    let silence = Duration::from_millis(10);
    let short = || Some(MotionError::LinkLost { silence });
    let (mut pair, _, _) = LifecycleAndDriver::moving();
    assert!(pair.stop(10));
    let later = BRAKE_TIMEOUT + Duration::from_secs(1);
    let second = pair.lifecycle.stop(GoalId(11), &pair.state, NOW + later);
    assert!(second);
    let passed = NOW + BRAKE_TIMEOUT;
    pair.lifecycle.on_time(passed, short());
    let moved = passed + LINK_TIMEOUT - silence;
    assert_eq!(pair.lifecycle.deadline(), Some(moved));
    assert_eq!(pair.stop_requests(), 0);
    pair.lifecycle.on_time(moved, None);
    pair.settle();
    assert_eq!(pair.stop_requests(), 1);

    let (mut pair, motion, _) = LifecycleAndDriver::moving();
    let violation = Violation::SecondMotionStarted { id: CommandId(1) };
    pair.lifecycle.on_move_violation(motion, violation, NOW);
    let passed = NOW + END_TIMEOUT + Duration::from_millis(1);
    pair.lifecycle.on_time(passed, short());
    let moved = passed + LINK_TIMEOUT - silence;
    assert_eq!(pair.lifecycle.deadline(), Some(moved));
    assert!(!pair.lifecycle.is_idle(), "the next motion waits");
    pair.lifecycle.on_time(moved, None);
    assert!(pair.lifecycle.is_idle());
}
