//! Keeps the messages of the last seconds in memory, and writes them to a file after an incident.

use std::collections::VecDeque;

use super::encoder::Message;
use super::error::RecordError;
use super::mcap_file::McapFile;
use super::options::BlackBox;
use super::session::Session;
use crate::HostTime;

#[derive(Debug)]
pub(super) struct LastSeconds {
    options: BlackBox,
    messages: VecDeque<Message>,
    /// Incident for which a file must be written; `None` if no file is due.
    incident: Option<Incident>,
}

/// Parts of the file name of an incident.
#[derive(Debug)]
struct Incident {
    time: HostTime,
    robot: String,
    why: String,
}

/// A file to be written.
#[derive(Debug)]
pub(super) struct Dump {
    pub(super) name: String,
    pub(super) bytes: Vec<u8>,
}

impl LastSeconds {
    pub(super) fn new(options: BlackBox) -> Self {
        Self {
            options,
            messages: VecDeque::new(),
            incident: None,
        }
    }

    pub(super) fn push(&mut self, message: Message) {
        let now = message.time;
        self.messages.push_back(message);
        let past = now - self.options.before - self.options.after;
        // One robot's clock may be behind the clocks of the others. The old data of this robot is
        // removed in any case.
        while self
            .messages
            .front()
            .is_some_and(|oldest| oldest.time < past)
        {
            self.messages.pop_front();
        }
    }

    /// Records an incident. If a file is already due, this file also covers the new incident.
    pub(super) fn note(&mut self, time: HostTime, robot: &str, why: &str) {
        self.incident.get_or_insert_with(|| Incident {
            time,
            robot: robot.to_owned(),
            why: why.to_owned(),
        });
    }

    /// Returns the file that is due at `now`, if any.
    pub(super) fn dump(
        &mut self,
        now: HostTime,
        session: &Session,
    ) -> Option<Result<Dump, RecordError>> {
        let after = self.options.after;
        let incident = self
            .incident
            .take_if(|incident| incident.time + after <= now)?;
        let written = write(session, &self.messages);
        Some(written.map(|bytes| Dump {
            name: incident.file_name(),
            bytes,
        }))
    }
}

fn write(session: &Session, messages: &VecDeque<Message>) -> Result<Vec<u8>, RecordError> {
    let mut file = McapFile::begin(session)?;
    let mut bytes = Vec::new();
    let mut flushed = HostTime::default();
    for message in messages {
        // Chunks are short, as in any recording, so that a reader can read a part of the file.
        if message.time.since(flushed) >= super::options::FLUSH_MAX {
            flushed = message.time;
            bytes.append(&mut file.flush()?);
        }
        file.write(message)?;
    }
    bytes.append(&mut file.finish()?);
    Ok(bytes)
}

impl Incident {
    fn file_name(&self) -> String {
        let time = self.time.to_string().replace(['-', ':'], "");
        format!("{time}-{}-{}.mcap", self.robot, self.why)
    }
}

/// A file of a black box, identified by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NamedFile {
    Whole,
    /// A file that is not complete.
    Part,
}

/// Returns the kind of black box file with this name; `None` for other files. The name of a black
/// box file begins with a time.
pub(super) fn file_of_name(name: &str) -> Option<NamedFile> {
    let (time, rest) = name.split_once('-')?;
    let shape: String = time
        .chars()
        .map(|c| if c.is_ascii_digit() { '0' } else { c })
        .collect();
    if shape != "00000000T000000.000Z" {
        return None;
    }
    match rest.strip_suffix(".part") {
        Some(rest) if rest.ends_with(".mcap") => Some(NamedFile::Part),
        None if rest.ends_with(".mcap") => Some(NamedFile::Whole),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_by_time_robot_and_cause() {
        let incident = Incident {
            time: HostTime::from_nanos(1_709_210_096_123_000_000),
            robot: "left".to_owned(),
            why: "guard-deviation".to_owned(),
        };
        let name = incident.file_name();
        assert_eq!(name, "20240229T123456.123Z-left-guard-deviation.mcap");
        assert_eq!(file_of_name(&name), Some(NamedFile::Whole));
        let part = format!("{name}.part");
        assert_eq!(file_of_name(&part), Some(NamedFile::Part));
        for other in ["run.mcap", "20240229-left-reflex.mcap", "notes-1.mcap", ""] {
            assert_eq!(file_of_name(other), None, "{other}");
        }
    }
}
