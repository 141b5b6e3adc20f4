//! From the URDF that the simulator serves to a model.

use std::time::Duration;

use franka_async::connection::Builder;
use franka_async::control::{Finish, JointVelocities};
use franka_async::error::{ConnectError, GoalError, ModelError, UrdfError};
use franka_async::{MotionError, Realtime, Robot};
use franka_model::geometry::Lengths;
use franka_model::limits::JointLimits;
use franka_model::{Model, READY, RobotKind};
use franka_rt::session::geometry::residual;
use franka_sim::arm::{Arm, StateGeometry, SystemLimits};
use franka_sim::{Config, Sim};

use crate::connected;

/// The description that the simulated FR3 serves.
fn served() -> String {
    let robot = franka_sim::Robot::new(before_5_9());
    robot.description().expect("an FR3 describes itself").into()
}

/// The configuration of an ideal FR3 with the limits of the constants.
fn before_5_9() -> Config {
    let mut arm = Arm::ideal(RobotKind::Fr3);
    arm.limits = SystemLimits::Before5_9;
    Config {
        arm: Some(arm),
        ..Config::default()
    }
}

#[test]
fn simulator_description_equals_constants_bit_for_bit() {
    let model = Model::from_urdf(&served()).expect("a description");
    assert_eq!(&model, Model::fr3());
}

#[test]
fn the_simulator_serves_the_limits_of_system_5_9_by_default() {
    let robot = franka_sim::Robot::new(Config::default());
    let text = robot.description().expect("an FR3 describes itself");
    let limits = *Model::from_urdf(text).expect("an arm").joint_limits();
    let documented = JointLimits::fr3_system_5_9();
    // Where to command is not in the text: the margins of the constants are added again.
    assert!((limits.lower - documented.lower).amax() < 1e-12);
    assert!((limits.upper - documented.upper).amax() < 1e-12);
    let (lower, upper) = (documented.lower, documented.upper);
    assert_eq!(
        JointLimits {
            lower,
            upper,
            ..limits
        },
        *documented
    );
}

#[tokio::test]
async fn a_range_without_room_is_refused_while_connecting() {
    let text = served().replace(
        "lower=\"-2.7501\" upper=\"2.7501\"",
        "lower=\"-0.003\" upper=\"0.003\"",
    );
    let sim = serving(text).start().await.expect("it starts");
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let error = builder.connect().await.expect_err("no room").to_string();
    assert!(
        error.contains("joint joint1, from -0.003 to 0.003 rad,") && error.contains("expected 0.2"),
        "{error}"
    );
}

/// The same description with `other` in place of `number`, which occurs once.
fn served_with(number: &str, other: &str) -> String {
    let text = served();
    assert_eq!(text.matches(number).count(), 1, "{number}");
    text.replace(number, other)
}

/// A robot that serves this description.
fn serving(text: String) -> Sim {
    Sim::new(before_5_9()).configure(|config| config.urdf = Some(text))
}

#[tokio::test]
async fn an_fr3_is_asked_for_its_model_over_the_network() {
    let (robot, _sim) = connected(Sim::new(before_5_9())).await;
    assert_eq!(robot.model(), Model::fr3());
    robot.shutdown().await;
}

#[tokio::test]
async fn other_numbers_in_the_description_change_the_model() {
    let mass = format!("mass value=\"{}\"", Model::fr3().links()[6].mass);
    let (robot, _sim) = connected(serving(served_with(&mass, "mass value=\"0.75\""))).await;
    assert_eq!(robot.model().links()[6].mass, 0.75);
    assert_eq!(robot.model().joint_limits(), Model::fr3().joint_limits());
    robot.shutdown().await;
}

/// The description of an arm whose first joint has a smaller range than documented, and is slow at
/// its ends, as in newer systems.
fn narrower() -> String {
    served_with("upper=\"2.7501\"", "upper=\"2.7437\"")
}

#[tokio::test]
async fn goals_keep_the_range_that_the_description_gives() {
    let beyond = {
        let mut q: [f64; 7] = READY.into();
        q[0] = Model::fr3().joint_limits().upper[0] - 1e-4;
        q
    };
    let (robot, _sim) = connected(serving(narrower())).await;
    let refused = robot.move_joints(beyond).await;
    assert!(
        matches!(
            refused,
            Err(MotionError::Goal(GoalError::OutOfRange { joint: 1, .. }))
        ),
        "{refused:?}"
    );
    robot.shutdown().await;
}

#[tokio::test]
async fn a_limiter_keeps_the_velocities_that_the_description_gives() {
    // The range is 1.25 rad smaller than the vendor's, so the arm must brake where the constants
    // would still allow full speed.
    let mut start = READY;
    start[0] = 1.2;
    let text = served_with("upper=\"2.7501\"", "upper=\"1.5\"");
    let (robot, _sim) = connected(serving(text).configure(|config| config.q = start)).await;
    let limits = *robot.model().joint_limits();
    let (mut worst, mut time) = (f64::NEG_INFINITY, Duration::ZERO);
    let (told, hear) = std::sync::mpsc::channel();
    let ended = robot
        .control_joint_velocities(move |state, period| {
            time += period;
            let (_, upper) = limits.velocity_envelope(&state.q_d.into(), 0.0);
            worst = worst.max(state.dq_d[0] - upper[0]);
            let asked = time.as_secs_f64().min(0.6);
            let slow = state.dq_d[0].abs() < 0.01;
            if time > Duration::from_millis(700) && slow {
                let _ = told.send((worst, state.q_d[0]));
                return JointVelocities([0.0; 7]).finish();
            }
            JointVelocities([asked, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).into()
        })
        .limit_rate(true)
        .await;
    ended.expect("the robot accepts the motion");
    let (worst, end) = hear.recv().expect("an end");
    // The limit is for the position of the previous cycle; it falls by 6 mrad/s per cycle.
    assert!(worst.abs() < 0.01, "it binds and holds: {worst}");
    assert!(1.48 < end && end < 1.5, "{end}");
    robot.shutdown().await;
}

#[tokio::test]
async fn foreign_description_is_refused_unless_constants_chosen() {
    let text = served_with("<robot name=\"fr3\"", "<robot name=\"tmr_platform\"");
    let sim = serving(text).start().await.expect("it starts");
    let builder = || Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let error = builder().connect().await.expect_err("no arm");
    assert!(
        matches!(
            error,
            ConnectError::Model(ModelError::Urdf(UrdfError::MobileRobot { .. }))
        ),
        "{error}"
    );
    // The text of libfranka.
    let text = "libfranka: loadModel() is not available for mobile robots. \
                Use franka::MobileModel with the URDF from getRobotModel() instead.";
    assert!(error.to_string().contains(text), "{error}");

    let chosen = builder().nominal_model(true).connect().await;
    let robot = chosen.expect("the robot accepts a new client");
    assert_eq!(robot.model(), Model::fr3());
    assert!(robot.urdf().await.is_ok());
    robot.shutdown().await;
}

#[tokio::test]
async fn an_fer_has_the_constants_of_its_library() {
    let (robot, _sim) = connected(Sim::fer().ideal()).await;
    assert_eq!(robot.model().kind(), RobotKind::Fer);
    assert_eq!(robot.model(), Model::fer());
    robot.shutdown().await;
}

#[tokio::test]
async fn the_geometry_is_that_of_the_poses_that_the_robot_reports() {
    let [described, recorded] = Lengths::KNOWN;
    let connect = async |geometry: StateGeometry, options: fn(Builder) -> Builder| {
        let sim = Sim::fr3().ideal().state_geometry(geometry);
        let sim = sim.start().await.expect("it starts");
        let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
        (options(builder).connect().await, sim)
    };
    for nominal in [false, true] {
        let options: fn(Builder) -> Builder = match nominal {
            true => |builder| builder.nominal_model(true),
            false => |builder| builder,
        };
        let (robot, _sim) = connect(StateGeometry::RECORDED_FR3, options).await;
        let robot = robot.expect("these lengths are known");
        let check = robot.geometry_check();
        let served = if nominal { described } else { recorded };
        assert_eq!((check.described, check.used), (served, recorded));
        assert_eq!(robot.model().lengths(), &recorded);
        assert!(check.agrees() && check.residual.is_some(), "{check:?}");
        robot.shutdown().await;
    }
    let random = StateGeometry::random(5);
    let (refused, _sim) = connect(random, |builder| builder).await;
    let error = refused.expect_err("an unknown geometry");
    let ConnectError::Geometry { residual } = error else {
        panic!("{error}")
    };
    assert!((1e-4..5e-3).contains(&residual), "{residual:e} m");
    let got = format!("{:.1} µm", residual * 1e6);
    let text = error.to_string();
    assert!(
        text.contains(&got) && text.contains("expected 2 µm"),
        "{text}"
    );

    let (robot, _sim) = connect(random, |builder| builder.accept_geometry_error(true)).await;
    let robot = robot.expect("it is accepted");
    let check = robot.geometry_check();
    assert_eq!((check.described, check.used), (described, described));
    assert!(!check.agrees(), "{check:?}");
    robot.shutdown().await;
}

/// As a program meets them: without options.
#[tokio::test]
async fn simulated_robots_have_the_lengths_of_the_recorded_ones() {
    for (sim, expected) in [
        (Sim::fr3(), Lengths::RECORDED_FR3),
        (Sim::fer(), Lengths::DESCRIBED),
        (
            Sim::fr3().state_geometry(StateGeometry::DESCRIBED),
            Lengths::DESCRIBED,
        ),
    ] {
        let (robot, _sim) = connected(sim).await;
        let check = robot.geometry_check();
        assert_eq!((check.described, check.used), (expected, expected));
        assert!(check.is_as_described(), "{check}");
        let state = robot.state();
        let model = Model::of(robot.model().kind()).clone();
        let residual = |lengths| residual(&model.clone().with_lengths(lengths), &state);
        assert!(residual(expected).is_some_and(|off| off < 2e-6));
        for other in Lengths::KNOWN.into_iter().filter(|it| *it != expected) {
            assert!(residual(other).is_some_and(|off| off > 5e-5));
        }
        robot.shutdown().await;
    }
}

#[tokio::test]
async fn the_geometry_of_an_fer_is_checked_too() {
    let sim = Sim::fer().ideal().state_geometry(StateGeometry::random(5));
    let sim = sim.start().await.expect("it starts");
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let error = builder.connect().await.expect_err("an unknown geometry");
    assert!(matches!(error, ConnectError::Geometry { .. }), "{error}");
    let (robot, _sim) = connected(Sim::fer().ideal()).await;
    assert!(
        robot
            .geometry_check()
            .residual
            .is_some_and(|residual| residual < 1e-9)
    );
    robot.shutdown().await;
}
