//! Robots by name: a TOML file in the user's configuration directory.
//!
//! ```toml
//! [left]
//! address = "172.16.0.2"
//! realtime = "ignore" # for a simulator
//! hand = "127.0.0.1:40123" # if it is not beside the robot
//! ```

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;
use std::{env, fs, io, process};

use anyhow::Context;
use clap::ValueEnum;
use franka_async::connection::Endpoint;
use serde::{Deserialize, Serialize};
use toml_edit::{DocumentMut, Item, Table, Value, de};

use crate::ending::{Ending, Failure};
use crate::fields::fields;

/// Real-time scheduling of the control thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Realtime {
    /// Required: fail without it
    Enforce,
    /// Optional: enough for a simulator
    Ignore,
}

/// A robot in the robots file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entry {
    pub(crate) address: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) realtime: Option<Realtime>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) hand: Option<String>,
}

#[derive(Debug)]
pub(crate) struct RobotsFile {
    pub(crate) path: PathBuf,
    pub(crate) robots: BTreeMap<String, Entry>,
    /// Text of the file, including the user's comments.
    document: DocumentMut,
}

impl RobotsFile {
    /// Reads the file. If the file does not exist, there are no robots.
    pub(crate) fn read() -> anyhow::Result<Self> {
        let path = path()?;
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(error).with_context(|| path.display().to_string()),
        };
        let (robots, document) = parse(&text).map_err(|error| {
            let message = format!("{}: {error}", path.display());
            Failure::usage(message.trim_end()).advice("Fix the file, or delete it.")
        })?;
        Ok(Self {
            path,
            robots,
            document,
        })
    }

    /// Adds a robot. Replaces the robot that has this name, if any.
    pub(crate) fn insert(&mut self, name: &str, entry: &Entry) {
        let robot = self.document.entry(name);
        let robot = robot.or_insert_with(|| Item::Table(Table::new()));
        let fields = robot.as_table_like_mut().expect("robots are tables");
        let realtime = entry.realtime.and_then(|it| it.to_possible_value());
        let realtime = realtime.as_ref().map(|it| it.get_name());
        for (key, new) in [
            ("address", Some(&*entry.address)),
            ("realtime", realtime),
            ("hand", entry.hand.as_deref()),
        ] {
            let Some(new) = new else {
                fields.remove(key);
                continue;
            };
            let mut new = Value::from(new);
            match fields.get_mut(key).and_then(Item::as_value_mut) {
                Some(old) => {
                    // The comment after the old value must be kept.
                    *new.decor_mut() = old.decor().clone();
                    *old = new;
                }
                None => {
                    fields.insert(key, Item::Value(new));
                }
            }
        }
    }

    /// Removes a robot. Returns true if the file contained it.
    pub(crate) fn remove(&mut self, name: &str) -> bool {
        self.document.remove(name).is_some()
    }

    /// Writes the robots to a new file, which replaces the old file.
    pub(crate) fn write(&self) -> anyhow::Result<()> {
        let write = || {
            if let Some(directory) = self.path.parent() {
                fs::create_dir_all(directory)?;
            }
            // No other running program uses this name.
            let new = format!("toml.{}.new", process::id());
            let new = self.path.with_extension(new);
            let mut file = fs::File::create(&new)?;
            let text = self.document.to_string();
            let written = file
                .write_all(text.as_bytes())
                .and_then(|()| file.sync_all())
                .and_then(|()| fs::rename(&new, &self.path));
            if written.is_err() {
                let _ = fs::remove_file(&new);
            }
            written
        };
        write().with_context(|| format!("writing {}", self.path.display()))
    }
}

fn parse(text: &str) -> Result<(BTreeMap<String, Entry>, DocumentMut), String> {
    let robots: BTreeMap<String, Entry> = de::from_str(text).map_err(|error| error.to_string())?;
    let document = text
        .parse()
        .map_err(|error: toml_edit::TomlError| error.to_string())?;
    for (name, entry) in &robots {
        check_name(name)?;
        for address in [Some(&entry.address), entry.hand.as_ref()]
            .into_iter()
            .flatten()
        {
            let parsed = address.parse::<Endpoint>();
            parsed.map_err(|error| format!("robot `{name}`: {error}"))?;
        }
    }
    Ok((robots, document))
}

/// Checks that a name is valid. A name must be neither an address nor a field of a state.
pub(crate) fn check_name(name: &str) -> Result<(), String> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if name.is_empty() || !name.chars().all(is_word) {
        return Err(format!(
            "`{name}` is not a valid robot name: expected letters, digits, `-` and `_`"
        ));
    }
    if fields().contains_key(name) {
        return Err(format!(
            "`{name}` is a field of the state, so it cannot be a robot name"
        ));
    }
    Ok(())
}

/// Returns the path of `robots.toml` in the folder `franka` of the XDG configuration directory.
fn path() -> anyhow::Result<PathBuf> {
    let absolute = |variable: &str| {
        let path = env::var_os(variable).map(PathBuf::from);
        path.filter(|path| path.is_absolute())
    };
    let home = || Some(absolute("HOME")?.join(".config"));
    let directory = absolute("XDG_CONFIG_HOME").or_else(home).ok_or_else(|| {
        Failure::new(
            Ending::Host,
            "neither XDG_CONFIG_HOME nor HOME is set to a directory",
        )
    })?;
    Ok(directory.join("franka").join("robots.toml"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_says_what_is_wrong_with_it() {
        let robots = parse("[left]\naddress = '172.16.0.2'\nrealtime = 'ignore'\n")
            .unwrap()
            .0;
        assert_eq!(robots["left"].realtime, Some(Realtime::Ignore));
        for (text, expected) in [
            ("[left]\n", "address"),
            ("[left]\naddress = 'a b'\n", "robot `left`"),
            ("['a.b']\naddress = 'x'\n", "not a valid robot name"),
            ("[q]\naddress = 'x'\n", "a field of the state"),
            ("[left]\naddress = 'x'\nrealtime = 'maybe'\n", "maybe"),
            ("[left]\naddress = 'x'\nport = 1\n", "port"),
            ("left", "expected"),
        ] {
            let error = parse(text).expect_err(text);
            assert!(error.contains(expected), "{text}: {error}");
        }
    }

    #[test]
    fn writing_leaves_the_files_of_other_programs() {
        let folder = env::temp_dir().join(format!("franka-robots-{}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (path, other) = (folder.join("robots.toml"), folder.join("robots.toml.new"));
        fs::write(&path, "").unwrap();
        fs::write(&other, "unfinished").unwrap();
        let text = "left = { address = 'a' }\n";
        let (robots, document) = parse(text).unwrap();
        let file = RobotsFile {
            path,
            robots,
            document,
        };
        file.write().unwrap();
        assert_eq!(fs::read_to_string(&file.path).unwrap(), text);
        assert_eq!(fs::read_to_string(&other).unwrap(), "unfinished");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn comments_of_the_user_stay() {
        let text = "# The lab.\n\n[left] # by the door\naddress = \"172.16.0.2\" # old cable\n\n\
                    # Borrowed.\n[right]\naddress = \"172.16.0.3\"\nrealtime = \"ignore\"\n";
        let (robots, document) = parse(text).unwrap();
        let mut file = RobotsFile {
            path: PathBuf::new(),
            robots,
            document,
        };
        let entry = |address: &str| Entry {
            address: address.to_owned(),
            realtime: None,
            hand: None,
        };
        file.insert("left", &entry("172.16.0.9"));
        file.insert("third", &entry("172.16.0.4"));
        let changed = text.replace("172.16.0.2", "172.16.0.9");
        let third = "\n[third]\naddress = \"172.16.0.4\"\n";
        assert_eq!(file.document.to_string(), format!("{changed}{third}"));
        assert!(file.remove("third") && !file.remove("third"));
        assert_eq!(file.document.to_string(), changed);
        // This entry no longer has a real-time option.
        file.insert("right", &entry("172.16.0.3"));
        let changed = changed.replace("realtime = \"ignore\"\n", "");
        assert_eq!(file.document.to_string(), changed);
        // This file uses a different style of TOML.
        let (robots, document) = parse("left = { address = 'a' } # short\n").unwrap();
        let mut file = RobotsFile {
            path: PathBuf::new(),
            robots,
            document,
        };
        file.insert("left", &entry("b"));
        assert_eq!(
            file.document.to_string(),
            "left = { address = \"b\" } # short\n"
        );
    }
}
