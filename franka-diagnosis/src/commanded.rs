//! Differences of commands, computed as the robot computes them.
//!
//! The robot computes backward differences over one cycle, relative to the commanded values in the
//! answered state (FCI documentation, control parameters). The limits are the nominal limits.

use franka_model::differential_ik::{DifferentialIk, JointBox};
use franka_model::limits::MotionLimits;
use franka_model::{CYCLE, EndEffector, Frame, JointVector, Model, Twist, rotation, transform};
use franka_proto::{MotionGeneratorMode as Generator, RobotState};
use nalgebra::{Isometry3, SVector, Vector3};

use super::evidence::{Evidence, Reading, Sample, positions, velocities};
use super::finding::{Origin, Quantity, Subject};

#[derive(Clone, Copy, Debug)]
pub(super) struct Derivatives<const N: usize> {
    pub(super) velocity: SVector<f64, N>,
    pub(super) acceleration: SVector<f64, N>,
    pub(super) jerk: SVector<f64, N>,
}

impl<const N: usize> Derivatives<N> {
    fn of(
        velocity: SVector<f64, N>,
        before: SVector<f64, N>,
        acceleration_before: SVector<f64, N>,
    ) -> Self {
        let acceleration = (velocity - before) / CYCLE;
        Self {
            velocity,
            acceleration,
            jerk: (acceleration - acceleration_before) / CYCLE,
        }
    }

    /// Returns the derivatives if the next cycle is a standstill, as after a finished command.
    pub(super) fn at_rest_next(&self) -> Self {
        Self::of(SVector::zeros(), self.velocity, self.acceleration)
    }
}

/// Returns the joint positions of a joint command and their derivatives; `None` for other commands.
pub(super) fn joints(sample: &Sample<'_>) -> Option<(JointVector, Derivatives<7>)> {
    let Sample {
        before, command, ..
    } = sample;
    let from = JointVector::from(before.q_d);
    let (q, velocity) = match before.motion_generator_mode {
        Generator::JointPosition => {
            let q = JointVector::from(command.q_c);
            (q, (q - from) / CYCLE)
        }
        Generator::JointVelocity => {
            let dq = JointVector::from(command.dq_c);
            (from + dq * CYCLE, dq)
        }
        _ => return None,
    };
    let (dq_d, ddq_d) = (
        JointVector::from(before.dq_d),
        JointVector::from(before.ddq_d),
    );
    Some((q, Derivatives::of(velocity, dq_d, ddq_d)))
}

/// Returns the pose of a Cartesian command and its derivatives; `None` for other commands and for
/// invalid poses.
pub(super) fn cartesian(sample: &Sample<'_>) -> Option<(Isometry3<f64>, Derivatives<6>)> {
    let Sample {
        before, command, ..
    } = sample;
    let from = transform::isometry_from_array(before.commanded_pose())?;
    let (pose, twist) = match before.motion_generator_mode {
        Generator::CartesianPosition => {
            let pose = transform::isometry_from_array(&command.O_T_EE_c)?;
            (pose, difference(&pose, &from) / CYCLE)
        }
        Generator::CartesianVelocity => {
            let twist = Twist::from(command.O_dP_EE_c);
            let (linear, angular) = halves(&twist);
            let turn = rotation::exp(&(angular * CYCLE)) * from.rotation;
            let position = from.translation.vector + linear * CYCLE;
            (Isometry3::from_parts(position.into(), turn), twist)
        }
        _ => return None,
    };
    let (before_twist, before_acceleration) = (
        Twist::from(before.O_dP_EE_c),
        Twist::from(before.O_ddP_EE_c),
    );
    Some((
        pose,
        Derivatives::of(twist, before_twist, before_acceleration),
    ))
}

pub(super) fn elbow(sample: &Sample<'_>) -> Option<Derivatives<1>> {
    let [angle, _] = sample.command.elbow_c?;
    let before = sample.before;
    let velocity = (angle - before.commanded_elbow()[0]) / CYCLE;
    let one = SVector::<f64, 1>::repeat;
    Some(Derivatives::of(
        one(velocity),
        one(before.delbow_c[0]),
        one(before.ddelbow_c[0]),
    ))
}

/// Returns the joint positions of a Cartesian command and their derivatives, with Newton's method
/// that starts at the commanded joint positions. The robot's own method is not published, but its
/// result is known to be close to the smallest step.
pub(super) fn resulting(
    model: &Model,
    sample: &Sample<'_>,
) -> Option<(JointVector, Derivatives<7>)> {
    let before = sample.before;
    let (pose, _) = cartesian(sample)?;
    let ee = end_effector(before);
    let from = JointVector::from(before.q_d);
    let mut q = from;
    // Applies the commanded displacement to the model's pose, because the model's pose may differ
    // from the robot's.
    let robots = transform::isometry_from_array(before.commanded_pose())?;
    let models = transform::isometry(&model.pose(Frame::EndEffector, &q, &ee))?;
    let way = pose.translation.vector - robots.translation.vector;
    let pose = Isometry3::from_parts(
        (models.translation.vector + way).into(),
        pose.rotation * robots.rotation.inverse() * models.rotation,
    );
    for _ in 0..ITERATIONS {
        let here = transform::isometry(&model.pose(Frame::EndEffector, &q, &ee))?;
        let error = difference(&pose, &here);
        let mut upper = JointVector::repeat(LEAP);
        let mut lower = -upper;
        if let Some([angle, _]) = sample.command.elbow_c {
            upper[2] = (angle - q[2]).clamp(-LEAP, LEAP);
            lower[2] = upper[2];
        }
        let jacobian = model.zero_jacobian(Frame::EndEffector, &q, &ee);
        let bounds = JointBox::new(&lower, &upper);
        let start = Default::default();
        let step = DifferentialIk::smooth().solve(
            &jacobian,
            &error,
            &JointVector::zeros(),
            &bounds,
            start,
        );
        q += step.velocity;
    }
    let (dq_d, ddq_d) = (
        JointVector::from(before.dq_d),
        JointVector::from(before.ddq_d),
    );
    Some((q, Derivatives::of((q - from) / CYCLE, dq_d, ddq_d)))
}

/// Returns the change of the command's torques relative to the torques in the state, `[N·m]`. For
/// the first command, the change is relative to zero.
pub(super) fn torque_step(sample: &Sample<'_>) -> Option<JointVector> {
    if !sample.before.controller_running() {
        return None;
    }
    let before = if sample.first {
        JointVector::zeros()
    } else {
        sample.before.tau_J_d.into()
    };
    Some(JointVector::from(sample.command.tau_J_d) - before)
}

/// Returns the client's frames from a state.
pub(super) fn end_effector(state: &RobotState) -> EndEffector {
    EndEffector::from_arrays(&state.F_T_EE, &state.EE_T_K)
}

/// Order of the derivative of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    Velocity,
    Acceleration,
    Jerk,
}

/// Returns the readings of all joint commands in a log. Each reading has the limit of the
/// derivative `which`.
pub(super) fn joint_readings(evidence: &Evidence<'_>, which: Which) -> Vec<Reading> {
    of_joints(evidence, Origin::Commanded, which, joints)
}

pub(super) fn resulting_readings(evidence: &Evidence<'_>, which: Which) -> Vec<Reading> {
    of_joints(evidence, Origin::Desired, which, |sample| {
        resulting(evidence.model, sample)
    })
}

fn of_joints(
    evidence: &Evidence<'_>,
    origin: Origin,
    which: Which,
    derive: impl Fn(&Sample<'_>) -> Option<(JointVector, Derivatives<7>)>,
) -> Vec<Reading> {
    let limits = evidence.model.joint_limits();
    let mut readings = Vec::new();
    if !evidence.commander.commands_every_cycle() {
        return readings;
    }
    for sample in evidence.samples() {
        let Some((_, asked)) = derive(&sample) else {
            continue;
        };
        for motion in with_rest(asked, &sample) {
            let cycle = sample.cycle();
            let error = |i: usize, order| joint_rounding(evidence, &sample, i, order);
            let (quantity, values, limit) = match which {
                Which::Velocity => {
                    let q = JointVector::from(sample.before.q_d);
                    let velocities =
                        velocities(evidence.model, origin, &q, &motion.velocity, cycle);
                    let velocities = velocities.into_iter().enumerate();
                    readings.extend(velocities.map(|(i, reading)| reading.within(error(i, 1))));
                    continue;
                }
                Which::Acceleration => (
                    Quantity::Acceleration,
                    motion.acceleration,
                    limits.acceleration,
                ),
                Which::Jerk => (Quantity::Jerk, motion.jerk, limits.jerk),
            };
            let order = if which == Which::Jerk { 3 } else { 2 };
            readings.extend((0..7).map(|i| {
                let subject = Subject::joint(i);
                Reading::magnitude(subject, quantity, origin, values[i], limit[i], cycle)
                    .within(error(i, order))
            }));
        }
    }
    readings
}

pub(super) fn position_readings(evidence: &Evidence<'_>) -> Vec<Reading> {
    let mut readings = Vec::new();
    for sample in evidence.samples() {
        // The robot ignores the position in the finishing command of an asynchronous motion.
        if sample.is_finished() && sample.command.q_c == [0.0; 7] {
            continue;
        }
        let commanded = joints(&sample).map(|(q, _)| (Origin::Commanded, q));
        let asked = commanded
            .or_else(|| resulting(evidence.model, &sample).map(|(q, _)| (Origin::Desired, q)));
        if let Some((origin, q)) = asked {
            readings.extend(positions(evidence.model, origin, &q, sample.cycle()));
        }
    }
    readings
}

pub(super) fn cartesian_readings(evidence: &Evidence<'_>, which: Which) -> Vec<Reading> {
    evidence
        .samples()
        .flat_map(|sample| {
            let error = pose_rounding(evidence, &sample, which);
            let readings = cartesian_readings_of(evidence.model, &sample, which);
            readings.into_iter().map(move |it| it.within(error))
        })
        .collect()
}

/// Returns the largest effect of rounding on a derivative of this order of a joint command. The
/// current and the previous position are rounded, and their difference is divided by powers of the
/// cycle time. The previous derivatives are separate numbers.
fn joint_rounding(evidence: &Evidence<'_>, sample: &Sample<'_>, i: usize, order: i32) -> f64 {
    if !evidence.rounded {
        return 0.0;
    }
    let (half, order) = match sample.before.motion_generator_mode {
        Generator::JointPosition => (half_digit(sample.command.q_c[i]), order),
        Generator::JointVelocity => (half_digit(sample.command.dq_c[i]), order - 1),
        // Near a singularity, the joints move ten times more than the pose.
        _ => (10.0 * half_digit(POSE), order),
    };
    2.0 * half / CYCLE.powi(order)
}

/// Returns the largest effect of rounding on a derivative of a Cartesian command. The previous
/// derivatives are differences, too.
fn pose_rounding(evidence: &Evidence<'_>, sample: &Sample<'_>, which: Which) -> f64 {
    let order = match which {
        _ if !evidence.rounded => return 0.0,
        Which::Velocity => 1,
        Which::Acceleration => 2,
        Which::Jerk => 3,
    };
    let order = match sample.before.motion_generator_mode {
        Generator::CartesianVelocity => order - 1,
        _ => order,
    };
    // Factor for the norm over three axes.
    3.0_f64.sqrt() * half_digit(POSE) * (2.0 / CYCLE).powi(order)
}

/// Returns half a unit of the last of six significant digits.
fn half_digit(value: f64) -> f64 {
    let digits = value.abs().max(1e-3).log10().floor();
    0.5 * 10f64.powi(digits as i32 - 5)
}

/// Returns one reading for the translation and one for the rotation.
pub(super) fn cartesian_readings_of(
    model: &Model,
    sample: &Sample<'_>,
    which: Which,
) -> Vec<Reading> {
    let limits = model.cartesian_limits();
    let Some((_, asked)) = cartesian(sample) else {
        return Vec::new();
    };
    let mut readings = Vec::new();
    for motion in with_rest(asked, sample) {
        let (quantity, vector, limit) = select(which, &motion);
        for (offset, limits) in [(0, &limits.translation), (3, &limits.rotation)] {
            let half = vector.fixed_rows::<3>(offset);
            let subject = Subject::component(offset + half.iamax());
            let limit = limit(limits);
            let (norm, cycle) = (half.norm(), sample.cycle());
            readings.push(Reading::magnitude(
                subject,
                quantity,
                Origin::Commanded,
                norm,
                limit,
                cycle,
            ));
        }
    }
    readings
}

pub(super) fn elbow_readings(evidence: &Evidence<'_>) -> Vec<Reading> {
    let limits = &evidence.model.cartesian_limits().elbow;
    let mut readings = Vec::new();
    for sample in evidence.samples() {
        let Some(motion) = elbow(&sample) else {
            continue;
        };
        for which in [Which::Velocity, Which::Acceleration, Which::Jerk] {
            let (quantity, value, limit) = select(which, &motion);
            readings.push(Reading::magnitude(
                Subject::Elbow,
                quantity,
                Origin::Commanded,
                value[0],
                limit(limits),
                sample.cycle(),
            ));
        }
    }
    readings
}

/// Returns the readings of the torque rate for every joint and every command.
pub(super) fn torque_readings(evidence: &Evidence<'_>) -> Vec<Reading> {
    let limit = &evidence.model.joint_limits().torque_rate;
    let mut readings = Vec::new();
    for sample in evidence.samples() {
        let Some(step) = torque_step(&sample) else {
            continue;
        };
        readings.extend((0..7).map(|i| {
            Reading::magnitude(
                Subject::joint(i),
                Quantity::TorqueRate,
                Origin::Commanded,
                step[i] / CYCLE,
                limit[i],
                sample.cycle(),
            )
        }));
    }
    readings
}

/// Returns the readings of a command. The last command also has readings of the standstill that
/// follows it.
fn with_rest<const N: usize>(
    asked: Derivatives<N>,
    sample: &Sample<'_>,
) -> impl Iterator<Item = Derivatives<N>> {
    let rest = sample.is_finished().then(|| asked.at_rest_next());
    core::iter::once(asked).chain(rest)
}

fn select<const N: usize>(
    which: Which,
    motion: &Derivatives<N>,
) -> (Quantity, SVector<f64, N>, fn(&MotionLimits) -> f64) {
    match which {
        Which::Velocity => (Quantity::Velocity, motion.velocity, |limits| {
            limits.velocity
        }),
        Which::Acceleration => (Quantity::Acceleration, motion.acceleration, |limits| {
            limits.acceleration
        }),
        Which::Jerk => (Quantity::Jerk, motion.jerk, |limits| limits.jerk),
    }
}

/// Returns the displacement and the rotation vector from `from` to `to`, in base axes.
pub(super) fn difference(to: &Isometry3<f64>, from: &Isometry3<f64>) -> Twist {
    let shift = to.translation.vector - from.translation.vector;
    let turn = rotation::error(&to.rotation, &from.rotation);
    Twist::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

fn halves(twist: &Twist) -> (Vector3<f64>, Vector3<f64>) {
    (
        twist.fixed_rows::<3>(0).into_owned(),
        twist.fixed_rows::<3>(3).into_owned(),
    )
}

/// Typical magnitude of the larger numbers in a pose: positions, `[m]`, and elements of a rotation
/// matrix.
const POSE: f64 = 0.5;

/// Number of Newton steps per cycle. Two or three steps are enough away from singular poses.
const ITERATIONS: usize = 4;

/// Largest change of a joint in one Newton step, `[rad]`.
const LEAP: f64 = 0.5;
