//! The robot's own low-pass filters on clients' commands.

use franka_model::{CYCLE, JointVector, rotation, transform};
use franka_proto::{Filters, RobotCommand};

use crate::generator::Desired;

/// Filters a command. The filters continue from the desired values and from the last torques,
/// `[N·m]`.
///
/// The filters are first-order low-passes with the gain `T / (T + 1 / 2πf)`. The highest cutoff
/// that can be set, 1000 Hz, means no filter (FCI documentation). An invalid pose passes unchanged
/// and is refused later.
pub(crate) fn filtered(
    command: &RobotCommand,
    before: &Desired,
    torque: &JointVector,
    filters: &Filters,
) -> RobotCommand {
    let mut out = *command;
    let joints = gain(filters.joint_position_filter_frequency);
    blend(&mut out.q_c, before.joints.q.as_slice(), joints);
    let joints = gain(filters.joint_velocity_filter_frequency);
    blend(&mut out.dq_c, before.joints.dq.as_slice(), joints);
    let twist = gain(filters.cartesian_velocity_filter_frequency);
    let before_twist = before.cartesian.twist;
    blend(&mut out.O_dP_EE_c, before_twist.as_slice(), twist);
    let controller = gain(filters.controller_filter_frequency);
    blend(&mut out.tau_J_d, torque.as_slice(), controller);

    let pose = gain(filters.cartesian_position_filter_frequency);
    if pose < 1.0 {
        if let Some(target) = transform::isometry_from_array(&command.O_T_EE_c) {
            let from = &before.cartesian.pose;
            let turn = rotation::error(&target.rotation, &from.rotation) * pose;
            let mut next = *from;
            next.rotation = rotation::exp(&turn) * from.rotation;
            let way = target.translation.vector - from.translation.vector;
            next.translation.vector += way * pose;
            out.O_T_EE_c = transform::array(&next);
        }
        if let Some([angle, _]) = &mut out.elbow_c {
            *angle = before.elbow.angle + (*angle - before.elbow.angle) * pose;
        }
    }
    out
}

fn blend<const N: usize>(values: &mut [f64; N], before: &[f64], gain: f64) {
    if gain < 1.0 {
        for (value, last) in values.iter_mut().zip(before) {
            *value = last + (*value - last) * gain;
        }
    }
}

fn gain(frequency: f64) -> f64 {
    if frequency >= OFF {
        return 1.0;
    }
    CYCLE / (CYCLE + 1.0 / (core::f64::consts::TAU * frequency))
}

/// Cutoff that means no filter, `[Hz]`.
const OFF: f64 = 1000.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::generator::ArmModel;
    use crate::kind::Description;
    use franka_model::{EndEffector, Model, READY, RobotKind};

    fn resting() -> Desired {
        let (frames, config) = (EndEffector::default(), Config::default());
        let kind = Description::of(RobotKind::Fer);
        Desired::resting(&ArmModel::new(kind, Model::fer(), &frames, &config), READY)
    }

    #[test]
    fn every_command_is_filtered_by_its_own_cutoff() {
        let before = resting();
        let mut shifted = before.cartesian.pose;
        shifted.translation.vector.x += 1.0;
        let command = RobotCommand {
            q_c: READY.add_scalar(1.0).into(),
            dq_c: [1.0; 7],
            O_T_EE_c: transform::array(&shifted),
            O_dP_EE_c: [1.0; 6],
            elbow_c: Some([before.elbow.angle + 1.0, -1.0]),
            tau_J_d: [1.0; 7],
            ..RobotCommand::default()
        };
        let filters = Filters {
            joint_position_filter_frequency: 50.0,
            joint_velocity_filter_frequency: 100.0,
            cartesian_position_filter_frequency: 200.0,
            cartesian_velocity_filter_frequency: 400.0,
            controller_filter_frequency: 999.0,
        };
        let out = filtered(&command, &before, &JointVector::zeros(), &filters);
        // Expected: libfranka's gain at 100 Hz.
        assert!((out.dq_c[3] - 0.385_869_545_095_037_5).abs() < 1e-15);
        let seen = [
            out.q_c[0] - READY[0],
            out.dq_c[0],
            out.O_T_EE_c[12] - before.cartesian.pose.translation.vector.x,
            out.O_dP_EE_c[0],
            out.tau_J_d[0],
        ];
        for (value, frequency) in seen.into_iter().zip([50.0, 100.0, 200.0, 400.0, 999.0]) {
            assert!((value - gain(frequency)).abs() < 1e-12, "{frequency}");
        }
        let [elbow, sign] = out.elbow_c.expect("there is one");
        assert!((elbow - before.elbow.angle - gain(200.0)).abs() < 1e-12 && sign == -1.0);
        let off = Filters::uniform(1000.0);
        let out = filtered(&command, &before, &JointVector::zeros(), &off);
        assert_eq!(out, command);
    }
}
