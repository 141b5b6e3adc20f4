//! Tare of the external wrench. The robot reports a wrench even if nothing touches the arm, and a
//! [`WrenchTare`] subtracts it.
//!
//! The models of arm, tool and friction are never exact, so this wrench is a newton or two. A
//! [`WrenchTare`] is the average of the robot's estimates at rest. It holds for the posture in
//! which it was taken: the part that comes from wrong weights turns with the arm. Friction also
//! differs after each motion.
//!
//! # The moment
//!
//! According to the vendor's documentation, `O_F_ext_hat_K` acts on the stiffness frame, in axes of
//! the base. In recordings of both robots, however, its moment is about the origin of the base, so
//! it changes with the position of the arm. The moment of `K_F_ext_hat_K` is about the stiffness
//! frame in either case. The tare therefore uses the moment of `K_F_ext_hat_K`, rotated into axes
//! of the base.

use core::time::Duration;

use franka_proto::{RobotMode, RobotState};

/// Average of the robot's estimates at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WrenchTare {
    /// Force, then moment about the origin of the stiffness frame, in axes of the base, `[N, N m]`.
    pub wrench: [f64; 6],
    /// Standard deviation of each component of the wrench over the averaged states, `[N, N m]`.
    pub deviation: [f64; 6],
    /// Average of the external joint torques, `tau_ext_hat_filtered`, `[N m]`.
    pub joint_torques: [f64; 7],
    /// Average of the joint positions, `[rad]`.
    pub q: [f64; 7],
    /// `message_id` of the last averaged state, `[ms]` of the robot's clock.
    pub time: u64,
    /// Number of averaged states.
    pub states: u32,
}

impl WrenchTare {
    /// Default time over which states are averaged.
    pub const DURATION: Duration = Duration::from_millis(500);

    /// Largest change of any joint since the tare for which the tare is assumed to hold, `[rad]`.
    /// The value is a convention: for an undeclared kilogram at half a metre, two degrees change
    /// the torque by less than 0.2 N m.
    pub const NEAR: f64 = 0.035;

    /// Returns the wrench of a state minus the tare: force, then moment about the origin of the
    /// stiffness frame, in axes of the base, `[N, N m]`. It is the wrench that the arm exerts.
    /// `None` if the robot has no estimate, because near a singularity it reports zeros.
    pub fn compensate(&self, state: &RobotState) -> Option<[f64; 6]> {
        let wrench = estimate(state)?;
        Some(core::array::from_fn(|i| wrench[i] - self.wrench[i]))
    }

    /// Returns the external joint torques of a state minus the tare, `[N m]`.
    pub fn compensate_torques(&self, state: &RobotState) -> [f64; 7] {
        core::array::from_fn(|i| state.tau_ext_hat_filtered[i] - self.joint_torques[i])
    }

    /// Returns the largest change of any joint position since the tare, `[rad]`. The tare is
    /// assumed to hold within [`Self::NEAR`].
    pub fn turned(&self, state: &RobotState) -> f64 {
        let turned = (0..7).map(|i| (state.q[i] - self.q[i]).abs());
        turned.fold(0.0, f64::max)
    }
}

/// Reason why a tare was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TareRefused {
    /// A joint moves.
    #[error(
        "joint {joint} moves at {speed:.3} rad/s, {way:.4} rad since the first state, expected at \
         most \
         {SPEED} rad/s and {WAY} rad: wait until the arm rests"
    )]
    Moves {
        /// Number of the joint, 1 to 7.
        joint: u8,
        /// Velocity of the joint, `[rad/s]`.
        speed: f64,
        /// Distance of the joint from its position in the first state of the average, `[rad]`.
        way: f64,
    },
    /// A goal is under way. Even if the arm stands still, the law may push it against friction.
    #[error("a motion is running, expected none: await its end before the tare")]
    UnderWay,
    /// The robot is in a mode in which its torques do not measure the offset.
    #[error(
        "the robot is in mode {got}, expected idle or move: the arm must hold itself, untouched"
    )]
    Mode {
        /// The robot's mode.
        got: RobotMode,
    },
    /// The robot reports a contact.
    #[error("the robot reports a contact, expected none: nothing may touch the arm during a tare")]
    Contact,
    /// The robot reports no estimate in this posture.
    #[error(
        "the robot reports no external wrench, expected one: this posture is near a singularity, \
         so take \
         the tare in another posture"
    )]
    NoEstimate,
    /// The duration is out of range.
    #[error("the duration of the tare is {got:?}, expected 20 ms to 60 s")]
    Duration {
        /// The given duration.
        got: Duration,
    },
}

/// Computes a tare from states that are added one by one.
#[derive(Clone, Debug)]
pub struct Taring {
    duration: u64,
    first: Option<RobotState>,
    states: u32,
    sum: [f64; NUMBERS],
    squares: [f64; 6],
}

/// Number of averaged values: wrench, joint torques, joint positions.
const NUMBERS: usize = 6 + 7 + 7;

impl Taring {
    /// Returns a taring that averages states over `duration`, by the robot's clock.
    ///
    /// # Errors
    /// Returns [`TareRefused::Duration`] if `duration` is out of range.
    pub fn over(duration: Duration) -> Result<Self, TareRefused> {
        let range = Duration::from_millis(20)..=Duration::from_secs(60);
        if !range.contains(&duration) {
            return Err(TareRefused::Duration { got: duration });
        }
        Ok(Self {
            duration: duration.as_millis() as u64,
            first: None,
            states: 0,
            sum: [0.0; NUMBERS],
            squares: [0.0; 6],
        })
    }

    /// Adds a state. Returns the tare once the states span the duration. Every call counts, so add
    /// each state once.
    ///
    /// # Errors
    /// Returns [`TareRefused`] if the state does not show an untouched arm at rest.
    pub fn push(&mut self, state: &RobotState) -> Result<Option<WrenchTare>, TareRefused> {
        let first = *self.first.get_or_insert(*state);
        check(state, &first)?;
        let wrench = estimate(state).ok_or(TareRefused::NoEstimate)?;
        // Summing differences from the first state avoids the loss of digits.
        let start = estimate(&first).ok_or(TareRefused::NoEstimate)?;
        self.states += 1;
        for i in 0..6 {
            let off = wrench[i] - start[i];
            self.sum[i] += off;
            self.squares[i] += off * off;
        }
        for i in 0..7 {
            self.sum[6 + i] += state.tau_ext_hat_filtered[i];
            self.sum[13 + i] += state.q[i];
        }
        let lasted = state.message_id.saturating_sub(first.message_id);
        if lasted < self.duration {
            return Ok(None);
        }
        let count = f64::from(self.states);
        let mean = self.sum.map(|sum| sum / count);
        Ok(Some(WrenchTare {
            wrench: core::array::from_fn(|i| start[i] + mean[i]),
            deviation: core::array::from_fn(|i| {
                (self.squares[i] / count - mean[i] * mean[i])
                    .max(0.0)
                    .sqrt()
            }),
            joint_torques: core::array::from_fn(|i| mean[6 + i]),
            q: core::array::from_fn(|i| mean[13 + i]),
            time: state.message_id,
            states: self.states,
        }))
    }
}

fn check(state: &RobotState, first: &RobotState) -> Result<(), TareRefused> {
    if !matches!(state.robot_mode, RobotMode::Idle | RobotMode::Move) {
        return Err(TareRefused::Mode {
            got: state.robot_mode,
        });
    }
    for i in 0..7 {
        let (speed, way) = (state.dq[i], state.q[i] - first.q[i]);
        // NaN does not count as rest.
        if !(speed.abs() <= SPEED && way.abs() <= WAY) {
            let joint = i as u8 + 1;
            return Err(TareRefused::Moves { joint, speed, way });
        }
    }
    let mut flags = state.joint_contact.iter().chain(&state.cartesian_contact);
    if flags.any(|flag| *flag != 0.0) {
        return Err(TareRefused::Contact);
    }
    Ok(())
}

/// Returns force and moment about the origin of the stiffness frame, in axes of the base. `None` if
/// the robot has no estimate and reports zeros.
fn estimate(state: &RobotState) -> Option<[f64; 6]> {
    let wrench = state.wrench_at_stiffness_frame();
    let is_there = wrench.iter().all(|number| number.is_finite())
        && wrench.iter().any(|number| *number != 0.0);
    is_there.then_some(wrench)
}

/// Highest joint velocity at which an arm counts as resting, `[rad/s]`. It is twenty times the
/// velocity that real resting arms report.
const SPEED: f64 = 0.02;

/// Largest movement of a joint during the average, `[rad]`.
const WAY: f64 = 0.002;

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    /// Returns the state of an arm whose estimate has an offset and noise.
    fn state(message_id: u64) -> RobotState {
        let noise = if message_id.is_multiple_of(2) {
            0.5
        } else {
            -0.5
        };
        let mut state = RobotState {
            message_id,
            robot_mode: RobotMode::Idle,
            q: [0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8],
            tau_ext_hat_filtered: [0.2; 7],
            O_F_ext_hat_K: [1.0, -2.0, 0.5 + noise, 0.3, 0.0, 0.0],
            K_F_ext_hat_K: [1.0, 2.0, -0.5 - noise, 0.3, 0.1, 0.0],
            ..RobotState::default()
        };
        // Half a turn about x: the hand points down.
        for (index, value) in [(5, -1.0), (10, -1.0)] {
            state.O_T_EE[index] = value;
        }
        state
    }

    fn taken(state: impl Fn(u64) -> RobotState) -> Result<WrenchTare, TareRefused> {
        let mut taring = Taring::over(Duration::from_millis(100))?;
        for time in 1000..2000 {
            if let Some(tare) = taring.push(&state(time))? {
                return Ok(tare);
            }
        }
        panic!("the states lasted long enough");
    }

    #[test]
    fn a_tare_is_the_average_and_leaves_nothing_where_it_was_taken() {
        let tare = taken(state).unwrap();
        assert_eq!((tare.time, tare.states), (1100, 101));
        for (got, expected) in tare.wrench.iter().zip([1.0, -2.0, 0.5, 0.3, -0.1, 0.0]) {
            assert!((got - expected).abs() < 0.01, "{tare:?}");
        }
        assert!((tare.deviation[2] - 0.5).abs() < 1e-3, "{tare:?}");
        assert!(tare.deviation[0] < 1e-9);
        let mut later = state(5001);
        later.O_F_ext_hat_K[2] -= 8.0;
        later.q[3] += 0.2;
        let [x, y, z, ..] = tare.compensate(&later).expect("an estimate");
        assert!(x.abs() < 1e-9 && y.abs() < 1e-9, "{x} {y}");
        assert!((z + 8.5).abs() < 0.01, "{z}");
        assert!(tare.compensate_torques(&later)[0].abs() < 1e-9);
        assert!((tare.turned(&later) - 0.2).abs() < 1e-9);
    }

    /// If the moment were about the origin of the base, it would change with the position for a
    /// constant force.
    #[test]
    fn the_moment_does_not_depend_on_where_the_base_is() {
        let tare = taken(state).unwrap();
        let shifted = |mut state: RobotState| {
            let force = Vector3::new(1.0, -2.0, 0.5);
            let moment = Vector3::new(0.5, 0.1, 0.4).cross(&force);
            for i in 0..3 {
                state.O_F_ext_hat_K[3 + i] += moment[i];
            }
            state
        };
        let other = taken(|time| shifted(state(time))).unwrap();
        assert_eq!(other, tare);
        let seen = tare.compensate(&shifted(state(7001)));
        assert_eq!(seen, tare.compensate(&state(7001)));
    }

    #[test]
    fn a_posture_without_an_estimate_has_no_compensated_wrench() {
        let tare = taken(state).unwrap();
        let singular = |time| RobotState {
            O_F_ext_hat_K: [0.0; 6],
            K_F_ext_hat_K: [0.0; 6],
            ..state(time)
        };
        assert_eq!(tare.compensate(&singular(1)), None);
        assert_eq!(taken(singular), Err(TareRefused::NoEstimate));
    }

    #[test]
    fn only_an_untouched_arm_at_rest_is_tared() {
        type Change = fn(&mut RobotState);
        let refused = |change: Change| {
            let changed = |time| {
                let mut state = state(time);
                if time > 1050 {
                    change(&mut state);
                }
                state
            };
            taken(changed).expect_err("refused").to_string()
        };
        let changes: [(Change, &str); 6] = [
            (|it| it.dq[3] = -0.05, "joint 4 moves at -0.050 rad/s"),
            (
                |it| it.q[1] += 0.01,
                "joint 2 moves at 0.000 rad/s, 0.0100 rad since",
            ),
            (|it| it.dq[0] = f64::NAN, "joint 1 moves"),
            (
                |it| it.robot_mode = RobotMode::Guiding,
                "the robot is in mode",
            ),
            (|it| it.joint_contact[2] = 1.0, "reports a contact"),
            (|it| it.cartesian_contact[5] = 1.0, "reports a contact"),
        ];
        for (change, text) in changes {
            let error = refused(change);
            assert!(error.starts_with(text) || error.contains(text), "{error}");
        }
        let short = Taring::over(Duration::from_millis(5)).unwrap_err();
        assert!(short.to_string().contains("expected 20 ms to 60 s"));
    }
}
