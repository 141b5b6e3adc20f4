//! Formats the results as a table and as JSON.

use std::fmt::Write as _;
use std::fs;
use std::time::Duration;

use serde_json::{Value, json};

use crate::case::{Case, ClientKind, Measured};
use crate::simulator_case::{Plant, SimulatorCase, SimulatorCost, Starts};
use crate::trace::Quantiles;

/// A client and the result of its measurement.
type Row = (Case, anyhow::Result<Measured>);

/// Returns the machine, the table, and a comparison of each client with the echo under the same
/// scheduler.
pub(crate) fn markdown(rows: &[Row], time: Duration) -> String {
    let mut text = format!("{}; {} s each\n\n", machine(), time.as_secs());
    text += "| client | scheduler | success rate, mean / least | lost of states | interval p50 / p99 / p99.9 / max, µs | turnaround p50 / p99 / p99.9 / max, µs | times the echo's p50 / p99 | CPU, % of a core |\n";
    text += "|---|---|---|---|---|---|---|---|\n";
    for (case, result) in rows {
        let client = case.client.name();
        let row = match result {
            Err(error) => format!("| {client} | failed: {error:#} |||||||"),
            Ok(measured) => {
                let summary = &measured.summary;
                let scheduler = scheduler(measured.fifo_priority);
                format!(
                    "| {client} | {scheduler} | {:.4} / {:.2} | {} of {} | {} | {} | {} | {:.2} |",
                    summary.success_average,
                    summary.success_minimum,
                    summary.lost,
                    summary.states,
                    micros(&summary.interval),
                    micros(&summary.turnaround),
                    compared(measured, echo(rows, case)),
                    measured.cpu_percent,
                )
            }
        };
        // Writing to a string does not fail.
        let _ = writeln!(text, "{row}");
    }
    text
}

/// Returns all values of the clients.
pub(crate) fn json(rows: &[Row], time: Duration) -> Value {
    let rows: Vec<_> = rows
        .iter()
        .map(|(case, result)| match result {
            Ok(measured) => json!({ "client": case.name(), "measured": measured }),
            Err(error) => json!({ "client": case.name(), "failed": format!("{error:#}") }),
        })
        .collect();
    json!({ "machine": machine(), "seconds": time.as_secs(), "clients": rows })
}

/// Returns the machine, the start time of the simulator, and its cost.
pub(crate) fn simulator_markdown(
    starts: &[(Plant, Starts)],
    cases: &[(SimulatorCase, SimulatorCost)],
    time: Duration,
) -> String {
    let mut text = format!("{}; {} s each\n\n", machine(), time.as_secs());
    text += "| plant | ready after, p50 / max, ms |\n|---|---|\n";
    for (plant, Starts { p50, max, .. }) in starts {
        let [p50, max] = [p50, max].map(|&nanos| nanos as f64 / 1e6);
        let _ = writeln!(text, "| {} | {p50:.1} / {max:.1} |", plant.name());
    }
    text += "\n| plant | client | scheduler | CPU, % of a core | memory, MB | state interval p50 / p99 / p99.9 / max, µs | off a millisecond p50 / p99 / p99.9 / max, µs |\n";
    text += "|---|---|---|---|---|---|---|\n";
    for (case, cost) in cases {
        let columns = [
            case.plant.name().to_owned(),
            case.client.name().to_owned(),
            scheduler(cost.fifo_priority),
            format!("{:.2}", cost.cpu_percent),
            format!("{:.1}", cost.memory_kib as f64 * 1024.0 / 1e6),
            cost.state_interval.as_ref().map(micros).unwrap_or_default(),
            cost.state_deviation
                .as_ref()
                .map(micros)
                .unwrap_or_default(),
        ];
        let _ = writeln!(text, "| {} |", columns.join(" | "));
    }
    text
}

/// Returns all values of the simulator.
pub(crate) fn simulator_json(
    starts: &[(Plant, Starts)],
    cases: &[(SimulatorCase, SimulatorCost)],
    time: Duration,
) -> Value {
    let starts: Vec<_> = starts
        .iter()
        .map(|(plant, starts)| json!({ "plant": plant.name(), "ready_ns": starts }))
        .collect();
    let cases: Vec<_> = cases
        .iter()
        .map(|(case, cost)| {
            json!({
                "plant": case.plant.name(),
                "client": case.client.name(),
                "realtime": case.realtime,
                "measured": cost,
            })
        })
        .collect();
    json!({ "machine": machine(), "seconds": time.as_secs(), "starts": starts, "simulators": cases })
}

fn scheduler(fifo_priority: Option<u32>) -> String {
    match fifo_priority {
        Some(priority) => format!("`SCHED_FIFO`, {priority}"),
        None => "normal".to_owned(),
    }
}

/// Returns the result of the echo under the same scheduler.
fn echo<'a>(rows: &'a [Row], case: &Case) -> Option<&'a Measured> {
    let is_floor = |(other, _): &&Row| {
        matches!(other.client, ClientKind::Echo) && other.scheduler == case.scheduler
    };
    rows.iter().find(is_floor)?.1.as_ref().ok()
}

fn compared(measured: &Measured, echo: Option<&Measured>) -> String {
    let Some(echo) = echo else {
        return String::new();
    };
    let (ours, floor) = (measured.summary.turnaround, echo.summary.turnaround);
    let times = |ours: u64, floor: u64| ours as f64 / floor as f64;
    format!(
        "{:.2} / {:.2}",
        times(ours.p50, floor.p50),
        times(ours.p99, floor.p99)
    )
}

fn micros(quantiles: &Quantiles) -> String {
    let Quantiles {
        p50,
        p99,
        p99_9,
        max,
    } = quantiles;
    let micros = [p50, p99, p99_9, max].map(|&nanos| {
        let micros = nanos as f64 / 1e3;
        if micros < 100.0 {
            format!("{micros:.1}")
        } else {
            format!("{micros:.0}")
        }
    });
    micros.join(" / ")
}

/// Returns the processor model, the number of processors, and the kernel.
pub(crate) fn machine() -> String {
    let read = |path| fs::read_to_string(path).unwrap_or_default();
    let processors = read("/proc/cpuinfo");
    let model = processors
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(": "))
        .map_or("unknown processor", |(_, model)| model);
    let count = std::thread::available_parallelism().map_or(0, usize::from);
    let kernel = read("/proc/sys/kernel/osrelease");
    let kind = if franka_rt::sched::kernel_is_realtime() {
        "PREEMPT_RT"
    } else {
        "no real-time kernel"
    };
    format!("{model}, {count} cores; Linux {} ({kind})", kernel.trim())
}

#[cfg(test)]
mod tests {
    use crate::case::Scheduler;
    use crate::simulator_case::ConnectedClient;
    use crate::trace::Summary;

    use super::*;

    fn measured(turnaround: u64) -> Measured {
        let quantiles = |nanos| Quantiles {
            p50: nanos,
            p99: 2 * nanos,
            p99_9: 3 * nanos,
            max: 40 * nanos,
        };
        Measured {
            summary: Summary {
                states: 1000,
                lost: 3,
                success_average: 0.99951,
                success_minimum: 0.97,
                state_interval: quantiles(1_000_000),
                interval: quantiles(1_000_000),
                turnaround: quantiles(turnaround),
            },
            cpu_percent: 1.234,
            fifo_priority: Some(99),
        }
    }

    #[test]
    fn a_client_is_compared_with_the_echo_of_its_scheduler() {
        let row = |client, scheduler, nanos| {
            let case = Case { client, scheduler };
            (case, Ok(measured(nanos)))
        };
        let mut rows = vec![
            row(ClientKind::Echo, Scheduler::Normal, 50_000),
            row(ClientKind::Echo, Scheduler::Fifo, 10_000),
            row(ClientKind::Torques, Scheduler::Fifo, 12_500),
        ];
        let text = markdown(&rows, Duration::from_secs(5));
        let last = text.lines().last().unwrap();
        assert_eq!(
            last,
            "| control function | `SCHED_FIFO`, 99 | 0.9995 / 0.97 | 3 of 1000 | 1000 / 2000 / 3000 / 40000 | 12.5 / 25.0 / 37.5 / 500 | 1.25 / 1.25 | 1.23 |"
        );

        rows[2].1 = Err(anyhow::anyhow!("it ended"));
        let text = markdown(&rows, Duration::from_secs(5));
        assert!(text.contains("failed: it ended"), "{text}");
        let json = json(&rows, Duration::from_secs(5));
        assert_eq!(json["clients"][2]["failed"], "it ended");
        assert_eq!(
            json["clients"][1]["measured"]["summary"]["turnaround"]["p50"],
            10_000
        );
    }
    #[test]
    fn a_simulator_has_intervals_only_with_a_listener() {
        let starts = Starts {
            count: 3,
            p50: 12_340_000,
            max: 23_450_000,
        };
        let starts = [(Plant::Rigid, starts)];
        let listened = measured(100_000).summary.state_interval;
        let case = |client, interval| {
            let case = SimulatorCase {
                plant: Plant::Rigid,
                client,
                realtime: false,
            };
            let cost = SimulatorCost {
                cpu_percent: 2.345,
                memory_kib: 10_000,
                fifo_priority: None,
                state_interval: interval,
                state_deviation: interval,
            };
            (case, cost)
        };
        let cases = [
            case(ConnectedClient::None, None),
            case(ConnectedClient::Listener, Some(listened)),
        ];
        let time = Duration::from_secs(5);
        let text = simulator_markdown(&starts, &cases, time);
        assert!(text.contains("| rigid | 12.3 / 23.4 |"), "{text}");
        let none = "| rigid | none | normal | 2.35 | 10.2 |  |  |";
        assert!(text.contains(none), "{text}");
        assert!(text.contains("| 1000 / 2000 / 3000 / 40000 |"), "{text}");
        let json = simulator_json(&starts, &cases, time);
        assert_eq!(json["starts"][0]["ready_ns"]["p50"], 12_340_000);
        let interval = &json["simulators"][1]["measured"]["state_interval"];
        assert_eq!(interval["p99"], 2_000_000);
    }
}
