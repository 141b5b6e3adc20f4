//! `franka sim`: the simulator.

use std::io;

use franka_sim::command_line::Arguments;

use crate::ending::{Ending, Failure};
use crate::output::line;

pub(super) const EXAMPLES: &str = "\
Examples:
  franka sim                              a Franka Research 3 with a Hand's server, on 1337 and 1338
  franka sim --robot fer --hand           a Panda with its Hand
  franka sim --arm bad --arm-seed 3       an arm that sticks, flexes and lags more than most
  franka sim --robot fer --network fer-stalls
                                          a Panda that sends its states as late as a Panda does
  franka sim --wait-for-commands          for a busy computer
  franka sim --port 0                     on free ports, which it prints";

/// Simulates until Ctrl-C.
pub(super) async fn run(arguments: &Arguments) -> anyhow::Result<Ending> {
    let ready = |lines: &str| line(lines).map_err(io::Error::other);
    let outcome = arguments.run(ready).await;
    outcome.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
    Ok(Ending::Done)
}
