//! Tuning of a session, and options that are refused.

use super::{turned, up};
use franka_model::Wrench;
use franka_model::collision::Obstacle;
use franka_rt::law::{Gains, Law};
use franka_rt::lifecycle::{Engagement, MotionError, Tuning};
use franka_rt::session::{ForceCap, Free, Goal, GoalError, Guard, Lapse, OnArrival, Target};
use franka_tests::lockstep::{Lockstep, for_each_robot};

#[test]
fn tuning_gains_does_not_step_the_torque_and_keeps_their_bounds() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let push = Wrench::new(0.0, 0.0, -6.0, 0.0, 0.0, 0.0);
        lockstep.robot.push_end_effector(push, 100_000);
        lockstep.run(1500);
        let before = lockstep.arm_pose();
        // Compensation would hold the arm up.
        let soft = Gains::cartesian()
            .without_compensation()
            .with_cartesian_stiffness([300.0, 300.0, 300.0, 15.0, 15.0, 15.0]);
        let gains = Some(soft);
        lockstep
            .tune(
                engaged,
                Tuning {
                    gains,
                    ..Tuning::default()
                },
            )
            .unwrap();
        let mut last = lockstep.client.record.tau_c;
        let mut step: f64 = 0.0;
        for _ in 0..1500 {
            lockstep.tick();
            let tau = lockstep.client.record.tau_c;
            for (now, last) in tau.iter().zip(last) {
                step = step.max((now - last).abs());
            }
            last = tau;
        }
        assert!(step < 0.1, "a step of {step} N m");
        let sunk = before.translation.z - lockstep.arm_pose().translation.z;
        assert!(sunk > 0.004, "{sunk} m");
        let mut hard = soft;
        hard.cartesian_stiffness[0] = 1e5;
        let gains = Some(hard);
        let refused = lockstep.tune(
            engaged,
            Tuning {
                gains,
                ..Tuning::default()
            },
        );
        assert!(matches!(
            refused,
            Err(MotionError::Goal(GoalError::Gains(_)))
        ));
    });
}

#[test]
fn gains_unused_while_guiding_are_checked_for_the_goal_after_it() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        lockstep
            .within(engaged, Target::Guide(Free::ALL), OnArrival::Hold)
            .expect("it is held");
        lockstep.run(300);
        let mut hard = Gains::cartesian();
        hard.cartesian_stiffness[0] = 1e5;
        let mut nowhere = Gains::cartesian().with_cartesian_stiffness([0.0; 6]);
        nowhere.project_joint_gains = true;
        for refused in [hard, nowhere] {
            let tuning = Tuning {
                gains: Some(refused),
                ..Tuning::default()
            };
            let outcome = lockstep.tune(engaged, tuning);
            assert!(matches!(outcome, Err(MotionError::Goal(_))), "{outcome:?}");
        }
        let cap = Tuning {
            force_cap: Some(ForceCap::Newtons(8.0)),
            ..Tuning::default()
        };
        assert_eq!(lockstep.tune(engaged, cap), Ok(()));
    });
}

#[test]
fn a_force_cap_is_tuned_within_its_bounds() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let cap = |cap| Tuning {
            force_cap: Some(cap),
            ..Tuning::default()
        };
        for refused in [4.9, 201.0, f64::NAN] {
            let outcome = lockstep.tune(engaged, cap(ForceCap::Newtons(refused)));
            assert!(
                matches!(
                    outcome,
                    Err(MotionError::Goal(GoalError::Number {
                        what: "force cap",
                        ..
                    }))
                ),
                "{outcome:?}"
            );
        }
        // The arm resists a push of 12 N under the default cap, and not under one of 8 N, until
        // that is removed.
        lockstep
            .robot
            .push_end_effector(Wrench::new(0.0, 12.0, 0.0, 0.0, 0.0, 0.0), 1_000_000);
        let bound = |lockstep: &mut Lockstep| {
            lockstep.run(600);
            lockstep.client.record.bindings.contains(Guard::ForceCap)
        };
        assert!(!bound(&mut lockstep));
        lockstep.tune(engaged, cap(ForceCap::Newtons(8.0))).unwrap();
        assert!(bound(&mut lockstep));
        lockstep.tune(engaged, cap(ForceCap::Off)).unwrap();
        assert!(!bound(&mut lockstep));
    });
}

#[test]
fn a_session_keeps_out_of_its_regions_and_refuses_invalid_ones() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let floor = Obstacle::floor(lockstep.arm_pose().translation.z - 0.1);
        let engaged = lockstep.engage_with(Engagement {
            keep_out: Some(vec![floor]),
            ..Engagement::default()
        });
        let down = up(&lockstep, -0.2);
        let goal = lockstep
            .within(engaged, Target::Pose(down), OnArrival::ReportAndHold)
            .unwrap();
        let outcome = lockstep.until_resolved(goal, 20_000);
        assert_eq!(outcome, Err(MotionError::Braked(Lapse::Blocked)));
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
        for regions in [vec![floor; 5], vec![Obstacle::floor(f64::NAN)]] {
            let engagement = Engagement {
                keep_out: Some(regions),
                ..Engagement::default()
            };
            let refused = lockstep.try_engage(engagement);
            assert!(
                matches!(refused, Err(MotionError::Goal(GoalError::KeepOut { .. }))),
                "{refused:?}"
            );
        }
    });
}

#[test]
fn gains_too_weak_to_hold_the_arm_are_refused() {
    let mut lockstep = Lockstep::ready();
    for gains in [
        Gains {
            law: Law::OperationalSpace,
            ..Gains::joint()
        },
        Gains {
            project_joint_gains: true,
            ..Gains::joint()
        },
    ] {
        let goal = lockstep.goal(turned(0.1), OnArrival::ReportAndFinish);
        let refused = lockstep.submit(Goal { gains, ..goal });
        assert_eq!(refused, Err(MotionError::Goal(GoalError::Unheld)));
    }
}
