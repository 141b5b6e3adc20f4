//! `franka sim`: runs the simulator.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use clap::Args;
use franka_async::connection::admission::Token;
use franka_dash::Options;
use franka_sim::Running;
use franka_sim::command_line::Arguments;

use super::dash::{PAGE, listen, no_token};
use crate::ending::{Ending, Failure};
use crate::output::line;

pub(super) const EXAMPLES: &str = "\
Examples:
  franka sim                              a Franka Research 3 with a Hand's server, on 1337 and 1338
  franka sim --robot fer --hand           a Panda with its Hand
  franka sim --arm bad --arm-seed 3       an arm with more friction, flexibility and delay than most
  franka sim --robot fer --network fer-stalls
                                          a Panda with the delays of a real one
  franka sim --wait-for-commands          waits for each command, for a busy computer
  franka sim --port 0                     on free ports, which are printed
  franka sim --dash                       with a page that shows and pushes it";

/// The simulator, with or without the dashboard.
#[derive(Debug, Args)]
pub(crate) struct Sim {
    #[command(flatten)]
    arguments: Arguments,
    /// Serve a page that shows, pushes and disturbs the robot, at this address [default:
    /// 127.0.0.1:8080]. If other computers can reach it, FRANKA_ACCESS_TOKEN is required
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1)]
    dash: Option<Option<SocketAddr>>,
}

impl Sim {
    /// Runs the simulator until Ctrl-C.
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let mut options = Options::default();
        if self.dash.is_some()
            && let Some(token) = Token::configured(None).map_err(no_token)?
        {
            options = options.token(token);
        }
        let page = match self.dash {
            Some(address) => Some(listen(address.unwrap_or(PAGE), &options).await?),
            None => None,
        };
        let ready = async |sim: &Arc<Running>, lines: &str| {
            line(lines).map_err(io::Error::other)?;
            let Some(page) = page else {
                return Ok(());
            };
            line(&format!("dashboard on http://{}/", page.local_addr()?))
                .map_err(io::Error::other)?;
            let router = franka_dash::simulator(sim, options).await;
            let router = router.map_err(io::Error::other)?;
            let router = router.into_make_service_with_connect_info::<SocketAddr>();
            tokio::spawn(axum::serve(page, router).into_future());
            Ok(())
        };
        let outcome = self.arguments.run(ready).await;
        outcome.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
        Ok(Ending::Done)
    }
}
