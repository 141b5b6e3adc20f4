//! A robot's answer to the handshake, which shows its version and its availability.

use core::time::Duration;
use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpStream, UdpSocket};
use std::time::Instant;

use franka_proto::client::{Event, Session};
use franka_proto::framing::next_message_within;
use franka_proto::{IncompatibleVersion, Protocol as _, Version};

use crate::finding::{About, Finding, Judged, Purpose};

/// Result of an attempt to open a session with a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Answer {
    /// The robot opened a session with this version.
    Accepted(Version),
    /// The robot supports a version other than the announced version.
    Incompatible(IncompatibleVersion),
    /// The robot closed the connection without an answer.
    Closed,
    /// No connection was possible, or no valid answer came in time. The text describes what
    /// happened.
    Missing(String),
}

/// Opens a session with the robot at `address`, and closes the session immediately. If the robot
/// reports an older version that is supported, this function opens another session with that
/// version. It sends no other commands. Each connection and each answer may take 1 s.
///
/// The robot sends states until the session is closed, and accepts only one client at a time. Call
/// this function only if the user asked for a connection to the robot.
pub fn answers(address: SocketAddr) -> Vec<Answer> {
    let first = ask(address, NEWEST, TIMEOUT);
    let older = match &first {
        Answer::Incompatible(refusal) => Version::from_number(refusal.server_version),
        _ => None,
    };
    let older = older.filter(|version| *version != NEWEST);
    let second = older.map(|version| ask(address, version, TIMEOUT));
    [Some(first), second].into_iter().flatten().collect()
}

/// Returns the findings about the answers of a robot (`robot.version` and `robot.busy`). `answers`
/// must be in the order of the sessions. This function performs no I/O.
pub fn handshake(answers: &[Answer], purpose: Purpose) -> Vec<Finding> {
    let speaks = About::robot(
        "robot.version",
        "version 10 (Franka Research 3, system 5.9.0 or later) or 5 (Franka Emika Robot, system 4.2.1 or later)",
        "The robot's system determines its protocol version; the robot refuses other versions.",
        "vendor: table of compatible versions, libfranka 0.21",
    );
    let is_free = About::robot(
        "robot.busy",
        "the robot opens a session",
        "A robot takes one client at a time.",
        "vendor: FCI documentation; how a robot refuses a second client was not seen on an arm",
    );
    vec![
        speaks.finding(Ok(version(answers)), purpose),
        is_free.finding(Ok(busy(answers)), purpose),
    ]
}

fn version(answers: &[Answer]) -> Judged {
    let named = answers.iter().find_map(|answer| match answer {
        Answer::Accepted(version) => Some(version.number()),
        Answer::Incompatible(refusal) => Some(refusal.server_version),
        Answer::Closed | Answer::Missing(_) => None,
    });
    let Some(number) = named else {
        return unanswered(answers);
    };
    let Some(device) = Version::field(number) else {
        return Judged::failure(format!(
            "version {number}, which this driver does not support"
        ));
    };
    let read = format!(
        "version {number}, for a {} with system {}",
        device.name, device.system
    );
    match device.update {
        None => Judged::good(read),
        Some(update) => Judged::failure(format!(
            "{read}: update the robot's system to {update} (Desk, Settings, System)"
        )),
    }
}

/// Judges whether the robot already has a client.
fn busy(answers: &[Answer]) -> Judged {
    match answers.last() {
        Some(Answer::Accepted(_)) => Judged::good("free: the robot opened a session"),
        Some(Answer::Closed) => Judged::warning(
            "the robot closed the connection without an answer: another client is probably connected",
        ),
        Some(Answer::Incompatible(_)) => {
            Judged::unknown("unknown: the robot refused the version before it opened a session")
        }
        Some(Answer::Missing(_)) | None => unanswered(answers),
    }
}

/// Returns the reason why the version and the availability are unknown.
fn unanswered(answers: &[Answer]) -> Judged {
    Judged::unknown(match answers.last() {
        Some(Answer::Missing(why)) => format!("unknown: {why}"),
        Some(_) => "unknown: the robot closed the connection without an answer".into(),
        None => "unknown: the robot was not asked".into(),
    })
}

/// Announces `version` on a new connection. The connection and the answer may take `timeout` each.
fn ask(address: SocketAddr, version: Version, timeout: Duration) -> Answer {
    let stream = match TcpStream::connect_timeout(&address, timeout) {
        Ok(stream) => stream,
        Err(error) => return Answer::Missing(format!("no connection to {address}: {error}")),
    };
    match session(stream, address, version, timeout) {
        Ok(answer) => answer,
        Err(error) => match error.kind() {
            io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::BrokenPipe => Answer::Closed,
            io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock => no_answer(timeout),
            _ => Answer::Missing(format!("the connection to {address}: {error}")),
        },
    }
}

/// Performs the handshake on `stream`, and closes the stream.
fn session(
    mut stream: TcpStream,
    address: SocketAddr,
    version: Version,
    timeout: Duration,
) -> io::Result<Answer> {
    // The robot sends its states to this socket, which is never read.
    let states = match address {
        SocketAddr::V4(_) => UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)),
        SocketAddr::V6(_) => UdpSocket::bind((Ipv6Addr::UNSPECIFIED, 0)),
    }?;
    let deadline = Instant::now() + timeout;
    let mut session = Session::<Version>::new(version);
    stream.set_write_timeout(Some(timeout))?;
    stream.write_all(session.connect(states.local_addr()?.port()).as_bytes())?;
    let mut received = Vec::new();
    let mut chunk = [0; 512];
    loop {
        match next_message_within(&received, ANSWER_MAX) {
            Err(error) => return Ok(Answer::Missing(error.to_string())),
            Ok(Some(message)) => {
                let size = message.size();
                match session.on_message(message) {
                    Err(violation) => return Ok(Answer::Missing(violation.to_string())),
                    Ok(Event::Connected { version }) => return Ok(Answer::Accepted(version)),
                    Ok(Event::Incompatible(refusal)) => return Ok(Answer::Incompatible(refusal)),
                    // This message answers another request, and the expected answer may still
                    // arrive.
                    Ok(_) => {}
                }
                received.drain(..size);
            }
            Ok(None) => {
                let remaining = deadline.saturating_duration_since(Instant::now());
                if remaining.is_zero() {
                    return Ok(no_answer(timeout));
                }
                stream.set_read_timeout(Some(remaining))?;
                match stream.read(&mut chunk)? {
                    0 => return Ok(Answer::Closed),
                    length => received.extend_from_slice(&chunk[..length]),
                }
            }
        }
    }
}

fn no_answer(timeout: Duration) -> Answer {
    let seconds = timeout.as_secs_f64();
    Answer::Missing(format!("no answer to the handshake within {seconds} s"))
}

/// The version that is announced first, as in the driver.
const NEWEST: Version = Version::V10;

/// Time limit for the connection and for the answer, as in the check of the ports.
const TIMEOUT: Duration = Duration::from_secs(1);

/// Longest accepted message in bytes. An answer to a handshake has 15 bytes.
const ANSWER_MAX: usize = 1024;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;
    use franka_proto::framing::Header;
    use std::net::TcpListener;
    use std::thread;

    /// Time limit for an answer that must come; longer than any delay of a busy machine.
    const PATIENCE: Duration = Duration::from_secs(60);

    fn refusal(server_version: u16) -> Answer {
        Answer::Incompatible(IncompatibleVersion {
            server_version,
            library_version: Version::V10,
        })
    }

    /// Returns verdicts and values for the version and the availability.
    fn judged(answers: &[Answer], purpose: Purpose) -> ([Verdict; 2], [String; 2]) {
        let found = handshake(answers, purpose);
        let [version, busy] = <[Finding; 2]>::try_from(found).expect("two findings");
        assert_eq!((version.id, busy.id), ("robot.version", "robot.busy"));
        ([version.verdict, busy.verdict], [version.read, busy.read])
    }

    #[test]
    fn handshake_names_version_or_the_system_to_install() {
        for (number, system) in [
            (3, "4.2.1"),
            (4, "4.2.1"),
            (6, "5.9.0"),
            (7, "5.9.0"),
            (8, "5.9.0"),
            (9, "5.9.0"),
        ] {
            let (verdicts, [version, _]) = judged(&[refusal(number)], Purpose::Move);
            assert_eq!(verdicts, [Verdict::Failure, Verdict::Unknown], "{number}");
            let text =
                format!("update the robot's system to {system} or later (Desk, Settings, System)");
            assert!(version.ends_with(&text), "{version}");
        }
        let (verdicts, [version, _]) = judged(&[refusal(11)], Purpose::Read);
        assert_eq!(verdicts[0], Verdict::Failure);
        assert!(
            version.starts_with("version 11, which this driver does not support"),
            "{version}"
        );
        for version in Version::ALL {
            let (verdicts, [read, _]) = judged(&[Answer::Accepted(version)], Purpose::Move);
            assert_eq!(verdicts, [Verdict::Good, Verdict::Good]);
            assert!(read.contains(&format!("version {version},")), "{read}");
        }
        assert_eq!(judged(&[refusal(7)], Purpose::Sim).0[0], Verdict::Info);
    }

    #[test]
    fn a_robot_with_a_client_is_busy_and_one_that_is_silent_unknown() {
        use Verdict::{Good, Unknown, Warning};
        let silent = Answer::Missing("no answer".into());
        for (answers, expected) in [
            (&[Answer::Closed][..], [Unknown, Warning]),
            // The older version is supported; the second session was refused.
            (&[refusal(5), Answer::Closed], [Good, Warning]),
            (&[refusal(5), Answer::Accepted(Version::V5)], [Good, Good]),
            (&[silent], [Unknown, Unknown]),
            (&[], [Unknown, Unknown]),
        ] {
            let (verdicts, texts) = judged(answers, Purpose::Move);
            assert_eq!(verdicts, expected, "{answers:?}");
            for (verdict, text) in verdicts.iter().zip(&texts) {
                assert_eq!(*verdict == Unknown, text.starts_with("unknown: "), "{text}");
            }
        }
    }

    /// Returns the bytes of an answer to the first handshake of a session.
    fn reply(status: u8, version: u16) -> Vec<u8> {
        let header = Header {
            command: 0,
            command_id: 0,
            size: 15,
        };
        let mut bytes = header.to_bytes().to_vec();
        bytes.push(status);
        bytes.extend(version.to_le_bytes());
        bytes
    }

    /// Returns the answer when a peer sends `bytes` after the handshake. The peer then closes the
    /// connection if `closes` is true.
    fn asked(bytes: Vec<u8>, closes: bool, timeout: Duration) -> Answer {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
        let address = listener.local_addr().expect("bound");
        let peer = thread::spawn(move || {
            let (mut stream, _) = listener.accept().expect("a client");
            // A header, a version, a port.
            let mut handshake = [0; 16];
            stream.read_exact(&mut handshake).expect("a handshake");
            stream.write_all(&bytes).expect("sent");
            // Waits until the client has closed its end of the connection.
            if !closes {
                let _ = stream.read_to_end(&mut Vec::new());
            }
        });
        let answer = ask(address, Version::V10, timeout);
        peer.join().expect("no panic");
        answer
    }

    #[test]
    fn answers_on_a_connection_are_told_apart() {
        assert_eq!(
            asked(reply(0, 10), false, PATIENCE),
            Answer::Accepted(Version::V10)
        );
        assert_eq!(asked(reply(1, 7), false, PATIENCE), refusal(7));
        assert_eq!(asked(Vec::new(), true, PATIENCE), Answer::Closed);
        // Half an answer, then the end.
        assert_eq!(asked(vec![0; 8], true, PATIENCE), Answer::Closed);
        let silent = asked(Vec::new(), false, Duration::from_millis(20));
        assert_eq!(silent, no_answer(Duration::from_millis(20)));
        // A message of another protocol. The size in its header is far out of range.
        let text = b"HTTP/1.1 400 Bad Request\r\n".to_vec();
        let Answer::Missing(why) = asked(text, false, PATIENCE) else {
            panic!("no robot answers with HTTP")
        };
        assert!(why.contains("announces a message of"), "{why}");
    }

    #[test]
    fn a_port_that_nobody_listens_on_is_no_robot() {
        let free = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
        let address = free.local_addr().expect("bound");
        drop(free);
        let [Answer::Missing(why)] = &answers(address)[..] else {
            panic!("nobody listens there")
        };
        assert!(why.contains("no connection"), "{why}");
    }
}
