//! Derives the reason for a reflex: a finding from the errors, causes from the finding, and advice
//! from the causes.

use core::time::Duration;

use franka_proto::{Errors, RobotError as E};

use super::advice::Advice;
use super::cause::{Cause, is_slow};
use super::commanded::{self, Which};
use super::contact::Sense;
use super::evidence::{Evidence, Reading, newest, worst};
use super::finding::{Finding, Quantity};
use super::{command_steps, contact, lost_cycles, measured, posture};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Category {
    /// Missing commands.
    Link,
    /// The first command.
    Start,
    /// The client's commands.
    Command,
    /// The joint positions that result from a Cartesian command.
    Inverse,
    /// Contacts of the arm.
    Contact,
    /// The motion of the arm.
    Arm,
    /// Settings that only Desk or the robot's own controllers know.
    Desk,
}

/// Every error, sorted so that an error precedes the errors that it causes. A missing command comes
/// before the jump that it causes, and a command comes before the arm's motion. Acceleration comes
/// before jerk, and jerk before velocity. A contact comes before the motion that it causes.
const ORDER: [(E, Category); 41] = [
    (E::CommunicationConstraintsViolation, Category::Link),
    (
        E::JointPositionMotionGeneratorStartPoseInvalid,
        Category::Start,
    ),
    (
        E::CartesianPositionMotionGeneratorStartPoseInvalid,
        Category::Start,
    ),
    (
        E::CartesianMotionGeneratorStartElbowInvalid,
        Category::Start,
    ),
    (E::StartElbowSignInconsistent, Category::Start),
    (
        E::CartesianPositionMotionGeneratorInvalidFrameFlag,
        Category::Command,
    ),
    (
        E::CartesianMotionGeneratorElbowSignInconsistent,
        Category::Command,
    ),
    (E::ControllerTorqueDiscontinuity, Category::Command),
    (
        E::CartesianMotionGeneratorVelocityDiscontinuity,
        Category::Command,
    ),
    (
        E::CartesianMotionGeneratorAccelerationDiscontinuity,
        Category::Command,
    ),
    (
        E::CartesianMotionGeneratorVelocityLimitsViolation,
        Category::Command,
    ),
    (
        E::CartesianMotionGeneratorElbowLimitViolation,
        Category::Command,
    ),
    (
        E::JointMotionGeneratorVelocityDiscontinuity,
        Category::Command,
    ),
    (
        E::JointMotionGeneratorAccelerationDiscontinuity,
        Category::Command,
    ),
    (
        E::JointMotionGeneratorPositionLimitsViolation,
        Category::Command,
    ),
    (
        E::JointMotionGeneratorVelocityLimitsViolation,
        Category::Command,
    ),
    (
        E::CartesianMotionGeneratorJointVelocityDiscontinuity,
        Category::Inverse,
    ),
    (
        E::CartesianMotionGeneratorJointAccelerationDiscontinuity,
        Category::Inverse,
    ),
    (
        E::CartesianMotionGeneratorJointPositionLimitsViolation,
        Category::Inverse,
    ),
    (
        E::CartesianMotionGeneratorJointVelocityLimitsViolation,
        Category::Inverse,
    ),
    (E::JointReflex, Category::Contact),
    (E::CartesianReflex, Category::Contact),
    (E::SelfCollisionAvoidanceViolation, Category::Arm),
    (E::JointPositionLimitsViolation, Category::Arm),
    (E::InstabilityDetected, Category::Arm),
    (E::TauJRangeViolation, Category::Arm),
    (E::JointVelocityViolation, Category::Arm),
    (E::CartesianVelocityViolation, Category::Arm),
    (E::PowerLimitViolation, Category::Arm),
    (E::MaxPathPoseDeviationViolation, Category::Arm),
    (E::MaxGoalPoseDeviationViolation, Category::Arm),
    (E::CartesianPositionLimitsViolation, Category::Desk),
    (E::CartesianVelocityProfileSafetyViolation, Category::Desk),
    (E::ForceControlSafetyViolation, Category::Desk),
    (
        E::ForceControllerDesiredForceToleranceViolation,
        Category::Desk,
    ),
    (E::JointMoveInWrongDirection, Category::Desk),
    (E::JointP2pInsufficientTorqueForPlanning, Category::Desk),
    (E::CartesianSplineMotionGeneratorViolation, Category::Desk),
    (
        E::JointViaMotionGeneratorPlanningJointLimitViolation,
        Category::Desk,
    ),
    (E::BaseAccelerationInitializationTimeout, Category::Desk),
    (E::BaseAccelerationInvalidReading, Category::Desk),
];

fn category(error: E) -> Category {
    let known = ORDER.iter().find(|(other, _)| *other == error);
    known.map_or(Category::Desk, |&(_, category)| category)
}

/// Returns the error that explains the other errors, and its evidence in the log. This is the first
/// error with evidence, or the first error if no error has evidence.
pub(super) fn explaining(evidence: &Evidence<'_>, errors: Errors) -> (Option<E>, Option<Finding>) {
    let named = || {
        ORDER
            .iter()
            .map(|&(error, _)| error)
            .filter(|&error| errors.contains(error))
    };
    let shown = named().find_map(|error| find(evidence, error));
    (
        shown
            .map(|finding| finding.error)
            .or_else(|| named().next()),
        shown,
    )
}

fn find(evidence: &Evidence<'_>, error: E) -> Option<Finding> {
    // A value that certainly exceeds its limit has priority over a value that is near its limit.
    let first_of = |readings: &[&dyn Fn() -> Vec<Reading>]| {
        let found = || readings.iter().map(|readings| newest(error, &readings()));
        found()
            .find_map(beyond)
            .or_else(|| found().flatten().next())
    };
    let joints = |which| move || commanded::joint_readings(evidence, which);
    let resulting = |which| move || commanded::resulting_readings(evidence, which);
    let cartesian = |which| move || commanded::cartesian_readings(evidence, which);
    use Which::{Acceleration, Jerk, Velocity};
    match error {
        E::CommunicationConstraintsViolation => lost_cycles::starvation(evidence),
        E::JointPositionMotionGeneratorStartPoseInvalid
        | E::CartesianPositionMotionGeneratorStartPoseInvalid
        | E::CartesianMotionGeneratorStartElbowInvalid
        | E::StartElbowSignInconsistent => command_steps::start_offset(evidence, error),
        E::ControllerTorqueDiscontinuity => first_of(&[&|| commanded::torque_readings(evidence)]),
        // The meaning of the error depends on the command. For a velocity command, the acceleration
        // is the first difference.
        E::JointMotionGeneratorVelocityDiscontinuity
        | E::JointMotionGeneratorAccelerationDiscontinuity => {
            first_of(&[&joints(Acceleration), &joints(Jerk)])
        }
        E::JointMotionGeneratorVelocityLimitsViolation => first_of(&[&joints(Velocity)]),
        E::JointMotionGeneratorPositionLimitsViolation
        | E::CartesianMotionGeneratorJointPositionLimitsViolation => {
            first_of(&[&|| commanded::position_readings(evidence)])
        }
        E::CartesianMotionGeneratorVelocityDiscontinuity
        | E::CartesianMotionGeneratorAccelerationDiscontinuity => {
            first_of(&[&cartesian(Acceleration), &cartesian(Jerk)])
        }
        E::CartesianMotionGeneratorVelocityLimitsViolation => first_of(&[&cartesian(Velocity)]),
        E::CartesianMotionGeneratorElbowLimitViolation => {
            first_of(&[&|| commanded::elbow_readings(evidence)])
        }
        E::CartesianMotionGeneratorJointVelocityDiscontinuity
        | E::CartesianMotionGeneratorJointAccelerationDiscontinuity => {
            first_of(&[&resulting(Acceleration), &resulting(Jerk)])
        }
        E::CartesianMotionGeneratorJointVelocityLimitsViolation => {
            first_of(&[&resulting(Velocity)])
        }
        E::JointReflex => contact::collision(evidence, error, Sense::Joints),
        E::CartesianReflex => contact::collision(evidence, error, Sense::Axes),
        E::SelfCollisionAvoidanceViolation => measured::nearest_bodies(evidence),
        // Newer systems of the FR3 report this error for commands, too.
        E::JointPositionLimitsViolation => {
            beyond(newest(error, &commanded::position_readings(evidence)))
                .or_else(|| worst(error, &measured::position_readings(evidence)))
        }
        E::InstabilityDetected => measured::shaking(evidence),
        E::TauJRangeViolation => worst(error, &measured::torque_readings(evidence)),
        E::JointVelocityViolation => worst(error, &measured::velocity_readings(evidence)),
        E::CartesianVelocityViolation => worst(error, &measured::speed_readings(evidence)),
        E::PowerLimitViolation => measured::power(evidence),
        E::MaxPathPoseDeviationViolation | E::MaxGoalPoseDeviationViolation => {
            measured::deviation(evidence, error)
        }
        _ => None,
    }
}

/// Returns the finding only if its limit is exceeded. A value just below the limit does not count.
fn beyond(finding: Option<Finding>) -> Option<Finding> {
    finding.filter(|finding| finding.excess().is_some_and(|excess| excess > 0.0))
}

/// Returns the causes of an error, most likely first.
pub(super) fn causes(evidence: &Evidence<'_>, error: E, finding: Option<&Finding>) -> Vec<Cause> {
    let mut causes = Vec::new();
    let subject = finding.map(|finding| finding.subject);
    let limit = || {
        let bounded = |finding: &&Finding| {
            matches!(finding.quantity, Quantity::Velocity | Quantity::Position)
        };
        finding
            .filter(bounded)
            .and_then(|finding| posture::limit(evidence, finding))
    };
    match category(error) {
        Category::Link => {
            let late = lost_cycles::late_commands(evidence);
            let lost = lost_cycles::lost_packets(evidence);
            // A command that left too late did not reach the robot in time either. If the thread
            // does not read states, it loses them. If all states arrived, but some were late, the
            // network may have delayed them.
            let turnaround = evidence.statistics.map(|counts| counts.worst_turnaround);
            let turnaround = turnaround.unwrap_or_default();
            let by_host = match lost {
                Some(Cause::LostPackets {
                    states: 0,
                    unanswered,
                    ..
                }) => unanswered > 0 || is_slow(turnaround),
                Some(Cause::LostPackets { longest_run, .. }) => {
                    turnaround >= Duration::from_millis(longest_run)
                }
                _ => false,
            };
            let (first, second) = if by_host { (late, lost) } else { (lost, late) };
            causes.extend(first);
            causes.extend(second);
        }
        Category::Start | Category::Command | Category::Inverse => {
            let lost = lost_cycles::lost_before(evidence, finding);
            causes.extend(lost);
            if lost.is_some() {
                causes.extend(lost_cycles::late_commands(evidence));
            }
            causes.extend(match finding {
                Some(finding) => command_steps::leap_or_finish(evidence, finding),
                None => command_steps::finished_before_the_arm(evidence, error),
            });
            causes.extend(posture::singularity(evidence));
            causes.extend(limit());
        }
        Category::Contact | Category::Arm => {
            let is_arm = category(error) == Category::Arm;
            let contact = contact::contact(evidence, subject.filter(|_| !is_arm))
                .or_else(|| is_arm.then(|| contact::push(evidence, subject))?);
            // Commands after the contact, or beyond the limit, did not cause it.
            let passed = finding.filter(|_| is_arm);
            let mut since = passed.map_or(u64::MAX, |finding| finding.since);
            if let Some(Cause::Contact { since: touched, .. }) = contact {
                since = since.min(touched);
            }
            causes.extend(contact);
            if error == E::CartesianReflex {
                causes.extend(posture::singular_pose(evidence));
            }
            causes.extend(command_steps::torque_step(evidence, since));
            if is_arm {
                causes.extend(posture::singularity(evidence));
                causes.extend(limit());
            }
        }
        Category::Desk => causes.extend(contact::contact(evidence, None)),
    }
    causes
}

/// Returns at most two recommended changes, derived from the causes. If the causes give no advice,
/// or if the error is about the arm's motion, the advice follows from the error and its finding.
pub(super) fn advice(error: E, finding: Option<&Finding>, causes: &[Cause]) -> Vec<Advice> {
    let of_arm = category(error) == Category::Arm;
    // Commands that left too late did not reach the robot in time.
    let late = matches!(causes.first(), Some(Cause::LateCommands { .. }));
    let by_cause = causes.iter().map(|cause| match cause {
        Cause::LostPackets {
            states, commands, ..
        } if !late && (*states > 0 || *commands > 0) => Advice::Network,
        Cause::LostPackets { .. } | Cause::LateCommands { .. } => Advice::Host,
        Cause::WrongStart { .. } => Advice::StartWhereItIs,
        Cause::FinishedMoving { .. } => Advice::FinishAtRest,
        Cause::TargetStep {
            quantity: Quantity::Torque,
            ..
        } => Advice::SmoothTorques,
        Cause::TargetStep { .. } => Advice::Smooth,
        Cause::Contact { .. } if of_arm => Advice::GiveWay,
        Cause::Contact { .. } => Advice::Thresholds,
        Cause::Singularity { .. } => Advice::AvoidSingularity,
        Cause::Limit { .. } => Advice::StayInRange,
    });
    let by_error = match finding.map(|finding| finding.quantity) {
        // One of the causes is a command that jumps.
        Some(Quantity::Velocity | Quantity::Acceleration) if by_error(error) == Advice::Smooth => {
            Advice::SlowDown
        }
        _ => by_error(error),
    };
    let touched = |cause: &Cause| matches!(cause, Cause::Contact { .. });
    // The contact caused the effort.
    let is_first = of_arm && !(by_error == Advice::LessEffort && causes.iter().any(touched));
    let first = (is_first || causes.is_empty()).then_some(by_error);
    let mut advice: Vec<Advice> = Vec::new();
    for next in first.into_iter().chain(by_cause) {
        if advice.len() < 2 && !advice.contains(&next) {
            advice.push(next);
        }
    }
    advice
}

fn by_error(error: E) -> Advice {
    match error {
        E::JointPositionLimitsViolation
        | E::JointMotionGeneratorPositionLimitsViolation
        | E::CartesianMotionGeneratorJointPositionLimitsViolation => Advice::StayInRange,
        E::JointMotionGeneratorVelocityLimitsViolation
        | E::CartesianMotionGeneratorVelocityLimitsViolation
        | E::CartesianMotionGeneratorJointVelocityLimitsViolation => Advice::SlowDown,
        E::ControllerTorqueDiscontinuity => Advice::SmoothTorques,
        E::SelfCollisionAvoidanceViolation => Advice::StayClearOfItself,
        E::InstabilityDetected => Advice::SofterGains,
        E::TauJRangeViolation | E::PowerLimitViolation => Advice::LessEffort,
        _ => match category(error) {
            Category::Link => Advice::Network,
            Category::Start => Advice::StartWhereItIs,
            Category::Command | Category::Inverse => Advice::Smooth,
            Category::Contact => Advice::Thresholds,
            Category::Desk => Advice::Desk,
            Category::Arm => Advice::SlowDown,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_has_its_place_once() {
        for error in E::ALL {
            let places = ORDER.iter().filter(|(other, _)| *other == error).count();
            assert_eq!(places, 1, "{error}");
        }
    }
}
