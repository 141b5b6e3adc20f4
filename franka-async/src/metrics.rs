//! What connections have counted and measured, as [OpenMetrics] text: for Prometheus and whatever
//! else reads its format.
//!
//! [`Robot::metrics`] is one robot's text. [`Exporter`] is that of several, or a collector for a
//! registry of the program's own. Both read the counters that the control thread keeps anyway
//! ([`Robot::stats`]), the newest state and [`Robot::granted`], when they are called: nothing is
//! counted for them, and the thread does not notice. Counts begin anew with each connection.
//!
//! | metric | type | labels beside `robot` |
//! |---|---|---|
//! | `franka_build_info` | info | `version`; without `robot` |
//! | `franka_connected` | gauge, 0 or 1 | |
//! | `franka_robot_mode` | gauge, 1 for the mode of the newest state | `mode` |
//! | `franka_error_active` | gauge, 1 for each error of the newest state | `error` |
//! | `franka_success_ratio` | gauge, the robot's `control_command_success_rate` | |
//! | `franka_rt_granted` | gauge, 0 or 1 | `what`: `fifo`, `busy_poll` |
//! | `franka_cycles_total` | counter, states that the control thread took up | |
//! | `franka_commands_total`, `franka_commands_late_total` | counter; late: after the next state was due | |
//! | `franka_states_lost_total`, `franka_states_skipped_total`, `franka_states_stale_total` | counter | |
//! | `franka_datagrams_refused_total` | counter | `reason`: `foreign`, `malformed` |
//! | `franka_socket_errors_total` | counter | `call`: `receive`, `send` |
//! | `franka_state_interval_seconds`, `franka_cycle_turnaround_seconds` | histogram | |
//! | `franka_cycle_slack_seconds` | gauge, the least so far; negative for an overrun | |
//!
//! The thread's buckets are finer than these histograms' and do not end where theirs do: a bucket
//! counts all durations up to 15/16 of its bound, some of those up to the bound, and none above.
//! The sum is that of the middles of the thread's buckets, within 1/32.
//!
//! [OpenMetrics]: https://prometheus.io/docs/specs/om/open_metrics_spec/

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use franka_proto::{RobotError, RobotMode, RobotState};
use franka_rt::stats::{Histogram, Stats};
use futures::FutureExt;
use prometheus_client::collector::Collector;
use prometheus_client::encoding::{
    DescriptorEncoder, EncodeGaugeValue, EncodeLabelSet, MetricEncoder, NoLabelSet, text,
};
use prometheus_client::metrics::MetricType;
use prometheus_client::registry::{Registry, Unit};

use crate::robot::Robot;

/// The library that [`Exporter`] is a collector of.
pub use prometheus_client;

/// The content type of the text, for the answer to a scrape.
pub const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

impl Robot {
    /// The metrics of this connection as OpenMetrics text; the label `robot` is its address. See
    /// [`metrics`](crate::metrics). The content type is
    /// [`CONTENT_TYPE`](crate::metrics::CONTENT_TYPE).
    pub fn metrics(&self) -> String {
        Exporter::new([(self.address().to_string(), self.clone())]).text()
    }
}

/// The metrics of some robots. It holds a handle of each: a connection ends with the exporter, or
/// by [`Robot::shutdown`], if no other handle is left.
#[derive(Clone, Debug)]
pub struct Exporter {
    robots: Vec<(String, Robot)>,
}

impl Exporter {
    /// Metrics of these robots, each with its value of the label `robot`: no two the same, and the
    /// same whenever the program runs.
    pub fn new<L: Into<String>>(robots: impl IntoIterator<Item = (L, Robot)>) -> Self {
        let robots = robots.into_iter();
        Self {
            robots: robots.map(|(label, robot)| (label.into(), robot)).collect(),
        }
    }

    /// The text, which ends with `# EOF`.
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
        let scrapes = self.robots.iter().map(|(label, robot)| Scrape {
            label,
            robot,
            state: robot.state(),
            stats: robot.stats(),
        });
        Families {
            encoder,
            scrapes: scrapes.collect(),
        }
        .encode()
    }
}

/// One robot at one moment.
struct Scrape<'a> {
    label: &'a str,
    robot: &'a Robot,
    state: RobotState,
    stats: Arc<Stats>,
}

/// The metric families, each with its samples of every robot: a family must not come twice.
struct Families<'a, 'e> {
    encoder: DescriptorEncoder<'e>,
    scrapes: Vec<Scrape<'a>>,
}

impl Families<'_, '_> {
    fn encode(mut self) -> fmt::Result {
        let version = [("version", env!("CARGO_PKG_VERSION"))];
        self.encoder
            .encode_descriptor("franka_build", "The driver.", None, MetricType::Info)?
            .encode_info(&version)?;
        self.gauges(
            "franka_connected",
            "Whether the connection stands.",
            |scrape| {
                let connected = scrape.robot.closed().now_or_never().is_none();
                [(ALONE, i64::from(connected))]
            },
        )?;
        self.gauges("franka_robot_mode", "The mode of the robot.", |scrape| {
            RobotMode::ALL.map(|mode| {
                let name = mode.to_string().to_lowercase().replace(' ', "_");
                ([("mode", name)], i64::from(mode == scrape.state.robot_mode))
            })
        })?;
        self.gauges("franka_error_active", "Errors that hold.", |scrape| {
            RobotError::ALL.map(|error| {
                let holds = scrape.state.errors.contains(error);
                ([("error", error.name())], i64::from(holds))
            })
        })?;
        let help = "Commands that the robot received in time, of the last hundred.";
        self.gauges("franka_success_ratio", help, |scrape| {
            [(ALONE, scrape.state.control_command_success_rate)]
        })?;
        let help = "What the operating system granted the control thread.";
        self.gauges("franka_rt_granted", help, |scrape| {
            let granted = scrape.robot.granted();
            [
                ([("what", "fifo")], i64::from(granted.priority.is_some())),
                (
                    [("what", "busy_poll")],
                    i64::from(granted.busy_poll.is_some()),
                ),
            ]
        })?;
        for (name, help, count) in COUNTERS {
            self.counters(name, help, |stats| [(ALONE, count(stats))])?;
        }
        let help = "Datagrams that were no states of the robot.";
        self.counters("franka_datagrams_refused", help, |stats| {
            [
                ([("reason", "foreign")], stats.foreign.get()),
                ([("reason", "malformed")], stats.malformed.get()),
            ]
        })?;
        self.counters(
            "franka_socket_errors",
            "Failed calls of the socket.",
            |stats| {
                [
                    ([("call", "receive")], stats.receive_errors.get()),
                    ([("call", "send")], stats.send_errors.get()),
                ]
            },
        )?;
        let help = "Times between two states in a row.";
        self.histogram("franka_state_interval", help, |stats| &stats.interval)?;
        let help = "Times from the receipt of a state to the departure of its command.";
        self.histogram("franka_cycle_turnaround", help, |stats| &stats.turnaround)?;
        self.least_slack()
    }

    /// A family of gauges: of each robot, some samples with labels beside that of the robot.
    fn gauges<L, V, S>(
        &mut self,
        name: &str,
        help: &str,
        of: impl Fn(&Scrape<'_>) -> S,
    ) -> fmt::Result
    where
        L: EncodeLabelSet,
        V: EncodeGaugeValue,
        S: IntoIterator<Item = (L, V)>,
    {
        let mut family = self
            .encoder
            .encode_descriptor(name, help, None, MetricType::Gauge)?;
        for scrape in &self.scrapes {
            for (labels, value) in of(scrape) {
                labelled(&mut family, scrape, labels, |metric| {
                    metric.encode_gauge(&value)
                })?;
            }
        }
        Ok(())
    }

    /// A family of counters, as [`Self::gauges`].
    fn counters<L, S>(&mut self, name: &str, help: &str, of: impl Fn(&Stats) -> S) -> fmt::Result
    where
        L: EncodeLabelSet,
        S: IntoIterator<Item = (L, u64)>,
    {
        let mut family = self
            .encoder
            .encode_descriptor(name, help, None, MetricType::Counter)?;
        for scrape in &self.scrapes {
            for (labels, count) in of(&scrape.stats) {
                labelled(&mut family, scrape, labels, |metric| {
                    metric.encode_counter::<NoLabelSet, _, u64>(&count, None)
                })?;
            }
        }
        Ok(())
    }

    /// A family with a histogram per robot, in seconds.
    fn histogram(
        &mut self,
        name: &str,
        help: &str,
        of: impl Fn(&Stats) -> &Histogram,
    ) -> fmt::Result {
        let unit = Some(&Unit::Seconds);
        let mut family = self
            .encoder
            .encode_descriptor(name, help, unit, MetricType::Histogram)?;
        for scrape in &self.scrapes {
            let Buckets { counts, sum } = Buckets::of(of(&scrape.stats));
            let count = counts.iter().map(|(_, count)| count).sum();
            labelled(&mut family, scrape, ALONE, |metric| {
                metric.encode_histogram::<NoLabelSet>(sum, count, &counts, None)
            })?;
        }
        Ok(())
    }

    fn least_slack(&mut self) -> fmt::Result {
        let mut family = self.encoder.encode_descriptor(
            "franka_cycle_slack",
            "The least time that was left until the next state was due when a command departed.",
            Some(&Unit::Seconds),
            MetricType::Gauge,
        )?;
        for scrape in &self.scrapes {
            let stats = &scrape.stats;
            let overrun = stats.overrun.max().map(|overrun| -overrun.as_secs_f64());
            let least = overrun.or_else(|| stats.slack.min().map(|slack| slack.as_secs_f64()));
            if let Some(least) = least {
                labelled(&mut family, scrape, ALONE, |metric| {
                    metric.encode_gauge(&least)
                })?;
            }
        }
        Ok(())
    }
}

/// Encodes one sample with the label of its robot and these.
fn labelled(
    family: &mut MetricEncoder<'_>,
    scrape: &Scrape<'_>,
    labels: impl EncodeLabelSet,
    encode: impl FnOnce(&mut MetricEncoder<'_>) -> fmt::Result,
) -> fmt::Result {
    encode(&mut family.encode_family(&([("robot", scrape.label)], labels))?)
}

/// No labels beside that of the robot.
const ALONE: [(&str, &str); 0] = [];

/// A name without `_total`, the text of help, and where the count is.
type CounterOf = (&'static str, &'static str, fn(&Stats) -> u64);

const COUNTERS: [CounterOf; 6] = [
    (
        "franka_cycles",
        "States that the control thread took up.",
        |stats| stats.states.get(),
    ),
    ("franka_commands", "Commands sent.", |stats| {
        stats.commands.get()
    }),
    (
        "franka_commands_late",
        "Commands that left after the next state was due.",
        |stats| stats.overrun.count(),
    ),
    (
        "franka_states_lost",
        "States that never arrived.",
        |stats| stats.lost.get(),
    ),
    (
        "franka_states_skipped",
        "States that a newer one had overtaken when the thread looked.",
        |stats| stats.skipped.get(),
    ),
    (
        "franka_states_stale",
        "States that came after a newer one, or twice.",
        |stats| stats.stale.get(),
    ),
];

/// A histogram of the thread in the buckets of the text, in seconds.
#[derive(Debug, PartialEq)]
struct Buckets {
    /// The bound of each bucket, and how many durations lie between it and the one before.
    counts: Vec<(f64, u64)>,
    sum: f64,
}

impl Buckets {
    fn of(histogram: &Histogram) -> Self {
        Self::regrouped(histogram.buckets())
    }

    fn regrouped(fine: impl Iterator<Item = (Duration, u64)>) -> Self {
        let bounds = BOUNDS.into_iter().chain([f64::INFINITY]);
        let mut counts: Vec<_> = bounds.map(|bound| (bound, 0)).collect();
        let mut sum = 0.0;
        for (longest, count) in fine {
            let longest = longest.as_secs_f64();
            let bucket = counts.partition_point(|(bound, _)| *bound < longest);
            counts[bucket].1 += count;
            sum += count as f64 * longest * MIDDLE;
        }
        Self { counts, sum }
    }
}

/// Upper bounds of the buckets, `[s]`: around the millisecond that a cycle has.
const BOUNDS: [f64; 11] = [
    5e-5, 1e-4, 2e-4, 3e-4, 5e-4, 7.5e-4, 1e-3, 1.25e-3, 2e-3, 5e-3, 1e-2,
];

/// The middle of a bucket of the thread, as a share of its longest duration.
const MIDDLE: f64 = 1.0 - 1.0 / 32.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_duration_is_in_the_bucket_below_whose_bound_it_lies() {
        let micros = [
            (49, 1),
            (51, 2),
            (100, 4),
            (980, 8),
            (1010, 16),
            (90_000, 32),
        ];
        let fine = micros.map(|(longest, count)| (Duration::from_micros(longest), count));
        let Buckets { counts, sum } = Buckets::regrouped(fine.into_iter());
        let at = |bound| {
            counts
                .iter()
                .find(|(b, _)| *b == bound)
                .map(|found| found.1)
        };
        assert_eq!(at(5e-5), Some(1));
        assert_eq!(at(1e-4), Some(2 + 4));
        assert_eq!(at(1e-3), Some(8));
        assert_eq!(at(1.25e-3), Some(16));
        assert_eq!(at(f64::INFINITY), Some(32));
        let all: u64 = counts.iter().map(|(_, count)| count).sum();
        assert_eq!(all, 63);
        let exact: f64 = micros
            .iter()
            .map(|(t, count)| *t as f64 * 1e-6 * *count as f64)
            .sum();
        assert!((sum / exact - MIDDLE).abs() < 1e-12, "{sum} for {exact}");
    }
}
