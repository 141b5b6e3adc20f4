//! Conversion of cycles to messages, and back.

use franka_model::transform;
use franka_proto::{ControllerMode, Errors, RobotState};
use franka_rt::driver::Activity;
use franka_rt::stats::Slack;
use nalgebra::Vector3;

use super::arrays::{
    get, get_exact, get_levels, isometry, matrix_of, pose, pose_of, put, put_levels,
    put_unless_zero,
};
use super::franka;
use super::numbers::{bindings, generator, generator_number, guard_number, robot_mode, seconds};
use crate::{Cycle, HostTime};

impl franka::Cycle {
    /// Replaces the contents with `cycle`, and reuses the memory of the fields.
    pub fn set(&mut self, cycle: &Cycle) {
        let (record, state) = (&cycle.record, &cycle.state);
        self.host_time = cycle.time.as_nanos();
        self.robot_time = record.time;
        self.skipped = record.skipped;
        self.activity = activity(record.activity).into();
        self.robot_mode = i32::from(record.robot_mode.byte());
        self.motion_generator_mode = generator_number(state.motion_generator_mode);
        self.controller_mode = u32::from(state.controller_mode.byte());
        self.errors = record.errors.bits();
        self.reflex_reason = record.reflex_reason.bits();
        self.success_rate = record.success_rate as f32;
        self.goal = record.goal;

        self.q.clear();
        self.q.extend(record.q);
        put(&mut self.dq, &record.dq);
        put(&mut self.tau_j, &state.tau_J);
        put(&mut self.tau_ext, &state.tau_ext_hat_filtered);
        put(&mut self.o_f_ext, &state.O_F_ext_hat_K);
        self.o_t_ee = pose_of(&state.O_T_EE);

        put_levels(&mut self.joint_contact, &state.joint_contact);
        put_levels(&mut self.joint_collision, &state.joint_collision);
        put_levels(&mut self.cartesian_contact, &state.cartesian_contact);
        put_levels(&mut self.cartesian_collision, &state.cartesian_collision);

        put(&mut self.q_d, &state.q_d);
        put(&mut self.dq_d, &state.dq_d);
        put(&mut self.ddq_d, &state.ddq_d);
        put(&mut self.tau_j_d, &state.tau_J_d);
        self.o_t_ee_d = pose_of(&state.O_T_EE_d);
        put(&mut self.o_d_p_ee_d, &state.O_dP_EE_d);

        put_unless_zero(&mut self.q_ref, &record.q_ref);
        put_unless_zero(&mut self.dq_ref, &record.dq_ref);
        put_unless_zero(&mut self.ddq_ref, &record.ddq_ref);
        self.reference = cycle.reference.as_ref().map(pose);
        self.target = record.pose_target.as_ref().map(pose);
        put(
            &mut self.q_target,
            record.q_target.as_ref().map_or(&[], |q| q),
        );
        self.elapsed = record.elapsed.as_secs_f32();
        self.remaining = record.remaining.as_secs_f32();

        put_unless_zero(&mut self.tau_c, &record.tau_c);
        put_unless_zero(&mut self.compensation, &record.compensation);
        self.guards.clear();
        self.guards.extend(record.bindings.iter().map(guard_number));

        self.late = record.late.as_secs_f32();
        self.turnaround = record.turnaround.as_secs_f32();
        self.slack = record
            .slack
            .map(|slack| (slack.as_nanos() as f64 * 1e-9) as f32);
    }

    /// Returns the cycle in this message. The caller provides the tool, because the message does
    /// not contain it.
    pub fn to_cycle(&self, tool: Option<&franka::Tool>) -> Cycle {
        let mut cycle = Cycle {
            time: HostTime::from_nanos(self.host_time),
            reference: self.reference.as_ref().and_then(isometry),
            ..Cycle::default()
        };
        self.fill_record(&mut cycle);
        self.fill_state(&mut cycle.state);
        if let Some(tool) = tool {
            tool.apply(&mut cycle.state);
        }
        derive(&mut cycle.state);
        cycle
    }

    fn fill_record(&self, cycle: &mut Cycle) {
        let record = &mut cycle.record;
        record.time = self.robot_time;
        record.skipped = self.skipped;
        record.activity = match self.activity() {
            franka::Activity::Watching => Activity::Watching,
            franka::Activity::Armed => Activity::Armed,
            franka::Activity::Waiting => Activity::Waiting,
            franka::Activity::Running => Activity::Running,
            franka::Activity::Finishing => Activity::Finishing,
            franka::Activity::Silent => Activity::Silent,
        };
        record.robot_mode = robot_mode(self.robot_mode);
        record.errors = Errors::from_bits(self.errors);
        record.reflex_reason = Errors::from_bits(self.reflex_reason);
        record.success_rate = f64::from(self.success_rate);
        record.goal = self.goal;
        record.q = get_exact(&self.q);
        record.dq = get(&self.dq);
        record.q_ref = get(&self.q_ref);
        record.dq_ref = get(&self.dq_ref);
        record.ddq_ref = get(&self.ddq_ref);
        record.q_target = (!self.q_target.is_empty()).then(|| get(&self.q_target));
        record.pose_target = self.target.as_ref().and_then(isometry);
        record.elapsed = seconds(self.elapsed.into());
        record.remaining = seconds(self.remaining.into());
        record.tau_c = get(&self.tau_c);
        record.compensation = get(&self.compensation);
        record.bindings = bindings(&self.guards);
        record.late = seconds(self.late.into());
        record.turnaround = seconds(self.turnaround.into());
        record.slack = self
            .slack
            .map(|slack| Slack::from_nanos((f64::from(slack) * 1e9).round() as i64));
    }

    fn fill_state(&self, state: &mut RobotState) {
        state.message_id = self.robot_time;
        state.robot_mode = robot_mode(self.robot_mode);
        state.motion_generator_mode = generator(self.motion_generator_mode);
        // Files of this crate contain no larger number.
        let controller = u8::try_from(self.controller_mode).unwrap_or(u8::MAX);
        state.controller_mode = ControllerMode::from_byte(controller);
        state.errors = Errors::from_bits(self.errors);
        state.reflex_reason = Errors::from_bits(self.reflex_reason);
        state.control_command_success_rate = f64::from(self.success_rate);
        state.q = get_exact(&self.q);
        state.dq = get(&self.dq);
        state.tau_J = get(&self.tau_j);
        state.tau_ext_hat_filtered = get(&self.tau_ext);
        state.O_F_ext_hat_K = get(&self.o_f_ext);
        state.O_T_EE = matrix_of(self.o_t_ee.as_ref());
        state.joint_contact = get_levels(&self.joint_contact);
        state.joint_collision = get_levels(&self.joint_collision);
        state.cartesian_contact = get_levels(&self.cartesian_contact);
        state.cartesian_collision = get_levels(&self.cartesian_collision);
        state.q_d = get(&self.q_d);
        state.dq_d = get(&self.dq_d);
        state.ddq_d = get(&self.ddq_d);
        state.tau_J_d = get(&self.tau_j_d);
        state.O_T_EE_d = matrix_of(self.o_t_ee_d.as_ref());
        state.O_dP_EE_d = get(&self.o_d_p_ee_d);
    }
}

/// Fills in the values that can be computed from other values.
fn derive(state: &mut RobotState) {
    let pose = |matrix| transform::isometry_from_array(matrix).unwrap_or_default();
    let stiffness = pose(&state.O_T_EE) * pose(&state.EE_T_K);
    let [x, y, z, a, b, c] = state.O_F_ext_hat_K;
    let (force, torque) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
    // In base axes, the torque of the wrench is relative to the origin of the base.
    let torque = torque - stiffness.translation.vector.cross(&force);
    let force: [f64; 3] = stiffness.inverse_transform_vector(&force).into();
    let torque: [f64; 3] = stiffness.inverse_transform_vector(&torque).into();
    state.K_F_ext_hat_K[..3].copy_from_slice(&force);
    state.K_F_ext_hat_K[3..].copy_from_slice(&torque);
    state.elbow = [state.q[2], if state.q[3] < 0.0 { -1.0 } else { 1.0 }];
}

fn activity(activity: Activity) -> franka::Activity {
    match activity {
        Activity::Armed => franka::Activity::Armed,
        Activity::Waiting => franka::Activity::Waiting,
        Activity::Running => franka::Activity::Running,
        Activity::Finishing => franka::Activity::Finishing,
        Activity::Silent => franka::Activity::Silent,
        _ => franka::Activity::Watching,
    }
}

#[cfg(test)]
mod tests {
    use core::time::Duration;

    use super::*;
    use franka_proto::{MotionGeneratorMode, RobotMode};
    use franka_rt::session::Guard;
    use nalgebra::Isometry3;
    use prost::Message as _;

    /// Returns a cycle whose numbers all differ, and have few digits.
    fn cycle() -> Cycle {
        let mut next = 0.0;
        let mut number = || {
            next += 0.125;
            next
        };
        let mut cycle = Cycle {
            time: HostTime::from_nanos(1_700_000_000_123_456_789),
            reference: Some(Isometry3::new(
                Vector3::new(0.5, 0.25, -0.125),
                Vector3::zeros(),
            )),
            ..Cycle::default()
        };
        let (record, state) = (&mut cycle.record, &mut cycle.state);
        record.time = 77;
        state.message_id = 77;
        record.skipped = 3;
        record.activity = Activity::Running;
        record.robot_mode = RobotMode::Reflex;
        state.robot_mode = RobotMode::Reflex;
        state.motion_generator_mode = MotionGeneratorMode::None;
        state.controller_mode = ControllerMode::ExternalController;
        record.errors = Errors::from_bits(0b101);
        state.errors = record.errors;
        record.reflex_reason = Errors::from_bits(1 << 40);
        state.reflex_reason = record.reflex_reason;
        record.success_rate = 0.75;
        state.control_command_success_rate = 0.75;
        record.goal = 12;
        record.q = core::array::from_fn(|joint| 0.1 * joint as f64 - 1.0 / 3.0);
        state.q = record.q;
        let mut seven = || core::array::from_fn::<f64, 7, _>(|_| number());
        record.dq = seven();
        state.dq = record.dq;
        for field in [
            &mut record.q_ref,
            &mut record.dq_ref,
            &mut record.ddq_ref,
            &mut record.tau_c,
            &mut record.compensation,
            &mut state.tau_J,
            &mut state.tau_ext_hat_filtered,
            &mut state.q_d,
            &mut state.dq_d,
            &mut state.ddq_d,
            &mut state.tau_J_d,
        ] {
            *field = seven();
        }
        for field in [&mut state.O_F_ext_hat_K, &mut state.O_dP_EE_d] {
            *field = core::array::from_fn(|_| number());
        }
        state.O_T_EE[12..15].copy_from_slice(&[0.5, -0.25, 0.75]);
        state.O_T_EE_d[12..15].copy_from_slice(&[1.5, -1.25, 1.75]);
        let [x, y, z, a, b, c] = state.O_F_ext_hat_K;
        let (force, about_base) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
        let about_k = about_base - Vector3::new(0.5, -0.25, 0.75).cross(&force);
        state.K_F_ext_hat_K = [x, y, z, about_k.x, about_k.y, about_k.z];
        state.elbow = [state.q[2], -1.0];
        state.joint_contact[2] = 1.0;
        state.joint_collision[3] = 1.0;
        state.cartesian_contact[4] = 1.0;
        state.cartesian_collision[5] = 1.0;
        record.pose_target = Some(Isometry3::translation(0.0, 1.0, 2.0));
        record.q_target = Some([0.5; 7]);
        record.bindings.insert(Guard::Leash);
        record.bindings.insert(Guard::Team);
        record.elapsed = Duration::from_millis(500);
        record.remaining = Duration::from_millis(250);
        record.late = Duration::ZERO;
        record.turnaround = Duration::from_secs(1) / 8192;
        record.slack = Some(Slack::from_nanos(-1_000_000_000 / 4));
        state.m_load = 1.0 / 3.0;
        state.F_T_EE[14] = 0.1034;
        cycle
    }

    #[test]
    fn a_cycle_survives_its_message() {
        let cycle = cycle();
        let mut message = franka::Cycle::default();
        message.set(&Cycle::default());
        message.set(&cycle);
        let bytes = message.encode_to_vec();
        let message = franka::Cycle::decode(&*bytes).unwrap();
        let tool = franka::Tool::of(&cycle.state);
        assert!(tool.is_of(&cycle.state));
        assert_eq!(message.to_cycle(Some(&tool)), cycle);
        message.to_cycle(None);
    }

    #[test]
    fn a_cycle_without_numbers_survives() {
        let mut cycle = Cycle::default();
        cycle.state.elbow = [0.0, 1.0];
        let mut message = franka::Cycle::default();
        message.set(&cycle);
        assert_eq!(message.to_cycle(None), cycle);
    }
}
