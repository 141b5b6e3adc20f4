//! The metric families. Each contains the samples of all robots, because a family must not appear
//! twice.

use std::fmt;
use std::sync::Arc;

use franka_proto::{RobotError, RobotMode, RobotState};
use franka_rt::lifecycle::Unready;
use franka_rt::stats::{Histogram, Stats};
use franka_rt::supervision::{Condition, Health};
use prometheus_client::encoding::{
    DescriptorEncoder, EncodeGaugeValue, EncodeLabelSet, MetricEncoder, NoLabelSet,
};
use prometheus_client::metrics::MetricType;
use prometheus_client::registry::Unit;

use super::buckets::Buckets;
use crate::robot::Robot;
use crate::tally::Tally;

/// The data of one robot at one moment.
pub(super) struct Scrape<'a> {
    label: &'a str,
    robot: &'a Robot,
    state: RobotState,
    stats: Arc<Stats>,
    health: Health,
    tally: Tally,
}

impl<'a> Scrape<'a> {
    pub(super) fn new(label: &'a str, robot: &'a Robot) -> Self {
        Self {
            label,
            robot,
            state: robot.state(),
            stats: robot.stats(),
            health: robot.health().newest(),
            tally: robot.tally(),
        }
    }
}

/// Writer of all families.
pub(super) struct Families<'a, 'e> {
    encoder: DescriptorEncoder<'e>,
    scrapes: Vec<Scrape<'a>>,
}

impl<'a, 'e> Families<'a, 'e> {
    pub(super) fn new(
        encoder: DescriptorEncoder<'e>,
        scrapes: impl Iterator<Item = Scrape<'a>>,
    ) -> Self {
        Self {
            encoder,
            scrapes: scrapes.collect(),
        }
    }

    pub(super) fn encode(mut self) -> fmt::Result {
        let version = [("version", env!("CARGO_PKG_VERSION"))];
        self.encoder
            .encode_descriptor("franka_build", "The driver.", None, MetricType::Info)?
            .encode_info(&version)?;
        self.robot()?;
        self.mishaps()?;
        self.thread()
    }

    /// Writes the health of the robot.
    fn robot(&mut self) -> fmt::Result {
        let help = "1 while the robot is connected, otherwise 0.";
        self.gauges("franka_connected", help, None, |scrape| {
            let without = [Condition::Closed, Condition::Unready(Unready::Disconnected)];
            let connected = !without.contains(&scrape.health.condition);
            [(ALONE, i64::from(connected))]
        })?;
        let help = "1 while the robot accepts motions, otherwise 0.";
        self.gauges("franka_ready", help, None, |scrape| {
            let ready = scrape.health.condition == Condition::Ready;
            [(ALONE, i64::from(ready))]
        })?;
        let help = "1 for the current mode of the robot, 0 for the other modes.";
        self.gauges("franka_robot_mode", help, None, |scrape| {
            RobotMode::ALL.map(|mode| {
                let name = mode.to_string().to_lowercase().replace(' ', "_");
                ([("mode", name)], i64::from(mode == scrape.state.robot_mode))
            })
        })?;
        let help = "1 for each active error of the robot, otherwise 0.";
        self.gauges("franka_error_active", help, None, |scrape| {
            RobotError::ALL.map(|error| {
                let holds = scrape.state.errors.contains(error);
                ([("error", error.name())], i64::from(holds))
            })
        })?;
        let help = "Share of the last 100 commands that the robot received in time.";
        self.gauges("franka_success_ratio", help, None, |scrape| {
            [(ALONE, scrape.state.control_command_success_rate)]
        })
    }

    /// Writes the numbers of motions, reflexes, recoveries and reconnects.
    fn mishaps(&mut self) -> fmt::Result {
        let help = "Motions that have ended.";
        self.counters("franka_motions", help, |scrape| {
            let motions = scrape.tally.motions();
            motions.map(|(outcome, count)| ([("outcome", outcome)], count))
        })?;
        let help = "Reflexes.";
        self.counters("franka_reflexes", help, |scrape| {
            let reflexes = scrape.tally.reflexes();
            reflexes.map(|(error, count)| ([("reason", error.name())], count))
        })?;
        let help = "Recoveries by the supervisor.";
        self.counters("franka_recoveries", help, |scrape| {
            [(ALONE, scrape.health.recoveries)]
        })?;
        let help = "Connections that the supervisor made after the first one.";
        self.counters("franka_reconnects", help, |scrape| {
            [(ALONE, scrape.health.reconnects)]
        })?;
        let help = "Duration of the newest recovery by the supervisor.";
        self.gauges("franka_recovery", help, SECONDS, |scrape| {
            let took = scrape.health.last_recovery;
            took.map(|took| (ALONE, took.as_secs_f64()))
        })?;
        let help = "Duration of the newest reconnect.";
        self.gauges("franka_reconnect", help, SECONDS, |scrape| {
            let took = scrape.health.last_reconnect;
            took.map(|took| (ALONE, took.as_secs_f64()))
        })
    }

    /// Writes how punctual control is.
    fn thread(&mut self) -> fmt::Result {
        let help = "1 for each real-time request of the control thread that the operating system \
            granted, otherwise 0.";
        self.gauges("franka_rt_granted", help, None, |scrape| {
            let granted = scrape.robot.granted();
            let (fifo, polled) = (granted.priority.is_some(), granted.busy_poll.is_some());
            [
                ([("what", "fifo")], i64::from(fifo)),
                ([("what", "busy_poll")], i64::from(polled)),
            ]
        })?;
        for (name, help, count) in COUNTERS {
            self.counters(name, help, |scrape| [(ALONE, count(&scrape.stats))])?;
        }
        let help = "Datagrams that were not states of the robot.";
        self.counters("franka_datagrams_refused", help, |scrape| {
            [
                ([("reason", "foreign")], scrape.stats.foreign.get()),
                ([("reason", "malformed")], scrape.stats.malformed.get()),
            ]
        })?;
        let help = "Failed socket calls.";
        self.counters("franka_socket_errors", help, |scrape| {
            [
                ([("call", "receive")], scrape.stats.receive_errors.get()),
                ([("call", "send")], scrape.stats.send_errors.get()),
            ]
        })?;
        let help = "Time between consecutive states.";
        self.histogram("franka_state_interval", help, |stats| &stats.interval)?;
        let help = "Time from the receipt of a state to the departure of its command.";
        self.histogram("franka_cycle_turnaround", help, |stats| &stats.turnaround)?;
        let help =
            "Least time between the departure of a command and the due time of the next state.";
        self.gauges("franka_cycle_slack", help, SECONDS, |scrape| {
            let (slack, overrun) = (scrape.stats.slack.min(), scrape.stats.overrun.max());
            let overrun = overrun.map(|overrun| -overrun.as_secs_f64());
            let least = overrun.or_else(|| slack.map(|slack| slack.as_secs_f64()));
            least.map(|least| (ALONE, least))
        })
    }

    /// Writes a family of gauges: some samples for each robot, with labels in addition to the
    /// robot's label.
    fn gauges<L, V, S>(
        &mut self,
        name: &str,
        help: &str,
        unit: Option<&Unit>,
        of: impl Fn(&Scrape<'_>) -> S,
    ) -> fmt::Result
    where
        L: EncodeLabelSet,
        V: EncodeGaugeValue,
        S: IntoIterator<Item = (L, V)>,
    {
        let mut family = self
            .encoder
            .encode_descriptor(name, help, unit, MetricType::Gauge)?;
        for scrape in &self.scrapes {
            for (labels, value) in of(scrape) {
                labelled(&mut family, scrape, labels, |metric| {
                    metric.encode_gauge(&value)
                })?;
            }
        }
        Ok(())
    }

    /// Writes a family of counters, as [`Self::gauges`] does.
    fn counters<L, S>(
        &mut self,
        name: &str,
        help: &str,
        of: impl Fn(&Scrape<'_>) -> S,
    ) -> fmt::Result
    where
        L: EncodeLabelSet,
        S: IntoIterator<Item = (L, u64)>,
    {
        let mut family = self
            .encoder
            .encode_descriptor(name, help, None, MetricType::Counter)?;
        for scrape in &self.scrapes {
            for (labels, count) in of(scrape) {
                labelled(&mut family, scrape, labels, |metric| {
                    metric.encode_counter::<NoLabelSet, _, u64>(&count, None)
                })?;
            }
        }
        Ok(())
    }

    /// Writes a family with one histogram per robot, in seconds.
    fn histogram(
        &mut self,
        name: &str,
        help: &str,
        of: impl Fn(&Stats) -> &Histogram,
    ) -> fmt::Result {
        let mut family =
            self.encoder
                .encode_descriptor(name, help, SECONDS, MetricType::Histogram)?;
        for scrape in &self.scrapes {
            let Buckets { counts, sum } = Buckets::of(of(&scrape.stats));
            let count = counts.iter().map(|(_, count)| count).sum();
            labelled(&mut family, scrape, ALONE, |metric| {
                metric.encode_histogram::<NoLabelSet>(sum, count, &counts, None)
            })?;
        }
        Ok(())
    }
}

/// Encodes one sample with the label of its robot and these labels.
fn labelled(
    family: &mut MetricEncoder<'_>,
    scrape: &Scrape<'_>,
    labels: impl EncodeLabelSet,
    encode: impl FnOnce(&mut MetricEncoder<'_>) -> fmt::Result,
) -> fmt::Result {
    encode(&mut family.encode_family(&([("robot", scrape.label)], labels))?)
}

/// No labels in addition to the robot's label.
const ALONE: [(&str, &str); 0] = [];

const SECONDS: Option<&Unit> = Some(&Unit::Seconds);

/// A name without `_total`, the help text, and the getter of the count.
type CounterOf = (&'static str, &'static str, fn(&Stats) -> u64);

const COUNTERS: [CounterOf; 6] = [
    (
        "franka_cycles",
        "States that the control thread processed.",
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
        "States skipped, because a newer state had already arrived.",
        |stats| stats.skipped.get(),
    ),
    (
        "franka_states_stale",
        "States that arrived after a newer state, or twice.",
        |stats| stats.stale.get(),
    ),
];
