//! Link lengths of the connected robot, in every computation of the driver.

use franka_async::error::Lapse;
use franka_async::{MotionError, Pose, Robot};
use franka_model::analytic_ik::{Redundancy, solve};
use franka_model::collision::Shape;
use franka_model::geometry::Lengths;
use franka_model::{EndEffector, Frame, JointVector, Model, READY, transform};
use franka_rt::session::SELF_STOP;
use franka_sim::arm::StateGeometry;
use franka_sim::{Running, Sim, Tool};
use nalgebra::Matrix4;

use crate::connected;

/// An ideal arm with a Hand that computes its poses with these lengths.
async fn with_lengths(lengths: Lengths) -> (Robot, Running) {
    let geometry = match lengths {
        Lengths::DESCRIBED => StateGeometry::DESCRIBED,
        _ => StateGeometry::RECORDED_FR3,
    };
    let sim = Sim::fr3().ideal().tool(Tool::hand());
    connected(sim.state_geometry(geometry)).await
}

/// The two known sets of lengths change a pose by 0.2 mm or more.
const EXACT: f64 = 1e-5;

#[tokio::test]
async fn poses_and_postures_have_the_lengths_of_the_robot() {
    for lengths in Lengths::KNOWN {
        let (robot, _sim) = with_lengths(lengths).await;
        let own = Model::fr3().clone().with_lengths(lengths);
        let q = READY + JointVector::from([0.3, -0.2, 0.2, 0.3, -0.2, 0.3, 0.4]);
        let ee = EndEffector {
            f_t_ee: Matrix4::from_column_slice(&robot.state().F_T_EE),
            ..EndEffector::default()
        };
        let at = |q: &JointVector| {
            let pose = own.pose(Frame::EndEffector, q, &ee);
            transform::isometry(&pose).expect("a rigid frame")
        };
        let target: Pose = at(&q);
        let off = |pose: Pose| (pose.translation.vector - target.translation.vector).norm();
        assert!(off(robot.pose_at(q.into())) < EXACT);
        let joint7 = Redundancy::Joint7(q[6]);
        let found = solve(robot.model(), &target, &ee, joint7).expect("finite");
        let nearest = found.nearest(&q).expect("within reach");
        assert!((nearest.q - q).amax() < EXACT, "{:?}", nearest.q);
        let preview = robot.move_to(target).preview().expect("within reach");
        assert!(off(at(&preview.end().into())) < EXACT);
        robot.shutdown().await;
    }
}

/// Smallest distance between links that are three or more apart, `[m]`.
fn self_distance(lengths: Lengths, q: &[f64; 7]) -> f64 {
    let arm = Shape::vendor().with_lengths(lengths).with_hand();
    let arm = arm.at(&JointVector::from(*q));
    let apart = arm
        .distances()
        .filter(|((inner, outer), _)| outer.number() - inner.number() >= 3);
    let distances = apart.map(|(_, distance)| distance);
    distances.fold(f64::INFINITY, f64::min)
}

/// Returns the posture, bent forwards, in which an arm with these lengths comes too near to itself.
fn nearest_allowed(lengths: Lengths) -> f64 {
    let (mut clear, mut near) = (0.5, 1.9);
    while near - clear > 1e-9 {
        let middle = (clear + near) / 2.0;
        match self_distance(lengths, &bent(middle)) > SELF_STOP {
            true => clear = middle,
            false => near = middle,
        }
    }
    clear
}

/// The ready pose, bent forwards by this angle.
fn bent(angle: f64) -> [f64; 7] {
    let mut q: [f64; 7] = READY.into();
    q[1] += angle;
    q
}

#[tokio::test]
async fn self_collision_is_that_of_an_arm_with_the_robots_lengths() {
    // The other arm would be clear of itself in a posture in which this one is not, or vice versa.
    let between = Lengths::KNOWN.map(nearest_allowed);
    let q = bent(between.iter().sum::<f64>() / 2.0);
    let blocked = Lengths::KNOWN.map(|lengths| self_distance(lengths, &q) < SELF_STOP);
    assert_ne!(blocked[0], blocked[1]);
    for (lengths, blocked) in Lengths::KNOWN.into_iter().zip(blocked) {
        println!("{:.6} m", self_distance(lengths, &q) - SELF_STOP);
        let (robot, _sim) = with_lengths(lengths).await;
        let motion = robot.move_joints(q);
        let preview = motion.preview().expect("within range");
        let found = preview.blocked(robot.model(), &robot.state(), &[]);
        assert_eq!(found.expect("no region").is_some(), blocked);
        match motion.await {
            Err(MotionError::Braked(Lapse::Blocked { region: None })) => assert!(blocked),
            ended => assert!(ended.is_ok() && !blocked, "{ended:?}"),
        }
        robot.shutdown().await;
    }
}
