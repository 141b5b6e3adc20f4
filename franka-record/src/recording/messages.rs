//! The messages of one robot, read chunk by chunk.

use mcap::records::{MessageHeader, op};
use prost::Message as _;

use super::RobotRecording;
use super::bytes::Bytes;
use super::chunk::Chunk;
use super::error::RecordingError;
use super::index::ChunkEntry;
use super::wire;
use crate::schema::{Topic, franka};
use crate::{Cycle, Event, GripperState, HostTime};

/// Iterates over the chunks that can contain the requested messages.
#[derive(Debug)]
struct Walk {
    bytes: Bytes,
    /// The remaining chunks. The next chunk is the last element.
    chunks: Vec<ChunkEntry>,
    open: Option<Chunk>,
    from: HostTime,
    to: HostTime,
}

impl Walk {
    /// Starts `before` chunks before the first chunk that can contain requested messages.
    fn of(robot: &RobotRecording<'_>, before: usize) -> Self {
        let all = &robot.recording.index.chunks;
        let wanted = |chunk: &ChunkEntry| {
            chunk.end >= robot.from.as_nanos() && chunk.begin <= robot.to.as_nanos()
        };
        let first = all.iter().position(wanted).unwrap_or(all.len());
        let last = all.iter().rposition(wanted).map_or(first, |last| last + 1);
        let first = first.saturating_sub(before).min(last);
        Self {
            bytes: robot.recording.bytes.clone(),
            chunks: all[first..last].iter().rev().copied().collect(),
            open: None,
            from: robot.from,
            to: robot.to,
        }
    }

    /// Calls `take` with one message after the other until `take` returns a value, and returns this
    /// value. Returns `None` at the end.
    fn next<T>(
        &mut self,
        mut take: impl FnMut(MessageHeader, &[u8]) -> Option<Result<T, (&'static str, String)>>,
    ) -> Option<Result<T, RecordingError>> {
        loop {
            let chunk = match &mut self.open {
                Some(chunk) => chunk,
                None => {
                    let entry = self.chunks.pop()?;
                    match Chunk::read(&self.bytes, &entry) {
                        Ok(chunk) => self.open.insert(chunk),
                        Err(error) => return Some(Err(error)),
                    }
                }
            };
            let offset = chunk.offset;
            while let Some((kind, body)) = chunk.next() {
                if kind != op::MESSAGE {
                    continue;
                }
                let Some((header, data)) = wire::message(body) else {
                    continue;
                };
                match take(header, data) {
                    None => {}
                    Some(Ok(taken)) => return Some(Ok(taken)),
                    Some(Err((topic, reason))) => {
                        return Some(Err(RecordingError::Message {
                            topic: topic.to_owned(),
                            offset,
                            reason,
                        }));
                    }
                }
            }
            let cut = chunk.is_cut();
            self.open = None;
            if cut {
                return Some(Err(RecordingError::Chunk {
                    offset,
                    reason: "its last record is cut off".to_owned(),
                }));
            }
        }
    }
}

fn channel(robot: &RobotRecording<'_>, topic: Topic) -> Option<u16> {
    let channels = &robot.recording.channels;
    channels.find(&topic.channel(&robot.name), &topic.schema())
}

/// Iterator over the cycles of one robot (see [`RobotRecording::cycles`]).
#[derive(Debug)]
pub struct Cycles {
    walk: Walk,
    cycles: Option<u16>,
    tools: Option<u16>,
    tool: Option<franka::Tool>,
}

impl Cycles {
    pub(super) fn of(robot: &RobotRecording<'_>) -> Self {
        Self {
            // Each chunk contains the tool once. In a thinned recording, the tool may come up to
            // half a second later.
            walk: Walk::of(robot, 2),
            cycles: channel(robot, Topic::Cycle),
            tools: channel(robot, Topic::Tool),
            tool: None,
        }
    }
}

impl Iterator for Cycles {
    type Item = Result<Cycle, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        let Self {
            walk,
            cycles,
            tools,
            tool,
        } = self;
        let (from, to) = (walk.from, walk.to);
        let wanted = |time| from <= time && time <= to;
        walk.next(|message, data| {
            let channel = Some(message.channel_id);
            if channel == *tools {
                match franka::Tool::decode(data) {
                    Ok(read) => *tool = Some(read),
                    Err(error) => return Some(Err(("tool", error.to_string()))),
                }
            }
            if channel != *cycles || !wanted(HostTime::from_nanos(message.log_time)) {
                return None;
            }
            Some(match franka::Cycle::decode(data) {
                Ok(read) => Ok(read.to_cycle(tool.as_ref())),
                Err(error) => Err(("cycle", error.to_string())),
            })
        })
    }
}

/// Iterator over the events of one robot (see [`RobotRecording::events`]).
#[derive(Debug)]
pub struct Events {
    walk: Walk,
    channel: Option<u16>,
}

impl Events {
    pub(super) fn of(robot: &RobotRecording<'_>) -> Self {
        Self {
            walk: Walk::of(robot, 0),
            channel: channel(robot, Topic::Event),
        }
    }
}

impl Iterator for Events {
    type Item = Result<Event, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        let (from, to, channel) = (self.walk.from, self.walk.to, self.channel);
        self.walk.next(|message, data| {
            let time = HostTime::from_nanos(message.log_time);
            if Some(message.channel_id) != channel || time < from || time > to {
                return None;
            }
            match franka::Event::decode(data) {
                // Events of kinds that later versions added are ignored.
                Ok(read) => read.to_event(time).map(Ok),
                Err(error) => Some(Err(("event", error.to_string()))),
            }
        })
    }
}

/// Iterator over the gripper states of one robot, each with its time of arrival (see
/// [`RobotRecording::gripper_states`]).
#[derive(Debug)]
pub struct GripperStates {
    walk: Walk,
    channel: Option<u16>,
}

impl GripperStates {
    pub(super) fn of(robot: &RobotRecording<'_>) -> Self {
        Self {
            walk: Walk::of(robot, 0),
            channel: channel(robot, Topic::Gripper),
        }
    }
}

impl Iterator for GripperStates {
    type Item = Result<(HostTime, GripperState), RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        let (from, to, channel) = (self.walk.from, self.walk.to, self.channel);
        self.walk.next(|message, data| {
            let time = HostTime::from_nanos(message.log_time);
            if Some(message.channel_id) != channel || time < from || time > to {
                return None;
            }
            match franka::Gripper::decode(data) {
                Ok(read) => read.to_state().map(|state| Ok((time, state))),
                Err(error) => Some(Err(("gripper", error.to_string()))),
            }
        })
    }
}
