//! Tests of the simulator over sockets: clients that violate the protocol, a simulator that is
//! stopped in the middle of a motion, and robot time that follows the client's answers.
//!
//! After each abuse, the same process must serve a good client, and its memory must not have grown.
//! The robots wait for answers, so a machine that delays a client only makes the test slow.
//!
//! | module | content |
//! |---|---|
//! | `binary` | the process: its ports, its memory, what it has logged |
//! | `port` | a service of the simulator, and its bytes |
//! | `good` | a client that observes the protocol: this project's driver |
//! | `client` | a client of the robot that can violate the protocol within a session |
//! | `handshakes`, `messages`, `second_clients`, `motions`, `datagrams`, `commands`, `growth` | abuse |
//! | `stopped` | a process that is stopped and continued |
//! | `virtual_time` | robot time as fast as the client answers |

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
mod second_clients;
mod stopped;
mod virtual_time;

use std::sync::{Mutex, MutexGuard, PoisonError};

use binary::Binary;

/// Each test holds this lock, because two cores support only a few robots.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Lock that a test intentionally holds across every await. Each test blocks a separate runtime.
struct Alone {
    _guard: MutexGuard<'static, ()>,
}

fn alone() -> Alone {
    let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    Alone { _guard }
}

/// Runs a test on both robots, one after the other.
fn each_robot(test: impl Fn(&Binary)) {
    let _alone = alone();
    for kind in ["fr3", "fer"] {
        test(&Binary::start(kind));
    }
}
