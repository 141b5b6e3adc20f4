//! Events of one robot, and the permitted sequences of them.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use franka_rt::supervision::{Event, EventKind};

/// Events of a robot so far.
#[derive(Debug, Default)]
pub(super) struct Chronicle {
    at: Duration,
    is_connected: bool,
    was_connected: bool,
    is_silent: bool,
    is_pressed: bool,
    is_guided: bool,
    is_braked: bool,
    /// The reflex that holds the robot.
    reflex: Option<u64>,
    reflexes: u64,
    motions: BTreeSet<u64>,
    /// The whole text.
    pub(super) text: String,
    /// Number of events of each kind.
    pub(super) counts: BTreeMap<&'static str, u64>,
}

impl Chronicle {
    /// Processes the next event.
    ///
    /// # Panics
    /// If it cannot follow on those before it.
    pub(super) fn take(&mut self, event: &Event) {
        assert!(event.at >= self.at, "{event:?} after {:?}", self.at);
        self.at = event.at;
        let name = self.follow(&event.kind);
        assert_eq!(
            event.robot_time.is_some(),
            self.is_connected,
            "only a robot that is connected has a time: {event:?}"
        );
        *self.counts.entry(name).or_default() += 1;
        let line = format!("{:?} {name}\n", event.at);
        self.text.push_str(&line);
    }

    fn follow(&mut self, kind: &EventKind) -> &'static str {
        match kind {
            EventKind::Connected { attempts, after } => {
                assert!(!self.is_connected && *attempts > 0);
                assert_eq!(after.is_some(), self.was_connected);
                (self.is_connected, self.was_connected) = (true, true);
                "connected"
            }
            EventKind::Unrecognised { differences } => {
                assert!(self.is_connected && !differences.is_empty());
                "unrecognised"
            }
            EventKind::Lost { .. } => {
                assert!(self.is_connected);
                self.is_connected = false;
                self.is_silent = false;
                (self.is_pressed, self.is_guided, self.is_braked) = (false, false, false);
                self.reflex = None;
                "lost"
            }
            EventKind::Silent { .. } => {
                assert!(self.is_connected && !self.is_silent);
                self.is_silent = true;
                "silent"
            }
            EventKind::Resumed { .. } => {
                assert!(self.is_connected && self.is_silent);
                self.is_silent = false;
                "resumed"
            }
            EventKind::Reflex(reflex) => {
                assert!(self.is_connected && !reflex.errors.is_empty());
                assert_eq!(reflex.number, self.reflexes + 1, "they are counted");
                self.reflexes = reflex.number;
                self.reflex = Some(reflex.number);
                "reflex"
            }
            EventKind::NotRecovered { reflex, .. } => {
                assert_eq!(Some(*reflex), self.reflex);
                "not recovered"
            }
            EventKind::Recovered { reflex, .. } => {
                assert_eq!(Some(*reflex), self.reflex);
                self.reflex = None;
                "recovered"
            }
            EventKind::UserStop { pressed } => {
                assert!(self.is_connected);
                assert_ne!(std::mem::replace(&mut self.is_pressed, *pressed), *pressed);
                if *pressed {
                    "stop pressed"
                } else {
                    "stop released"
                }
            }
            EventKind::Guiding { active } => {
                assert!(self.is_connected);
                assert_ne!(std::mem::replace(&mut self.is_guided, *active), *active);
                if *active { "guiding" } else { "let go" }
            }
            EventKind::Brakes { closed } => {
                assert!(self.is_connected);
                assert_ne!(std::mem::replace(&mut self.is_braked, *closed), *closed);
                if *closed {
                    "brakes closed"
                } else {
                    "brakes opened"
                }
            }
            EventKind::LoadChanged { .. } => {
                assert!(self.is_connected);
                "load changed"
            }
            EventKind::NotConfigured { .. } => {
                assert!(self.is_connected);
                "not configured"
            }
            EventKind::MotionBegun { goal } => {
                assert!(self.motions.insert(*goal));
                "motion begun"
            }
            EventKind::MotionEnded { goal, .. } => {
                assert!(self.motions.remove(goal));
                "motion ended"
            }
            other => panic!("nothing here causes {other:?}"),
        }
    }

    /// True if every motion that began has ended.
    pub(super) fn is_complete(&self) -> bool {
        self.motions.is_empty()
    }
}
