//! Episodes of a recording, and samples of their cycles for exports and replays.

use core::fmt;

use franka_proto::gripper;

use crate::cycle::{Cycle, HostTime};
use crate::event::{Event, EventKind, GripperState};
use crate::sample::Sample;

/// An attempt at a task: the part of a recording between two marks.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Episode {
    /// Name of the episode.
    pub name: String,
    /// Description of the task.
    pub task: String,
    /// True if the task succeeded, false if it failed; `None` if the attempt was not judged.
    pub success: Option<bool>,
    /// Time of the beginning.
    pub begin: HostTime,
    /// Time of the end.
    pub end: HostTime,
}

/// Reason why a name or a task is invalid, or why an episode was not found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EpisodeError {
    /// The name is invalid.
    #[error(
        "got the episode name {got:?}, expected 1 to {} letters, digits, '-' and '_'",
        Episode::NAME_MAX
    )]
    Name {
        /// The given name.
        got: String,
    },
    /// The task is empty.
    #[error("episode {name:?} has an empty task, expected a description of the task in words")]
    Task {
        /// Name of the episode.
        name: String,
    },
    /// No episode has this name.
    #[error("got the episode {got:?}, expected one of {known}")]
    Unknown {
        /// The given name.
        got: String,
        /// The names of the existing episodes.
        known: String,
    },
}

impl Episode {
    /// Largest number of characters in an episode's name.
    pub const NAME_MAX: usize = 128;

    /// Checks the name and the task of a new episode. The name must be valid as part of a file
    /// name, and the task must not be empty.
    ///
    /// # Errors
    /// Returns an [`EpisodeError`] if the name or the task is invalid. The error states the given
    /// value and the expected value.
    pub fn check(name: &str, task: &str) -> Result<(), EpisodeError> {
        let fits = |letter: char| letter.is_ascii_alphanumeric() || "-_".contains(letter);
        if !(1..=Self::NAME_MAX).contains(&name.len()) || !name.chars().all(fits) {
            let got = name.to_owned();
            return Err(EpisodeError::Name { got });
        }
        if task.trim().is_empty() {
            let name = name.to_owned();
            return Err(EpisodeError::Task { name });
        }
        Ok(())
    }

    /// Returns the episodes that `events` mark, in the order of the events. Episodes without an end
    /// are omitted. An episode has no end if the recording ends during it, or if the next episode
    /// begins first.
    ///
    /// # Errors
    /// Returns the error of the first event that cannot be read.
    pub fn of<E>(events: impl IntoIterator<Item = Result<Event, E>>) -> Result<Vec<Self>, E> {
        let mut episodes = Vec::new();
        let mut begun = None;
        for event in events {
            let Event { time, kind, .. } = event?;
            match kind {
                EventKind::EpisodeStart { name, task } => begun = Some((time, name, task)),
                EventKind::EpisodeEnd { success } => {
                    episodes.extend(begun.take().map(|(begin, name, task)| Self {
                        name,
                        task,
                        success,
                        begin,
                        end: time,
                    }));
                }
                _ => {}
            }
        }
        Ok(episodes)
    }

    /// Returns the episodes of `all` whose names are in `names`, in the order of `all`.
    ///
    /// # Errors
    /// Returns [`EpisodeError::Unknown`] if no episode has one of the names.
    pub fn named(all: Vec<Self>, names: &[String]) -> Result<Vec<Self>, EpisodeError> {
        let is_there = |name: &String| all.iter().any(|episode| episode.name == *name);
        if let Some(unknown) = names.iter().find(|name| !is_there(name)) {
            let known: Vec<_> = all.iter().map(|episode| episode.name.as_str()).collect();
            return Err(EpisodeError::Unknown {
                got: unknown.clone(),
                known: known.join(", "),
            });
        }
        let is_wanted = |episode: &Self| names.contains(&episode.name);
        Ok(all.into_iter().filter(is_wanted).collect())
    }
}

/// Iterator over the samples of cycles. Each sample contains the gripper's most recent width.
///
/// Both inputs must be sorted by time. Vacuum grippers have no width.
pub struct Samples<C, G: Iterator> {
    cycles: C,
    gripper: core::iter::Peekable<G>,
    width: Option<f64>,
}

impl<C, G, E> Samples<C, G>
where
    C: Iterator<Item = Result<Cycle, E>>,
    G: Iterator<Item = Result<(HostTime, GripperState), E>>,
{
    /// Creates an iterator over the samples of these cycles and gripper states.
    pub fn new(
        cycles: impl IntoIterator<IntoIter = C>,
        gripper: impl IntoIterator<IntoIter = G>,
    ) -> Self {
        Self {
            cycles: cycles.into_iter(),
            gripper: gripper.into_iter().peekable(),
            width: None,
        }
    }
}

impl<C, G: Iterator> fmt::Debug for Samples<C, G> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Samples")
            .field("width", &self.width)
            .finish_non_exhaustive()
    }
}

impl<C, G, E> Iterator for Samples<C, G>
where
    C: Iterator<Item = Result<Cycle, E>>,
    G: Iterator<Item = Result<(HostTime, GripperState), E>>,
{
    type Item = Result<Sample, E>;

    fn next(&mut self) -> Option<Self::Item> {
        let cycle = match self.cycles.next()? {
            Ok(cycle) => cycle,
            Err(error) => return Some(Err(error)),
        };
        let is_due = |state: &G::Item| match state {
            Ok((time, _)) => *time <= cycle.time,
            Err(_) => true,
        };
        while let Some(state) = self.gripper.next_if(is_due) {
            match state {
                Ok((_, GripperState::Hand(gripper::State { width, .. }))) => {
                    self.width = Some(width);
                }
                Ok((_, GripperState::Vacuum(_))) => {}
                Err(error) => return Some(Err(error)),
            }
        }
        Some(Ok(Sample {
            width: self.width,
            ..Sample::of(&cycle)
        }))
    }
}

#[cfg(test)]
mod tests {
    use core::convert::Infallible;

    use super::*;

    const fn at(second: u64) -> HostTime {
        HostTime::from_nanos(second * 1_000_000_000)
    }

    fn mark(second: u64, kind: EventKind) -> Result<Event, Infallible> {
        Ok(Event {
            time: at(second),
            robot_time: 0,
            kind,
        })
    }

    fn start(second: u64, name: &str) -> Result<Event, Infallible> {
        let (name, task) = (name.to_owned(), format!("do {name}"));
        mark(second, EventKind::EpisodeStart { name, task })
    }

    #[test]
    fn episodes_lie_between_marks_and_have_an_end() {
        let end = |second, success| mark(second, EventKind::EpisodeEnd { success });
        let events = [
            end(1, Some(true)),
            start(2, "one"),
            mark(3, EventKind::Dropped { cycles: 1 }),
            end(4, Some(true)),
            start(5, "given-up"),
            start(6, "two"),
            end(7, None),
            start(8, "open"),
        ];
        let Ok(episodes) = Episode::of(events);
        let told: Vec<_> = episodes
            .iter()
            .map(|it| (&*it.name, &*it.task, it.success, it.begin, it.end))
            .collect();
        assert_eq!(
            told,
            [
                ("one", "do one", Some(true), at(2), at(4)),
                ("two", "do two", None, at(6), at(7)),
            ]
        );
    }

    #[test]
    fn a_name_is_one_of_a_file_and_a_task_has_words() {
        assert_eq!(Episode::check("pick_07-b", "pick the cube"), Ok(()));
        for name in ["", "a/b", "..", "a b", "ü", &"x".repeat(129)] {
            let error = Episode::check(name, "pick").unwrap_err();
            assert_eq!(error, EpisodeError::Name { got: name.into() });
        }
        let error = Episode::check("pick", " \n").unwrap_err();
        assert!(error.to_string().contains("empty task"), "{error}");
    }

    #[test]
    fn a_sample_has_the_width_that_came_last_before_it() {
        let cycles = (0..6).map(|second| {
            Ok::<_, Infallible>(Cycle {
                time: at(second),
                ..Cycle::default()
            })
        });
        let widths = [(2, 0.03), (2, 0.02), (4, 0.01)].map(|(second, width)| {
            let state = gripper::State {
                width,
                ..gripper::State::default()
            };
            Ok((at(second), GripperState::Hand(state)))
        });
        let widths: Vec<_> = Samples::new(cycles, widths)
            .map(|sample| sample.map(|it| it.width))
            .collect::<Result<_, _>>()
            .unwrap_or_default();
        let expected = [None, None, Some(0.02), Some(0.02), Some(0.01), Some(0.01)];
        assert_eq!(widths, expected);
    }
}
