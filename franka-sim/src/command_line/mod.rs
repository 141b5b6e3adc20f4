//! The command line of the simulator, for programs that start a simulator: the binary `franka-sim`,
//! and programs with a subcommand for it (feature `command-line`).
//!
//! | module | content |
//! |---|---|
//! | `arguments` | the options |
//! | `values` | checked values of options |
//! | `setup` | creates the robot, plant, grippers and network that the options describe |

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
    /// Returns an error if the options describe no valid robot, if an address is in use, or if the
    /// simulation has ended.
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
        // Otherwise, the simulation stops when its last owner drops it.
        if let Some(sim) = Arc::into_inner(sim) {
            sim.stop().await;
        }
        Ok(())
    }
}
