//! The hand can be guided freely above a virtual floor: a spring and a damper that only push
//! upwards. Springs in the nullspace, which do not affect the hand, pull the elbow back to its
//! posture.
//!
//! `cargo run --release --example virtual_floor -- [ADDRESS] [--below 0.05] [--seconds 20]`

use clap::Parser;
use franka_async::READY;
use franka_async::control::{Finish, Torques};
use franka_async::model::{Dynamics, JointVector, StateModel, Twist, Wrench};
use franka_async::state::RobotState;
use franka_examples::{Connection, Summary, push_simulated, report_hand};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Distance of the floor below the ready pose, `[m]`.
    #[arg(long, default_value_t = 0.05)]
    below: f64,
    /// Duration of the guiding, `[s]`.
    #[arg(long, default_value_t = 20.0)]
    seconds: f64,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let what = "lets itself be led by the hand";
    let (robot, sim) = arguments.connection.open_ready(what).await?;
    let law = Law {
        model: robot.state_model(),
        floor: robot.pose().translation.z - arguments.below,
    };
    println!("floor at {:.4} m", law.floor);
    if let Some(sim) = &sim {
        push_simulated(sim, [0.0, 0.0, -12.0]).await?;
    }
    let reporter = report_hand(&robot);
    let mut time = 0.0;
    let free = robot.control_torques(move |state, step| {
        time += step.as_secs_f64();
        law.torques(state).finish_if(time >= arguments.seconds)
    });
    let report = free.limit_rate(true).await?;
    reporter.abort();
    robot.shutdown().await;
    println!("{}", Summary(&report));
    Ok(())
}

struct Law {
    model: StateModel,
    /// Height of the floor in the base frame, `[m]`.
    floor: f64,
}

/// Stiffness of the floor, `[N/m]`.
const STIFFNESS: f64 = 2000.0;
/// Damping of the floor, `[s/m]`: the relative increase of its stiffness per velocity of the hand
/// into it. Damping that grows with depth starts without a step (Hunt and Crossley, 1975).
const DAMPING: f64 = 5.0;
/// Damping of the hand everywhere, `[N s/m]` and `[N m s/rad]`, which stops it when it is released.
const OIL: [f64; 6] = [20.0, 20.0, 20.0, 1.5, 1.5, 1.5];
/// Stiffness and damping of the posture, `[N m/rad]` and `[N m s/rad]`.
const POSTURE: (f64, f64) = (20.0, 4.0);

impl Law {
    fn torques(&self, state: &RobotState) -> Torques {
        let dynamics = self.model.dynamics(state);
        let dq = JointVector::from(state.dq);
        let twist = dynamics.jacobian * dq;

        let mut wrench = Wrench::from_fn(|i, _| -OIL[i] * twist[i]);
        wrench[2] += push_of_the_floor(self.floor - dynamics.pose[(2, 3)], twist[2]);
        let posture = (READY - JointVector::from(state.q)) * POSTURE.0 - dq * POSTURE.1;

        let felt = dynamics.jacobian.tr_mul(&wrench);
        Torques((felt + unfelt(&dynamics, &posture) + dynamics.coriolis).into())
    }
}

/// Returns the force of the floor on a hand `depth` below it that moves upwards at `velocity`,
/// `[N]`. Never downwards, so that the floor does not hold a hand that leaves it.
fn push_of_the_floor(depth: f64, velocity: f64) -> f64 {
    STIFFNESS * depth.max(0.0) * (1.0 - DAMPING * velocity).max(0.0)
}

/// Returns the part of `torques` that does not accelerate the hand: `(1 - J' L J M^-1) torques`
/// with `L = (J M^-1 J')^-1`, the effective inertia of the hand (Khatib, A unified approach for
/// motion and force control of robot manipulators, 1987). Zero if the hand cannot move in every
/// direction, because the part is then undefined.
fn unfelt(dynamics: &Dynamics, torques: &JointVector) -> JointVector {
    let Some(hand) = dynamics.operational_space() else {
        return JointVector::zeros();
    };
    let Some(mass) = dynamics.mass.cholesky() else {
        return JointVector::zeros();
    };
    let acceleration: Twist = dynamics.jacobian * mass.solve(torques);
    match hand.inertia() {
        Some(inertia) => torques - dynamics.jacobian.tr_mul(&(inertia * acceleration)),
        None => JointVector::zeros(),
    }
}
