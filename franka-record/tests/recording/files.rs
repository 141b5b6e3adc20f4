//! The contents of the files, under all conditions.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use franka_model::RobotKind;
use franka_record::event::{Ending, Note, Outcome};
use franka_record::recorder::{
    BlackBox, RecordError, RecordOptions, RecordStatus, Recorder, Robot, Rotation,
};
use franka_record::{EventKind, Recording};

use crate::feed::{Arm, Scratch, quick};

#[test]
fn every_cycle_is_in_the_file() {
    let scratch = Scratch::new();
    let recorder = Recorder::to_file(scratch.path("run.mcap"), quick()).unwrap();
    let (mut arm, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    arm.run(&recorder, 3000);
    handle.note("half");
    arm.run(&recorder, 2000);
    let status = recorder.finish().unwrap();
    assert_eq!((status.cycles, status.dropped), (5000, 0));
    let bytes = std::fs::read(scratch.path("run.mcap")).unwrap();
    assert_eq!(bytes.len() as u64, status.bytes);
    let mut cycles = 0;
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        cycles += u64::from(message.unwrap().channel.topic == "/cycle");
    }
    assert_eq!(cycles, 5000);
}

/// This also holds if the recording ends before the recorder has read the newest connection. A
/// connection that is reported twice is recorded once.
#[test]
fn cycles_of_other_connections_follow_those_of_the_first() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let recorder = Recorder::to_file(&path, quick()).unwrap();
    let (mut first, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    handle.resume(first.reader());
    first.run(&recorder, 1000);
    let others = [300, 200].map(|count| {
        let (mut arm, cycles) = Arm::new(RobotKind::Fr3);
        handle.resume(cycles);
        handle.resume(arm.reader());
        (0..count).for_each(|_| arm.step());
        arm
    });
    let status = recorder.finish().unwrap();
    let count = first.cycles() + others.iter().map(Arm::cycles).sum::<u64>();
    assert_eq!((status.cycles, status.dropped), (count, 0));
    let recording = Recording::open(&path).unwrap();
    let cycles = recording.robot("").unwrap().cycles();
    let times: Vec<_> = cycles.map(|cycle| cycle.unwrap().record.time).collect();
    let expected: Vec<_> = (1..=1000).chain(1..=300).chain(1..=200).collect();
    assert_eq!(times, expected);
}

#[test]
fn event_before_the_first_cycle_has_the_attach_time() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let recorder = Recorder::to_file(&path, quick()).unwrap();
    let begun = Instant::now();
    let robot = Robot {
        robot_time: 104_506,
        ..Robot::new(RobotKind::Fr3)
    };
    let (mut arm, handle) = Arm::attach(&recorder, robot);
    let remark = |text: &str| {
        EventKind::Note(Note {
            text: text.into(),
            ..Note::default()
        })
    };
    handle.event_at(handle.clock().at(begun), remark("before"));
    arm.run(&recorder, 100);
    let after = begun + Duration::from_secs(1);
    handle.event_at(handle.clock().at(after), remark("after"));
    recorder.finish().unwrap();
    let recording = Recording::open(&path).unwrap();
    let events = recording.robot("").unwrap().events();
    let noted = events
        .map(Result::unwrap)
        .filter_map(|event| match event.kind {
            EventKind::Note(note) => Some((note.text, event.robot_time)),
            _ => None,
        });
    let noted: Vec<_> = noted.collect();
    let expected = [("before".to_owned(), 104_506), ("after".to_owned(), 100)];
    assert_eq!(noted, expected);
}

#[test]
fn a_file_is_never_overwritten() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let first = Recorder::to_file(&path, quick()).unwrap();
    let second = Recorder::to_file(&path, quick()).map(drop);
    assert!(
        matches!(second, Err(RecordError::Exists { .. })),
        "{second:?}"
    );
    first.finish().unwrap();
    let third = Recorder::to_file(&path, quick()).map(drop);
    assert!(
        matches!(third, Err(RecordError::Exists { .. })),
        "{third:?}"
    );
}

#[test]
fn a_folder_that_is_not_there_is_told_at_once() {
    let scratch = Scratch::new();
    let missing = Recorder::to_file(scratch.path("none/run.mcap"), quick()).map(drop);
    let error = missing.unwrap_err();
    assert!(matches!(error, RecordError::Create { .. }), "{error}");
    assert!(error.to_string().contains("none/run.mcap"), "{error}");
}

/// Records three files or more.
fn rotated(scratch: &Scratch) -> (Arm, RecordStatus) {
    let options = RecordOptions {
        rotation: Rotation {
            bytes: Some(1_000_000),
            time: None,
        },
        ..quick()
    };
    let recorder = Recorder::to_file(scratch.path("run.mcap"), options).unwrap();
    let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fer));
    arm.run(&recorder, 12_000);
    let status = recorder.finish().unwrap();
    assert!(status.files.len() >= 3, "{:?}", status.files);
    (arm, status)
}

#[test]
fn a_recording_goes_on_in_the_next_file() {
    let scratch = Scratch::new();
    let (arm, status) = rotated(&scratch);
    assert_eq!(status.files[1], scratch.path("run-0002.mcap"));
    let mut cycles = 0;
    for path in &status.files {
        let bytes = std::fs::read(path).unwrap();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            cycles += u64::from(message.unwrap().channel.topic == "/cycle");
        }
    }
    assert_eq!(cycles, arm.cycles());
}

/// The files belong to an earlier recording with the same name. Its first file was moved away.
#[test]
fn rotation_leaves_out_numbers_that_other_files_have() {
    let scratch = Scratch::new();
    for number in ["0002", "0003", "0005"] {
        std::fs::write(scratch.path(&format!("run-{number}.mcap")), "of before").unwrap();
    }
    let (arm, status) = rotated(&scratch);
    let names = ["run.mcap", "run-0004.mcap", "run-0006.mcap"];
    assert_eq!(status.files[..3], names.map(|name| scratch.path(name)));
    assert_eq!((status.cycles, status.dropped), (arm.cycles(), 0));
    for number in ["0002", "0003", "0005"] {
        let text = std::fs::read_to_string(scratch.path(&format!("run-{number}.mcap")));
        assert_eq!(text.unwrap(), "of before");
    }
}

#[test]
fn the_last_seconds_are_written_when_a_reflex_ends_a_motion() {
    let scratch = Scratch::new();
    let black_box = BlackBox {
        before: Duration::from_secs(2),
        keep: 2,
        ..BlackBox::new(scratch.path("boxes"))
    };
    let recorder = Recorder::black_box(black_box).unwrap();
    let (mut arm, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3).named("left"));
    for ending in [
        Ending::Arrived,
        Ending::Reflex,
        Ending::LinkLost,
        Ending::Reflex,
    ] {
        arm.run(&recorder, 3000);
        handle.event(EventKind::Outcome(Outcome {
            ending,
            ..Outcome::default()
        }));
        arm.run(&recorder, 2000);
    }
    let status = recorder.finish().unwrap();
    assert!(status.files.is_empty());
    assert_eq!(status.black_boxes.len(), 3, "{status:?}");
    let mut left: Vec<_> = std::fs::read_dir(scratch.path("boxes"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    left.sort();
    assert_eq!(left, status.black_boxes[1..]);
    let name = left[0].file_name().unwrap().to_string_lossy().into_owned();
    assert!(name.ends_with("Z-left-link-lost.mcap"), "{name}");
    let bytes = std::fs::read(&left[1]).unwrap();
    let cycles = mcap::MessageStream::new(&bytes)
        .unwrap()
        .filter(|message| message.as_ref().unwrap().channel.topic == "/left/cycle")
        .count();
    assert!((2000..=3100).contains(&cycles), "{cycles}");
}

#[test]
fn full_disk_keeps_earlier_data_and_reports_one_error() {
    if let Some(path) = std::env::var_os(FULL) {
        return record_until_full(Path::new(&path));
    }
    let scratch = Scratch::new();
    let path = scratch.path("full.mcap");
    // A limit of the process simulates a full disk: the write that exceeds it is cut short and the
    // next one fails. The shell counts blocks of 512 or 1024 bytes.
    let mut child = Command::new("sh");
    child
        .arg("-c")
        .arg("trap '' XFSZ; ulimit -f 900; exec \"$0\" \"$@\"");
    child.arg(std::env::current_exe().unwrap());
    let name = "full_disk_keeps_earlier_data_and_reports_one_error";
    child.args(["--exact", &format!("files::{name}"), "--nocapture"]);
    let output = child.env(FULL, &path).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}{errors}");
    assert_eq!(said.matches("ERROR").count(), 1, "{said}");
    assert!(said.contains("full.mcap"), "{said}");
}

/// Records more data than this process may write.
fn record_until_full(path: &Path) {
    tracing_subscriber::fmt().with_ansi(false).init();
    let options = RecordOptions {
        flush: Duration::from_millis(100),
        ..RecordOptions::default()
    };
    let recorder = Recorder::to_file(path, options).unwrap();
    let (mut arm, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    // Cycles are read, and no thread waits, regardless of the file.
    let patience = Instant::now() + Duration::from_secs(60);
    while recorder.status().error.is_none() {
        assert!(Instant::now() < patience, "the limit does not hold");
        arm.run(&recorder, 500);
    }
    arm.run(&recorder, 500);
    handle.note("not recorded");
    let recording = Recording::open(path).unwrap();
    let damage = recording.damage().expect("it has no end");
    assert!(damage.contains("end is missing"), "{damage}");
    let robot = recording.robot("").unwrap();
    let times = robot.cycles().map(|cycle| cycle.unwrap().record.time);
    let times: Vec<_> = times.collect();
    assert!(times.len() > 100, "{}", times.len());
    assert_eq!(times, (1..=times.len() as u64).collect::<Vec<_>>());
    // All other cycles are counted once the disk thread has processed the last chunk; the newest
    // one is counted with the next chunk.
    let counted = loop {
        let status = recorder.status();
        let kept = status.cycles - status.dropped;
        if (kept - 1..=kept).contains(&(times.len() as u64)) {
            break status;
        }
        assert!(Instant::now() < patience, "{status:?}");
        std::thread::sleep(Duration::from_millis(1));
    };
    let error = recorder.finish().unwrap_err();
    let RecordError::Write { bytes, source, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!(source.kind(), std::io::ErrorKind::FileTooLarge);
    let length = std::fs::metadata(path).unwrap().len();
    assert_eq!((length, *bytes), (counted.bytes, counted.bytes));
}

/// A folder path that is a file accepts no files, even for a privileged user.
#[test]
fn unwritable_folder_is_reported_and_recording_goes_on() {
    let scratch = Scratch::new();
    let folder = scratch.path("file");
    std::fs::write(&folder, b"").unwrap();
    let error = Recorder::to_file(folder.join("run.mcap"), quick()).map(drop);
    let error = error.unwrap_err();
    assert!(matches!(error, RecordError::Create { .. }), "{error}");

    let options = RecordOptions {
        black_box: Some(BlackBox {
            after: Duration::ZERO,
            ..BlackBox::new(&folder)
        }),
        ..quick()
    };
    let recorder = Recorder::to_file(scratch.path("run.mcap"), options).unwrap();
    let (mut arm, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    arm.run(&recorder, 1000);
    handle.event(EventKind::Outcome(Outcome {
        ending: Ending::Reflex,
        ..Outcome::default()
    }));
    arm.run(&recorder, 1000);
    let status = recorder.finish().unwrap();
    let error = status.black_box_error.expect("it cannot be written");
    assert!(matches!(error, RecordError::BlackBox { .. }), "{error}");
    assert!(error.to_string().contains("-fr3-reflex.mcap"), "{error}");
    assert_eq!((status.cycles, status.dropped), (2000, 0));
    assert!(status.black_boxes.is_empty());
}

/// Environment variable with the file for the child process whose disk is full.
const FULL: &str = "FRANKA_RECORD_FULL";
