//! Options of a goal that change how it is pursued: leash, deviation, torques, settling, posture.

use core::time::Duration;

use franka_lockstep::Lockstep;
use franka_model::{JointVector, RobotKind, Wrench};
use franka_rt::law::Gains;
use franka_rt::lifecycle::{MotionError, NewMotion, Party, Tuning};
use franka_rt::session::{
    Deviation, Goal, GoalError, GoalId, Guard, Lapse, Lead, Leash, OnArrival, Settling, Target,
    Waypoint,
};
use franka_sim::Arm;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

/// Runs the test on a realistic arm of each kind.
fn for_each_arm(test: impl Fn(&dyn Fn() -> Lockstep)) {
    for kind in [RobotKind::Fr3, RobotKind::Fer] {
        test(&|| {
            Lockstep::new(franka_sim::Config {
                arm: Some(Arm::realistic(kind)),
                ..Lockstep::config_of(kind)
            })
        });
    }
}

/// 12 cm to the side and down.
fn aside(lockstep: &Lockstep) -> Isometry3<f64> {
    Translation3::new(0.02, 0.1, -0.06) * lockstep.arm_pose()
}

fn submit(
    lockstep: &mut Lockstep,
    target: Isometry3<f64>,
    change: impl Fn(Goal) -> Goal,
) -> GoalId {
    let goal = lockstep.goal(Target::Pose(target), OnArrival::ReportAndFinish);
    lockstep.submit(change(goal)).expect("within the bounds")
}

/// Moves to a target and returns the greatest torque of each joint during the motion, without
/// gravity, `[N m]`.
fn arrive(
    lockstep: &mut Lockstep,
    target: Isometry3<f64>,
    change: impl Fn(Goal) -> Goal,
) -> JointVector {
    let id = submit(lockstep, target, change);
    let mut most = JointVector::zeros();
    while lockstep.client.outcome(id).is_none() {
        lockstep.tick();
        most = most.sup(&JointVector::from(lockstep.client.record.tau_c).abs());
    }
    lockstep
        .until_resolved(id, 1)
        .expect("nothing is in the way");
    most
}

#[test]
fn sticking_arm_reaches_its_target_on_any_leash() {
    for_each_arm(|arm| {
        for leash in [Leash::LEAST, Leash::default(), Leash::MOST] {
            let mut lockstep = arm();
            let target = aside(&lockstep);
            arrive(&mut lockstep, target, |goal| Goal { leash, ..goal });
        }
    });
}

#[test]
fn push_borne_on_a_long_leash_moves_the_arm_on_short_one() {
    for_each_arm(|arm| {
        // The arm's greatest way aside, and its greatest distance from the reference, `[m]`.
        let pushed = |translation: f64| {
            let mut lockstep = arm();
            let leash = Leash {
                translation,
                ..Leash::default()
            };
            let start = lockstep.arm_pose().translation.vector;
            let goal = lockstep.goal(Target::Pose(lockstep.arm_pose()), OnArrival::Hold);
            lockstep
                .submit(Goal { leash, ..goal })
                .expect("it is there");
            lockstep.run(300);
            let push = Wrench::new(0.0, 15.0, 0.0, 0.0, 0.0, 0.0);
            lockstep.robot.push_end_effector(push, 100_000);
            let (mut aside, mut stretch): (f64, f64) = (0.0, 0.0);
            for _ in 0..1500 {
                lockstep.tick();
                let at = lockstep.arm_pose().translation.vector;
                aside = aside.max((at - start).norm());
                if aside > 0.1 {
                    break;
                }
                let reference = lockstep.reference_pose().translation.vector;
                stretch = stretch.max((reference - at).norm());
            }
            (aside, stretch)
        };
        let (along, short) = pushed(Leash::LEAST.translation);
        let (borne, long) = pushed(Leash::default().translation);
        println!("{along:.3} m aside at {short:.4} m, {borne:.3} at {long:.4}");
        assert!(
            along > 0.1 && short < 0.0125,
            "{along} m aside at {short} m"
        );
        assert!(borne < 0.025 && long > 0.01, "{borne} m aside at {long} m");
    });
}

#[test]
fn a_goal_says_how_far_its_arm_may_be_pushed() {
    for_each_arm(|arm| {
        let pushed = |most: f64| {
            let mut lockstep = arm();
            let deviation = Deviation {
                translation: most,
                ..Deviation::default()
            };
            let start = lockstep.arm_pose();
            let goal = lockstep.goal(Target::Pose(start), OnArrival::Hold);
            let id = lockstep
                .submit(Goal { deviation, ..goal })
                .expect("it is there");
            lockstep.run(300);
            let push = Wrench::new(0.0, 35.0, 0.0, 0.0, 0.0, 0.0);
            lockstep.robot.push_end_effector(push, 100_000);
            while lockstep.arm_pose().translation.y < start.translation.y + 0.12 {
                lockstep.tick();
                if lockstep.client.record.bindings.contains(Guard::Deviation) {
                    lockstep.robot.let_go();
                    let outcome = lockstep.until_resolved(id, 20_000);
                    assert_eq!(outcome, Err(MotionError::Braked(Lapse::Displaced)));
                    return Some(lockstep.arm_pose().translation.y - start.translation.y);
                }
            }
            None
        };
        let given_up = pushed(0.05).expect("pushed by 12 cm");
        assert!((0.03..0.12).contains(&given_up), "{given_up} m");
        assert_eq!(pushed(0.3), None);
        assert_eq!(pushed(f64::INFINITY), None);
    });
}

#[test]
fn the_torques_stay_within_their_limits() {
    for_each_arm(|arm| {
        let most = |torque_limits: [f64; 7]| {
            let mut lockstep = arm();
            let target = aside(&lockstep);
            let limited = |goal: Goal| Goal {
                gains: Gains {
                    torque_limits,
                    ..goal.gains
                },
                ..goal
            };
            let on_the_way = arrive(&mut lockstep, target, limited);
            let goal = lockstep.goal(Target::Pose(target), OnArrival::Hold);
            lockstep.submit(limited(goal)).expect("it is there");
            let push = Wrench::new(0.0, 25.0, 10.0, 0.0, 0.0, 0.0);
            lockstep.robot.push_end_effector(push, 100_000);
            (0..120).fold(on_the_way, |most, _| {
                lockstep.tick();
                most.sup(&JointVector::from(lockstep.client.record.tau_c).abs())
            })
        };
        let torque_limits = [4.0, 4.0, 3.0, 4.0, 2.0, 2.0, 1.5];
        let limited = most(torque_limits);
        for (joint, (most, limit)) in limited.iter().zip(torque_limits).enumerate() {
            assert!(*most <= limit, "joint {joint}: {most} of {limit} N m");
        }
        let free = most(Gains::TORQUE_LIMITS);
        println!(
            "limited {:.1?}, free {:.1?}",
            limited.as_slice(),
            free.as_slice()
        );
        assert!(free[0] > 1.5 * torque_limits[0], "{free}");
    });
}

#[test]
fn motion_begun_paused_stays_until_it_is_resumed() {
    for_each_arm(|arm| {
        for kind in ["pose", "joints", "path", "path of a session"] {
            let mut lockstep = arm();
            let engaged = (kind == "path of a session").then(|| lockstep.engage());
            let (start, end) = (lockstep.arm_pose(), aside(&lockstep));
            let q = lockstep.robot.q() + JointVector::repeat(0.1);
            let target = match kind {
                "joints" => Target::Joints(q.into()),
                _ => Target::Pose(end),
            };
            let goal = lockstep.goal(target, OnArrival::ReportAndFinish);
            let mut goal = Goal {
                paused: true,
                ..goal
            };
            if engaged.is_some() {
                goal.on_arrival = OnArrival::ReportAndHold;
            }
            let motion = NewMotion::Goal {
                goal: Box::new(goal),
                path: None,
                ticket: None,
                session: engaged,
            };
            let path = [
                Waypoint::new(Translation3::new(0.0, 0.1, 0.0) * start).blend(0.02),
                end.into(),
            ];
            let begun = match kind {
                "pose" | "joints" => lockstep.client.begin(motion),
                _ => lockstep.client.begin_along(&path, motion),
            };
            let id = begun.expect("within reach");
            let (mut moved, mut cycles) = (0.0_f64, 0);
            for _ in 0..1500 {
                lockstep.tick();
                if lockstep.client.record.goal == id.0 {
                    cycles += 1;
                    let reference = lockstep.reference_pose().translation.vector;
                    moved = moved.max((reference - start.translation.vector).norm());
                }
            }
            println!("{kind}: {moved:.6} m in {cycles} cycles");
            assert!(cycles > 1000, "{kind}: it has begun");
            assert!(moved < 1e-3, "{kind}: {moved} m");
            assert_eq!(lockstep.client.outcome(id), None, "{kind}: it waits");
            lockstep.client.lifecycle.pause(id, false);
            let report = lockstep.until_resolved(id, 10_000).expect("it arrives");
            assert!(report.duration > Duration::from_millis(1500), "{report:?}");
            assert!(report.final_error.expect("of a pose").translation < 1e-3);
        }
    });
}

#[test]
fn torque_limit_below_friction_is_named_as_the_hindrance() {
    for_each_arm(|arm| {
        for by_joints in [false, true] {
            let mut lockstep = arm();
            let q = lockstep.robot.q() + JointVector::repeat(0.1);
            let target = if by_joints {
                Target::Joints(q.into())
            } else {
                Target::Pose(aside(&lockstep))
            };
            let goal = lockstep.goal(target, OnArrival::ReportAndFinish);
            let gains = Gains {
                torque_limits: Gains::LEAST.torque_limits,
                ..goal.gains
            };
            let goal = Goal { gains, ..goal };
            let id = lockstep.submit(goal).expect("within the bounds");
            let error = lockstep.until_resolved(id, 10_000).unwrap_err();
            println!("{error}");
            let MotionError::TargetNotReached(short) = &error else {
                panic!("{error}");
            };
            let limited = short.limited.expect("1 N m moves no joint");
            // A joint that slides under the limit stops nearer to the target, where the springs
            // demand less than they did where it stuck at the start.
            let arm = Arm::realistic(lockstep.robot.config().kind);
            let sticks = arm.friction.static_torque[limited.joint - 1];
            assert_eq!(limited.limit, 1.0);
            assert!(limited.asked > sticks, "{limited:?}");
            let named = format!("the torque limit of joint {} is 1.0 N m", limited.joint);
            assert!(error.to_string().contains(&named), "{error}");
            assert_eq!(error.party(), Party::Caller);
        }
    });
}

#[test]
fn every_cutoff_of_the_torques_arrives_without_oscillating() {
    for_each_arm(|arm| {
        for torque_cutoff in [Gains::LEAST.torque_cutoff, 100.0, 1000.0] {
            let mut lockstep = arm();
            let target = aside(&lockstep);
            let with = |gains: Gains| Gains {
                torque_cutoff,
                ..gains
            };
            arrive(&mut lockstep, target, |goal| Goal {
                gains: with(goal.gains),
                ..goal
            });
            // Stiff joints have the least margin.
            let q = lockstep.robot.q() + JointVector::repeat(0.1);
            let goal = lockstep.goal(Target::Joints(q.into()), OnArrival::ReportAndFinish);
            let id = lockstep
                .submit(Goal {
                    gains: with(goal.gains),
                    ..goal
                })
                .expect("within the bounds");
            let mut fastest: f64 = 0.0;
            while lockstep.client.outcome(id).is_none() {
                lockstep.tick();
                if lockstep.client.record.remaining.is_zero() {
                    fastest = fastest.max(lockstep.robot.dq().amax());
                }
            }
            lockstep
                .until_resolved(id, 1)
                .expect("nothing is in the way");
            println!("{torque_cutoff} Hz: {fastest:.4} rad/s behind the reference's arrival");
            assert!(fastest < 0.1, "{torque_cutoff} Hz: {fastest} rad/s");
        }
    });
}

#[test]
fn settling_takes_as_long_as_it_is_asked_for() {
    for_each_arm(|arm| {
        let duration = |hold: u64| {
            let mut lockstep = arm();
            let (target, begun) = (aside(&lockstep), lockstep.now());
            let settling = Settling {
                hold: Duration::from_millis(hold),
                ..Settling::default()
            };
            arrive(&mut lockstep, target, |goal| Goal { settling, ..goal });
            lockstep.now() - begun
        };
        let (short, long) = (duration(20), duration(1200));
        assert!(long >= short + 1100, "{short} ms, {long} ms");
    });
}

/// The posture turned by the elbow: the same hand, other odd joints.
fn elbow_out(lockstep: &Lockstep) -> [f64; 7] {
    let mut q = *lockstep.robot.q();
    q[0] += 0.35;
    q[2] -= 0.45;
    q.into()
}

#[test]
fn the_elbow_goes_to_its_posture_while_the_hand_stays() {
    for_each_arm(|arm| {
        let mut lockstep = arm();
        let engaged = lockstep.engage();
        lockstep.run(300);
        let (hand, q) = (lockstep.arm_pose(), *lockstep.robot.q());
        let posture = elbow_out(&lockstep);
        let id = lockstep
            .within(engaged, Target::Pose(hand), OnArrival::Hold)
            .expect("it is there");
        assert!(lockstep.client.outcome(id).is_none());
        let tuning = Tuning {
            posture: Some(posture),
            ..Tuning::default()
        };
        lockstep.tune(engaged, tuning).expect("in range");
        let (mut off, mut jolt): (f64, f64) = (0.0, 0.0);
        let mut last = JointVector::from(lockstep.client.record.ddq_ref);
        for _ in 0..6000 {
            lockstep.tick();
            let ddq = JointVector::from(lockstep.client.record.ddq_ref);
            jolt = jolt.max((ddq - last).amax() / 1e-3);
            last = ddq;
            let hand = lockstep.reference_pose().translation.vector - hand.translation.vector;
            off = off.max(hand.norm());
        }
        let turned = lockstep.robot.q()[2] - q[2];
        println!(
            "joint 3 turned {turned:.3} rad, the reference's hand {off:.1e} m off, jerk {jolt:.0}"
        );
        assert!(turned < -0.2, "{turned} rad");
        assert!(off < 1e-4, "{off} m");
        assert!(jolt < 200.0, "{jolt} rad/s^3");
        assert!(JointVector::from(lockstep.client.record.dq_ref).amax() < 1e-3);
        let moved = (lockstep.arm_pose().translation.vector - hand.translation.vector).norm();
        assert!(moved < 2e-3, "{moved} m");
    });
}

#[test]
fn a_motion_arrives_when_hand_and_elbow_rest() {
    for_each_arm(|arm| {
        let mut lockstep = arm();
        let (target, posture) = (aside(&lockstep), elbow_out(&lockstep));
        arrive(&mut lockstep, target, |goal| Goal {
            posture: Some(posture),
            ..goal
        });
        let there = *lockstep.robot.q();
        let mut plain = arm();
        arrive(&mut plain, target, |goal| goal);
        let turned = there[2] - plain.robot.q()[2];
        println!(
            "joint 3 {turned:.3} rad further, after {} and {} ms",
            lockstep.now(),
            plain.now()
        );
        assert!(turned < -0.2, "{turned} rad");
        let away = |q: &JointVector| (q - JointVector::from(posture)).norm();
        assert!(away(&there) < away(plain.robot.q()));
    });
}

#[test]
fn numbers_out_of_bounds_are_named_with_what_is_accepted() {
    let mut lockstep = Lockstep::ready();
    let start = lockstep.arm_pose();
    let goal = lockstep.goal(Target::Pose(start), OnArrival::ReportAndFinish);
    let leash = |translation| Goal {
        leash: Leash {
            translation,
            ..Leash::default()
        },
        ..goal
    };
    let deviation = Goal {
        deviation: Deviation {
            joints: f64::NAN,
            ..Deviation::default()
        },
        ..goal
    };
    let settling = |hold, timeout| Goal {
        settling: Settling {
            hold: Duration::from_millis(hold),
            timeout: Duration::from_millis(timeout),
        },
        ..goal
    };
    let gains = |torque, cutoff| {
        let mut gains = Gains::cartesian();
        (gains.torque_limits[6], gains.torque_cutoff) = (torque, cutoff);
        Goal { gains, ..goal }
    };
    let stretched = Goal {
        posture: Some([0.0; 7]),
        ..goal
    };
    let lead = Goal {
        lead: Some(Lead {
            translation: 0.0,
            rotation: 0.3,
            joints: 0.3,
        }),
        ..goal
    };
    let mut twice = start;
    twice.rotation = UnitQuaternion::new_unchecked(start.rotation.into_inner() * 2.0);
    let twice = Goal {
        target: Target::Pose(twice),
        ..goal
    };
    for (refused, says) in [
        (
            lead,
            "lead (end effector) is 0 m, expected at least 0.000001 m",
        ),
        (
            twice,
            "the quaternion of the target has the length 2, expected 1",
        ),
        (
            leash(0.004),
            "leash (end effector) is 0.004 m, expected between 0.005 and 0.1 m",
        ),
        (
            leash(f64::INFINITY),
            "leash (end effector) is inf m, expected between 0.005 and 0.1 m",
        ),
        (deviation, "deviation (joints) is NaN rad"),
        (
            settling(0, 100),
            "hold time of settling is 0 s, expected between 0.001 and 60 s",
        ),
        (
            settling(200, 100),
            "timeout of settling is 0.1 s, expected between 0.2 and 60 s",
        ),
        (
            gains(12.0, 100.0),
            "torque limit [N m] of axis 7 is 12, expected between 1 and 11.5",
        ),
        (
            gains(11.0, 10.0),
            "torque cutoff frequency [Hz] is 10, expected between 20 and 1000",
        ),
        (stretched, "the target of joint 4 is 0 rad"),
    ] {
        let error = lockstep.submit(refused).expect_err(says);
        assert!(error.to_string().starts_with(says), "{error}");
        assert!(matches!(
            error,
            MotionError::Goal(
                GoalError::Number { .. }
                    | GoalError::NotRotation { .. }
                    | GoalError::Gains(_)
                    | GoalError::OutOfRange { .. }
            )
        ));
    }
}
