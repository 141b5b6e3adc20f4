//! Properties that hold for any bytes and any values.
#![allow(non_snake_case)]

use franka_proto::framing::{Header, Message, next_message};
use franka_proto::{
    CollisionBehavior, Command, CommandId, ControllerMode, Deviation, EncodeError, Errors, Filters,
    Load, MotionGeneratorMode, MoveControllerMode, MoveGeneratorMode, MoveRequest, Reply, Request,
    RobotCommand, RobotMode, RobotState, Version, client, server,
};
use proptest::array::{uniform3, uniform6, uniform7, uniform16};
use proptest::prelude::*;

fn version() -> impl Strategy<Value = Version> {
    prop::sample::select(&Version::ALL[..])
}

/// Generates finite numbers of any size.
fn number() -> impl Strategy<Value = f64> {
    prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO
}

fn command() -> impl Strategy<Value = RobotCommand> {
    (
        any::<u64>(),
        uniform7(number()),
        uniform7(number()),
        uniform16(number()),
        uniform6(number()),
        prop::option::of(prop::array::uniform2(number())),
        any::<bool>(),
        uniform7(number()),
    )
        .prop_map(
            |(message_id, q_c, dq_c, pose, twist, elbow_c, finished, tau_J_d)| RobotCommand {
                message_id,
                q_c,
                dq_c,
                O_T_EE_c: pose,
                O_dP_EE_c: twist,
                elbow_c,
                motion_generation_finished: finished,
                tau_J_d,
                torque_command_finished: false,
            },
        )
}

fn request() -> impl Strategy<Value = Request> {
    let controller = prop::sample::select(vec![
        MoveControllerMode::JointImpedance,
        MoveControllerMode::CartesianImpedance,
        MoveControllerMode::ExternalController,
    ]);
    let generator = prop::sample::select(vec![
        MoveGeneratorMode::JointPosition,
        MoveGeneratorMode::JointVelocity,
        MoveGeneratorMode::CartesianPosition,
        MoveGeneratorMode::CartesianVelocity,
    ]);
    let deviation = || {
        uniform3(number()).prop_map(|[translation, rotation, elbow]| Deviation {
            translation,
            rotation,
            elbow,
        })
    };
    let velocities = prop::option::of(uniform7(number()));
    let motion = (controller, generator, deviation(), deviation(), velocities);
    let thresholds = (
        uniform7(number()),
        uniform7(number()),
        uniform6(number()),
        uniform6(number()),
    );
    let load = (
        number(),
        uniform3(number()),
        prop::array::uniform9(number()),
    );
    prop_oneof![
        motion.prop_map(
            |(controller, generator, path, goal, asynchronous)| Request::Move(MoveRequest {
                controller,
                generator,
                maximum_path_deviation: path,
                maximum_goal_pose_deviation: goal,
                asynchronous,
            })
        ),
        thresholds.prop_map(|(a, b, c, d)| {
            Request::SetCollisionBehavior(CollisionBehavior::uniform(a, b, c, d))
        }),
        uniform7(number()).prop_map(Request::SetJointImpedance),
        uniform6(number()).prop_map(Request::SetCartesianImpedance),
        uniform16(number()).prop_map(Request::SetEEToK),
        uniform16(number()).prop_map(Request::SetNEToEE),
        (uniform6(any::<bool>()), any::<bool>()).prop_map(|(guiding_mode, nullspace)| {
            Request::SetGuidingMode {
                guiding_mode,
                nullspace,
            }
        }),
        load.prop_map(|(m_load, F_x_Cload, I_load)| Request::SetLoad(Load {
            m_load,
            F_x_Cload,
            I_load,
        })),
        (any::<u16>(), any::<u16>())
            .prop_map(|(version, udp_port)| Request::Connect { version, udp_port }),
        Just(Request::StopMove),
        Just(Request::AutomaticErrorRecovery),
        Just(Request::GetRobotModel),
        number().prop_map(|frequency| Request::SetFilters(Filters::uniform(frequency))),
        any::<i32>().prop_map(|id| Request::GetCartesianLimit { id }),
    ]
}

/// Generates datagrams of a state, with random finite numbers, any errors, and modes in range.
fn state_bytes(version: Version) -> impl Strategy<Value = Vec<u8>> {
    let size = version.state_size();
    // The modes and flags lie between the numbers and the success rate.
    let real = if version.has_accelerometers() { 4 } else { 8 };
    let tail = 2 + 41 + 41 + 1 + real;
    let numbers = (size - 8 - tail) / real;
    let modes = (0..5u8, 0..4u8, prop::collection::vec(0..2u8, 82), 0..7u8);
    let reals = prop::collection::vec(prop::num::f32::NORMAL, numbers + 1);
    (any::<u64>(), reals, modes).prop_map(
        move |(id, reals, (generator, controller, flags, mode))| {
            let mut bytes = id.to_le_bytes().to_vec();
            let push = |bytes: &mut Vec<u8>, value: f32| match real {
                4 => bytes.extend(value.to_le_bytes()),
                _ => bytes.extend(f64::from(value).to_le_bytes()),
            };
            for &value in &reals[1..] {
                push(&mut bytes, value);
            }
            bytes.extend([generator, controller]);
            bytes.extend(flags);
            bytes.push(mode);
            push(&mut bytes, reals[0]);
            bytes
        },
    )
}

proptest! {
    #[test]
    fn a_state_comes_back_byte_for_byte(
        (version, bytes) in version().prop_flat_map(|v| (Just(v), state_bytes(v)))
    ) {
        prop_assert_eq!(bytes.len(), version.state_size());
        let state = RobotState::decode(version, &bytes).unwrap();
        let mut again = [0xaa; RobotState::MAX_SIZE];
        let size = state.encode(version, &mut again).unwrap();
        prop_assert_eq!(&again[..size], &bytes[..]);
        let text = state.text(version).to_string();
        prop_assert_eq!(text.split(' ').next(), Some("{\"O_T_EE\":"));
        prop_assert!(again[size..].iter().all(|&byte| byte == 0xaa));
    }

    #[test]
    fn a_command_comes_back_value_for_value(version in version(), command in command()) {
        let mut bytes = [0xaa; RobotCommand::MAX_SIZE];
        let size = command.encode(version, &mut bytes).unwrap();
        prop_assert_eq!(size, version.command_size());
        prop_assert_eq!(RobotCommand::decode(version, &bytes[..size]), Ok(command));
        prop_assert!(RobotCommand::decode(version, &bytes[..size - 1]).is_err());
    }

    #[test]
    fn a_request_comes_back_value_for_value(
        version in version(), request in request(), id in any::<u32>()
    ) {
        let encoded = request.encode(version, CommandId(id));
        let exists = match request {
            Request::Move(motion) if motion.asynchronous.is_some() => {
                version.has_asynchronous_motion()
            }
            request => version.supports(request.command()),
        };
        prop_assert_eq!(encoded.is_ok(), exists);
        let Ok(outgoing) = encoded else { return Ok(()) };
        let message = next_message(outgoing.as_bytes()).unwrap().unwrap();
        prop_assert_eq!(message.header.command_id, id);
        prop_assert_eq!(Request::decode(version, &message), Ok(request));
    }

    #[test]
    fn no_bytes_make_a_decoder_panic(
        version in version(),
        bytes in prop::collection::vec(any::<u8>(), 0..2600)
    ) {
        let state = RobotState::decode(version, &bytes);
        prop_assert_eq!(state.is_ok(), bytes.len() >= version.state_size());
        let command = RobotCommand::decode(version, &bytes);
        prop_assert_eq!(command.is_ok(), bytes.len() >= version.command_size());
        let _ = next_message(&bytes);
        if let Ok(state) = state {
            let _ = state.total_load(version);
        }
    }

    /// Ids and command numbers are small, so that they often match known numbers.
    #[test]
    fn no_messages_make_a_session_panic(
        version in version(),
        connected in any::<bool>(),
        messages in prop::collection::vec(
            (0..16u32, 0..8u32, prop::collection::vec(0..14u8, 0..450)), 0..40
        )
    ) {
        let mut client = client::Session::new(version);
        let mut server = server::Session::new(version);
        let hello = client.connect(1);
        if connected {
            let hello = next_message(hello.as_bytes()).unwrap().unwrap();
            let Ok(server::Event::Connect { reply, .. }) = server.on_message(hello) else {
                panic!("the handshake fails");
            };
            client.on_message(next_message(reply.as_bytes()).unwrap().unwrap()).unwrap();
            client.request(&Request::StopMove).unwrap();
            client.request(&Request::SetEEToK([0.0; 16])).unwrap();
        }
        for (command, command_id, payload) in &messages {
            let size = (Header::SIZE + payload.len()) as u32;
            let header = Header { command: *command, command_id: *command_id, size };
            let message = Message { header, payload };
            let _ = client.on_message(message);
            let _ = server.on_message(message);
            for command in Command::ALL {
                if let Ok(reply) = Reply::decode(version, command, &message) {
                    // A decoded reply is of the right kind.
                    prop_assert!(reply.suits(command));
                }
            }
            prop_assert!(client.pending() <= <client::Session>::PENDING_LIMIT);
        }
    }
}

#[test]
fn every_byte_of_a_mode_is_read() {
    let mut bytes = [0; RobotState::MAX_SIZE];
    for (version, offset) in [(Version::V10, 1288), (Version::V5, 2280)] {
        for byte in 0..=u8::MAX {
            bytes[offset] = byte;
            bytes[offset + 1] = byte;
            let state = RobotState::decode(version, &bytes).unwrap();
            let mut again = [0; RobotState::MAX_SIZE];
            state.encode(version, &mut again).unwrap();
            assert_eq!(again[offset..offset + 2], [byte, byte]);
        }
        bytes[offset] = 5;
        let mode = RobotState::decode(version, &bytes)
            .unwrap()
            .motion_generator_mode;
        let expected = match version {
            Version::V5 => MotionGeneratorMode::Unknown(5),
            Version::V10 => MotionGeneratorMode::None,
        };
        assert_eq!(mode, expected);
    }
}

#[test]
fn the_default_state_is_at_rest_with_identity_poses() {
    let state = RobotState::default();
    assert!(!state.motion_running());
    assert_eq!(state.robot_mode, RobotMode::Other);
    assert_eq!(state.controller_mode, ControllerMode::Other);
    assert_eq!(state.errors, Errors::NONE);
    for pose in [state.O_T_EE, state.F_T_NE, state.EE_T_K] {
        assert_eq!((pose[0], pose[5], pose[10], pose[15]), (1.0, 1.0, 1.0, 1.0));
        assert_eq!(pose.iter().sum::<f64>(), 4.0);
    }
}

#[test]
fn a_finish_of_torques_alone_exists_in_protocol_10_only() {
    let command = RobotCommand {
        torque_command_finished: true,
        ..RobotCommand::default()
    };
    let mut bytes = [0xaa; RobotCommand::MAX_SIZE];
    let what = "torque_command_finished";
    let refused = command.encode(Version::V5, &mut bytes);
    assert_eq!(refused, Err(EncodeError::Unsupported { what }));
    assert!(bytes.iter().all(|&byte| byte == 0xaa));
    let size = command.encode(Version::V10, &mut bytes).unwrap();
    assert_eq!(
        RobotCommand::decode(Version::V10, &bytes[..size]),
        Ok(command)
    );
}

#[test]
fn a_buffer_that_is_too_short_is_an_error_and_stays_untouched() {
    for version in Version::ALL {
        let mut buffer = [0xaa; RobotState::MAX_SIZE];
        let refused = |needed: usize| {
            let got = needed - 1;
            Err(EncodeError::Buffer { got, needed })
        };
        let size = version.state_size();
        let encoded = RobotState::default().encode(version, &mut buffer[..size - 1]);
        assert_eq!(encoded, refused(size));
        let size = version.command_size();
        let encoded = RobotCommand::default().encode(version, &mut buffer[..size - 1]);
        assert_eq!(encoded, refused(size));
        assert!(buffer.iter().all(|&byte| byte == 0xaa));
    }
}
