//! Jumps of commands: at the start of a motion, at its end, and in between.

use franka_model::limits::MotionLimits;
use franka_model::{CYCLE, JointVector, Twist, rotation, transform};
use franka_proto::{ControllerMode, MotionGeneratorMode as Generator, RobotError};
use nalgebra::Vector3;

use super::cause::Cause;
use super::commanded::{self, Derivatives, Which};
use super::evidence::{Evidence, Reading, Sample};
use super::finding::{Bound, Finding, Origin, Quantity, Subject};

/// Returns the distance of the first command from the robot's position, for the errors that report
/// such a distance.
pub(super) fn start_offset(evidence: &Evidence<'_>, error: RobotError) -> Option<Finding> {
    let sample = evidence.first()?;
    let (subject, value) = offset(&sample, error)?;
    (value.abs() > AT_THE_START).then_some(Finding {
        error,
        subject,
        quantity: Quantity::StartOffset,
        origin: Origin::Commanded,
        value,
        bound: Bound::Unknown,
        since: sample.cycle(),
    })
}

fn offset(sample: &Sample<'_>, error: RobotError) -> Option<(Subject, f64)> {
    let Sample {
        before, command, ..
    } = sample;
    match error {
        RobotError::CartesianPositionMotionGeneratorStartPoseInvalid => {
            let target = transform::isometry_from_array(&command.O_T_EE_c)?;
            let from = transform::isometry_from_array(before.commanded_pose())?;
            let shift = target.translation.vector - from.translation.vector;
            let turn = rotation::error(&target.rotation, &from.rotation);
            // A radian counts as half a metre, because the vendor does not publish whether the
            // robot checks the translation or the rotation.
            Some(if shift.norm() > 0.5 * turn.norm() {
                (Subject::component(shift.iamax()), shift.norm())
            } else {
                (Subject::component(3 + turn.iamax()), turn.norm())
            })
        }
        RobotError::CartesianMotionGeneratorStartElbowInvalid
        | RobotError::StartElbowSignInconsistent => {
            let [angle, _] = command.elbow_c?;
            Some((Subject::Elbow, angle - before.commanded_elbow()[0]))
        }
        _ => {
            let off = JointVector::from(command.q_c) - JointVector::from(before.q_d);
            let joint = off.iamax();
            Some((Subject::joint(joint), off[joint]))
        }
    }
}

/// Returns the jump of a finding's command; `None` if the command does not jump.
fn leap(evidence: &Evidence<'_>, finding: &Finding) -> Option<Cause> {
    if !evidence.commander.commands_every_cycle() {
        return None;
    }
    let sample = evidence.sample(finding.since)?;
    let cycle = sample.cycle();
    let step = |subject, quantity, size| {
        Some(if sample.first {
            Cause::WrongStart {
                subject,
                quantity,
                offset: size,
                cycle,
            }
        } else {
            Cause::TargetStep {
                subject,
                quantity,
                size,
                cycle,
            }
        })
    };
    match (finding.quantity, finding.subject) {
        (Quantity::StartOffset, subject) => Some(Cause::WrongStart {
            subject,
            quantity: Quantity::Position,
            offset: finding.value,
            cycle,
        }),
        (Quantity::TorqueRate, subject) => step(subject, Quantity::Torque, finding.value * CYCLE),
        (_, Subject::Joint(number)) if finding.origin == Origin::Commanded => {
            let index = usize::from(number) - 1;
            let (_, motion) = commanded::joints(&sample)?;
            let limits = evidence.model.joint_limits();
            let limits = MotionLimits {
                velocity: limits.velocity[index],
                acceleration: limits.acceleration[index],
                jerk: limits.jerk[index],
            };
            let acceleration = sample.before.ddq_d[index];
            let (quantity, size) =
                leap_of(&sample, &component(&motion, index), acceleration, &limits)?;
            step(finding.subject, quantity, size)
        }
        (_, Subject::Elbow) => {
            let motion = commanded::elbow(&sample)?;
            let limits = &evidence.model.cartesian_limits().elbow;
            let acceleration = sample.before.ddelbow_c[0];
            let (quantity, size) = leap_of(&sample, &component(&motion, 0), acceleration, limits)?;
            step(finding.subject, quantity, size)
        }
        _ => {
            let (subject, quantity, size) = cartesian_leap(evidence, &sample)?;
            step(subject, quantity, size)
        }
    }
}

/// Returns the jump of a Cartesian command. It is the jump of the translation or of the rotation,
/// whichever is larger relative to its limits.
fn cartesian_leap(
    evidence: &Evidence<'_>,
    sample: &Sample<'_>,
) -> Option<(Subject, Quantity, f64)> {
    let (_, motion) = commanded::cartesian(sample)?;
    let before = Twist::from(sample.before.O_ddP_EE_c);
    let limits = evidence.model.cartesian_limits();
    let half =
        |vector: &Twist, offset| -> Vector3<f64> { vector.fixed_rows::<3>(offset).into_owned() };
    let leaps = [(0, &limits.translation), (3, &limits.rotation)].map(|(offset, limits)| {
        let acceleration = half(&motion.acceleration, offset);
        let change = acceleration - half(&before, offset);
        let axis = Subject::component(offset + change.iamax());
        let norms = Derivatives {
            velocity: nalgebra::SVector::from([half(&motion.velocity, offset).norm()]),
            acceleration: nalgebra::SVector::from([acceleration.norm()]),
            jerk: nalgebra::SVector::from([half(&motion.jerk, offset).norm()]),
        };
        let excess = (norms.jerk[0] / limits.jerk).max(norms.acceleration[0] / limits.acceleration);
        (axis, norms, limits, change.norm(), excess)
    });
    let [translation, rotation] = leaps;
    let further = if rotation.4 > translation.4 {
        rotation
    } else {
        translation
    };
    let (axis, norms, limits, change, _) = further;
    // Norms have no direction. Therefore the previous acceleration is computed as this acceleration
    // minus the change.
    let (quantity, size) = leap_of(sample, &norms, norms.acceleration[0] - change, limits)?;
    Some((axis, quantity, size))
}

/// Returns the quantity that jumps in a command. If the acceleration is also too large, this is the
/// commanded quantity itself; otherwise it is the acceleration. If the acceleration grew to its
/// limit within the jerk limit, the command does not jump, but the motion is too fast.
fn leap_of(
    sample: &Sample<'_>,
    motion: &Derivatives<1>,
    acceleration_before: f64,
    limits: &MotionLimits,
) -> Option<(Quantity, f64)> {
    if motion.jerk[0].abs() <= limits.jerk {
        return None;
    }
    let acceleration = motion.acceleration[0];
    let by_velocity = matches!(
        sample.before.motion_generator_mode,
        Generator::JointVelocity | Generator::CartesianVelocity
    );
    if acceleration.abs() > limits.acceleration {
        Some(if by_velocity {
            (Quantity::Velocity, acceleration * CYCLE)
        } else {
            (Quantity::Position, acceleration * CYCLE * CYCLE)
        })
    } else {
        Some((Quantity::Acceleration, acceleration - acceleration_before))
    }
}

/// Returns the fault of a finding's command: a jump, or a last command that still moves. The robot
/// would have to stand still after the last command.
pub(super) fn leap_or_finish(evidence: &Evidence<'_>, finding: &Finding) -> Option<Cause> {
    let leap = leap(evidence, finding);
    match finished_moving(evidence, finding) {
        // A wrong start, or a jump of at least half of the velocity, has priority over a last
        // command that still moves.
        Some((finish, of_leap)) => {
            let is_start = matches!(leap, Some(Cause::WrongStart { .. }));
            leap.filter(|_| is_start || of_leap).or(Some(finish))
        }
        None => leap.or_else(|| finished_accelerating(evidence, finding)),
    }
}

/// Returns the command to which a finding about differences refers, if it is the last command of
/// the motion.
fn last_command<'a>(evidence: &Evidence<'a>, finding: &Finding) -> Option<Sample<'a>> {
    let of_differences = matches!(finding.quantity, Quantity::Acceleration | Quantity::Jerk);
    let every_cycle = evidence.commander.commands_every_cycle();
    let sample = evidence.sample(finding.since)?;
    (of_differences && every_cycle && sample.is_finished()).then_some(sample)
}

/// Returns the cause "the last command still moves". The flag is true if the command itself changes
/// at least half of its velocity.
fn finished_moving(evidence: &Evidence<'_>, finding: &Finding) -> Option<(Cause, bool)> {
    let sample = last_command(evidence, finding)?;
    let (subject, velocity, acceleration) = match commanded::joints(&sample) {
        Some((_, motion)) => {
            let joint = motion.velocity.iamax();
            let acceleration = motion.acceleration[joint];
            (Subject::joint(joint), motion.velocity[joint], acceleration)
        }
        None => {
            let (_, motion) = commanded::cartesian(&sample)?;
            let speeds = commanded::cartesian_readings_of(evidence.model, &sample, Which::Velocity);
            let fastest = speeds.iter().max_by(|a, b| a.score.total_cmp(&b.score))?;
            let offset = usize::from(matches!(fastest.subject, Subject::Rotation(_))) * 3;
            let acceleration = motion.acceleration.fixed_rows::<3>(offset).norm();
            (fastest.subject, fastest.value, acceleration)
        }
    };
    let finish = Cause::FinishedMoving {
        subject,
        velocity,
        cycle: sample.cycle(),
    };
    let of_leap = 2.0 * acceleration.abs() * CYCLE >= velocity.abs();
    (velocity.abs() > STANDSTILL).then_some((finish, of_leap))
}

/// Returns the jump of the acceleration to zero after a last joint command that hardly moves.
fn finished_accelerating(evidence: &Evidence<'_>, finding: &Finding) -> Option<Cause> {
    let sample = last_command(evidence, finding)?;
    let (_, motion) = commanded::joints(&sample)?;
    let Subject::Joint(number) = finding.subject else {
        return None;
    };
    let jerk = motion.at_rest_next().jerk[usize::from(number) - 1];
    let limit = evidence.model.joint_limits().jerk[usize::from(number) - 1];
    (jerk.abs() > limit).then_some(Cause::TargetStep {
        subject: finding.subject,
        quantity: Quantity::Acceleration,
        size: jerk * CYCLE,
        cycle: sample.cycle(),
    })
}

/// Returns the cause "the last command came before the arm was at rest". This cause applies to
/// motions with the client's torques, and to the errors that report it.
pub(super) fn finished_before_the_arm(evidence: &Evidence<'_>, error: RobotError) -> Option<Cause> {
    let says_so = matches!(
        error,
        RobotError::JointMotionGeneratorVelocityDiscontinuity
            | RobotError::CartesianMotionGeneratorVelocityDiscontinuity
    );
    if !says_so {
        return None;
    }
    let sample = evidence.samples().next_back()?;
    let dq = JointVector::from(sample.before.dq);
    let joint = dq.iamax();
    let external = sample.before.controller_mode == ControllerMode::ExternalController;
    let moves = sample.is_finished() && external && dq[joint].abs() > AT_REST;
    moves.then_some(Cause::FinishedMoving {
        subject: Subject::joint(joint),
        velocity: dq[joint],
        cycle: sample.cycle(),
    })
}

/// Returns the largest step of the commanded torques before a cycle, if the step is larger than
/// half of the limit. A torque with about the same change in an adjacent cycle is part of a ramp. A
/// change of exactly the limit comes from the rate limiter, which turns steps into ramps.
pub(super) fn torque_step(evidence: &Evidence<'_>, before: u64) -> Option<Cause> {
    let readings = commanded::torque_readings(evidence);
    let is_limited = |reading: &Reading| (reading.score - 1.0).abs() < LIMITED;
    // Each cycle has one reading for every joint.
    let beside = |i: usize| [i.checked_sub(7), i.checked_add(7)].into_iter().flatten();
    let is_ramp = |i: usize| {
        let goes_on = |other: &Reading| other.value / readings[i].value > RAMP;
        beside(i).any(|other| readings.get(other).is_some_and(goes_on))
    };
    let largest = (0..readings.len())
        .filter(|&i| readings[i].cycle < before && !is_limited(&readings[i]) && !is_ramp(i))
        .map(|i| &readings[i])
        .max_by(|a, b| a.score.total_cmp(&b.score))?;
    (largest.score > 0.5).then_some(Cause::TargetStep {
        subject: largest.subject,
        quantity: Quantity::Torque,
        size: largest.value * CYCLE,
        cycle: largest.cycle,
    })
}

fn component<const N: usize>(motion: &Derivatives<N>, index: usize) -> Derivatives<1> {
    Derivatives {
        velocity: nalgebra::SVector::from([motion.velocity[index]]),
        acceleration: nalgebra::SVector::from([motion.acceleration[index]]),
        jerk: nalgebra::SVector::from([motion.jerk[index]]),
    }
}

/// Measured joint velocity above which an arm is not at rest, `[rad/s]`. The simulator uses the
/// same value.
const AT_REST: f64 = 0.1;

/// Largest commanded velocity at which a motion may end, `[rad/s]` or `[m/s]`. A stop from this
/// velocity within one cycle is below every jerk limit of the arms.
const STANDSTILL: f64 = 0.003;

/// Relative distance from the limit within which a change counts as exactly the limit.
const LIMITED: f64 = 2e-3;

/// Smallest change in an adjacent cycle, as a share of a torque's change, for which the torque is
/// part of a ramp.
const RAMP: f64 = 0.9;

/// Offset of a first command that every robot accepts, `[rad]` or `[m]`. The vendor does not
/// publish the tolerance, but clients also start at measured positions.
const AT_THE_START: f64 = 1e-3;
