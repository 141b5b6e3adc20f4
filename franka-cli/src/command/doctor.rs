//! `franka doctor`: this computer and the way to a robot, checked before an arm moves.

use std::net::{IpAddr, SocketAddr};
use std::pin::pin;
use std::time::{Duration, Instant};

use anstream::ColorChoice;
use clap::{Args, ValueEnum};
use franka_async::Robot;
use franka_async::doctor::{
    Answer, Doctor as Checks, DryRun, Finding, Purpose, Received, Report, System, answers,
    arrivals, dry_run, handshake, ports,
};
use franka_async::realtime::Scheduling;
use franka_async::record::CycleFeed;
use franka_sim::Sim;

use super::bench;
use crate::connection::{Place, Which, resolve};
use crate::ending::Ending;
use crate::motion::progress_bar;
use crate::output::{Output, line, say};
use crate::robots_file::Realtime;

/// Check this computer, and the way to a robot
///
/// Changes nothing. With a robot, its states are counted while it rests, its ports tried and echo
/// requests sent, unless another client is connected to it; it is not moved. Exit code 1: a check
/// failed that the purpose needs.
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
    /// Measure for a second, and neither wake-ups nor round trips
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
        // The robot first: with another client connected, checks that would disturb it are left
        // out.
        let mut found = Vec::new();
        let mut taken = false;
        if let (Some(place), Some(address)) = (&place, address) {
            (found, taken) = self.robot(place, address).await?;
        }
        let mut report = self
            .host(address.map(|address| address.ip()), !taken)
            .await?;
        report.add(found);
        if self.purpose != For::Sim {
            report.add(self.dry_run().await);
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

    /// How long states are counted, and the dry run takes.
    fn length(&self) -> Duration {
        Duration::from_secs(match (self.quick, self.long) {
            (true, _) => 1,
            (_, true) => 60,
            _ => 10,
        })
    }

    /// The checks of this computer, with the card on the way to `robot`, which may be sent echo
    /// requests if `ping`.
    async fn host(&self, robot: Option<IpAddr>, ping: bool) -> anyhow::Result<Report> {
        let mut checks = Checks::new(self.purpose.purpose())
            .long(self.long)
            .ping(ping);
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

    /// The control loop of the driver against a simulated robot in this process.
    async fn dry_run(&self) -> Option<Finding> {
        let bar = progress_bar();
        bar.set_message("timing.dry_run");
        let (begin, length) = (Instant::now(), self.length());
        let mut run = pin!(bench::dry_run(punctual(), length));
        let mut clock = tokio::time::interval(Duration::from_millis(100));
        let ran = loop {
            tokio::select! {
                biased;
                ran = &mut run => break ran,
                _ = clock.tick() => {
                    let part = begin.elapsed().as_secs_f64() / length.as_secs_f64();
                    bar.set_position((part * 1000.0) as u64);
                }
            }
        };
        bar.finish_and_clear();
        match ran {
            Ok((outcome, stats, granted)) => {
                let run = DryRun {
                    ended: outcome.err().map(|error| error.to_string()),
                    ..DryRun::new(&stats, granted.priority)
                };
                Some(dry_run(&run, self.purpose.purpose()))
            }
            // The report is about the rest all the same.
            Err(error) => {
                say(&format!(
                    "there was no dry run of the control loop: {error:#}"
                ));
                None
            }
        }
    }

    /// The findings on the robot's address and its states, and whether another client is connected.
    async fn robot(
        &self,
        place: &Place,
        address: SocketAddr,
    ) -> anyhow::Result<(Vec<Finding>, bool)> {
        let mut found = Vec::new();
        let purpose = self.purpose.purpose();
        let connected = place
            .connect(Some(Realtime::Ignore), |builder| builder)
            .await;
        let answered = match connected {
            Ok(robot) => {
                let answered = vec![Answer::Accepted(robot.version())];
                let states = received(&robot, self.length()).await;
                robot.shutdown().await;
                found.extend(arrivals(&states?, purpose));
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
        found.extend(handshake(&answered, purpose));
        let taken = answered.last() == Some(&Answer::Closed);
        if address.port() == ROBOT && !taken {
            let ports = tokio::task::spawn_blocking(move || ports(address.ip(), purpose)).await?;
            found.extend(ports);
        }
        Ok((found, taken))
    }
}

/// A simulated robot that keeps its millisecond as well as this computer can, and ends a motion if
/// too many commands are late.
fn punctual() -> Sim {
    // On the thread of the robot. What is refused leaves it as it is.
    let mut scheduling = Some(Scheduling {
        realtime: franka_async::Realtime::Ignore,
        prefault_stack: 0,
        ..Scheduling::default()
    });
    Sim::fr3().every_millisecond(move |_| {
        if let Some(scheduling) = scheduling.take() {
            let _ = scheduling.enter();
        }
    })
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
