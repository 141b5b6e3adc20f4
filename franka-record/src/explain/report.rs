//! The text of an explanation.

use core::fmt;
use core::time::Duration;

use super::place::name;
use super::{Approach, Explanation, Peak, Place};

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.cycles == 0 {
            return match &self.cause {
                Some(cause) => write!(f, "the log has no cycle of the motion\n{}", cause.text),
                None => write!(
                    f,
                    "the recording has no cycles, so there is nothing to explain"
                ),
            };
        }
        let seconds = (self.last - self.first) as f64 * 1e-3;
        writeln!(
            f,
            "{} cycles in {seconds:.3} s, {} to {} ms of the robot's clock",
            self.cycles, self.first, self.last
        )?;
        match &self.cause {
            Some(cause) => {
                let what = if cause.errors.is_empty() {
                    "the motion ended"
                } else {
                    "the robot stopped"
                };
                write!(f, "\nWhy {what} at {} ms", self.end)?;
                match self.received {
                    Some(received) => writeln!(f, " ({received})")?,
                    None => writeln!(f)?,
                }
                for line in cause.text.lines() {
                    writeln!(f, "  {line}")?;
                }
            }
            None => writeln!(f, "\n{NO_END}")?,
        }
        if let (None, Some(failed)) = (&self.cause, &self.failed) {
            writeln!(f, "The last goal failed: {failed}")?;
        }
        if let Some(goal) = self.under_way {
            writeln!(f, "Goal {goal} was running; its end is not recorded.")?;
        }
        match self.earlier {
            0 => {}
            1 => writeln!(f, "(one motion ended earlier)")?,
            earlier => writeln!(f, "({earlier} motions ended earlier)")?,
        }
        if let Some(place) = &self.contact
            && place.noticed
        {
            writeln!(f, "\nContact with the arm")?;
            write!(f, "{place}")?;
        }
        writeln!(f, "\nTimeline, ms before the end")?;
        let shown = self.timeline.len().saturating_sub(SHOWN);
        let left_out = self.moments_left_out + shown as u64;
        if left_out > 0 {
            writeln!(f, "  ({left_out} earlier entries are not shown)")?;
        }
        for moment in &self.timeline[shown..] {
            let before = self.end as i128 - i128::from(moment.time);
            // A text of several lines becomes one line.
            let text = moment.text.replace('\n', " ");
            writeln!(f, "  {:>8}  {text}", -before)?;
        }
        writeln!(f, "\nClosest approach to each limit")?;
        for (what, approach, unit) in [
            ("position", &self.margins.position, "rad"),
            ("velocity", &self.margins.velocity, "rad/s"),
            ("torque", &self.margins.torque, "N·m"),
            ("translation", &self.margins.translation, "m/s"),
            ("rotation", &self.margins.rotation, "rad/s"),
        ] {
            if let Some(approach) = approach {
                self.approach(f, what, approach, unit)?;
            }
        }
        if let Some(fallback) = &self.fallback {
            writeln!(f, "  ({CONSTANTS}: {fallback})")?;
        }
        writeln!(f, "\nPeaks")?;
        for (what, peak, unit) in [
            ("external torque", &self.peaks.external_torque, "N·m"),
            ("external force", &self.peaks.force, "N"),
            ("following error", &self.peaks.following_error, "rad"),
        ] {
            if let Some(Peak { joint, value, time }) = *peak {
                let at = self.before(time);
                writeln!(f, "  {what:<16} {:<14} {value:.3} {unit}, {at}", of(joint))?;
            }
        }
        let lost = &self.lost;
        if lost.states == 0 {
            writeln!(f, "\nNo state was lost.")?;
        } else {
            writeln!(
                f,
                "\n{} states lost, {} in the last second; at most {} in a row, {}",
                lost.states,
                lost.in_last_second,
                lost.most_in_a_row,
                self.before(lost.most_at)
            )?;
        }
        let late = &self.late;
        if late.commands == 0 {
            return Ok(());
        }
        let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
        writeln!(
            f,
            "{} commands left after the next state was due, {:.1} ms late at most,\n  {} (the \
             answer to that state took {:.3} ms)",
            late.commands,
            milliseconds(late.most),
            self.before(late.at),
            milliseconds(late.turnaround)
        )
    }
}

impl Explanation {
    fn approach(
        &self,
        f: &mut fmt::Formatter<'_>,
        what: &str,
        approach: &Approach,
        unit: &str,
    ) -> fmt::Result {
        let Approach {
            joint,
            value,
            limit,
            margin,
            time,
        } = *approach;
        let passed = if margin < 0.0 { ", exceeded" } else { "" };
        let at = self.before(time);
        writeln!(
            f,
            "  {what:<16} {:<14} {value:.3} of {limit:.3} {unit}{passed}, {at}",
            of(joint)
        )
    }

    /// Returns a text such as `12 ms before the end`.
    fn before(&self, time: u64) -> String {
        match self.end as i128 - i128::from(time) {
            0 => "at the end".to_owned(),
            before if before > 0 => format!("{before} ms before the end"),
            before => format!("{} ms after the end", -before),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(why) = &self.unknown {
            writeln!(f, "  {why}")?;
        }
        if let Some(contact) = &self.contact {
            let [x, y, z] = contact.point;
            let [fx, fy, fz] = contact.force;
            let lead = if self.unknown.is_some() {
                "most likely: "
            } else {
                ""
            };
            writeln!(
                f,
                "  {lead}{} ({:.0} %) at {x:.3}, {y:.3}, {z:.3} m, within {:.0} mm",
                name(contact.body),
                100.0 * contact.probability,
                1e3 * contact.spread
            )?;
            writeln!(
                f,
                "  force on the arm: {:.1} N ({fx:.1}, {fy:.1}, {fz:.1} N)\n  (the robot's own \
                 estimates have opposite signs: the force that the arm exerts)",
                contact.size()
            )?;
            if let Some((body, probability)) = contact.next
                && probability >= 0.005
            {
                writeln!(f, "  or {} ({:.0} %)", name(body), 100.0 * probability)?;
            }
        }
        if self.tared < SHORT {
            let tared = 1e3 * self.tared;
            writeln!(
                f,
                "  (rough: the recording shows the arm untouched for only {tared:.0} ms)"
            )?;
        }
        Ok(())
    }
}

fn of(joint: Option<u8>) -> String {
    match joint {
        Some(joint) => format!("joint {joint}"),
        None => "end effector".to_owned(),
    }
}

/// Text for an explanation without the end of a motion.
pub(super) const NO_END: &str = "No reflex, guard or lost link ended a motion.";

/// Text for limits that do not come from a description of the robot.
const CONSTANTS: &str = "limits are the constants for systems before 5.9";

/// Largest number of moments in the report; older moments are omitted.
const SHOWN: usize = 40;

/// Duration of baseline learning below which the report warns, `[s]`.
const SHORT: f64 = 0.2;
