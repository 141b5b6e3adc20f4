//! Control functions against libfranka's control loops: `control_loop_vectors.json`.
//!
//! A trace is the record of a loop over four states. It has the function that the loop called with
//! each state and time step, and the sent command, after filter, limiter and checks. Here the
//! driver runs the same functions.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use anyhow::{Context as _, bail};
use franka_proto::{MoveControllerMode, RobotCommand, RobotMode, RobotState, Version};
use franka_rt::control::{
    Callback, CartesianPose, CartesianVelocities, GeneratorCommand, JointPositions,
    JointVelocities, Modes, Next, Shaper, Torques,
};
use franka_rt::driver::{ControlLog, Driver, MotionId, Order, Program};
use serde::Deserialize;

use super::{Case, Report, Versions};

/// Tolerance of every number of a command, in its SI unit. The vectors allow 1e-12, and 1e-11 for
/// poses, which go through quaternions.
const TOLERANCE: f64 = 5e-15;

/// The reference's run of a control loop.
#[derive(Deserialize)]
struct Trace {
    /// Kinds of the functions, for example `torque+joint_position`.
    variant: String,
    limit_rate: bool,
    cutoff_frequency: f64,
    states: Vec<State>,
    events: Vec<Event>,
}

/// A state with the fields that are given; the others are zero.
#[derive(Deserialize)]
#[serde(default)]
#[allow(non_snake_case)]
#[derive(Default)]
struct State {
    time_ms: u64,
    q_d: [f64; 7],
    dq_d: [f64; 7],
    ddq_d: [f64; 7],
    tau_J_d: [f64; 7],
    O_T_EE_c: [f64; 16],
    O_dP_EE_c: [f64; 6],
    O_ddP_EE_c: [f64; 6],
    elbow_c: [f64; 2],
    delbow_c: [f64; 2],
    ddelbow_c: [f64; 2],
}

#[derive(Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
enum Event {
    /// Modes of the `Move`, in the numbering of requests.
    Start {
        controller_mode: u64,
        motion_generator_mode: u64,
    },
    MotionCallback(Call),
    TorqueCallback(Call),
    Update(Sent),
    Finish(Sent),
}

/// A call of a function, and its result.
#[derive(Deserialize)]
struct Call {
    /// Index of the state.
    state: usize,
    time_step_ms: u64,
    returns: Vec<f64>,
    /// Two zeros stand for no elbow.
    elbow: Option<[f64; 2]>,
    finished: u8,
}

/// Data passed to the robot. The finishing flag is not set yet there.
#[derive(Deserialize)]
struct Sent {
    motion: Option<SentMotion>,
    control: Option<SentControl>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
#[allow(non_snake_case)]
struct SentMotion {
    q_c: Option<[f64; 7]>,
    dq_c: Option<[f64; 7]>,
    O_T_EE_c: Option<[f64; 16]>,
    O_dP_EE_c: Option<[f64; 6]>,
    elbow_c: [f64; 2],
    valid_elbow: u8,
}

#[derive(Deserialize)]
#[allow(non_snake_case)]
struct SentControl {
    tau_J_d: [f64; 7],
}

/// Checks `control_loop_vectors.json`.
pub(super) fn traces(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: Versions<Vec<Trace>> = serde_json::from_slice(text)?;
    for (version, traces) in file.each() {
        for (index, trace) in traces.iter().enumerate() {
            let (callback, calls) = trace.functions(version)?;
            let expected = trace.cycles()?;
            let name = format!("v{version}[{index}] ({})", trace.variant);
            report.case(name, |case| {
                trace.compare(case, version, callback, &calls, &expected);
            });
        }
    }
    Ok(report)
}

/// A call as a function notes it: which one, `message_id` of the state, and the time step.
type Noted = (Function, u64, Duration);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Function {
    Motion,
    Torque,
}

/// The reference's result for one state.
struct Cycle {
    calls: Vec<Noted>,
    /// The command sent then.
    command: RobotCommand,
    /// True if that was the last command.
    finished: bool,
}

impl Trace {
    /// The events by state. The first two are the start and an update without commands.
    fn cycles(&self) -> anyhow::Result<Vec<Cycle>> {
        let (mut cycles, mut calls) = (Vec::new(), Vec::new());
        for event in self.events.iter().skip(2) {
            match event {
                Event::Start { .. } => bail!("a second start"),
                Event::MotionCallback(call) => calls.push(self.noted(Function::Motion, call)?),
                Event::TorqueCallback(call) => calls.push(self.noted(Function::Torque, call)?),
                Event::Update(sent) | Event::Finish(sent) => cycles.push(Cycle {
                    calls: std::mem::take(&mut calls),
                    command: sent.command(),
                    finished: matches!(event, Event::Finish(_)),
                }),
            }
        }
        Ok(cycles)
    }

    fn noted(&self, function: Function, call: &Call) -> anyhow::Result<Noted> {
        let state = self
            .states
            .get(call.state)
            .context("a call with an unknown state")?;
        Ok((
            function,
            state.time_ms,
            Duration::from_millis(call.time_step_ms),
        ))
    }

    fn compare(
        &self,
        case: &mut Case<'_>,
        version: Version,
        callback: Callback,
        calls: &Receiver<Noted>,
        cycles: &[Cycle],
    ) {
        let Some(&Event::Start {
            controller_mode,
            motion_generator_mode,
        }) = self.events.first()
        else {
            return case.fail("the first event is not the start");
        };
        // An argument of the loop, where torques leave the choice.
        let controller = match controller_mode {
            1 => MoveControllerMode::CartesianImpedance,
            _ => MoveControllerMode::JointImpedance,
        };
        let request = callback.request(version, controller);
        let started = (request.controller as u64, request.generator as u64);
        let expected = (controller_mode, motion_generator_mode);
        case.equal("modes of the Move", started, expected);
        let modes = Modes::of(&request);
        let mut driver = Driver::new(version);
        driver.on_order(Order::Arm {
            motion: MotionId(1),
            modes,
            program: Program::Callback(Box::new(callback)),
            log: ControlLog::default(),
            ticket: None,
            times: Arc::default(),
            observer: None,
        });
        case.equal("cycles", self.states.len(), cycles.len());
        for (state, cycle) in self.states.iter().map(State::robot_state).zip(cycles) {
            let sent = driver.on_state(&RobotState {
                motion_generator_mode: modes.generator,
                controller_mode: modes.controller,
                robot_mode: RobotMode::Move,
                ..state
            });
            let called: Vec<_> = calls.try_iter().collect();
            case.equal("calls", &called, &cycle.calls);
            match sent {
                Some(sent) => cycle.compare_command(case, &sent, state.message_id),
                None => case.fail("no command"),
            }
        }
    }

    /// The functions, which return the values of the trace's callbacks, and the record of their
    /// calls.
    fn functions(&self, version: Version) -> anyhow::Result<(Callback, Receiver<Noted>)> {
        let (sender, calls) = channel();
        let torques = player(Function::Torque, &self.events, &sender, |call| {
            Ok(Torques(call.array()?))
        })?;
        let (with_torques, motion) = match self.variant.strip_prefix("torque") {
            Some("") => (true, None),
            Some(rest) => (true, rest.strip_prefix('+')),
            None => (false, Some(self.variant.as_str())),
        };
        let callback = match motion {
            None => Callback::torques(version, torques),
            Some(motion) => {
                let callback = match motion {
                    "joint_position" => {
                        self.motion(version, &sender, |call| Ok(JointPositions(call.array()?)))?
                    }
                    "joint_velocity" => {
                        self.motion(version, &sender, |call| Ok(JointVelocities(call.array()?)))?
                    }
                    "cartesian_pose" => self.motion(version, &sender, |call| {
                        Ok(CartesianPose {
                            O_T_EE: call.array()?,
                            elbow: call.elbow(),
                        })
                    })?,
                    "cartesian_velocity" => self.motion(version, &sender, |call| {
                        Ok(CartesianVelocities {
                            O_dP_EE: call.array()?,
                            elbow: call.elbow(),
                        })
                    })?,
                    _ => bail!("{motion}: expected a variant of the control loops"),
                };
                if with_torques {
                    callback.with_torques(torques)
                } else {
                    callback
                }
            }
        };
        let shaper = Shaper::new(version, self.limit_rate, self.cutoff_frequency);
        Ok((callback.with_shaper(shaper.trusting_the_echo()), calls))
    }

    fn motion<C: GeneratorCommand>(
        &self,
        version: Version,
        calls: &Sender<Noted>,
        read: impl Fn(&Call) -> anyhow::Result<C>,
    ) -> anyhow::Result<Callback> {
        let function = player(Function::Motion, &self.events, calls, read)?;
        Ok(Callback::motion::<C, _>(version, function))
    }
}

/// A control function.
type Player<T> = Box<dyn FnMut(&RobotState, Duration) -> Next<T> + Send>;

/// A function that returns, call by call, the values of the trace's callback, and panics beyond
/// them.
fn player<T: Send + 'static>(
    function: Function,
    events: &[Event],
    calls: &Sender<Noted>,
    read: impl Fn(&Call) -> anyhow::Result<T>,
) -> anyhow::Result<Player<T>> {
    let mut returns = VecDeque::new();
    for event in events {
        let call = match (event, function) {
            (Event::MotionCallback(call), Function::Motion) => call,
            (Event::TorqueCallback(call), Function::Torque) => call,
            _ => continue,
        };
        let returned = read(call)?;
        returns.push_back(match call.finished {
            0 => Next::Continue(returned),
            _ => Next::Finish(returned),
        });
    }
    let calls = calls.clone();
    Ok(Box::new(move |state: &RobotState, step: Duration| {
        let heard = calls.send((function, state.message_id, step));
        heard.expect("the calls are compared after the last one");
        returns.pop_front().expect("no more calls than there were")
    }))
}

impl Call {
    fn array<const N: usize>(&self) -> anyhow::Result<[f64; N]> {
        let array = self.returns.as_slice().try_into();
        array.with_context(|| format!("{} numbers, expected {N}", self.returns.len()))
    }

    fn elbow(&self) -> Option<[f64; 2]> {
        self.elbow.filter(|elbow| *elbow != [0.0, 0.0])
    }
}

impl State {
    fn robot_state(&self) -> RobotState {
        RobotState {
            message_id: self.time_ms,
            q_d: self.q_d,
            dq_d: self.dq_d,
            ddq_d: self.ddq_d,
            tau_J_d: self.tau_J_d,
            O_T_EE_c: self.O_T_EE_c,
            O_dP_EE_c: self.O_dP_EE_c,
            O_ddP_EE_c: self.O_ddP_EE_c,
            elbow_c: self.elbow_c,
            delbow_c: self.delbow_c,
            ddelbow_c: self.ddelbow_c,
            ..RobotState::default()
        }
    }
}

impl Sent {
    fn command(&self) -> RobotCommand {
        let mut command = RobotCommand::default();
        if let Some(motion) = &self.motion {
            command.q_c = motion.q_c.unwrap_or_default();
            command.dq_c = motion.dq_c.unwrap_or_default();
            command.O_T_EE_c = motion.O_T_EE_c.unwrap_or_default();
            command.O_dP_EE_c = motion.O_dP_EE_c.unwrap_or_default();
            command.elbow_c = (motion.valid_elbow != 0).then_some(motion.elbow_c);
        }
        if let Some(control) = &self.control {
            command.tau_J_d = control.tau_J_d;
        }
        command
    }
}

impl Cycle {
    fn compare_command(&self, case: &mut Case<'_>, sent: &RobotCommand, message_id: u64) {
        let expected = &self.command;
        case.equal("message_id", sent.message_id, message_id);
        let finished = sent.motion_generation_finished || sent.torque_command_finished;
        case.equal("finished", finished, self.finished);
        case.near("q_c", &sent.q_c, &expected.q_c, TOLERANCE);
        case.near("dq_c", &sent.dq_c, &expected.dq_c, TOLERANCE);
        case.near("O_T_EE_c", &sent.O_T_EE_c, &expected.O_T_EE_c, TOLERANCE);
        case.near("O_dP_EE_c", &sent.O_dP_EE_c, &expected.O_dP_EE_c, TOLERANCE);
        case.near("tau_J_d", &sent.tau_J_d, &expected.tau_J_d, TOLERANCE);
        let (elbow, expected) = (sent.elbow_c, expected.elbow_c);
        case.equal("valid_elbow", elbow.is_some(), expected.is_some());
        let (elbow, expected) = (elbow.unwrap_or_default(), expected.unwrap_or_default());
        case.near("elbow_c", &elbow, &expected, TOLERANCE);
    }
}
