//! Poses that the arm reaches, though not on a straight line with its elbow where it is.

use std::time::Duration;

use franka_lockstep::{Lockstep, for_each_robot, pose_of, self_distance};
use franka_model::{EndEffector, JointVector, Model, RobotKind};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::driver::Activity;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::condition::elapsed;
use franka_rt::session::{GoalError, Hindrance, Lapse, OnArrival, PoseError, SELF_STOP, Target};
use franka_sim::arm::{Arm, Family};
use franka_sim::{Config, Tool};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

/// A robot that ends no motion because of a push.
fn insensitive(config: Config) -> Lockstep {
    let mut lockstep = Lockstep::new(config);
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    lockstep.run(5);
    lockstep
}

/// Start and target of an arm. The straight line winds the joints to the ends of their ranges
/// unless the elbow is led.
fn winding(kind: RobotKind, tool: Tool) -> (Lockstep, Isometry3<f64>) {
    let q = [-0.4781, -0.8056, -0.3814, -2.3850, 0.2325, 3.4186, 0.5198];
    let turn = UnitQuaternion::new_normalize(Quaternion::new(0.0, 0.4635, 0.8860, 0.0));
    let there = Isometry3::from_parts(Translation3::new(0.6206, 0.0244, 0.1662), turn);
    let config = Config {
        tool,
        q: q.into(),
        ..Lockstep::config_of(kind)
    };
    (insensitive(config), there)
}

#[test]
fn winding_line_takes_another_elbow_or_is_refused() {
    for kind in RobotKind::ALL {
        for tool in [Tool::hand(), Tool::NONE] {
            let (mut lockstep, there) = winding(kind, tool);
            let goal = lockstep.goal(Target::Pose(there), OnArrival::ReportAndFinish);
            let id = match lockstep.submit(goal) {
                Ok(id) => id,
                Err(MotionError::Goal(error @ GoalError::NoLine { posture, .. })) => {
                    println!("{kind:?}: {error}");
                    let posture = posture.expect("joint positions that reach the pose");
                    lockstep.begin(Target::Joints(posture))
                }
                Err(other) => panic!("{kind:?}: {other}"),
            };
            let outcome = lockstep.until_resolved(id, 40_000);
            outcome.unwrap_or_else(|error| panic!("{kind:?}: {error}"));
            assert_near(&lockstep, &there);
        }
    }
}

/// A motion that is not planned, as it may end anywhere on its way, does not blame the surroundings
/// for the ends of the joints' ranges.
#[test]
fn an_unplanned_line_ends_where_the_joints_have_no_way_on() {
    for kind in RobotKind::ALL {
        let (mut lockstep, there) = winding(kind, Tool::hand());
        let mut goal = lockstep.goal(Target::Pose(there), OnArrival::ReportAndFinish);
        goal.reaction = Some(elapsed(Duration::from_secs(3600)).into());
        let id = lockstep.submit(goal).expect("within reach");
        let outcome = lockstep.until_resolved(id, 60_000);
        let braked = matches!(
            outcome,
            Err(MotionError::Braked(Lapse::OutOfReach { joint: Some(_) }))
        );
        assert!(braked, "{kind:?}: {outcome:?}");
    }
}

/// The line to the other side of the base collides with the arm itself, with every elbow. A joint
/// motion reaches its end, with the arm clear of itself.
#[test]
fn line_into_the_arm_is_refused_but_joints_get_there() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let start = lockstep.arm_pose();
        let there = Translation3::new(-2.0 * start.translation.x, 0.0, -0.2) * start;
        let goal = lockstep.goal(Target::Pose(there), OnArrival::ReportAndFinish);
        let refused = lockstep.submit(goal).expect_err("it has no line");
        let MotionError::Goal(GoalError::NoLine {
            hindrance: Hindrance::Itself,
            posture: Some(posture),
            ..
        }) = refused
        else {
            panic!("{refused:?}");
        };
        assert!(
            refused.to_string().contains("come too close to itself"),
            "{refused}"
        );
        lockstep.run(20);
        assert!(!lockstep.client.state.motion_running());

        let id = lockstep.begin(Target::Joints(posture));
        while lockstep.client.outcome(id).is_none() {
            lockstep.tick();
            let record = &lockstep.client.record;
            if record.activity == Activity::Running {
                let room = self_distance(&record.q_ref.into());
                assert!(room > SELF_STOP - 1e-3, "{room} m");
            }
            assert!(lockstep.now() < 60_000);
        }
        assert!(lockstep.client.outcome(id).unwrap().is_ok());
        assert_near(&lockstep, &there);
    });
}

fn assert_near(lockstep: &Lockstep, there: &Isometry3<f64>) {
    let off = PoseError::between(&lockstep.arm_pose(), there);
    assert!(off.translation < 1e-3 && off.rotation < 5e-3, "{off:?}");
}

/// Distance of the hand from its straight line that counts as leaving it, `[m]`.
const ASTRAY: f64 = 0.01;

/// Returns joint positions in which the arm is clear of itself and of the table, away from the ends
/// of the joints' ranges.
fn free_posture(random: &mut SmallRng, kind: RobotKind, hand: &EndEffector) -> JointVector {
    let limits = Model::of(kind).joint_limits();
    loop {
        let q = JointVector::from_fn(|i, _| {
            random.random_range(limits.lower[i] + 0.15..limits.upper[i] - 0.15)
        });
        if self_distance(&q) > SELF_STOP && pose_of(&q, hand).translation.z > 0.05 {
            return q;
        }
    }
}

/// From a random posture, a motion to a random pose arrives on its line, or is refused before it
/// begins. The refusal names joint positions that are then reached.
///
/// About a quarter of the motions are accepted. A search over a grid of all elbows, without margins
/// and without self-collision, also finds a way along the line for only a quarter.
///
/// A few percent of the accepted motions still fail or leave their line near singular postures: the
/// arm swings at its target, or friction holds it too far from its reference. One percent of the
/// joint motions fail.
#[test]
fn random_reachable_poses_are_reached_or_refused() {
    let seed = 10;
    let cases = if franka_tests::thorough() { 1000 } else { 20 };
    for kind in RobotKind::ALL {
        let mut random = SmallRng::seed_from_u64(seed);
        let hand = EndEffector {
            f_t_ee: Tool::hand().f_t_ne,
            ..EndEffector::default()
        };
        let [
            mut accepted,
            mut failed,
            mut astray,
            mut ended,
            mut crowded,
            mut lost,
        ] = [0; 6];
        for case in 0..cases {
            let [from, to] = [(); 2].map(|()| free_posture(&mut random, kind, &hand));
            let target = pose_of(&to, &hand);
            let mut lockstep = insensitive(Config {
                q: from,
                arm: Some(Arm::sample(kind, case, &Family::realistic())),
                ..Lockstep::config_of(kind)
            });
            let start = lockstep.arm_pose().translation.vector;
            let goal = lockstep.goal(Target::Pose(target), OnArrival::ReportAndFinish);
            let mut own = None;
            let id = match lockstep.submit(goal) {
                Ok(id) => {
                    accepted += 1;
                    let mut off = 0.0_f64;
                    let way = target.translation.vector - start;
                    while lockstep.client.outcome(id).is_none() {
                        lockstep.tick();
                        assert!(lockstep.now() < 60_000);
                        let p = lockstep.arm_pose().translation.vector - start;
                        let along = (p.dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
                        off = off.max((p - way * along).norm());
                    }
                    astray += u64::from(off > ASTRAY);
                    own = Some(off);
                    id
                }
                Err(MotionError::Goal(GoalError::NoLine {
                    posture, hindrance, ..
                })) => {
                    *if hindrance == Hindrance::Itself {
                        &mut crowded
                    } else {
                        &mut ended
                    } += 1;
                    // The alternative in the refusal is valid.
                    let Some(posture) = posture else {
                        lost += 1;
                        continue;
                    };
                    lockstep.begin(Target::Joints(posture))
                }
                Err(error) => panic!("{kind:?}, seed {seed}, case {case}: {error}"),
            };
            match lockstep.until_resolved(id, 60_000) {
                Ok(report) => {
                    let off = PoseError::between(&lockstep.arm_pose(), &target);
                    // The joint sensors of a sampled arm have offsets.
                    let near = off.translation < 6e-3 && off.rotation < 2e-2;
                    assert!(near, "{kind:?}, seed {seed}, case {case}: {off:?}");
                    // A motion of joints has no line.
                    match (report.line_deviation, own) {
                        (Some(told), Some(own)) => {
                            assert!((told - own).abs() < 2e-3, "{told}, {own} m");
                        }
                        (told, own) => assert_eq!((told, own), (None, None)),
                    }
                }
                Err(error) => {
                    failed += 1;
                    println!("{kind:?}, seed {seed}, case {case}: {error}");
                    assert!(!matches!(error, MotionError::Control(_)), "a reflex");
                }
            }
        }
        println!(
            "{kind:?}: {accepted} accepted of {cases}, {failed} failed, {astray} left their line; \
             refused at the ends of ranges {ended}, near itself {crowded}, of these without a way \
             over the joints {lost}"
        );
        assert!(accepted >= cases / 5 && lost <= cases / 100);
        assert!(failed <= cases / 50 && astray <= accepted / 12);
    }
}
