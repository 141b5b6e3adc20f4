//! States and commands that are lost in a row. Both look the same to the robot: a state that does
//! not arrive is not answered.

use franka_model::Model;
use franka_proto::{MoveGeneratorMode, RobotError};

use crate::faults::expect::Expect;
use crate::faults::program::Misbehaviour;
use crate::faults::rules::{LOST_LIMIT, errors_after_loss};
use crate::faults::trial::{Moment, Trial};
use crate::faults::variant::{Channel, Variant, Way};
use crate::faults::{Matrix, course};

/// Messages that are lost.
#[derive(Clone, Copy, Debug)]
enum Lost {
    States,
    Commands,
}

impl Lost {
    const ALL: [Self; 2] = [Self::States, Self::Commands];

    fn lose(self, trial: &mut Trial, count: u64) {
        match self {
            Self::States => trial.lockstep.link.drop_states(count),
            Self::Commands => trial.lockstep.link.drop_commands(count),
        }
    }
}

/// Numbers of losses in a row: every number around the limit.
fn counts() -> impl Iterator<Item = u64> {
    const SAMPLE: [u64; 10] = [1, 2, 7, 13, 18, 19, 20, 21, 22, 30];
    (1..=30).filter(|count| franka_tests::thorough() || SAMPLE.contains(count))
}

fn expected(errors: franka_proto::Errors) -> Expect {
    if errors.is_empty() {
        Expect::Done
    } else {
        Expect::reflex(errors.iter())
    }
}

/// Change of the joint positions per distance of a Cartesian motion, `[rad/m]`, measured without a
/// fault.
fn joints_per_way(variant: Variant, channel: Channel) -> [f64; 7] {
    let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
    let before = trial.lockstep.client.state.q_d;
    trial.until(Moment::Cycle(course::END));
    let after = trial.lockstep.client.state.q_d;
    let way = course::full_speed(channel.generator) * course::way(course::END);
    core::array::from_fn(|i| (after[i] - before[i]) / way)
}

/// Up to nineteen losses are bridged, if the robot's extrapolation fits the commands after them.
#[test]
fn losses_in_mid_motion_are_bridged_or_named() {
    let mut matrix = Matrix::new("lost");
    let cruise = course::REST + course::RAMP + 3;
    let ramp = course::REST + course::RAMP / 2;
    for (variant, channel) in Variant::cyclic() {
        let model = Model::of(variant.kind);
        let joints = joints_per_way(variant, channel);
        for count in counts() {
            for first in [cruise, ramp] {
                for lost in Lost::ALL {
                    let name = format!("{variant}/{count}-{lost:?}-from-{first}");
                    matrix.case(name, || {
                        let errors = errors_after_loss(model, channel, &joints, first, count);
                        let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                        trial.until(Moment::Cycle(first));
                        lost.lose(&mut trial, count);
                        let outcome = trial.outcome();
                        expected(errors).check(&trial, &outcome);
                        if let Ok(report) = outcome {
                            let states = matches!(lost, Lost::States);
                            assert_eq!(report.lost_states, if states { count } else { 0 });
                        }
                        trial.works_again();
                    });
                }
            }
        }
    }
    matrix.finish();
}

/// Before the first command the robot waits and counts no losses. A client without states has not
/// begun. A client whose commands are lost has begun, and its program runs ahead of the robot.
#[test]
fn the_robot_counts_no_losses_before_the_first_command() {
    let mut matrix = Matrix::new("lost-first");
    for variant in Variant::all() {
        let joints = match variant.channel() {
            Some(channel) => joints_per_way(variant, channel),
            None => [0.0; 7],
        };
        for count in counts() {
            for lost in Lost::ALL {
                matrix.case(format_args!("{variant}/{count}-{lost:?}"), || {
                    let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                    lost.lose(&mut trial, count);
                    let outcome = trial.outcome();
                    let expected = match (variant.channel(), lost) {
                        (Some(channel), Lost::Commands) => {
                            let model = Model::of(variant.kind);
                            expected(errors_after_loss(model, channel, &joints, 0, count))
                        }
                        _ => Expect::Done,
                    };
                    expected.check(&trial, &outcome);
                    trial.works_again();
                });
            }
        }
    }
    matrix.finish();
}

/// The finishing command is repeated until a state shows that the robot has received it. States
/// that are lost after that make no difference.
#[test]
fn a_lost_finish_is_repeated_until_the_robot_stops_by_itself() {
    let mut matrix = Matrix::new("lost-last");
    for variant in Variant::all() {
        for count in counts() {
            for lost in Lost::ALL {
                matrix.case(format_args!("{variant}/{count}-{lost:?}"), || {
                    let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                    match lost {
                        Lost::Commands => trial.lockstep.link.drop_finishing(count),
                        Lost::States => {
                            trial.until(Moment::Finishing(0));
                            trial.lockstep.link.drop_states(count);
                        }
                    }
                    let outcome = trial.outcome();
                    let expected = match lost {
                        // A motion between sparse targets needs no command per cycle.
                        Lost::Commands
                            if count >= LOST_LIMIT && variant.way != Way::Asynchronous =>
                        {
                            Expect::reflex([RobotError::CommunicationConstraintsViolation])
                        }
                        _ => Expect::Done,
                    };
                    expected.check(&trial, &outcome);
                    trial.works_again();
                });
            }
        }
    }
    matrix.finish();
}

/// The robot repeats the last torques when commands are lost, and target control limits its torques
/// against those.
#[test]
fn target_control_survives_all_losses_the_robot_bridges() {
    let mut matrix = Matrix::new("lost-target");
    for variant in Variant::all().filter(|variant| variant.is_target()) {
        for count in counts() {
            for first in [1, 40, course::END + 100] {
                for lost in Lost::ALL {
                    let name = format!("{variant}/{count}-{lost:?}-from-{first}");
                    matrix.case(name, || {
                        let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                        trial.until(Moment::Cycle(first));
                        lost.lose(&mut trial, count);
                        let outcome = trial.outcome();
                        let expected = if count < LOST_LIMIT {
                            Expect::Done
                        } else {
                            Expect::reflex([RobotError::CommunicationConstraintsViolation])
                        };
                        expected.check(&trial, &outcome);
                        trial.works_again();
                    });
                }
            }
        }
    }
    matrix.finish();
}

/// The robot plans between sparse targets and keeps moving without commands.
#[test]
fn sparse_targets_need_no_command_per_cycle() {
    let mut matrix = Matrix::new("lost-asynchronous");
    for variant in Variant::all().filter(|variant| variant.way == Way::Asynchronous) {
        for count in [1, 19, 20, 30, 70] {
            for lost in Lost::ALL {
                matrix.case(format_args!("{variant}/{count}-{lost:?}"), || {
                    let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                    trial.until(Moment::Cycle(course::REST + 2));
                    lost.lose(&mut trial, count);
                    let outcome = trial.outcome();
                    Expect::Done.check(&trial, &outcome);
                    let q_d = trial.lockstep.client.state.q_d[course::JOINT];
                    let way = q_d - franka_model::READY[course::JOINT];
                    assert!((way - 0.003).abs() < 1e-4, "it has moved by {way} rad");
                    trial.works_again();
                });
            }
        }
    }
    matrix.finish();
}

#[test]
fn the_course_keeps_every_limit() {
    for channel in Channel::ALL {
        for kind in franka_model::RobotKind::ALL {
            let model = Model::of(kind);
            let per_metre = match channel.generator {
                MoveGeneratorMode::CartesianPosition | MoveGeneratorMode::CartesianVelocity => 3.5,
                _ => 0.0,
            };
            let errors = errors_after_loss(model, channel, &[per_metre; 7], 1, 0);
            assert!(errors.is_empty(), "{kind:?} {channel:?}: {errors}");
        }
    }
}
