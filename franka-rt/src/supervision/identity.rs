//! Checks if the robot that answers after a lost connection is the same robot, unchanged.

use core::time::Duration;

use franka_proto::RobotState;

use crate::lifecycle::Differences;

/// Data about a robot with which it is recognised after a lost connection.
#[derive(Clone, Debug)]
pub(super) struct Identity {
    /// Hash of the robot's description or model library; `None` for a robot without either.
    description: Option<u64>,
    frames: [[f64; 16]; 3],
    /// Mass, centre of mass and inertia of the robot's end effector.
    tool: ([f64; 4], [f64; 9]),
    q: [f64; 7],
    dq: [f64; 7],
    message_id: u64,
    /// Time of the recorded state, by the clock of this computer.
    at: Duration,
}

impl Identity {
    pub(super) fn of(description: Option<u64>, state: &RobotState, now: Duration) -> Self {
        let [x, y, z] = state.F_x_Cee;
        Self {
            description,
            frames: [state.F_T_NE, state.NE_T_EE, state.EE_T_K],
            tool: ([state.m_ee, x, y, z], state.I_ee),
            q: state.q,
            dq: state.dq,
            message_id: state.message_id,
            at: now,
        }
    }

    pub(super) fn update(&mut self, state: &RobotState, now: Duration) {
        *self = Self::of(self.description, state, now);
    }

    /// Records that the newest state arrived `silence` before `now`.
    pub(super) fn silent_for(&mut self, silence: Duration, now: Duration) {
        self.at = now.saturating_sub(silence);
    }

    /// Returns the differences between this robot and `other`, whose data are newer.
    pub(super) fn differences(&self, other: &Self) -> Differences {
        let differs =
            |a: &[f64], b: &[f64]| core::iter::zip(a, b).any(|(a, b)| (a - b).abs() > EPS);
        let mut frames = core::iter::zip(&self.frames, &other.frames);
        let tool = differs(&self.tool.0, &other.tool.0) || differs(&self.tool.1, &other.tool.1);
        let elsewhere = |joint: &usize| {
            let reach = MOVED + self.dq[*joint].abs() * BRAKING;
            let moved = (self.q[*joint] - other.q[*joint]).abs();
            // A position that is not a number counts as moved.
            moved.is_nan() || moved > reach
        };
        Differences {
            description: self.description != other.description,
            frames: frames.any(|(a, b)| differs(a, b)) || tool,
            clock: !self.clock_continues(other),
            joint: (0..7).find(elsewhere).map(|joint| joint as u8 + 1),
        }
    }

    fn clock_continues(&self, other: &Self) -> bool {
        let Some(passed) = other.message_id.checked_sub(self.message_id) else {
            return false;
        };
        let expected = other.at.saturating_sub(self.at);
        Duration::from_millis(passed).abs_diff(expected) <= CLOCK
    }
}

/// Distance of a joint from its earlier position above which the joint counts as moved, `[rad]`.
const MOVED: f64 = 5e-3;

/// Time for which a joint may have continued at its last velocity, `[s]`. A robot without commands
/// continues for 20 ms and then brakes. From its highest velocities, braking takes about 0.3 s.
const BRAKING: f64 = 0.3;

/// Difference above which two numbers of a frame or a tool count as different. States of protocol
/// 10 have single precision.
const EPS: f64 = 1e-5;

/// Tolerance between the robot's clock and the time that has passed. It is much longer than states
/// can be late, and much shorter than a robot takes to start.
const CLOCK: Duration = Duration::from_secs(5);

#[cfg(test)]
mod tests {
    use super::*;

    const MS: fn(u64) -> Duration = Duration::from_millis;

    fn state(message_id: u64) -> RobotState {
        RobotState {
            message_id,
            ..RobotState::default()
        }
    }

    fn seen(state: &RobotState, at: u64) -> Identity {
        Identity::of(Some(1), state, MS(at))
    }

    #[test]
    fn robot_that_rests_is_recognised_however_long_it_was_away() {
        let before = seen(&state(100_000), 20_000);
        for away in [1, 1000, 86_400_000] {
            let after = seen(&state(100_000 + away), 20_000 + away);
            assert!(before.differences(&after).is_empty(), "{away}");
        }
    }

    #[test]
    fn clock_that_does_not_continue_is_noticed() {
        let before = seen(&state(100_000), 20_000);
        for (clock, at) in [
            (99_999, 20_001),
            (1000, 60_000),
            (130_000, 80_000),
            (190_000, 80_000),
        ] {
            let differences = before.differences(&seen(&state(clock), at));
            let clock = Differences {
                clock: true,
                ..Differences::default()
            };
            assert_eq!(differences, clock, "{at}");
        }
        // The newest state may be older than the loss of the connection.
        let mut silent = seen(&state(100_000), 26_000);
        silent.silent_for(MS(6000), MS(26_000));
        assert!(
            silent
                .differences(&seen(&state(110_000), 30_000))
                .is_empty()
        );
    }

    #[test]
    fn joints_frames_tools_and_descriptions_are_compared() {
        let begin = state(1000);
        let before = seen(&begin, 0);
        let of = |change: fn(&mut RobotState)| {
            let mut state = state(1500);
            change(&mut state);
            before.differences(&seen(&state, 500))
        };
        assert!(of(|state| state.q[2] += 4.9e-3).is_empty());
        assert_eq!(of(|state| state.q[2] -= 5.1e-3).joint, Some(3));
        assert_eq!(of(|state| state.q[6] = f64::NAN).joint, Some(7));
        for change in [
            (|state| state.F_T_NE[14] += 1e-3) as fn(&mut RobotState),
            |state| state.NE_T_EE[12] += 1e-3,
            |state| state.EE_T_K[0] -= 1e-3,
            |state| state.m_ee += 0.1,
            |state| state.F_x_Cee[1] += 1e-3,
            |state| state.I_ee[4] += 1e-3,
        ] {
            let frames = Differences {
                frames: true,
                ..Differences::default()
            };
            assert_eq!(of(change), frames);
        }
        let other = Identity::of(Some(2), &state(1500), MS(500));
        assert!(before.differences(&other).description);
        let none = Identity::of(None, &state(1500), MS(500));
        let text = before.differences(&none).to_string();
        assert_eq!(text, "the model that it sends has changed");
    }

    #[test]
    fn joint_that_moved_may_have_run_on() {
        let mut moving = state(1000);
        moving.dq[0] = 1.0;
        let before = seen(&moving, 0);
        let mut rests = state(2000);
        rests.q[0] = 0.25;
        assert!(before.differences(&seen(&rests, 1000)).is_empty());
        rests.q[1] = 0.25;
        rests.message_id = 1;
        let differences = before.differences(&seen(&rests, 1000));
        assert_eq!(
            differences.to_string(),
            "its clock does not continue, as after a restart; joint 2 has moved"
        );
    }
}
