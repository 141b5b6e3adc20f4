//! Sensor values relative to their limits.

use franka_model::collision::Shape;
use franka_model::{Frame, JointVector};
use franka_proto::RobotError;

use super::commanded::end_effector;
use super::evidence::{Evidence, Reading, positions, velocities};
use super::finding::{Bound, Finding, Origin, Quantity, Subject};

pub(super) fn velocity_readings(evidence: &Evidence<'_>) -> Vec<Reading> {
    evidence
        .states()
        .flat_map(|state| {
            let (q, dq) = (state.q.into(), state.dq.into());
            velocities(evidence.model, Origin::Measured, &q, &dq, state.message_id)
        })
        .collect()
}

pub(super) fn position_readings(evidence: &Evidence<'_>) -> Vec<Reading> {
    evidence
        .states()
        .flat_map(|state| {
            positions(
                evidence.model,
                Origin::Measured,
                &state.q.into(),
                state.message_id,
            )
        })
        .collect()
}

pub(super) fn speed_readings(evidence: &Evidence<'_>) -> Vec<Reading> {
    let limit = evidence.model.cartesian_limits().translation.velocity;
    evidence
        .states()
        .map(|state| {
            let ee = end_effector(state);
            let jacobian = evidence
                .model
                .zero_jacobian(Frame::EndEffector, &state.q.into(), &ee);
            let twist = jacobian * JointVector::from(state.dq);
            let linear = twist.fixed_rows::<3>(0);
            let subject = Subject::component(linear.iamax());
            let (speed, cycle) = (linear.norm(), state.message_id);
            Reading::magnitude(
                subject,
                Quantity::Velocity,
                Origin::Measured,
                speed,
                limit,
                cycle,
            )
        })
        .collect()
}

/// Returns the readings of the joint torques relative to the nominal limits. The slightly larger
/// range of the sensors is not published.
pub(super) fn torque_readings(evidence: &Evidence<'_>) -> Vec<Reading> {
    let limit = &evidence.model.joint_limits().torque;
    evidence
        .states()
        .flat_map(|state| {
            (0..7).map(|i| {
                let (subject, torque) = (Subject::joint(i), state.tau_J[i]);
                let cycle = state.message_id;
                Reading::magnitude(
                    subject,
                    Quantity::Torque,
                    Origin::Measured,
                    torque,
                    limit[i],
                    cycle,
                )
            })
        })
        .collect()
}

pub(super) fn power(evidence: &Evidence<'_>) -> Option<Finding> {
    let powers = evidence.states().map(|state| {
        let power = JointVector::from(state.tau_J)
            .dot(&JointVector::from(state.dq))
            .abs();
        (power, state.message_id)
    });
    let (value, since) = powers
        .filter(|(power, _)| *power > 0.0)
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(unbounded(
        RobotError::PowerLimitViolation,
        Subject::Arm,
        Quantity::Power,
        value,
        since,
    ))
}

/// Returns the two bodies of the arm that are closest to each other at the end of the motion,
/// according to the vendor's capsules. Only bodies that are three or more links apart count.
pub(super) fn nearest_bodies(evidence: &Evidence<'_>) -> Option<Finding> {
    let state = evidence.last()?;
    let arm = Shape::vendor().with_lengths(*evidence.model.lengths());
    let shape = if state.m_ee > 0.0 {
        arm.with_hand()
    } else {
        arm
    };
    let placed = shape.at(&state.q.into());
    let pair = placed
        .pairs()
        .filter(|pair| pair.bodies.1.number() - pair.bodies.0.number() >= 3)
        .min_by(|a, b| a.distance.total_cmp(&b.distance))?;
    let (inner, outer) = pair.bodies;
    (pair.distance < NEAR).then(|| {
        unbounded(
            RobotError::SelfCollisionAvoidanceViolation,
            Subject::Bodies(inner.number(), outer.number()),
            Quantity::Distance,
            pair.distance,
            state.message_id,
        )
    })
}

/// Returns the finding for the largest distance between the measured and the desired end effector.
pub(super) fn deviation(evidence: &Evidence<'_>, error: RobotError) -> Option<Finding> {
    let deviations = evidence.states().map(|state| {
        let shift = |i: usize| state.O_T_EE[12 + i] - state.O_T_EE_d[12 + i];
        let shift = nalgebra::Vector3::from_fn(|i, _| shift(i));
        (shift, state.message_id)
    });
    let (shift, since) = deviations.max_by(|a, b| a.0.norm().total_cmp(&b.0.norm()))?;
    let subject = Subject::component(shift.iamax());
    (shift.norm() > 0.0)
        .then(|| unbounded(error, subject, Quantity::Deviation, shift.norm(), since))
}

/// Returns the joint whose velocity changes its sign most often, if it does so at least twice.
pub(super) fn shaking(evidence: &Evidence<'_>) -> Option<Finding> {
    let reversals = |i: usize| {
        let mut side = 0.0;
        let mut count = 0_u32;
        for state in evidence.states() {
            let velocity = state.dq[i];
            if velocity.abs() > STILL {
                count += u32::from(side * velocity < 0.0);
                side = velocity;
            }
        }
        count
    };
    let (joint, count) = (0..7)
        .map(|i| (i, reversals(i)))
        .max_by_key(|&(_, count)| count)?;
    let first = evidence.states().next()?.message_id;
    (count > 1).then(|| {
        unbounded(
            RobotError::InstabilityDetected,
            Subject::joint(joint),
            Quantity::Reversals,
            f64::from(count),
            first,
        )
    })
}

fn unbounded(
    error: RobotError,
    subject: Subject,
    quantity: Quantity,
    value: f64,
    since: u64,
) -> Finding {
    Finding {
        error,
        subject,
        quantity,
        origin: Origin::Measured,
        value,
        bound: Bound::Unknown,
        since,
    }
}

/// Distance above which two bodies do not explain a stop, `[m]`. Robots are known to stop before
/// contact, but the distance is not published.
const NEAR: f64 = 0.1;

/// Velocity below which a joint is at rest, `[rad/s]`. It is several times the velocity that the
/// sensors of an arm at rest report.
const STILL: f64 = 0.02;
