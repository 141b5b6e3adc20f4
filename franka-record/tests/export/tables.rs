//! Tables of synthetic cycles: text and Parquet.

use std::fs::{self, File};
use std::io;
use std::process::Command;
use std::time::Duration;

use franka_record::export::{Columns, ExportError, NewFile, write_csv, write_parquet};
use franka_record::{Cycle, HostTime};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::{Value, json};

fn cycle(millisecond: u64) -> Cycle {
    let mut cycle = Cycle {
        time: HostTime::from_nanos(1_000_000 * millisecond),
        ..Cycle::default()
    };
    cycle.state.message_id = 70 + millisecond;
    cycle.state.q = [0.25 * millisecond as f64; 7];
    cycle.state.O_T_EE[12] = 0.5;
    cycle.record.goal = millisecond;
    cycle
}

fn columns() -> Columns {
    Columns::named(["q", "goal", "activity", "slack", "O_T_EE", "q"]).unwrap()
}

#[test]
fn text_has_names_units_and_a_line_for_each_cycle() {
    let mut text = Vec::new();
    let cycles = (0..3).map(|k| Ok::<_, io::Error>(cycle(k)));
    assert_eq!(write_csv(cycles, &columns(), true, &mut text).unwrap(), 3);
    let text = String::from_utf8(text).unwrap();
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 5);
    assert!(lines[0].starts_with("# ms,ns,rad,rad,"), "{}", lines[0]);
    assert!(lines[0].contains("\"number of the goal, 0 without one\""));
    assert!(lines[1].starts_with("time,host_time,q[0],q[1],"));
    assert!(lines[1].contains(",q[6],goal,activity,slack,O_T_EE[0],"));
    // A matrix by rows: x of the position is the fourth number. The slack is missing.
    let q = ",0.5".repeat(7);
    let begin = format!("72,2000000{q},2,watching,,1,0,0,0.5,0,1,0,");
    assert!(lines[4].starts_with(&begin), "{}", lines[4]);
    let fields = |line: &str| line.split(',').count();
    assert_eq!(fields(lines[1]), 2 + 7 + 3 + 16);
    assert_eq!(fields(lines[4]), fields(lines[1]));
}

#[test]
fn a_table_has_lists_texts_and_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cycles.parquet");
    let cycles = || (0..1000).map(|k| Ok::<_, io::Error>(cycle(k)));
    assert_eq!(write_parquet(cycles(), &columns(), &path).unwrap(), 1000);
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    let notes = reader.metadata().file_metadata().key_value_metadata();
    let units = notes.unwrap().iter().find(|it| it.key == "units").unwrap();
    let units: Value = serde_json::from_str(units.value.as_ref().unwrap()).unwrap();
    assert_eq!((&units["q"], &units["time"]), (&json!("rad"), &json!("ms")));
    let rows: Vec<_> = reader
        .get_row_iter(None)
        .unwrap()
        .collect::<Result<_, _>>()
        .unwrap();
    assert_eq!(rows.len(), 1000);
    let row: Vec<_> = rows[4].get_column_iter().collect();
    assert_eq!(row[0], (&"time".to_owned(), &Field::Long(74)));
    assert_eq!(*row[1].1, Field::Long(4_000_000));
    assert_eq!(row[2].1.to_string(), "[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]");
    assert_eq!(*row[3].1, Field::Long(4));
    assert_eq!(*row[4].1, Field::Str("watching".into()));
}

#[test]
fn tables_replace_no_file_and_leave_none_when_they_fail() {
    let folder = tempfile::tempdir().unwrap();
    let names = || {
        let entries = fs::read_dir(folder.path()).unwrap();
        let mut names: Vec<_> = entries.map(|it| it.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let path = folder.path().join("cycles.parquet");
    let cycles = || (0..1000).map(|k| Ok::<_, io::Error>(cycle(k)));
    let broken = cycles().chain([Err(io::ErrorKind::UnexpectedEof.into())]);
    assert!(write_parquet(broken, &columns(), &path).is_err());
    assert_eq!(names(), [] as [&str; 0]);
    fs::write(&path, "of somebody").unwrap();
    let error = write_parquet(cycles(), &columns(), &path).unwrap_err();
    assert!(matches!(error, ExportError::Exists { .. }), "{error}");
    let error = NewFile::create(&path).unwrap_err();
    assert!(matches!(error, ExportError::Exists { .. }), "{error}");
    // Another program was faster.
    let mut late = NewFile::create(folder.path().join("late.csv")).unwrap();
    write_csv(cycles(), &columns(), true, &mut late).unwrap();
    fs::write(folder.path().join("late.csv"), "of somebody").unwrap();
    let error = late.finish().unwrap_err();
    assert!(matches!(error, ExportError::Exists { .. }), "{error}");
    assert_eq!(names(), ["cycles.parquet", "late.csv"]);
    for name in names() {
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!(text, "of somebody");
    }
    let missing = NewFile::create(folder.path().join("none/run.csv")).unwrap_err();
    let text = missing.to_string();
    assert!(text.contains("none/run.csv: No such file"), "{text}");
    assert!(!text.contains(".partial"), "{text}");
}

/// A child process of the test writes to the file until the test kills it.
#[test]
fn tables_that_were_interrupted_are_in_no_later_ones_way() {
    const TO: &str = "FRANKA_RECORD_TEST_TABLE";
    let endless = || (0..).map(|k| Ok::<_, io::Error>(cycle(k % 1000)));
    if let Some(path) = std::env::var_os(TO) {
        write_parquet(endless(), &columns(), path).unwrap();
        unreachable!("it is endless");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cycles.parquet");
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "tables::tables_that_were_interrupted_are_in_no_later_ones_way",
        ])
        .env(TO, &path)
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    while fs::read_dir(folder.path()).unwrap().next().is_none() {
        assert!(child.try_wait().unwrap().is_none(), "it has ended");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!path.exists());
    let cycles = (0..10).map(|k| Ok::<_, io::Error>(cycle(k)));
    assert_eq!(write_parquet(cycles, &columns(), &path).unwrap(), 10);
}

#[test]
fn unknown_column_is_refused_with_the_known_ones() {
    let error = Columns::named(["q", "tau_j"]).unwrap_err();
    assert_eq!(error.got, "tau_j");
    assert!(error.to_string().contains("tau_J, "), "{error}");
}
