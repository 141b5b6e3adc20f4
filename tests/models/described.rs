//! From the URDF that the simulator serves to a model.

use franka_async::{ModelError, UrdfError};
use franka_model::{Model, RobotKind};
use franka_sim::{Config, Sim};

use crate::connected;

/// What the simulated FR3 serves.
fn served() -> String {
    let robot = franka_sim::Robot::new(Config::default());
    robot.description().expect("an FR3 describes itself").into()
}

#[test]
fn the_description_that_the_simulator_serves_gives_the_constant_model_to_the_last_bit() {
    let model = Model::from_urdf(&served()).expect("a description");
    assert_eq!(&model, Model::fr3());
}

#[tokio::test]
async fn an_fr3_is_asked_for_its_model_over_the_network() {
    let (robot, _sim) = connected(Sim::fr3()).await;
    assert_eq!(robot.model().await.as_ref(), Ok(Model::fr3()));
    robot.shutdown().await;
}

#[tokio::test]
async fn an_arm_with_other_numbers_has_a_model_with_those_numbers() {
    let text = served();
    let mass = format!("mass value=\"{}\"", Model::fr3().links()[6].mass);
    assert_eq!(text.matches(&mass).count(), 1);
    let text = text.replace(&mass, "mass value=\"0.75\"");
    let (robot, _sim) = connected(Sim::fr3().urdf(text)).await;
    let model = robot.model().await.expect("a model");
    assert_eq!(model.links()[6].mass, 0.75);
    assert_eq!(model.joint_limits(), Model::fr3().joint_limits());
    // Control goes on with the constants.
    assert_eq!(robot.nominal_model(), Model::fr3());
    robot.shutdown().await;
}

#[tokio::test]
async fn a_description_of_something_else_is_refused_and_the_connection_stays() {
    let text = served().replace("<robot name=\"fr3\"", "<robot name=\"tmr_platform\"");
    let (robot, _sim) = connected(Sim::fr3().urdf(text)).await;
    let error = robot.model().await.expect_err("no arm");
    assert!(
        matches!(error, ModelError::Urdf(UrdfError::MobileRobot { .. })),
        "{error}"
    );
    // libfranka's text for this case.
    let text = "libfranka: loadModel() is not available for mobile robots. \
                Use franka::MobileModel with the URDF from getRobotModel() instead.";
    assert!(error.to_string().contains(text), "{error}");
    assert!(robot.urdf().await.is_ok());
    robot.shutdown().await;
}

#[tokio::test]
async fn an_fer_has_the_constants_of_its_library() {
    let (robot, _sim) = connected(Sim::fer()).await;
    let model = robot.model().await.expect("constants");
    assert_eq!(model.kind(), RobotKind::Fer);
    assert_eq!(&model, Model::fer());
    robot.shutdown().await;
}
