//! Robots with synthetic cycles, determined by a pace and a seed.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use franka_model::RobotKind;
use franka_proto::{RobotMode, RobotState, Version};
use franka_record::recorder::{RecordHandle, RecordOptions, Recorder, Robot};
use franka_rt::driver::{Activity, Record};
use franka_rt::thread::{CycleFeed, CyclePublisher, CycleReader, cycle_feed};
use nalgebra::Isometry3;

/// A robot that moves in a circle and feeds a recorder.
pub(crate) struct Arm {
    version: Version,
    publisher: CyclePublisher,
    feed: CycleFeed,
    began: Instant,
    ms: u64,
    /// The state of the next cycle, except the moving parts.
    pub(crate) state: RobotState,
}

impl Arm {
    /// Attaches an arm of this kind to a recorder.
    pub(crate) fn attach(recorder: &Recorder, robot: Robot) -> (Self, RecordHandle) {
        let (arm, cycles) = Self::new(robot.kind);
        let handle = recorder.attach(robot, cycles).unwrap();
        (arm, handle)
    }

    /// Creates an arm of this kind, and a reader of its cycles.
    pub(crate) fn new(kind: RobotKind) -> (Self, CycleReader) {
        let version = match kind {
            RobotKind::Fer => Version::V5,
            _ => Version::V10,
        };
        let (feed, publisher) = cycle_feed(version);
        let mut arm = Self {
            version,
            publisher,
            feed,
            began: Instant::now(),
            ms: 0,
            state: RobotState {
                robot_mode: RobotMode::Move,
                m_ee: 0.73,
                ..RobotState::default()
            },
        };
        let reader = arm.reader();
        (arm, reader)
    }

    /// Returns a reader of this arm's cycles from now on.
    pub(crate) fn reader(&mut self) -> CycleReader {
        let reader = self.feed.attach(RING).unwrap();
        self.publisher.take_attached();
        reader
    }

    /// Feeds `count` cycles of a millisecond each, as fast as `recorder` reads them.
    pub(crate) fn run(&mut self, recorder: &Recorder, count: u64) {
        for cycle in 0..count {
            // At most half the ring is unread.
            if cycle % (RING as u64 / 4) == 0 {
                self.wait(recorder);
            }
            self.step();
        }
        self.wait(recorder);
    }

    /// Waits until the recorder has read every cycle.
    pub(crate) fn wait(&self, recorder: &Recorder) {
        let patience = Instant::now() + Duration::from_secs(60);
        while recorder.status().cycles < self.ms {
            assert!(Instant::now() < patience, "the recorder takes no cycles");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Feeds one cycle.
    pub(crate) fn step(&mut self) {
        self.ms += 1;
        let (state, record) = self.cycle_at(self.ms);
        let mut bytes = [0; RobotState::MAX_SIZE];
        let length = state.encode(self.version, &mut bytes).unwrap();
        self.publisher
            .push(record, &bytes[..length], self.received());
    }

    /// Returns the time of the last cycle according to the arm's pace, regardless of the actual
    /// speed.
    pub(crate) fn received(&self) -> Instant {
        self.began + Duration::from_millis(self.ms)
    }

    /// Returns the state and the record of a cycle.
    pub(crate) fn cycle_at(&self, ms: u64) -> (RobotState, Record) {
        let t = ms as f64 * 1e-3;
        let mut state = self.state;
        state.message_id = ms;
        for joint in 0..7 {
            let phase = 0.7 * t + joint as f64;
            state.q[joint] = 0.4 * phase.sin();
            state.dq[joint] = 0.28 * phase.cos();
            state.tau_J[joint] = 10.0 * phase.cos();
            state.tau_ext_hat_filtered[joint] = 0.1 * (13.0 * phase).sin();
        }
        state.O_T_EE[12..15].copy_from_slice(&[0.5, 0.1 * t.sin(), 0.4]);
        state.O_F_ext_hat_K[2] = 5.0 * t.sin();
        let mut record = Record::default();
        record.time = ms;
        record.activity = Activity::Running;
        record.robot_mode = state.robot_mode;
        record.errors = state.errors;
        record.reflex_reason = state.reflex_reason;
        record.goal = 1;
        record.pose_target = Some(Isometry3::translation(0.5, 0.1, 0.4));
        record.q = state.q;
        record.dq = state.dq;
        record.q_ref = state.q;
        record.tau_c = state.tau_J;
        record.turnaround = Duration::from_micros(80);
        (state, record)
    }

    /// Number of cycles so far.
    pub(crate) fn cycles(&self) -> u64 {
        self.ms
    }
}

/// Length of the ring in cycles.
const RING: usize = 4096;

/// A directory that is removed when this value is dropped.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    pub(crate) fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("franka-record-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Returns options that do not wait for the disk.
pub(crate) fn quick() -> RecordOptions {
    RecordOptions {
        sync: false,
        ..RecordOptions::default()
    }
}
