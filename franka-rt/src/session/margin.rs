//! Stability margin: how far gains are from the first oscillation.
//!
//! Four delays lie between a desired torque and its effect: the client's cycle, the robot's delay,
//! the lag of its torque loop and the low-pass of the commands. With inertia `M`, dampers `D` and
//! springs `K` in joint space, every mode of the arm obeys
//!
//! ```text
//! m s^2 + (d s + k) exp(-s DELAY) / ((1 + s LAG) (1 + s FILTER)) = 0
//! ```
//!
//! to first order. A damper alone makes a mode oscillate if `d / m` reaches the value at which the
//! phases of delay and lags add up to a quarter of a turn. With a slow spring, the mode is stable
//! if `d > k (DELAY + LAG + FILTER)`. The computation ignores friction, which increases the margin,
//! and the elasticity of the joints, which reduces it. The margins were compared with simulated
//! arms (`cargo xtask arms --gain`).

use core::f64::consts::{FRAC_PI_2, TAU};

use franka_model::{GRAVITY_EARTH, JointVector, MassMatrix, Model};
use franka_proto::{RobotState, Version};

use super::{ForceCap, end_effector_of, load_of};
use crate::law::Gains;
use crate::law::blended_gains::BlendedGains;
use crate::law::interaction::Interaction;
use crate::law::task_space::{ROTORS, TaskSpace};
use crate::shaping::MAX_CUTOFF_FREQUENCY;

/// Stability margin of gains: how far they are from the first oscillation. The arm is assumed to
/// have the delays and lags of the slowest realistic simulated arm
/// (`franka_sim::arm::Family::realistic`). Bad arms have less margin: their lags are twice as long,
/// and their joints are softer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// Factor by which all dampers may grow before the arm oscillates.
    pub damping: f64,
    /// Factor by which all springs may grow before the arm oscillates, with unchanged dampers.
    pub stiffness: f64,
}

impl Margin {
    /// Least recommended margin, for both factors.
    pub const WANTED: f64 = 2.0;

    /// True if both factors reach the recommended margin.
    pub fn is_wanted(&self) -> bool {
        self.damping >= Self::WANTED && self.stiffness >= Self::WANTED
    }

    /// Returns the margin of these gains on an arm of this model in `state`, with the end effector
    /// and the load that the robot knows. Returns `None` if a gain is out of its bounds, or if the
    /// tool is not a rigid body.
    pub fn of(gains: &Gains, model: &Model, state: &RobotState, version: Version) -> Option<Self> {
        gains.check().ok()?;
        let (ee, load) = (end_effector_of(state)?, load_of(state, version)?);
        let (q, rest) = (JointVector::from(state.q), JointVector::zeros());
        let dynamics = model.dynamics(&q, &rest, &ee, &load, &GRAVITY_EARTH);
        let late = Lateness::of(gains.torque_cutoff);
        let gains = BlendedGains::new(gains, ForceCap::Off.newtons());
        let space = gains.needs_task_space().then(|| TaskSpace::of(&dynamics));
        let matrix = |of: Interaction<'_>| {
            let columns: [JointVector; 7] = core::array::from_fn(|i| {
                let mut unit = JointVector::zeros();
                unit[i] = 1.0;
                of.torques(&unit)
            });
            let matrix = MassMatrix::from_columns(&columns);
            (matrix + matrix.transpose()) * 0.5
        };
        let jacobian = &dynamics.jacobian;
        let springs = matrix(Interaction::springs(&gains, jacobian, space.as_ref()));
        let dampers = matrix(Interaction::dampers(&gains, jacobian, space.as_ref()));
        let inertia = dynamics.mass + MassMatrix::from_diagonal(&ROTORS.into());
        Some(Self {
            damping: late.damped() / greatest_ratio(dampers, inertia),
            stiffness: 1.0 / (late.sum() * greatest_ratio(springs, dampers)),
        })
    }
}

/// Returns the greatest eigenvalue of `over^-1 of`, where both matrices are symmetric. Infinite if
/// `over` is not positive definite.
fn greatest_ratio(of: MassMatrix, over: MassMatrix) -> f64 {
    let floor = MassMatrix::identity() * 1e-9;
    let ratio = (over + floor).cholesky().and_then(|factor| {
        let half = factor.l().solve_lower_triangular(&of)?;
        factor.l().solve_lower_triangular(&half.transpose())
    });
    ratio.map_or(f64::INFINITY, |ratio| ratio.symmetric_eigenvalues().max())
}

/// Delays between a desired torque and its effect.
struct Lateness {
    /// Time constants of the torque loop and of the low-pass of the commands, `[s]`.
    lags: [f64; 2],
}

impl Lateness {
    /// Delay of one cycle of the client and two cycles of the robot, `[s]`.
    const DELAY: f64 = 3e-3;

    /// Time constant of the robot's torque loop, `[s]`.
    const LAG: f64 = 5e-3;

    /// Returns the delays with a low-pass of this cutoff frequency, `[Hz]`.
    fn of(cutoff: f64) -> Self {
        let filter = if cutoff < MAX_CUTOFF_FREQUENCY {
            1.0 / (TAU * cutoff)
        } else {
            0.0
        };
        Self {
            lags: [Self::LAG, filter],
        }
    }

    fn sum(&self) -> f64 {
        self.lags.iter().fold(Self::DELAY, |sum, lag| sum + lag)
    }

    /// Returns the ratio of damper to inertia at which a mode begins to oscillate, `[1/s]`. At the
    /// frequency of that oscillation, the phases add up to a quarter of a turn; the ratio also
    /// compensates the gain of the lags. With the default low-pass the ratio is 257, at 182 rad/s.
    fn damped(&self) -> f64 {
        let phase = |frequency: f64| {
            let lags = self.lags.iter().map(|lag| (frequency * lag).atan());
            frequency * Self::DELAY + lags.sum::<f64>()
        };
        let (mut low, mut high) = (0.0, FRAC_PI_2 / Self::DELAY);
        while high - low > 1e-3 {
            let middle = 0.5 * (low + high);
            if phase(middle) < FRAC_PI_2 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let passed = |lag: &f64| (low * lag).hypot(1.0);
        low * self.lags.iter().map(passed).product::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::SmallRng;
    use rand::{Rng, SeedableRng};

    use super::*;

    fn at(q: JointVector, gains: Gains) -> Margin {
        let transform = nalgebra::Matrix4::identity();
        let state = RobotState {
            q: q.into(),
            F_T_EE: transform.as_slice().try_into().expect("sixteen"),
            EE_T_K: transform.as_slice().try_into().expect("sixteen"),
            ..RobotState::default()
        };
        Margin::of(&gains, Model::fr3(), &state, Version::V10).expect("a rigid tool")
    }

    fn of(gains: Gains) -> Margin {
        at(franka_model::READY, gains)
    }

    #[test]
    fn the_presets_have_a_margin_wherever_the_arm_is() {
        let mut random = SmallRng::seed_from_u64(1);
        let limits = Model::fr3().joint_limits();
        for _ in 0..500 {
            let q = limits
                .lower
                .zip_map(&limits.upper, |low, high| random.random_range(low..high));
            for gains in [Gains::cartesian(), Gains::joint(), Gains::droid()] {
                let margin = at(q, gains);
                assert!(margin.is_wanted(), "{margin:?} at {q}");
            }
        }
    }

    /// Results of simulated arms: `arms --law joint --scaled joint-damping --gain F` was quiet with
    /// a factor of 2.4 and oscillated with 3. With all default gains scaled, it was quiet with 4.
    #[test]
    fn margin_matches_simulated_arms() {
        let margin = of(Gains::joint()).damping;
        assert!((2.4..3.0).contains(&margin), "{margin}");
        let margin = of(Gains::cartesian()).damping;
        assert!(margin > 4.0, "{margin}");
    }

    #[test]
    fn a_lower_cutoff_takes_from_it() {
        let with = |torque_cutoff| {
            of(Gains {
                torque_cutoff,
                ..Gains::joint()
            })
        };
        let [off, default, least] = [1000.0, 100.0, Gains::LEAST.torque_cutoff].map(with);
        for (more, less) in [(off, default), (default, least)] {
            assert!(more.damping > less.damping && more.stiffness > less.stiffness);
        }
        // The softest accepted filter leaves a third of the presets' margin.
        assert!(default.is_wanted() && !least.is_wanted());
        assert!(least.damping > 1.5 && least.stiffness > 1.5, "{least:?}");
        assert!((Lateness::of(100.0).damped() - 257.0).abs() < 1.0);
    }

    #[test]
    fn margin_is_a_factor_on_the_gains() {
        let gains = Gains::cartesian();
        let margin = of(gains);
        let damped = Gains {
            cartesian_damping: gains.cartesian_damping.map(|d| 1.5 * d),
            joint_damping: gains.joint_damping.map(|d| 1.5 * d),
            ..gains
        };
        let near = |got: f64, want: f64| assert!((got / want - 1.0).abs() < 1e-3, "{got} {want}");
        near(of(damped).damping, margin.damping / 1.5);
        near(of(damped).stiffness, margin.stiffness * 1.5);
        let mut undamped = gains;
        (undamped.cartesian_damping, undamped.joint_damping) = ([0.0; 6], [0.0; 7]);
        assert!(of(undamped).stiffness < 1e-3);
        assert!(!of(undamped).is_wanted());
    }
}
