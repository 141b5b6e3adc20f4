//! Options of the playback of a cassette.

use std::time::Duration;

/// Options of the playback.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlayOptions {
    /// The requirements on the client's messages.
    pub matching: Matching,
    /// The timing of the robot's messages.
    pub pace: Pace,
    /// Time for which [`Pace::Answered`] waits for a recorded command.
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

/// The requirements on the client's messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matching {
    /// The client must send the recorded bytes, including every recorded command. Exceptions are
    /// the UDP port in `Connect`, the ids of requests, and the `message_id` of commands, which
    /// changes with held states.
    Strict,
    /// The client must send the recorded kinds of request, in their order, with any parameters.
    /// Commands are not compared; the end of a motion counts as a request.
    Lenient,
}

/// The timing of the robot's messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// The recorded times. While the next request is missing, time stands still. The last state is
    /// repeated with increasing ids, so that a slower client stays connected.
    Recorded,
    /// Like [`Self::Recorded`], but a state that followed a command is sent exactly when that
    /// command has arrived. A client is never too late, and may be faster than the recorded client.
    Answered,
    /// As fast as [`super::Player::poll`] is called, without held states. For tests with their own
    /// clock.
    Lockstep,
}
