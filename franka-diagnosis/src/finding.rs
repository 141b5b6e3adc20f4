//! Exceeded limits: the part of the arm, the quantity, the excess and the first cycle.

use core::fmt;

use franka_proto::RobotError;

/// The part of the arm that a number describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Subject {
    /// A joint, numbered 1 to 7 from the base.
    Joint(u8),
    /// The translation of the end effector. Limits apply to the norm of the vector. The axis is the
    /// direction of its largest component.
    Translation(Axis),
    /// The rotation of the end effector. The axis is the direction of the largest component.
    Rotation(Axis),
    /// The elbow: the angle of joint 3 in a Cartesian motion.
    Elbow,
    /// Two bodies of the arm: 0 is the base, 1 to 7 are the links, and 8 is the tool on the flange.
    Bodies(u8, u8),
    /// The arm as a whole.
    Arm,
}

/// An axis of the base frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Axis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

/// A measured or commanded quantity of a [`Subject`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Quantity {
    /// Position, `[rad]` or `[m]`.
    Position,
    /// Velocity, `[rad/s]` or `[m/s]`.
    Velocity,
    /// Acceleration, `[rad/s²]` or `[m/s²]`.
    Acceleration,
    /// Jerk, `[rad/s³]` or `[m/s³]`.
    Jerk,
    /// Torque, `[N·m]`.
    Torque,
    /// Torque rate, `[N·m/s]`.
    TorqueRate,
    /// The robot's estimate of the external load: `[N·m]` for a joint or a rotation, `[N]` for a
    /// translation.
    ExternalLoad,
    /// Difference between the commanded position in the state and the first command, `[rad]` or
    /// `[m]`.
    StartOffset,
    /// Distance between the measured pose and the desired pose, `[m]`.
    Deviation,
    /// Distance between two bodies, `[m]`.
    Distance,
    /// Mechanical power of all joints, `[W]`.
    Power,
    /// Number of consecutive cycles without a command.
    LostCycles,
    /// Number of sign changes of the velocity within the log.
    Reversals,
}

/// Origin of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Origin {
    /// Commands. The value is a difference over one cycle, relative to the values that the robot
    /// published in the state before.
    Commanded,
    /// Joint positions of a Cartesian command, computed by this driver's inverse kinematics.
    Desired,
    /// Sensors.
    Measured,
    /// The robot's estimates of external loads.
    Estimated,
}

/// Limit of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Bound {
    /// Upper limit: the nominal limit of the robot's model in the positive direction.
    AtMost(f64),
    /// Lower limit: the nominal limit of the robot's model in the negative direction, or the lower
    /// end of a range.
    AtLeast(f64),
    /// A threshold that no state contains. It lies between two magnitudes: the first magnitude did
    /// not exceed it, and the second did.
    Between(f64, f64),
    /// An unknown limit: it is not published, and no state contains it.
    Unknown,
}

/// A limit that was exceeded.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Finding {
    /// The error that reports the exceeded limit.
    pub error: RobotError,
    /// The joint, axis or part that exceeded the limit.
    pub subject: Subject,
    /// The quantity that exceeded the limit.
    pub quantity: Quantity,
    /// The source of the value.
    pub origin: Origin,
    /// The largest value, in the unit of its [`Quantity`].
    pub value: f64,
    /// The limit of the value, in the same unit.
    pub bound: Bound,
    /// First of the consecutive cycles in which the limit was exceeded. The cycle is given as the
    /// `message_id` of the state that the command answers, or that contains the measurement.
    pub since: u64,
}

impl Finding {
    /// Returns the excess over the limit, in the unit of the quantity; `None` if the limit is
    /// unknown. The excess is zero or slightly negative, by a few hundredths of the limit, if the
    /// state is not precise enough to show an excess.
    pub fn excess(&self) -> Option<f64> {
        self.bound.excess(self.value)
    }

    /// Returns the ratio of the value to the limit; `None` if the limit is zero, unknown, or the
    /// limit of a position.
    pub fn times(&self) -> Option<f64> {
        let limit = self.bound.limit()?;
        let is_scale = limit != 0.0 && self.quantity != Quantity::Position;
        is_scale.then_some(self.value / limit)
    }
}

impl Bound {
    /// Returns the nominal limit, if known.
    pub fn limit(self) -> Option<f64> {
        match self {
            Self::AtMost(limit) | Self::AtLeast(limit) => Some(limit),
            Self::Between(..) | Self::Unknown => None,
        }
    }

    /// Returns the excess of a value over the limit; negative if the value is within the limit.
    pub(super) fn excess(self, value: f64) -> Option<f64> {
        match self {
            Self::AtMost(limit) => Some(value - limit),
            Self::AtLeast(limit) => Some(limit - value),
            Self::Between(..) | Self::Unknown => None,
        }
    }
}

impl Subject {
    /// Returns joint number `index`, counted from 0.
    pub(super) fn joint(index: usize) -> Self {
        Self::Joint(index as u8 + 1)
    }

    /// Returns component number `index` of a twist or wrench, counted from 0.
    pub(super) fn component(index: usize) -> Self {
        let axis = [Axis::X, Axis::Y, Axis::Z][index % 3];
        if index < 3 {
            Self::Translation(axis)
        } else {
            Self::Rotation(axis)
        }
    }

    fn length(self) -> &'static str {
        match self {
            Self::Translation(_) => "m",
            _ => "rad",
        }
    }
}

impl Quantity {
    pub(super) fn of(self, subject: Subject, value: f64) -> Measure {
        Measure {
            quantity: self,
            subject,
            value,
            digits: DIGITS,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Torque => "torque",
            Self::TorqueRate => "torque rate",
            Self::ExternalLoad => "external load",
            Self::StartOffset => "offset of the first command",
            Self::Deviation => "deviation from the desired pose",
            Self::Distance => "distance",
            Self::Power => "power",
            Self::LostCycles => "cycles in a row without a command",
            Self::Reversals => "reversals of the velocity",
        }
    }
}

/// A number with its unit.
pub(super) struct Measure {
    quantity: Quantity,
    subject: Subject,
    value: f64,
    digits: u8,
}

impl Measure {
    /// Returns the same measure, with more digits if its text would otherwise equal the text of
    /// `other`.
    fn told_from(self, other: f64) -> Self {
        let same = |&digits: &u8| Digits(self.value).with(digits) == Digits(other).with(digits);
        let digits = (DIGITS..=DIGITS_MAX).find(|digits| !same(digits));
        Self {
            digits: digits.unwrap_or(DIGITS),
            ..self
        }
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = Digits(self.value).with(self.digits);
        let length = self.subject.length();
        match self.quantity {
            Quantity::Position | Quantity::StartOffset => write!(f, "{number} {length}"),
            Quantity::Velocity => write!(f, "{number} {length}/s"),
            Quantity::Acceleration => write!(f, "{number} {length}/s^2"),
            Quantity::Jerk => write!(f, "{number} {length}/s^3"),
            Quantity::ExternalLoad if length == "m" => write!(f, "{number} N"),
            Quantity::Torque | Quantity::ExternalLoad => write!(f, "{number} N m"),
            Quantity::TorqueRate => write!(f, "{number} N m/s"),
            Quantity::Deviation | Quantity::Distance => write!(f, "{number} m"),
            Quantity::Power => write!(f, "{number} W"),
            // The name of the quantity already contains the unit.
            Quantity::LostCycles | Quantity::Reversals => write!(f, "{number}"),
        }
    }
}

/// A number with four significant digits and no exponent, with at most six decimals.
pub(super) struct Digits(pub(super) f64);

/// Number of significant digits.
const DIGITS: u8 = 4;

/// Largest number of significant digits, used if two similar numbers must differ.
const DIGITS_MAX: u8 = 8;

impl Digits {
    fn with(&self, digits: u8) -> String {
        let value = self.0;
        if value == 0.0 || !value.is_finite() {
            return value.to_string();
        }
        let digits = f64::from(digits) - 1.0;
        let decimals = (digits - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') {
            let short = text.trim_end_matches('0').trim_end_matches('.');
            return short.to_owned();
        }
        text
    }
}

impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.with(DIGITS))
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let body = |number: u8| match number {
            0 => "base".to_owned(),
            8 => "tool".to_owned(),
            link => format!("link {link}"),
        };
        match *self {
            Self::Joint(number) => write!(f, "joint {number}"),
            Self::Translation(axis) => write!(f, "translation along {axis}"),
            Self::Rotation(axis) => write!(f, "rotation about {axis}"),
            Self::Elbow => write!(f, "elbow"),
            Self::Bodies(inner, outer) => write!(f, "{} and {}", body(inner), body(outer)),
            Self::Arm => write!(f, "arm"),
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Commanded => "commanded",
            Self::Desired => "resulting",
            Self::Measured => "measured",
            Self::Estimated => "estimated",
        })
    }
}

impl fmt::Display for Finding {
    /// Formats the finding like `joint 4: commanded acceleration 250 rad/s^2, limit 12.5 rad/s^2
    /// (20 times as much)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            subject,
            quantity,
            origin,
            ..
        } = *self;
        let value = quantity.of(subject, self.value);
        let value = match self.bound.limit() {
            Some(limit) if self.excess() > Some(0.0) => value.told_from(limit),
            _ => value,
        };
        match quantity {
            // The names of these quantities contain the origin.
            Quantity::LostCycles | Quantity::Reversals => {
                write!(f, "{subject}: {value} {}", quantity.name())?
            }
            Quantity::StartOffset | Quantity::Distance | Quantity::Deviation | Quantity::Power => {
                write!(f, "{subject}: {} {value}", quantity.name())?
            }
            _ => write!(f, "{subject}: {origin} {} {value}", quantity.name())?,
        }
        match self.bound {
            Bound::AtMost(limit) | Bound::AtLeast(limit) => {
                let limit = quantity.of(subject, limit);
                let excess = self.excess().unwrap_or_default();
                match self.times() {
                    _ if excess <= 0.0 && quantity == Quantity::LostCycles => {
                        write!(f, ", within the log; limit {limit}")
                    }
                    _ if excess <= 0.0 => write!(f, ", at the limit of {limit}"),
                    Some(times) if times > 1.1 => {
                        write!(
                            f,
                            ", limit {limit} ({} times as much)",
                            Digits(round(times))
                        )
                    }
                    _ => {
                        let excess = quantity.of(subject, excess);
                        write!(f, ", limit {limit} ({excess} beyond)")
                    }
                }
            }
            Bound::Between(passed, stopped) => write!(
                f,
                ", threshold above {} and up to {}",
                Digits(passed),
                quantity.of(subject, stopped)
            ),
            Bound::Unknown => Ok(()),
        }
    }
}

/// Rounds a ratio to two decimals.
fn round(times: f64) -> f64 {
    (times * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(quantity: Quantity, value: f64, bound: Bound) -> Finding {
        Finding {
            error: RobotError::JointVelocityViolation,
            subject: Subject::Joint(4),
            quantity,
            origin: Origin::Measured,
            value,
            bound,
            since: 7,
        }
    }

    #[test]
    fn a_finding_says_what_and_by_how_much() {
        for (finding, expected) in [
            (
                finding(Quantity::Velocity, -2.8, Bound::AtLeast(-2.62)),
                "joint 4: measured velocity -2.8 rad/s, limit -2.62 rad/s (0.18 rad/s beyond)",
            ),
            (
                finding(Quantity::Velocity, 3.93, Bound::AtMost(2.62)),
                "joint 4: measured velocity 3.93 rad/s, limit 2.62 rad/s (1.5 times as much)",
            ),
            (
                finding(Quantity::Acceleration, 10.0013, Bound::AtMost(10.0)),
                "joint 4: measured acceleration 10.001 rad/s^2, limit 10 rad/s^2 (0.0013 rad/s^2 beyond)",
            ),
            (
                finding(Quantity::Jerk, 4900.0, Bound::AtMost(5000.0)),
                "joint 4: measured jerk 4900 rad/s^3, at the limit of 5000 rad/s^3",
            ),
            (
                finding(Quantity::Velocity, 0.2, Bound::AtMost(0.0)),
                "joint 4: measured velocity 0.2 rad/s, limit 0 rad/s (0.2 rad/s beyond)",
            ),
            (
                finding(Quantity::Position, -3.1, Bound::AtLeast(-3.0481)),
                "joint 4: measured position -3.1 rad, limit -3.048 rad (0.0519 rad beyond)",
            ),
            (
                finding(Quantity::Position, -0.1, Bound::AtMost(-0.1458)),
                "joint 4: measured position -0.1 rad, limit -0.1458 rad (0.0458 rad beyond)",
            ),
            (
                finding(
                    Quantity::ExternalLoad,
                    -12.345,
                    Bound::Between(11.0, 12.345),
                ),
                "joint 4: measured external load -12.35 N m, threshold above 11 and up to 12.35 N m",
            ),
            (
                finding(Quantity::Power, 612.0, Bound::Unknown),
                "joint 4: power 612 W",
            ),
        ] {
            assert_eq!(finding.to_string(), expected);
        }
    }

    #[test]
    fn the_excess_counts_outwards() {
        for (value, bound, excess) in [
            (-2.75, Bound::AtLeast(-2.5), 0.25),
            (2.75, Bound::AtMost(2.5), 0.25),
            (2.25, Bound::AtMost(2.5), -0.25),
            (-0.125, Bound::AtMost(-0.25), 0.125),
        ] {
            let found = finding(Quantity::Velocity, value, bound).excess();
            assert_eq!(found, Some(excess));
        }
    }

    #[test]
    fn digits_are_four() {
        for (value, text) in [
            (0.0, "0"),
            (12_345.678, "12346"),
            (0.000_123_456, "0.000123"),
            (-2.5, "-2.5"),
            (100.0, "100"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(Digits(value).to_string(), text);
        }
    }
}
