//! The robot's reaction to lost commands, computed on one number: the completed share of the
//! course.
//!
//! Source: FCI documentation, control parameters and "handling of packet losses". The robot
//! extrapolates a lost command of a generator with the acceleration of the last. Twenty losses in a
//! row end the motion. Derivatives are backward differences, which include the extrapolated
//! commands. Lost torques are replaced by the last ones.

use franka_model::limits::MotionLimits;
use franka_model::{CYCLE, Model};
use franka_proto::{Errors, MoveGeneratorMode, RobotError as E};

use crate::faults::course;
use crate::faults::variant::Channel;

/// Commands lost in a row that end a motion.
pub(crate) const LOST_LIMIT: u64 = 20;

/// The distance that each quantity must keep from its limit, on either side, for a clear verdict. A
/// robot judges by the published values, in single precision. The joints of a Cartesian motion are
/// computed from its beginning and its end.
const MARGIN: f64 = 0.005;

/// Returns the reasons for which the robot stops a motion along the course when `lost` commands
/// from `first` `[ms]` on are lost; empty if it continues. `joints_per_way` is the change of the
/// joint positions per distance of a Cartesian motion, `[rad/m]`.
///
/// # Panics
/// If a quantity is too close to its limit for a verdict.
pub(crate) fn errors_after_loss(
    model: &Model,
    channel: Channel,
    joints_per_way: &[f64; 7],
    first: u64,
    lost: u64,
) -> Errors {
    let begun = first > 0;
    if begun && lost >= LOST_LIMIT {
        return E::CommunicationConstraintsViolation.into();
    }
    let bounds = Bounds::of(model, channel.generator, joints_per_way);
    let mut signal = Signal::default();
    for ms in (0..=course::END).filter(|&ms| begun || ms >= lost) {
        if begun && (first..first + lost).contains(&ms) {
            if channel.generator != MoveGeneratorMode::None {
                signal = signal.extrapolated();
            }
            continue;
        }
        let (next, jerk) = match channel.generator {
            MoveGeneratorMode::None => (signal.to_torque(course::torque(ms)), 0.0),
            MoveGeneratorMode::JointPosition | MoveGeneratorMode::CartesianPosition => {
                signal.to_way(course::way(ms))
            }
            _ => signal.to_velocity(course::share(ms)),
        };
        let errors = bounds.broken(&next, jerk);
        if !errors.is_empty() {
            return errors;
        }
        signal = next;
    }
    Errors::NONE
}

/// The course as the robot follows it; for torques, the last one and its step.
#[derive(Clone, Copy, Default)]
struct Signal {
    way: f64,
    velocity: f64,
    acceleration: f64,
}

impl Signal {
    fn to_way(self, way: f64) -> (Self, f64) {
        let (next, jerk) = self.to_velocity((way - self.way) / CYCLE);
        (Self { way, ..next }, jerk)
    }

    fn to_velocity(self, velocity: f64) -> (Self, f64) {
        let acceleration = (velocity - self.velocity) / CYCLE;
        let next = Self {
            way: self.way + velocity * CYCLE,
            velocity,
            acceleration,
        };
        (next, (acceleration - self.acceleration) / CYCLE)
    }

    fn to_torque(self, torque: f64) -> Self {
        Self {
            way: torque,
            velocity: (torque - self.way) / CYCLE,
            acceleration: 0.0,
        }
    }

    fn extrapolated(self) -> Self {
        let velocity = self.velocity + self.acceleration * CYCLE;
        Self {
            way: self.way + velocity * CYCLE,
            velocity,
            ..self
        }
    }
}

/// The limits of the course's quantities, each with its error.
struct Bounds(Vec<(MotionLimits, [E; 3])>);

impl Bounds {
    fn of(model: &Model, generator: MoveGeneratorMode, joints_per_way: &[f64; 7]) -> Self {
        let joints = model.joint_limits();
        let joint = |i: usize, per_way: f64| MotionLimits {
            velocity: joints.velocity[i] / per_way.abs(),
            acceleration: joints.acceleration[i] / per_way.abs(),
            jerk: joints.jerk[i] / per_way.abs(),
        };
        let translation = &model.cartesian_limits().translation;
        let speed = course::full_speed(generator);
        let own = match generator {
            MoveGeneratorMode::None => MotionLimits {
                velocity: joints.torque_rate[course::JOINT],
                acceleration: f64::INFINITY,
                jerk: f64::INFINITY,
            },
            MoveGeneratorMode::JointPosition | MoveGeneratorMode::JointVelocity => {
                joint(course::JOINT, speed)
            }
            _ => MotionLimits {
                velocity: translation.velocity / speed,
                acceleration: translation.acceleration / speed,
                jerk: translation.jerk / speed,
            },
        };
        let mut bounds = vec![(own, own_errors(generator))];
        if let Some(errors) = joint_errors(generator) {
            bounds.extend((0..7).map(|i| (joint(i, joints_per_way[i] * speed), errors)));
        }
        Self(bounds)
    }

    fn broken(&self, signal: &Signal, jerk: f64) -> Errors {
        let mut broken = Errors::NONE;
        for (limits, errors) in &self.0 {
            let pairs = [
                (signal.velocity, limits.velocity),
                (signal.acceleration, limits.acceleration),
                (jerk, limits.jerk),
            ];
            for ((value, limit), error) in pairs.into_iter().zip(errors) {
                let ratio = value.abs() / limit;
                assert!(
                    (ratio - 1.0).abs() > MARGIN,
                    "{error}: too close to the limit: {ratio}"
                );
                if ratio > 1.0 {
                    broken.insert(*error);
                }
            }
        }
        broken
    }
}

/// The errors for velocity, acceleration and jerk beyond the limit; for torques, for the rate.
fn own_errors(generator: MoveGeneratorMode) -> [E; 3] {
    match generator {
        MoveGeneratorMode::None => [E::ControllerTorqueDiscontinuity; 3],
        MoveGeneratorMode::JointPosition => [
            E::JointMotionGeneratorVelocityLimitsViolation,
            E::JointMotionGeneratorVelocityDiscontinuity,
            E::JointMotionGeneratorAccelerationDiscontinuity,
        ],
        MoveGeneratorMode::JointVelocity => [
            E::JointMotionGeneratorVelocityLimitsViolation,
            E::JointMotionGeneratorAccelerationDiscontinuity,
            E::JointMotionGeneratorAccelerationDiscontinuity,
        ],
        MoveGeneratorMode::CartesianPosition => [
            E::CartesianMotionGeneratorVelocityLimitsViolation,
            E::CartesianMotionGeneratorVelocityDiscontinuity,
            E::CartesianMotionGeneratorAccelerationDiscontinuity,
        ],
        MoveGeneratorMode::CartesianVelocity => [
            E::CartesianMotionGeneratorVelocityLimitsViolation,
            E::CartesianMotionGeneratorAccelerationDiscontinuity,
            E::CartesianMotionGeneratorAccelerationDiscontinuity,
        ],
    }
}

/// The same errors for the joints of a Cartesian motion.
fn joint_errors(generator: MoveGeneratorMode) -> Option<[E; 3]> {
    let acceleration = match generator {
        MoveGeneratorMode::CartesianPosition => {
            E::CartesianMotionGeneratorJointVelocityDiscontinuity
        }
        MoveGeneratorMode::CartesianVelocity => {
            E::CartesianMotionGeneratorJointAccelerationDiscontinuity
        }
        _ => return None,
    };
    Some([
        E::CartesianMotionGeneratorJointVelocityLimitsViolation,
        acceleration,
        E::CartesianMotionGeneratorJointAccelerationDiscontinuity,
    ])
}
