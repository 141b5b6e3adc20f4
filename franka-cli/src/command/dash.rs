//! `franka dash`: shows the dashboard of robots in the browser.

use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4};
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use franka_async::connection::admission::{Token, TokenError};
use franka_dash::{BindError, Options};
use tokio::net::TcpListener;
use tokio::task::JoinSet;

use crate::connection::{Place, Which};
use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::output::{line, say};
use crate::robots_file::Realtime;

/// Show robots in the browser; with --allow-motion, move them while a button is held
///
/// Runs until Ctrl-C. Each robot has a page, and an overview shows all of them. A browser page is
/// neither an emergency stop nor an enabling device.
#[derive(Debug, Args)]
pub(crate) struct Dash {
    /// Names or addresses of the robots [default: FRANKA_ROBOT, or the only robot with a name]
    #[arg(value_name = "ROBOT")]
    robots: Vec<String>,
    /// Address to listen on. A token is required if other computers can reach it
    #[arg(long, value_name = "ADDRESS:PORT", default_value_t = PAGE)]
    listen: SocketAddr,
    /// Allow the viewer in command to move the arm and recover the robot
    #[arg(long)]
    allow_motion: bool,
    /// Real-time scheduling of the control thread, with --allow-motion [default: the robot's
    /// setting, or enforce]
    #[arg(long, value_enum)]
    realtime: Option<Realtime>,
    /// With --allow-motion, also move robots whose reported pose does not fit their model
    #[arg(long)]
    accept_geometry_error: bool,
    /// Show the Franka Hand too and, with --allow-motion, move its fingers. No other program can
    /// use the Hand in the meantime
    #[arg(long)]
    gripper: bool,
    /// Allow the viewer in command to record to new files in this folder
    #[arg(long, value_name = "FOLDER")]
    record: Option<PathBuf>,
    #[command(flatten)]
    access: Access,
}

/// The token with which other computers can open a page.
#[derive(Debug, Args)]
#[group(multiple = false)]
struct Access {
    /// Require the token in this file: pages open as http://ADDRESS:PORT/#TOKEN [default:
    /// FRANKA_ACCESS_TOKEN, if it is set]
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    /// Generate a random token, require it, and print the addresses with it
    #[arg(long)]
    new_token: bool,
}

impl Access {
    fn token(&self) -> Result<Option<Token>, Failure> {
        match self.new_token {
            true => Token::generate().map(Some),
            false => Token::configured(self.token_file.as_deref()),
        }
        .map_err(no_token)
    }

    /// Returns the fragment of the printed addresses. The fragment omits a token that the user
    /// provided.
    fn fragment(&self, token: Option<&Token>) -> String {
        match token {
            Some(token) if self.new_token => format!("#{}", token.reveal()),
            _ => String::new(),
        }
    }
}

impl Dash {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let mut options = Options::default();
        if self.allow_motion {
            options = options.allow_motion();
        }
        let token = self.access.token()?;
        let fragment = self.access.fragment(token.as_ref());
        if let Some(token) = token {
            options = options.token(token);
        }
        if let Some(folder) = &self.record {
            if !folder.is_dir() {
                let text = format!(
                    "{}: not a folder; --record needs an existing folder",
                    folder.display()
                );
                return Err(Failure::usage(text).into());
            }
            options = options.record_to(folder);
        }
        let recordings_ended = options.recordings_ended();
        let listener = listen(self.listen, &options).await?;
        let address = listener.local_addr().context("the address of the page")?;
        let interrupt = interrupted()?;
        let named = match self.robots.is_empty() {
            true => vec![None],
            false => self.robots.iter().cloned().map(Some).collect(),
        };
        // A page that only shows the robot needs no real-time scheduling.
        let realtime = match self.allow_motion {
            true => self.realtime,
            false => Some(Realtime::Ignore),
        };
        let accepts = self.accept_geometry_error || !self.allow_motion;
        let mut places = Vec::new();
        for robot in named {
            let place = Which::of(robot).place()?;
            let is_same = |other: &Place| other.name() == place.name();
            if places.iter().any(is_same) {
                return Err(Failure::usage(format!(
                    "got {} twice, expected different robots",
                    place.name()
                ))
                .into());
            }
            places.push(place);
        }
        let mut robots = Vec::new();
        for place in places {
            // Events need the last second of cycles for their explanation.
            let robot = place.connect(realtime, |builder| {
                builder.log_size(1000).accept_geometry_error(accepts)
            });
            let robot = robot.await?;
            let options = match self.gripper {
                true => options.clone().gripper(place.connect_hand().await?),
                false => options.clone(),
            };
            robots.push((place, robot, options));
        }
        let page = match &robots[..] {
            [(place, robot, options)] => {
                line(&format!("{place}: http://{address}/{fragment}"))?;
                franka_dash::router(robot.clone(), options.clone())
            }
            several => {
                line(&format!("http://{address}/{fragment}"))?;
                let each = several
                    .iter()
                    .map(|(place, robot, options)| (place.name(), robot.clone(), options.clone()));
                let page = franka_dash::several(each).map_err(|error| {
                    Failure::usage(error.to_string())
                        .advice("Give the robot a name: franka robots add NAME ADDRESS")
                })?;
                for (place, ..) in several {
                    let name = place.name();
                    line(&format!("{place}: http://{address}/{name}/{fragment}"))?;
                }
                page
            }
        };
        let page = page.into_make_service_with_connect_info::<SocketAddr>();
        let mut closed = JoinSet::new();
        for (place, robot, _) in &robots {
            let (place, robot) = (place.to_string(), robot.clone());
            closed.spawn(async move { (place, robot.closed().await) });
        }
        // If one robot is lost, the pages of the other robots and their Stop buttons still work.
        let all_closed = async {
            let mut last = String::new();
            while let Some(Ok((place, reason))) = closed.join_next().await {
                last = format!("the connection to {place} has ended: {reason}");
                if !closed.is_empty() {
                    say(&format!("{last}; the others continue"));
                }
            }
            Failure::new(Ending::NoRobot, last)
        };
        let ended = tokio::select! {
            _ = interrupt => Ok(Ending::Done),
            failure = all_closed => Err(failure.into()),
            served = axum::serve(listener, page).into_future() => {
                served.map(|()| Ending::Done).map_err(Into::into)
            }
        };
        for (_, robot, _) in &robots {
            robot.shutdown().await;
        }
        recordings_ended.await;
        ended
    }
}

pub(super) async fn listen(address: SocketAddr, options: &Options) -> Result<TcpListener, Failure> {
    let bound = franka_dash::bind(address, options).await;
    bound.map_err(|error| match &error {
        BindError::NoToken { .. } => Failure::usage(error.to_string()).advice(ADVICE),
        _ => Failure::new(Ending::Host, format!("{:#}", anyhow::Error::new(error))),
    })
}

pub(super) fn no_token(error: TokenError) -> Failure {
    let text = format!("{:#}", anyhow::Error::new(error));
    Failure::usage(text).advice(ADVICE)
}

const ADVICE: &str = "Set a token: in the variable FRANKA_ACCESS_TOKEN, with --token-file FILE, \
    or with --new-token, which generates one.";

pub(super) const PAGE: SocketAddr = SocketAddr::V4(SocketAddrV4::new(Ipv4Addr::LOCALHOST, 8080));
