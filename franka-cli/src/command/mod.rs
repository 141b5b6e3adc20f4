//! The commands, in one file each.

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
    #[command(after_help = "Example: franka doctor 172.16.0.2 --quick")]
    Doctor(doctor::Doctor),
    #[command(after_help = "Example: franka state left --watch")]
    State(state::State),
    #[command(after_help = "Example: franka read left q O_T_EE")]
    Read(read::Read),
    #[command(subcommand)]
    Model(model::Model),
    #[command(after_help = "Example: franka limits --kind fr3")]
    Limits(limits::Limits),
    #[command(after_help = "Example: franka move left --by 0,0,0.05")]
    Move(move_to::Move),
    #[command(after_help = "Example: franka guide left --free position")]
    Guide(guide::Guide),
    #[command(after_help = "Example: franka stop left")]
    Stop(stop::Stop),
    #[command(after_help = "Example: franka recover left")]
    Recover(recover::Recover),
    #[command(subcommand)]
    Gripper(gripper::Gripper),
    #[command(subcommand)]
    Tool(tool::Tool),
    #[command(after_help = "Example: franka collision compliant left")]
    Collision(collision::Collision),
    #[command(subcommand)]
    Robots(robots::Robots),
    #[command(about = "Run the simulator", after_help = sim::EXAMPLES)]
    Sim(sim::Sim),
    #[command(after_help = "Example: franka dash left right --allow-motion")]
    Dash(dash::Dash),
    #[command(after_help = "Example: franka record day.mcap left --seconds 60")]
    Record(record::Record),
    #[command(after_help = "Example: franka explain day.mcap --figure stop.svg")]
    Explain(explain::Explain),
    #[command(after_help = "Example: franka replay day.mcap left --speed 0.5")]
    Replay(replay::Replay),
    #[command(after_help = "Example: franka export day.mcap --csv day.csv --columns q,dq")]
    Export(export::Export),
    #[command(after_help = "Example: franka tap wire.mcap left --port 1340")]
    Tap(tap::Tap),
    #[command(subcommand)]
    Cassette(cassette::Cassette),
    #[command(subcommand)]
    Test(test::Test),
    #[command(after_help = trial::EXAMPLES)]
    Trial(trial::Trial),
    #[command(subcommand)]
    Bench(bench::Bench),
    #[command(after_help = "Example: franka completions fish")]
    Completions(completions::Completions),
    #[command(after_help = "Example: franka man man1")]
    Man(man::Man),
}

impl Command {
    /// Returns true if the command sets up its own logging.
    pub(crate) fn logs(&self) -> bool {
        matches!(self, Self::Sim(_) | Self::Tap(_))
    }

    /// Runs the command.
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
        // The connection to the robot is closed, so the remaining tasks are no longer needed.
        runtime.shutdown_background();
        outcome
    }
}
