//! The behaviour of libfranka's client, scenario by scenario, after libfranka's own tests: with a
//! scripted robot, for both versions of the protocol.
//!
//! | module | scenarios |
//! |---|---|
//! | [`receiving`] | 1, 2, 7: which state counts, and what happens without one |
//! | [`starting`] | 3, 8, 13, 16: the start of a motion, the next one, and two at once |
//! | [`commanding`] | 4, 5, 6: commands that the motion accepts, and those that it refuses |
//! | [`ending`] | 9, 10, 11, 12: the ends of a motion |
//! | [`log`] | 14: the last cycles of a motion |
//! | [`callbacks`] | 15: control functions |
//! | [`connecting`] | 17: no robot, or one of another version |
//! | [`end_effectors`] | 18: the Hand and the vacuum gripper |
//!
//! Each scenario runs twice: with the scripted robot, and with the [cassette](tape) of that run.
//!
//! Client and robot share one thread and a counted clock, see [`pair::Pair`]. They exchange bytes
//! only: messages go through the sessions of both sides, datagrams over loopback through the socket
//! code of the control thread. Tests state the intended differences between this driver and
//! libfranka.

mod callbacks;
mod commanding;
mod connecting;
mod end_effectors;
mod ending;
mod log;
mod pair;
mod receiving;
mod robot;
mod starting;
mod tape;

use franka_proto::Version;

/// Runs a scenario for every version that has it.
fn for_each_version(scenario: impl Fn(Version)) {
    for version in Version::ALL {
        println!("protocol {version}");
        tape::recorded_and_replayed(|| scenario(version));
    }
}
