//! The causes that a diagnosis can name, and their text. `reasoning` selects them.

use core::fmt;
use core::time::Duration;

use franka_model::CYCLE;

use super::finding::{Digits, Quantity, Subject};

/// True if the answer to a state took longer than a cycle.
pub(super) fn is_slow(turnaround: Duration) -> bool {
    turnaround.as_secs_f64() > CYCLE
}

/// Something in the log that led up to the end of a motion. Cycles are the `message_id`s of states.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Cause {
    /// A command that leaps from where the robot was told to be.
    TargetStep {
        /// What leaps.
        subject: Subject,
        /// Its position, velocity, acceleration or torque.
        quantity: Quantity,
        /// By how much, beyond what going on as before would have been, in the unit of the
        /// quantity.
        size: f64,
        /// The command answers this state.
        cycle: u64,
    },
    /// The first command was not where the robot was.
    WrongStart {
        /// What is off.
        subject: Subject,
        /// What of it.
        quantity: Quantity,
        /// By how much, in the unit of the quantity.
        offset: f64,
        /// The command answers this state.
        cycle: u64,
    },
    /// The command that ended the motion was one that moves.
    FinishedMoving {
        /// What moves.
        subject: Subject,
        /// With this velocity, `[rad/s]` or `[m/s]`.
        velocity: f64,
        /// The command answers this state.
        cycle: u64,
    },
    /// Cycles that passed without a command.
    LostPackets {
        /// States that did not arrive, so that nothing answered them.
        states: u64,
        /// Commands that were sent and did not arrive in time, by the success rate that the robot
        /// reports.
        commands: u64,
        /// States that arrived and were not answered.
        unanswered: u64,
        /// Most of them in a row.
        longest_run: u64,
        /// The first of them.
        first: u64,
        /// The last of them.
        last: u64,
        /// `control_command_success_rate` of the last state of the motion that was received, in
        /// `[0, 1]`.
        success_rate: f64,
    },
    /// Commands left this host after the next state was due, at some time in the motion.
    LateCommands {
        /// How many.
        count: u64,
        /// Longest time from when the thread had a state to its command.
        worst_turnaround: Duration,
    },
    /// The estimate of an external force or torque was above the lower threshold.
    Contact {
        /// The joint, or the axis of the base frame.
        subject: Subject,
        /// The largest estimate in these cycles: `[N·m]` of a joint or a rotation, `[N]` of a
        /// translation. Positive is what the robot does to its surroundings.
        value: f64,
        /// Since when it was above the lower threshold, without a break.
        since: u64,
    },
    /// A Cartesian motion in a pose where joints have to move fast for little.
    Singularity {
        /// Smallest singular value of the Jacobian of the end effector, metres and radians mixed;
        /// 0.14 to 0.23 in ordinary poses.
        smallest: f64,
        /// What joint 4 is from where the arm is stretched, `[rad]`.
        stretch: f64,
        /// The pose that the robot was told to have in this state.
        cycle: u64,
    },
    /// A joint near the end of its range, where less speed is allowed towards it.
    Limit {
        /// 1 to 7.
        joint: u8,
        /// True if it is the upper end.
        upper: bool,
        /// What is left, `[rad]`; negative beyond it.
        distance: f64,
        /// The greatest speed towards it there, `[rad/s]`.
        speed: f64,
        /// In this state.
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
                "a first command {} away from the robot's own, {subject}, in cycle {cycle}",
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
                        "it had states late, and answered each within {longest} ms"
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

/// So many of something.
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

/// Of joint 4, `[rad]`: nearer to stretched than this, the elbow is worth a word.
const STRETCHED: f64 = 0.3;
