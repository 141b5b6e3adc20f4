//! Estimates friction, bias and load from records, with weighted least squares.

use franka_model::{JointVector, Load, Model};
use franka_proto::RobotState;
use nalgebra::{SMatrix, SVector, Vector3, Vector4};

use super::{Estimate, Identified, IdentifiedJoint, IdentifiedLoad, Plan, declared, load_gravity};
use crate::driver::Record;
use crate::session::Guard;

/// Collects the records of a [`Plan`]'s motions, and computes the arm's friction, bias and load
/// from them.
#[derive(Clone, Debug)]
pub struct Fit {
    model: Model,
    /// Sum of the load and the end effector, as configured at the robot.
    total: Load,
    /// Load as configured at the robot: mass and moment.
    declared: Vector4<f64>,
    /// Acceleration of gravity in the base frame, `[m/s²]`.
    gravity: Vector3<f64>,
    steady: Steady,
    windows: Vec<Window>,
}

/// Current stretch of steady motion.
#[derive(Clone, Copy, Debug, Default)]
struct Steady {
    /// Direction of each joint, -1 or 1; 0 if the joint is too slow.
    signs: JointVector,
    time: u64,
    /// Number of cycles of the stretch so far.
    cycles: u32,
    /// Number of summed cycles of the stretch, and their sums.
    summed: u32,
    q: JointVector,
    dq: JointVector,
    tau: JointVector,
    /// Number of the stroke that the stretch belongs to.
    stroke: u32,
}

/// Means over a part of a steady motion.
#[derive(Clone, Copy, Debug)]
struct Window {
    signs: JointVector,
    /// Joint torques that the model does not explain, `[N m]`.
    takes: JointVector,
    /// Joint torques per mass and per moment of a load.
    gravity: SMatrix<f64, 7, 4>,
    stroke: u32,
}

/// Reason why the records do not determine the arm's friction, bias and load.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A joint hardly moved as planned, because something held the arm or records were missed.
    #[error(
        "joint {joint} moved steadily in one direction for {got} intervals, expected at least \
         {expected}: something held the arm, or the program was too slow"
    )]
    TooLittle {
        /// Number of the joint, 1 to 7.
        joint: usize,
        /// Number of quarter-second intervals in which the joint moved steadily in one direction.
        got: usize,
        /// Smallest number of intervals that is accepted.
        expected: usize,
    },
    /// The torques of a joint do not fit any friction, bias and load, because something pushed the
    /// arm.
    #[error(
        "the torques of joint {joint} differ by {got:.2} N m (rms) from the fitted friction, bias \
         and load, expected {expected} N m at most: something pushed the arm"
    )]
    Disturbed {
        /// Number of the joint, 1 to 7.
        joint: usize,
        /// Root mean square of the unexplained torque, `[N m]`.
        got: f64,
        /// Largest accepted value, `[N m]`.
        expected: f64,
    },
}

/// Friction of each joint, bias of each joint, mass and moment of the load.
type Unknowns = SVector<f64, 18>;

impl Fit {
    /// Returns a fit for an arm of this model in this state. The end effector, the declared load
    /// and the base must not change.
    pub fn new(model: &Model, state: &RobotState) -> Self {
        let end_effector = Load::from_arrays(state.m_ee, &state.F_x_Cee, &state.I_ee);
        let load = Load::from_arrays(state.m_load, &state.F_x_Cload, &state.I_load);
        Self {
            model: model.clone(),
            total: end_effector.combine(&load),
            declared: declared(state),
            gravity: state.O_ddP_O.into(),
            steady: Steady::default(),
            windows: Vec::new(),
        }
    }

    /// Adds the record of a cycle. Do not add records of motions under the robot's own controller.
    /// The fit ignores slow motions and cycles in which a guard limits the command, and records may
    /// be missing.
    pub fn on_record(&mut self, record: &Record) {
        let (v, a) = (JointVector::from(record.dq_ref), record.ddq_ref);
        let signs = v.map(|v| if v.abs() > FAST { v.signum() } else { 0.0 });
        let free = HOLDING
            .iter()
            .all(|guard| !record.bindings.contains(*guard));
        let steady = free && a.iter().all(|a| a.abs() < STEADY) && signs.amax() > 0.0;
        let follows = record.time.saturating_sub(self.steady.time) <= GAP;
        let on = &mut self.steady;
        if !steady || !follows || on.signs != signs {
            let stroke = on.stroke + u32::from(on.cycles > 0);
            *on = Steady {
                stroke,
                ..Steady::default()
            };
        }
        on.time = record.time;
        if !steady {
            return;
        }
        on.signs = signs;
        on.cycles += 1;
        if on.cycles <= SETTLES {
            return;
        }
        on.summed += 1;
        on.q += JointVector::from(record.q);
        on.dq += JointVector::from(record.dq);
        on.tau += JointVector::from(record.tau_c);
        if on.summed == WINDOW {
            let share = 1.0 / f64::from(WINDOW);
            let (q, dq, tau) = (on.q * share, on.dq * share, on.tau * share);
            let window = Window {
                signs,
                takes: tau - self.model.coriolis(&q, &dq, &self.total),
                gravity: load_gravity(&self.model, &q, &self.gravity),
                stroke: on.stroke,
            };
            let mut numbers = window.takes.iter().chain(&window.gravity);
            if numbers.all(|number| number.abs() < ABSURD) {
                self.windows.push(window);
            }
            (on.summed, on.q, on.dq, on.tau) = Default::default();
        }
    }

    /// Returns the identified values of the arm.
    ///
    /// # Errors
    /// Returns [`FitError`] if the records do not determine these values.
    pub fn finish(&self) -> Result<Identified, FitError> {
        for joint in 0..7 {
            for way in [1.0, -1.0] {
                let of = self.windows.iter().filter(|one| one.signs[joint] == way);
                let got = of.count();
                if got < INTERVALS {
                    return Err(FitError::TooLittle {
                        joint: joint + 1,
                        got,
                        expected: INTERVALS,
                    });
                }
            }
        }
        let mut noise = JointVector::repeat(1.0);
        let mut fitted = self.solve(&noise);
        for _ in 0..REWEIGHTED {
            noise = self.residuals(&fitted.0);
            fitted = self.solve(&noise);
        }
        let (joint, got) = noise.argmax();
        if got > RESIDUAL_MAX {
            return Err(FitError::Disturbed {
                joint: joint + 1,
                got,
                expected: RESIDUAL_MAX,
            });
        }
        Ok(self.identified(&fitted.0, &fitted.1))
    }

    /// Returns the most likely unknowns and their variances. `noise` is the standard deviation of
    /// the windows of a stroke, for each joint.
    fn solve(&self, noise: &JointVector) -> (Unknowns, Unknowns) {
        let mut information = SMatrix::<f64, 18, 18>::from_diagonal(&prior());
        let mut right = Unknowns::zeros();
        // Windows of one stroke have the same errors, so together they count as one.
        let strokes = self.windows.chunk_by(|a, b| a.stroke == b.stroke).count();
        let share = strokes as f64 / self.windows.len() as f64;
        for window in &self.windows {
            for (joint, deviation) in noise.iter().enumerate() {
                if let Some(row) = window.row(joint) {
                    let weight = share / deviation.powi(2);
                    information += row * row.transpose() * weight;
                    right += row * (window.takes[joint] * weight);
                }
            }
        }
        let factor = information.cholesky();
        let inverse = factor.expect("positive definite by the prior").inverse();
        (inverse * right, inverse.diagonal())
    }

    /// Returns the deviation of each joint's windows from the prediction with these unknowns, `[N
    /// m]`.
    fn residuals(&self, unknowns: &Unknowns) -> JointVector {
        JointVector::from_fn(|joint, _| {
            let off = self.windows.iter().filter_map(|window| {
                let row = window.row(joint)?;
                Some((window.takes[joint] - row.dot(unknowns)).powi(2))
            });
            let (sum, count) = off.fold((0.0, 0.0), |(sum, count), off| (sum + off, count + 1.0));
            f64::sqrt(sum / count).max(RESIDUAL_MIN)
        })
    }

    fn identified(&self, unknowns: &Unknowns, variances: &Unknowns) -> Identified {
        let estimate = |i: usize, own: f64| Estimate {
            value: unknowns[i],
            deviation: variances[i].sqrt().hypot(own),
        };
        let load = |i: usize, own| {
            let found = estimate(14 + i, own);
            Estimate {
                value: found.value + self.declared[i],
                ..found
            }
        };
        Identified {
            kind: self.model.kind(),
            joints: core::array::from_fn(|i| {
                let friction = estimate(i, 0.0);
                IdentifiedJoint {
                    friction: Estimate {
                        value: friction.value.max(0.0),
                        ..friction
                    },
                    bias: estimate(7 + i, 0.0),
                }
            }),
            load: IdentifiedLoad {
                mass: load(0, MODEL_MASS),
                moment: [1, 2, 3].map(|i| load(i, MODEL_MOMENT)),
            },
        }
    }
}

impl Window {
    /// Returns the derivative of a joint's torque with respect to the unknowns; `None` if the joint
    /// was too slow.
    fn row(&self, joint: usize) -> Option<Unknowns> {
        let sign = self.signs[joint];
        (sign != 0.0).then(|| {
            let mut row = Unknowns::zeros();
            (row[joint], row[7 + joint]) = (sign, 1.0);
            let gravity = self.gravity.row(joint).transpose();
            row.fixed_rows_mut::<4>(14).copy_from(&gravity);
            row
        })
    }
}

/// Returns the prior knowledge that holds for any arm: the inverse variances of the unknowns.
fn prior() -> Unknowns {
    Unknowns::from_fn(|i, _| {
        let deviation: f64 = match i {
            0..7 => 5.0,
            7..14 => 0.5,
            14 => 3.0,
            _ => 0.3,
        };
        deviation.powi(-2)
    })
}

/// Guards under which the torques do not come from the arm alone.
const HOLDING: [Guard; 5] = [
    Guard::Leash,
    Guard::ForceCap,
    Guard::TorqueClamp,
    Guard::VelocityBarrier,
    Guard::TorqueRate,
];

/// Velocity of the reference above which a joint counts, `[rad/s]`. At lower velocities the
/// friction differs.
const FAST: f64 = 0.75 * Plan::SPEED;

/// Acceleration of the reference below which the motion is steady, `[rad/s^2]`.
const STEADY: f64 = 0.02;

/// Number of cycles of steady motion after which the transients of the arm have decayed.
const SETTLES: u32 = 150;

/// Length of a window, in cycles.
const WINDOW: u32 = 250;

/// Time without a record after which a new stretch of steady motion begins, `[ms]`.
const GAP: u64 = 20;

/// Number of windows that each joint needs in each direction.
const INTERVALS: usize = 12;

/// Number of iterations that compute the weights of the joints from the residuals.
const REWEIGHTED: usize = 3;

/// Least standard deviation of a joint's windows, `[N m]`. It is the resolution of the joint's
/// sensor.
const RESIDUAL_MIN: f64 = 0.01;

/// Torque that no joint can reach, `[N m]`. Larger values and NaN are ignored.
const ABSURD: f64 = 1e3;

/// Largest standard deviation of a joint's windows if nothing has pushed the arm, `[N m]`.
const RESIDUAL_MAX: f64 = 0.5;

/// Assumed error of the robot's own masses, `[kg]`, and moments, `[kg m]`.
const MODEL_MASS: f64 = 0.05;
const MODEL_MOMENT: f64 = 0.01;
