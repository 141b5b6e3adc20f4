//! `franka test communication`: tests whether a connection is good enough for control at 1 kHz.

use std::time::Duration;

use clap::{Args, Subcommand};
use franka_async::control::{Finish, Torques};
use franka_async::realtime::Histogram;
use franka_async::{MotionError, MotionReport};
use serde_json::{Value, json};

use crate::connection::Which;
use crate::ending::{Ending, Failure};
use crate::motion::{Length, Mover, Moving};
use crate::output::{BAD, BOLD, GOOD, WARN};
use crate::values::seconds;

/// Test a robot's connection
#[derive(Debug, Subcommand)]
pub(crate) enum Test {
    #[command(after_help = "Example: franka test communication left --seconds 10")]
    Communication(Communication),
}

impl Test {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let Self::Communication(communication) = self;
        communication.run().await
    }
}

/// Test network and computer for control at 1 kHz, with one robot or two at the same time
///
/// Commands zero torques for some seconds. The arm stays in place, because the robot compensates
/// gravity. Exit code 0: good (0.95 of the commands arrive in time) or usable (0.9); 1: not usable.
/// With two robots, the worse one decides.
#[derive(Debug, Args)]
pub(crate) struct Communication {
    #[command(flatten)]
    mover: Mover,
    /// Second robot, tested at the same time
    #[arg(long, value_name = "ROBOT", conflicts_with = "record")]
    two: Option<String>,
    /// Duration of the test
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "10")]
    seconds: Duration,
}

impl Communication {
    async fn run(self) -> anyhow::Result<Ending> {
        let one = self.mover.begin().await?;
        let other = match &self.two {
            Some(other) => Some(
                self.mover
                    .how
                    .begin(&Which::of(Some(other.clone())))
                    .await?,
            ),
            None => None,
        };
        let outcome = self.measure(&one, other.as_ref()).await;
        let figures = |moving: &Moving, report: &MotionReport| {
            let stats = moving.robot.stats();
            figures(moving, report, &stats.interval, &stats.turnaround)
        };
        let outcome = outcome.map(|(report, another)| {
            let mut all = vec![figures(&one, &report)];
            if let (Some(other), Some(report)) = (&other, another) {
                all.push(figures(other, &report));
            }
            all
        });
        if let Some(other) = other {
            other.end(Ok(())).await?;
        }
        let all = one.end(outcome).await?;
        let rates = all
            .iter()
            .filter_map(|it| it["success_rate"]["avg"].as_f64());
        let worst = rates.fold(1.0, f64::min);
        let (verdict, style, ending) = match worst {
            rate if rate >= GOOD_RATE => ("good", GOOD, Ending::Done),
            rate if rate >= USABLE_RATE => ("usable", WARN, Ending::Done),
            _ => ("not usable", BAD, Ending::Failed),
        };
        let value = json!({ "verdict": verdict, "robots": all });
        self.mover.how.output.print(&value, || {
            let about = match verdict {
                "good" => "",
                "usable" => ": motions will be rough, and the robot may stop them",
                _ => ": franka doctor shows likely causes",
            };
            let tables: String = all.iter().map(table).collect();
            format!("{tables}verdict        {style}{verdict}{style:#}{about}")
        })?;
        Ok(ending)
    }

    async fn measure(
        &self,
        one: &Moving,
        other: Option<&Moving>,
    ) -> anyhow::Result<(MotionReport, Option<MotionReport>)> {
        let what = format!(
            "For {} s the arm gets no torques except the robot's gravity compensation,\n\
             and keeps its position. An undeclared load pulls it down.",
            self.seconds.as_secs_f64()
        );
        one.ask("test", &what).await?;
        let length = Some(Length::About(self.seconds));
        let Some(other) = other else {
            let report = one.drive(nothing(one, self.seconds), length).await?;
            return Ok((report, None));
        };
        other.ask("test", &what).await?;
        let both = tokio::try_join!(
            one.drive(nothing(one, self.seconds), length),
            other.drive(nothing(other, self.seconds), None)
        );
        // If one test fails or is interrupted, the other test must end, too.
        if both.is_err() {
            let stopped = tokio::join!(one.robot.stop(), other.robot.stop());
            if let (Err(error), _) | (_, Err(error)) = stopped {
                let message = format!("cannot stop the other robot: {error}");
                return Err(both
                    .map(drop)
                    .expect_err("failed")
                    .context(Failure::new(Ending::Failed, message)));
            }
        }
        both.map(|(one, other)| (one, Some(other)))
    }
}

/// Commands zero torques for `seconds`.
async fn nothing(moving: &Moving, seconds: Duration) -> Result<MotionReport, MotionError> {
    let mut time = Duration::ZERO;
    let control = moving.robot.control_torques(move |_, step| {
        time += step;
        Torques([0.0; 7]).finish_if(time >= seconds)
    });
    control.await
}

fn figures(
    moving: &Moving,
    report: &MotionReport,
    interval: &Histogram,
    turnaround: &Histogram,
) -> Value {
    json!({
        "robot": moving.place.to_string(),
        "success_rate": { "min": report.success_rate_min, "avg": report.success_rate_avg },
        "lost": report.lost_states,
        "skipped": report.skipped_states,
        "interval_us": quantiles(interval),
        "turnaround_us": quantiles(turnaround),
    })
}

/// Returns quantiles of times, in microseconds.
pub(super) fn quantiles(times: &Histogram) -> Value {
    let at = |quantile| times.quantile(quantile).map(|time| time.as_micros() as u64);
    json!({ "p50": at(0.5), "p99": at(0.99), "p999": at(0.999), "max": at(1.0) })
}

pub(super) fn times(quantiles: &Value) -> String {
    let at = |quantile: &str| quantiles[quantile].as_u64().unwrap_or(0);
    let [p50, p99, p999, max] = ["p50", "p99", "p999", "max"].map(at);
    format!("p50 {p50:>6}  p99 {p99:>6}  p99.9 {p999:>6}  max {max:>6}  us")
}

/// Returns the results of one robot as text.
pub(super) fn table(figures: &Value) -> String {
    let rate = |of: &str| figures["success_rate"][of].as_f64().unwrap_or(0.0);
    format!(
        "{BOLD}{}{BOLD:#}\n\
         success rate   {:.4}, {:.2} at worst\n\
         states         {} lost, {} skipped\n\
         interval       {}\n\
         turnaround     {}\n",
        figures["robot"].as_str().unwrap_or(""),
        rate("avg"),
        rate("min"),
        figures["lost"],
        figures["skipped"],
        times(&figures["interval_us"]),
        times(&figures["turnaround_us"]),
    )
}

/// Smallest mean success rate that counts as good. The next constant is the rate that counts as
/// usable.
const GOOD_RATE: f64 = 0.95;
const USABLE_RATE: f64 = 0.9;
