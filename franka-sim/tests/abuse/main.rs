//! The simulator's binary against clients that leave the protocol. After each of them a good client
//! is served within a second, by the same process, which has not grown.
//!
//! | module | what it holds |
//! |---|---|
//! | `binary` | the process: its ports, its memory, what it has logged |
//! | `port` | a service as bytes see it |
//! | `good` | the good client, which is the project's own |
//! | `client` | a client of the robot that can do wrong in mid-session |
//! | `handshakes`, `messages`, `seats`, `motions`, `datagrams`, `commands`, `growth`,
//! `stopped` | the tests |

mod binary;
mod client;
mod commands;
mod datagrams;
mod good;
mod growth;
mod handshakes;
mod messages;
mod motions;
mod port;
mod seats;
mod stopped;

use std::sync::{Mutex, MutexGuard, PoisonError};

use binary::Binary;

/// Held by each test: two cores carry only so many robots.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs a test on both robots, one after the other.
fn each_robot(test: impl Fn(&Binary)) {
    let _alone = alone();
    for kind in ["fr3", "fer"] {
        test(&Binary::start(kind));
    }
}
