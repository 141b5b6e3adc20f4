//! The text for every status byte of every command, in both versions.

use franka_proto::framing::{Header, Message};
use franka_proto::{Command, MoveStatus, Refusal, Reply, RobotMode, Status, Version};

/// The texts after `libfranka: `, by status byte. The text of a success is empty. The byte after
/// the last text is undefined.
type Texts = &'static [&'static str];

/// Returns a reply that is long enough for every command.
fn reply(version: Version, command: Command, status: u8) -> Result<Option<String>, String> {
    let payload = [&[status][..], &[0; 200]].concat();
    let header = Header {
        command: version.command_number(command).expect("it has it"),
        command_id: 1,
        size: (Header::SIZE + payload.len()) as u32,
    };
    let message = Message {
        header,
        payload: &payload,
    };
    let reply = Reply::decode(version, command, &message).map_err(|error| error.to_string())?;
    let refusal = Refusal::from_reply(command, &reply, RobotMode::Guiding);
    Ok(refusal.map(|refusal| refusal.to_string()))
}

/// Checks the texts of `command`, and the text of the byte after the last.
fn check(version: Version, command: Command, texts: Texts, unknown: &str) {
    for (status, text) in (0..).zip(texts) {
        let expected = (!text.is_empty()).then(|| format!("libfranka: {text}"));
        let got = reply(version, command, status);
        assert_eq!(got, Ok(expected), "{command}, {version}, {status}");
    }
    for status in [texts.len() as u8, 0xff] {
        let expected = Err(format!("libfranka: {unknown}"));
        let got = reply(version, command, status);
        assert_eq!(got, expected, "{command}, {version}, {status}");
    }
}

#[test]
fn move_statuses_have_their_texts() {
    let unknown = "Unexpected response while handling Move command!";
    check(Version::V10, Command::Move, MOVE_V10, unknown);
    check(Version::V5, Command::Move, MOVE_V5, unknown);
}

#[test]
fn stop_statuses_have_their_texts() {
    let unknown = "Unexpected response while handling Stop Move command!";
    check(Version::V10, Command::StopMove, STOP_V10, unknown);
    check(Version::V5, Command::StopMove, STOP_V5, unknown);
}

#[test]
fn recovery_statuses_have_their_texts() {
    let unknown = "Unexpected response while handling Automatic Error Recovery command!";
    let command = Command::AutomaticErrorRecovery;
    check(Version::V10, command, RECOVERY_V10, unknown);
    check(Version::V5, command, RECOVERY_V5, unknown);
}

#[test]
fn setter_statuses_have_their_texts() {
    for (command, name) in SETTERS {
        for version in Version::ALL {
            if !version.supports(command) {
                continue;
            }
            // Protocol 10 has a status for safety functions.
            let statuses = if version == Version::V10 { 4 } else { 3 };
            for (status, text) in (0..).zip(&SETTER[..statuses]) {
                let expected = (!text.is_empty()).then(|| format!("libfranka: {name}{text}"));
                let got = reply(version, command, status);
                assert_eq!(got, Ok(expected), "{name}, {version}, {status}");
            }
            let unknown = format!("libfranka: Unexpected response while handling {name} command!");
            assert_eq!(reply(version, command, statuses as u8), Err(unknown));
        }
    }
}

#[test]
fn model_statuses_have_their_texts() {
    let unknown = "Unexpected response while handling Get Robot Model command!";
    check(Version::V10, Command::GetRobotModel, MODEL, unknown);
    // Every status except success causes this error, including an undefined byte.
    let error = LIBRARY[1];
    check(Version::V5, Command::LoadModelLibrary, LIBRARY, error);
}

#[test]
fn not_possible_in_each_mode() {
    let status = Status::Move(MoveStatus::CommandNotPossibleRejected);
    for (mode, ending) in [
        (RobotMode::Other, "(\"Other\")! Did you open the brakes?"),
        (RobotMode::Idle, "(\"Idle\")!"),
        (RobotMode::Move, "(\"Move\")!"),
        (RobotMode::Guiding, "(\"Guiding\")!"),
        (RobotMode::Reflex, "(\"Reflex\")!"),
        (RobotMode::UserStopped, "(\"User stopped\")!"),
        (
            RobotMode::AutomaticErrorRecovery,
            "(\"Automatic error recovery\")!",
        ),
    ] {
        let refusal = Refusal::new(Command::Move, status, mode).expect("no success");
        let begin = "libfranka: Move command rejected: command not possible in the current mode ";
        assert_eq!(refusal.to_string(), format!("{begin}{ending}"));
    }
}

const MOVE_V10: Texts = &[
    "",
    "",
    "Move command preempted!",
    "Move command preempted due to activated safety function! Please disable all safety functions.",
    "Move command rejected due to activated safety function! Please disable all safety functions.",
    "Move command rejected: command not possible in the current mode (\"Guiding\")!",
    "Move command rejected: cannot start at singular pose!",
    "Move command rejected: maximum path deviation out of range!",
    "Move command aborted: motion aborted by reflex!",
    "Move command aborted: User Stop pressed!",
    "Move command aborted: invalid input provided!",
    "Move command aborted!",
];

const MOVE_V5: Texts = &[
    "",
    "",
    "Move command preempted!",
    "Move command rejected: command not possible in the current mode (\"Guiding\")!",
    "Move command rejected: cannot start at singular pose!",
    "Move command rejected: maximum path deviation out of range!",
    "Move command aborted: motion aborted by reflex!",
    "Move command aborted: User Stop pressed!",
    "Move command aborted: invalid input provided!",
    "Move command aborted!",
];

/// "Aborted" has the same text as "not possible", and the text of a safety function names `Move`.
const STOP_V10: Texts = &[
    "",
    "Stop Move command rejected: command not possible in the current mode (\"Guiding\")!",
    "Move command rejected due to activated safety function! Please disable all safety functions.",
    "Stop Move command aborted: User Stop pressed!",
    "Stop Move command aborted: motion aborted by reflex!",
    "Stop Move command rejected: command not possible in the current mode (\"Guiding\")!",
];

const STOP_V5: Texts = &[
    "",
    "Stop Move command rejected: command not possible in the current mode (\"Guiding\")!",
    "Stop Move command aborted: User Stop pressed!",
    "Stop Move command aborted: motion aborted by reflex!",
    "Stop Move command rejected: command not possible in the current mode (\"Guiding\")!",
];

const RECOVERY_V10: Texts = &[
    "",
    "Automatic Error Recovery command rejected: command not possible in the current mode (\"Guiding\")!",
    "Move command rejected due to activated safety function! Please disable all safety functions.",
    "Automatic Error Recovery command rejected: manual error recovery required!",
    "Automatic Error Recovery command aborted: motion aborted by reflex!",
    "Automatic Error Recovery command aborted: User Stop pressed!",
    "Automatic Error Recovery command aborted!",
];

const RECOVERY_V5: Texts = &[
    "",
    "Automatic Error Recovery command rejected: command not possible in the current mode (\"Guiding\")!",
    "Automatic Error Recovery command rejected: manual error recovery required!",
    "Automatic Error Recovery command aborted: motion aborted by reflex!",
    "Automatic Error Recovery command aborted: User Stop pressed!",
    "Automatic Error Recovery command aborted!",
];

const MODEL: Texts = &[
    "",
    "Get Robot Model command rejected: command not possible in the current mode (\"Guiding\")!",
    "Get Robot Model command rejected due to activated safety function! Please disable all safety functions.",
];

const LIBRARY: Texts = &["", "Server reports error when loading model library."];

const SETTERS: [(Command, &str); 9] = [
    (Command::SetCollisionBehavior, "Set Collision Behavior"),
    (Command::SetJointImpedance, "Set Joint Impedance"),
    (Command::SetCartesianImpedance, "Set Cartesian Impedance"),
    (Command::SetGuidingMode, "Set Guiding Mode"),
    (Command::SetEEToK, "Set EE to K"),
    (Command::SetNEToEE, "Set NE to EE"),
    (Command::SetLoad, "Set Load"),
    (Command::SetFilters, "Set Filters"),
    (Command::GetCartesianLimit, "Get Cartesian Limit"),
];

/// The texts after the command's name; the last ends in a space.
const SETTER: [&str; 4] = [
    "",
    " command rejected: command not possible in the current mode (\"Guiding\")!",
    " command rejected: invalid argument!",
    " command rejected due to activated safety function! Please disable all safety functions. ",
];
