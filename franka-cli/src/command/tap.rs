//! `franka tap`: records the traffic between clients and a robot.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

use clap::{Args, value_parser};
use franka_async::cassette::{CassetteError, Device, Route, Tap as Recording};
use serde_json::json;

use crate::connection::{Which, resolve};
use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::output::{Output, say};

/// Record the traffic between clients and a robot, byte for byte
///
/// Runs until Ctrl-C. Clients connect to this computer instead of the robot; each connection is
/// passed on. For debugging only: adds latency to every command.
#[derive(Debug, Args)]
pub(crate) struct Tap {
    /// New file
    #[arg(value_name = "FILE.mcap")]
    file: PathBuf,
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    listening: Listening,
    #[command(flatten)]
    output: Output,
}

/// Addresses at which clients connect to the tap.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Listening {
    /// Address for clients
    #[arg(long, value_name = "IP", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    listen: IpAddr,
    /// Port for clients of the robot; the Hand and the vacuum gripper use the next two. 0 picks
    /// free ports
    #[arg(long, default_value_t = 1337, value_parser = value_parser!(u16).range(..=65533))]
    port: u16,
}

impl Listening {
    /// Returns the address at which clients connect to a device.
    pub(super) fn at(self, device: Device) -> SocketAddr {
        let port = match self.port {
            0 => 0,
            port => port + (device.port() - Device::Robot.port()),
        };
        (self.listen, port).into()
    }
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
        for (device, endpoint) in devices {
            routes.push(Route {
                device,
                listen: self.listening.at(device),
                robot: resolve(&endpoint, device.port()).await?,
            });
        }
        let interrupt = interrupted()?;
        let tap = Recording::start(&routes, &self.file);
        let tap = tap.map_err(|error| failed(&self.file, &error))?;
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
        let report = report.map_err(|error| failed(&self.file, &error))?;
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

pub(super) fn failed(file: &Path, error: &CassetteError) -> Failure {
    Failure::new(Ending::Host, format!("{}: {error}", file.display()))
}
