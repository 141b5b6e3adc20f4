//! Conversion of actions to the commands of each cycle, within the robot's limits.

use franka_async::goal::target_range_of;
use franka_async::nalgebra::{Matrix4, Vector3};
use franka_model::differential_ik::{DifferentialIk, JointBox};
use franka_model::geometry::Lengths;
use franka_model::limits::JointLimits;
use franka_model::{CYCLE, EndEffector, Frame, JointVector, Model, Twist, rotation, transform};
use franka_otg::{Generator, Limits, State, Synchronisation};
use franka_proto::RobotCommand;

use super::member::Settings;

/// The meaning of an action.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    JointVelocity,
    JointDelta,
    CartesianDelta,
    Torque,
}

impl Kind {
    pub(super) const NAMES: [(&str, Self); 4] = [
        ("joint_velocity", Self::JointVelocity),
        ("joint_delta", Self::JointDelta),
        ("cartesian_delta", Self::CartesianDelta),
        ("torque", Self::Torque),
    ];

    pub(super) fn name(self) -> &'static str {
        let mut names = Self::NAMES.iter();
        let name = names.find(|(_, kind)| *kind == self);
        name.expect("every kind has a name").0
    }

    /// The length of an action.
    pub(super) fn size(self) -> usize {
        if self == Self::CartesianDelta { 6 } else { 7 }
    }
}

impl Settings {
    /// Returns the accelerations of motions, `[rad/s²]`: they stop before the end of a range
    /// without leaving the velocity envelope.
    fn acceleration(&self) -> JointVector {
        let limits = self.model().joint_limits();
        let share = limits.acceleration * ACCELERATION;
        let Some(envelope) = &limits.envelope else {
            return share;
        };
        share.inf(&(envelope.deceleration * DECELERATION))
    }

    /// Returns the smallest and largest positions of motions, `[rad]`.
    fn range(&self) -> (JointVector, JointVector) {
        let limits = self.model().joint_limits();
        let range = target_range_of(limits, &self.acceleration().data.0[0]);
        let (lower, upper) = (range.map(|it| it.0), range.map(|it| it.1));
        (lower.into(), upper.into())
    }

    /// Returns the largest effective action of each axis in a step of `dt` seconds.
    pub(super) fn action_bound(&self, dt: f64) -> Vec<f64> {
        let model = self.model();
        let velocity = model.joint_limits().velocity * self.speed;
        match self.control {
            Kind::JointVelocity => velocity.as_slice().to_vec(),
            Kind::JointDelta => (velocity * dt).as_slice().to_vec(),
            Kind::CartesianDelta => {
                let limits = model.cartesian_limits();
                let [move_by, turn_by] =
                    [limits.translation, limits.rotation].map(|of| of.velocity * self.speed * dt);
                [[move_by; 3], [turn_by; 3]].concat()
            }
            Kind::Torque => model.joint_limits().torque.as_slice().to_vec(),
        }
    }
}

/// The conversion from actions to commands.
pub(super) enum Control {
    Velocity(Box<Velocity>),
    Position(Box<Position>),
    Torque(Torque),
}

impl Control {
    /// Creates the control of an arm with these lengths, at rest at the desired positions `q`.
    pub(super) fn new(settings: &Settings, lengths: Lengths, q: &JointVector) -> Self {
        let model = settings.model();
        match settings.control {
            Kind::JointVelocity => Self::Velocity(Box::new(Velocity {
                limits: model.joint_limits(),
                range: settings.range(),
                bound: model.joint_limits().velocity * settings.speed,
                acceleration: settings.acceleration(),
                wanted: JointVector::zeros(),
                q: *q,
                dq: JointVector::zeros(),
                ddq: JointVector::zeros(),
            })),
            Kind::JointDelta | Kind::CartesianDelta => {
                Self::Position(Box::new(Position::new(settings, lengths, q)))
            }
            Kind::Torque => Self::Torque(Torque {
                limits: model.joint_limits(),
                wanted: JointVector::zeros(),
                torque: JointVector::zeros(),
            }),
        }
    }

    /// Sets an action, which has the length of its kind.
    pub(super) fn act(&mut self, action: &[f64]) {
        match self {
            Self::Velocity(velocity) => {
                let wanted = JointVector::from_column_slice(action);
                velocity.wanted = wanted.zip_map(&velocity.bound, |v, most| v.clamp(-most, most));
            }
            Self::Position(position) => position.act(action),
            Self::Torque(torque) => {
                let wanted = JointVector::from_column_slice(action);
                torque.wanted =
                    wanted.zip_map(&torque.limits.torque, |t, most| t.clamp(-most, most));
            }
        }
    }

    /// Returns the command of the next cycle, without the state that it answers.
    pub(super) fn command(&mut self) -> RobotCommand {
        let mut command = RobotCommand::default();
        match self {
            Self::Velocity(velocity) => command.q_c = velocity.advance().data.0[0],
            Self::Position(position) => command.q_c = position.generator.step().position,
            Self::Torque(torque) => command.tau_J_d = torque.advance().data.0[0],
        }
        command
    }
}

/// Joint velocities that approach the requested ones within limits of acceleration and jerk, and
/// slow down before the ends of the ranges.
pub(super) struct Velocity {
    limits: &'static JointLimits,
    /// Angles, `[rad]`.
    range: (JointVector, JointVector),
    /// Largest velocity, `[rad/s]`.
    bound: JointVector,
    /// Acceleration, `[rad/s²]`.
    acceleration: JointVector,
    wanted: JointVector,
    q: JointVector,
    dq: JointVector,
    ddq: JointVector,
}

impl Velocity {
    fn advance(&mut self) -> JointVector {
        for i in 0..7 {
            let most = self.acceleration[i];
            let towards = |distance: f64| {
                let braking = (2.0 * BRAKING * most * distance.max(0.0)).sqrt();
                braking.min(APPROACH * distance)
            };
            let up = towards(self.range.1[i] - self.q[i]);
            let down = towards(self.q[i] - self.range.0[i]);
            let wanted = self.wanted[i].min(up).max(-down);
            let jerk = JERK * self.limits.jerk[i] * CYCLE;
            let change = ((wanted - self.dq[i]) * RESPONSE).clamp(-most, most) - self.ddq[i];
            self.ddq[i] += change.clamp(-jerk, jerk);
            self.dq[i] += self.ddq[i] * CYCLE;
            self.q[i] += self.dq[i] * CYCLE;
        }
        self.q
    }
}

/// Joint targets moved by actions, and the path to them.
pub(super) struct Position {
    model: Model,
    ee: EndEffector,
    is_cartesian: bool,
    /// Angles, `[rad]`.
    range: (JointVector, JointVector),
    generator: Generator<7>,
    /// Angles, `[rad]`.
    target: JointVector,
}

impl Position {
    fn new(settings: &Settings, lengths: Lengths, q: &JointVector) -> Self {
        let model = settings.model().clone().with_lengths(lengths);
        let limits = model.joint_limits();
        let limits = Limits::from_arrays(
            (limits.velocity * settings.speed).data.0[0],
            settings.acceleration().data.0[0],
            (limits.jerk * JERK).data.0[0],
        );
        let limits = limits.expect("shares of a robot's limits are positive and finite");
        let generator = Generator::new(State::at_rest(q.data.0[0]), limits);
        let generator = generator.expect("a robot's positions are finite");
        Self {
            model,
            ee: EndEffector {
                f_t_ee: settings.tool.f_t_ne,
                ee_t_k: Matrix4::identity(),
            },
            range: settings.range(),
            is_cartesian: settings.control == Kind::CartesianDelta,
            generator: generator.with_synchronisation(Synchronisation::Time),
            target: *q,
        }
    }

    fn act(&mut self, action: &[f64]) {
        let wanted = match self.is_cartesian {
            true => self.moved(&Twist::from_column_slice(action)),
            false => self.target + JointVector::from_column_slice(action),
        };
        let ((lower, upper), at) = (&self.range, self.generator.state().position);
        self.target = JointVector::from_fn(|i, _| {
            // The target stays near: actions that the arm cannot follow do not accumulate.
            let near = wanted[i].clamp(at[i] - LEASH, at[i] + LEASH);
            near.clamp(lower[i], upper[i])
        });
        let target = self.target.data.0[0];
        let planned = self.generator.set_target(&target);
        planned.expect("a target within the ranges of the joints");
    }

    /// Returns joint positions with the end effector moved by `delta` from the target's pose, if
    /// the arm can reach it.
    fn moved(&self, delta: &Twist) -> JointVector {
        let Some(from) = self.pose(&self.target) else {
            return self.target;
        };
        let [x, y, z, a, b, c] = delta.data.0[0];
        let position = from.translation.vector + Vector3::new(x, y, z);
        let orientation = rotation::exp(&Vector3::new(a, b, c)) * from.rotation;
        let (lower, upper) = &self.range;
        let mut q = self.target;
        for _ in 0..IK_STEPS {
            let Some(pose) = self.pose(&q) else {
                break;
            };
            let away = position - pose.translation.vector;
            let turn = rotation::error(&orientation, &pose.rotation);
            let error = Twist::new(away.x, away.y, away.z, turn.x, turn.y, turn.z);
            let bounds = JointBox::new(
                &(lower - q).sup(&JointVector::repeat(-IK_STEP)),
                &(upper - q).inf(&JointVector::repeat(IK_STEP)),
            );
            let jacobian = self.model.zero_jacobian(Frame::EndEffector, &q, &self.ee);
            let posture = JointVector::zeros();
            let solver = DifferentialIk::default();
            let step = solver.solve(&jacobian, &error, &posture, &bounds, Default::default());
            q += step.velocity;
        }
        q
    }

    fn pose(&self, q: &JointVector) -> Option<franka_async::Pose> {
        transform::isometry(&self.model.pose(Frame::EndEffector, q, &self.ee))
    }
}

/// Torques that approach the requested ones as fast as the robot allows.
pub(super) struct Torque {
    limits: &'static JointLimits,
    /// Requested torques, `[N·m]`.
    wanted: JointVector,
    torque: JointVector,
}

impl Torque {
    fn advance(&mut self) -> JointVector {
        for i in 0..7 {
            // Slightly less, because of rounding.
            let most = 0.999 * self.limits.torque_rate[i] * CYCLE;
            self.torque[i] += (self.wanted[i] - self.torque[i]).clamp(-most, most);
        }
        self.torque
    }
}

/// Share of the largest accelerations and jerks that motions use.
const ACCELERATION: f64 = 0.4;
const JERK: f64 = 0.5;

/// Share of the velocity envelope's deceleration. The rest, and the distance of targets from the
/// ends of the ranges, compensate for the reduced speed of the envelope.
const DECELERATION: f64 = 0.6;

/// Rate at which a velocity approaches the requested one, `[1/s]`.
const RESPONSE: f64 = 100.0;

/// Share of the acceleration planned before the end of a range; the rest compensates for the
/// response.
const BRAKING: f64 = 0.6;

/// Velocity per distance to the end of a range, close to it, `[1/s]`.
const APPROACH: f64 = 4.0;

/// Largest distance of a target ahead, `[rad]`.
const LEASH: f64 = 0.3;

/// Number of inverse kinematics steps for an action; four steps reach a pose to a micrometre from
/// centimetres.
const IK_STEPS: usize = 4;

/// Largest displacement of a joint in one step, `[rad]`.
const IK_STEP: f64 = 0.1;
