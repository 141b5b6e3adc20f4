//! The destinations of messages: the files of the recording, and the last seconds.

use core::mem;
use std::path::PathBuf;
use std::time::Instant;

use super::black_box::LastSeconds;
use super::disk::Disk;
use super::encoder::Message;
use super::error::RecordError;
use super::mcap_file::McapFile;
use super::options::{RecordOptions, Robot};
use super::session::Session;
use super::thinning::Thinning;
use crate::HostTime;
use crate::schema::Topic;

pub(super) struct Files {
    options: RecordOptions,
    session: Session,
    disk: Disk,
    /// The current file; `None` without a file, and after a failure.
    open: Option<Open>,
    /// True if the recording is written to files.
    wanted: bool,
    last_seconds: Option<LastSeconds>,
    thinning: Option<Thinning>,
    /// The server that shows the messages as they arrive.
    #[cfg(feature = "foxglove")]
    server: Option<super::live::Server>,
    newest: HostTime,
    robots: Vec<RobotFiles>,
    /// Number of chunks of the recording so far.
    chunk: u64,
    missing_events: u64,
}

#[derive(Default)]
struct RobotFiles {
    /// Number of this robot's cycles that were lost since the last call of [`Files::take_missing`].
    missing: u64,
    /// Number of the newest chunk that contains the robot's tool.
    chunk: Option<u64>,
}

/// The current file.
struct Open {
    file: McapFile,
    first: PathBuf,
    bytes: u64,
    /// Number of cycles since the last flush.
    cycles: u64,
    /// Time of the file's first message.
    began: Option<HostTime>,
    /// Time of the newest message at the last flush, and the time of that flush.
    flushed: HostTime,
    flushed_at: Instant,
    room: Room,
}

/// Kinds of messages that are accepted while the disk is behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Room {
    All,
    /// Only events, because they are few and explain the recording.
    Events,
    Nothing,
}

impl Room {
    fn beside(backlog: u64) -> Self {
        if backlog < BACKLOG_MAX {
            Self::All
        } else if backlog < EVENT_BACKLOG_MAX {
            Self::Events
        } else {
            Self::Nothing
        }
    }

    fn takes(self, topic: Topic) -> bool {
        match self {
            Self::All => true,
            Self::Events => matches!(topic, Topic::Event | Topic::Log),
            Self::Nothing => false,
        }
    }
}

impl Files {
    pub(super) fn begin(
        now: HostTime,
        options: RecordOptions,
        path: Option<PathBuf>,
        disk: Disk,
    ) -> Result<Self, RecordError> {
        let session = Session::new(now, &options);
        let open = match path {
            Some(path) => Some(Open::begin(path, &session)?),
            None => None,
        };
        Ok(Self {
            session,
            disk,
            wanted: open.is_some(),
            open,
            last_seconds: options.black_box.clone().map(LastSeconds::new),
            thinning: options.thinned.then(Thinning::default),
            #[cfg(feature = "foxglove")]
            server: None,
            newest: HostTime::default(),
            robots: Vec::new(),
            chunk: 0,
            missing_events: 0,
            options,
        })
    }

    pub(super) fn add_robot(&mut self, robot: Robot) {
        self.robots.push(RobotFiles::default());
        let added = match &mut self.open {
            Some(open) => open.file.add_robot(&robot),
            None => Ok(()),
        };
        #[cfg(feature = "foxglove")]
        let added = match &mut self.server {
            Some(server) => added.and(server.add_robot(&robot)),
            None => added,
        };
        let added = added.and(self.session.add_robot(robot));
        self.check(added);
    }

    /// Sends all further messages to viewers through `server`.
    #[cfg(feature = "foxglove")]
    pub(super) fn serve(&mut self, mut server: super::live::Server) {
        let mut robots = self.session.robots().iter();
        let added = robots.try_for_each(|robot| server.add_robot(robot));
        self.server = Some(server);
        self.check(added);
    }

    /// Processes messages and empties the list.
    pub(super) fn pass(&mut self, messages: &mut Vec<Message>) {
        for message in messages.drain(..) {
            self.newest = self.newest.max(message.time);
            #[cfg(feature = "foxglove")]
            if let Some(server) = &mut self.server {
                server.send(&message);
            }
            if let Some(last_seconds) = &mut self.last_seconds {
                last_seconds.push(message.clone());
            }
            match self.thinning.take() {
                Some(mut thinning) => {
                    thinning.push(message, |message| self.write(&message));
                    self.thinning = Some(thinning);
                }
                None => self.write(&message),
            }
        }
    }

    fn write(&mut self, message: &Message) {
        let topic = message.topic;
        let written = match &mut self.open {
            Some(open) if open.room.takes(topic) => {
                open.began.get_or_insert(message.time);
                open.cycles += u64::from(topic == Topic::Cycle);
                open.file.write(message)
            }
            _ => {
                if self.wanted {
                    self.count_missing(message);
                }
                Ok(())
            }
        };
        self.check(written);
    }

    fn count_missing(&mut self, message: &Message) {
        match message.topic {
            Topic::Cycle => {
                if let Some(robot) = self.robots.get_mut(message.robot) {
                    robot.missing += 1;
                }
            }
            Topic::Event => self.missing_events += 1,
            // This data is derived from cycles and events, which are counted.
            _ => {}
        }
    }

    /// Returns the number of this robot's cycles that were lost since the last call.
    pub(super) fn take_missing(&mut self, robot: usize) -> u64 {
        let open = self.open.as_ref();
        // The number is recorded in the file once there is more space.
        if open.is_some_and(|open| open.room != Room::All) {
            return 0;
        }
        self.take_missing_at_end(robot)
    }

    /// Does the same as [`Self::take_missing`] at the end of a robot's cycles.
    pub(super) fn take_missing_at_end(&mut self, robot: usize) -> u64 {
        let robot = self.robots.get_mut(robot);
        robot.map_or(0, |robot| mem::take(&mut robot.missing))
    }

    /// Returns the number of events that were lost since the last call.
    pub(super) fn take_missing_events(&mut self) -> u64 {
        mem::take(&mut self.missing_events)
    }

    /// Makes space in the queue for the last events of the recording.
    pub(super) fn begin_end(&mut self) {
        if let Some(open) = &mut self.open
            && open.room == Room::Nothing
        {
            open.room = Room::Events;
        }
    }

    /// Ends the chunk if it is too old for messages at `now`.
    pub(super) fn flush_if_due(&mut self, now: HostTime) {
        if let Some(open) = &self.open
            && now.since(open.flushed) >= self.options.flush
        {
            self.newest = self.newest.max(now);
            self.flush();
        }
    }

    /// Returns true if the robot's next messages are its first messages in the current chunk. Later
    /// calls for the same chunk return false.
    pub(super) fn begins_chunk(&mut self, robot: usize) -> bool {
        let chunk = Some(self.chunk);
        let robot = self.robots.get_mut(robot);
        robot.is_some_and(|robot| mem::replace(&mut robot.chunk, chunk) != chunk)
    }

    pub(super) fn note_incident(&mut self, time: HostTime, robot: &str, why: &str) {
        if let Some(last_seconds) = &mut self.last_seconds {
            last_seconds.note(time, robot, why);
        }
    }

    /// Writes the data that is due at `now`. The thread calls this about 50 times a second.
    pub(super) fn tick(&mut self, now: HostTime) {
        if !self.disk.is_well() {
            self.give_up();
        }
        if let Some(open) = &self.open
            && open.flushed_at.elapsed() >= self.options.flush
        {
            self.flush();
        }
        self.dump(now.max(self.newest));
    }

    fn dump(&mut self, now: HostTime) {
        if let Some(last_seconds) = &mut self.last_seconds
            && let Some(dump) = last_seconds.dump(now, &self.session)
            && let Some(options) = &self.options.black_box
        {
            match dump {
                Ok(dump) => {
                    let directory = options.directory.clone();
                    self.disk.black_box(directory, dump, options.keep);
                }
                Err(error) => self.disk.fail_black_box(error),
            }
        }
    }

    /// Ends the chunk. Also ends the file if a new file is due.
    fn flush(&mut self) {
        let newest = self.newest;
        let flushed = match &mut self.open {
            Some(open) => open.flush(newest, &self.disk),
            None => Ok(()),
        };
        self.chunk += 1;
        self.check(flushed);
        let rotation = self.options.rotation;
        // A new file follows only if the current file is not empty.
        if let Some(open) = self.open.take_if(|open| {
            let span = open.began.map(|began| newest.since(began));
            let is_due = rotation.bytes.is_some_and(|bytes| open.bytes >= bytes)
                || rotation.time.is_some_and(|time| span >= Some(time));
            is_due && open.room == Room::All
        }) {
            let next = open.follow(&self.session, &self.disk);
            match next {
                Ok(next) => self.open = Some(next),
                Err(error) => self.disk.fail(error),
            }
        }
    }

    pub(super) fn finish(&mut self) {
        if let Some(mut thinning) = self.thinning.take() {
            thinning.finish(|message| self.write(&message));
        }
        self.dump(HostTime::from_nanos(u64::MAX));
        if let Some(open) = self.open.take() {
            match open.file.finish() {
                Ok(bytes) => self.disk.append(bytes, open.cycles),
                Err(error) => {
                    self.disk.lose(open.cycles);
                    self.disk.fail(error);
                }
            }
        }
    }

    fn check(&mut self, result: Result<(), RecordError>) {
        if let Err(error) = result {
            self.disk.fail(error);
            self.give_up();
        }
    }

    /// Closes the file without further writes.
    fn give_up(&mut self) {
        if let Some(open) = self.open.take() {
            self.disk.lose(open.cycles);
        }
    }
}

impl Open {
    fn begin(first: PathBuf, session: &Session) -> Result<Self, RecordError> {
        Ok(Self {
            file: McapFile::begin(session)?,
            first,
            bytes: 0,
            cycles: 0,
            began: None,
            flushed: HostTime::default(),
            flushed_at: Instant::now(),
            room: Room::All,
        })
    }

    fn flush(&mut self, newest: HostTime, disk: &Disk) -> Result<(), RecordError> {
        let bytes = self.file.flush()?;
        self.flushed = newest;
        self.flushed_at = Instant::now();
        self.bytes += bytes.len() as u64;
        let cycles = mem::take(&mut self.cycles);
        if !bytes.is_empty() {
            disk.append(bytes, cycles);
        }
        self.room = Room::beside(disk.backlog());
        Ok(())
    }

    /// Ends this file and begins the next.
    fn follow(self, session: &Session, disk: &Disk) -> Result<Self, RecordError> {
        disk.append(self.file.finish()?, self.cycles);
        disk.follow(self.first.clone());
        Self::begin(self.first, session)
    }
}

/// Largest number of bytes that may wait for the disk: more than a minute of one robot.
pub(super) const BACKLOG_MAX: u64 = 64 << 20;

/// Largest number of bytes that may wait for the disk, including events.
pub(super) const EVENT_BACKLOG_MAX: u64 = BACKLOG_MAX + (16 << 20);
