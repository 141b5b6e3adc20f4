//! Tables of every generation, exception texts, and the errors of invalid tables and texts.

use franka_model::Model;
use franka_proto::{ControllerMode, MotionGeneratorMode, RobotCommand, RobotError, RobotState};
use franka_rt::driver::{ControlLog, LogEntry};

use super::*;
use crate::explain::Explanation;
use crate::export::{Columns, write_csv};

/// Returns the table of a joint velocity motion whose last command jumps.
fn table() -> String {
    let entry = |time: u64| {
        let speed = 0.001 * (time - 1000) as f64;
        let state = RobotState {
            message_id: time,
            q: [0.1, -0.7, 0.0, -2.35, 0.25, 1.57, 0.78],
            q_d: [0.1, -0.7, 0.0, -2.35, 0.25, 1.57, 0.78],
            dq_d: [speed; 7],
            control_command_success_rate: if time == 1005 { 0.0 } else { 0.98 },
            ..RobotState::default()
        };
        let command = RobotCommand {
            dq_c: match time {
                1000 => [0.0; 7],
                1005 => [0.9; 7],
                _ => [speed; 7],
            },
            ..RobotCommand::default()
        };
        LogEntry::new(state, command)
    };
    ControlLog::from_iter((1000..=1005).map(entry)).to_csv()
}

/// Returns the same table in the format of older versions.
fn older(table: &str, generation: Generation) -> String {
    let (names, rows) = table.split_once('\n').expect("a header");
    let spaced = |names: &str| {
        // Spaces within a vector, and after the first two names.
        let mut text = names.replace("time,success_rate,", "time, success_rate, ");
        for index in 0..16 {
            text = text.replace(
                &format!("[{index}],"),
                &match names.contains(&format!("[{}],", index + 1)) {
                    _ if index == 6 => format!("[{index}],"),
                    _ => format!("[{index}], "),
                },
            );
        }
        text
    };
    match generation {
        Generation::Compact => table.to_owned(),
        Generation::Spaced => format!("{}\n{rows}", spaced(names)),
        Generation::Unprefixed => {
            let names = spaced(names)
                .replace("time, success_rate", "duration, success rate")
                .replace("state.", "")
                .replacen("cmd.", "sent commands,cmd.", 1)
                .replace("cmd.", "");
            let cells = 2 + 6 * 7;
            let rows = rows.lines().map(|row| {
                let at = row.match_indices(',').nth(cells - 1).expect("commands").0;
                format!("{},{}\n", &row[..at], &row[at..])
            });
            format!("{names}\n{}", rows.collect::<String>())
        }
    }
}

const MESSAGE: &str = "libfranka: Move command aborted: motion aborted by reflex! \
                       [\"joint_motion_generator_acceleration_discontinuity\", \"joint_reflex\"]\n\
                       control_command_success_rate: 0.98 packets lost in a row in the last \
                       sample: 3";

#[test]
fn every_generation_of_columns_is_read() {
    let expected = ControlLogFile::parse(&table()).unwrap();
    assert_eq!(expected.generation, Some(Generation::Compact));
    assert_eq!((expected.log.len(), expected.earlier), (6, 0));
    for generation in [Generation::Unprefixed, Generation::Spaced] {
        let text = older(&table(), generation);
        let file = ControlLogFile::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(file.generation, Some(generation));
        assert_eq!(file.log, expected.log);
        let fer = generation == Generation::Unprefixed;
        assert_eq!(file.kind(), fer.then_some(RobotKind::Fer));
    }
}

/// The table has line ends of Windows, quotes of a spreadsheet, columns in another order, and
/// additional columns.
#[test]
fn a_table_that_another_program_has_written_anew_is_read() {
    let expected = ControlLogFile::parse(&table()).unwrap();
    let anew = |line: &str| {
        let cells: Vec<_> = line.split(',').collect();
        let (first, rest) = cells.split_at(2);
        let rest = rest.iter().rev().map(|cell| format!("\"{cell}\""));
        let cells = first.iter().map(|&cell| cell.to_owned());
        let cells = cells.chain(["\"more, or less\"".to_owned()]).chain(rest);
        cells.collect::<Vec<_>>().join(",") + "\r\n"
    };
    let text: String = table().lines().map(anew).collect();
    let text = format!("\u{feff}{text}");
    let file = ControlLogFile::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(file.log, expected.log);
}

#[test]
fn values_missing_from_a_table_follow_from_its_rows() {
    let file = ControlLogFile::parse(&format!("{MESSAGE}\n{}", table())).unwrap();
    let entries: Vec<_> = file.log.iter().collect();
    let (last, running) = entries.split_last().unwrap();
    assert_eq!(running[0].command.message_id, 0, "no command came before");
    for pair in entries.windows(2) {
        assert_eq!(pair[1].command.message_id, pair[0].state.message_id);
    }
    for entry in &running[1..] {
        let state = &entry.state;
        let generator = MotionGeneratorMode::JointVelocity;
        assert_eq!(state.motion_generator_mode, generator);
        assert_eq!(state.controller_mode, ControllerMode::JointImpedance);
        assert!((state.ddq_d[3] - 1.0).abs() < 1e-6, "{}", state.ddq_d[3]);
    }
    assert!(!last.state.motion_running());
    assert!(last.state.reflex_reason.contains(RobotError::JointReflex));
}

#[test]
fn the_message_is_found_between_other_lines() {
    let message = MESSAGE.replace(", \"joint_reflex", ",\n   \"joint_reflex");
    let wrapped = format!(
        "[ros2_control_node-2] terminate called after throwing 'franka::ControlException'\n\
         [ros2_control_node-2]   what():  {message}\nAborted (core dumped)\n"
    );
    let text = format!("{MESSAGE}\n{wrapped}\n\n{}\nthe end\n", table());
    let file = ControlLogFile::parse(&text).unwrap();
    let message = file.message.as_ref().expect("a message");
    let text = "libfranka: Move command aborted: motion aborted by reflex!";
    assert_eq!(message.text, text);
    assert_eq!(message.errors.len(), 2);
    let rate = message.success_rate.expect("a rate");
    assert_eq!((rate.rate, rate.lost), (0.98, 3));
    assert_eq!((file.earlier, file.log.len()), (1, 6));
    // A JSON log.
    let escaped = format!("{{\"msg\": \"{}\"}}", MESSAGE.replace('"', "\\\""));
    let errors = ControlLogFile::parse(&escaped).unwrap().errors();
    assert_eq!(errors, file.errors());
}

#[test]
fn a_message_alone_is_explained() {
    let file = ControlLogFile::parse(MESSAGE).unwrap();
    let text = Explanation::of_control_log(&file, Model::fr3()).to_string();
    let first = "the log has no cycle of the motion\njoint_motion_generator_acceleration_disc";
    assert!(text.starts_with(first), "{text}");
    assert!(text.contains("other errors: joint_reflex"), "{text}");
    assert!(text.contains("success_rate: 0.98 packets lost"), "{text}");
    // The text of a user stop, not of a reflex.
    let stop = "terminate: libfranka: Move command aborted: User Stop pressed!";
    let file = ControlLogFile::parse(stop).unwrap();
    let text = Explanation::of_control_log(&file, Model::fr3()).to_string();
    assert!(text.contains("aborted: User Stop pressed!"), "{text}");
}

#[test]
fn a_table_without_its_message_says_that_the_errors_are_missing() {
    let file = ControlLogFile::parse(&table()).unwrap();
    let explanation = Explanation::of_control_log(&file, Model::fr3());
    let text = explanation.to_string();
    assert!(text.contains("does not name the errors"), "{text}");
    let error = RobotError::JointMotionGeneratorAccelerationDiscontinuity;
    let file = file.with_errors(error.into());
    let text = Explanation::of_control_log(&file, Model::fr3()).to_string();
    assert!(text.contains("commanded acceleration 89"), "{text}");
    assert!(text.contains("since cycle 1004 ms"), "{text}");
}

#[test]
fn file_fault_is_reported_with_line_and_column() {
    let row = |from: &str, to: &str| table().replacen(from, to, 1);
    let cut = |text: &str, end: &str| text[..text.find(end).unwrap() + end.len()].to_owned();
    let lines: Vec<_> = table().lines().map(str::to_owned).collect();
    for (text, expected) in [
        (
            String::new(),
            "got \"\", expected a recording (MCAP); a table",
        ),
        (
            "q,dq\n1,2\n".into(),
            "got \"q,dq\", expected a recording (MCAP)",
        ),
        (
            row("1002,0.98,0.1,-0.7", "1002,0.98,0.1,x"),
            "line 4, column 4 (state.q[1]): got \"x\", expected a number",
        ),
        (
            row("1003,0.98", "1003.5,0.98"),
            "line 5, column 1 (time): got \"1003.5\", expected whole milliseconds",
        ),
        (
            row("1003,0.98", "1001,0.98"),
            "line 5, column 1 (time): got \"1001\", expected a time after 1002 ms",
        ),
        (
            row("1003,0.98", "1003,high"),
            "line 5, column 2 (success_rate): got \"high\", expected a success rate, 0 to 1",
        ),
        (
            cut(&table(), "\n1004,0.98,0.1"),
            "line 6, column 4: got a row of 3 cells, expected 87: the file ends too early",
        ),
        (
            cut(&table(), "\n10"),
            "line 2, column 2: got a row of 1 cells, expected 87: the file ends too early",
        ),
        (
            row("1002,0.98,", "1002,0.98,0,"),
            "line 4, column 88: got a row of 88 cells, expected 87",
        ),
        (
            row("state.dq[3]", "speed"),
            "line 1: got 87 columns without \"state.dq[3]\", expected the columns of \
             franka::logToCSV",
        ),
        (
            format!("a note\n\n{}\n", lines[0]),
            "line 3: got a table without rows, expected a row for each cycle",
        ),
        (
            format!(
                "an error:\n{}",
                cut(MESSAGE, "[\"joint_motion_generator_acc")
            ),
            "line 2, column 62: got \"joint_motion_generator_acc\", expected the name of one of",
        ),
        (
            cut(MESSAGE, "discontinuity\","),
            "line 1, column 113: got \"the end of the text\", expected a name in quotes",
        ),
        (
            cut(MESSAGE, "reflex!"),
            "line 1, column 59: got \"the end of the text\", expected a list of errors",
        ),
        (
            MESSAGE.replace("0.98", "high"),
            "line 2, column 31: got \"high packets lost in a row",
        ),
    ] {
        let error = ControlLogFile::parse(&text).expect_err(expected);
        let error = error.to_string();
        assert!(error.starts_with(expected), "{error}\nnot: {expected}");
    }
}

#[test]
fn no_text_makes_the_reader_panic() {
    use rand::{Rng, SeedableRng};
    let whole = format!("{MESSAGE}\n{}", table());
    let mut random = rand::rngs::SmallRng::seed_from_u64(54);
    for _ in 0..300 {
        let mut bytes = whole.clone().into_bytes();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(0..bytes.len());
            match random.random_range(0..3) {
                0 => bytes.truncate(at.max(1)),
                1 => bytes[at] = b"\n,\"]0e-x\xc3 "[random.random_range(0..10)],
                _ => drop(bytes.splice(at..at, *b"\n9,")),
            }
        }
        if let Ok(file) = ControlLogFile::parse(&String::from_utf8_lossy(&bytes)) {
            let _ = Explanation::of_control_log(&file, Model::fr3()).to_string();
        }
    }
}

#[test]
fn a_log_is_exported_with_the_commands_that_answer_its_states() {
    let file = ControlLogFile::parse(&table()).unwrap();
    let columns = Columns::of_log();
    let columns = columns.choose(["dq_d", "dq_ref"]).unwrap();
    let mut csv = Vec::new();
    let cycles = file.cycles().map(Ok::<_, std::convert::Infallible>);
    assert_eq!(write_csv(cycles, &columns, false, &mut csv).unwrap(), 6);
    let csv = String::from_utf8(csv).unwrap();
    let row = csv.lines().find(|row| row.starts_with("1004,")).unwrap();
    let cells: Vec<_> = row.split(',').collect();
    assert_eq!((cells[2], cells[9]), ("0.004", "0.9"), "{row}");
    assert!(columns.choose(["tau_J"]).is_err());
    assert!(Columns::of_log().choose(["theta"]).is_err());
}
