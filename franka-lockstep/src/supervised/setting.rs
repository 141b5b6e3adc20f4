//! Settings that a program sends to a supervised robot, one at a time.

use std::collections::{BTreeMap, VecDeque};

use franka_proto::{Request, RobotState, SetterStatus};
use franka_rt::supervision::{Answer, SettingId};

use super::Supervised;

/// Longest wait for an answer, as in `franka-async`, `[ms]`.
const ANSWER: u64 = 5000;

/// Number of states to wait until a state shows a setting, as in `franka-async`.
const SHOWN: u64 = 200;

/// Sends settings to the robot, and keeps the settings that are still to be sent.
#[derive(Debug, Default)]
pub(super) struct Sender {
    queue: VecDeque<Request>,
    /// True if the supervision requires all settings to be sent again.
    is_due: bool,
    sent: Option<Sent>,
    /// The valid setting of each kind: the newest setting that the robot has not refused.
    wanted: BTreeMap<&'static str, Request>,
}

#[derive(Debug)]
struct Sent {
    id: SettingId,
    request: Request,
    /// True if the program sends the setting, false if the supervision sends it again.
    is_program: bool,
    /// Time at which the setting was sent, `[ms]`.
    at: u64,
    /// `message_id` of the newest state when the robot accepted the setting.
    taken: Option<u64>,
}

/// True if a state shows the setting, or if states never show settings of this kind.
pub fn shows(request: &Request, state: &RobotState) -> bool {
    match request {
        Request::SetLoad(load) => (state.m_load - load.m_load).abs() < 1e-5,
        Request::SetNEToEE(frame) => (state.NE_T_EE[14] - frame[14]).abs() < 1e-5,
        Request::SetEEToK(frame) => (state.EE_T_K[14] - frame[14]).abs() < 1e-5,
        _ => true,
    }
}

impl Supervised {
    /// Sends a setting, once the previous setting has been answered.
    pub fn set(&mut self, request: Request) {
        self.sender.queue.push_back(request);
        self.send_settings();
    }

    /// True if a setting of the program has no answer yet.
    pub fn is_setting(&self) -> bool {
        let sent = self.sender.sent.as_ref();
        !self.sender.queue.is_empty() || sent.is_some_and(|sent| sent.is_program)
    }

    pub(super) fn configure(&mut self) {
        self.sender.is_due = true;
    }

    /// Passes on the answer to the current setting, and sends the next settings.
    pub(super) fn send_settings(&mut self) {
        if let Some(sent) = self.sender.sent.take() {
            match self.answer_to(&sent) {
                Some(answer) => self.answered(sent, answer),
                None => {
                    let status = self.lockstep.client.setting.take();
                    let taken = status.map(|_| self.state().message_id);
                    self.sender.sent = Some(Sent {
                        taken: taken.or(sent.taken),
                        ..sent
                    });
                }
            }
        }
        while self.sender.sent.is_none() && self.send_next() {}
    }

    /// Returns the final answer to a setting: refused, shown by a state, not shown in time, or
    /// unknown.
    fn answer_to(&self, sent: &Sent) -> Option<Answer> {
        let text = String::new();
        if !self.is_up_or_silent() {
            return Some(Answer::Unknown { text });
        }
        let status = self.lockstep.client.setting;
        if let Some(status) = status.filter(|status| *status != SetterStatus::Success) {
            let text = format!("{status:?}");
            return Some(Answer::Refused { text });
        }
        let state = self.state();
        match sent.taken {
            None if self.now() >= sent.at + ANSWER => Some(Answer::Unknown { text }),
            None => None,
            Some(_) if shows(&sent.request, state) => Some(Answer::Taken),
            Some(taken) if state.message_id > taken + SHOWN => Some(Answer::NotShown { text }),
            Some(_) => None,
        }
    }

    fn answered(&mut self, sent: Sent, answer: Answer) {
        self.lockstep.client.setting = None;
        if sent.is_program {
            let now = self.time();
            self.supervision.on_set(sent.id, &answer, now);
            if !matches!(answer, Answer::Refused { .. }) {
                let name = sent.request.command().display_name();
                self.sender.wanted.insert(name, sent.request);
            }
            self.answers.push((sent.request, answer));
        } else if self.is_up_or_silent() {
            self.supervision.on_set_again(sent.id, answer);
        }
        self.carry_out();
    }

    /// Sends the next setting, if any. Returns true if another setting may follow immediately.
    fn send_next(&mut self) -> bool {
        let now = self.time();
        let is_program = !self.sender.queue.is_empty();
        let next = match self.sender.queue.pop_front() {
            Some(request) => Some((self.supervision.declare(request), request)),
            None if self.sender.is_due => self.supervision.next_setting(now),
            None => return false,
        };
        self.sender.is_due &= next.is_some();
        // The supervision may request the setting again.
        self.carry_out();
        let Some((id, request)) = next else {
            return self.sender.is_due;
        };
        let sent = Sent {
            id,
            request,
            is_program,
            at: self.now(),
            taken: None,
        };
        if !self.is_up_or_silent() {
            let text = String::from("no connection");
            self.answered(sent, Answer::Unknown { text });
            return true;
        }
        self.lockstep.request(&request);
        self.sender.sent = Some(sent);
        false
    }

    /// Ends the command connection after the robot has received the setting, and before the client
    /// receives the answer.
    pub fn lose_answers(&mut self) {
        while let Some(bytes) = self.lockstep.client.take_message() {
            let received = self.lockstep.robot.receive(&bytes);
            received.expect("the client's messages are well-formed");
        }
        self.mend(true);
    }

    /// Stops all answers of the robot until the client connects again.
    pub fn lose_replies(&mut self) {
        self.lockstep.link.replies = false;
    }

    /// Checks that the robot has all settings of the program, except a setting in transit.
    pub(super) fn check_settings(&mut self) {
        let with_robot = self.sender.sent.as_ref().map(|sent| sent.request.command());
        let state = self.lockstep.robot.state();
        for request in self.sender.wanted.values() {
            assert!(
                shows(request, state) || with_robot == Some(request.command()),
                "a motion begins without {request:?}"
            );
        }
    }
}
