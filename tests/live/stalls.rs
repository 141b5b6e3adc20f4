//! An FER's transmit stalls over sockets, for the driver as it is. What they come to is exact in
//! virtual time, `tests/lockstep/stalls.rs`; here they are seen, and measured:
//!
//! ```text
//! FRANKA_STALLS_SECONDS=30 cargo test --package franka-tests --test live stalls -- --nocapture
//! ```
//!
//! measures for as long as robots were measured. More states give way to a newer one here than
//! there: a burst leaves the simulator faster than the driver's thread wakes up.

use std::sync::{Arc, Mutex};

use franka_async::control::{Finish as _, Torques};
use franka_sim::{Network, Sim};
use franka_tests::cycle_counts::CycleCounts;

use crate::{ahead_of_the_client, alone};

/// A state that has waited out a stall is answered late, whatever the client: some 14 of 1000
/// cycles.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_stalls_of_an_fer_are_bridged_and_make_commands_late() {
    let _alone = alone();
    let seconds = std::env::var("FRANKA_STALLS_SECONDS").ok();
    let seconds: u64 = seconds.map_or(SECONDS, |text| text.parse().expect("a number"));
    let (robot, sim) = ahead_of_the_client(Sim::fer().ideal().network(Network::fer(1))).await;
    let counts = Arc::new(Mutex::new(CycleCounts::default()));
    let noted = Arc::clone(&counts);
    let before = sim.pace().await.expect("it runs");
    let motion = robot.control_torques(move |state, step| {
        let mut counts = noted.lock().expect("no panic");
        counts.note(state, step);
        Torques([0.0; 7]).finish_if(counts.cycles >= 1000 * seconds)
    });
    let report = motion.await.expect("the robot bridges such gaps");
    let after = sim.pace().await.expect("it runs");
    robot.shutdown().await;
    let counts = *counts.lock().expect("no panic");
    println!(
        "{} of {} lost, {} in a row at most, success rate {:.4}; {} states skipped, {:?}; the host \
         was late for {} states",
        counts.lost(),
        counts.cycles,
        counts.row,
        counts.rate(),
        report.skipped_states,
        report.turnaround,
        after.late() - before.late(),
    );
    // No machine is better than the robot's network.
    assert!(counts.rate() < 0.995, "{counts:?}");
}

/// How long, unless told otherwise.
const SECONDS: u64 = 4;
