//! Playback of one recorded connection, without sockets and without a clock.

mod matching;
mod pace;

use std::collections::{HashMap, VecDeque};
use std::fmt;
use std::time::Duration;

use super::options::{Matching, Pace, PlayOptions};
use super::script::{Script, Step, Unplayable, counter};
use super::{Connection, Device};
use pace::Gate;

/// Output of a player, which the caller must perform.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// Send these bytes over TCP.
    Stream(Vec<u8>),
    /// Send this datagram over UDP to the client's port ([`Player::udp_port`]).
    Datagram(Vec<u8>),
    /// Close the TCP stream.
    End,
}

/// Error for a client that deviated from the recording.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the client of the {device} differs from the recording: got {got}, expected {expected}")]
pub struct Mismatch {
    /// The device of the connection.
    pub device: Device,
    /// Description of what the client did.
    pub got: String,
    /// Description of what the recorded client did.
    pub expected: String,
}

/// Counts of one playback.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Tally {
    /// Number of requests that matched the recording.
    pub requests: u64,
    /// Number of commands that arrived.
    pub commands: u64,
    /// Number of states sent, including repeated states.
    pub states: u64,
    /// Number of states that were repeated because a request was missing.
    pub held: u64,
}

/// A state machine that plays back a recorded connection to a client.
///
/// * Input: [`Self::on_stream`], [`Self::on_datagram`], [`Self::on_end`].
/// * Output: call [`Self::poll`] until it returns `None`, after every input and at
///   [`Self::deadline`].
///
/// Each `now` is the time since a fixed moment of your choice, and must not decrease. An error ends
/// the playback.
#[derive(Clone, Debug)]
pub struct Player {
    script: Script,
    options: PlayOptions,
    /// Index of the next step.
    position: usize,
    /// Time at which the next step is due, as recorded.
    due: Duration,
    /// Time since which the player has waited for a step of the client; `None` if it does not wait.
    blocked: Option<Duration>,
    /// Indices of steps. All requests (or all commands) before the index have arrived.
    requested: usize,
    commanded: usize,
    client_ended: bool,
    udp_port: Option<u16>,
    received: Vec<u8>,
    /// Ids of this client's requests, by the ids of the recorded requests.
    ids: HashMap<[u8; 4], [u8; 4]>,
    last_state: Option<(Duration, Vec<u8>)>,
    /// Difference between the ids of the states sent and the ids of the recorded states.
    shift: u64,
    /// Ids of the states sent, each with the recorded id; `None` for a repeated state.
    sent: VecDeque<(u64, Option<u64>)>,
    /// True if a command did not arrive in time and no command has arrived since.
    silent: bool,
    failure: Option<Mismatch>,
    tally: Tally,
}

impl Player {
    /// Creates a player for a recorded connection. Playback begins at `now`.
    ///
    /// # Errors
    /// Returns [`Unplayable`] if the recording is incomplete, or does not begin with a client's
    /// `Connect`.
    pub fn new(
        connection: &Connection,
        options: PlayOptions,
        now: Duration,
    ) -> Result<Self, Unplayable> {
        Ok(Self {
            script: Script::new(connection)?,
            options,
            position: 0,
            due: now,
            blocked: None,
            requested: 0,
            commanded: 0,
            client_ended: false,
            udp_port: None,
            received: Vec::new(),
            ids: HashMap::new(),
            last_state: None,
            shift: 0,
            sent: VecDeque::new(),
            silent: false,
            failure: None,
            tally: Tally::default(),
        })
    }

    /// Returns the client's UDP port; `None` until the client has sent `Connect`.
    #[must_use]
    pub fn udp_port(&self) -> Option<u16> {
        self.udp_port
    }

    /// Returns true if every step has been played back.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.position == self.script.steps.len()
    }

    /// Returns a description of the client's next step.
    #[must_use]
    pub fn awaited(&self) -> String {
        self.expected(self.position)
    }

    /// Returns the counts of the playback.
    #[must_use]
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// Processes bytes of the client's stream.
    ///
    /// # Errors
    /// Returns [`Mismatch`] if the bytes contain a request that differs from the recorded request.
    pub fn on_stream(&mut self, bytes: &[u8]) -> Result<(), Mismatch> {
        self.checked()?;
        self.received.extend_from_slice(bytes);
        let received = std::mem::take(&mut self.received);
        let mut rest = received.as_slice();
        loop {
            match self.script.device.next_message(rest) {
                Ok(Some(message)) => {
                    let (whole, behind) = rest.split_at(message.size());
                    self.on_request(whole)?;
                    rest = behind;
                }
                Ok(None) => break,
                Err(error) => {
                    let expected = self.expected(self.requested);
                    return self.fail(error.to_string(), expected);
                }
            }
        }
        self.received = rest.to_vec();
        Ok(())
    }

    /// Processes a datagram of the client.
    ///
    /// # Errors
    /// Returns [`Mismatch`] if the command differs from the recorded command.
    pub fn on_datagram(&mut self, datagram: &[u8]) -> Result<(), Mismatch> {
        self.checked()?;
        self.silent = false;
        let got = counter(self.script.device, datagram);
        let sent = got.and_then(|id| self.sent.iter().rev().find(|(sent, _)| *sent == id));
        let recorded = match sent {
            // The recording contains no command that answers a repeated state.
            Some((_, None)) if !self.script.finishes(datagram) => return Ok(()),
            Some((_, None)) => None,
            Some((_, recorded)) => *recorded,
            None => got.map(|id| id.wrapping_sub(self.shift)),
        };
        self.tally.commands += 1;
        match self.options.matching {
            Matching::Strict => self.compare_command(recorded, datagram),
            Matching::Lenient => {
                self.accept_command(recorded, datagram);
                Ok(())
            }
        }
    }

    /// Processes the end of the client's stream.
    ///
    /// # Errors
    /// Returns [`Mismatch`] if the recording contains further requests. With [`Matching::Strict`],
    /// also returns it if the recording contains further commands.
    pub fn on_end(&mut self) -> Result<(), Mismatch> {
        self.checked()?;
        self.client_ended = true;
        let request = self.next_request();
        let command = self.next_command();
        let strict = self.options.matching == Matching::Strict;
        if let Some(missing) = request.or(command.filter(|_| strict)) {
            let expected = self.expected(missing);
            return self.fail("the end of the connection".to_owned(), expected);
        }
        self.position = self.script.steps.len();
        Ok(())
    }

    /// Returns the next output; `None` if no output is due before [`Self::deadline`] or the next
    /// input.
    ///
    /// # Errors
    /// Returns [`Mismatch`] if the client deviated from the recording, or did not send a command in
    /// time.
    pub fn poll(&mut self, now: Duration) -> Result<Option<Output>, Mismatch> {
        self.checked()?;
        while let Some((_, step)) = self.script.steps.get(self.position) {
            match step {
                Step::Request(_) if self.position < self.requested => self.pass(now),
                Step::Request(_) | Step::ClientEnd => return Ok(self.hold(now)),
                Step::Command(_) => match self.command_gate(now)? {
                    Gate::Open => self.pass(now),
                    Gate::Hold => return Ok(self.hold(now)),
                    Gate::Wait => return Ok(None),
                },
                Step::Reply(_) | Step::State(_) | Step::RobotEnd => {
                    if self.options.pace != Pace::Lockstep && now < self.due {
                        return Ok(None);
                    }
                    let output = self.perform(now);
                    self.pass(now);
                    return Ok(Some(output));
                }
            }
        }
        Ok(None)
    }

    /// Returns the time of the next output, assuming that no further input arrives; `None` if there
    /// will be no output without input.
    #[must_use]
    pub fn deadline(&self) -> Option<Duration> {
        let held = || {
            let (at, _) = self.last_state.as_ref()?;
            Some(*at + self.script.interval)
        };
        match &self.script.steps.get(self.position)?.1 {
            Step::Reply(_) | Step::State(_) | Step::RobotEnd => Some(self.due),
            Step::Request(_) | Step::ClientEnd => held(),
            Step::Command(_) if self.is_unfinished_motion(self.position) => held(),
            Step::Command(_) => self.given_up_at(),
        }
    }

    /// Returns the time at which the player stops waiting for a missing command.
    fn given_up_at(&self) -> Option<Duration> {
        let since = self.blocked?;
        Some(since.saturating_add(self.options.patience))
    }

    fn next_request(&self) -> Option<usize> {
        self.next_step(self.requested, |step| matches!(step, Step::Request(_)))
    }

    fn next_command(&self) -> Option<usize> {
        self.next_step(self.commanded, |step| matches!(step, Step::Command(_)))
    }

    fn next_step(&self, from: usize, is: impl Fn(&Step) -> bool) -> Option<usize> {
        let steps = self.script.steps.get(from..)?;
        let found = steps.iter().position(|(_, step)| is(step))?;
        Some(from + found)
    }

    /// Describes the client's first step at or after `step`.
    fn expected(&self, step: usize) -> String {
        let is_clients =
            |step: &Step| matches!(step, Step::Request(_) | Step::Command(_) | Step::ClientEnd);
        match self.next_step(step, is_clients) {
            Some(step) => self.script.describe(&self.script.steps[step].1),
            None => "nothing more".to_owned(),
        }
    }

    fn checked(&self) -> Result<(), Mismatch> {
        self.failure.clone().map_or(Ok(()), Err)
    }

    fn fail(&mut self, got: String, expected: String) -> Result<(), Mismatch> {
        let device = self.script.device;
        self.failure = Some(Mismatch {
            device,
            got,
            expected,
        });
        self.checked()
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "received {} requests and {} commands, sent {} states, held back {} of them",
            self.requests, self.commands, self.states, self.held
        )
    }
}
