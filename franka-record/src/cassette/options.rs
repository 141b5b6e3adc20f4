//! Options for the playback of a cassette.

use std::time::Duration;

/// Options for the playback of a cassette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlayOptions {
    /// Required match between the client's messages and the recorded messages.
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

/// Required match between the client's messages and the recorded messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matching {
    /// The client must send the recorded bytes, including every recorded command. Three values may
    /// differ: the UDP port in `Connect`, the ids of requests, and the `message_id` of commands.
    /// The `message_id` changes when the player repeats states.
    Strict,
    /// The client must send the recorded kinds of request in the recorded order, with any
    /// parameters. The player does not compare commands. The end of a motion counts as a request.
    Lenient,
}

/// Timing of the robot's messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// The robot's messages are sent at the recorded times. While the client's next request is
    /// missing, the playback pauses and repeats the last state with increasing ids, so a slower
    /// client stays connected.
    Recorded,
    /// Like [`Self::Recorded`], but a state that followed a command is sent as soon as the client
    /// sends this command. Therefore the client is never too late, and can be faster than the
    /// recorded client.
    Answered,
    /// The robot's messages are sent as fast as the caller calls [`super::Player::poll`], without
    /// repeated states. Use this variant for tests that have their own clock.
    Lockstep,
}
