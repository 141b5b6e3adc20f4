//! Settings that this program has made on the robot, and that every connection should have.

use franka_proto::{Command, Request};

/// Result of a setting that was sent to the robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The robot has accepted the setting. If states contain the value, they show it.
    Taken,
    /// The robot has accepted the setting, but its states show a different value.
    NotShown {
        /// Description of the values shown and set, for a person.
        text: String,
    },
    /// The robot has refused the setting, or it was not sent. The earlier value stays in effect.
    Refused {
        /// Description of the robot's answer and the value set, for a person.
        text: String,
    },
    /// There was no answer. The robot may have accepted the setting.
    Unknown {
        /// Description of the missing answer, for a person.
        text: String,
    },
}

/// Identifies a setting. [`Supervision::declare`](super::Supervision::declare) returns it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SettingId(u64);

/// The newest setting of each kind, in the order in which they were made.
#[derive(Debug, Default)]
pub(super) struct Settings {
    newest: Vec<Setting>,
    count: u64,
}

#[derive(Debug)]
struct Setting {
    id: SettingId,
    request: Request,
    /// Number of the connection over which the program sent the setting.
    connection: u64,
    standing: Standing,
    /// True if states have shown the setting.
    was_shown: bool,
    /// The earlier setting of this kind, until the robot has answered. It is used again if the
    /// robot refuses this setting.
    before: Option<Box<Setting>>,
}

/// State of a setting on the newest connection.
#[derive(Debug)]
enum Standing {
    /// The program has sent the setting, and there is no answer yet.
    Sent,
    /// It is unknown if the robot has the setting.
    Open,
    Holds,
    /// The setting could not be restored, for this reason.
    Failed {
        text: String,
    },
}

impl Settings {
    pub(super) fn is_empty(&self) -> bool {
        self.newest.is_empty()
    }

    pub(super) fn all_hold(&self) -> bool {
        let holds = |setting: &Setting| matches!(setting.standing, Standing::Holds);
        self.newest.iter().all(holds)
    }

    pub(super) fn any_open(&self) -> bool {
        self.next().is_some()
    }

    /// True if the program waits for an answer. Until the answer arrives, it is unknown which value
    /// is in effect.
    pub(super) fn any_sent(&self) -> bool {
        let is_sent = |setting: &Setting| matches!(setting.standing, Standing::Sent);
        self.newest.iter().any(is_sent)
    }

    /// Records a setting that the program is about to send over the connection with this number.
    /// The setting is kept unless the robot refuses it.
    pub(super) fn declare(&mut self, request: Request, connection: u64) -> SettingId {
        let is_same = |setting: &Setting| setting.request.command() == request.command();
        let before = self.newest.iter().position(is_same);
        let before = before.map(|place| Box::new(self.newest.remove(place)));
        self.count += 1;
        let id = SettingId(self.count);
        self.newest.push(Setting {
            id,
            request,
            connection,
            standing: Standing::Sent,
            was_shown: false,
            before,
        });
        id
    }

    /// Processes the answer to a setting that the program has sent. `connection` is the number of
    /// the newest connection.
    pub(super) fn on_answer(&mut self, id: SettingId, answer: &Answer, connection: u64) {
        if let Answer::Refused { .. } = answer {
            return self.remove(id);
        }
        let Some(setting) = self.find(id) else {
            return;
        };
        setting.before = None;
        if let Answer::Taken | Answer::NotShown { .. } = answer {
            setting.was_shown = *answer == Answer::Taken;
            if setting.connection == connection {
                setting.standing = Standing::Holds;
            }
        }
        if let Standing::Sent = setting.standing {
            setting.standing = Standing::Open;
        }
    }

    /// Processes the answer to a setting that [`Self::next`] returned.
    pub(super) fn on_answer_again(&mut self, id: SettingId, answer: Answer) {
        let Some(setting) = self.find(id) else {
            return;
        };
        setting.standing = match answer {
            // If a robot rounds numbers, its states never show exactly the number that was set.
            Answer::NotShown { .. } if !setting.was_shown => Standing::Holds,
            Answer::Taken => {
                setting.was_shown = true;
                Standing::Holds
            }
            Answer::NotShown { text } | Answer::Refused { text } | Answer::Unknown { text } => {
                Standing::Failed { text }
            }
        };
    }

    pub(super) fn next(&self) -> Option<(SettingId, Request)> {
        let is_open = |setting: &&Setting| matches!(setting.standing, Standing::Open);
        let open = self.newest.iter().find(is_open)?;
        Some((open.id, open.request))
    }

    pub(super) fn failures(&self) -> impl Iterator<Item = (Command, &String)> {
        self.newest
            .iter()
            .filter_map(|setting| match &setting.standing {
                Standing::Failed { text } => Some((setting.request.command(), text)),
                _ => None,
            })
    }

    /// Requests another attempt for the failed settings.
    pub(super) fn retry(&mut self) {
        for setting in &mut self.newest {
            if let Standing::Failed { .. } = setting.standing {
                setting.standing = Standing::Open;
            }
        }
    }

    /// Processes a new connection, on which no setting has been made.
    pub(super) fn on_connected(&mut self) {
        for newest in &mut self.newest {
            let mut setting = Some(newest);
            while let Some(it) = setting {
                it.standing = Standing::Open;
                setting = it.before.as_deref_mut();
            }
        }
    }

    fn find(&mut self, id: SettingId) -> Option<&mut Setting> {
        self.newest.iter_mut().find_map(|newest| {
            let mut setting = newest;
            while setting.id != id {
                setting = setting.before.as_deref_mut()?;
            }
            Some(setting)
        })
    }

    /// Removes a setting, so that the earlier setting is used again.
    fn remove(&mut self, id: SettingId) {
        if let Some(place) = self.newest.iter().position(|newest| newest.id == id) {
            match self.newest[place].before.take() {
                Some(before) => self.newest[place] = *before,
                None => drop(self.newest.remove(place)),
            }
            return;
        }
        for newest in &mut self.newest {
            let mut link = &mut newest.before;
            while link.as_ref().is_some_and(|setting| setting.id != id) {
                link = &mut link.as_mut().expect("it was looked at").before;
            }
            if let Some(setting) = link {
                *link = setting.before.take();
            }
        }
    }
}
