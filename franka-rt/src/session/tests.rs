//! A session before the next state, and between a state and its answer.

mod product;

use super::condition::{elapsed, force_z};
use super::*;
use crate::triple_buffer::{Writer, triple_buffer};
use franka_model::{JointVector, READY, transform};
use franka_otg::AxisLimits;
use nalgebra::Isometry3;

/// Returns the size of a sample: `thorough` with `FRANKA_THOROUGH=1`, as in the nightly run, and
/// `otherwise` without it.
pub(crate) fn sample(thorough: usize, otherwise: usize) -> usize {
    match std::env::var("FRANKA_THOROUGH") {
        Ok(value) if value == "1" => thorough,
        _ => otherwise,
    }
}

/// A session whose arm is always at its reference.
struct Arm {
    session: TargetSession,
    goals: Writer<Goal>,
    state: RobotState,
    /// Report of the newest answer.
    event: Option<SessionEvent>,
}

impl Arm {
    fn new() -> Self {
        let (goals, reader) = triple_buffer();
        let rigid = transform::array(&Isometry3::identity());
        Self {
            session: TargetSession::new(Arc::new(Model::fr3().clone()), Version::V10, reader),
            goals,
            state: RobotState {
                q: READY.into(),
                F_T_EE: rigid,
                EE_T_K: rigid,
                ..RobotState::default()
            },
            event: None,
        }
    }

    /// Sets a goal that turns joint 1 by `by` from the ready posture, `[rad]`.
    fn turn(&mut self, id: u64, by: f64) {
        let mut q: [f64; 7] = READY.into();
        q[0] += by;
        let limits = Model::fr3().joint_limits();
        let goal = Goal::new(GoalId(id), q.into(), OnArrival::ReportAndHold, limits);
        self.goals.write(goal);
    }

    fn answer(&mut self, gate: Gate) -> SessionStep {
        self.state.message_id += 1;
        self.event = None;
        let step = self.session.answer(gate, &self.state, &mut self.event);
        self.state.q = step.trace.reference.q.into();
        self.state.dq = step.trace.reference.dq.into();
        step
    }

    /// Returns how the next goal ends.
    fn settles(&mut self, gate: Gate) -> (GoalId, Settlement) {
        for _ in 0..10_000 {
            self.session.prepare();
            self.answer(gate);
            if let Some(SessionEvent::Settled {
                goal, settlement, ..
            }) = self.event
            {
                return (goal, settlement);
            }
        }
        panic!("no goal settles")
    }
}

#[test]
fn a_goal_moves_the_answer_that_is_prepared_after_it() {
    let mut arm = Arm::new();
    arm.turn(1, 0.0);
    arm.answer(Gate::Open);
    arm.session.prepare();
    arm.turn(2, 0.1);
    assert_eq!(arm.answer(Gate::Open).trace.goal, GoalId(1));
    arm.session.prepare();
    // Preparing twice has no effect.
    arm.turn(3, -0.1);
    arm.session.prepare();
    let step = arm.answer(Gate::Open);
    assert_eq!(step.trace.goal, GoalId(2));
    assert!(step.trace.reference.dq[0] > 0.0);
}

#[test]
fn an_answer_that_is_not_prepared_is_computed_all_the_same() {
    let mut arm = Arm::new();
    arm.turn(1, 0.1);
    for _ in 0..100 {
        arm.answer(Gate::Open);
    }
    assert!(arm.state.dq[0] > 0.0);
}

/// A reference that lagged by one cycle would pull the hand back.
#[test]
fn a_guided_arm_is_answered_from_where_it_is() {
    let mut arm = Arm::new();
    let limits = Model::fr3().joint_limits();
    let guided = Target::Guide(Free::ALL);
    let goal = Goal::new(GoalId(1), guided, OnArrival::Hold, limits);
    arm.goals.write(goal);
    for cycle in 0..1000 {
        arm.state.q[0] += if cycle < 10 { 0.0 } else { 1e-3 };
        let q = arm.state.q;
        let reference = arm.answer(Gate::Open).trace.reference;
        arm.session.prepare();
        assert_eq!(reference.q, JointVector::from(q), "cycle {cycle}");
    }
}

#[test]
fn goal_at_a_broken_start_is_not_taken_for_the_waiting_one() {
    let fault = StartFault::Withdrawn { member: 1 };
    for another in [false, true] {
        let mut arm = Arm::new();
        arm.turn(1, 0.1);
        assert!(!arm.session.is_withdrawn());
        arm.answer(Gate::Closed);
        arm.session.prepare();
        arm.answer(Gate::Broken(fault));
        let expected = if another {
            arm.turn(2, 0.1);
            GoalId(2)
        } else {
            GoalId(1)
        };
        let (goal, settlement) = arm.settles(Gate::Broken(fault));
        assert_eq!(goal, expected);
        let unstarted = settlement == Settlement::Unstarted(fault);
        assert_eq!(unstarted, !another, "{settlement:?}");
    }
}

/// Returns a goal for a turn of joint 1. It reacts to 5 N along z, or after a number of
/// milliseconds.
fn watched(by: f64, milliseconds: u64) -> Goal {
    let mut q: [f64; 7] = READY.into();
    q[0] += by;
    let limits = Model::fr3().joint_limits();
    let due = elapsed(Duration::from_millis(milliseconds));
    Goal {
        reaction: Some((force_z(5.0) | due).into()),
        ..Goal::new(GoalId(1), q.into(), OnArrival::ReportAndHold, limits)
    }
}

#[test]
fn non_finite_force_is_answered_without_a_reaction() {
    let mut arm = Arm::new();
    arm.goals.write(watched(1.0, 100_000));
    for force in [0.0, f64::NAN, f64::INFINITY, 0.0] {
        arm.state.O_F_ext_hat_K[2] = force;
        for _ in 0..50 {
            let step = arm.answer(Gate::Open);
            arm.session.prepare();
            assert!(!step.trace.bindings.contains(Guard::Reaction), "{force}");
            assert!(step.trace.reference.q.iter().all(|q| q.is_finite()));
        }
    }
    arm.state.O_F_ext_hat_K[2] = -5.0;
    let before = arm.answer(Gate::Open);
    arm.session.prepare();
    let after = arm.answer(Gate::Open);
    let says_so = |step: &SessionStep| step.trace.bindings.contains(Guard::Reaction);
    assert_eq!((says_so(&before), says_so(&after)), (false, true));
}

#[test]
fn goal_does_not_react_before_its_common_start() {
    let mut arm = Arm::new();
    arm.goals.write(watched(1.0, 100));
    assert!(!arm.session.is_withdrawn());
    arm.state.O_F_ext_hat_K[2] = -20.0;
    for _ in 0..500 {
        arm.answer(Gate::Closed);
        arm.session.prepare();
    }
    arm.state.O_F_ext_hat_K[2] = 0.0;
    let opens = arm.state.message_id;
    for _ in 0..1000 {
        arm.answer(Gate::Open);
        arm.session.prepare();
        if let Some(SessionEvent::Settled { reacted, .. }) = arm.event {
            let reacted = reacted.expect("a reaction");
            assert_eq!(reacted.after, Duration::from_millis(100));
            // The second state that finds the gate open is the first state of the goal.
            assert_eq!(reacted.time - opens, 102);
            return;
        }
    }
    panic!("no reaction");
}

/// Uses a budget that goals may not have. The session does not check the budget.
#[test]
fn a_time_too_long_for_a_duration_does_not_panic() {
    let mut arm = Arm::new();
    let mut q: [f64; 7] = READY.into();
    q[0] += 0.3;
    let limits = Model::fr3().joint_limits();
    let mut goal = Goal::new(GoalId(1), q.into(), OnArrival::ReportAndHold, limits);
    for joint in &mut goal.budget.joints {
        joint.velocity = 1e-20;
    }
    arm.goals.write(goal);
    arm.answer(Gate::Open);
    arm.session.prepare();
    let step = arm.answer(Gate::Open);
    assert_eq!(step.trace.remaining, Duration::MAX);
}

/// The state shows that a tool is mounted, but not its shape.
#[test]
fn room_for_the_hand_is_kept_only_with_a_tool() {
    let end = |m_ee: f64| {
        let mut arm = Arm::new();
        arm.state.m_ee = m_ee;
        let mut q: [f64; 7] = READY.into();
        q[1] += 1.7;
        let limits = Model::fr3().joint_limits();
        let goal = Goal::new(GoalId(1), q.into(), OnArrival::ReportAndHold, limits);
        arm.goals.write(goal);
        arm.settles(Gate::Open).1
    };
    let bare = end(0.0);
    assert!(matches!(bare, Settlement::Arrived(_)), "{bare:?}");
    let blocked = Settlement::Braked(Lapse::Blocked { region: None });
    assert_eq!(end(0.73), blocked);
}

#[test]
fn a_budget_has_least_limits_with_which_a_plan_ends() {
    let (model, state) = (Model::fr3(), Arm::new().state);
    let mut q: [f64; 7] = READY.into();
    q[0] += 0.3;
    let limits = model.joint_limits();
    let goal = Goal::new(GoalId(1), q.into(), OnArrival::ReportAndHold, limits);
    let slowest = goal.budget.at_speed(Budget::SPEED_MIN, model).unwrap();
    let slow = Goal {
        budget: slowest,
        ..goal
    };
    assert_eq!(slow.check(model, &state), Ok(()));
    let [velocity, acceleration, jerk] = Budget::LIMITS_MIN;
    let least = AxisLimits {
        velocity,
        acceleration,
        jerk,
    };
    type Limit = fn(&mut AxisLimits) -> &mut f64;
    let each: [Limit; 3] = [
        |l| &mut l.velocity,
        |l| &mut l.acceleration,
        |l| &mut l.jerk,
    ];
    for axis in 0..9 {
        let with = |limits: AxisLimits| {
            let mut goal = goal;
            *match axis {
                0..7 => &mut goal.budget.joints[axis],
                7 => &mut goal.budget.translation,
                _ => &mut goal.budget.rotation,
            } = limits;
            goal.check(model, &state)
        };
        assert_eq!(with(least), Ok(()), "axis {axis}");
        for limit in each {
            let mut smaller = least;
            *limit(&mut smaller) *= 0.9;
            let error = with(smaller).unwrap_err();
            assert!(matches!(error, GoalError::Budget { .. }), "{error}");
        }
    }
    let mut arm = Arm::new();
    arm.goals.write(Goal {
        budget: Budget {
            joints: [least; 7],
            ..goal.budget
        },
        ..goal
    });
    arm.answer(Gate::Open);
    arm.session.prepare();
    let days = arm.answer(Gate::Open).trace.remaining.as_secs() / 86_400;
    assert!((1..30).contains(&days), "{days} days");
}
