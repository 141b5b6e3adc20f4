//! An FER's transmit stalls over sockets, for the driver as it is. In virtual time:
//! `tests/lockstep/stalls.rs`.
//!
//! What is answered too late is about the same there and here. More states give way to a newer one
//! here: a burst leaves the simulator faster than the driver's thread wakes up.
//!
//! ```text
//! FRANKA_STALLS_SECONDS=30 cargo test --package franka-tests --test live stalls -- --nocapture
//! ```
//!
//! measures for as long as robots were measured.

use std::sync::{Arc, Mutex};

use franka_async::{Finish as _, Robot, Torques};
use franka_sim::{Network, Sim};
use franka_tests::tally::Tally;

use crate::starving::prefer_the_simulator;
use crate::{alone, connect};

/// Commands no torque to an FER for so many seconds, over `network`. Beside what was noted, the
/// share of states for which this machine has not kept the robot's millisecond.
async fn communicate(network: Network, seconds: u64) -> (Tally, f64) {
    let sim = Sim::fer().network(network).enforce_communication(false);
    let sim = sim.start().await.expect("a simulator starts");
    let robot: Robot = connect(&sim).await;
    prefer_the_simulator();
    let tally = Arc::new(Mutex::new(Tally::default()));
    let noted = Arc::clone(&tally);
    let before = sim.pace().await.expect("it runs");
    let motion = robot.control_torques(move |state, step| {
        let mut tally = noted.lock().expect("no panic");
        tally.note(state, step);
        Torques([0.0; 7]).finish_if(tally.cycles >= 1000 * seconds)
    });
    let report = motion.await.expect("the robot bridges such gaps");
    let after = sim.pace().await.expect("it runs");
    let (lost, skipped) = (report.lost_states, report.skipped_states);
    println!("{lost} lost, {skipped} skipped, {:?}", report.turnaround);
    robot.shutdown().await;
    let tally = *tally.lock().expect("no panic");
    let late = after.late() - before.late();
    (tally, late as f64 / (after.cycles - before.cycles) as f64)
}

/// A state that has waited out a stall is answered late, whatever the client: some 14 of 1000
/// cycles.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_stalls_of_an_fer_make_the_driver_as_late_as_in_virtual_time() {
    let _alone = alone();
    let seconds = std::env::var("FRANKA_STALLS_SECONDS").ok();
    let seconds = seconds.map_or(SECONDS, |text| text.parse().expect("a number"));
    let (tally, late) = communicate(Network::fer(1), seconds).await;
    println!(
        "{} of {} lost, {} in a row at most, success rate {:.4}; {late:.4} of the states late",
        tally.lost(),
        tally.cycles,
        tally.row,
        tally.rate(),
    );
    // No machine is better than the robot's network, and what this one adds is a clock
    // that slips.
    assert!(tally.rate() < 0.995, "{tally:?}");
    if late < 0.005 {
        assert!(tally.rate() > 0.96, "{tally:?}, {late}");
        // Three of a hundred, thirty times what was measured on robots.
        assert!(tally.lost() * 100 < tally.cycles * 3, "{tally:?}, {late}");
    } else {
        println!("THE FIGURES WERE NOT CHECKED: this machine is too busy to keep a millisecond");
    }
}

/// How long, unless told otherwise.
const SECONDS: u64 = 4;
