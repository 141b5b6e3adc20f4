//! An FER's transmit stalls over sockets, for the driver as it is. `tests/lockstep/stalls.rs` has
//! their exact effect in virtual time. These tests detect them, and this command measures them for
//! the duration of the measurements on robots:
//!
//! ```text
//! FRANKA_STALLS_SECONDS=30 cargo test --package franka-tests --test live stalls -- --nocapture
//! ```
//!
//! Here a newer state replaces more states than on robots: a burst leaves the simulator faster than
//! the driver's thread wakes up.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use franka_async::control::{Finish as _, Torques};
use franka_sim::network::Conditions;
use franka_sim::{Network, Sim};
use franka_tests::cycle_counts::CycleCounts;

use crate::{ahead_of_the_client, alone, by_the_clock};

/// Every client answers late the states that have waited for the end of a stall: some 14 of 1000
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

/// An answer may be on its way when the next cycle is due: it is waited for as well.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_command_is_lost_behind_a_cable_where_commands_are_waited_for() {
    let _alone = alone();
    let cable = Network::new(1, Conditions::cable(), Conditions::cable());
    let (robot, _sim) = by_the_clock(Sim::fer().ideal().network(cable)).await;
    let mut cycles = 0;
    let least = Arc::new(Mutex::new(1.0_f64));
    let noted = Arc::clone(&least);
    let motion = robot.control_torques(move |state, _| {
        cycles += 1;
        std::thread::sleep(Duration::from_micros(100) * (cycles % 12));
        // The first commands may have been late; the rate covers the last 100 ms.
        if cycles > 200 {
            let mut least = noted.lock().expect("no panic");
            *least = least.min(state.control_command_success_rate);
        }
        Torques([0.0; 7]).finish_if(cycles >= 2000)
    });
    motion.await.expect("the robot has all commands");
    robot.shutdown().await;
    let least = *least.lock().expect("no panic");
    assert_eq!(least, 1.0);
}

/// Default duration, in seconds.
const SECONDS: u64 = 4;
