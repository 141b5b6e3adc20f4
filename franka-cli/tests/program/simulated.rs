//! Robots in this process.

use std::thread;
use std::time::Duration;

use franka_async::state::{RobotMode, RobotState};
use franka_sim::{Fingers, Robot, Running, Sim, Tool};
use tokio::runtime::Runtime;

use crate::program::until;

/// A simulated robot with a Hand, and its runtime.
pub(crate) struct Simulated {
    runtime: Runtime,
    sim: Running,
}

impl Simulated {
    pub(crate) fn fr3() -> Self {
        Self::of(Sim::fr3())
    }

    pub(crate) fn fer() -> Self {
        Self::of(Sim::fer())
    }

    /// Runs a test with robots of both kinds, in parallel.
    pub(crate) fn each(test: impl Fn(&Self) + Sync) {
        Self::each_kind(|_, sim| test(sim));
    }

    /// Runs a test with robots of both kinds from [`Self::fast`], one after the other, because each
    /// keeps a processor busy.
    pub(crate) fn each_fast(test: impl Fn(&Self)) {
        test(&Self::fast(Sim::fr3()));
        test(&Self::fast(Sim::fer()));
    }

    /// Runs a test with robots of both kinds, in parallel. The test also gets a robot of the same
    /// kind that is not started.
    pub(crate) fn each_kind(test: impl Fn(Sim, &Self) + Sync) {
        thread::scope(|scope| {
            for kind in [Sim::fr3 as fn() -> Sim, Sim::fer] {
                let test = &test;
                scope.spawn(move || test(kind(), &Self::of(kind())));
            }
        });
    }

    /// Starts a robot whose clock runs as fast as the program answers, for uninterrupted motions.
    pub(crate) fn fast(sim: Sim) -> Self {
        Self::start(sim.virtual_time(PATIENCE))
    }

    fn of(sim: Sim) -> Self {
        Self::start(sim.wait_for_commands(PATIENCE))
    }

    /// Starts a robot with a tool and a Hand.
    pub(crate) fn start(sim: Sim) -> Self {
        let runtime = Runtime::new().expect("a runtime");
        let object = Fingers::new().with_object(0.03);
        let sim = sim.tool(Tool::hand()).hand(object, 0);
        let sim = runtime.block_on(sim.start()).expect("a simulator");
        Self { runtime, sim }
    }

    /// Returns the robot's address.
    pub(crate) fn address(&self) -> String {
        self.sim.addr().to_string()
    }

    /// Returns the address of the robot's Hand.
    pub(crate) fn hand(&self) -> String {
        self.sim.hand().expect("a Hand").addr().to_string()
    }

    /// Returns the distance between the fingers, `[m]`.
    pub(crate) fn fingers_width(&self) -> f64 {
        let hand = self.sim.hand().expect("a Hand");
        let width = hand.with(|hand| hand.state().width);
        self.runtime.block_on(width).expect("it runs")
    }

    pub(crate) fn with<R: Send + 'static>(
        &self,
        function: impl FnOnce(&mut Robot) -> R + Send + 'static,
    ) -> R {
        self.runtime
            .block_on(self.sim.with(function))
            .expect("it runs")
    }

    pub(crate) fn state(&self) -> RobotState {
        self.with(|robot| *robot.state())
    }

    /// Waits until the arm moves.
    pub(crate) fn moves(&self) {
        until("a motion", || {
            let state = self.state();
            state.robot_mode == RobotMode::Move && speed(&state) > 0.01
        });
    }

    /// Checks that the arm is at rest and that the robot is in this mode.
    #[track_caller]
    pub(crate) fn rests(&self, mode: RobotMode) {
        until("rest", || {
            let state = self.state();
            state.robot_mode == mode && speed(&state) < 0.01
        });
    }

    /// Ends the simulation.
    pub(crate) fn end(self) {
        self.runtime.block_on(self.sim.stop());
    }
}

/// Returns the speed of the fastest joint, `[rad/s]`.
fn speed(state: &RobotState) -> f64 {
    state.dq.iter().fold(0.0, |most, dq| dq.abs().max(most))
}

/// Time for which the robot waits for a command of a busy computer. Twenty consecutive missing
/// commands end a motion. The robot also waits for a command that the driver has skipped, and sends
/// no states meanwhile. After a second without states, the driver considers the robot lost.
const PATIENCE: Duration = Duration::from_millis(100);
