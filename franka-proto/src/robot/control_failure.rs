//! The text of a motion that ended abnormally, as in libfranka's `ControlException`.

use core::fmt;

use super::{Errors, MoveStatus, Refusal, Status};
use crate::number_text::General;

/// A motion that ended abnormally, with data from the log of its last cycles.
///
/// `Display` prints the message of libfranka's `ControlException`: the refusal's text, and after a
/// reflex also the errors and the success rate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ControlFailure {
    /// The robot's last answer to the `Move`.
    pub refusal: Refusal,
    /// `reflex_reason` of the state in which the client saw the end of the motion.
    pub reflex_reason: Errors,
    /// Success rate from the last two records of the log. It is `None` if the log has fewer
    /// records.
    pub success_rate: Option<SuccessRate>,
}

impl fmt::Display for ControlFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.refusal)?;
        if self.refusal.status() == Status::Move(MoveStatus::ReflexAborted) {
            write!(f, " {}", self.reflex_reason)?;
            if let Some(success_rate) = self.success_rate {
                write!(f, "{success_rate}")?;
            }
        }
        Ok(())
    }
}

impl core::error::Error for ControlFailure {}

/// The command success rate at the end of a motion.
///
/// `Display` prints the last part of libfranka's message, including the line break before it.
///
/// ```
/// use franka_proto::SuccessRate;
///
/// // The last state always reports 0: the rate is from the record before it.
/// let rate = SuccessRate::of_log(0.77, 1000, 1004);
/// assert_eq!(rate.to_string(), "\ncontrol_command_success_rate: 0.7469 packets lost in a row in the last sample: 3");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SuccessRate {
    /// Share of commands that arrived in time, 0 to 1.
    pub rate: f64,
    /// Number of states lost between the last two records.
    pub lost: u64,
}

impl SuccessRate {
    /// Computes the success rate from the last two records of the log, as libfranka 0.21 does. The
    /// result is the rate in the second-to-last record, reduced by 1 % of its value for every
    /// state lost between the two records. It is at least 0; libfranka's result can be negative.
    /// Times are `message_id`s `[ms]`.
    #[must_use]
    pub fn of_log(success_rate: f64, time: u64, last_time: u64) -> Self {
        let lost = last_time.saturating_sub(time).saturating_sub(1);
        Self {
            rate: success_rate * (1.0 - lost as f64 / 100.0).max(0.0),
            lost,
        }
    }
}

impl fmt::Display for SuccessRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rate = General(self.rate);
        write!(f, "\ncontrol_command_success_rate: {rate}")?;
        if self.lost > 0 {
            let lost = self.lost;
            write!(f, " packets lost in a row in the last sample: {lost}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Command;
    use crate::robot::RobotError;
    use crate::robot::RobotMode;
    use std::string::ToString;

    #[test]
    fn states_out_of_order_count_as_none_lost() {
        assert_eq!(SuccessRate::of_log(0.5, 7, 7).lost, 0);
        assert_eq!(SuccessRate::of_log(0.5, 8, 7).lost, 0);
    }

    #[test]
    fn a_rate_is_never_below_zero() {
        assert_eq!(SuccessRate::of_log(0.5, 0, 302).rate, 0.0);
    }

    #[test]
    fn only_a_reflex_tells_its_errors_and_the_rate() {
        let failure = |status| {
            let refusal =
                Refusal::new(Command::Move, Status::Move(status), RobotMode::Reflex).unwrap();
            let failure = ControlFailure {
                refusal,
                reflex_reason: RobotError::CommunicationConstraintsViolation.into(),
                success_rate: Some(SuccessRate {
                    rate: 0.77,
                    lost: 3,
                }),
            };
            failure.to_string()
        };
        assert_eq!(
            failure(MoveStatus::ReflexAborted),
            "libfranka: Move command aborted: motion aborted by reflex! \
             [\"communication_constraints_violation\"]\n\
             control_command_success_rate: 0.77 packets lost in a row in the last sample: 3"
        );
        assert_eq!(
            failure(MoveStatus::EmergencyAborted),
            "libfranka: Move command aborted: User Stop pressed!"
        );
    }
}
