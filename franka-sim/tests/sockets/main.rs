//! Tests of the simulator over sockets: clients that violate the protocol, a simulator that is
//! stopped in the middle of a motion, and robot time that follows the client's answers.
//!
//! After each abuse, the same process must serve a good client, and its memory must not have grown.
//! The robots wait for answers, so a machine that delays a client only makes the test slow.
//!
//! | module | content |
//! |---|---|
//! | `binary` | the process: its ports, its memory, what it has logged |
//! | `port` | a service as bytes see it |
//! | `good` | the good client, which is the project's own |
//! | `client` | a client of the robot that can do wrong in mid-session |
//! | `handshakes`, `messages`, `second_clients`, `motions`, `datagrams`, `commands`, `growth` | abuse |
//! | `stopped` | the process stopped and continued |
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

/// Lock that a test holds across every await. This is intended: each test blocks a separate
/// runtime.
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
