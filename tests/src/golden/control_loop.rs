//! Control functions against libfranka's control loops: `control_loop_vectors.json`.
//!
//! A trace is what a loop did with four states: which function it called with which state and time
//! step, and what it sent once the values that they returned had passed filter, limiter and checks.
//! Here the driver runs the same functions.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use franka_proto::{MoveControllerMode, RobotCommand, RobotMode, RobotState, Version};
use franka_rt::control::{
    Callback, CartesianPose, CartesianVelocities, GeneratorCommand, JointPositions,
    JointVelocities, Next, Torques,
};
use franka_rt::driver::{ControlLog, Driver, Modes, MotionId, Order, Program};
use franka_rt::shaping::Shaper;

use super::{Case, Malformed, Node, Report};

/// Of every number of a command, in its SI unit. The vectors allow 1e-12, and 1e-11 for poses,
/// which go through quaternions.
const TOLERANCE: f64 = 5e-15;

/// Checks `control_loop_vectors.json`.
pub(super) fn traces(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for version in Version::ALL {
        for node in root.get(&format!("v{version}"))?.list()? {
            let name = format!("{} ({})", node.path(), node.get("variant")?.text()?);
            let (callback, calls) = functions(version, &node)?;
            let states = node.get("states")?.list()?;
            let states: Vec<_> = states.iter().map(state).collect::<Result<_, _>>()?;
            let trace = Trace::read(&node)?;
            report.case(name, |case| {
                trace.compare(case, version, callback, &calls, &states);
            });
        }
    }
    Ok(report)
}

/// A call of a function: its event, `message_id` of the state, and the time step.
type Call = (&'static str, u64, Duration);

const MOTION: &str = "motion_callback";
const TORQUE: &str = "torque_callback";

/// What the reference did.
struct Trace {
    /// Controller and motion generator of the `Move`, in the numbering of requests.
    started: (u64, u64),
    cycles: Vec<Cycle>,
}

/// What it did with one state.
struct Cycle {
    /// Name, state and step `[ms]` of each call.
    calls: Vec<(String, u64, u64)>,
    /// What was sent then.
    command: RobotCommand,
    /// Whether that was the last command.
    finished: bool,
}

impl Trace {
    fn read(node: &Node<'_>) -> Result<Self, Malformed> {
        let events = node.get("events")?.list()?;
        let (start, events) = match &events[..] {
            [start, first, events @ ..] if name(start)? == "start" && name(first)? == "update" => {
                (start, events)
            }
            _ => return Err(node.malformed("a start and an update without commands first")),
        };
        let integer = |node: &Node<'_>, member| node.get(member)?.integer();
        let mut cycles = Vec::new();
        let mut calls = Vec::new();
        for event in events {
            let name = name(event)?;
            if name == "update" || name == "finish" {
                cycles.push(Cycle {
                    calls: std::mem::take(&mut calls),
                    command: command(event)?,
                    finished: name == "finish",
                });
            } else {
                let (state, step) = (integer(event, "state")?, integer(event, "time_step_ms")?);
                calls.push((name.to_owned(), state, step));
            }
        }
        Ok(Self {
            started: (
                integer(start, "controller_mode")?,
                integer(start, "motion_generator_mode")?,
            ),
            cycles,
        })
    }

    fn compare(
        &self,
        case: &mut Case<'_>,
        version: Version,
        callback: Callback,
        calls: &Receiver<Call>,
        states: &[RobotState],
    ) {
        // An argument of the loop, where torques leave the choice.
        let controller = match self.started.0 {
            1 => MoveControllerMode::CartesianImpedance,
            _ => MoveControllerMode::JointImpedance,
        };
        let request = callback.request(version, controller);
        let started = (request.controller as u64, request.generator as u64);
        case.equal("modes of the Move", started, self.started);
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
        case.equal("cycles", states.len(), self.cycles.len());
        for (state, cycle) in states.iter().zip(&self.cycles) {
            let sent = driver.on_state(&RobotState {
                motion_generator_mode: modes.generator,
                controller_mode: modes.controller,
                robot_mode: RobotMode::Move,
                ..*state
            });
            let called: Vec<_> = calls.try_iter().collect();
            let expected = cycle.calls.iter().map(|(name, state, step)| {
                let state = states.get(*state as usize).map(|state| state.message_id);
                (name.as_str(), state, Duration::from_millis(*step))
            });
            let called = called
                .iter()
                .map(|(name, state, step)| (*name, Some(*state), *step));
            case.equal(
                "calls",
                called.collect::<Vec<_>>(),
                expected.collect::<Vec<_>>(),
            );
            match sent {
                Some(sent) => cycle.compare_command(case, &sent, state.message_id),
                None => case.fail("no command"),
            }
        }
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

/// The functions of a trace, which return what its callbacks did, and where their calls are noted.
fn functions(version: Version, node: &Node<'_>) -> Result<(Callback, Receiver<Call>), Malformed> {
    let variant = node.get("variant")?.text()?;
    let events = node.get("events")?.list()?;
    let (sender, calls) = channel();
    let torques = player(TORQUE, &events, &sender, |node| {
        Ok(Torques(node.get("returns")?.numbers()?))
    })?;
    let (with_torques, motion) = match variant.strip_prefix("torque") {
        Some("") => (true, None),
        Some(rest) => (true, rest.strip_prefix('+')),
        None => (false, Some(variant)),
    };
    let callback = match motion {
        None => Callback::torques(version, torques),
        Some(motion) => {
            let callback = match motion {
                "joint_position" => motion_of(version, &events, &sender, |node| {
                    Ok(JointPositions(node.get("returns")?.numbers()?))
                })?,
                "joint_velocity" => motion_of(version, &events, &sender, |node| {
                    Ok(JointVelocities(node.get("returns")?.numbers()?))
                })?,
                "cartesian_pose" => motion_of(version, &events, &sender, |node| {
                    Ok(CartesianPose {
                        O_T_EE: node.get("returns")?.numbers()?,
                        elbow: elbow(node)?,
                    })
                })?,
                "cartesian_velocity" => motion_of(version, &events, &sender, |node| {
                    Ok(CartesianVelocities {
                        O_dP_EE: node.get("returns")?.numbers()?,
                        elbow: elbow(node)?,
                    })
                })?,
                _ => return Err(node.malformed("a variant of the control loops")),
            };
            if with_torques {
                callback.with_torques(torques)
            } else {
                callback
            }
        }
    };
    let limit_rate = node.get("limit_rate")?.boolean()?;
    let cutoff_frequency = node.get("cutoff_frequency")?.number()?;
    let shaper = Shaper::new(version, limit_rate, cutoff_frequency).trusting_the_echo();
    Ok((callback.with_shaper(shaper), calls))
}

fn motion_of<C: GeneratorCommand>(
    version: Version,
    events: &[Node<'_>],
    calls: &Sender<Call>,
    read: impl Fn(&Node<'_>) -> Result<C, Malformed>,
) -> Result<Callback, Malformed> {
    let function = player(MOTION, events, calls, read)?;
    Ok(Callback::motion::<C, _>(version, function))
}

/// A function that returns, call by call, what the events of this name did, and panics beyond.
fn player<T: Send + 'static>(
    event: &'static str,
    events: &[Node<'_>],
    calls: &Sender<Call>,
    read: impl Fn(&Node<'_>) -> Result<T, Malformed>,
) -> Result<impl FnMut(&RobotState, Duration) -> Next<T> + Send + 'static, Malformed> {
    let mut returns = VecDeque::new();
    for node in events {
        if name(node)? == event {
            let finished = node.get("finished")?.boolean()?;
            let returned = read(node)?;
            returns.push_back(if finished {
                Next::Finish(returned)
            } else {
                Next::Continue(returned)
            });
        }
    }
    let calls = calls.clone();
    Ok(move |state: &RobotState, step: Duration| {
        let heard = calls.send((event, state.message_id, step));
        heard.expect("the calls are compared after the last one");
        returns.pop_front().expect("no more calls than there were")
    })
}

fn name<'a>(event: &Node<'a>) -> Result<&'a str, Malformed> {
    event.get("event")?.text()
}

/// An elbow where there is one: two zeros are none.
fn elbow(node: &Node<'_>) -> Result<Option<[f64; 2]>, Malformed> {
    let elbow = node.get("elbow")?.numbers()?;
    Ok((elbow != [0.0, 0.0]).then_some(elbow))
}

/// A state with the fields that are given; the others are zero.
fn state(node: &Node<'_>) -> Result<RobotState, Malformed> {
    fn numbers<const N: usize>(node: &Node<'_>, name: &str) -> Result<[f64; N], Malformed> {
        node.find(name)
            .map_or(Ok([0.0; N]), |numbers| numbers.numbers())
    }
    Ok(RobotState {
        message_id: node.get("time_ms")?.integer()?,
        q_d: numbers(node, "q_d")?,
        dq_d: numbers(node, "dq_d")?,
        ddq_d: numbers(node, "ddq_d")?,
        tau_J_d: numbers(node, "tau_J_d")?,
        O_T_EE_c: numbers(node, "O_T_EE_c")?,
        O_dP_EE_c: numbers(node, "O_dP_EE_c")?,
        O_ddP_EE_c: numbers(node, "O_ddP_EE_c")?,
        elbow_c: numbers(node, "elbow_c")?,
        delbow_c: numbers(node, "delbow_c")?,
        ddelbow_c: numbers(node, "ddelbow_c")?,
        ..RobotState::default()
    })
}

/// What an event hands to the robot. The finishing flag is not set yet there.
fn command(event: &Node<'_>) -> Result<RobotCommand, Malformed> {
    let mut command = RobotCommand::default();
    let present = |name| {
        let node = event.get(name)?;
        Ok((!node.value().is_null()).then_some(node))
    };
    if let Some(motion) = present("motion")? {
        for (name, value) in motion.members()? {
            match name {
                "q_c" => command.q_c = value.numbers()?,
                "dq_c" => command.dq_c = value.numbers()?,
                "O_T_EE_c" => command.O_T_EE_c = value.numbers()?,
                "O_dP_EE_c" => command.O_dP_EE_c = value.numbers()?,
                "valid_elbow" if value.boolean()? => {
                    command.elbow_c = Some(motion.get("elbow_c")?.numbers()?);
                }
                "valid_elbow" | "elbow_c" | "motion_generation_finished" => {}
                _ => return Err(value.malformed("a field of a motion command")),
            }
        }
    }
    if let Some(control) = present("control")? {
        command.tau_J_d = control.get("tau_J_d")?.numbers()?;
    }
    Ok(command)
}
