//! `franka tap`: what passes between clients and a robot, byte for byte.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;

use clap::Args;
use franka_async::cassette::{Device, Route, Tap as Recording};
use serde_json::json;

use crate::connection::{Which, resolve};
use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::output::{Output, say};

/// Record what passes between clients and a robot, byte for byte
///
/// Until Ctrl-C. Clients connect to this computer instead of the robot. For looking closely:
/// commands reach the robot a little later.
#[derive(Debug, Args)]
pub(crate) struct Tap {
    /// The new file
    #[arg(value_name = "FILE.mcap")]
    file: PathBuf,
    #[command(flatten)]
    which: Which,
    /// Where clients connect to
    #[arg(long, value_name = "IP", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    listen: IpAddr,
    /// Port for clients of the robot; those of the Hand and the vacuum gripper follow. 0 takes free
    /// ones
    #[arg(long, default_value_t = 1337)]
    port: u16,
    #[command(flatten)]
    output: Output,
}

impl Tap {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let place = self.which.place()?;
        let hand = match place.is_listed() {
            true => place.hand.clone(),
            false => place.address.clone().at_port(Device::Hand.port()),
        };
        let vacuum = place.address.clone().at_port(Device::VacuumGripper.port());
        let mut routes = Vec::new();
        let devices = [
            (Device::Robot, place.address.clone()),
            (Device::Hand, hand),
            (Device::VacuumGripper, vacuum),
        ];
        for (i, (device, endpoint)) in devices.into_iter().enumerate() {
            let port = match self.port {
                0 => 0,
                port => port.checked_add(i as u16).unwrap_or(0),
            };
            routes.push(Route {
                device,
                listen: (self.listen, port).into(),
                robot: resolve(&endpoint, device.port()).await?,
            });
        }
        let interrupt = interrupted()?;
        let tap = Recording::start(&routes, &self.file);
        let tap = tap.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
        for route in &routes {
            if let Some(address) = tap.address(route.device) {
                say(&format!(
                    "{} at {address}, for {}",
                    route.device, route.robot
                ));
            }
        }
        say("Ctrl-C ends");
        interrupt.await;
        let report = tokio::task::spawn_blocking(|| tap.finish()).await?;
        let report = report.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
        let value = json!({
            "connections": report.connections,
            "events": report.events,
            "dropped": report.dropped,
        });
        self.output.print(&value, || {
            format!(
                "{} connections, {} events in {}, {} dropped",
                report.connections,
                report.events,
                self.file.display(),
                report.dropped
            )
        })
    }
}
