//! Effect of an FER's transmit stalls on its client.
//!
//! Figures of robots, in 30 s under control by a client that answers the newest available state:
//! some 28 of the 30 000 states were skipped for a newer one, never two in a row. The mean of
//! `control_command_success_rate` was 0.986. These are the figures of libfranka's example
//! `communication_test`. The tests count as the example does: in the control function, from the
//! time steps and the rate in each state.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use franka_lockstep::{Link, Lockstep};
use franka_model::RobotKind;
use franka_proto::Version;
use franka_rt::control::{Callback, Finish, Torques};
use franka_sim::Network;
use franka_sim::network::Conditions;
use franka_tests::cycle_counts::CycleCounts;

/// Commands no torque to an FER for this many cycles, over `network`.
fn communicate(network: Network, turnaround: Duration, cycles: u64) -> CycleCounts {
    let mut lockstep = Lockstep::ready_of(RobotKind::Fer);
    lockstep.link = Link::over(network);
    lockstep.client.turnaround = turnaround;
    let counts = Arc::new(Mutex::new(CycleCounts::default()));
    let noted = Arc::clone(&counts);
    let callback = Callback::torques(Version::V5, move |state, step| {
        let mut counts = noted.lock().expect("no panic");
        counts.note(state, step);
        Torques([0.0; 7]).finish_if(counts.cycles >= cycles)
    });
    let id = lockstep.control_function(callback);
    let id = id.expect("nothing else runs");
    let outcome = lockstep.until_resolved(id, cycles + 1000);
    outcome.expect("the robot bridges such gaps");
    *counts.lock().expect("no panic")
}

/// A measurement, `[ms]`.
const RUN: u64 = 30_000;

/// Measurements: one seed each.
const RUNS: u64 = 12;

/// The time that the client of the measurement takes from a state until it is ready for the next.
/// It has not been published. Below 20 us, the time of a state on the cable, every state of a burst
/// is answered. From 40 us on, two in a row are skipped.
const TURNAROUND: Duration = Duration::from_micros(35);

fn measure(turnaround: Duration, runs: u64) -> Vec<CycleCounts> {
    let run = |seed| {
        let counts = communicate(Network::fer(seed), turnaround, RUN);
        let (lost, rate) = (counts.lost(), counts.rate());
        println!("{turnaround:?}, seed {seed}: {lost} lost, rate {rate:.4}");
        counts
    };
    (0..runs).map(run).collect()
}

fn mean(runs: &[CycleCounts], figure: impl Fn(&CycleCounts) -> f64) -> f64 {
    runs.iter().map(figure).sum::<f64>() / runs.len() as f64
}

fn mean_rate(runs: &[CycleCounts]) -> f64 {
    mean(runs, CycleCounts::rate)
}

fn mean_loss(runs: &[CycleCounts]) -> f64 {
    mean(runs, |counts| counts.lost() as f64)
}

/// Between runs, as between measurements, the losses vary by some 5, since few stalls are long
/// enough to cause one, and the rate by 0.001. A run may deviate by three to four times that, the
/// mean of all runs by less.
#[test]
fn the_stalls_reproduce_the_figures_measured_on_fers() {
    let runs = measure(TURNAROUND, RUNS);
    println!("{} lost, rate {:.4}", mean_loss(&runs), mean_rate(&runs));
    for counts in &runs {
        assert!(counts.lost().abs_diff(28) <= 20, "{counts:?}");
        assert_eq!(counts.row, 1, "{counts:?}");
        assert!((counts.rate() - 0.986).abs() < 0.004, "{counts:?}");
    }
    let (lost, rate) = (mean_loss(&runs), mean_rate(&runs));
    assert!((lost - 28.0).abs() < 6.0, "{lost}");
    assert!((rate - 0.986).abs() < 0.002, "{rate}");
}

/// The robot's stalls decide how many states are answered in time; the speed of the client decides
/// how many states of a burst it sees.
#[test]
fn faster_client_loses_no_state_but_answers_as_late() {
    let [fast, measured, slow] =
        [10, 35, 120].map(|us| measure(Duration::from_micros(us), RUNS / 4));
    assert_eq!(mean_loss(&fast), 0.0);
    assert!((mean_rate(&fast) - mean_rate(&measured)).abs() < 5e-4);
    // The slow client misses almost all states of a burst but the first and the last.
    assert!(mean_loss(&slow) > 3.0 * mean_loss(&measured));
    assert!(slow.iter().all(|counts| counts.row > 1));
    assert!((mean_rate(&slow) - mean_rate(&measured)).abs() < 2e-3);
}

#[test]
fn on_the_same_cable_without_stalls_nothing_is_late() {
    let cable = Conditions::cable();
    let counts = communicate(Network::new(1, cable, cable), TURNAROUND, 5000);
    assert_eq!((counts.lost(), counts.rate()), (0, 1.0));
}
