//! Recordings read by the standard reader in Python, and a function to run scripts.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use franka_model::RobotKind;
use franka_proto::gripper;
use franka_record::recorder::{Recorder, Robot};
use franka_record::{GripperState, Recording};

use crate::feed::{Arm, Scratch, quick};

#[test]
#[ignore = "needs Python with mcap: `cargo xtask check --only recordings` has it"]
fn python_decodes_every_message_of_both_robots() {
    let scratch = Scratch::new();
    let mut paths = Vec::new();
    for kind in RobotKind::ALL {
        let path = scratch.path(&format!("{kind:?}.mcap"));
        let recorder = Recorder::to_file(&path, quick()).unwrap();
        let mut robot = Robot::new(kind);
        robot.urdf = Some("<robot name=\"made up\"/>".to_owned());
        let (mut arm, handle) = Arm::attach(&recorder, robot);
        handle.note("begun");
        handle.gripper(GripperState::Hand(gripper::State::default()));
        arm.run(&recorder, CYCLES);
        recorder.finish().unwrap();
        paths.push(path);
    }
    // A truncated and recovered file is like any other.
    let bytes = std::fs::read(&paths[0]).unwrap();
    let cut = scratch.path("cut.mcap");
    std::fs::write(&cut, &bytes[..bytes.len() - 40]).unwrap();
    let recovered = scratch.path("recovered.mcap");
    let recovery = Recording::recover(&cut, &recovered).unwrap();
    assert!(recovery.damage.is_some());
    paths.push(recovered);

    let mut arguments = vec![CYCLES.to_string().into()];
    arguments.extend(paths.iter().map(OsString::from));
    let said = python("decode.py", PYTHON, &arguments);
    assert_eq!(said.matches("ok ").count(), paths.len(), "{said}");
}

/// Runs a script of `tests/python` with the interpreter in the environment variable `variable`, and
/// returns its output.
pub(crate) fn python(script: &str, variable: &str, arguments: &[OsString]) -> String {
    let interpreter = std::env::var_os(variable).expect("the interpreter is named");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python");
    let mut command = Command::new(interpreter);
    command.arg(folder.join(script)).args(arguments);
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}{errors}");
    print!("{said}");
    said
}

const CYCLES: u64 = 5000;

/// Environment variable with the path of the interpreter that has the packages.
pub(crate) const PYTHON: &str = "FRANKA_RECORD_PYTHON";
