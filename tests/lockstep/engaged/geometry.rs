//! Robots that compute their poses with the lengths of recorded ones, or with joint frames that the
//! client does not know.

use std::time::Duration;

use franka_lockstep::Lockstep;
use franka_model::{JointVector, Model, READY, RobotKind, transform};
use franka_proto::RobotState;
use franka_rt::lifecycle::Engagement;
use franka_rt::session::geometry::{RESIDUAL_MAX, residual};
use franka_rt::session::{
    Backend, Chunk, GoalId, OnArrival, PoseError, Target, Tolerance, Waypoint,
};
use franka_sim::Config;
use franka_sim::arm::{Arm, Family, StateGeometry};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Largest drift in ten minutes, `[m]`.
const HELD_MAX: f64 = 0.05e-3;

/// Largest drift that counts as holding still, `[m/s]`.
const CREEP_MAX: f64 = HELD_MAX / 600.0;

/// Additional drift of a sampled arm, `[m]`. Its friction lets it settle for a minute.
const SETTLING_MAX: f64 = 0.01e-3;

/// Distance of ideal arms from a target by the robot's own report: springs rest some hundredths of
/// a millimetre off with any geometry.
const IDEAL: Tolerance = Tolerance {
    translation: 1e-4,
    rotation: 1.5e-4,
};

/// A session with a robot of some geometry.
struct Case {
    name: String,
    backend: Backend,
    is_ideal: bool,
}

impl Case {
    /// Tolerance of the arm.
    fn tolerance(&self) -> Tolerance {
        match self.backend {
            _ if self.is_ideal => IDEAL,
            Backend::RobotController { controller, .. } => Tolerance::under(controller),
            _ => Tolerance::default(),
        }
    }

    /// Checks that the arm is at `target` by the robot's own report, and has met no reflex.
    fn is_at(&self, what: &str, lockstep: &mut Lockstep, target: &Isometry3<f64>) {
        let off = PoseError::between(&mean(lockstep, 100), target);
        let most = self.tolerance();
        assert!(
            off.translation < most.translation && off.rotation < most.rotation,
            "{}, {what}: {off:?}",
            self.name
        );
        let errors = &lockstep.client.state.errors;
        assert!(errors.is_empty(), "{}, {what}: {errors}", self.name);
    }

    /// Checks that the geometry counts as no error of a goal for joints.
    fn reaches_joints(&self, lockstep: &mut Lockstep, engaged: GoalId) {
        let joints = READY + JointVector::from([0.5, -0.3, 0.4, 0.3, -0.5, -0.4, 0.6]);
        let joints = Target::Joints(joints.into());
        let goal = lockstep.within(engaged, joints, OnArrival::ReportAndHold);
        let report = lockstep.until_resolved(goal.expect("within range"), 8000);
        let report = report.unwrap_or_else(|error| panic!("{}, joints: {error}", self.name));
        let off = report.final_error.expect("the goal has a target");
        let is_near = off.translation < 2e-4 && off.rotation < 1e-3;
        assert!(is_near || !self.is_ideal, "{}, joints: {off:?}", self.name);
    }
}

/// Runs `test` with a session on an ideal and a realistic arm of each robot whose states have each
/// geometry, under each backend with each kind of setpoint; for one in `every` of these cases. The
/// realistic arm of a case is sampled with the number of the case as seed.
fn for_each_geometry(every: u64, test: impl Fn(&Case, &mut Lockstep, GoalId)) {
    let backends = [Backend::Torques].into_iter();
    let backends = backends.chain(Backend::ROBOT_CONTROLLERS);
    let geometries = [
        ("described", StateGeometry::DESCRIBED),
        ("recorded", StateGeometry::RECORDED_FR3),
        ("random", StateGeometry::random(5)),
    ];
    let family = Family::realistic();
    let mut count = 0;
    for backend in backends {
        for kind in RobotKind::ALL {
            for (geometry, state_geometry) in geometries {
                for is_ideal in [true, false] {
                    count += 1;
                    if count % every != 0 {
                        continue;
                    }
                    let mut arm = match is_ideal {
                        true => Arm::ideal(kind),
                        false => Arm::sample(kind, count, &family),
                    };
                    arm.body.state_geometry = state_geometry;
                    let mut lockstep = Lockstep::new(Config {
                        arm: Some(arm),
                        ..Lockstep::config_of(kind)
                    });
                    let engaged = lockstep.engage_with(Engagement {
                        backend,
                        ..Engagement::default()
                    });
                    let arm = match is_ideal {
                        true => "ideal".to_owned(),
                        false => format!("sampled (seed {count})"),
                    };
                    let name = format!("{arm} {kind:?}, {geometry}, {backend}");
                    let case = Case {
                        name,
                        backend,
                        is_ideal,
                    };
                    test(&case, &mut lockstep, engaged);
                    let errors = &lockstep.client.state.errors;
                    assert!(errors.is_empty(), "{}: {errors}", case.name);
                }
            }
        }
    }
}

/// Logs of poses and joints from two topics are microns off with the right lengths. The check at
/// connect compares the values of one state.
#[test]
fn pose_of_a_state_belongs_to_the_joints_of_that_state() {
    for kind in RobotKind::ALL {
        let mut lockstep = Lockstep::new(Config {
            arm: Some(Arm::realistic(kind)),
            ..Lockstep::config_of(kind)
        });
        lockstep.run(1000);
        let lengths = *lockstep.robot.model().lengths();
        let model = Model::of(kind).clone().with_lengths(lengths);
        let (mut own, mut others) = (Vec::new(), Vec::new());
        for _ in 0..200 {
            let earlier = lockstep.client.state;
            lockstep.run(20);
            let state = lockstep.client.state;
            let mixed = RobotState {
                q: earlier.q,
                ..state
            };
            own.push(residual(&model, &state).expect("a pose"));
            others.push(residual(&model, &mixed).expect("a pose"));
        }
        for all in [&mut own, &mut others] {
            all.sort_by(f64::total_cmp);
        }
        let (worst, median) = (own[own.len() - 1], others[others.len() / 2]);
        assert!(worst < 0.25 * RESIDUAL_MAX, "{kind:?}: {worst:e} m");
        assert!((1e-6..5e-6).contains(&median), "{kind:?}: {median:e} m");
    }
}

/// The mean of the reported pose over the next milliseconds.
fn mean(lockstep: &mut Lockstep, milliseconds: u32) -> Isometry3<f64> {
    let (mut place, mut turn) = (Vector3::zeros(), Vector3::zeros());
    let reported = |lockstep: &Lockstep| {
        transform::isometry_from_array(&lockstep.client.state.O_T_EE).expect("a rigid pose")
    };
    let first = reported(lockstep);
    for _ in 0..milliseconds {
        lockstep.tick();
        let pose = reported(lockstep);
        place += pose.translation.vector;
        turn += (pose.rotation * first.rotation.inverse()).scaled_axis();
    }
    let count = f64::from(milliseconds);
    let turn = UnitQuaternion::from_scaled_axis(turn / count);
    Isometry3::from_parts((place / count).into(), turn * first.rotation)
}

#[test]
fn an_arm_holds_still_whatever_its_states_are_computed_with() {
    // One in five has ideal and realistic arms under every backend.
    let (every, seconds) = match franka_tests::thorough() {
        true => (1, 600),
        false => (5, 20),
    };
    for_each_geometry(every, |case, lockstep, _| {
        lockstep.run(2000);
        let first = mean(lockstep, 1000);
        lockstep.run(1000 * (seconds - 4));
        let last = mean(lockstep, 1000);
        let way = (last.translation.vector - first.translation.vector).norm();
        println!("{}: {way:.1e} m in {seconds} s", case.name);
        let creep = CREEP_MAX * (seconds - 3) as f64;
        let most = match case.is_ideal {
            true => creep,
            false => (creep + SETTLING_MAX).min(HELD_MAX),
        };
        assert!(way < most, "{}: {way:e} m in {seconds} s", case.name);
    });
}

#[test]
fn an_arm_comes_to_where_the_robot_reports_it_to_be() {
    let every = if franka_tests::thorough() { 1 } else { 5 };
    for_each_geometry(every, |case, lockstep, engaged| {
        let home = mean(lockstep, 100);
        for metres in [0.05, 0.0] {
            let target = Translation3::new(0.0, 0.0, metres) * home;
            let goal = lockstep.within(engaged, target.into(), OnArrival::ReportAndHold);
            let report = lockstep.until_resolved(goal.expect("within reach"), 8000);
            let report = report.unwrap_or_else(|error| panic!("{}: {error}", case.name));
            let off = report.line_deviation.expect("a goal to a pose");
            let most = if case.is_ideal { 1e-3 } else { 1e-2 };
            assert!(off < most, "{}: {off} m beside its line", case.name);
            case.is_at("goal", lockstep, &target);
        }
        let tilt = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.1, 0.2));
        let corner = Translation3::new(0.0, 0.03, 0.02) * home;
        let mut end = Translation3::new(-0.05, 0.05, 0.0) * home;
        end.rotation = tilt * end.rotation;
        let path = [corner, end].map(Waypoint::new);
        let path = lockstep.through(Some(engaged), &path).expect("a free path");
        let report = lockstep.until_resolved(path, 12_000);
        assert!(report.is_ok(), "{}: {report:?}", case.name);
        case.is_at("path", lockstep, &end);

        let points = (1..=12).map(|k| {
            let along = Translation3::new(0.004 * f64::from(k), -0.004 * f64::from(k), 0.0);
            (Duration::from_millis(80) * k, along * end)
        });
        let chunk = Chunk::poses(points).expect("finite points");
        let Target::Pose(end) = chunk.target() else {
            unreachable!("a chunk of poses ends at one")
        };
        lockstep.chunk(engaged, chunk).expect("it is taken");
        lockstep.run(4000);
        case.is_at("chunk", lockstep, &end);

        if !case.backend.is_cartesian() {
            case.reaches_joints(lockstep, engaged);
        }
        lockstep.disengage(engaged);
        lockstep.until_resolved(engaged, 1000).unwrap();
    });
}
