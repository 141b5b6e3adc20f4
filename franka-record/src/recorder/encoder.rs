//! Converts the data of one robot to messages.

use core::mem;
use core::time::Duration;

use super::frames::{Frames, timestamp};
use super::options::Robot;
use crate::schema::{Topic, foxglove, franka};
use crate::{Cycle, Event, EventKind, GripperState, HostTime, RecordedModel};
use franka_model::{EndEffector, Frame, Model, transform};
use franka_proto::{Errors, RobotMode};

#[derive(Clone, Debug)]
pub(super) struct Message {
    pub(super) robot: usize,
    pub(super) topic: Topic,
    pub(super) time: HostTime,
    pub(super) data: Box<[u8]>,
    /// True if the recorder must keep the full rate near this message.
    pub(super) notable: bool,
}

/// Encoder for one robot. It detects changes of the mode, the errors, the contacts and the tool.
#[derive(Debug)]
pub(super) struct Encoder {
    robot: usize,
    frames: Frames,
    model: Model,
    /// Message of a cycle. The encoder reuses the message and the memory of its fields.
    cycle: franka::Cycle,
    /// Compared values of the newest cycle; `None` before the first cycle.
    seen: Option<Seen>,
    /// The robot's clock before the first cycle, `[ms]`; 0 if unknown.
    attached: u64,
    tool: Option<franka::Tool>,
    /// Time at which the next messages on the slower channels are due.
    slow_due: HostTime,
}

/// Values that the encoder compares between consecutive cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    robot_time: u64,
    mode: RobotMode,
    errors: Errors,
    reflex_reason: Errors,
    touched: [[f64; 7]; 2],
    pressed: [[f64; 6]; 2],
}

impl Encoder {
    pub(super) fn new(index: usize, robot: &Robot) -> Self {
        Self {
            robot: index,
            frames: Frames::of(robot),
            model: RecordedModel::of(robot.kind, robot.urdf.as_deref(), Some(robot.lengths)).model,
            cycle: franka::Cycle::default(),
            seen: None,
            attached: robot.robot_time,
            tool: None,
            slow_due: HostTime::default(),
        }
    }

    pub(super) fn cycle(&mut self, mut cycle: Cycle, out: &mut Vec<Message>) {
        let state = &cycle.state;
        if cycle.reference.is_none() && cycle.record.q_ref != [0.0; 7] {
            let ee = EndEffector::from_arrays(&state.F_T_EE, &state.EE_T_K);
            let q_ref = cycle.record.q_ref.into();
            let pose = self.model.pose(Frame::EndEffector, &q_ref, &ee);
            cycle.reference = transform::isometry(&pose);
        }
        let notable = self.compare(&cycle, out);
        if !self.tool.as_ref().is_some_and(|tool| tool.is_of(state)) {
            self.tool = Some(franka::Tool::of(state));
            self.repeat_tool(cycle.time, out);
        }
        let mut message = mem::take(&mut self.cycle);
        message.set(&cycle);
        self.put(Topic::Cycle, cycle.time, &message, out);
        self.cycle = message;
        if let Some(last) = out.last_mut() {
            last.notable = notable;
        }
        if cycle.time >= self.slow_due {
            self.slow_due = cycle.time + SLOW_PERIOD;
            self.viewed(&cycle, out);
        }
    }

    /// Appends an event for each change since the previous cycle. Returns true if the recorder must
    /// keep the full rate near this cycle.
    fn compare(&mut self, cycle: &Cycle, out: &mut Vec<Message>) -> bool {
        let state = &cycle.state;
        let now = Seen {
            robot_time: cycle.record.time,
            mode: state.robot_mode,
            errors: state.errors,
            reflex_reason: state.reflex_reason,
            touched: [state.joint_contact, state.joint_collision],
            pressed: [state.cartesian_contact, state.cartesian_collision],
        };
        let before = self.seen.replace(now);
        let mut put = |kind| {
            let event = Event {
                time: cycle.time,
                robot_time: cycle.record.time,
                kind,
            };
            self.event(&event, out);
        };
        if let Some(before) = before
            && before.mode != now.mode
        {
            put(EventKind::Mode {
                from: before.mode,
                to: now.mode,
            });
        }
        let errors = (now.errors, now.reflex_reason);
        let none = (Errors::NONE, Errors::NONE);
        if before.map_or(none, |before| (before.errors, before.reflex_reason)) != errors {
            put(EventKind::Errors {
                errors: now.errors,
                reflex_reason: now.reflex_reason,
            });
        }
        before.is_some_and(|before| (before.touched, before.pressed) != (now.touched, now.pressed))
    }

    /// Appends the messages for viewers.
    fn viewed(&self, cycle: &Cycle, out: &mut Vec<Message>) {
        let time = cycle.time;
        self.put(Topic::Tf, time, &self.frames.transforms(cycle), out);
        self.put(Topic::Joints, time, &self.frames.joints(cycle), out);
        if let Some(target) = self.frames.target(cycle) {
            self.put(Topic::Target, time, &target, out);
        }
        if let Some(scene) = self.frames.scene(cycle) {
            self.put(Topic::Scene, time, &scene, out);
        }
    }

    /// Appends two messages for an event: the event itself, and its text.
    pub(super) fn event(&self, event: &Event, out: &mut Vec<Message>) {
        let mut message = franka::Event::from(event);
        if message.robot_time == 0 {
            message.robot_time = self.seen.map_or(self.attached, |seen| seen.robot_time);
        }
        self.put(Topic::Event, event.time, &message, out);
        if let Some(last) = out.last_mut() {
            last.notable = event.kind.is_notable();
        }
        let log = foxglove::Log {
            timestamp: Some(timestamp(event.time)),
            level: foxglove::log::Level::from(event.kind.level()).into(),
            message: event.kind.to_string(),
            name: event.kind.source().to_owned(),
            file: String::new(),
            line: 0,
        };
        self.put(Topic::Log, event.time, &log, out);
    }

    pub(super) fn gripper(&self, time: HostTime, state: &GripperState, out: &mut Vec<Message>) {
        self.put(Topic::Gripper, time, &franka::Gripper::from(state), out);
    }

    pub(super) fn repeat_tool(&self, time: HostTime, out: &mut Vec<Message>) {
        if let Some(tool) = &self.tool {
            self.put(Topic::Tool, time, tool, out);
        }
    }

    fn put(
        &self,
        topic: Topic,
        time: HostTime,
        message: &impl prost::Message,
        out: &mut Vec<Message>,
    ) {
        out.push(Message {
            robot: self.robot,
            topic,
            time,
            data: message.encode_to_vec().into(),
            notable: false,
        });
    }
}

/// Period of the messages for viewers. Its rate of 50 Hz is enough for a screen.
const SLOW_PERIOD: Duration = Duration::from_millis(20);
