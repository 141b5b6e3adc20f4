//! A hand that pushes the arm and measures the force, in the robot's time.

use std::sync::mpsc;

use anyhow::Context as _;
use franka_proto::RobotMode;
use franka_sim::{Robot, Sim, Touch, TouchId};
use franka_tests::push::{PUSH, START, STIFFNESS, hand};
use nalgebra::Vector3;
use tokio::sync::oneshot;
use tokio::time::timeout;

use crate::PATIENCE;
use crate::witness::Witness;

/// Time at constant velocity that is excluded from the mean force, `[ms]`: contact and arm still
/// oscillate then.
const SWING: u64 = 100;

/// Time at the beginning of a push that is excluded, `[ms]`.
const LEFT_OUT: u64 = (START * 1e3) as u64 + SWING;

/// Requests pushes of a simulated robot.
pub(crate) struct Hand {
    orders: mpsc::Sender<Order>,
    witness: Witness,
}

/// The direction of a push, and the channel for its result.
type Order = (Vector3<f64>, oneshot::Sender<Felt>);

/// The result of a push.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Felt {
    /// The mean force at constant velocity, `[N]`: no part of it accelerates the arm.
    Mean(f64),
    /// The largest force before the robot stopped itself, `[N]`.
    Reflex(f64),
}

/// A running push.
struct Push {
    touch: TouchId,
    /// `message_id` at the beginning.
    begun: u64,
    /// Sum of the forces so far, `[N]`.
    sum: f64,
    most: f64,
    result: oneshot::Sender<Felt>,
}

impl Hand {
    /// Attaches a hand to this robot. It acts in every millisecond of the robot, regardless of
    /// delays of this program.
    pub(crate) fn beside(sim: Sim) -> (Self, Sim) {
        let (orders, ordered) = mpsc::channel::<Order>();
        let witness = Witness::default();
        let seen = witness.clone();
        let mut push = None;
        let sim = sim.every_millisecond(move |robot| {
            seen.note(robot);
            push = match push.take() {
                Some(push) => Push::feel(push, robot),
                None => ordered
                    .try_recv()
                    .ok()
                    .map(|order| Push::begin(order, robot)),
            };
        });
        (Self { orders, witness }, sim)
    }

    /// Returns its record of the robot.
    pub(crate) fn witness(&self) -> &Witness {
        &self.witness
    }

    /// Pushes along `way`.
    pub(crate) async fn push(&self, way: Vector3<f64>) -> anyhow::Result<Felt> {
        let (result, felt) = oneshot::channel();
        self.orders.send((way, result)).context("no robot")?;
        let felt = timeout(PATIENCE, felt).await;
        felt.context("nothing answers")?.context("no robot")
    }
}

impl Felt {
    pub(crate) fn newtons(self) -> f64 {
        match self {
            Self::Mean(newtons) | Self::Reflex(newtons) => newtons,
        }
    }

    /// Returns the worse result: a reflex is worse than any force, and a larger force is worse than
    /// a smaller one.
    pub(crate) fn max(self, other: Self) -> Self {
        let rank = |felt: Self| (matches!(felt, Self::Reflex(_)), felt.newtons());
        if rank(other) > rank(self) {
            other
        } else {
            self
        }
    }
}

impl Push {
    fn begin((way, result): Order, robot: &mut Robot) -> Self {
        let pose = robot.state().O_T_EE;
        let from = Vector3::new(pose[12], pose[13], pose[14]);
        Self {
            touch: robot.touch(Touch::carry(move |t| from + way * hand(t), STIFFNESS)),
            begun: robot.state().message_id,
            sum: 0.0,
            most: 0.0,
            result,
        }
    }

    /// Processes the force of the last millisecond. Returns the push unless it is complete.
    fn feel(mut self, robot: &mut Robot) -> Option<Self> {
        let state = robot.state();
        let (mode, time) = (state.robot_mode, state.message_id - self.begun);
        let force = robot.felt(self.touch).expect("it lasts until released");
        let force = force.fixed_rows::<3>(0).norm();
        self.most = self.most.max(force);
        if time > LEFT_OUT {
            self.sum += force;
        }
        let felt = match mode {
            RobotMode::Reflex => Felt::Reflex(self.most),
            _ if time < PUSH => return Some(self),
            _ => Felt::Mean(self.sum / (PUSH - LEFT_OUT) as f64),
        };
        robot.release(self.touch);
        // The requester may have given up.
        let _ = self.result.send(felt);
        None
    }
}
