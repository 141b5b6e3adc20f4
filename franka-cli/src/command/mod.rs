//! The commands, a file for each.

mod bench;
mod cassette;
mod collision;
mod completions;
mod dash;
mod doctor;
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
mod trial;
mod view;

use clap::Subcommand;

use crate::ending::Ending;

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Doctor(doctor::Doctor),
    State(state::State),
    Read(read::Read),
    #[command(subcommand)]
    Model(model::Model),
    Limits(limits::Limits),
    Move(move_to::Move),
    Guide(guide::Guide),
    Stop(stop::Stop),
    Recover(recover::Recover),
    #[command(subcommand)]
    Gripper(gripper::Gripper),
    #[command(subcommand)]
    Tool(tool::Tool),
    Collision(collision::Collision),
    #[command(subcommand)]
    Robots(robots::Robots),
    #[command(about = "Be a simulated robot", after_help = sim::EXAMPLES)]
    Sim(sim::Sim),
    Dash(dash::Dash),
    Record(record::Record),
    Explain(explain::Explain),
    Replay(replay::Replay),
    Export(export::Export),
    Tap(tap::Tap),
    #[command(subcommand)]
    Cassette(cassette::Cassette),
    #[command(subcommand)]
    Test(test::Test),
    #[command(after_help = trial::EXAMPLES)]
    Trial(trial::Trial),
    #[command(subcommand)]
    Bench(bench::Bench),
    Completions(completions::Completions),
    Man(man::Man),
}

impl Command {
    /// Whether the command logs by itself.
    pub(crate) fn logs(&self) -> bool {
        matches!(self, Self::Sim(_) | Self::Tap(_))
    }

    /// Does what the command says.
    pub(crate) fn run(self) -> anyhow::Result<Ending> {
        let runtime = tokio::runtime::Runtime::new()?;
        let outcome = runtime.block_on(async {
            match self {
                Self::Doctor(doctor) => doctor.run().await,
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
                Self::Sim(sim) => sim.run().await,
                Self::Dash(dash) => dash.run().await,
                Self::Record(record) => record.run().await,
                Self::Replay(replay) => replay.run().await,
                Self::Tap(tap) => tap.run().await,
                Self::Test(test) => test.run().await,
                Self::Trial(trial) => trial.run().await,
                Self::Bench(bench) => bench.run().await,
                Self::Robots(robots) => robots.run(),
                Self::Explain(explain) => explain.run(),
                Self::Export(export) => export.run(),
                Self::Cassette(cassette) => cassette.run(),
                Self::Completions(completions) => completions.run(),
                Self::Man(man) => man.run(),
            }
        });
        // Whatever still runs has nothing to do with the robot: its connection is closed.
        runtime.shutdown_background();
        outcome
    }
}
