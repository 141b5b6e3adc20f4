//! How a cassette is played.

use std::time::Duration;

/// How to play a cassette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlayOptions {
    /// What the client has to send.
    pub matching: Matching,
    /// When the robot sends.
    pub pace: Pace,
    /// How long [`Pace::Answered`] waits for a command that the recording has.
    pub patience: Duration,
}

impl Default for PlayOptions {
    fn default() -> Self {
        Self {
            matching: Matching::Strict,
            pace: Pace::Answered,
            patience: Duration::from_secs(1),
        }
    }
}

/// What a client has to send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matching {
    /// The recorded bytes. May differ: the UDP port in `Connect`, the ids of requests, and the
    /// `message_id` of commands as far as states were held. Every recorded command has to come.
    Strict,
    /// The recorded kinds of request, in their order, with any parameters. Commands are not
    /// compared; the end of a motion counts as a request.
    Lenient,
}

/// When the robot sends what it sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As recorded. While a request that comes next is missing, time stands still: the last state
    /// is repeated with an id that goes on, so that a client that takes longer stays connected.
    Recorded,
    /// As [`Self::Recorded`], and a state that followed a command is sent as soon as that command
    /// has come, not before. A client is never too late, and may be faster than it was.
    Answered,
    /// As fast as [`super::Player::poll`] is called, and no states are held. For tests that count
    /// time themselves.
    Lockstep,
}
