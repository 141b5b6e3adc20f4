//! Options of the playback of a cassette.

use std::time::Duration;

/// Options of the playback.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlayOptions {
    /// Requirements on the client's messages.
    pub matching: Matching,
    /// Timing of the robot's messages.
    pub pace: Pace,
    /// Longest time for which [`Pace::Answered`] waits for a recorded command.
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

/// Requirements on the client's messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matching {
    /// The client must send the recorded bytes, including every recorded command. Exceptions are
    /// the UDP port in `Connect`, the ids of requests, and the `message_id` of commands. Repeated
    /// states change the `message_id`.
    Strict,
    /// The client must send the recorded kinds of request, in their order, with any parameters. The
    /// player does not compare commands. The end of a motion counts as a request.
    Lenient,
}

/// Timing of the robot's messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// The recorded times. While the client's next request is missing, the playback waits and
    /// repeats the last state with increasing ids, so a slower client stays connected.
    Recorded,
    /// Like [`Self::Recorded`], but a state that followed a command is sent as soon as this command
    /// arrives. The client is never too late, and may be faster than the recorded client.
    Answered,
    /// As fast as the caller calls [`super::Player::poll`], without repeated states. Use this for
    /// tests that have their own clock.
    Lockstep,
}
