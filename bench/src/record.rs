//! The cost of recording: bytes per cycle, and processor time of the recorder's threads.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use franka_model::RobotKind;
use franka_proto::RobotState;
use franka_record::recorder::{RecordOptions, Recorder, Robot as Recorded};
use franka_rt::driver::Record;
use franka_rt::thread::{CyclePublisher, cycle_feed};
use franka_sim::{Arm, Config, Robot, Tool};

use franka_lockstep::{Lockstep, Wander};

/// The totals of a recording.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Cost {
    /// Number of recorded cycles.
    pub cycles: u64,
    /// Number of cycles without space.
    pub dropped: u64,
    /// Bytes of the file, per cycle of the robot.
    pub bytes_per_cycle: f64,
    /// Size of an hour, `[GB]`.
    pub gigabytes_per_hour: f64,
    /// Processor time of the recorder's threads at 1 kHz, in percent of one core; `None` if the
    /// system does not provide the time of a thread.
    pub cpu_percent: Option<f64>,
}

/// Records `minutes` of a realistic arm with random motions, as fast as possible, in `directory`.
/// The cycles of its first 20 s are repeated.
///
/// # Panics
/// If the file cannot be written.
pub fn record(minutes: f64, thinned: bool, directory: &Path) -> Cost {
    let seen = cycles();
    let path = directory.join(format!("bench-{}.mcap", std::process::id()));
    let options = RecordOptions {
        thinned,
        ..RecordOptions::default()
    };
    let recorder = Recorder::to_file(&path, options).expect("a new file");
    let version = franka_proto::Version::V10;
    let (feed, mut publisher) = cycle_feed(version);
    let reader = feed.attach(RING as usize).expect("the first reader");
    publisher.take_attached();
    let handle = recorder
        .attach(Recorded::new(RobotKind::Fr3), reader)
        .expect("the first robot");
    let began = Instant::now();
    let total = (minutes * 60_000.0) as u64;
    let mut taken = 0;
    for ms in 0..total {
        // Less than the capacity of the ring is unread.
        while ms >= taken + RING / 2 {
            std::thread::sleep(Duration::from_millis(1));
            taken = recorder.status().cycles;
        }
        push(&mut publisher, &seen, ms, began);
    }
    while recorder.status().cycles + recorder.status().dropped < total {
        std::thread::sleep(Duration::from_millis(1));
    }
    let spent = processor_time();
    drop(handle);
    let status = recorder.finish().expect("the file can be written");
    let _ = fs::remove_file(&path);
    let bytes_per_cycle = status.bytes as f64 / total as f64;
    Cost {
        cycles: status.cycles,
        dropped: status.dropped,
        bytes_per_cycle,
        gigabytes_per_hour: bytes_per_cycle * 3.6e6 * 1e-9,
        cpu_percent: spent.map(|spent| spent.as_secs_f64() / (total as f64 * 1e-3) * 100.0),
    }
}

/// Returns the cycles of 20 s of a realistic arm.
fn cycles() -> Vec<(Record, RobotState)> {
    let config = Config {
        tool: Tool::hand(),
        arm: Some(Arm::realistic(RobotKind::Fr3)),
        ..Config::default()
    };
    let mut wander = Wander::of(Lockstep::with_robot(Robot::new(config)), 19);
    (0..20_000)
        .map(|_| {
            wander.tick_around(|_, work| work());
            let client = &wander.lockstep.client;
            (*client.driver.record(), client.state)
        })
        .collect()
}

/// Feeds a cycle like the control thread.
fn push(publisher: &mut CyclePublisher, seen: &[(Record, RobotState)], ms: u64, began: Instant) {
    let (mut record, mut state) = seen[ms as usize % seen.len()];
    record.time = ms;
    state.message_id = ms;
    let mut bytes = [0; RobotState::MAX_SIZE];
    let length = state
        .encode(franka_proto::Version::V10, &mut bytes)
        .expect("it was decoded from as many bytes");
    publisher.push(record, &bytes[..length], began + Duration::from_millis(ms));
}

/// Returns the processor time of the recorder's threads so far; `None` if the system does not
/// provide it.
pub fn processor_time() -> Option<Duration> {
    let mut total = Duration::ZERO;
    for task in fs::read_dir("/proc/self/task").ok()? {
        let path = task.ok()?.path();
        let name = fs::read_to_string(path.join("comm")).ok()?;
        if matches!(name.trim(), "franka-record" | "franka-disk") {
            // The first value is the time on a processor in nanoseconds.
            let stat = fs::read_to_string(path.join("schedstat")).ok()?;
            let nanos = stat.split_whitespace().next()?.parse().ok()?;
            total += Duration::from_nanos(nanos);
        }
    }
    Some(total)
}

/// Length of the ring in cycles.
const RING: u64 = 4096;
