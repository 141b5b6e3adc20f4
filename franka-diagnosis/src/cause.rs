//! Causes in a diagnosis and their texts. The module `reflex_reason` selects the causes.

use core::fmt;
use core::time::Duration;

use franka_model::CYCLE;

use super::finding::{Digits, Quantity, Subject};

/// Returns true if the driver took longer than one cycle to answer a state.
pub(super) fn is_slow(turnaround: Duration) -> bool {
    turnaround.as_secs_f64() > CYCLE
}

/// An event in the log that led to the end of a motion. Each cycle is identified by the
/// `message_id` of its state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Cause {
    /// A command jumped: it differs from the command that the robot published in its last state.
    TargetStep {
        /// The part of the command that jumps.
        subject: Subject,
        /// The quantity that jumps: the position, velocity, acceleration or torque.
        quantity: Quantity,
        /// Size of the jump, in the unit of the quantity. It is the difference between the command
        /// and an unchanged continuation of the previous commands.
        size: f64,
        /// Cycle of the state that the command answers.
        cycle: u64,
    },
    /// The first command did not match the robot's position.
    WrongStart {
        /// The part of the command that differs.
        subject: Subject,
        /// The quantity that differs.
        quantity: Quantity,
        /// Size of the difference, in the unit of the quantity.
        offset: f64,
        /// Cycle of the state that the command answers.
        cycle: u64,
    },
    /// The command that ended the motion was still moving.
    FinishedMoving {
        /// The part of the arm that was moving.
        subject: Subject,
        /// Velocity of this part, `[rad/s]` or `[m/s]`.
        velocity: f64,
        /// Cycle of the state that the command answers.
        cycle: u64,
    },
    /// The robot received no command in some cycles.
    LostPackets {
        /// Number of states that did not arrive, so this host did not answer them.
        states: u64,
        /// Number of commands that were sent but did not arrive in time, computed from the robot's
        /// success rate.
        commands: u64,
        /// Number of states that arrived but were not answered.
        unanswered: u64,
        /// Largest number of consecutive cycles without a command.
        longest_run: u64,
        /// First cycle without a command.
        first: u64,
        /// Last cycle without a command.
        last: u64,
        /// `control_command_success_rate` in the last received state of the motion, in `[0, 1]`.
        success_rate: f64,
    },
    /// Some commands of the motion left this host after the next state was due.
    LateCommands {
        /// Number of late commands.
        count: u64,
        /// Longest time from the arrival of a state in the control thread to the command that
        /// answers it.
        worst_turnaround: Duration,
    },
    /// The estimated external force or torque exceeded the lower (contact) threshold.
    Contact {
        /// The joint or the axis of the base frame at which the robot senses the contact.
        subject: Subject,
        /// Largest estimate during the contact: `[N·m]` for a joint or a rotation, `[N]` for a
        /// translation. It is positive when the robot pushes the environment.
        value: f64,
        /// First cycle of the uninterrupted period above the lower threshold.
        since: u64,
    },
    /// A Cartesian motion reached a pose in which small motions require fast joints.
    Singularity {
        /// Smallest singular value of the Jacobian of the end effector, with rows in metres and
        /// radians. It is 0.14 to 0.23 in ordinary poses.
        smallest: f64,
        /// Angle of joint 4 from its position in the stretched arm, `[rad]`.
        stretch: f64,
        /// Cycle of the state that contains this desired pose.
        cycle: u64,
    },
    /// A joint is near one end of its range, where its speed towards this end is limited.
    Limit {
        /// Number of the joint, 1 to 7.
        joint: u8,
        /// True for the upper end of the range.
        upper: bool,
        /// Remaining distance to the end of the range, `[rad]`; negative beyond the end.
        distance: f64,
        /// Largest speed towards the end at this position, `[rad/s]`.
        speed: f64,
        /// Cycle of the state that contains this joint position.
        cycle: u64,
    },
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TargetStep {
                subject,
                quantity,
                size,
                cycle,
            } => write!(
                f,
                "{} step of {}, {subject}, in cycle {cycle}",
                noun(quantity),
                quantity.of(subject, size),
            ),
            Self::WrongStart {
                subject,
                quantity,
                offset,
                cycle,
            } => write!(
                f,
                "a first command {} away from the robot's own value, {subject}, in cycle {cycle}",
                quantity.of(subject, offset),
            ),
            Self::FinishedMoving {
                subject,
                velocity,
                cycle,
            } => write!(
                f,
                "a motion finished at {}, {subject}, in cycle {cycle}",
                Quantity::Velocity.of(subject, velocity),
            ),
            Self::LostPackets {
                states,
                commands,
                unanswered,
                longest_run,
                first,
                last,
                success_rate,
            } => {
                write!(f, "lost packets:")?;
                let mut comma = "";
                for (count, what, end) in [
                    (states, "state", " did not arrive"),
                    (commands, "command", " did not reach the robot in time"),
                    (unanswered, "state", " got no answer"),
                ] {
                    if count > 0 {
                        write!(f, "{comma} {}{end}", Count(count, what))?;
                        comma = ",";
                    }
                }
                write!(
                    f,
                    " (at most {longest_run} in a row, cycles {first} to {last}, last reported success rate {})",
                    Digits(success_rate)
                )
            }
            Self::LateCommands {
                count,
                worst_turnaround,
            } => {
                write!(
                    f,
                    "{} left this computer too late: ",
                    Count(count, "command")
                )?;
                let longest = Digits(worst_turnaround.as_secs_f64() * 1e3);
                match is_slow(worst_turnaround) {
                    true => write!(f, "the answer to a state took up to {longest} ms"),
                    false => write!(
                        f,
                        "states arrived late, and each was answered within {longest} ms"
                    ),
                }
            }
            Self::Contact {
                subject,
                value,
                since,
            } => write!(
                f,
                "contact, {subject}, up to {}, since cycle {since}",
                Quantity::ExternalLoad.of(subject, value)
            ),
            Self::Singularity {
                smallest,
                stretch,
                cycle,
            } => {
                write!(
                    f,
                    "a singular pose in cycle {cycle}: smallest singular value {}",
                    Digits(smallest)
                )?;
                if stretch.abs() < STRETCHED {
                    write!(f, ", the elbow {} rad from stretched", Digits(stretch))?;
                }
                Ok(())
            }
            Self::Limit {
                joint,
                upper,
                distance,
                speed,
                cycle,
            } => {
                let (way, end) = (
                    if distance < 0.0 { "beyond" } else { "from" },
                    if upper { "upper" } else { "lower" },
                );
                write!(
                    f,
                    "joint {joint} {} rad {way} its {end} limit",
                    Digits(distance.abs())
                )?;
                write!(
                    f,
                    " in cycle {cycle}, where {} rad/s is allowed towards it",
                    Digits(speed)
                )
            }
        }
    }
}

/// A number with the noun that it counts.
struct Count(u64, &'static str);

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let &Self(count, what) = self;
        write!(f, "{count} {what}{}", if count == 1 { "" } else { "s" })
    }
}

fn noun(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Velocity => "a velocity",
        Quantity::Acceleration => "an acceleration",
        Quantity::Torque => "a torque",
        _ => "a target",
    }
}

/// Distance of joint 4 from its stretched position below which the text mentions the elbow,
/// `[rad]`.
const STRETCHED: f64 = 0.3;
