//! A hand that pushes the arm, and what it feels, in the robot's time.

use std::sync::mpsc;

use anyhow::Context as _;
use franka_sim::{Robot, Sim, Touch, TouchId};
use franka_tests::push::{PUSH, START, STIFFNESS, hand};
use nalgebra::Vector3;
use tokio::sync::oneshot;
use tokio::time::timeout;

use crate::PATIENCE;

/// The time at constant velocity that is left out of the mean force, `[ms]`: contact and arm still
/// oscillate then.
const SWING: u64 = 100;

/// The time at the beginning of a push that is left out, `[ms]`.
const LEFT_OUT: u64 = (START * 1e3) as u64 + SWING;

/// Orders pushes of a robot that is being simulated.
pub(crate) struct Hand {
    orders: mpsc::Sender<Order>,
}

/// The direction of a push, and where the mean force goes.
type Order = (Vector3<f64>, oneshot::Sender<f64>);

/// A push under way.
struct Push {
    touch: TouchId,
    /// `message_id` at the beginning.
    begun: u64,
    /// The forces felt so far, `[N]`.
    sum: f64,
    mean: oneshot::Sender<f64>,
}

impl Hand {
    /// A hand beside this robot. It moves and feels in every millisecond of the robot, however late
    /// this program is.
    pub(crate) fn beside(sim: Sim) -> (Self, Sim) {
        let (orders, ordered) = mpsc::channel::<Order>();
        let mut push = None;
        let sim = sim.every_millisecond(move |robot| {
            push = match push.take() {
                Some(push) => Push::feel(push, robot),
                None => ordered
                    .try_recv()
                    .ok()
                    .map(|order| Push::begin(order, robot)),
            };
        });
        (Self { orders }, sim)
    }

    /// The mean force on a hand that moves at constant velocity along `way`, `[N]`: no part of it
    /// accelerates the arm.
    pub(crate) async fn push(&self, way: Vector3<f64>) -> anyhow::Result<f64> {
        let (mean, felt) = oneshot::channel();
        self.orders.send((way, mean)).context("no robot")?;
        let felt = timeout(PATIENCE, felt).await;
        felt.context("nothing answers")?.context("no robot")
    }
}

impl Push {
    fn begin((way, mean): Order, robot: &mut Robot) -> Self {
        let pose = robot.state().O_T_EE;
        let from = Vector3::new(pose[12], pose[13], pose[14]);
        Self {
            touch: robot.touch(Touch::carry(move |t| from + way * hand(t), STIFFNESS)),
            begun: robot.state().message_id,
            sum: 0.0,
            mean,
        }
    }

    /// Takes in the force of the last millisecond. Returns the push unless it is over.
    fn feel(mut self, robot: &mut Robot) -> Option<Self> {
        let time = robot.state().message_id - self.begun;
        if time > LEFT_OUT {
            let force = robot.felt(self.touch).expect("it lasts until released");
            self.sum += force.fixed_rows::<3>(0).norm();
        }
        if time < PUSH {
            return Some(self);
        }
        robot.release(self.touch);
        // The order may have been given up.
        let _ = self.mean.send(self.sum / (PUSH - LEFT_OUT) as f64);
        None
    }
}
