//! `franka doctor`: this computer and the way to a robot, checked before an arm moves.

use std::net::{IpAddr, SocketAddr};
use std::time::{Duration, Instant};

use anstream::ColorChoice;
use clap::{Args, ValueEnum};
use franka_async::Robot;
use franka_async::record::CycleFeed;
use franka_doctor::{
    Answer, Doctor as Checks, Purpose, Received, Report, System, answers, arrivals, handshake,
    ports,
};

use crate::connection::{Place, Which, resolve};
use crate::ending::Ending;
use crate::motion::progress_bar;
use crate::output::{Output, line, say};
use crate::robots_file::Realtime;

/// Check this computer, and the way to a robot
///
/// Changes nothing. With a robot, its ports are tried and its states counted while it rests; it is
/// not moved. Exit code 1: something would keep the purpose from being served.
#[derive(Debug, Args)]
pub(crate) struct Doctor {
    #[command(flatten)]
    which: Which,
    /// What this computer is to do
    #[arg(long = "for", value_enum, default_value_t = For::Move)]
    purpose: For,
    /// Print a script with the commands that fix what was found, for reading before running
    #[arg(long, conflicts_with = "json")]
    fix: bool,
    /// Measure for a minute, instead of ten seconds
    #[arg(long)]
    long: bool,
    /// Measure nothing that takes time
    #[arg(long, conflicts_with = "long")]
    quick: bool,
    /// Say what is good, too, and why and by which source
    #[arg(long, conflicts_with_all = ["json", "fix"])]
    all: bool,
    #[command(flatten)]
    output: Output,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum For {
    /// Simulate robots
    Sim,
    /// Read the states of a robot
    Read,
    /// Move a robot
    Move,
}

impl For {
    fn purpose(self) -> Purpose {
        match self {
            Self::Sim => Purpose::Sim,
            Self::Read => Purpose::Read,
            Self::Move => Purpose::Move,
        }
    }
}

impl Doctor {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        // No robot is needed: only one that is named is asked.
        let place = match self.which.robot {
            Some(_) => Some(self.which.place()?),
            None => None,
        };
        let address = match &place {
            Some(place) => Some(resolve(&place.address, ROBOT).await?),
            None => None,
        };
        let mut report = self.host(address.map(|address| address.ip())).await?;
        if let (Some(place), Some(address)) = (&place, address) {
            self.robot(&mut report, place, address).await?;
        }
        if self.output.json {
            line(&report.to_json())?;
        } else if self.fix {
            line(report.fix_script().trim_end())?;
        } else {
            let color = anstream::AutoStream::choice(&std::io::stdout()) != ColorChoice::Never;
            let text = match self.all {
                true => report.to_detailed_text(color),
                false => report.to_text(color),
            };
            line(text.trim_end())?;
        }
        Ok(match report.exit_code() {
            0 => Ending::Done,
            _ => Ending::Failed,
        })
    }

    /// How long states are counted.
    fn length(&self) -> Duration {
        Duration::from_secs(match (self.quick, self.long) {
            (true, _) => 1,
            (_, true) => 60,
            _ => 10,
        })
    }

    /// The checks of this computer, with the card on the way to `robot`.
    async fn host(&self, robot: Option<IpAddr>) -> anyhow::Result<Report> {
        let mut checks = Checks::new(self.purpose.purpose()).long(self.long);
        if let Some(IpAddr::V4(robot)) = robot {
            checks = checks.robot(robot);
        }
        if self.quick {
            checks = checks.timing(false);
        }
        let bar = progress_bar();
        let shown = bar.clone();
        let run = move || {
            checks.run(&System::default(), &mut |what, part| {
                shown.set_position((part * 1000.0) as u64);
                shown.set_message(what.to_owned());
            })
        };
        let report = tokio::task::spawn_blocking(run).await?;
        bar.finish_and_clear();
        Ok(report)
    }

    /// What answers at the robot's address, and how regularly its states come.
    async fn robot(
        &self,
        report: &mut Report,
        place: &Place,
        address: SocketAddr,
    ) -> anyhow::Result<()> {
        let purpose = self.purpose.purpose();
        let connected = place
            .connect(Some(Realtime::Ignore), |builder| builder)
            .await;
        let answered = match connected {
            Ok(robot) => {
                let answered = vec![Answer::Accepted(robot.version())];
                let states = received(&robot, self.length()).await;
                robot.shutdown().await;
                report.add(arrivals(&states?, purpose));
                answered
            }
            // The report is about the rest all the same.
            Err(error) => {
                say(&format!("the robot's states were not checked: {error:#}"));
                match Ending::of(&error) {
                    Ending::Taken => vec![Answer::Closed],
                    _ => tokio::task::spawn_blocking(move || answers(address)).await?,
                }
            }
        };
        report.add(handshake(&answered, purpose));
        // Whoever has the robot is not disturbed by what follows.
        let taken = answered.last() == Some(&Answer::Closed);
        if address.port() == ROBOT && !taken {
            let found = tokio::task::spawn_blocking(move || ports(address.ip(), purpose)).await?;
            report.add(found);
        }
        Ok(())
    }
}

/// States as they arrive, for some seconds.
async fn received(robot: &Robot, length: Duration) -> anyhow::Result<Vec<Received>> {
    let begin = Instant::now();
    let mut reader = robot.cycles(CycleFeed::<()>::DEFAULT_CAPACITY)?;
    let read = move || {
        let mut states = Vec::new();
        while begin.elapsed() < length && !reader.has_ended() {
            reader.wait(Duration::from_millis(100));
            while let Some(cycle) = reader.pop() {
                let time = cycle.received.saturating_duration_since(begin);
                states.push((cycle.state.message_id, time));
            }
        }
        states
    };
    Ok(tokio::task::spawn_blocking(read).await?)
}

/// Where robots listen.
const ROBOT: u16 = 1337;
