//! Tuning of a session, and options that are refused.

use super::{turned, up};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::collision::Obstacle;
use franka_model::{JointVector, RobotKind, Wrench};
use franka_rt::law::{Gains, Law};
use franka_rt::lifecycle::{Engagement, MotionError, Tuning};
use franka_rt::session::{ForceCap, Free, Goal, GoalError, Guard, Lapse, Leash, OnArrival, Target};
use franka_sim::Arm;
use nalgebra::Translation3;

#[test]
fn tuning_gains_does_not_step_the_torque_and_keeps_their_bounds() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let push = Wrench::new(0.0, 0.0, -6.0, 0.0, 0.0, 0.0);
        lockstep.robot.push_end_effector(push, 100_000);
        lockstep.run(1500);
        let before = lockstep.arm_pose();
        // Compensation would support the arm.
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

/// The arm is held back on its way, far behind its reference on a long leash, which is then
/// shortened in a single call.
#[test]
fn leash_tightened_in_mid_motion_causes_no_step() {
    for kind in [RobotKind::Fr3, RobotKind::Fer] {
        let held = Free {
            axes: [true, false, true, true, true, true],
            elbow: true,
        };
        for name in ["joints", "pose", "guide"] {
            let mut lockstep = Lockstep::new(franka_sim::Config {
                arm: Some(Arm::realistic(kind)),
                ..Lockstep::config_of(kind)
            });
            let engaged = lockstep.engage();
            let tuning = |leash| Tuning {
                leash: Some(leash),
                force_cap: Some(ForceCap::Off),
                ..Tuning::default()
            };
            lockstep.tune(engaged, tuning(Leash::MOST)).unwrap();
            let aside = Translation3::new(0.0, 0.2, 0.0) * lockstep.arm_pose();
            let target = match name {
                "joints" => turned(0.6),
                "pose" => Target::Pose(aside),
                _ => Target::Guide(held),
            };
            let goal = lockstep.goal(target, OnArrival::Hold);
            let goal = tuning(Leash::MOST).apply(goal);
            lockstep.submit_within(engaged, goal).unwrap();
            lockstep.run(350);
            let push = Wrench::new(0.0, -28.0, 0.0, 0.0, 0.0, 0.0);
            lockstep.robot.push_end_effector(push, 100_000);
            lockstep.run(350);
            let stretch = |lockstep: &Lockstep| {
                let record = &lockstep.client.record;
                let joints = JointVector::from(record.q_ref) - JointVector::from(record.q);
                let (hand, reference) = (lockstep.arm_pose(), lockstep.reference_pose());
                let hand = reference.translation.vector - hand.translation.vector;
                (joints, hand, JointVector::from(record.tau_c))
            };
            let mut last = stretch(&lockstep);
            let before = (last.0.amax(), last.1.norm());
            lockstep.tune(engaged, tuning(Leash::LEAST)).unwrap();
            let mut most = [0.0_f64; 3];
            for _ in 0..400 {
                lockstep.tick();
                let now = stretch(&lockstep);
                most[0] = most[0].max((now.0 - last.0).amax());
                most[1] = most[1].max((now.1 - last.1).norm());
                most[2] = most[2].max((now.2 - last.2).amax());
                last = now;
            }
            let after = (last.0.amax(), last.1.norm());
            let [joints, hand, torque] = most;
            println!(
                "{kind:?} {name}: {before:.3?} rad and m ahead, then {after:.3?}; steps of \
                 {joints:.5} rad, {hand:.5} m, {torque:.2} N m"
            );
            assert!(before.0 > 0.037 && before.1 > 0.026, "{before:?}");
            assert!(after.0 < 0.0301 && after.1 < 0.025, "{after:?}");
            // The whole change of the leash in 0.3 s: 1.24 mrad and 0.32 mm a cycle, in addition to
            // the reference's own gain on the arm.
            assert!(joints < 1.5e-3 && hand < 0.8e-3, "{most:?}");
            assert!(torque < 0.6, "{most:?}");
        }
    }
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
        assert_eq!(
            outcome,
            Err(MotionError::Braked(Lapse::Blocked { region: Some(1) }))
        );
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
