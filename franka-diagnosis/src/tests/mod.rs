//! Diagnoses of logs that each contain one problem.

mod arm;
mod commander;
mod commands;
mod finishing;
mod lost_cycles;
mod nothing;

use franka_model::{EndEffector, Frame, JointVector, Model, READY, layout};
use franka_proto::{
    ControllerMode, Errors, MotionGeneratorMode, RobotCommand, RobotError, RobotMode, RobotState,
};

use super::evidence::Evidence;
use super::{Commander, Diagnosis, Finding};
use franka_rt::driver::LogEntry;
use franka_rt::stats::MotionStatistics;

/// A log under construction: a state, then pairs of a command and the state after it.
struct Story {
    commander: Commander,
    model: &'static Model,
    entries: Vec<LogEntry>,
}

/// `message_id` of the first state.
const BEGIN: u64 = 1000;

impl Story {
    /// A motion with this generator from the ready pose, after its first command.
    fn of(model: &'static Model, generator: MotionGeneratorMode) -> Self {
        let mut story = Self::unbegun(model, generator);
        story.go(|_, _| {}, |_| {});
        story
    }

    /// A story whose first state has not been answered.
    fn unbegun(model: &'static Model, generator: MotionGeneratorMode) -> Self {
        let pose = model.pose(Frame::EndEffector, &READY, &EndEffector::default());
        let state = RobotState {
            message_id: BEGIN,
            q: READY.into(),
            q_d: READY.into(),
            O_T_EE: layout::pose(&pose),
            O_T_EE_d: layout::pose(&pose),
            O_T_EE_c: layout::pose(&pose),
            elbow_c: [READY[2], -1.0],
            motion_generator_mode: generator,
            controller_mode: ControllerMode::ExternalController,
            robot_mode: RobotMode::Move,
            control_command_success_rate: 1.0,
            ..RobotState::default()
        };
        let entry = LogEntry::new(state, RobotCommand::default());
        Self {
            commander: Commander::Function,
            model,
            entries: vec![entry],
        }
    }

    /// Returns the same story under another commander.
    fn by(self, commander: Commander) -> Self {
        Self { commander, ..self }
    }

    fn newest(&self) -> &RobotState {
        &self.entries.last().expect("never empty").state
    }

    /// Adds one cycle: the command that answers the newest state, and the next state. The command
    /// is at rest unless `ask` changes it; `then` changes the state. The values that a robot
    /// repeats from the command are filled in.
    fn go(
        &mut self,
        ask: impl FnOnce(&RobotState, &mut RobotCommand),
        then: impl FnOnce(&mut RobotState),
    ) {
        let before = *self.newest();
        let mut command = RobotCommand {
            message_id: before.message_id,
            q_c: before.q_d,
            O_T_EE_c: before.O_T_EE_c,
            tau_J_d: before.tau_J_d,
            ..RobotCommand::default()
        };
        ask(&before, &mut command);
        let mut state = before;
        state.message_id += 1;
        state.tau_J_d = command.tau_J_d;
        state.O_T_EE_c = command.O_T_EE_c;
        match before.motion_generator_mode {
            MotionGeneratorMode::JointPosition => {
                let q = JointVector::from(command.q_c);
                let dq = (q - JointVector::from(before.q_d)) / 1e-3;
                state.q_d = command.q_c;
                state.ddq_d = ((dq - JointVector::from(before.dq_d)) / 1e-3).into();
                state.dq_d = dq.into();
            }
            MotionGeneratorMode::JointVelocity => {
                let dq = JointVector::from(command.dq_c);
                state.q_d = (JointVector::from(before.q_d) + dq * 1e-3).into();
                state.ddq_d = ((dq - JointVector::from(before.dq_d)) / 1e-3).into();
                state.dq_d = command.dq_c;
            }
            _ => {}
        }
        then(&mut state);
        self.entries.push(LogEntry::new(state, command));
    }

    /// Adds a last cycle, in which the robot stops with these errors.
    fn stop(
        self,
        errors: &[RobotError],
        ask: impl FnOnce(&RobotState, &mut RobotCommand),
        then: impl FnOnce(&mut RobotState),
    ) -> Diagnosis {
        self.stop_counted(None, errors, ask, then)
    }

    /// Adds a last cycle, with the counts of the motion.
    fn stop_counted(
        mut self,
        statistics: Option<&MotionStatistics>,
        errors: &[RobotError],
        ask: impl FnOnce(&RobotState, &mut RobotCommand),
        then: impl FnOnce(&mut RobotState),
    ) -> Diagnosis {
        let errors: Errors = errors.iter().copied().collect();
        let before = *self.newest();
        self.go(ask, |state| {
            // The robot does not apply a command that violates a limit.
            *state = RobotState {
                message_id: state.message_id,
                ..before
            };
            state.motion_generator_mode = MotionGeneratorMode::Idle;
            state.controller_mode = ControllerMode::Other;
            state.robot_mode = RobotMode::Reflex;
            state.control_command_success_rate = 0.0;
            state.errors = errors;
            state.reflex_reason = errors;
            then(state);
        });
        let diagnosis = self.diagnosis(errors, statistics);
        let text = diagnosis.to_string();
        println!("{text}\n");
        assert!(text.lines().count() <= 6, "{text}");
        diagnosis
    }

    fn diagnosis(&self, errors: Errors, statistics: Option<&MotionStatistics>) -> Diagnosis {
        let evidence = Evidence {
            commander: self.commander,
            entries: self.entries.iter().collect(),
            model: self.model,
            statistics,
            rounded: false,
        };
        Diagnosis::of_evidence(errors, &evidence)
    }
}

fn finding(diagnosis: &Diagnosis) -> Finding {
    diagnosis.finding.expect("it is visible")
}
