//! Missing commands: the robot's extrapolation, and its consequences.

use franka_model::CYCLE;

use crate::pair::*;

/// The values that a kind of motion commands, and their derivatives, as in the state.
struct Channel {
    name: &'static str,
    generator: MoveGeneratorMode,
    /// Returns a command at the distance `shift` from the start. The first argument is the state at
    /// the start.
    command: fn(&RobotState, f64) -> RobotCommand,
    /// Returns the commanded value, its velocity and its acceleration.
    told: fn(&RobotState) -> [f64; 3],
    /// Distance from the start after 0.6 s, or the speed if the command is a velocity.
    way: f64,
    is_rate: bool,
}

const CHANNELS: [Channel; 5] = [
    Channel {
        name: "joint position",
        generator: MoveGeneratorMode::JointPosition,
        command: |start, shift| {
            let mut command = RobotCommand {
                q_c: start.q_d,
                ..RobotCommand::default()
            };
            command.q_c[3] += shift;
            command
        },
        told: |state| [state.q_d[3], state.dq_d[3], state.ddq_d[3]],
        way: 0.1,
        is_rate: false,
    },
    Channel {
        name: "joint velocity",
        generator: MoveGeneratorMode::JointVelocity,
        command: |_, rate| {
            let mut command = RobotCommand::default();
            command.dq_c[3] = rate;
            command
        },
        told: |state| [state.q_d[3], state.dq_d[3], state.ddq_d[3]],
        way: 1.0,
        is_rate: true,
    },
    Channel {
        name: "pose",
        generator: MoveGeneratorMode::CartesianPosition,
        command: |start, shift| {
            let mut command = RobotCommand {
                O_T_EE_c: start.O_T_EE_c,
                ..RobotCommand::default()
            };
            command.O_T_EE_c[14] += shift;
            command
        },
        told: |state| [state.O_T_EE_c[14], state.O_dP_EE_c[2], state.O_ddP_EE_c[2]],
        way: 0.03,
        is_rate: false,
    },
    Channel {
        name: "elbow",
        generator: MoveGeneratorMode::CartesianPosition,
        command: |start, shift| RobotCommand {
            O_T_EE_c: start.O_T_EE_c,
            elbow_c: Some([start.elbow_c[0] + shift, start.elbow_c[1]]),
            ..RobotCommand::default()
        },
        told: |state| [state.elbow_c[0], state.delbow_c[0], state.ddelbow_c[0]],
        way: 0.05,
        is_rate: false,
    },
    Channel {
        name: "twist",
        generator: MoveGeneratorMode::CartesianVelocity,
        command: |_, rate| {
            let mut command = RobotCommand::default();
            command.O_dP_EE_c[2] = rate;
            command
        },
        told: |state| [state.O_T_EE_c[14], state.O_dP_EE_c[2], state.O_ddP_EE_c[2]],
        way: 0.7,
        is_rate: true,
    },
];

/// Moves with this kind of command until the middle of the acceleration.
fn underway(channel: &Channel, kind: RobotKind) -> (Pair, RobotState) {
    let mut pair = Pair::of(kind);
    pair.start(MoveControllerMode::JointImpedance, channel.generator);
    let start = pair.state;
    for cycle in 0..100 {
        pair.tick(Some(nominal(channel, &start, cycle)));
    }
    (pair, start)
}

/// Returns the command of a cycle, which may then be lost.
fn nominal(channel: &Channel, start: &RobotState, cycle: u32) -> RobotCommand {
    let shift = channel.way * ramp(f64::from(cycle) * CYCLE, 0.6);
    (channel.command)(start, shift)
}

#[test]
fn lost_command_is_bridged_with_the_last_acceleration() {
    for kind in RobotKind::ALL {
        for channel in &CHANNELS {
            let (mut pair, _) = underway(channel, kind);
            let [mut value, mut rate, acceleration] = (channel.told)(&pair.state);
            assert!(acceleration > 0.01, "{kind:?} {}", channel.name);
            for lost in 1..=5 {
                pair.tick(None);
                rate += acceleration * CYCLE;
                value += rate * CYCLE;
                let [told, told_rate, told_acceleration] = (channel.told)(&pair.state);
                let off = [
                    // A velocity channel publishes the pose that it has reached.
                    if channel.is_rate { 0.0 } else { told - value },
                    told_rate - rate,
                    (told_acceleration - acceleration) * CYCLE,
                ];
                for (n, off) in off.into_iter().enumerate() {
                    // States of protocol 10 have single precision.
                    assert!(
                        off.abs() < 1e-6,
                        "{kind:?} {}, {lost} lost, derivative {n}: {off} off",
                        channel.name
                    );
                }
            }
            assert_eq!(pair.state.robot_mode, RobotMode::Move);
        }
    }
}

#[test]
fn resuming_client_is_bridged_but_an_unaware_one_jumps() {
    const LOST: u32 = 10;
    for kind in RobotKind::ALL {
        for channel in &CHANNELS {
            let goes_on_with = |lost: u32, skipped: u32| {
                let (mut pair, start) = underway(channel, kind);
                pair.idle(lost as usize);
                for cycle in 0..3 {
                    pair.tick(Some(nominal(channel, &start, 100 + skipped + cycle)));
                }
                pair.state.errors
            };
            let name = format!("{kind:?} {}", channel.name);
            for lost in [1, 2] {
                let errors = goes_on_with(lost, lost);
                assert!(errors.is_empty(), "{name}: {errors}");
            }
            let errors = goes_on_with(LOST, 0);
            let jumps = |error: RobotError| {
                let name = error.name();
                name.ends_with("discontinuity") || name.ends_with("elbow_limit_violation")
            };
            assert!(errors.iter().any(jumps), "{name}: {errors}");
        }
    }
}

#[test]
fn bridged_commands_must_keep_the_limits() {
    for kind in RobotKind::ALL {
        let mut pair = Pair::of(kind);
        let limits = franka_model::limits::JointLimits::of(kind);
        let id = pair.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointVelocity,
        );
        let mut command = RobotCommand::default();
        // The acceleration rises to 9 rad/s² within the jerk limit, until the velocity is just
        // below its limit.
        let mut acceleration = 0.0_f64;
        while command.dq_c[0] < limits.velocity[0] - 0.04 {
            acceleration = (acceleration + 1.0).min(9.0);
            command.dq_c[0] += acceleration * CYCLE;
            pair.tick(Some(command));
            let errors = pair.state.errors;
            assert!(errors.is_empty(), "{kind:?}: {errors}");
        }
        pair.idle(18);
        let violation = RobotError::JointMotionGeneratorVelocityLimitsViolation;
        let errors = pair.state.errors;
        assert!(errors.contains(violation), "{kind:?}: {errors}");
        assert_eq!(pair.outcome(id), MoveStatus::ReflexAborted);
    }
}
