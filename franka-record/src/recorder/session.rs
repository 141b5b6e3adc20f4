//! Data at the beginning of every file of a recording.

use std::collections::BTreeMap;
use std::time::Instant;

use super::error::RecordError;
use super::options::{Attachment, RecordOptions, Robot};
use crate::HostTime;

/// Clock that dates recorded data. It starts at the wall clock's time when the recorder is created,
/// and then advances with the monotonic clock.
#[derive(Clone, Copy, Debug)]
pub struct RecordClock {
    wall: HostTime,
    monotonic: Instant,
}

impl RecordClock {
    /// Creates a clock that starts at the current time of the wall clock.
    pub(super) fn start() -> Self {
        Self {
            wall: HostTime::now(),
            monotonic: Instant::now(),
        }
    }

    /// Returns the recorded time at `instant`.
    pub fn at(&self, instant: Instant) -> HostTime {
        match instant.checked_duration_since(self.monotonic) {
            Some(since) => self.wall + since,
            None => self.wall - self.monotonic.duration_since(instant),
        }
    }

    /// Returns the current recorded time.
    pub fn now(&self) -> HostTime {
        self.at(Instant::now())
    }
}

/// Data at the beginning of every file of a recording.
#[derive(Debug)]
pub(super) struct Session {
    began: HostTime,
    metadata: BTreeMap<String, String>,
    attachments: Vec<Attachment>,
    robots: Vec<Robot>,
}

impl Session {
    pub(super) fn new(began: HostTime, options: &RecordOptions) -> Self {
        let mut metadata = BTreeMap::from([
            ("began".to_owned(), began.to_string()),
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("system".to_owned(), std::env::consts::OS.to_owned()),
            ("machine".to_owned(), std::env::consts::ARCH.to_owned()),
        ]);
        metadata.extend(options.described());
        for (name, path) in [
            ("host", "/proc/sys/kernel/hostname"),
            ("kernel", "/proc/sys/kernel/osrelease"),
            ("kernel_build", "/proc/sys/kernel/version"),
        ] {
            // This file exists only on Linux.
            if let Ok(text) = std::fs::read_to_string(path) {
                metadata.insert(name.to_owned(), text.trim().to_owned());
            }
        }
        metadata.extend(options.metadata.clone());
        Self {
            began,
            metadata,
            attachments: options.attachments.clone(),
            robots: Vec::new(),
        }
    }

    pub(super) fn began(&self) -> HostTime {
        self.began
    }

    pub(super) fn metadata(&self) -> BTreeMap<String, String> {
        self.metadata.clone()
    }

    pub(super) fn attachments(&self) -> &[Attachment] {
        &self.attachments
    }

    pub(super) fn robots(&self) -> &[Robot] {
        &self.robots
    }

    pub(super) fn add_robot(&mut self, robot: Robot) -> Result<(), RecordError> {
        robot.check()?;
        if self.robots.iter().any(|other| other.name == robot.name) {
            return Err(RecordError::SameName { name: robot.name });
        }
        self.robots.push(robot);
        Ok(())
    }
}
