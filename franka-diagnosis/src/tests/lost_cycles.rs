//! Cycles without a command: network losses, and late commands of this host.

use core::time::Duration;

use franka_model::Model;
use franka_proto::MotionGeneratorMode as Generator;
use franka_proto::RobotError as E;

use super::*;
use crate::{Advice, Cause};

#[test]
fn a_loss_long_before_a_step_did_not_lead_to_it() {
    let causes = |between: u32| {
        let mut story = Story::of(Model::fer(), Generator::JointVelocity);
        // This command does not reach the robot.
        story.go(|_, _| {}, |state| state.control_command_success_rate = 0.9);
        for _ in 0..between {
            story.go(|_, _| {}, |_| {});
        }
        let error = E::ControllerTorqueDiscontinuity;
        let diagnosis = story.stop(&[error], |_, command| command.tau_J_d[4] += 5.0, |_| {});
        (diagnosis.causes.len(), diagnosis.advice)
    };
    assert_eq!(causes(25), (1, vec![Advice::SmoothTorques]));
    assert_eq!(causes(0), (2, vec![Advice::Network, Advice::SmoothTorques]));
}

#[test]
fn states_that_nobody_answered_are_this_hosts_doing() {
    let mut story = Story::of(Model::fr3(), Generator::JointVelocity);
    let answered = story.newest().message_id - 1;
    for _ in 0..20 {
        story.go(|_, command| command.message_id = answered, |_| {});
    }
    let diagnosis = story.stop(
        &[E::CommunicationConstraintsViolation],
        |_, command| command.message_id = answered,
        |_| {},
    );
    let [
        Cause::LostPackets {
            states: 0,
            commands: 0,
            unanswered: 21,
            longest_run: 21,
            ..
        },
    ] = diagnosis.causes[..]
    else {
        panic!("{:?}", diagnosis.causes)
    };
    assert_eq!(diagnosis.advice[0], Advice::Host);
}

#[test]
fn commands_that_left_too_late_are_told_from_the_counts() {
    let told = |turnaround, what: &str| {
        let mut story = Story::of(Model::fr3(), Generator::None);
        for lost in 1..=19_u32 {
            let rate = 1.0 - f64::from(lost) / 100.0;
            story.go(|_, _| {}, |state| state.control_command_success_rate = rate);
        }
        let mut counts = MotionStatistics::default();
        counts.overruns = 20;
        counts.worst_turnaround = Duration::from_micros(turnaround);
        let errors = [E::CommunicationConstraintsViolation];
        let diagnosis = story.stop_counted(Some(&counts), &errors, |_, _| {}, |_| {});
        let text = format!("20 commands left this computer too late: {what}");
        let late = |cause: &Cause| cause.to_string() == text;
        let first = diagnosis.causes.iter().position(late);
        let lost = |cause: &Cause| matches!(cause, Cause::LostPackets { commands: 20, .. });
        assert!(diagnosis.causes.iter().any(lost), "{diagnosis}");
        (first, diagnosis.advice[0])
    };
    let slow = told(1800, "the answer to a state took up to 1.8 ms");
    assert_eq!(slow, (Some(0), Advice::Host));
    // The states may have been delayed by the network.
    let quick = told(
        45,
        "states arrived late, and each was answered within 0.045 ms",
    );
    assert_eq!(quick, (Some(1), Advice::Network));
}

#[test]
fn states_that_a_slow_function_skips_are_not_lost() {
    let mut story = Story::of(Model::fr3(), Generator::None);
    // Each call takes 3 ms: the robot misses three commands, and two states are skipped.
    let slow = |state: &mut franka_proto::RobotState| state.message_id += 2;
    for call in 1..=6_u32 {
        let rate = 1.0 - f64::from(3 * call) / 100.0;
        story.go(
            |_, _| {},
            |state| {
                slow(state);
                state.control_command_success_rate = rate;
            },
        );
    }
    let mut counts = MotionStatistics::default();
    counts.skipped_states = 14;
    counts.overruns = 7;
    counts.worst_turnaround = Duration::from_millis(3);
    let errors = [E::CommunicationConstraintsViolation];
    let diagnosis = story.stop_counted(Some(&counts), &errors, |_, _| {}, slow);
    let [
        Cause::LateCommands { count: 7, .. },
        Cause::LostPackets {
            states: 0,
            commands: 7,
            unanswered: 14,
            longest_run: 21,
            ..
        },
    ] = diagnosis.causes[..]
    else {
        panic!("{:?}", diagnosis.causes)
    };
    assert_eq!(finding(&diagnosis).value, 20.0);
    assert_eq!(diagnosis.advice[0], Advice::Host);
}

#[test]
fn states_lost_while_a_function_blocks_are_blamed_on_host() {
    let told = |turnaround| {
        let story = Story::of(Model::fr3(), Generator::None);
        let mut counts = MotionStatistics::default();
        counts.overruns = 50;
        counts.worst_turnaround = Duration::from_millis(turnaround);
        let errors = [E::CommunicationConstraintsViolation];
        let gap = |state: &mut franka_proto::RobotState| state.message_id += 200;
        let diagnosis = story.stop_counted(Some(&counts), &errors, |_, _| {}, gap);
        let lost = |cause: &Cause| matches!(cause, Cause::LostPackets { states: 200, .. });
        (diagnosis.causes.iter().position(lost), diagnosis.advice)
    };
    assert_eq!(told(250), (Some(1), vec![Advice::Host]));
    assert_eq!(told(5), (Some(0), vec![Advice::Network, Advice::Host]));
}
