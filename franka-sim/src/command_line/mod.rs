//! The command line of the simulator, for programs that start one: the binary `franka-sim`, and
//! the subcommand of another (feature `command-line`).
//!
//! | module | content |
//! |---|---|
//! | `arguments` | the options |
//! | `values` | checked values of options |
//! | `setup` | options to a robot, a plant, grippers and a network |

mod arguments;
mod setup;
mod values;

use std::io;
use std::sync::Arc;

use tokio::signal::unix::{SignalKind, signal};

pub use arguments::{Arguments, Kind, NetworkKind, PlantKind};
pub use values::numbers;

use crate::Running;

impl Arguments {
    /// Simulates until SIGINT or SIGTERM. Once the robot is ready, calls `ready` with the robot and
    /// with one line of text per address on which the robot listens.
    ///
    /// # Errors
    /// An error if the options describe no valid robot, an address is in use, or the simulation has
    /// ended.
    pub async fn run(
        &self,
        ready: impl AsyncFnOnce(&Arc<Running>, &str) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut interrupt = signal(SignalKind::interrupt())?;
        let mut terminate = signal(SignalKind::terminate())?;
        let sim = self.sim().map_err(io::Error::other)?;
        let sim = sim.start().await.map_err(|error| {
            let kind = error.kind();
            io::Error::new(kind, format!("cannot listen on {error}"))
        })?;
        let mut lines = format!("listening on {}", sim.addr());
        if let Some(hand) = sim.hand() {
            lines += &format!("\nFranka Hand on {}", hand.addr());
        }
        if let Some(gripper) = sim.vacuum_gripper() {
            lines += &format!("\nvacuum gripper on {}", gripper.addr());
        }
        let sim = Arc::new(sim);
        ready(&sim, &lines).await?;
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
            () = sim.ended() => return Err(io::Error::other("the simulation has ended")),
        }
        // Otherwise, the last owner stops the simulation by dropping it.
        if let Some(sim) = Arc::into_inner(sim) {
            sim.stop().await;
        }
        Ok(())
    }
}
