//! Checks of the state of a robot that is at rest.

use franka_proto::{RobotMode, RobotState};

use crate::finding::{About, Finding, Judged, Needs, Purpose};

/// Returns the findings about a state of the robot: `robot.mode`, `robot.errors` and `robot.load`.
/// `has_hand` is true if a Hand also answers. This function performs no I/O.
///
/// The collision thresholds are not checked, because a state does not contain them.
pub fn at_rest(state: &RobotState, has_hand: bool, purpose: Purpose) -> Vec<Finding> {
    let mode_wanted = About::robot(
        "robot.mode",
        "idle",
        "A robot accepts motions only at rest, with open brakes and the user stop released.",
        "vendor: FCI documentation, robot modes",
    );
    let errors_wanted = About::robot(
        "robot.errors",
        "none",
        "A robot that has stopped itself refuses motions until it is recovered.",
        "vendor: FCI documentation, errors",
    );
    let load_wanted = About::robot(
        "robot.load",
        "the declared mass matches the mounted end effector: 0.73 kg for a Franka Hand",
        "The robot compensates the declared weight. A wrong weight pulls the arm and appears as \
         an external force.",
        "vendor: FCI documentation, end effector; 0.73 kg: Desk's own value for the Hand",
    );
    vec![
        mode_wanted.finding(Ok(mode(state)), purpose),
        errors_wanted.finding(Ok(errors(state)), purpose),
        load_wanted.finding(Ok(load(state, has_hand)), purpose),
    ]
}

fn mode(state: &RobotState) -> Judged {
    match state.robot_mode {
        RobotMode::Idle => Judged::good("idle"),
        RobotMode::Move => Judged::info("in motion, started by another program"),
        RobotMode::Guiding => Judged::info("guided by hand"),
        RobotMode::AutomaticErrorRecovery => Judged::info("being recovered"),
        RobotMode::Reflex => {
            Judged::warning("the robot has stopped itself").fix(Needs::Nothing, "franka recover")
        }
        RobotMode::UserStopped => {
            Judged::warning("the user stop is pressed, or a safety function is active")
        }
        RobotMode::Other => Judged::warning(
            "not ready: the brakes are closed, or the robot is \
            starting",
        ),
    }
}

fn errors(state: &RobotState) -> Judged {
    match (state.errors.is_empty(), state.reflex_reason.is_empty()) {
        (false, _) => {
            Judged::warning(state.errors.to_string()).fix(Needs::Nothing, "franka recover")
        }
        (true, false) => Judged::info(format!(
            "none now; the last motion ended by {}",
            state.reflex_reason
        )),
        (true, true) => Judged::good("none"),
    }
}

fn load(state: &RobotState, has_hand: bool) -> Judged {
    let read = format!(
        "end effector {:.3} kg, load {:.3} kg",
        state.m_ee, state.m_load
    );
    match (state.m_ee + state.m_load > 0.0, has_hand) {
        (true, _) => Judged::good(read),
        (false, true) => Judged::warning(format!(
            "{read}, but a Hand answers: choose it as the end effector in Desk"
        )),
        (false, false) => Judged::info(format!("{read}: right if nothing is mounted")),
    }
}

#[cfg(test)]
mod tests {
    use franka_proto::{Errors, RobotError};

    use super::*;
    use crate::finding::Verdict;

    #[test]
    fn a_state_shows_what_keeps_the_robot_from_a_motion() {
        use Verdict::{Good, Info, Warning};
        let idle = RobotState {
            robot_mode: RobotMode::Idle,
            m_ee: 0.73,
            ..RobotState::default()
        };
        let reflex = Errors::from(RobotError::CartesianReflex);
        for (state, hand, expected) in [
            (idle, true, [Good, Good, Good]),
            (
                RobotState {
                    robot_mode: RobotMode::Reflex,
                    errors: reflex,
                    ..idle
                },
                true,
                [Warning, Warning, Good],
            ),
            (
                RobotState {
                    robot_mode: RobotMode::UserStopped,
                    reflex_reason: reflex,
                    m_ee: 0.0,
                    ..idle
                },
                true,
                [Warning, Info, Warning],
            ),
            (RobotState { m_ee: 0.0, ..idle }, false, [Good, Good, Info]),
            (
                RobotState {
                    m_ee: 0.0,
                    m_load: 0.5,
                    ..idle
                },
                true,
                [Good, Good, Good],
            ),
        ] {
            let findings = at_rest(&state, hand, Purpose::Move);
            let verdicts: Vec<Verdict> = findings.iter().map(|found| found.verdict).collect();
            assert_eq!(verdicts, expected, "{findings:?}");
        }
    }
}
