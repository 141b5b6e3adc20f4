//! Counts and measurements of connections as [OpenMetrics] text, for Prometheus and other readers
//! of that format.
//!
//! [`Robot::metrics`] returns the text of one robot. [`Exporter`] returns the text of several
//! robots, or acts as a collector in the program's own registry. Both read their data when called:
//! the counters of the control thread ([`Robot::stats`]), the newest state, [`Robot::health`],
//! [`Robot::granted`], and how motions ended. This costs the control thread no work. The counts of
//! the thread begin anew with each connection of a supervised robot.
//!
//! | metric | type | labels besides `robot` |
//! |---|---|---|
//! | `franka_build_info` | info | `version`; without `robot` |
//! | `franka_connected` | gauge, 0 or 1 | |
//! | `franka_ready` | gauge, 1 if the robot accepts motions | |
//! | `franka_robot_mode` | gauge, 1 for the mode of the newest state | `mode` |
//! | `franka_error_active` | gauge, 1 for each error of the newest state | `error` |
//! | `franka_success_ratio` | gauge, the robot's `control_command_success_rate` | |
//! | `franka_rt_granted` | gauge, 0 or 1 | `what`: `fifo`, `busy_poll` |
//! | `franka_motions_total` | counter, motions that have ended, and goals of sessions that have ended | `outcome` |
//! | `franka_reflexes_total` | counter, reflexes by error; a reflex with several errors counts once for each error | `reason` |
//! | `franka_recoveries_total`, `franka_reconnects_total` | counter, recoveries and reconnects by the supervisor | |
//! | `franka_recovery_seconds`, `franka_reconnect_seconds` | gauge, duration of the newest recovery or reconnect; no sample before the first one | |
//! | `franka_cycles_total` | counter, states that the control thread processed | |
//! | `franka_commands_total`, `franka_commands_late_total` | counter, commands; late ones were sent after the next state was due | |
//! | `franka_states_lost_total`, `franka_states_skipped_total`, `franka_states_stale_total` | counter | |
//! | `franka_datagrams_refused_total` | counter | `reason`: `foreign`, `malformed` |
//! | `franka_socket_errors_total` | counter | `call`: `receive`, `send` |
//! | `franka_state_interval_seconds`, `franka_cycle_turnaround_seconds` | histogram | |
//! | `franka_cycle_slack_seconds` | gauge, the shortest time so far from a command until the next state was due; negative if a command was late | |
//!
//! The control thread's own histograms have finer buckets with other bounds. Therefore a bucket
//! here counts all durations up to 15/16 of its bound, some of the durations up to the bound, and
//! none above it. The sum is computed from the middles of the thread's buckets, and is accurate to
//! 1/32.
//!
//! [OpenMetrics]: https://prometheus.io/docs/specs/om/open_metrics_spec/

mod buckets;
mod families;

use std::fmt;

use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, text};
use prometheus_client::registry::Registry;

use crate::robot::Robot;
use families::{Families, Scrape};

/// The library whose registry accepts an [`Exporter`].
pub use prometheus_client;

/// The content type of the text, for the HTTP response to a scrape.
pub const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

impl Robot {
    /// Returns the metrics of this robot as OpenMetrics text. The label `robot` contains its
    /// address. See [`metrics`](crate::metrics). The content type is
    /// [`CONTENT_TYPE`](crate::metrics::CONTENT_TYPE).
    pub fn metrics(&self) -> String {
        Exporter::new([(self.address().to_string(), self.clone())]).text()
    }
}

/// The metrics of one or more robots. An exporter holds a handle of each robot. If it holds the
/// last handle, the connection ends when the exporter is dropped, or when [`Robot::shutdown`] is
/// called.
#[derive(Clone, Debug)]
pub struct Exporter {
    robots: Vec<(String, Robot)>,
}

impl Exporter {
    /// Returns the metrics of these robots. Each robot comes with its value of the label `robot`.
    /// The values must be distinct, and should be the same in every run of the program.
    pub fn new<L: Into<String>>(robots: impl IntoIterator<Item = (L, Robot)>) -> Self {
        let robots = robots.into_iter();
        Self {
            robots: robots.map(|(label, robot)| (label.into(), robot)).collect(),
        }
    }

    /// Returns the text, which ends with `# EOF`.
    pub fn text(&self) -> String {
        let mut registry = Registry::default();
        registry.register_collector(Box::new(self.clone()));
        let mut text = String::new();
        text::encode(&mut text, &registry).expect("writing to a string does not fail");
        text
    }
}

impl Collector for Exporter {
    fn encode(&self, encoder: DescriptorEncoder<'_>) -> fmt::Result {
        let robots = self.robots.iter();
        let scrapes = robots.map(|(label, robot)| Scrape::new(label, robot));
        Families::new(encoder, scrapes).encode()
    }
}
