//! The robot's side: sends states at 1 kHz, and records when the kernel received the commands.

use std::fmt;
use std::io;
use std::net::{IpAddr, Ipv4Addr, UdpSocket};
use std::thread;
use std::time::{Duration, Instant};

use franka_proto::{RobotCommand, RobotState, Version};

use super::preferred;
use crate::stamp::{self, Stamped};
use crate::trace::Quantiles;

/// The protocol version of the FR3.
pub(crate) const VERSION: Version = Version::V10;

/// The address that states are sent from.
pub(crate) const ADDRESS: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

/// Losses and turnarounds of an exchange.
pub(crate) struct Outcome {
    states: usize,
    /// Number of states whose command had not arrived when the next one left.
    lost: usize,
    /// Times from the departure of a state to the arrival of its command.
    turnaround: Quantiles,
}

/// Sends states to `port` of this machine for `time`.
pub(crate) fn run(port: u16, time: Duration) -> io::Result<Outcome> {
    let socket = UdpSocket::bind((ADDRESS, 0))?;
    socket.connect((ADDRESS, port))?;
    socket.set_read_timeout(Some(SILENCE))?;
    let mut listening = Stamped::new(socket.try_clone()?)?;
    // The kernel enables time stamps in the background.
    thread::sleep(20 * PERIOD);
    let states = usize::try_from(time.as_millis()).expect("a time of some seconds");
    let listener = thread::spawn(move || {
        prefer();
        listen(&mut listening, states)
    });
    let speaker = thread::spawn(move || {
        prefer();
        speak(&socket, states)
    });
    let sent = speaker.join().expect("no panic")?;
    let arrived = listener.join().expect("no panic");
    Ok(Outcome::of(&sent, &arrived))
}

/// Raises this thread's priority, if the system grants it: a robot is a separate computer, which
/// the load on this one does not slow down.
fn prefer() {
    let granted = preferred(Some(PRIORITY)).enter();
    granted.expect("nothing is enforced");
}

/// Sends a state per millisecond, and returns the time at which each left.
fn speak(socket: &UdpSocket, states: usize) -> io::Result<Vec<Duration>> {
    let mut bytes = [0; RobotState::MAX_SIZE];
    let mut sent = Vec::with_capacity(states);
    let mut due = Instant::now();
    for message_id in 1..=states as u64 {
        due += PERIOD;
        thread::sleep(due.saturating_duration_since(Instant::now()));
        let state = RobotState {
            message_id,
            ..RobotState::default()
        };
        let size = state.encode(VERSION, &mut bytes).expect("there is room");
        sent.push(stamp::now());
        socket.send(&bytes[..size])?;
    }
    Ok(sent)
}

/// Receives until no command arrives for a while. Returns the arrival time of each state's command.
fn listen(socket: &mut Stamped, states: usize) -> Vec<Option<Duration>> {
    let mut arrived = vec![None; states];
    let mut bytes = [0; RobotCommand::MAX_SIZE];
    while let Ok((size, now)) = socket.receive(&mut bytes) {
        let command = RobotCommand::decode(VERSION, &bytes[..size]).expect("a command");
        let answered = command.message_id as usize - 1;
        arrived[answered].get_or_insert(now);
    }
    arrived
}

impl Outcome {
    fn of(sent: &[Duration], arrived: &[Option<Duration>]) -> Self {
        let next = sent.iter().skip(1);
        // No state follows the last.
        let in_time = arrived
            .iter()
            .zip(next)
            .filter(|(arrived, next)| arrived.is_some_and(|arrived| arrived < **next));
        let states = sent.len() - 1;
        let lost = states - in_time.count();
        let answered = sent.iter().zip(arrived);
        let turnarounds =
            answered.filter_map(|(sent, arrived)| Some((*arrived)?.saturating_sub(*sent)));
        Self {
            states,
            lost,
            turnaround: Quantiles::of(turnarounds),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (states, lost, nanos) = (self.states, self.lost, &self.turnaround);
        let [p50, p99, p99_9, max] =
            [nanos.p50, nanos.p99, nanos.p99_9, nanos.max].map(|nanos| nanos / 1000);
        write!(
            f,
            "{states:>8} {lost:>6} {p50:>7} {p99:>7} {p99_9:>7} {max:>7}"
        )
    }
}

const PERIOD: Duration = Duration::from_millis(1);

/// Longer than any delay of a command.
const SILENCE: Duration = Duration::from_millis(500);

/// Below the control thread, which requests the highest.
const PRIORITY: i32 = 10;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_commands_count_as_lost_but_have_a_turnaround() {
        let at = Duration::from_micros;
        let sent = [at(0), at(1000), at(2000), at(3000)];
        let arrived = [Some(at(40)), Some(at(2500)), None, Some(at(3060))];
        let outcome = Outcome::of(&sent, &arrived);
        assert_eq!((outcome.states, outcome.lost), (3, 2));
        assert_eq!(outcome.turnaround.p50 / 1000, 60);
        assert_eq!(outcome.turnaround.max / 1000, 1500);
    }
}
