//! The steps of a trial.

use std::ops::ControlFlow;
use std::time::Duration;

use anyhow::Context as _;
use franka_async::connection::GeometryCheck;
use franka_async::error::TareError;
use franka_async::model::{JointVector, Twist};
use franka_async::nalgebra::Vector3;
use franka_async::state::{RobotState, TareRefused, WrenchTare};
use franka_async::{Arm, Engage, Error, MotionReport, Pose};
use serde_json::json;
use tokio::sync::watch;

use super::look::{Look, Mean, SPARSE, apart, described};
use super::report::{Report, Verdict};
use super::{FORCE, PACE, limits};
use crate::motion::Moving;
use crate::output::say;

/// Performs all steps. The report contains the findings even if a step fails.
pub(super) async fn all(moving: &Moving, report: &mut Report) -> anyhow::Result<()> {
    let mut steps = Steps { moving, report };
    let tare = steps.look().await?;
    steps.hold().await?;
    steps.up("1 cm", 0.01).await?;
    steps.up("5 cm", 0.05).await?;
    steps.joint().await?;
    steps.stream().await?;
    steps.after(tare).await
}

struct Steps<'a> {
    moving: &'a Moving,
    report: &'a mut Report,
}

impl Steps<'_> {
    /// Observes the arm at rest under the robot's own controller. The arm does not move.
    async fn look(&mut self) -> anyhow::Result<Option<WrenchTare>> {
        self.name("at rest");
        let robot = &self.moving.robot;
        let look = Look::over(robot, LOOK).await.map_err(Error::from)?;
        self.geometry(&look)?;
        self.limits()?;
        self.zeros(&look)?;
        self.drift(&look)?;
        let missing = look.missing();
        let share = missing as f64 / (look.states + missing) as f64;
        let text = format!(
            "{missing} of {} states did not arrive",
            look.states + missing
        );
        let figures = json!({ "states": look.states, "missing": missing });
        let verdict = Verdict::of(share, [0.01, 0.1]);
        self.report.note("states", verdict, text, figures)?;
        let tare = self.tare().await?;
        self.room()?;
        Ok(tare)
    }

    /// Compares the reported pose with the model's pose at the reported joint positions.
    fn geometry(&mut self, look: &Look) -> anyhow::Result<()> {
        let sets = look.geometry(&described(&self.moving.robot));
        let [(own, gap), known @ ..] = sets;
        let um = gap * 1e6;
        let of_own = format!(
            "O_T_EE is {um:.2} um off the model with {:.4} and {:.4} m",
            own.upper_arm, own.forearm
        );
        let most = GeometryCheck::RESIDUAL_MAX;
        let fitting = known.iter().find(|(_, gap)| *gap <= most);
        let (verdict, text) = match fitting {
            _ if gap <= most => (Verdict::Good, of_own),
            Some((other, gap)) => {
                let um = gap * 1e6;
                let (upper, fore) = (other.upper_arm, other.forearm);
                let fits = format!("{um:.2} um off with {upper:.4} and {fore:.4} m");
                (Verdict::Look, format!("{of_own}; {fits}"))
            }
            None => (Verdict::Bad, format!("{of_own}; no known lengths fit")),
        };
        let figures = sets.map(|(lengths, gap)| {
            json!({
                "upper_arm": lengths.upper_arm,
                "forearm": lengths.forearm,
                "gap_um": gap * 1e6,
            })
        });
        self.report
            .note("geometry", verdict, text, json!(figures))?;
        Ok(())
    }

    /// Checks the robot's joint limits.
    fn limits(&mut self) -> anyhow::Result<()> {
        let model = self.moving.robot.model();
        let (name, difference) = limits::nearest(model.kind(), model.joint_limits());
        let (verdict, text) = match difference {
            None => (Verdict::Good, format!("equal to {name}")),
            Some(most) => {
                let text = format!("in no known table; nearest to {name}; {most}");
                (Verdict::Look, text)
            }
        };
        let columns = limits::columns(model.joint_limits());
        let figures = columns.map(|(name, unit, values)| {
            let values = <[f64; 7]>::from(values);
            json!({ "limit": name, "unit": unit, "joints": values })
        });
        self.report.note("limits", verdict, text, json!(figures))?;
        Ok(())
    }

    /// Lists the fields that this robot does not fill in. Such fields are not an error.
    fn zeros(&mut self, look: &Look) -> anyhow::Result<()> {
        let zeros = SPARSE.iter().zip(look.zero);
        let zeros: Vec<_> = zeros
            .filter_map(|(name, zero)| zero.then_some(*name))
            .collect();
        let text = match zeros.as_slice() {
            [] => format!("none of {} is zero", SPARSE.join(", ")),
            zeros => format!("{} zero in every state", zeros.join(", ")),
        };
        let figures = json!({ "looked_at": SPARSE, "zero": zeros });
        self.report.note("zeros", Verdict::Good, text, figures)?;
        Ok(())
    }

    /// Measures how far the reported pose drifts from the third to the last second.
    fn drift(&mut self, look: &Look) -> anyhow::Result<()> {
        let poses = (look.begin.pose(), look.end.pose());
        let (Some(begin), Some(end)) = poses else {
            let text = "O_T_EE is not a pose".to_owned();
            let failed = self.report.note("drift", Verdict::Bad, text, json!(null));
            return Ok(failed?);
        };
        let (way, turn) = apart(&begin, &end);
        let text = format!("{:.3} mm and {:.3} mrad", way * 1e3, turn * 1e3);
        let figures = json!({ "translation_mm": way * 1e3, "rotation_mrad": turn * 1e3 });
        let verdict = Verdict::of(way, DRIFT);
        self.report.note("drift", verdict, text, figures)?;
        Ok(())
    }

    /// Measures the wrench that the robot estimates while nothing touches the arm.
    async fn tare(&mut self) -> anyhow::Result<Option<WrenchTare>> {
        let tare = match self.moving.robot.tare().await {
            Ok(tare) => tare,
            Err(TareError::Refused(TareRefused::NoEstimate)) => {
                let text = "the robot shows no estimate: a singularity is near".to_owned();
                let figures = json!(null);
                self.report.note("wrench", Verdict::Look, text, figures)?;
                return Ok(None);
            }
            Err(error) => return Err(Error::from(error).into()),
        };
        let force = Vector3::from_column_slice(&tare.wrench[..3]).norm();
        let verdict = Verdict::of(force, [0.5 * FORCE, FORCE]);
        let what = match verdict {
            Verdict::Good => "",
            _ => "; check the declared load",
        };
        let text = format!("{force:.1} N with nothing attached, tared{what}");
        self.report.note("wrench", verdict, text, json!(tare))?;
        Ok(Some(tare))
    }

    /// Checks that all later motions are possible from the current position.
    fn room(&mut self) -> anyhow::Result<()> {
        let robot = &self.moving.robot;
        let up = Pose::translation(0.0, 0.0, 0.05) * robot.pose();
        let motions = [
            ("5 cm up", robot.move_to(up)),
            ("joint 7", robot.move_joints(self.turned(&robot.state()))),
        ];
        let mut refused = String::new();
        for (name, motion) in motions {
            let why = match motion.speed(PACE).preview() {
                Ok(preview) => {
                    let blocked = preview.blocked(robot.model(), &robot.state(), &[]);
                    let near = |_| "the arm would come too close to itself".to_owned();
                    blocked.map_or_else(|error| Some(error.to_string()), |found| found.map(near))
                }
                Err(error) => Some(error.to_string()),
            };
            if let Some(why) = why {
                refused += &format!("{name}: {why}; ");
            }
        }
        let (verdict, text) = match refused.as_str() {
            "" => (Verdict::Good, "the arm can do all steps from here".into()),
            why => (Verdict::Bad, format!("{why}guide the arm elsewhere")),
        };
        self.report.note("room", verdict, text, json!(null))?;
        Ok(())
    }

    async fn hold(&mut self) -> anyhow::Result<()> {
        let seconds = HOLD.as_secs();
        let what = format!("The arm holds its position for {seconds} s.");
        let arm = self.begin("hold", &what).await?;
        let look = Look::over(&self.moving.robot, HOLD).await;
        let look = look.map_err(Error::from)?;
        let report = self.end(arm).await?;
        self.drift(&look)?;
        self.zeros(&look)?;
        self.timing(&report)
    }

    /// Moves the hand up and back.
    async fn up(&mut self, name: &'static str, height: f64) -> anyhow::Result<()> {
        let pace = PACE * 300.0;
        let what = format!(
            "The hand moves {:.0} mm up and back, in a straight line.\n\
             speed at most {pace:.0} mm/s for the hand",
            height * 1e3
        );
        let arm = self.begin(name, &what).await?;
        let here = self.moving.robot.pose();
        let there = Pose::translation(0.0, 0.0, height) * here;
        let mut arrivals = Vec::new();
        for (way, target) in [("there", there), ("back", here)] {
            if let Err(error) = arm.move_to(target).await {
                return Err(self.moving.explain(error).await);
            }
            let mean = self.mean().await?;
            arrivals.push((way, mean.pose().map(|pose| apart(&pose, &target))));
        }
        let report = self.end(arm).await?;
        for (way, arrival) in arrivals {
            let (off, turn) = arrival.unwrap_or((f64::NAN, f64::NAN));
            let (off, turn) = (off * 1e3, turn * 1e3);
            let text = format!("{off:.2} mm and {turn:.2} mrad from the target by O_T_EE");
            let figures = json!({ "translation_mm": off, "rotation_mrad": turn });
            let verdict = Verdict::of(off, ARRIVAL_MM);
            self.report.note(way, verdict, text, figures)?;
        }
        self.timing(&report)
    }

    async fn joint(&mut self) -> anyhow::Result<()> {
        let start = self.moving.robot.state();
        let there = self.turned(&start);
        let degrees = (there[6] - start.q[6]).to_degrees();
        let model = self.moving.robot.model();
        // The default speed is a fifth of the limits.
        let pace = (0.2 * PACE * model.joint_limits().velocity[6]).to_degrees();
        let what = format!(
            "Joint 7 turns the hand by {degrees:+.0} deg and back.\n\
             speed the joint at {pace:.0} deg/s at most"
        );
        let arm = self.begin("one joint", &what).await?;
        let mut arrivals = Vec::new();
        for (way, target) in [("there", there), ("back", start.q)] {
            if let Err(error) = arm.move_joints(target).await {
                return Err(self.moving.explain(error).await);
            }
            let off = JointVector::from(self.mean().await?.q()) - JointVector::from(target);
            arrivals.push((way, off.amax() * 1e3));
        }
        let report = self.end(arm).await?;
        for (way, off) in arrivals {
            let text = format!("{off:.2} mrad from the target by q, the farthest joint");
            let figures = json!({ "joint_mrad": off });
            let verdict = Verdict::of(off, ARRIVAL_MRAD);
            self.report.note(way, verdict, text, figures)?;
        }
        self.timing(&report)
    }

    /// Follows a stream of targets that rise and fall.
    async fn stream(&mut self) -> anyhow::Result<()> {
        let (height, fastest) = (2e3 * WAVE.height, 1e3 * WAVE.velocity(0.25 * WAVE.period));
        let what = format!(
            "The hand follows a target every {EVERY} ms: {height:.0} mm up and back, \
             for {:.0} s.\n\
             speed {fastest:.0} mm/s for the hand, at most {:.0} mm/s",
            WAVE.period,
            PACE * 300.0
        );
        let arm = self.begin("a stream", &what).await?;
        let (robot, here) = (&self.moving.robot, self.moving.robot.pose());
        let (targets, followed) = watch::channel((here, Twist::zeros()));
        // The robot's clock measures the time, because a simulator may run faster than the wall
        // clock.
        let streaming = async move {
            let (mut first, mut sent, mut behind) = (None, 0, Vec::new());
            let read = robot.read(|state| {
                let since = state.message_id - *first.get_or_insert(state.message_id);
                let time = since as f64 * 1e-3;
                let position = here.translation.z + WAVE.at(time);
                behind.push((state.O_T_EE[14] - position).abs() * 1e3);
                if time >= WAVE.period {
                    return ControlFlow::Break(());
                }
                if since >= sent + EVERY {
                    sent = since;
                    let pose = Pose::translation(0.0, 0.0, WAVE.at(time)) * here;
                    let twist = Twist::new(0.0, 0.0, WAVE.velocity(time), 0.0, 0.0, 0.0);
                    // If this fails, the motion has ended, and returns its own error.
                    let _ = targets.send((pose, twist));
                }
                ControlFlow::Continue(())
            });
            read.await.map_err(Error::from)?;
            let _ = targets.send((here, Twist::zeros()));
            anyhow::Ok(behind)
        };
        let following = async {
            match arm.follow(followed).await {
                Ok(_) => Ok(()),
                Err(error) => Err(self.moving.explain(error).await),
            }
        };
        let (mut behind, ()) = tokio::try_join!(streaming, following)?;
        let mean = self.mean().await?;
        let report = self.end(arm).await?;
        behind.sort_by(f64::total_cmp);
        let quantile = |share: f64| behind[((behind.len() - 1) as f64 * share) as usize];
        let [p50, p95, most] = [0.5, 0.95, 1.0].map(quantile);
        let text = format!("{p50:.2} mm at the median, 95 % below {p95:.2}, {most:.2} at most");
        let figures = json!({ "p50_mm": p50, "p95_mm": p95, "max_mm": most });
        let verdict = Verdict::of(p95, BEHIND_MM);
        self.report.note("behind", verdict, text, figures)?;
        let (off, turn) = mean
            .pose()
            .map_or((f64::NAN, f64::NAN), |pose| apart(&pose, &here));
        let (off, turn) = (off * 1e3, turn * 1e3);
        let text = format!("{off:.2} mm and {turn:.2} mrad from the last target by O_T_EE");
        let figures = json!({ "translation_mm": off, "rotation_mrad": turn });
        let verdict = Verdict::of(off, ARRIVAL_MM);
        self.report.note("end", verdict, text, figures)?;
        self.timing(&report)
    }

    /// Measures how much the wrench has changed during the motions.
    async fn after(&mut self, tare: Option<WrenchTare>) -> anyhow::Result<()> {
        self.name("after the motions");
        let (Some(first), Some(second)) = (tare, self.tare().await?) else {
            return Ok(());
        };
        let left: [f64; 6] = std::array::from_fn(|i| second.wrench[i] - first.wrench[i]);
        let force = Vector3::from_column_slice(&left[..3]).norm();
        let text = format!("{force:.1} N remain with the earlier tare");
        let figures = json!({ "wrench": left });
        let verdict = Verdict::of(force, [LEFT, f64::INFINITY]);
        self.report.note("tare", verdict, text, figures)?;
        Ok(())
    }

    /// Checks the punctuality of states and commands.
    fn timing(&mut self, report: &MotionReport) -> anyhow::Result<()> {
        let us = |time: Duration| time.as_micros();
        let text = format!(
            "success rate {:.4}, {:.2} at worst; {} lost, {} skipped; turnaround {} us at worst",
            report.success_rate_avg,
            report.success_rate_min,
            report.lost_states,
            report.skipped_states,
            us(report.worst_turnaround),
        );
        let verdict = match report.success_rate_avg {
            rate if rate >= GOOD_RATE => Verdict::Good,
            rate if rate >= USABLE_RATE => Verdict::Look,
            _ => Verdict::Bad,
        };
        self.report.note("timing", verdict, text, json!(report))?;
        Ok(())
    }

    /// Begins a step in which the arm does not move.
    fn name(&mut self, name: &'static str) {
        say(name);
        self.report.begin(name);
    }

    /// Asks for permission for a step, and starts a session that holds the arm.
    async fn begin(&mut self, name: &'static str, what: &str) -> anyhow::Result<Arm> {
        self.report.begin(name);
        let what = format!("{what}\nforce {FORCE:.0} N at the hand at most");
        let asked = self.moving.ask(&format!("trial, {name}"), &what).await;
        asked.with_context(|| format!("trial, {name}"))?;
        let engage = Engage::default().speed(PACE).force_cap(FORCE);
        match self.moving.robot.engage(engage.speed_cap(FASTEST)).await {
            Ok(arm) => Ok(arm),
            Err(error) => Err(self.moving.explain(error).await),
        }
    }

    /// Ends the session and releases the arm.
    async fn end(&self, arm: Arm) -> anyhow::Result<MotionReport> {
        match arm.disengage().await {
            Ok(report) => Ok(report),
            Err(error) => Err(self.moving.explain(error).await),
        }
    }

    /// Returns the mean of the states over a short time.
    async fn mean(&self) -> anyhow::Result<Mean> {
        let (mut first, mut mean) = (None, Mean::default());
        let read = self.moving.robot.read(|state| {
            mean.push(state);
            let since = state.message_id - *first.get_or_insert(state.message_id);
            match since < MOMENT {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
        read.await.map_err(Error::from)?;
        Ok(mean)
    }

    /// Returns the joint positions after a turn of joint 7 towards the middle of its range.
    fn turned(&self, state: &RobotState) -> [f64; 7] {
        let limits = self.moving.robot.model().joint_limits();
        let middle = 0.5 * (limits.lower[6] + limits.upper[6]);
        let mut q = state.q;
        q[6] += TURN.copysign(middle - q[6]);
        q
    }
}

/// A series of targets that rise and fall, and that are at rest at both ends.
struct Wave {
    /// Half of the height, `[m]`.
    height: f64,
    /// Period, `[s]`.
    period: f64,
}

impl Wave {
    fn phase(&self, time: f64) -> f64 {
        core::f64::consts::TAU * time.min(self.period) / self.period
    }

    /// Returns the height above the start at `time`, `[m]`.
    fn at(&self, time: f64) -> f64 {
        self.height * (1.0 - self.phase(time).cos())
    }

    /// Returns the velocity at `time`, `[m/s]`.
    fn velocity(&self, time: f64) -> f64 {
        let pace = core::f64::consts::TAU / self.period;
        self.height * pace * self.phase(time).sin()
    }
}

/// Wave of the stream. Its speed is at most 16 mm/s, which is well below the motion's limit.
const WAVE: Wave = Wave {
    height: 0.015,
    period: 6.0,
};

/// Interval between two targets of the stream, `[ms]`.
const EVERY: u64 = 20;

/// Turn of joint 7, `[rad]`. It is 10 degrees.
const TURN: f64 = 0.1745;

/// Speed of any point of the arm at which a step ends, `[m/s]`. It is more than twice the commanded
/// speed.
const FASTEST: f64 = 0.2;

/// Duration of the observation before the arm moves. The drift is measured from the third to the
/// fourth second.
const LOOK: Duration = Duration::from_secs(4);

const HOLD: Duration = Duration::from_secs(10);

/// Period over which a position is averaged, `[ms]`.
const MOMENT: u64 = 200;

/// Limits of the drift of a held arm, for good and for bad, `[m]`. The driver aims at less than the
/// first limit.
const DRIFT: [f64; 2] = [5e-5, 1e-3];

/// Limits of the distance from a target, `[mm]`. The first is the error of the control law on arms
/// with stiction. The second ends the trial.
const ARRIVAL_MM: [f64; 2] = [1.0, 10.0];

/// Limits of the distance of a joint from its target, `[mrad]`.
const ARRIVAL_MRAD: [f64; 2] = [3.0, 30.0];

/// Limits of the distance from the targets of a stream, `[mm]`.
const BEHIND_MM: [f64; 2] = [4.0, 20.0];

/// Limit of the change of the force during the motions, `[N]`. Some force remains because the
/// stiction has changed.
const LEFT: f64 = 3.0;

/// Smallest mean success rate that counts as good, as in `franka test communication`. The next
/// constant is the rate that counts as usable.
const GOOD_RATE: f64 = 0.95;
const USABLE_RATE: f64 = 0.9;
