//! What a dry run of the control loop shows, against a simulated robot on this computer.

use core::time::Duration;

use franka_rt::stats::Stats;

use crate::finding::{About, Finding, Group, Judged, Matters, Purpose};

/// Times of a control loop that ran against a simulated robot. The slack of a cycle is the time
/// from the departure of its command to when the next state is due.
///
/// States are due by the most punctual of the last 32 to 64, and the clock of a simulated robot
/// stands still while its thread is held up: one such pause takes its length from the slack of as
/// many commands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DryRun {
    /// The `SCHED_FIFO` priority of the loop; `None` under the normal scheduler.
    pub priority: Option<i32>,
    /// Commands sent.
    pub commands: u64,
    /// Commands that left after the next state was due: their slack counts as zero.
    pub overruns: u64,
    /// The slack that half of the commands had at least, to 1/16.
    pub slack_p50: Duration,
    /// The slack that 99 % of the commands had at least, to 1/16.
    pub slack_p99: Duration,
    /// The shortest slack, exactly.
    pub slack_min: Duration,
    /// Why the run ended early, if it did.
    pub ended: Option<String>,
}

impl DryRun {
    /// What the loop of a run that did not end early has counted, at this priority.
    pub fn new(stats: &Stats, priority: Option<i32>) -> Self {
        let slack = |part| stats.slack.quantile(part).unwrap_or_default();
        Self {
            priority,
            commands: stats.commands.get(),
            overruns: stats.overrun.count(),
            slack_p50: slack(0.5),
            // The shortest ones are the worst.
            slack_p99: slack(0.01),
            slack_min: stats.slack.min().unwrap_or_default(),
            ended: None,
        }
    }
}

/// What a dry run shows: `timing.dry_run`. A pure function.
pub fn dry_run(run: &DryRun, purpose: Purpose) -> Finding {
    let about = About {
        id: "timing.dry_run",
        group: Group::Timing,
        matters: Matters::Moving,
        wanted: "no command late, a slack above 200 us in 99 % of the cycles; 1 % late or an early end a failure",
        why: "The driver's own loop with its sockets; only the network card and the robot are missing.",
        source: "thresholds: this project's, from the millisecond of a cycle; a pause of the simulated robot's thread counts for the 32 to 64 commands after it",
    };
    about.finding(Ok(judge(run)), purpose)
}

fn judge(run: &DryRun) -> Judged {
    if run.commands == 0 {
        return Judged::unknown("unknown: no command was sent");
    }
    let scheduling = match run.priority {
        Some(priority) => format!("SCHED_FIFO {priority}"),
        None => "normal scheduling".into(),
    };
    let read = format!(
        "{} commands under {scheduling}, {} late; slack p50 {}, p99 {}, min {} us",
        run.commands,
        run.overruns,
        run.slack_p50.as_micros(),
        run.slack_p99.as_micros(),
        run.slack_min.as_micros(),
    );
    if let Some(why) = &run.ended {
        Judged::failure(format!("{read}; ended early: {why}"))
    } else if run.overruns * 100 >= run.commands {
        Judged::failure(read)
    } else if run.overruns > 0 {
        Judged::warning(read)
    } else if run.slack_p99 <= SLACK_GOOD {
        Judged::info(read)
    } else if run.priority.is_none() {
        Judged::info(format!(
            "{read}; says little, as any other program may delay the loop"
        ))
    } else if run.commands < COMMANDS_MIN {
        Judged::info(format!("{read}; too few to call it good"))
    } else {
        Judged::good(read)
    }
}

const SLACK_GOOD: Duration = Duration::from_micros(200);

/// Fewer commands than ten seconds have, some at begin and end aside, show little.
const COMMANDS_MIN: u64 = 9_900;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;

    #[test]
    fn late_commands_decide_and_then_the_slack() {
        let good = DryRun {
            priority: Some(99),
            commands: 10_000,
            overruns: 0,
            slack_p50: Duration::from_micros(900),
            slack_p99: Duration::from_micros(700),
            slack_min: Duration::from_micros(150),
            ended: None,
        };
        let slack = |us| DryRun {
            slack_p99: Duration::from_micros(us),
            ..good.clone()
        };
        let late = |overruns| DryRun {
            overruns,
            ..good.clone()
        };
        let normal = DryRun {
            priority: None,
            ..good.clone()
        };
        let short = DryRun {
            commands: 9_899,
            ..good.clone()
        };
        let ended = DryRun {
            ended: Some("communication_constraints_violation".into()),
            ..good.clone()
        };
        use Verdict::{Failure, Good, Info, Unknown, Warning};
        for (run, expected) in [
            (good.clone(), Good),
            (ended, Failure),
            (slack(201), Good),
            (slack(200), Info),
            (normal, Info),
            (short, Info),
            (late(1), Warning),
            (late(99), Warning),
            (late(100), Failure),
            (DryRun::default(), Unknown),
        ] {
            let finding = dry_run(&run, Purpose::Move);
            assert_eq!(finding.verdict, expected, "{}", finding.read);
        }
        assert_eq!(dry_run(&late(100), Purpose::Read).verdict, Warning);
        assert_eq!(
            dry_run(&late(3), Purpose::Move).read,
            "10000 commands under SCHED_FIFO 99, 3 late; slack p50 900, p99 700, min 150 us"
        );
    }
}
