//! The punctuality of control, and its counters.

use std::time::Duration;

use franka_async::metrics::Exporter;
use franka_async::realtime::{CycleTimes, Histogram, Phases};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::names::Named;
use crate::robot::Robot;
use crate::runtime::runtime;

#[pymethods]
impl Robot {
    /// Counters and times of the control thread since the connection was made, as a new `dict`;
    /// without waiting, also during motions.
    ///
    /// Counters: `states`, `commands`, `skipped`, `lost`, `stale`, `foreign`, `malformed`,
    /// `receive_errors`, `send_errors`, `records_lost`, `states_lost`, `reports_lost`. Times, each
    /// a `dict` of `count`, `min`, `p50`, `p90`, `p99`, `p999` and `max`, s, `None` before the
    /// first one; quantiles are exact to 1/16: `interval` between two states, `turnaround` from a
    /// state to its command, `slack` that is left when a command leaves, `overrun` of those that
    /// left too late. `worst_cycle` and `newest_overrun` are the times of one cycle, or `None`:
    /// `time` of the robot's clock, `late`, `turnaround`, `slack` (negative for an overrun),
    /// `phases` and the `longest` of these. `motion` counts over the motion that runs or ran last,
    /// or is `None`.
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let stats = self.connected()?.stats();
        let all = PyDict::new(py);
        for (name, counter) in [
            ("states", &stats.states),
            ("commands", &stats.commands),
            ("skipped", &stats.skipped),
            ("lost", &stats.lost),
            ("stale", &stats.stale),
            ("foreign", &stats.foreign),
            ("malformed", &stats.malformed),
            ("receive_errors", &stats.receive_errors),
            ("send_errors", &stats.send_errors),
            ("records_lost", &stats.records_lost),
            ("states_lost", &stats.states_lost),
            ("reports_lost", &stats.reports_lost),
        ] {
            all.set_item(name, counter.get())?;
        }
        for (name, times) in [
            ("interval", &stats.interval),
            ("turnaround", &stats.turnaround),
            ("slack", &stats.slack),
            ("overrun", &stats.overrun),
        ] {
            all.set_item(name, histogram(py, times)?)?;
        }
        let cycle = |cycle: Option<CycleTimes>| cycle.map(|it| times(py, &it)).transpose();
        all.set_item("worst_cycle", cycle(stats.worst_cycle())?)?;
        all.set_item("newest_overrun", cycle(stats.newest_overrun())?)?;
        let motion = stats.motion().map(|motion| {
            let counts = PyDict::new(py);
            counts.set_item("duration", motion.duration_ms() as f64 / 1000.0)?;
            counts.set_item("cycles", motion.cycles)?;
            counts.set_item("commands", motion.commands)?;
            counts.set_item("lost_states", motion.lost_states)?;
            counts.set_item("skipped_states", motion.skipped_states)?;
            counts.set_item("overruns", motion.overruns)?;
            counts.set_item("success_rate_min", motion.success_rate_min)?;
            counts.set_item("success_rate_avg", motion.success_rate_avg())?;
            counts.set_item("worst_turnaround", motion.worst_turnaround.as_secs_f64())?;
            Ok::<_, PyErr>(counts)
        });
        all.set_item("motion", motion.transpose()?)?;
        Ok(all)
    }

    /// Rights granted to the control thread by the operating system, as a new `dict`: its
    /// `SCHED_FIFO` `priority` or `None`, `busy_poll` in s or `None`, and `refusals`, texts, under
    /// `realtime="ignore"`.
    fn granted<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let granted = self.connected()?.granted();
        let refusals: Vec<String> = granted.refusals.iter().map(ToString::to_string).collect();
        let all = PyDict::new(py);
        all.set_item("priority", granted.priority)?;
        all.set_item(
            "busy_poll",
            granted.busy_poll.map(|time| time.as_secs_f64()),
        )?;
        all.set_item("refusals", refusals)?;
        Ok(all)
    }

    /// The robot's metrics as OpenMetrics text, for Prometheus and compatible tools; the label
    /// `robot` is its address. `franka_async.metrics.text` is the text of several robots.
    fn metrics(&self, py: Python<'_>) -> PyResult<String> {
        let robot = self.connected()?;
        Ok(py.detach(|| robot.metrics()))
    }
}

/// Returns the metrics of the connected robots, each with its value of the label `robot`, as one
/// text.
#[pyfunction]
pub(crate) fn _metrics(
    py: Python<'_>,
    robots: Vec<(String, Bound<'_, Robot>)>,
) -> PyResult<String> {
    runtime()?;
    let connected = robots.iter().filter_map(|(label, robot)| {
        let robot = robot.get().connected().ok()?;
        Some((label.clone(), robot))
    });
    let exporter = Exporter::new(connected);
    Ok(py.detach(|| exporter.text()))
}

fn histogram<'py>(py: Python<'py>, times: &Histogram) -> PyResult<Bound<'py, PyDict>> {
    let seconds = |time: Option<Duration>| time.map(|time| time.as_secs_f64());
    let all = PyDict::new(py);
    all.set_item("count", times.count())?;
    all.set_item("min", seconds(times.min()))?;
    for (name, quantile) in [("p50", 0.5), ("p90", 0.9), ("p99", 0.99), ("p999", 0.999)] {
        all.set_item(name, seconds(times.quantile(quantile)))?;
    }
    all.set_item("max", seconds(times.max()))?;
    Ok(all)
}

fn times<'py>(py: Python<'py>, cycle: &CycleTimes) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("time", cycle.time as f64 / 1000.0)?;
    all.set_item("late", cycle.late.as_secs_f64())?;
    all.set_item("turnaround", cycle.turnaround.as_secs_f64())?;
    all.set_item("slack", cycle.slack.as_nanos() as f64 * 1e-9)?;
    let phases = cycle.phases.as_ref().map(|phases| self::phases(py, phases));
    all.set_item("phases", phases.transpose()?)?;
    let (longest, time) = cycle.longest();
    all.set_item("longest", (longest.python_name(), time.as_secs_f64()))?;
    Ok(all)
}

/// Returns the times of the phases of a cycle, s.
pub(crate) fn phases<'py>(py: Python<'py>, phases: &Phases) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (name, time) in [
        ("orders", phases.orders),
        ("decode", phases.decode),
        ("program", phases.program),
        ("send", phases.send),
        ("publish", phases.publish),
        ("prepare", phases.prepare),
    ] {
        all.set_item(name, time.as_secs_f64())?;
    }
    Ok(all)
}
