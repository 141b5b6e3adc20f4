//! The interface to a host: its files, and the few values that are not stored in files.

use core::fmt;
use core::time::Duration;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::net::Ipv4Addr;
use std::path::Path;
use std::str::FromStr;

use franka_rt::sched::Kernel;

use crate::latencies::Latencies;
use crate::round_trip::RoundTrips;

/// A host that the checks examine. [`System`](crate::System) is the running host, and [`Tree`] is a
/// host described by a text.
///
/// No method changes anything on the host.
pub trait Host {
    /// Returns the file at this absolute path, up to the first MiB.
    fn read(&self, path: &str) -> Result<String, Unread>;
    /// Returns the sorted names in a directory.
    fn list(&self, path: &str) -> Result<Vec<String>, Unread>;
    /// Returns the target of a symbolic link.
    fn link(&self, path: &str) -> Result<String, Unread>;
    /// Returns the kernel's description.
    fn kernel(&self) -> Kernel;
    /// Starts a thread that requests the highest `SCHED_FIFO` priority. Returns the priority that
    /// the thread received, or the reason why the system refused it.
    fn fifo(&self) -> Result<i32, String>;
    /// Returns the host's own address on the route to `robot`. This method sends no packets.
    fn own_address(&self, robot: Ipv4Addr) -> Result<Ipv4Addr, Unread>;
    /// Returns the answer of the driver of `interface` to `question`: the bytes of a structure from
    /// `linux/ethtool.h`.
    fn ethtool(&self, interface: &str, question: Ethtool) -> Result<Vec<u8>, Unread>;
    /// Returns true if `interface` has the address `own` permanently, and false if the address is
    /// leased, for example from DHCP.
    fn is_lasting(&self, interface: &str, own: Ipv4Addr) -> Result<bool, Unread>;
    /// Returns the number of free bytes on the disk of the current directory.
    fn free_disk(&self) -> Result<u64, Unread>;
    /// Returns the frequency of a processor, in kHz, after a thread under the normal scheduler has
    /// computed for one second.
    fn busy_frequency(&self, cpu: usize) -> Result<u64, Unread>;
    /// Measures how late a thread wakes up in each millisecond of this duration. The thread runs
    /// under `SCHED_FIFO` if the system allows it. Calls `progress` with the completed share about
    /// ten times a second.
    fn wake_ups(
        &self,
        duration: Duration,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Latencies, Unread>;
    /// Measures the round-trip times of datagrams to another thread on this host, one per
    /// millisecond for this duration. Both threads run under `SCHED_FIFO` if the system allows it.
    /// Calls `progress` as [`Self::wake_ups`] does.
    fn loopback(
        &self,
        duration: Duration,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Latencies, Unread>;
    /// Measures how long `robot` takes to answer each of `count` echo requests (ICMP) of 1200
    /// bytes. Sends at most one request per millisecond. Calls `progress` as [`Self::wake_ups`]
    /// does.
    fn round_trips(
        &self,
        robot: Ipv4Addr,
        count: u64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<RoundTrips, Unread>;
}

/// A query to the driver of a network card. No query changes a setting or needs privileges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ethtool {
    /// `ETHTOOL_GDRVINFO`: `struct ethtool_drvinfo`.
    Driver,
    /// `ETHTOOL_GCOALESCE`: `struct ethtool_coalesce`.
    Coalescing,
    /// `ETHTOOL_GRINGPARAM`: `struct ethtool_ringparam`.
    Rings,
    /// `ETHTOOL_GPAUSEPARAM`: `struct ethtool_pauseparam`.
    Pause,
    /// `ETHTOOL_GFLAGS`: `struct ethtool_value`.
    Flags,
    /// `ETHTOOL_GGRO`: `struct ethtool_value`.
    Gro,
    /// `ETHTOOL_GEEE`: `struct ethtool_eee`.
    Eee,
}

impl Ethtool {
    /// Returns the number of the ethtool command.
    pub fn command(self) -> u32 {
        match self {
            Self::Driver => 0x03,
            Self::Coalescing => 0x0e,
            Self::Rings => 0x10,
            Self::Pause => 0x12,
            Self::Flags => 0x25,
            Self::Gro => 0x2b,
            Self::Eee => 0x44,
        }
    }

    /// Returns the size of the structure in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::Driver => 196,
            Self::Coalescing => 92,
            Self::Rings => 36,
            Self::Pause => 16,
            Self::Flags | Self::Gro => 8,
            Self::Eee => 40,
        }
    }
}

/// Reason why a value could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unread {
    /// The value does not exist.
    Absent(String),
    /// Reading the value needs privileges.
    Denied(String),
    /// Another error. The values are the thing that was read, and the reason.
    Failed(String, String),
}

impl Unread {
    /// Creates the error for `what` from a system error.
    pub fn new(what: impl Into<String>, error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => Self::Absent(what.into()),
            io::ErrorKind::PermissionDenied => Self::Denied(what.into()),
            _ => Self::Failed(what.into(), error.to_string()),
        }
    }
}

impl fmt::Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absent(what) => write!(f, "{what} does not exist"),
            Self::Denied(what) => write!(f, "{what} needs root"),
            Self::Failed(what, why) => write!(f, "{what}: {why}"),
        }
    }
}

/// The files of a host in one text, for tests: blocks of a header and the file's content.
///
/// ```text
/// == /proc/swaps ==
/// Filename  Type  Size  Used  Priority
/// == /sys/class/net/eth0 -> ../../devices/virtual/net/eth0 ==
/// == /sys/devices/virtual/net/eth0/mtu ==
/// 1500
/// ```
///
/// A header with an arrow is a symbolic link. In a content, `\x00` is a byte, and `\` before a line
/// break removes the break. Values that are not in files are in these:
///
/// | file | contents |
/// |---|---|
/// | `/calls/fifo` | a priority, or the reason for a refusal |
/// | `/calls/own_address` | an IPv4 address |
/// | `/calls/ethtool/INTERFACE/COMMAND` | the answer's bytes in hexadecimal; `COMMAND` as `0x0e` |
/// | `/calls/is_lasting` | `true` if the host has its own address permanently, otherwise `false` |
/// | `/calls/free_disk` | free bytes |
/// | `/calls/busy_frequency` | the frequency of any processor under load, in kHz |
/// | `/calls/wake_ups`, `/calls/loopback` | lines with a latency in microseconds and its count |
/// | `/calls/round_trips` | a line with the numbers of sent and answered requests, then lines as above |
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// Contents by path. The paths have no leading slash.
    files: BTreeMap<String, String>,
    /// Targets of symbolic links by path, also without leading slashes.
    links: BTreeMap<String, String>,
}

impl Tree {
    /// Creates a host from its text.
    pub fn new(text: &str) -> Self {
        let mut tree = Self::default();
        let mut path = "";
        for line in text.split_inclusive('\n') {
            let header = line.strip_prefix("== /");
            match header.and_then(|header| header.strip_suffix(" ==\n")) {
                Some(header) => match header.split_once(" -> ") {
                    Some((link, target)) => drop(tree.links.insert(link.into(), target.into())),
                    None => {
                        path = header;
                        tree.files.entry(path.to_owned()).or_default();
                    }
                },
                None => *tree.files.entry(path.to_owned()).or_default() += line,
            }
        }
        for content in tree.files.values_mut() {
            *content = unescaped(content);
        }
        tree
    }

    /// Returns the path with all links replaced by their targets, without a leading slash.
    fn resolved(&self, path: &str) -> String {
        let mut parts: Vec<&str> = Vec::new();
        let mut rest: Vec<&str> = path.rsplit('/').collect();
        while let Some(part) = rest.pop() {
            match part {
                "" => {}
                ".." => drop(parts.pop()),
                part => parts.push(part),
            }
            if let Some(target) = self.links.get(&parts.join("/")) {
                parts.pop();
                rest.extend(target.rsplit('/'));
            }
        }
        parts.join("/")
    }

    fn call(&self, name: &str) -> Result<String, Unread> {
        self.read(&format!("calls/{name}"))
    }

    /// Returns the value of a file that contains a single value.
    fn value<T: FromStr>(&self, name: &str, what: &str) -> Result<T, Unread> {
        let text = self.call(name)?;
        let text = text.trim();
        text.parse().map_err(|_| {
            Unread::Failed(
                format!("calls/{name}"),
                format!("`{text}`, expected {what}"),
            )
        })
    }

    /// Returns the latencies of a thread that runs with the priority that the host grants.
    fn latencies(&self, name: &str, progress: &mut dyn FnMut(f64)) -> Result<Latencies, Unread> {
        progress(1.0);
        let mut latencies = Latencies::new(self.fifo().ok());
        for (us, count) in self.pairs(name)? {
            for _ in 0..count {
                latencies.note(Duration::from_micros(us));
            }
        }
        Ok(latencies)
    }

    /// Returns the lines of a file in which each line contains two numbers.
    fn pairs(&self, name: &str) -> Result<Vec<(u64, u64)>, Unread> {
        let text = self.call(name)?;
        let pair = |line: &str| {
            let numbers: Vec<u64> = line.split(' ').flat_map(str::parse).collect();
            let [first, second] = numbers[..] else {
                let why = format!("`{line}`, expected two numbers");
                return Err(Unread::Failed(format!("calls/{name}"), why));
            };
            Ok((first, second))
        };
        text.lines().map(pair).collect()
    }
}

impl Host for Tree {
    fn read(&self, path: &str) -> Result<String, Unread> {
        let content = self.files.get(&self.resolved(path));
        content.cloned().ok_or_else(|| Unread::Absent(path.into()))
    }

    fn list(&self, path: &str) -> Result<Vec<String>, Unread> {
        let directory = self.resolved(path) + "/";
        let below = |path: &String| {
            let name = path.strip_prefix(&directory)?.split('/').next()?;
            Some(name.to_owned())
        };
        let paths = self.files.keys().chain(self.links.keys());
        let names: BTreeSet<String> = paths.filter_map(below).collect();
        match names.is_empty() {
            true => Err(Unread::Absent(path.into())),
            false => Ok(names.into_iter().collect()),
        }
    }

    fn link(&self, path: &str) -> Result<String, Unread> {
        let target = self.links.get(path.trim_start_matches('/'));
        target.cloned().ok_or_else(|| Unread::Absent(path.into()))
    }

    fn kernel(&self) -> Kernel {
        Kernel::read_by(|path| self.read(path).ok())
    }

    fn fifo(&self) -> Result<i32, String> {
        let text = self.call("fifo").map_err(|unread| unread.to_string())?;
        text.trim().parse().map_err(|_| text.trim().to_owned())
    }

    fn own_address(&self, _: Ipv4Addr) -> Result<Ipv4Addr, Unread> {
        self.value("own_address", "an address")
    }

    fn is_lasting(&self, _: &str, _: Ipv4Addr) -> Result<bool, Unread> {
        self.value("is_lasting", "true or false")
    }

    fn free_disk(&self) -> Result<u64, Unread> {
        self.value("free_disk", "a number")
    }

    fn busy_frequency(&self, _: usize) -> Result<u64, Unread> {
        self.value("busy_frequency", "a number")
    }

    fn ethtool(&self, interface: &str, question: Ethtool) -> Result<Vec<u8>, Unread> {
        let name = format!("ethtool/{interface}/{:#04x}", question.command());
        let text = self.call(&name)?;
        let bytes: Result<Vec<u8>, _> = text
            .split_whitespace()
            .map(|word| u8::from_str_radix(word, 16))
            .collect();
        bytes.map_err(|_| Unread::Failed(name, "not bytes in hexadecimal".into()))
    }

    fn wake_ups(&self, _: Duration, progress: &mut dyn FnMut(f64)) -> Result<Latencies, Unread> {
        self.latencies("wake_ups", progress)
    }

    fn loopback(&self, _: Duration, progress: &mut dyn FnMut(f64)) -> Result<Latencies, Unread> {
        self.latencies("loopback", progress)
    }

    fn round_trips(
        &self,
        _: Ipv4Addr,
        _: u64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<RoundTrips, Unread> {
        progress(1.0);
        let pairs = self.pairs("round_trips")?;
        let mut round_trips = RoundTrips::default();
        for (index, (first, count)) in pairs.into_iter().enumerate() {
            match index {
                0 => round_trips.sent = first,
                _ => {
                    let times = (0..count).map(|_| Duration::from_micros(first));
                    round_trips.times.extend(times);
                }
            }
        }
        Ok(round_trips)
    }
}

/// Replaces each `\xNN` by the byte, and removes each line break after `\`.
fn unescaped(content: &str) -> String {
    let content = content.replace("\\\n", "");
    let mut parts = content.split("\\x");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let byte = part
            .get(..2)
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        match byte {
            Some(byte) => text.extend([char::from(byte).to_string().as_str(), &part[2..]]),
            None => text.extend(["\\x", part]),
        }
    }
    text
}

pub(crate) fn names_in(path: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(path)? {
        names.push(entry?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}
