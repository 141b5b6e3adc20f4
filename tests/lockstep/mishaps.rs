//! Each kind of network fault, under target control: the report counts it correctly, and the arm
//! arrives if the robot tolerates the fault. `tests/live/mishaps.rs` uses the same networks over
//! sockets.

use std::time::Duration;

use franka_diagnosis::Diagnose;
use franka_lockstep::{Link, Lockstep, Outcome, for_each_robot};
use franka_proto::{RobotError, Version};
use franka_rt::lifecycle::{MotionError, MotionReport};
use franka_rt::session::Target;
use franka_sim::Network;
use franka_sim::network::Tally;
use franka_tests::mishaps;

/// Runs a motion of a bit more than a second over this network. Returns its outcome, and the counts
/// of the network.
fn travel(ready: &dyn Fn() -> Lockstep, network: Network) -> (Lockstep, Outcome, Tally) {
    let mut lockstep = ready();
    lockstep.link = Link::over(network);
    let mut q = lockstep.client.state.q;
    q[0] += 0.4;
    q[5] += 0.2;
    let goal = lockstep.begin(Target::Joints(q));
    let outcome = lockstep.until_resolved(goal, 20_000);
    let tally = lockstep.link.network.to_client.tally();
    if outcome.is_ok() {
        for (is, target) in lockstep.client.state.q.iter().zip(q) {
            assert!((is - target).abs() < 2e-3, "{is} for {target}");
        }
    }
    println!("{tally:?}, {outcome:?}");
    (lockstep, outcome, tally)
}

/// Checks the report of a motion that arrives, for each robot and seed.
fn arrives(
    network: impl Fn(u64) -> Network,
    check: impl Fn(Version, &MotionReport, Tally, &Lockstep),
) {
    for_each_robot(|ready| {
        for seed in 1..=5 {
            let (lockstep, outcome, tally) = travel(ready, network(seed));
            let report = outcome.unwrap_or_else(|error| panic!("seed {seed}: {error}"));
            check(lockstep.client.version(), &report, tally, &lockstep);
        }
    });
}

/// Asserts that the report counts all losses during the motion. The motion does not run all the
/// time.
fn assert_counted(report: &MotionReport, tally: Tally) {
    let lost = report.lost_states;
    assert!(
        lost <= tally.lost && tally.lost <= lost + 6,
        "{tally:?}, {report:?}"
    );
    assert!(lost > 0, "{report:?}");
    assert_eq!(report.skipped_states, 0, "{report:?}");
}

/// The share of commands that arrive in time if packets pass with this probability.
fn answered(version: Version, passes: f64) -> f64 {
    match version {
        Version::V5 => passes.powi(3),
        Version::V10 => passes.powi(2),
    }
}

#[test]
fn loss_is_counted_and_bridged() {
    arrives(mishaps::loss, |version, report, tally, _| {
        assert_counted(report, tally);
        let expected = answered(version, 1.0 - mishaps::LOST);
        let rate = report.success_rate_avg;
        assert!((rate - expected).abs() < 0.03, "{rate} for {expected}");
    });
}

#[test]
fn loss_in_bursts_is_counted_and_bridged() {
    arrives(mishaps::bursts, |_, report, tally, _| {
        assert_counted(report, tally);
        // Longer than any run of losses in the test above.
        let longest = report.interval.expect("states came").max;
        assert!(longest >= Duration::from_millis(4), "{longest:?}");
        assert!(report.success_rate_min < 0.95, "{report:?}");
    });
}

#[test]
fn a_delay_within_the_cycle_costs_nothing() {
    let network = |_| mishaps::delay(Duration::from_micros(300));
    arrives(network, |_, report, tally, _| {
        assert_eq!((report.lost_states, tally.lost), (0, 0));
        assert_eq!(report.success_rate_min, 1.0);
    });
}

/// The command is delayed as long as the state, so it misses its cycle from a delay of half a
/// millisecond on. The robot waits for the first command, and counts from its arrival.
#[test]
fn a_delay_beyond_the_cycle_leaves_no_command_in_time() {
    for_each_robot(|ready| {
        let (lockstep, outcome, tally) = travel(ready, mishaps::delay(Duration::from_micros(600)));
        let Err(MotionError::Control(error)) = outcome else {
            panic!("{outcome:?}")
        };
        let starved = RobotError::CommunicationConstraintsViolation;
        assert!(error.errors.contains(starved), "{error}");
        let diagnosis = error.diagnose().expect("a reflex");
        let finding = diagnosis.finding.expect("none came in time");
        assert!(finding.value > 19.0, "{finding}");
        assert_eq!((error.statistics.cycles, tally.lost), (22, 0));
        assert_eq!(lockstep.client.state.control_command_success_rate, 0.0);
    });
}

#[test]
fn jitter_makes_commands_late_and_loses_nothing() {
    arrives(mishaps::jitter, |_, report, tally, _| {
        assert_eq!((report.lost_states, tally.lost), (0, 0));
        let rate = report.success_rate_avg;
        assert!((rate - 0.72).abs() < 0.05, "{rate}");
    });
}

#[test]
fn overtaken_states_count_as_lost() {
    arrives(mishaps::reordering, |_, report, tally, _| {
        assert_eq!(tally.lost, 0);
        // The motion continues after its arrival, the end of the report's duration.
        let share = report.lost_states as f64 / tally.sent as f64;
        assert!((share - mishaps::OVERTAKEN).abs() < 0.04, "{share}");
        let expected = (1.0 - mishaps::OVERTAKEN).powi(2);
        let rate = report.success_rate_avg;
        assert!((rate - expected).abs() < 0.05, "{rate} for {expected}");
    });
}

#[test]
fn duplicated_states_count_once() {
    arrives(mishaps::duplication, |_, report, _, _| {
        assert_eq!((report.lost_states, report.skipped_states), (0, 0));
        assert_eq!(report.success_rate_min, 1.0);
    });
}

#[test]
fn half_a_state_is_lost() {
    arrives(mishaps::halves, |version, report, tally, _| {
        assert_counted(report, tally);
        let whole = tally.lost - tally.fragment_lost;
        match version {
            // Losing one packet of a state is far more frequent than losing both.
            Version::V5 => assert!(tally.fragment_lost > 10 * whole, "{tally:?}"),
            Version::V10 => assert_eq!(tally.fragment_lost, 0),
        }
        let packets = if version == Version::V5 { 2 } else { 1 };
        let expected = (1.0 - mishaps::LOST_TO_CLIENT).powi(packets);
        let rate = report.success_rate_avg;
        assert!((rate - expected).abs() < 0.03, "{rate} for {expected}");
    });
}

/// The robot tolerates nineteen missing commands, and not twenty.
#[test]
fn a_cut_is_bridged_up_to_the_robots_tolerance() {
    for_each_robot(|ready| {
        let begin = Duration::from_millis(500);
        let cut = |milliseconds| mishaps::cut(begin..begin + Duration::from_millis(milliseconds));
        let (_, outcome, tally) = travel(ready, cut(19));
        let report = outcome.expect("it is bridged");
        assert_eq!((report.lost_states, tally.lost), (19, 19));

        let (mut lockstep, outcome, _) = travel(ready, cut(20));
        let Err(MotionError::Control(error)) = outcome else {
            panic!("{outcome:?}")
        };
        let reason = error.failure.reflex_reason;
        assert!(reason.contains(RobotError::CommunicationConstraintsViolation));
        lockstep.request(&franka_proto::Request::AutomaticErrorRecovery);
        lockstep.run(100);
        let goal = lockstep.begin(Target::Joints(lockstep.client.state.q));
        lockstep
            .until_resolved(goal, 5000)
            .expect("the network is whole again");
    });
}
