//! The thread that reads cycles from the rings and builds the files.

use core::time::Duration;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use franka_rt::thread::CycleReader;

use super::disk::Disk;
use super::encoder::{Encoder, Message};
use super::error::RecordError;
use super::files::Files;
use super::lock;
use super::options::{RecordOptions, Robot};
use super::session::RecordClock;
use crate::{Cycle, Event, EventKind, GripperState, HostTime};

/// Request to the thread.
#[derive(Debug)]
pub(super) enum Order {
    Attach(Box<(Robot, CycleReader)>),
    Resume(usize, Box<CycleReader>),
    Event(usize, Box<Event>),
    Gripper(usize, HostTime, GripperState),
    #[cfg(feature = "foxglove")]
    Serve(Box<super::live::Server>),
    Finish,
}

/// Progress of the thread, and the flag with which other threads end it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DrainStatus {
    pub(super) cycles: u64,
    pub(super) dropped: u64,
    pub(super) events_dropped: u64,
    /// True if the thread must end.
    pub(super) finish: bool,
    /// True once the thread has ended.
    pub(super) ended: bool,
}

/// State of the thread.
pub(super) struct Drain {
    orders: Receiver<Order>,
    status: Arc<Mutex<DrainStatus>>,
    sources: Vec<Source>,
    files: Files,
    clock: RecordClock,
    wall: fn() -> HostTime,
    /// Time of the next comparison with the wall clock.
    compare_due: Instant,
    /// Difference of the wall clock from recorded time, `[ns]`.
    offset: i64,
}

/// A recorded robot.
struct Source {
    label: String,
    cycles: CycleReader,
    /// Readers for later control threads of the same robot.
    next: VecDeque<CycleReader>,
    /// Number of lost cycles that have been reported for `cycles`.
    lost: u64,
    encoder: Encoder,
    /// Data other than cycles, oldest first. Each item waits until all earlier cycles have been
    /// read.
    waiting: Vec<Waiting>,
    /// Message buffer, which is empty between calls.
    messages: Vec<Message>,
}

/// Data other than a cycle.
enum Waiting {
    Event(Event),
    Gripper(HostTime, GripperState),
}

impl Waiting {
    fn time(&self) -> HostTime {
        match self {
            Self::Event(event) => event.time,
            Self::Gripper(time, _) => *time,
        }
    }
}

impl Drain {
    pub(super) fn new(
        orders: Receiver<Order>,
        clock: RecordClock,
        options: RecordOptions,
        path: Option<PathBuf>,
        disk: Disk,
        status: Arc<Mutex<DrainStatus>>,
        wall: fn() -> HostTime,
    ) -> Result<Self, RecordError> {
        Ok(Self {
            orders,
            status,
            sources: Vec::new(),
            files: Files::begin(clock.now(), options, path, disk)?,
            clock,
            wall,
            compare_due: Instant::now(),
            offset: 0,
        })
    }

    /// Runs until the thread receives the order to end, or all senders are dropped.
    pub(super) fn run(mut self) {
        loop {
            let go_on = self.take_orders();
            self.take_cycles();
            self.compare_clocks();
            self.files.tick(self.clock.now());
            self.count_missing_events();
            if !go_on {
                break;
            }
        }
        self.finish();
    }

    /// Waits for the interval between two polls, and processes the pending orders. Returns false if
    /// the thread must end.
    fn take_orders(&mut self) -> bool {
        let mut next = match self.orders.recv_timeout(LOOK) {
            Ok(order) => Some(order),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return false,
        };
        while let Some(order) = next {
            match order {
                Order::Attach(attached) => self.attach(*attached),
                Order::Resume(robot, cycles) => {
                    if let Some(source) = self.sources.get_mut(robot) {
                        source.resume(*cycles);
                    }
                }
                Order::Event(robot, event) => self.wait(robot, Waiting::Event(*event)),
                Order::Gripper(robot, time, state) => {
                    self.wait(robot, Waiting::Gripper(time, state));
                }
                #[cfg(feature = "foxglove")]
                Order::Serve(server) => self.files.serve(*server),
                Order::Finish => return false,
            }
            next = match self.orders.try_recv() {
                Ok(order) => Some(order),
                Err(TryRecvError::Empty) => None,
                Err(TryRecvError::Disconnected) => return false,
            };
        }
        !lock(&self.status).finish
    }

    fn attach(&mut self, (robot, cycles): (Robot, CycleReader)) {
        self.sources.push(Source {
            label: robot.label().to_owned(),
            cycles,
            next: VecDeque::new(),
            lost: 0,
            encoder: Encoder::new(self.sources.len(), &robot),
            waiting: Vec::new(),
            messages: Vec::new(),
        });
        self.files.add_robot(robot);
    }

    fn wait(&mut self, robot: usize, waiting: Waiting) {
        if let Some(source) = self.sources.get_mut(robot) {
            source.waiting.push(waiting);
        }
    }

    fn take_cycles(&mut self) {
        for index in 0..self.sources.len() {
            self.sources[index].waiting.sort_by_key(Waiting::time);
            self.take_waiting_cycles(index);
            // After the last cycle of a control thread, continue with the next control thread.
            while self.sources[index].cycles.waiting() == 0
                && let Some(next) = self.sources[index].next.pop_front()
            {
                let source = &mut self.sources[index];
                let lost = source.note_end(self.clock.now(), &mut self.files);
                (source.cycles, source.lost) = (next, 0);
                lock(&self.status).dropped += lost;
                self.take_waiting_cycles(index);
            }
            // A cycle that is still in transit is only slightly older than this data.
            self.sources[index].pass(self.clock.now(), &mut self.files);
        }
    }

    /// Reads the cycles of a robot that are available now. Cycles that arrive meanwhile wait until
    /// the other robots have had their turn.
    fn take_waiting_cycles(&mut self, index: usize) {
        let (mut taken, mut dropped) = (0, 0);
        let source = &mut self.sources[index];
        for _ in 0..source.cycles.waiting() {
            let Some(captured) = source.cycles.pop() else {
                break;
            };
            let cycle = Cycle {
                time: self.clock.at(captured.received),
                record: captured.record,
                state: captured.state,
                reference: None,
            };
            source.pass(cycle.time, &mut self.files);
            taken += 1;
            source.lost += captured.lost;
            let cycles = self.files.take_missing(index) + captured.lost;
            if cycles > 0 {
                dropped += cycles;
                source.event(cycle.time, EventKind::Dropped { cycles }, &mut self.files);
            }
            self.files.flush_if_due(cycle.time);
            if self.files.begins_chunk(index) {
                source.encoder.repeat_tool(cycle.time, &mut source.messages);
            }
            source.encoder.cycle(cycle, &mut source.messages);
            self.files.pass(&mut source.messages);
        }
        let mut status = lock(&self.status);
        status.cycles += taken;
        status.dropped += dropped;
    }

    /// Detects a step of this host's wall clock, and records it.
    fn compare_clocks(&mut self) {
        let now = Instant::now();
        if now < self.compare_due {
            return;
        }
        self.compare_due = now + COMPARE_PERIOD;
        let time = self.clock.now();
        let offset = (self.wall)().as_nanos() as i64 - time.as_nanos() as i64;
        if (offset - self.offset).abs() >= STEP_MIN {
            self.offset = offset;
            for source in &mut self.sources {
                source.event(time, EventKind::ClockStep { by: offset }, &mut self.files);
            }
        }
    }

    fn count_missing_events(&mut self) {
        let count = self.files.take_missing_events();
        if count > 0 {
            lock(&self.status).events_dropped += count;
        }
    }

    fn finish(mut self) {
        self.files.begin_end();
        for (index, source) in self.sources.iter_mut().enumerate() {
            source.pass(HostTime::from_nanos(u64::MAX), &mut self.files);
            let now = self.clock.now();
            let missing = self.files.take_missing_at_end(index);
            if missing > 0 {
                let kind = EventKind::Dropped { cycles: missing };
                source.event(now, kind, &mut self.files);
            }
            let lost = source.note_end(now, &mut self.files);
            lock(&self.status).dropped += missing + lost;
        }
        self.files.finish();
        // Counts the cycles that thinning has held back so far.
        for index in 0..self.sources.len() {
            lock(&self.status).dropped += self.files.take_missing_at_end(index);
        }
        self.count_missing_events();
        lock(&self.status).ended = true;
    }
}

impl Source {
    /// Reads `cycles` after all cycles of the current control thread. Does nothing if `cycles`
    /// belongs to the same control thread, because a connection can be reported twice.
    fn resume(&mut self, cycles: CycleReader) {
        let last = self.next.back().unwrap_or(&self.cycles);
        if !last.is_of_same_thread(&cycles) {
            self.next.push_back(cycles);
        }
    }

    /// Forwards the waiting data that is not newer than `time`.
    fn pass(&mut self, time: HostTime, files: &mut Files) {
        let count = self
            .waiting
            .partition_point(|waiting| waiting.time() <= time);
        for waiting in self.waiting.drain(..count) {
            match waiting {
                Waiting::Event(event) => {
                    self.encoder.event(&event, &mut self.messages);
                    if let EventKind::Outcome(outcome) = &event.kind
                        && event.kind.is_incident()
                    {
                        let why = outcome.ending.to_string();
                        files.note_incident(event.time, &self.label, &why);
                    }
                }
                Waiting::Gripper(time, state) => {
                    self.encoder.gripper(time, &state, &mut self.messages);
                }
            }
            files.pass(&mut self.messages);
        }
    }

    /// Reports the cycles that were lost after the newest received cycle, and returns their number.
    fn note_end(&mut self, time: HostTime, files: &mut Files) -> u64 {
        let cycles = self.cycles.lost() - self.lost;
        if cycles > 0 {
            self.event(time, EventKind::Dropped { cycles }, files);
        }
        cycles
    }

    fn event(&mut self, time: HostTime, kind: EventKind, files: &mut Files) {
        let event = Event {
            time,
            robot_time: 0,
            kind,
        };
        self.encoder.event(&event, &mut self.messages);
        files.pass(&mut self.messages);
    }
}

/// Interval between two polls of the rings. The rings hold several seconds of cycles.
const LOOK: Duration = Duration::from_millis(20);

const COMPARE_PERIOD: Duration = Duration::from_secs(1);

/// Smallest difference that counts as a step of the wall clock, `[ns]`. Smaller differences come
/// from slewing.
const STEP_MIN: i64 = 100_000_000;
