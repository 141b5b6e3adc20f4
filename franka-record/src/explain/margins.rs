//! The smallest distance to each limit, and the largest values.

use franka_model::limits::CartesianLimits;
use franka_model::{EndEffector, Frame, JointVector, Model};
use franka_proto::RobotState;
use franka_rt::driver::Record;

/// A value, its limit, and the distance between them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Approach {
    /// Number of the joint, 1 to 7; `None` for the end effector.
    pub joint: Option<u8>,
    /// The measured value.
    pub value: f64,
    /// The limit at this moment, on the same side as the value.
    pub limit: f64,
    /// Distance from the value to the limit; negative if the limit is exceeded.
    pub margin: f64,
    /// Time on the robot's clock, `[ms]`.
    pub time: u64,
}

/// Smallest distances to the limits; each is `None` before the first cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Margins {
    /// The joint position with the smallest distance to an end of its range, compared as a share of
    /// the range; `[rad]`.
    pub position: Option<Approach>,
    /// The joint velocity with the smallest distance to its limit at that joint position, compared
    /// as a share of the limit; `[rad/s]`.
    pub velocity: Option<Approach>,
    /// The joint torque, including gravity, with the smallest distance to its limit, compared as a
    /// share of the limit; `[N·m]`.
    pub torque: Option<Approach>,
    /// The velocity of the end effector that was closest to the limit of Cartesian commands,
    /// `[m/s]`.
    pub translation: Option<Approach>,
    /// The angular velocity of the end effector that was closest to its limit, `[rad/s]`.
    pub rotation: Option<Approach>,
}

/// The largest value of a quantity, and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Peak {
    /// Number of the joint, 1 to 7; `None` for the end effector.
    pub joint: Option<u8>,
    /// Magnitude of the value.
    pub value: f64,
    /// Time on the robot's clock, `[ms]`.
    pub time: u64,
}

/// Largest values of several quantities; each is `None` without data.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Peaks {
    /// External torque on a joint, minus the baseline without contact, `[N·m]`.
    pub external_torque: Option<Peak>,
    /// Norm of the estimated external force at the end effector, `[N]`. The robot computes the
    /// estimate.
    pub force: Option<Peak>,
    /// Distance of a joint from its reference position during target control, `[rad]`.
    pub following_error: Option<Peak>,
}

impl Margins {
    pub(super) fn cycle(&mut self, model: &Model, state: &RobotState) {
        let limits = model.joint_limits();
        let (q, dq) = (JointVector::from(state.q), JointVector::from(state.dq));
        let (least, greatest) = limits.velocity_envelope(&q, 0.0);
        let time = state.message_id;
        for i in 0..7 {
            let joint = Some(i as u8 + 1);
            let (low, high) = (limits.lower[i], limits.upper[i]);
            let limit = if q[i] < 0.5 * (low + high) { low } else { high };
            let margin = (q[i] - low).min(high - q[i]);
            let at = |value, limit, margin| Approach {
                joint,
                value,
                limit,
                margin,
                time,
            };
            let range = high - low;
            nearer(&mut self.position, at(q[i], limit, margin), |a| {
                a.margin / (range_of(model, a)).unwrap_or(range)
            });
            let bound = if dq[i] < 0.0 { least[i] } else { greatest[i] };
            let towards = (bound - dq[i]) * bound.signum();
            nearer(&mut self.velocity, at(dq[i], bound, towards), share);
            let tau = state.tau_J[i];
            let bound = limits.torque[i].copysign(tau);
            let left = limits.torque[i] - tau.abs();
            nearer(&mut self.torque, at(tau, bound, left), share);
        }
        let (linear, angular) = speeds(model, state);
        let cartesian = CartesianLimits::of(model.kind());
        let at = |value, limit| Approach {
            joint: None,
            value,
            limit,
            margin: limit - value,
            time,
        };
        let translation = at(linear, cartesian.translation.velocity);
        nearer(&mut self.translation, translation, share);
        nearer(
            &mut self.rotation,
            at(angular, cartesian.rotation.velocity),
            share,
        );
    }
}

impl Peaks {
    pub(super) fn cycle(
        &mut self,
        state: &RobotState,
        record: Option<&Record>,
        external: &JointVector,
    ) {
        let time = state.message_id;
        for i in 0..7 {
            let joint = Some(i as u8 + 1);
            let at = |value: f64| Peak {
                joint,
                value: value.abs(),
                time,
            };
            larger(&mut self.external_torque, at(external[i]));
            // The reference is zero outside target control.
            if let Some(record) = record.filter(|r| r.goal != 0 && r.q_ref != [0.0; 7]) {
                larger(&mut self.following_error, at(record.q_ref[i] - state.q[i]));
            }
        }
        let [x, y, z, ..] = state.O_F_ext_hat_K;
        let value = nalgebra::Vector3::new(x, y, z).norm();
        larger(
            &mut self.force,
            Peak {
                joint: None,
                value,
                time,
            },
        );
    }
}

/// Returns the linear speed, `[m/s]`, and the angular speed, `[rad/s]`, of the end effector.
fn speeds(model: &Model, state: &RobotState) -> (f64, f64) {
    let ee = EndEffector {
        f_t_ee: nalgebra::Matrix4::from_column_slice(&state.F_T_EE),
        ..EndEffector::default()
    };
    let jacobian = model.zero_jacobian(Frame::EndEffector, &state.q.into(), &ee);
    let twist = jacobian * JointVector::from(state.dq);
    (
        twist.fixed_rows::<3>(0).norm(),
        twist.fixed_rows::<3>(3).norm(),
    )
}

fn range_of(model: &Model, approach: &Approach) -> Option<f64> {
    let i = usize::from(approach.joint?) - 1;
    let limits = model.joint_limits();
    Some(limits.upper[i] - limits.lower[i])
}

fn share(approach: &Approach) -> f64 {
    approach.margin / approach.limit.abs().max(f64::MIN_POSITIVE)
}

fn nearer(best: &mut Option<Approach>, new: Approach, by: impl Fn(&Approach) -> f64) {
    if new.value.is_finite() && best.is_none_or(|best| by(&new) < by(&best)) {
        *best = Some(new);
    }
}

fn larger(best: &mut Option<Peak>, new: Peak) {
    if new.value.is_finite() && best.is_none_or(|best| new.value > best.value) {
        *best = Some(new);
    }
}
