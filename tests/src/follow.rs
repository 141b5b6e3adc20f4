//! Lag of target control behind a target that moves evenly, in virtual time.

use franka_model::{RobotKind, Twist, rotation};
use franka_rt::session::{OnArrival, Target};
use franka_sim::Arm;
use nalgebra::{Isometry3, Translation3, Vector3};

use franka_lockstep::Lockstep;

/// A robot with a realistic arm.
pub fn realistic() -> Lockstep {
    Lockstep::new(franka_sim::Config {
        arm: Some(Arm::realistic(RobotKind::Fr3)),
        ..Lockstep::config_of(RobotKind::Fr3)
    })
}

/// 0.1 m/s sideways and down, with a turn.
pub fn twist() -> Twist {
    Twist::new(0.02, 0.08, -0.05, 0.1, -0.05, 0.15)
}

/// The pose after `t` seconds of this motion.
pub fn moved(from: &Isometry3<f64>, twist: &Twist, t: f64) -> Isometry3<f64> {
    let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
    Isometry3::from_parts(
        Translation3::from(from.translation.vector + linear * t),
        rotation::exp(&Vector3::from(angular * t)) * from.rotation,
    )
}

/// Distance to a target that moves evenly, at most, in milliseconds of its motion.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lag {
    /// Lag of the reference.
    pub reference: f64,
    /// Lag of the arm.
    pub arm: f64,
}

/// The lag behind a target at [`twist`], once the arm follows it. A new target comes every `period`
/// milliseconds, with or without its velocity.
///
/// # Panics
/// If a target is refused.
pub fn lag(period: u64, says_velocity: bool) -> Lag {
    let mut lockstep = realistic();
    let session = lockstep.engage();
    let (start, twist) = (lockstep.reference_pose(), twist());
    let speed = twist.fixed_rows::<3>(0).norm();
    let at = |ms: u64| moved(&start, &twist, ms as f64 * 1e-3);
    let target = |ms: u64| match says_velocity {
        true => (at(ms), twist).into(),
        false => Target::Pose(at(ms)),
    };
    let goal = lockstep
        .within(session, target(0), OnArrival::Hold)
        .expect("within reach");
    let mut lag = Lag::default();
    for ms in 1..2000 {
        lockstep.tick();
        if ms > 1000 {
            let behind = |pose: Isometry3<f64>| {
                (at(ms).translation.vector - pose.translation.vector).norm() / speed * 1e3
            };
            lag.reference = lag.reference.max(behind(lockstep.reference_pose()));
            lag.arm = lag.arm.max(behind(lockstep.arm_pose()));
        }
        if ms % period == 0 {
            assert_eq!(lockstep.update(goal, target(ms)), Ok(true));
        }
    }
    lag
}
