//! The state that the robot publishes each millisecond.

use franka_model::{Frame, JointVector, Load, Twist, elbow, transform};
use franka_proto::MotionGeneratorMode;
use nalgebra::Matrix4;

use super::{Activity, Measurement, Robot};

impl Robot {
    /// Writes the state. `torque` is the controllers' last command, without gravity.
    pub(super) fn publish(&mut self, torque: &JointVector) {
        let Measurement { q, dq, .. } = self.measurement;
        let rate = self.config.unpublished.first_cycles;
        let rigid = JointVector::repeat(self.config.unpublished.joint_elasticity);
        let elasticity = self.train.stiffness().unwrap_or(rigid);
        let (mode, (generator, controller)) = (self.robot_mode(), self.modes());
        let zero_fields = self.config.unpublished.zero_fields;
        let takes_none = self.takes_no_commands();
        let (desired_torque, success_rate) = match &self.activity {
            Activity::Moving(motion) => {
                let torque = match motion.is_external() {
                    true if takes_none => JointVector::zeros(),
                    true => *motion.torque(),
                    false if zero_fields => JointVector::zeros(),
                    false => *torque,
                };
                (torque, motion.success_rate(rate))
            }
            _ => (JointVector::zeros(), 0.0),
        };
        let has_commanded_pose = !(zero_fields
            && matches!(
                generator,
                MotionGeneratorMode::JointPosition | MotionGeneratorMode::JointVelocity
            ));
        let (pose_d, twist_d) = self.desired_pose();

        let Self {
            settings,
            desired,
            estimate,
            measurement,
            state,
            arm,
            ..
        } = self;
        let flag = |on: bool| if on { 1.0 } else { 0.0 };
        let tool = &settings.tool;

        state.message_id = self.clock;
        state.O_T_EE = array(&self.dynamics.pose);
        state.O_T_EE_d = array(&pose_d);
        state.F_T_EE = array(&settings.frames.f_t_ee);
        state.EE_T_K = array(&settings.frames.ee_t_k);
        state.F_T_NE = array(&tool.f_t_ne);
        state.NE_T_EE = array(&settings.ne_t_ee);
        (state.m_ee, state.F_x_Cee, state.I_ee) = body(&tool.load);
        (state.m_load, state.F_x_Cload, state.I_load) = body(&settings.load);

        let side = elbow::elbow(&desired.joints.q)[1];
        state.elbow = elbow::elbow(&q);
        state.elbow_d = elbow::elbow(&desired.joints.q);
        state.elbow_c = [desired.elbow.angle, side];
        state.delbow_c = [desired.elbow.velocity, 0.0];
        state.ddelbow_c = [desired.elbow.acceleration, 0.0];

        state.tau_J = measurement.torque.into();
        state.tau_J_d = desired_torque.into();
        state.dtau_J = measurement.torque_rate.into();
        state.q = q.into();
        state.dq = dq.into();
        state.q_d = desired.joints.q.into();
        state.dq_d = desired.joints.dq.into();
        state.ddq_d = desired.joints.ddq.into();
        let wound = measurement.torque.component_div(&elasticity);
        state.theta = (q + wound + arm.sensors.motor_offset).into();
        state.dtheta = (dq + measurement.torque_rate.component_div(&elasticity)).into();

        state.joint_contact = estimate.joint_contact.map(flag);
        state.cartesian_contact = estimate.cartesian_contact.map(flag);
        state.joint_collision = estimate.joint_collision.map(flag);
        state.cartesian_collision = estimate.cartesian_collision.map(flag);
        state.tau_ext_hat_filtered = estimate.torque.into();
        state.O_F_ext_hat_K = estimate.wrench_base.into();
        state.K_F_ext_hat_K = estimate.wrench_stiffness.into();

        state.O_dP_EE_d = twist_d.into();
        state.O_T_EE_c = transform::array(&desired.cartesian.pose);
        state.O_dP_EE_c = desired.cartesian.twist.into();
        state.O_ddP_EE_c = desired.cartesian.acceleration.into();
        state.O_ddP_O = franka_model::GRAVITY_EARTH.into();
        if self.kind.version.has_accelerometers() {
            (state.accelerometer_top, state.accelerometer_bottom) = self.boards.read();
        }

        if !has_commanded_pose {
            state.O_T_EE_c = [0.0; 16];
            (state.O_dP_EE_c, state.O_ddP_EE_c) = ([0.0; 6], [0.0; 6]);
            (state.elbow_c, state.delbow_c, state.ddelbow_c) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        }

        state.motion_generator_mode = generator;
        state.controller_mode = controller;
        state.errors = self.errors;
        state.reflex_reason = self.reflex_reason;
        state.robot_mode = mode;
        state.control_command_success_rate = success_rate;
    }

    /// `O_T_EE_d` and `O_dP_EE_d`: pose and twist of the end effector for the desired joints.
    fn desired_pose(&self) -> (Matrix4<f64>, Twist) {
        let (joints, frames) = (&self.desired.joints, &self.settings.frames);
        let pose = self.model.pose(Frame::EndEffector, &joints.q, frames);
        if joints.dq == JointVector::zeros() {
            return (pose, Twist::zeros());
        }
        let jacobian = self
            .model
            .zero_jacobian(Frame::EndEffector, &joints.q, frames);
        (pose, jacobian * joints.dq)
    }
}

fn array(matrix: &Matrix4<f64>) -> [f64; 16] {
    let mut column_major = [0.0; 16];
    column_major.copy_from_slice(matrix.as_slice());
    column_major
}

fn body(load: &Load) -> (f64, [f64; 3], [f64; 9]) {
    let mut inertia = [0.0; 9];
    inertia.copy_from_slice(load.inertia.as_slice());
    (load.mass, load.com.into(), inertia)
}
