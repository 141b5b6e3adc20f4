//! The state of one millisecond, from everything that the robot knows.

use franka_model::{EndEffector, Frame, JointVector, Load, Model, Twist, elbow, transform};
use nalgebra::{Matrix3, Matrix4, Vector3};

use super::{Activity, Measurement, Robot};

impl Robot {
    /// Writes the state; `torque` is what the controllers commanded last, gravity excluded.
    pub(super) fn publish(&mut self, torque: &JointVector) {
        let Measurement { q, dq, .. } = self.measurement;
        let rate = self.config.unpublished.first_cycles;
        let elasticity = self.config.unpublished.joint_elasticity;
        let (mode, (generator, controller)) = (self.robot_mode(), self.modes());
        let (desired_torque, success_rate) = match &self.activity {
            Activity::Moving(motion) if motion.is_external() => {
                (*motion.torque(), motion.success_rate(rate))
            }
            Activity::Moving(motion) => (*torque, motion.success_rate(rate)),
            _ => (JointVector::zeros(), 0.0),
        };
        let (pose_d, twist_d) = self.desired_pose();

        let Self {
            settings,
            desired,
            estimate,
            measurement,
            state,
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
        state.theta = (q + measurement.torque / elasticity).into();
        state.dtheta = (dq + measurement.torque_rate / elasticity).into();

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
            (state.accelerometer_top, state.accelerometer_bottom) = accelerometers(self.model, &q);
        }

        state.motion_generator_mode = generator;
        state.controller_mode = controller;
        state.errors = self.errors;
        state.reflex_reason = self.reflex_reason;
        state.robot_mode = mode;
        state.control_command_success_rate = success_rate;
    }

    /// `O_T_EE_d` and `O_dP_EE_d`: what the desired joints mean for the end effector.
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

/// What the two acceleration sensors of each joint's board read: the support against gravity, in
/// the board's axes, `[m/s²]`. The motion of the boards is left out.
fn accelerometers(model: &Model, q: &JointVector) -> ([[f32; 3]; 6], [[f32; 3]; 6]) {
    let up = -franka_model::GRAVITY_EARTH;
    let mut top = [[0.0; 3]; 6];
    let mut bottom = [[0.0; 3]; 6];
    for board in 0..6 {
        let rotation: Matrix3<f64> = match board {
            0 => Matrix3::identity(),
            link => model
                .pose(Frame::ALL[link - 1], q, &EndEffector::default())
                .fixed_view::<3, 3>(0, 0)
                .into_owned(),
        };
        let in_link = rotation.tr_mul(&up);
        let (over, under) = BOARDS[board];
        top[board] = over.read(&in_link);
        bottom[board] = under.read(&in_link);
    }
    (top, bottom)
}

/// How a sensor's axes are turned about the x axis of its link.
#[derive(Debug, Clone, Copy)]
enum Turn {
    None,
    Quarter,
    Half,
    QuarterBack,
}

impl Turn {
    /// A vector of the link in the sensor's axes.
    fn read(self, v: &Vector3<f64>) -> [f32; 3] {
        let (x, y, z) = (v.x as f32, v.y as f32, v.z as f32);
        match self {
            Self::None => [x, y, z],
            Self::Quarter => [x, z, -y],
            Self::Half => [x, -y, -z],
            Self::QuarterBack => [x, -z, y],
        }
    }
}

/// Top and bottom sensor of links 0 to 5 (libfranka 0.21, `test/fr3.urdf`, accelerometer links).
const BOARDS: [(Turn, Turn); 6] = [
    (Turn::Half, Turn::None),
    (Turn::Quarter, Turn::QuarterBack),
    (Turn::QuarterBack, Turn::Quarter),
    (Turn::QuarterBack, Turn::Quarter),
    (Turn::Quarter, Turn::QuarterBack),
    (Turn::QuarterBack, Turn::Quarter),
];
