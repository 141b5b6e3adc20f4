//! `franka robots`: manages the names of robots.

use clap::Subcommand;
use franka_async::connection::Endpoint;
use serde_json::json;

use crate::ending::{Ending, Failure};
use crate::output::{Output, line};
use crate::robots_file::{Entry, Realtime, RobotsFile, check_name};

/// Manage the names of robots
#[derive(Debug, Subcommand)]
pub(crate) enum Robots {
    /// List the robots with names
    #[command(after_help = "Example: franka robots list")]
    List(Output),
    /// Add a robot, or change its settings
    #[command(after_help = "Example: franka robots add left 172.16.0.2")]
    Add {
        /// Name: letters, digits, `-` and `_`
        name: String,
        /// Address of the robot
        address: Endpoint,
        /// Real-time scheduling for motions [default: enforce]
        #[arg(long, value_enum)]
        realtime: Option<Realtime>,
        /// Address of the Hand [default: the robot's]
        #[arg(long, value_name = "ADDRESS")]
        hand: Option<Endpoint>,
    },
    /// Remove a robot
    #[command(after_help = "Example: franka robots remove left")]
    Remove {
        /// Name of the robot
        name: String,
    },
}

impl Robots {
    pub(super) fn run(self) -> anyhow::Result<Ending> {
        let mut file = RobotsFile::read()?;
        match self {
            Self::List(output) => output.print(&json!({ "robots": file.robots }), || {
                if file.robots.is_empty() {
                    let path = file.path.display();
                    return format!("{path} has no robots yet: franka robots add NAME ADDRESS");
                }
                let width = file.robots.keys().map(String::len).max().unwrap_or(0);
                let robots = file.robots.iter().map(|(name, entry)| {
                    let realtime = match entry.realtime {
                        Some(Realtime::Ignore) => "  without real-time scheduling",
                        _ => "",
                    };
                    let hand = entry.hand.as_ref().map(|hand| format!("  Hand at {hand}"));
                    let hand = hand.unwrap_or_default();
                    format!("{name:width$}  {}{hand}{realtime}\n", entry.address)
                });
                robots.collect()
            }),
            Self::Add {
                name,
                address,
                realtime,
                hand,
            } => {
                check_name(&name).map_err(Failure::usage)?;
                let entry = Entry {
                    address: address.to_string(),
                    realtime,
                    hand: hand.map(|hand| hand.to_string()),
                };
                file.insert(&name, &entry);
                file.write()?;
                line(&format!("{name} is saved in {}", file.path.display()))?;
                Ok(Ending::Done)
            }
            Self::Remove { name } => {
                if !file.remove(&name) {
                    let message = format!("{} has no robot `{name}`", file.path.display());
                    return Err(Failure::usage(message).into());
                }
                file.write()?;
                line(&format!("{name} is removed from {}", file.path.display()))?;
                Ok(Ending::Done)
            }
        }
    }
}
