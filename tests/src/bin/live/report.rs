//! The table, and the JSON.

use std::fmt::Write as _;
use std::fs;
use std::time::Duration;

use serde_json::{Value, json};

use crate::case::{Case, Client, Measured};
use crate::trace::Quantiles;

/// A client and what came of measuring it.
type Row = (Case, anyhow::Result<Measured>);

/// Where it was measured, the table, and how the clients compare with the echo under the same scheduler.
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
                let scheduler = match measured.fifo_priority {
                    Some(priority) => format!("`SCHED_FIFO`, {priority}"),
                    None => "normal".to_owned(),
                };
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

/// All values.
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

/// The echo under the same scheduler.
fn echo<'a>(rows: &'a [Row], case: &Case) -> Option<&'a Measured> {
    let is_floor = |(other, _): &&Row| {
        matches!(other.client, Client::Echo) && other.scheduler == case.scheduler
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

/// Processor, number of them, and kernel.
fn machine() -> String {
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
            row(Client::Echo, Scheduler::Normal, 50_000),
            row(Client::Echo, Scheduler::Fifo, 10_000),
            row(Client::Torques, Scheduler::Fifo, 12_500),
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
}
