//! What is in the files, whatever happens to them.

use franka_model::RobotKind;
use franka_record::EventKind;
use franka_record::event::{Ending, Outcome};
use franka_record::recorder::{BlackBox, RecordError, Recorder, Robot, Rotation};

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

#[test]
fn a_recording_goes_on_in_the_next_file() {
    let scratch = Scratch::new();
    let options = franka_record::recorder::RecordOptions {
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

#[test]
fn the_last_seconds_are_written_when_a_reflex_ends_a_motion() {
    let scratch = Scratch::new();
    let black_box = BlackBox {
        before: std::time::Duration::from_secs(2),
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
