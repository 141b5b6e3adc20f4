//! The commands, a file for each.

mod bench;
mod cassette;
mod collision;
mod completions;
mod explain;
mod export;
mod gripper;
mod guide;
mod limits;
mod man;
mod model;
mod move_to;
mod read;
mod record;
mod recover;
mod replay;
mod robots;
mod sim;
mod state;
mod stop;
mod tap;
mod test;
mod tool;
mod view;

use clap::Subcommand;

use crate::ending::Ending;

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Show what the robot says: mode, errors, joints, forces, link
    State(state::State),
    /// Print fields of the robot's state
    Read(read::Read),
    /// Compute with the model of the arm
    #[command(subcommand)]
    Model(model::Model),
    /// Print the limits of the arm
    Limits(limits::Limits),
    /// Move the arm
    Move(move_to::Move),
    /// Let a hand guide the arm
    Guide(guide::Guide),
    /// Stop what this computer has left in motion
    Stop(stop::Stop),
    /// Lead the robot out of a reflex
    Recover(recover::Recover),
    /// Move the fingers of the Franka Hand
    #[command(subcommand)]
    Gripper(gripper::Gripper),
    /// Declare what is at the flange, or measure it
    #[command(subcommand)]
    Tool(tool::Tool),
    /// Set the forces at which the robot stops itself
    Collision(collision::Collision),
    /// Name robots
    #[command(subcommand)]
    Robots(robots::Robots),
    /// Be a simulated robot
    #[command(after_help = sim::EXAMPLES)]
    Sim(franka_sim::command_line::Arguments),
    /// Record what happens to a robot
    Record(record::Record),
    /// Say why a recorded motion ended, and where the arm was touched
    Explain(explain::Explain),
    /// Move as recorded
    Replay(replay::Replay),
    /// Export a recording as tables, or as a dataset for training
    Export(export::Export),
    /// Record what passes between clients and a robot, byte for byte
    Tap(tap::Tap),
    /// Play what a tap has recorded, or convert it
    #[command(subcommand)]
    Cassette(cassette::Cassette),
    /// Test a robot's connection
    #[command(subcommand)]
    Test(test::Test),
    /// Measure this computer
    #[command(subcommand)]
    Bench(bench::Bench),
    /// Print the completions for a shell
    Completions(completions::Completions),
    /// Write the man pages
    Man(man::Man),
}

impl Command {
    /// Whether the command logs by itself.
    pub(crate) fn logs(&self) -> bool {
        matches!(self, Self::Sim(_))
    }

    /// Does what the command says.
    pub(crate) fn run(self) -> anyhow::Result<Ending> {
        match self {
            Self::Limits(limits) if limits.is_offline() => return limits.print_constants(),
            Self::Robots(robots) => return robots.run(),
            Self::Explain(explain) => return explain.run(),
            Self::Export(export) => return export.run(),
            Self::Cassette(cassette) => return cassette.run(),
            Self::Completions(completions) => return completions.run(),
            Self::Man(man) => return man.run(),
            Self::Bench(bench::Bench::Wake(wake)) => return wake.run(),
            _ => {}
        }
        let runtime = tokio::runtime::Runtime::new()?;
        let outcome = runtime.block_on(async {
            match self {
                Self::State(state) => state.run().await,
                Self::Read(read) => read.run().await,
                Self::Model(model) => model.run().await,
                Self::Limits(limits) => limits.run().await,
                Self::Move(motion) => motion.run().await,
                Self::Guide(guide) => guide.run().await,
                Self::Stop(stop) => stop.run().await,
                Self::Recover(recover) => recover.run().await,
                Self::Gripper(gripper) => gripper.run().await,
                Self::Tool(tool) => tool.run().await,
                Self::Collision(collision) => collision.run().await,
                Self::Sim(arguments) => sim::run(&arguments).await,
                Self::Record(record) => record.run().await,
                Self::Replay(replay) => replay.run().await,
                Self::Tap(tap) => tap.run().await,
                Self::Test(test) => test.run().await,
                Self::Bench(bench::Bench::Loop(bench)) => bench.run().await,
                _ => unreachable!("done without a runtime"),
            }
        });
        // Whatever still runs has nothing to do with the robot: its connection is closed.
        runtime.shutdown_background();
        outcome
    }
}
