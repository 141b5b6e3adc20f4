//! The text of a `franka::ControlException`.

use std::ops::Range;

use franka_proto::{Errors, RobotError, SuccessRate};

use super::{ControlLogError, SHOWN};

/// The text of a `franka::ControlException`.
///
/// Source: the message format of libfranka 0.9 and 0.21, `robot_impl.cpp`.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ControlMessage {
    /// The robot's answer to the motion. The text starts at `libfranka:` and ends after the list of
    /// errors, or at the end of the line.
    pub text: String,
    /// The listed errors; empty if the motion did not end with a reflex.
    pub errors: Errors,
    /// Success rate and number of lost states at the end of the motion; `None` if the text contains
    /// no success rate.
    pub success_rate: Option<SuccessRate>,
}

/// Returns every exception text in these parts of a file, oldest first.
pub(super) fn all(
    text: &str,
    parts: &[Range<usize>],
) -> Result<Vec<ControlMessage>, ControlLogError> {
    let mut messages = Vec::new();
    for part in parts {
        let mut at = part.start;
        while let Some(start) = begins(&text[at..part.end]).map(|start| at + start) {
            let mut reader = Reader {
                text: &text[..part.end],
                at: start,
            };
            messages.push(reader.message()?);
            at = reader.at;
        }
    }
    Ok(messages)
}

/// Returns the position of the first message. The message begins with libfranka's name, if the name
/// precedes it.
fn begins(text: &str) -> Option<usize> {
    let found = BEGINNINGS.iter().filter_map(|it| text.find(it)).min()?;
    let named = text[..found].ends_with(NAME);
    Some(if named { found - NAME.len() } else { found })
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
}

impl Reader<'_> {
    fn message(&mut self) -> Result<ControlMessage, ControlLogError> {
        let line = self.rest().lines().next().unwrap_or_default();
        let list = LISTED.iter().find_map(|it| Some(line.find(it)? + it.len()));
        let mut message = ControlMessage {
            text: line[..list.unwrap_or(line.len())].trim().to_owned(),
            ..ControlMessage::default()
        };
        self.at += list.unwrap_or(line.len());
        if list.is_some() {
            message.errors = self.errors()?;
            message.success_rate = self.success_rate()?;
        }
        Ok(message)
    }

    /// Reads a list such as `["joint_reflex", "cartesian_reflex"]`, even if an e-mail program has
    /// inserted line breaks.
    fn errors(&mut self) -> Result<Errors, ControlLogError> {
        self.expect("[", "a list of errors, such as [\"joint_reflex\"]")?;
        let mut errors = Errors::NONE;
        if self.takes("]") {
            return Ok(errors);
        }
        loop {
            // In logs in JSON format, the quotes are escaped.
            self.takes("\\");
            self.expect("\"", "a name in quotes")?;
            let name = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let length = self.rest().find(|c| !name(c)).unwrap_or(self.rest().len());
            let got = &self.rest()[..length];
            let Some(error) = RobotError::from_name(got) else {
                return self.fail("the name of one of the robot's 41 errors");
            };
            errors.insert(error);
            self.at += length;
            self.takes("\\");
            self.expect("\"", "the end of the name")?;
            if self.takes("]") {
                return Ok(errors);
            }
            self.expect(",", "a comma, or the end of the list")?;
        }
    }

    /// Reads the success rate. libfranka writes it if its log has at least two cycles.
    fn success_rate(&mut self) -> Result<Option<SuccessRate>, ControlLogError> {
        let until = begins(self.rest()).unwrap_or(self.rest().len());
        let Some(found) = self.rest()[..until].find(RATE) else {
            return Ok(None);
        };
        self.at += found + RATE.len();
        let rate = self.number("a success rate, 0 to 1")?;
        let mut lost = 0;
        if self.takes(LOST) {
            lost = self.number("the number of lost packets")?;
        }
        Ok(Some(SuccessRate { rate, lost }))
    }

    fn number<T: core::str::FromStr>(
        &mut self,
        expected: &'static str,
    ) -> Result<T, ControlLogError> {
        self.skip_blanks();
        let rest = self.rest();
        let number = |c: char| c.is_ascii_alphanumeric() || ['.', '+', '-'].contains(&c);
        let length = rest.find(|c| !number(c)).unwrap_or(rest.len());
        // A full stop may follow the number.
        let Ok(value) = rest[..length].trim_end_matches('.').parse() else {
            return self.fail(expected);
        };
        self.at += length;
        Ok(value)
    }

    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn skip_blanks(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    fn takes(&mut self, what: &str) -> bool {
        let rest = self.rest().trim_start();
        let found = rest.starts_with(what);
        if found {
            self.at = self.text.len() - rest.len() + what.len();
        }
        found
    }

    fn expect(&mut self, what: &str, expected: &'static str) -> Result<(), ControlLogError> {
        if self.takes(what) {
            Ok(())
        } else {
            self.fail(expected)
        }
    }

    fn fail<T>(&mut self, expected: &'static str) -> Result<T, ControlLogError> {
        self.skip_blanks();
        let before = &self.text[..self.at];
        let line_start = before.rfind('\n').map_or(0, |end| end + 1);
        let got = self.rest().lines().next().unwrap_or("the end of the text");
        Err(ControlLogError::Message {
            line: before.matches('\n').count() as u64 + 1,
            column: before[line_start..].chars().count() + 1,
            got: got.chars().take(SHOWN).collect(),
            expected,
        })
    }
}

const NAME: &str = "libfranka: ";

/// First words of the robot's answers to a motion.
const BEGINNINGS: [&str; 4] = [
    "Move command aborted",
    "Move command preempted",
    "Move command rejected",
    "Motion finished commanded,",
];

/// Answers that are followed by a list of errors.
const LISTED: [&str; 2] = ["motion aborted by reflex!", "the robot is still moving!"];

const RATE: &str = "control_command_success_rate:";

const LOST: &str = "packets lost in a row in the last sample:";
