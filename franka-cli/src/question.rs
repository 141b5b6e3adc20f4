//! Describes a motion before it begins, and asks for consent.

use std::io::{self, BufRead, IsTerminal, Write};

use franka_async::goal::Budget;
use franka_async::model::{EndEffector, RobotKind, inverse_kinematics};
use franka_async::nalgebra::Vector3;
use franka_async::{Pose, Robot};
use tokio::sync::oneshot;

use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::output::{BOLD, numbers, say};

/// Shows what will happen, and asks for consent. If `yes` is true, the user has already given
/// consent.
pub(crate) async fn ask(what: &str, yes: bool) -> anyhow::Result<()> {
    say(what);
    if yes {
        return Ok(());
    }
    if !(io::stdin().is_terminal() && io::stderr().is_terminal()) {
        let failure = Failure::new(
            Ending::NotConfirmed,
            "cannot ask for confirmation: the program has no terminal. Nothing has moved.",
        );
        return Err(failure
            .advice("In scripts, --yes agrees in advance.")
            .into());
    }
    let interrupt = interrupted()?;
    let mut terminal = anstream::stderr();
    write!(
        terminal,
        "Clear the path of the arm, and keep the user stop within reach. {BOLD}Continue? [y/N]{BOLD:#} "
    )?;
    terminal.flush()?;
    // A separate thread reads the answer. It is abandoned after Ctrl-C.
    let (answer, answered) = oneshot::channel();
    std::thread::spawn(move || {
        let mut line = String::new();
        let read = io::stdin().lock().read_line(&mut line);
        // The send fails after Ctrl-C, which is not an error.
        let _ = answer.send(read.map(|_| line));
    });
    tokio::select! {
        line = answered => match line??.trim() {
            "y" | "Y" | "yes" => Ok(()),
            _ => Err(Failure::new(Ending::NotConfirmed, "not confirmed. Nothing has moved since the question.").into()),
        },
        by = interrupt => {
            say("");
            Err(by.failure("interrupted. Nothing has moved since the question.").into())
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Target {
    Joints([f64; 7]),
    Pose(Pose),
}

impl Target {
    /// Describes the motion to this target: the displacement of each joint and of the hand, and the
    /// largest speed.
    pub(crate) fn describe(&self, robot: &Robot, speed: f64) -> anyhow::Result<String> {
        let (state, start) = (robot.state(), robot.pose());
        let model = robot.model();
        let budget = Budget::of(model.joint_limits()).at_speed(speed, model);
        let budget = budget.map_err(|error| Failure::usage(error.to_string()))?;
        let limits = model.joint_limits();
        let (way, q, end, pace) = match self {
            Self::Joints(q) => {
                for (i, &to) in q.iter().enumerate() {
                    let (lower, upper) = (limits.lower[i], limits.upper[i]);
                    if !(lower..=upper).contains(&to) {
                        let message = format!(
                            "the target of joint {} is {to:.4} rad, expected {lower:.4} to \
                             {upper:.4} rad",
                            i + 1
                        );
                        return Err(Failure::new(Ending::Failed, message).into());
                    }
                }
                let fastest = budget.joints.map(|axis| axis.velocity.to_degrees());
                let fastest = fastest.into_iter().fold(0.0, f64::max);
                let pace = format!("{fastest:.0} deg/s for each joint");
                ("all joints at the same time", *q, robot.pose_at(*q), pace)
            }
            Self::Pose(pose) => {
                let seed = state.q.into();
                let q = inverse_kinematics::solve(
                    model,
                    pose,
                    &EndEffector::from_arrays(&state.F_T_EE, &state.EE_T_K),
                    &seed,
                );
                let q = q.map_err(|error| {
                    let message = format!("the arm cannot reach the target: {error}");
                    Failure::new(Ending::Failed, message)
                })?;
                let pace = format!(
                    "{:.0} mm/s and {:.0} deg/s for the hand",
                    budget.translation.velocity * 1e3,
                    budget.rotation.velocity.to_degrees()
                );
                ("the hand in a straight line", q.into(), *pose, pace)
            }
        };
        let degrees = |q: [f64; 7]| numbers(&q.map(f64::to_degrees), 1);
        let by = std::array::from_fn(|i| q[i] - state.q[i]);
        let shift: Vector3<f64> = end.translation.vector - start.translation.vector;
        let turn = start.rotation.angle_to(&end.rotation).to_degrees();
        let about = match self {
            Self::Joints(_) => "deg",
            Self::Pose(_) => "deg, about",
        };
        let joints: String = (1..=7).map(|joint| format!("{joint:>7}")).collect();
        let [x, y, z] = [shift.x, shift.y, shift.z].map(|metres| (metres * 1e3).round() + 0.0);
        Ok(format!(
            "The arm moves {way}.\n\
             joint {joints}\nfrom  {}  deg\nto    {}  {about}\nby    {}  {about}\n\
             hand  {:.0} mm away (x {x:+}, y {y:+}, z {z:+}), rotated by {turn:.0} deg\n\
             speed at most {pace}",
            degrees(state.q),
            degrees(q),
            degrees(by),
            shift.norm() * 1e3,
        ))
    }
}

pub(crate) fn title(what: &str, kind: RobotKind, place: &impl std::fmt::Display) -> String {
    let kind = crate::connection::kind_name(kind);
    format!("{BOLD}{what}: {kind}, {place}{BOLD:#}")
}
