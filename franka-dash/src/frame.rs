//! The binary state frame. The page draws it 60 times per second.
//!
//! Little-endian, unpadded, [`LENGTH`] bytes, version [`VERSION`]:
//!
//! | offset | type | content |
//! |---|---|---|
//! | 0 | u16 | 0x4446, "FD" |
//! | 2 | u8 | version of this layout |
//! | 3 | u8 | robot mode: the robot's number, 0 to 6 |
//! | 4 | u32 | length of the frame in bytes |
//! | 8 | u64 | time of the server, `[ms]`: for the acknowledgement |
//! | 16 | u64 | robot time (`message_id`), `[ms]` |
//! | 24 | u32 | bit 0: a motion runs; bit 1: the reference is this driver's; bit 2: a hold is active; bits 3 to 5: the law, see [`law`] |
//! | 28 | f32 | success rate of commands, 0 to 1 |
//! | 32 | 7 f32 | q, `[rad]` |
//! | 60 | 7 f32 | dq, `[rad/s]` |
//! | 88 | 7 f32 | tau_J, `[N m]` |
//! | 116 | 7 f32 | tau_ext_hat_filtered, `[N m]` |
//! | 144 | 6 f32 | external wrench in base axes, its torque about the stiffness frame, `[N, N m]` |
//! | 168 | 7 f32 | reference of the joints, `[rad]` |
//! | 196 | 9 poses | joint frames 1 to 7, flange, end effector, as measured |
//! | 448 | 9 poses | the same at the reference |
//! | 700 | u32 | guards that were active within the last 0.1 s, one bit each in the order of the hello |
//! | 704 | f32 | width between the fingers, `[m]`; NaN without a gripper |
//! | 708 | 7 f32 | dq as a share of the joint's velocity limit at q, -1 to 1 |
//!
//! A pose is 7 f32: position x y z `[m]` and quaternion x y z w, in the base frame.

use franka_async::model::{EndEffector, Frame, JointVector, Model};
use franka_async::pose;
use franka_async::state::{ControllerMode, RobotState};

use crate::source::Sample;

pub(crate) const VERSION: u8 = 3;
pub(crate) const LENGTH: usize = 736;
const MAGIC: u16 = 0x4446;

/// The frames whose poses a state frame contains.
const FRAMES: [Frame; 9] = [
    Frame::Joint1,
    Frame::Joint2,
    Frame::Joint3,
    Frame::Joint4,
    Frame::Joint5,
    Frame::Joint6,
    Frame::Joint7,
    Frame::Flange,
    Frame::EndEffector,
];

/// Data of the server that a frame contains, besides the robot's state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Server {
    /// Time of the server, `[ms]`.
    pub(crate) ms: u64,
    pub(crate) holding: bool,
    /// Width between the fingers, `[m]`; `None` without a connected gripper.
    pub(crate) width: Option<f64>,
}

pub(crate) fn encode(sample: &Sample, model: &Model, server: Server) -> Vec<u8> {
    let Sample {
        state,
        reference,
        guards,
    } = sample;
    let mut frame = Vec::with_capacity(LENGTH);
    frame.extend(MAGIC.to_le_bytes());
    frame.extend([VERSION, state.robot_mode.byte()]);
    frame.extend((LENGTH as u32).to_le_bytes());
    frame.extend(server.ms.to_le_bytes());
    frame.extend(state.message_id.to_le_bytes());
    let flags = u32::from(state.motion_running())
        | u32::from(reference.is_some()) << 1
        | u32::from(server.holding) << 2
        | law(state, reference.is_some()) << 3;
    frame.extend(flags.to_le_bytes());
    let wanted = reference.unwrap_or(state.q_d);
    let mut put = |numbers: &[f64]| {
        for number in numbers {
            frame.extend((*number as f32).to_le_bytes());
        }
    };
    put(&[state.control_command_success_rate]);
    put(&state.q);
    put(&state.dq);
    put(&state.tau_J);
    put(&state.tau_ext_hat_filtered);
    put(&state.wrench_at_stiffness_frame());
    put(&wanted);
    for q in [state.q, wanted] {
        for (position, quaternion) in poses(model, state, q) {
            put(&position);
            put(&quaternion);
        }
    }
    frame.extend(guards.to_bits().to_le_bytes());
    let width = server.width.map_or(f32::NAN, |width| width as f32);
    frame.extend(width.to_le_bytes());
    let (lower, upper) = model.joint_limits().velocity_envelope(&state.q.into(), 0.0);
    for (joint, dq) in state.dq.iter().enumerate() {
        let most = if *dq < 0.0 {
            -lower[joint]
        } else {
            upper[joint]
        };
        // At the end of the range the limit is zero.
        let share = (dq / most.max(1e-9)).clamp(-1.0, 1.0);
        frame.extend((share as f32).to_le_bytes());
    }
    debug_assert_eq!(frame.len(), LENGTH);
    frame
}

/// Returns the number of the law that computes the torques. 0 means no law, and 1 means target
/// control of this driver. 2 means torques of another client or motion. 3 and 4 mean the robot's
/// joint impedance and Cartesian impedance.
fn law(state: &RobotState, ours: bool) -> u32 {
    if !state.motion_running() {
        return 0;
    }
    match state.controller_mode {
        ControllerMode::ExternalController if ours => 1,
        ControllerMode::ExternalController => 2,
        ControllerMode::JointImpedance => 3,
        ControllerMode::CartesianImpedance => 4,
        _ => 0,
    }
}

/// Returns the poses of the frames at the joint positions `q`.
pub(crate) fn poses(
    model: &Model,
    state: &RobotState,
    q: [f64; 7],
) -> impl Iterator<Item = ([f64; 3], [f64; 4])> {
    let q = JointVector::from(q);
    let tool = end_effector(state);
    FRAMES.into_iter().map(move |frame| {
        let placed = pose::from_matrix(&model.pose(frame, &q, &tool));
        pose::to_xyzw(&placed.unwrap_or_default())
    })
}

/// Returns the end effector of a state. If its pose is not a rigid transformation, returns the
/// default.
pub(crate) fn end_effector(state: &RobotState) -> EndEffector {
    let on_flange = pose::from_array(&state.F_T_EE).unwrap_or_default();
    EndEffector {
        f_t_ee: on_flange.to_homogeneous(),
        ..EndEffector::default()
    }
}

#[cfg(test)]
mod tests {
    use franka_async::READY;
    use franka_async::record::{Bindings, Guard};
    use franka_async::state::{MotionGeneratorMode, RobotMode};

    use super::*;

    fn number(frame: &[u8], offset: usize) -> f64 {
        let bytes = frame[offset..offset + 4].try_into().expect("four bytes");
        f64::from(f32::from_le_bytes(bytes))
    }

    #[test]
    fn a_frame_has_the_documented_layout() {
        let q: [f64; 7] = READY.into();
        let state = RobotState {
            message_id: 7,
            q,
            q_d: [0.1; 7],
            dq: [0.2; 7],
            tau_J: [0.3; 7],
            tau_ext_hat_filtered: [0.4; 7],
            O_F_ext_hat_K: [0.5; 6],
            robot_mode: RobotMode::Reflex,
            control_command_success_rate: 0.75,
            ..RobotState::default()
        };
        let reference = Some([0.6; 7]);
        let model = Model::fr3();
        let sample = Sample {
            state,
            reference,
            guards: Bindings::of(&[Guard::ALL[0], Guard::ALL[9]]),
        };
        let server = Server {
            ms: 9,
            holding: true,
            width: Some(0.03),
        };
        let frame = encode(&sample, model, server);
        assert_eq!(frame.len(), LENGTH);
        assert_eq!(frame[..8], [0x46, 0x44, VERSION, 4, 0xe0, 2, 0, 0]);
        assert_eq!((frame[8], frame[16], frame[24]), (9, 7, 6));
        let at = |offset, wanted: f64| assert!((number(&frame, offset) - wanted).abs() < 1e-6);
        at(28, 0.75);
        at(32, q[0]);
        at(56, q[6]);
        at(60, 0.2);
        at(88, 0.3);
        at(116, 0.4);
        at(144, 0.5);
        at(168, 0.6);
        // The flange at the ready pose; without a tool the end effector is at the flange.
        let flange = model.pose(Frame::Flange, &READY, &EndEffector::default());
        for offset in [196 + 7 * 28, 196 + 8 * 28] {
            at(offset, flange[(0, 3)]);
            at(offset + 8, flange[(2, 3)]);
        }
        let wanted = model.pose(Frame::Flange, &[0.6; 7].into(), &EndEffector::default());
        at(448 + 7 * 28, wanted[(0, 3)]);
        assert_eq!(frame[700..704], [1, 2, 0, 0]);
        at(704, 0.03);
        // Far from the ends of the range, the envelope equals the nominal velocity limit.
        at(708, 0.2 / model.joint_limits().velocity[0]);
    }

    #[test]
    fn the_velocity_that_is_left_is_that_at_the_place_of_the_joint() {
        let model = Model::fr3();
        let share = |q: f64, dq: f64| {
            let mut state = RobotState::default();
            (state.q[0], state.dq[0]) = (q, dq);
            let frame = encode(&sample_of(state), model, AT_FIRST);
            number(&frame, 708)
        };
        let end = model.joint_limits().upper[0];
        assert!(share(end, 0.1) > 2.0 * share(0.0, 0.1));
        assert_eq!(share(end, 3.0), 1.0);
        assert!((share(0.0, -0.1) + share(0.0, 0.1)).abs() < 1e-6);
        assert!((share(end, -0.1) + share(0.0, 0.1)).abs() < 1e-6);
    }

    #[test]
    fn the_law_is_that_of_the_motion_that_runs() {
        let of = |mode, controller, reference: Option<[f64; 7]>| {
            let state = RobotState {
                motion_generator_mode: mode,
                controller_mode: controller,
                robot_mode: RobotMode::Move,
                ..RobotState::default()
            };
            let sample = Sample {
                reference,
                ..sample_of(state)
            };
            encode(&sample, Model::fr3(), AT_FIRST)[24] >> 3
        };
        let (idle, none) = (MotionGeneratorMode::Idle, MotionGeneratorMode::None);
        let client = ControllerMode::ExternalController;
        assert_eq!(of(idle, ControllerMode::Other, None), 0);
        assert_eq!(of(none, client, Some([0.0; 7])), 1);
        assert_eq!(of(none, client, None), 2);
        let positions = MotionGeneratorMode::JointPosition;
        assert_eq!(of(positions, ControllerMode::JointImpedance, None), 3);
        assert_eq!(of(positions, ControllerMode::CartesianImpedance, None), 4);
    }

    const AT_FIRST: Server = Server {
        ms: 0,
        holding: false,
        width: None,
    };

    fn sample_of(state: RobotState) -> Sample {
        Sample {
            state,
            reference: None,
            guards: Bindings::default(),
        }
    }

    #[test]
    fn without_a_reference_that_of_the_robot_is_shown() {
        let state = RobotState {
            q_d: [0.1; 7],
            ..RobotState::default()
        };
        let frame = encode(&sample_of(state), Model::fer(), AT_FIRST);
        assert_eq!(frame[24], 0);
        assert!(number(&frame, 704).is_nan());
        assert!((number(&frame, 168) - 0.1).abs() < 1e-6);
    }
}
