//! Recorders whose disk blocks, and recorders whose wall clock is set during a recording.

use std::fs::File;
use std::io::{PipeReader, Read as _};
use std::os::fd::OwnedFd;
use std::path::Path;
use std::sync::atomic::{AtomicI64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use franka_model::RobotKind;
use rand::rngs::SmallRng;
use rand::{Rng as _, SeedableRng as _};

use super::{BlackBox, RecordError, Recorder, Robot, Rotation};
use crate::event::{Ending, Outcome};
use crate::{Cycle, EventKind, HostTime, Recording};
use feed::{Arm, Scratch, quick};

#[allow(dead_code, reason = "not every test uses all of it")]
#[path = "../../tests/recording/feed.rs"]
mod feed;

/// Returns a recorder whose disk accepts some bytes and then blocks until the other end is read.
fn hanging() -> (Recorder, PipeReader) {
    let (reader, writer) = std::io::pipe().unwrap();
    let file = File::from(OwnedFd::from(writer));
    let path = Some(Path::new("hanging.mcap"));
    let recorder = Recorder::start_with(path, Some(file), quick(), HostTime::now).unwrap();
    (recorder, reader)
}

fn cycles_and_dropped(recording: &Recording) -> (Vec<Cycle>, u64) {
    let robot = recording.robot("").unwrap();
    let cycles = robot.cycles().map(Result::unwrap).collect();
    let dropped = robot.events().map(|event| match event.unwrap().kind {
        EventKind::Dropped { cycles } => cycles,
        _ => 0,
    });
    (cycles, dropped.sum())
}

#[test]
fn finish_waits_no_longer_than_its_limit_for_a_hung_disk() {
    let (recorder, reader) = hanging();
    let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    // Every cycle is received, regardless of the disk.
    arm.run(&recorder, 3000);
    let limit = Duration::from_millis(50);
    let error = recorder.finish_within(limit).unwrap_err();
    assert!(
        matches!(error, RecordError::Unfinished { limit: told } if told == limit),
        "{error}"
    );
    // The rest is written once the disk continues.
    let recording = Recording::from_bytes(read_all(reader)).unwrap();
    assert_eq!(recording.damage(), None);
    let (cycles, dropped) = cycles_and_dropped(&recording);
    assert_eq!((cycles.len(), dropped), (3000, 0));
}

#[test]
fn data_dropped_while_a_disk_hangs_is_counted_in_the_file() {
    for goes_on in [true, false] {
        let (recorder, reader) = hanging();
        let (mut arm, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fer));
        arm.run(&recorder, 500);
        let mut random = SmallRng::seed_from_u64(23);
        let patience = Instant::now() + Duration::from_secs(60);
        while recorder.status().waiting < super::files::BACKLOG_MAX {
            assert!(Instant::now() < patience, "{:?}", recorder.status());
            // Text that cannot be compressed.
            let text = (0..4 << 20).map(|_| char::from(random.random_range(b' '..b'~')));
            handle.note(text.collect::<String>());
            // Cycles that are written while there is space.
            arm.run(&recorder, 200);
        }
        arm.run(&recorder, 1000);
        let reading = thread::spawn(|| read_all(reader));
        if goes_on {
            while recorder.status().waiting > 0 {
                assert!(Instant::now() < patience, "{:?}", recorder.status());
                thread::sleep(Duration::from_millis(5));
            }
            arm.run(&recorder, 2000);
        }
        let status = recorder.finish_within(Duration::from_secs(60)).unwrap();
        assert_eq!(status.cycles, arm.cycles());
        assert!(status.dropped >= 1000 - u64::from(goes_on), "{status:?}");
        let recording = Recording::from_bytes(reading.join().unwrap()).unwrap();
        let (cycles, dropped) = cycles_and_dropped(&recording);
        assert_eq!(cycles.len() as u64, status.cycles - status.dropped);
        assert_eq!(dropped, status.dropped);
    }
}

/// Records cycles, events and black boxes with a disk that accepts no data.
#[test]
fn memory_is_bounded_while_a_disk_hangs() {
    let (reader, writer) = std::io::pipe().unwrap();
    let scratch = Scratch::new();
    let mut options = quick();
    options.black_box = Some(BlackBox {
        before: Duration::from_secs(1),
        after: Duration::ZERO,
        ..BlackBox::new(scratch.path("boxes"))
    });
    let path = Some(Path::new("hanging.mcap"));
    let file = Some(File::from(OwnedFd::from(writer)));
    let recorder = Recorder::start_with(path, file, options, HostTime::now).unwrap();
    let (mut arm, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    arm.run(&recorder, 500);
    let mut random = SmallRng::seed_from_u64(29);
    let patience = Instant::now() + Duration::from_secs(60);
    let mut noted = 0;
    while recorder.status().events_dropped < 5 {
        assert!(Instant::now() < patience, "{:?}", recorder.status());
        let text = (0..4 << 20).map(|_| char::from(random.random_range(b' '..b'~')));
        handle.note(text.collect::<String>());
        noted += 1;
        arm.run(&recorder, 1100);
        let ending = Ending::Reflex;
        handle.event(EventKind::Outcome(Outcome {
            ending,
            ..Outcome::default()
        }));
    }
    // The bound plus a chunk and a black box.
    let most = super::files::EVENT_BACKLOG_MAX + (32 << 20);
    let status = recorder.status();
    assert!(status.waiting < most, "{noted} notes: {status:?}");
    let error = status.black_box_error.expect("the disk hangs");
    assert!(
        error
            .to_string()
            .contains("the previous block is not written yet"),
        "{error}"
    );
    // Without a reader the pipe is broken, and the recording ends with the data written before.
    drop(reader);
    let error = recorder.finish_within(Duration::from_secs(60)).unwrap_err();
    assert!(matches!(error, RecordError::Write { .. }), "{error}");
}

fn read_all(mut reader: PipeReader) -> Vec<u8> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).unwrap();
    bytes
}

/// Offset of the test's wall clock, and its value at the last read, `[ns]`.
static AHEAD: AtomicI64 = AtomicI64::new(0);
static READ: AtomicI64 = AtomicI64::new(0);

fn wall() -> HostTime {
    let ahead = AHEAD.load(Ordering::Relaxed);
    READ.store(ahead, Ordering::Relaxed);
    HostTime::from_nanos(HostTime::now().as_nanos().saturating_add_signed(ahead))
}

#[test]
fn a_clock_that_is_set_moves_no_time_of_a_recording() {
    const HOUR: i64 = 3_600_000_000_000;
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let mut options = quick();
    options.rotation = Rotation {
        time: Some(Duration::from_secs(2)),
        bytes: None,
    };
    let file = super::disk::create(&path).unwrap();
    let recorder = Recorder::start_with(Some(&path), Some(file), options, wall).unwrap();
    let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    for ahead in [0, HOUR, -HOUR, 0] {
        AHEAD.store(ahead, Ordering::Relaxed);
        let patience = Instant::now() + Duration::from_secs(60);
        while READ.load(Ordering::Relaxed) != ahead {
            assert!(Instant::now() < patience, "no one reads the clock");
            thread::sleep(Duration::from_millis(5));
        }
        arm.run(&recorder, 2000);
    }
    let status = recorder.finish().unwrap();
    // 8 s of cycles, without the hour.
    assert!((3..=5).contains(&status.files.len()), "{:?}", status.files);

    let (mut cycles, mut steps) = (Vec::new(), Vec::new());
    for path in &status.files {
        let recording = Recording::open(path).unwrap();
        assert_eq!(recording.damage(), None);
        let robot = recording.robot("").unwrap();
        let of_file: Vec<_> = robot.cycles().map(Result::unwrap).collect();
        for event in robot.events() {
            if let EventKind::ClockStep { by } = event.unwrap().kind {
                // Rounded to an hour, because the clock of this host may be slewed meanwhile.
                steps.push((by + by.signum() * HOUR / 2) / HOUR);
            }
        }
        if let Some(middle) = of_file.get(of_file.len() / 2) {
            let part = robot.from(middle.time).cycles();
            let expected = of_file.iter().filter(|cycle| cycle.time >= middle.time);
            assert_eq!(part.count(), expected.count());
        }
        cycles.extend(of_file);
    }
    assert_eq!(steps, [1, -1, 0]);
    let numbers: Vec<_> = cycles.iter().map(|cycle| cycle.record.time).collect();
    assert_eq!(numbers, (1..=8000).collect::<Vec<_>>());
    for pair in cycles.windows(2) {
        let between = pair[1].time.since(pair[0].time);
        assert!(pair[0].time < pair[1].time && between < Duration::from_millis(2));
    }
}
