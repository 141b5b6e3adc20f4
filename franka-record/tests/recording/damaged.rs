//! Files that are truncated, damaged or left by a killed program.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use franka_model::RobotKind;
use franka_record::Recording;
use franka_record::cassette::Cassette;
use franka_record::recorder::{RecordOptions, Recorder, Robot};
use franka_record::recording::RecordingError;
use rand::rngs::SmallRng;
use rand::{Rng as _, SeedableRng as _};

use crate::any_bytes;
use crate::feed::{Arm, Scratch, quick};

/// Returns a short recording, and the ends of its chunks.
fn recording(scratch: &Scratch, kind: RobotKind) -> (Vec<u8>, Vec<usize>) {
    let path = scratch.path("whole.mcap");
    let options = RecordOptions {
        flush: Duration::from_millis(15),
        ..quick()
    };
    let recorder = Recorder::to_file(&path, options).unwrap();
    let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(kind));
    arm.run(&recorder, CYCLES as u64);
    recorder.finish().unwrap();
    let bytes = std::fs::read(path).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let ends = summary
        .chunk_indexes
        .iter()
        .map(|chunk| (chunk.chunk_start_offset + chunk.chunk_length) as usize)
        .collect();
    (bytes, ends)
}

/// Returns the number of cycles in these whole chunks, according to the crate of the format.
fn cycles_by_standard(bytes: &[u8]) -> usize {
    let messages = by_standard(bytes).into_iter();
    messages.filter(|(topic, ..)| topic == "/cycle").count()
}

#[test]
fn a_file_that_is_cut_keeps_every_chunk_before_the_cut() {
    let scratch = Scratch::new();
    let (bytes, ends) = recording(&scratch, RobotKind::Fr3);
    let cycles: Vec<_> = ends
        .iter()
        .map(|end| cycles_by_standard(&bytes[..*end]))
        .collect();
    assert!(ends.len() > 20, "{ends:?}");
    assert_eq!(cycles.last(), Some(&CYCLES));
    let mut random = SmallRng::seed_from_u64(19);
    for _ in 0..1000 {
        let cut = random.random_range(8..bytes.len());
        let recording = Recording::from_bytes(bytes[..cut].to_vec()).unwrap();
        assert!(recording.damage().is_some(), "cut at {cut}");
        let whole = ends.iter().rposition(|end| *end <= cut);
        let expected = whole.map_or(0, |chunk| cycles[chunk]);
        let read = match recording.robot("") {
            Ok(robot) => robot.cycles().map(Result::unwrap).count(),
            Err(RecordingError::NoRobot { .. }) => 0,
            Err(error) => panic!("cut at {cut}: {error}"),
        };
        assert_eq!(read, expected, "cut at {cut}");
    }
}

#[test]
fn damaged_bytes_are_told_and_the_rest_is_read() {
    let scratch = Scratch::new();
    let (bytes, _) = recording(&scratch, RobotKind::Fr3);
    let mut random = SmallRng::seed_from_u64(20);
    for _ in 0..300 {
        let mut damaged = bytes.clone();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(0..damaged.len());
            damaged[at] ^= 1 << random.random_range(0..8);
        }
        // A file with another beginning is refused.
        let Ok(recording) = Recording::from_bytes(damaged) else {
            continue;
        };
        let Ok(robot) = recording.robot("") else {
            continue;
        };
        let times: BTreeSet<_> = robot
            .cycles()
            .filter_map(Result::ok)
            .map(|cycle| cycle.record.time)
            .collect();
        // Three chunks of 15 at most, if the file can be scanned at all.
        let gone_through = recording.damage().is_none();
        assert!(
            !gone_through || times.len() >= CYCLES - 45,
            "{}",
            times.len()
        );
        assert!(robot.events().count() < CYCLES);
    }
}

#[test]
fn a_recovered_file_is_whole_and_has_the_same_messages() {
    let scratch = Scratch::new();
    let (bytes, ends) = recording(&scratch, RobotKind::Fr3);
    let cut = ends[ends.len() / 2] + 100;
    let (damaged, whole) = (scratch.path("cut.mcap"), scratch.path("recovered.mcap"));
    std::fs::write(&damaged, &bytes[..cut]).unwrap();
    let recovery = Recording::recover(&damaged, &whole).unwrap();
    assert_eq!(
        (recovery.chunks, recovery.lost),
        (ends.len() as u64 / 2 + 1, 0)
    );
    assert!(recovery.damage.is_some());

    let recovered = std::fs::read(&whole).unwrap();
    // The standard reader reads it without leniency.
    let standard = mcap::MessageStream::new(&recovered).unwrap();
    let messages = standard.inspect(|message| assert!(message.is_ok())).count();
    assert_eq!(messages as u64, recovery.messages);
    let (before, after) = (
        Recording::open(&damaged).unwrap(),
        Recording::open(&whole).unwrap(),
    );
    assert_eq!(after.damage(), None);
    assert_eq!(after.metadata(), before.metadata());
    let cycles = |recording: &Recording| -> Vec<_> {
        let robot = recording.robot("").unwrap();
        robot.cycles().map(Result::unwrap).collect()
    };
    assert!(cycles(&before) == cycles(&after));
    let again = Recording::recover(&damaged, &whole).unwrap_err();
    assert!(matches!(again, RecordingError::File { .. }), "{again}");
}

/// According to its source, the standard tool recovers the messages of every whole chunk up to the
/// cut. Here, the crate of the format reads the records.
#[test]
fn files_cut_anywhere_are_recovered_as_the_standard_tool_does() {
    let scratch = Scratch::new();
    for kind in RobotKind::ALL {
        let (bytes, ends) = recording(&scratch, kind);
        let messages: Vec<_> = ends.iter().map(|end| by_standard(&bytes[..*end])).collect();
        let (damaged, whole) = (scratch.path("cut.mcap"), scratch.path("recovered.mcap"));
        let mut random = SmallRng::seed_from_u64(22);
        for _ in 0..1000 / RobotKind::ALL.len() {
            let cut = random.random_range(8..bytes.len());
            std::fs::write(&damaged, &bytes[..cut]).unwrap();
            let recovery = Recording::recover(&damaged, &whole).unwrap();
            let chunks = ends.iter().filter(|end| **end <= cut).count();
            assert_eq!(
                (recovery.chunks, recovery.lost),
                (chunks as u64, 0),
                "{cut}"
            );
            assert!(recovery.damage.is_some(), "{cut}");
            let recovered = std::fs::read(&whole).unwrap();
            std::fs::remove_file(&whole).unwrap();
            // Read strictly: with its end, and with correct checksums.
            let recovered: Vec<_> = mcap::MessageStream::new(&recovered)
                .unwrap()
                .map(|message| {
                    let message = message.unwrap();
                    let topic = message.channel.topic.clone();
                    (
                        topic,
                        message.sequence,
                        message.log_time,
                        message.data.to_vec(),
                    )
                })
                .collect();
            let expected = chunks
                .checked_sub(1)
                .map_or(&[][..], |last| &messages[last]);
            assert!(recovered == expected, "cut at {cut}");
        }
        std::fs::remove_file(scratch.path("whole.mcap")).unwrap();
    }
}

/// Returns topic, sequence number, time and data of each message of these whole chunks.
fn by_standard(bytes: &[u8]) -> Vec<(String, u32, u64, Vec<u8>)> {
    use mcap::read::{ChunkFlattener, Options};
    use mcap::records::Record;
    let records = ChunkFlattener::new_with_options(bytes, Options::IgnoreEndMagic.into());
    let (mut topics, mut messages) = (BTreeMap::new(), Vec::new());
    for record in records.unwrap() {
        match record {
            Ok(Record::Channel(channel)) => {
                topics.insert(channel.id, channel.topic);
            }
            Ok(Record::Message { header, data }) => {
                let topic = topics[&header.channel_id].clone();
                messages.push((topic, header.sequence, header.log_time, data.to_vec()));
            }
            Ok(_) => {}
            Err(_) => break,
        }
    }
    messages
}

#[test]
fn a_compression_that_is_not_read_is_an_error_and_no_damage() {
    let scratch = Scratch::new();
    let (path, whole) = (scratch.path("zstd.mcap"), scratch.path("recovered.mcap"));
    let (bytes, _) = recording(&scratch, RobotKind::Fr3);
    let mut file = bytes;
    // Its first chunk, with the name of another tool's compression.
    let at = file
        .windows(7)
        .position(|part| part == b"\x03\0\0\0lz4")
        .unwrap();
    file.splice(at..at + 7, *b"\x04\0\0\0zstd");
    let length = file[at - 36..at - 28]
        .try_into()
        .map(u64::from_le_bytes)
        .unwrap();
    file[at - 36..at - 28].copy_from_slice(&(length + 1).to_le_bytes());
    std::fs::write(&path, &file).unwrap();
    let recording = Recording::open(&path).unwrap();
    let error = recording
        .robot("")
        .unwrap()
        .cycles()
        .find_map(Result::err)
        .unwrap();
    let offset = at - 37;
    assert_eq!(
        error.to_string(),
        format!(
            "the chunk at byte {offset} is compressed with \"zstd\"; expected \"lz4\" or no compression"
        )
    );
    let error = Recording::recover(&path, &whole).unwrap_err();
    assert!(
        matches!(error, RecordingError::Compression { .. }),
        "{error}"
    );
    assert!(!whole.exists());
}

#[test]
fn a_file_of_another_kind_is_refused_with_what_it_begins_with() {
    let error = Recording::from_bytes(b"PK\x03\x04 and more".to_vec()).unwrap_err();
    assert!(error.to_string().contains("50, 4b"), "{error}");
    let error = Recording::from_bytes(Vec::new()).unwrap_err();
    assert!(matches!(error, RecordingError::NotMcap { .. }), "{error}");
    let error = Recording::open("/nowhere/run.mcap").unwrap_err();
    assert!(matches!(error, RecordingError::File { .. }), "{error}");
}

#[test]
fn mcap_files_of_other_programs_are_no_recordings() {
    let scratch = Scratch::new();
    let bag = |library: &str, profile: &str| {
        let path = scratch.path("bag.mcap");
        let options = mcap::WriteOptions::new().library(library).profile(profile);
        let file = std::fs::File::create(&path).unwrap();
        let mut writer = options.create(std::io::BufWriter::new(file)).unwrap();
        let metadata = mcap::records::Metadata {
            name: "rosbag2".to_owned(),
            metadata: BTreeMap::from([("serialized_metadata".to_owned(), "version: 5".to_owned())]),
        };
        writer.write_metadata(&metadata).unwrap();
        let channel = writer.add_channel(0, "/joint_states", "cdr", &BTreeMap::new());
        let header = mcap::records::MessageHeader {
            channel_id: channel.unwrap(),
            sequence: 0,
            log_time: 1,
            publish_time: 1,
        };
        writer.write_to_known_channel(&header, &[0; 64]).unwrap();
        writer.finish().unwrap();
        path
    };
    let refused = |path: &Path| {
        let error = Recording::open(path).unwrap_err();
        assert!(matches!(error, RecordingError::Foreign { .. }), "{error}");
        error.to_string()
    };
    let path = bag("libmcap 0.8.0", "ros2");
    let text = refused(&path);
    assert!(text.contains("not a recording of this program"), "{text}");
    assert!(
        text.contains("\"libmcap 0.8.0\" with the profile \"ros2\""),
        "{text}"
    );
    // A bag that is still being written, or was truncated.
    let bytes = std::fs::read(&path).unwrap();
    let cut = scratch.path("cut.mcap");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(refused(&cut), text);
    // The recovered file is not a recording either.
    let recovered = scratch.path("recovered.mcap");
    Recording::recover(&path, &recovered).unwrap();
    let text = refused(&recovered);
    assert!(text.contains("no description of a robot"), "{text}");
    let text = refused(&bag("", ""));
    assert!(
        text.contains("does not name the program that wrote it"),
        "{text}"
    );
    // A very long name is not shown.
    let text = refused(&bag(&"long ".repeat(1000), ""));
    assert!(text.len() < 200, "{text}");
}

#[test]
fn cassettes_are_no_recordings_but_called_cassettes() {
    let cassette = Cassette::default().to_bytes().unwrap();
    let error = Recording::from_bytes(cassette).unwrap_err();
    assert!(matches!(error, RecordingError::Foreign { .. }), "{error}");
    assert!(error.to_string().contains("`franka cassette`"), "{error}");
}

#[test]
fn flushed_data_of_a_killed_program_is_readable() {
    if let Some(path) = std::env::var_os(CHILD) {
        record_for_ever(Path::new(&path));
    }
    let scratch = Scratch::new();
    let path = scratch.path("killed.mcap");
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "damaged::flushed_data_of_a_killed_program_is_readable",
        ])
        .env(CHILD, &path)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let patience = Instant::now() + Duration::from_secs(60);
    while std::fs::metadata(&path).map_or(0, |file| file.len()) < 1_000_000 {
        assert!(Instant::now() < patience, "nothing was recorded");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();

    let recording = Recording::open(&path).unwrap();
    assert!(recording.damage().is_some());
    let robot = recording.robot("").unwrap();
    let times: Vec<_> = robot
        .cycles()
        .map(|cycle| cycle.unwrap().record.time)
        .collect();
    assert!(times.len() > 1000, "{}", times.len());
    assert_eq!(times, (1..=times.len() as u64).collect::<Vec<_>>());
}

/// Records until the test kills the process.
fn record_for_ever(path: &Path) -> ! {
    let recorder = Recorder::to_file(path, RecordOptions::default()).unwrap();
    let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    loop {
        arm.run(&recorder, 1000);
    }
}

/// Number of cycles of the recording.
const CYCLES: usize = 500;

/// Environment variable with the file that the child process writes until the test kills it.
const CHILD: &str = "FRANKA_RECORD_CHILD";

#[test]
fn any_bytes_are_read_without_a_panic() {
    let mut random = SmallRng::seed_from_u64(21);
    for (name, seed) in any_bytes::seeds() {
        let recording = Recording::from_bytes(seed.clone()).unwrap();
        assert_eq!(recording.damage(), None, "{name}");
        let robot = recording.robot("").unwrap();
        assert_eq!((robot.cycles().count(), robot.events().count()), (1, 1));
        for _ in 0..5000 {
            let mut bytes = seed.clone();
            // The index at the end has a checksum: if it is wrong, the chunks are scanned.
            if random.random_bool(0.5) {
                bytes.truncate(random.random_range(8..bytes.len()));
            }
            for _ in 0..random.random_range(1..6) {
                let at = random.random_range(8..bytes.len().max(9));
                let Some(byte) = bytes.get_mut(at) else {
                    continue;
                };
                *byte = match random.random_range(0..4) {
                    0 => 0,
                    1 => 0xff,
                    2 => random.random(),
                    _ => *byte ^ (1 << random.random_range(0..8)),
                };
            }
            any_bytes::read(&bytes);
        }
    }
}
