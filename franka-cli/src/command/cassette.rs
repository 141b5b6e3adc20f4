//! `franka cassette`: summarises, plays and converts recordings of a tap.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Context as _;
use clap::Subcommand;
use franka_async::cassette::{
    Cassette as Tape, CassetteServer, Device, Matching, Payload, PlayOptions, pcap,
};
use serde_json::json;

use super::tap::{Listening, failed};
use crate::ending::{Ending, Failure};
use crate::output::{Output, say};
use crate::values::seconds;

/// Play or convert the cassette of `franka tap`
#[derive(Debug, Subcommand)]
pub(crate) enum Cassette {
    /// Summarise a cassette
    #[command(after_help = "Example: franka cassette info wire.mcap")]
    Info {
        /// The cassette
        file: PathBuf,
        #[command(flatten)]
        output: Output,
    },
    /// Serve as the recorded robot until the session has been played
    #[command(after_help = "Example: franka cassette play wire.mcap --port 1337")]
    Play {
        /// The cassette
        file: PathBuf,
        #[command(flatten)]
        listening: Listening,
        /// Accept only the recorded bytes
        #[arg(long)]
        strict: bool,
        /// Time limit for the whole session
        #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "600")]
        patience: Duration,
        #[command(flatten)]
        output: Output,
    },
    /// Convert a cassette to a capture for Wireshark, or a capture (pcap, pcapng) to a cassette
    #[command(after_help = "Example: franka cassette convert wire.mcap wire.pcap")]
    Convert {
        /// File to convert; a cassette ends in .mcap
        from: PathBuf,
        /// New file
        to: PathBuf,
    },
}

impl Cassette {
    pub(super) fn run(self) -> anyhow::Result<Ending> {
        match self {
            Self::Info { file, output } => info(&open(&file)?, output),
            Self::Play {
                file,
                listening,
                strict,
                patience,
                output,
            } => {
                let mut options = PlayOptions::default();
                if !strict {
                    options.matching = Matching::Lenient;
                }
                let tape = open(&file)?;
                if tape.connections.is_empty() {
                    let message = format!("{} has no connections", file.display());
                    return Err(Failure::new(Ending::Failed, message).into());
                }
                let at = |device| listening.at(device);
                let server = CassetteServer::start_at(tape, at, options);
                let server =
                    server.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
                for device in Device::ALL {
                    if let Some(address) = server.address(device) {
                        say(&format!("{device} at {address}"));
                    }
                }
                let report = server.finish(patience);
                let report =
                    report.map_err(|error| Failure::new(Ending::Failed, error.to_string()))?;
                let lines = report
                    .played
                    .iter()
                    .map(|(device, tally)| format!("{device}: {tally}"));
                let lines: Vec<String> = lines.collect();
                output.print(&json!({ "played": lines }), || lines.join("\n"))
            }
            Self::Convert { from, to } => {
                let bytes = if from
                    .extension()
                    .is_some_and(|extension| extension == "mcap")
                {
                    pcap::to_capture(&open(&from)?)
                } else {
                    let capture = std::fs::read(&from);
                    let capture = capture.with_context(|| format!("reading {}", from.display()))?;
                    let tape = pcap::from_capture(&capture)?;
                    if tape.truncated > 0 {
                        say(&format!(
                            "{} packets of {} were captured only in part, so their data is \
                             missing: capture whole packets (tcpdump -s 0)",
                            tape.truncated,
                            from.display()
                        ));
                    }
                    tape.to_bytes()?
                };
                let written = File::create_new(&to).and_then(|mut file| file.write_all(&bytes));
                written.with_context(|| format!("writing {}", to.display()))?;
                Ok(Ending::Done)
            }
        }
    }
}

fn open(file: &Path) -> anyhow::Result<Tape> {
    let tape = Tape::open(file);
    let tape = tape.map_err(|error| {
        failed(file, &error)
            .advice("Cassettes come from franka tap. For recordings, use franka explain.")
    })?;
    if let Some(damage) = &tape.damage {
        say(&format!("{} ends early: {damage}", file.display()));
    }
    Ok(tape)
}

fn info(tape: &Tape, output: Output) -> anyhow::Result<Ending> {
    let mut connections = Vec::new();
    let mut lines = Vec::new();
    for connection in &tape.connections {
        let is_datagram = |what: &Payload| matches!(what, Payload::Datagram(_));
        let datagrams = connection
            .events
            .iter()
            .filter(|event| is_datagram(&event.what));
        let datagrams = datagrams.count();
        let last = connection.events.last().map(|event| event.at);
        let seconds = last.unwrap_or_default().as_secs_f64();
        lines.push(format!(
            "{}: {} events, {datagrams} of them datagrams, until {seconds:.3} s",
            connection.device,
            connection.events.len()
        ));
        connections.push(json!({
            "device": connection.device.to_string(),
            "events": connection.events.len(),
            "datagrams": datagrams,
            "until": seconds,
        }));
    }
    let value = json!({
        "connections": connections,
        "dropped": tape.dropped,
        "damage": tape.damage,
    });
    output.print(&value, || {
        let count = lines.len();
        lines.push(format!("{count} connections, {} dropped", tape.dropped));
        lines.join("\n")
    })
}
