//! `franka doctor`: checks this computer and the connection to a robot before an arm moves.

use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anstream::ColorChoice;
use clap::{Args, ValueEnum};
use franka_async::Robot;
use franka_async::connection::Endpoint;
use franka_async::doctor::{
    Answer, Doctor as Checks, DryRun, Finding, Purpose, Received, Report, Selection, System,
    Verdict, answers, arrivals, at_rest, dry_run, firewall, handshake, ports,
};
#[cfg(feature = "desk")]
use franka_async::doctor::{ask_desk, web};
use franka_async::realtime::Scheduling;
use franka_async::record::CycleFeed;
use franka_sim::Sim;

use super::bench;
use crate::connection::{Place, Seen, Which, resolve};
use crate::ending::{Ending, Failure};
use crate::motion::{progress_bar, shown};
use crate::output::{Output, line, say};
use crate::robots_file::Realtime;

/// Check this computer, and the connection to a robot
///
/// Changes nothing and moves nothing. With a robot, unless another client is connected to it, it
/// counts the states of the robot at rest, tries its ports and sends pings. Exit code 1: a check
/// failed that the purpose requires.
#[derive(Debug, Args)]
pub(crate) struct Doctor {
    /// Name or address of a robot; without it, only this computer is checked
    #[arg(value_name = "ROBOT")]
    robot: Option<String>,
    /// Purpose of this computer
    #[arg(long = "for", value_enum, default_value_t = For::Move)]
    purpose: For,
    /// Print a script that fixes the findings, to read before you run it
    #[arg(long, conflicts_with = "json")]
    fix: bool,
    /// Thorough: one-minute measurements instead of ten seconds
    #[arg(long)]
    long: bool,
    /// Quick: one-second measurements; skip wake-up, loopback and ping tests
    #[arg(long, conflicts_with = "long")]
    quick: bool,
    /// Show passed checks too, with reasons and sources
    #[arg(long, conflicts_with_all = ["json", "fix"])]
    all: bool,
    /// Run only these checks, by id or by group, as in `nic,timing.wake_up`
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    only: Vec<String>,
    /// Skip these checks
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    skip: Vec<String>,
    /// Show user names, hardware addresses, UUIDs and serial numbers
    #[arg(long)]
    unredacted: bool,
    /// Address of Desk [default: the robot's, port 443]; queried without a login
    #[arg(long, value_name = "ADDRESS", requires = "robot")]
    desk: Option<Endpoint>,
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
        #[cfg(not(feature = "desk"))]
        if self.desk.is_some() {
            return Err(Failure::without("--desk", "desk").into());
        }
        let place = match &self.robot {
            Some(robot) => Some(Which::of(Some(robot.clone())).place()?),
            None => None,
        };
        let address = match &place {
            Some(place) => Some(resolve(&place.address, ROBOT).await?),
            None => None,
        };
        // The robot is checked first. If another client is connected, the checks that would disturb
        // this client are skipped.
        let selection = Selection::new(self.only.clone(), self.skip.clone());
        let mut found = Vec::new();
        let mut taken = false;
        if let (Some(place), Some(address)) = (&place, address)
            && ROBOT_CHECKS.iter().any(|id| selection.takes(id))
        {
            (found, taken) = self.robot(place, address).await?;
        }
        if self.purpose != For::Sim && selection.takes("timing.dry_run") {
            found.extend(self.dry_run().await);
        }
        found.retain(|finding| selection.takes(finding.id));
        let robot = address.map(|address| address.ip());
        let mut report = self.host(robot, selection, !taken).await?;
        report.add(found);
        if report.findings.is_empty() {
            let failure = Failure::usage("none of the chosen checks exists or can run here");
            return Err(failure
                .advice("franka doctor --all names all checks.")
                .into());
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

    /// Returns the duration of the dry run, which is also the time for which states are counted.
    fn length(&self) -> Duration {
        Duration::from_secs(match (self.quick, self.long) {
            (true, _) => 1,
            (_, true) => 60,
            _ => 10,
        })
    }

    /// Runs the checks of this computer and of the network card on the route to `robot`. If `ping`
    /// is true, sends echo requests to the robot.
    async fn host(
        &self,
        robot: Option<IpAddr>,
        selection: Selection,
        ping: bool,
    ) -> anyhow::Result<Report> {
        let mut checks = Checks::new(self.purpose.purpose())
            .select(selection)
            .redact(!self.unredacted)
            .long(self.long)
            .ping(ping);
        if let Some(IpAddr::V4(robot)) = robot {
            checks = checks.robot(robot);
        }
        if self.quick {
            checks = checks.timing(false);
        }
        let bar = progress_bar();
        let told = bar.clone();
        let run = move || {
            checks.run(&System::default(), &mut |what, part| {
                told.set_position((part * 1000.0) as u64);
                told.set_message(what.to_owned());
            })
        };
        let report = tokio::task::spawn_blocking(run).await?;
        bar.finish_and_clear();
        Ok(report)
    }

    /// Runs the driver's control loop in this process with a simulated robot.
    async fn dry_run(&self) -> Option<Finding> {
        let (begin, length) = (Instant::now(), self.length());
        let sent = Arc::new(Mutex::new(Vec::with_capacity(1 << 17)));
        let run = bench::dry_run(punctual(sent.clone()), length);
        let ran = shown("timing.dry_run", length, run).await;
        match ran {
            Ok(ran) => {
                let since = |times: &[(u64, Instant)]| -> Vec<Received> {
                    let times = times.iter();
                    let since = times.map(|(id, at)| (*id, at.saturating_duration_since(begin)));
                    since.collect()
                };
                let sent = since(&sent.lock().unwrap_or_else(PoisonError::into_inner));
                let run = DryRun {
                    priority: ran.granted.priority,
                    ended: ran.outcome.err().map(|error| error.to_string()),
                    ..DryRun::new(&sent, &since(&ran.left))
                };
                Some(dry_run(&run, self.purpose.purpose()))
            }
            // The report contains the results of the other checks.
            Err(error) => {
                say(&format!(
                    "the dry run of the control loop failed to start: {error:#}"
                ));
                None
            }
        }
    }

    /// Returns the findings about the robot's address and its states. The flag is true if another
    /// client is connected to the robot.
    async fn robot(
        &self,
        place: &Place,
        address: SocketAddr,
    ) -> anyhow::Result<(Vec<Finding>, bool)> {
        let mut found = Vec::new();
        let purpose = self.purpose.purpose();
        // The program asks Desk before it connects, because Desk knows why the robot may refuse the
        // connection.
        #[cfg(feature = "desk")]
        found.extend(self.desk(address).await?);
        let connected = place
            .attempt(Some(Realtime::Ignore), |builder| {
                builder.accept_geometry_error(true)
            })
            .await;
        let (answered, states_arrive, state) = match connected {
            Ok(robot) => {
                let answered = vec![Answer::Accepted(robot.version())];
                let state = robot.state();
                let states = received(&robot, self.length());
                let states = shown("robot.lost", self.length(), states).await;
                robot.shutdown().await;
                found.extend(arrivals(&states?, purpose));
                (answered, Some(true), Some(state))
            }
            // The report contains the results of the other checks.
            Err((seen, failure)) => {
                say(&format!("the robot's states were not checked: {failure}"));
                let answered = match seen {
                    Seen::Closed => vec![Answer::Closed],
                    _ => tokio::task::spawn_blocking(move || answers(address)).await?,
                };
                (answered, (seen == Seen::NoState).then_some(false), None)
            }
        };
        found.push(firewall(states_arrive, purpose));
        found.extend(handshake(&answered, purpose));
        let taken = answered.last() == Some(&Answer::Closed);
        let mut has_hand = false;
        if address.port() == ROBOT && !taken {
            let ports = tokio::task::spawn_blocking(move || ports(address.ip(), purpose)).await?;
            let is_hand = |port: &Finding| port.id == "robot.tcp.hand";
            let hand = ports.iter().find(|port| is_hand(port));
            has_hand = hand.is_some_and(|hand| hand.verdict == Verdict::Good);
            found.extend(ports);
        }
        if let Some(state) = state {
            found.extend(at_rest(&state, has_hand, purpose));
        }
        Ok((found, taken))
    }

    /// Returns the finding about Desk. Uses the given address, or the robot's address with the
    /// usual port.
    #[cfg(feature = "desk")]
    async fn desk(&self, robot: SocketAddr) -> anyhow::Result<Option<Finding>> {
        let desk = match &self.desk {
            Some(desk) => resolve(desk, DESK).await?,
            None if robot.port() == ROBOT => SocketAddr::new(robot.ip(), DESK),
            None => return Ok(None),
        };
        let asked = tokio::task::spawn_blocking(move || ask_desk(desk)).await?;
        Ok(Some(web(&asked, self.purpose.purpose())))
    }
}

/// Returns a simulated robot that sends its states as punctually as this computer can. It ends a
/// motion if too many commands are late. `sent` receives the time of each state.
fn punctual(sent: Arc<Mutex<Vec<(u64, Instant)>>>) -> Sim {
    // This code runs on the robot's thread. If the system refuses the request, the thread keeps its
    // scheduling.
    let mut scheduling = Some(Scheduling {
        realtime: franka_async::Realtime::Ignore,
        prefault_stack: 0,
        ..Scheduling::default()
    });
    Sim::fr3().after_each_state(move |robot| {
        let now = Instant::now();
        if let Some(scheduling) = scheduling.take() {
            let _ = scheduling.enter();
        }
        let mut sent = sent.lock().unwrap_or_else(PoisonError::into_inner);
        sent.push((robot.state().message_id, now));
    })
}

/// Returns the states that arrive within `length`.
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

/// Ids of the checks that contact the robot or Desk.
const ROBOT_CHECKS: [&str; 13] = [
    "net.firewall",
    "robot.busy",
    "robot.errors",
    "robot.interval",
    "robot.load",
    "robot.lost",
    "robot.mode",
    "robot.ping",
    "robot.tcp",
    "robot.tcp.hand",
    "robot.tcp.vacuum",
    "robot.version",
    "robot.web",
];

/// Port of the robot.
const ROBOT: u16 = 1337;

/// Port of Desk.
#[cfg(feature = "desk")]
const DESK: u16 = 443;
