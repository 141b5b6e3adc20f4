//! The commands of a faultless program: a short, smooth motion that begins and ends at rest.

use franka_proto::{MoveGeneratorMode, RobotState};
use franka_rt::control::{
    CartesianPose, CartesianVelocities, JointPositions, JointVelocities, Torques,
};

/// Milliseconds at rest before and after.
pub(crate) const REST: u64 = 5;
/// Milliseconds of acceleration, and of deceleration.
pub(crate) const RAMP: u64 = 20;
/// Milliseconds at full speed.
pub(crate) const CRUISE: u64 = 40;
/// The moment of the last command, `[ms]` from the first.
pub(crate) const END: u64 = 2 * REST + 2 * RAMP + CRUISE;

/// Full speed of a joint, `[rad/s]`. The steepest acceleration is 3.9 rad/s², half of the limit of
/// every joint of either robot.
const JOINT_SPEED: f64 = 0.05;
/// Full speed of the end effector, `[m/s]`: some three times as many rad/s in a joint.
const CARTESIAN_SPEED: f64 = 0.02;
/// The largest torque on joint 1, `[N m]`. It changes by up to 0.4 N m in a millisecond, so that
/// one lost cycle is bridged.
const TORQUE: f64 = 5.0;

/// The joint that moves, or receives the torque.
pub(crate) const JOINT: usize = 0;
/// The direction in which the end effector moves: upwards.
pub(crate) const AXIS: usize = 2;

/// Share of the full speed at `ms` from the first command, 0 to 1.
pub(crate) fn share(ms: u64) -> f64 {
    let ramp = |into: u64| {
        let angle = core::f64::consts::FRAC_PI_2 * into as f64 / RAMP as f64;
        angle.sin().powi(2)
    };
    match ms {
        _ if ms <= REST || ms >= END - REST => 0.0,
        _ if ms < REST + RAMP => ramp(ms - REST),
        _ if ms <= REST + RAMP + CRUISE => 1.0,
        _ => ramp(END - REST - ms),
    }
}

/// The full speed of a generator's commands.
pub(crate) fn full_speed(generator: MoveGeneratorMode) -> f64 {
    match generator {
        MoveGeneratorMode::JointPosition | MoveGeneratorMode::JointVelocity => JOINT_SPEED,
        MoveGeneratorMode::CartesianPosition | MoveGeneratorMode::CartesianVelocity => {
            CARTESIAN_SPEED
        }
        MoveGeneratorMode::None => 0.0,
    }
}

/// The distance covered until `ms` at a full speed of 1, `[s]`: a sum over the cycles, since the
/// robot takes differences.
pub(crate) fn way(ms: u64) -> f64 {
    (1..=ms.min(END)).map(share).sum::<f64>() * 1e-3
}

/// Joint positions for a motion that began in the state `start`.
pub(crate) fn joint_positions(start: &RobotState, ms: u64) -> JointPositions {
    let mut q = start.q_d;
    q[JOINT] += JOINT_SPEED * way(ms);
    JointPositions(q)
}

/// Joint velocities.
pub(crate) fn joint_velocities(_: &RobotState, ms: u64) -> JointVelocities {
    let mut dq = [0.0; 7];
    dq[JOINT] = JOINT_SPEED * share(ms);
    JointVelocities(dq)
}

/// Poses for a motion that began in the state `start`.
pub(crate) fn cartesian_pose(start: &RobotState, ms: u64) -> CartesianPose {
    let mut pose = start.O_T_EE_c;
    pose[12 + AXIS] += CARTESIAN_SPEED * way(ms);
    CartesianPose {
        O_T_EE: pose,
        elbow: None,
    }
}

/// Twists.
pub(crate) fn cartesian_velocities(_: &RobotState, ms: u64) -> CartesianVelocities {
    let mut twist = [0.0; 6];
    twist[AXIS] = CARTESIAN_SPEED * share(ms);
    CartesianVelocities {
        O_dP_EE: twist,
        elbow: None,
    }
}

/// Torque on the joint, `[N m]`: one period of a sine, so that the arm ends at rest. It is fastest
/// in the middle.
pub(crate) fn torque(ms: u64) -> f64 {
    let duration = END - 2 * REST;
    match ms {
        _ if ms <= REST || ms >= END - REST => 0.0,
        _ => TORQUE * (core::f64::consts::TAU * (ms - REST) as f64 / duration as f64).sin(),
    }
}

/// Torques of a motion without a generator.
pub(crate) fn torques(_: &RobotState, ms: u64) -> Torques {
    let mut tau = [0.0; 7];
    tau[JOINT] = torque(ms);
    Torques(tau)
}
