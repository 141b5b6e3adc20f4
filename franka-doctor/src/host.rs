//! What is asked of a host: files, and the few answers that are not in files.

use core::fmt;
use core::time::Duration;
use std::fs;
use std::io;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use franka_rt::sched::Kernel;

use crate::latencies::Latencies;
use crate::round_trip::RoundTrips;

/// A host that can be asked. [`System`](crate::System) is the running one, [`Tree`] a directory.
///
/// No method changes anything on the host.
pub trait Host {
    /// The contents of a file, by its absolute path; the first MiB of it.
    fn read(&self, path: &str) -> Result<String, Unread>;
    /// The names in a directory, sorted.
    fn list(&self, path: &str) -> Result<Vec<String>, Unread>;
    /// What a symbolic link holds.
    fn link(&self, path: &str) -> Result<String, Unread>;
    /// What it says of its kernel.
    fn kernel(&self) -> Kernel;
    /// The `SCHED_FIFO` priority that a thread of this process gets if it asks for the highest one,
    /// or why it gets none. Tried on a thread of its own.
    fn fifo(&self) -> Result<i32, String>;
    /// The host's own address on the way to `robot`. Nothing is sent.
    fn own_address(&self, robot: Ipv4Addr) -> Result<Ipv4Addr, Unread>;
    /// What the driver of `interface` answers: the bytes of a structure of `linux/ethtool.h`.
    fn ethtool(&self, interface: &str, question: Ethtool) -> Result<Vec<u8>, Unread>;
    /// True if `interface` has `own` for good, set by hand; false if it was lent for a time, as by
    /// DHCP.
    fn is_lasting(&self, interface: &str, own: Ipv4Addr) -> Result<bool, Unread>;
    /// Free bytes for files in the current directory.
    fn free_disk(&self) -> Result<u64, Unread>;
    /// The frequency of a processor, in kHz, at the end of a second in which a thread under the
    /// normal scheduler computes on it.
    fn busy_frequency(&self, cpu: usize) -> Result<u64, Unread>;
    /// How late a thread under `SCHED_FIFO`, where allowed, wakes up each millisecond for that
    /// long. `progress` is called with the part done, about ten times a second.
    fn wake_ups(
        &self,
        duration: Duration,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Latencies, Unread>;
    /// Times until datagrams to another thread on this host, one each millisecond for that long,
    /// come back from it; both threads under `SCHED_FIFO`, where allowed. `progress` is called as
    /// by [`Self::wake_ups`].
    fn loopback(
        &self,
        duration: Duration,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Latencies, Unread>;
    /// Times until `robot` answers echo requests (ICMP) of 1200 bytes, `count` of them, one each
    /// millisecond at most. `progress` is called as by [`Self::wake_ups`].
    fn round_trips(
        &self,
        robot: Ipv4Addr,
        count: u64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<RoundTrips, Unread>;
}

/// A question to the driver of a network card. None changes a setting, or takes privilege.
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
    /// The number of the command.
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

    /// The size of the structure, in bytes.
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

/// Why something could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unread {
    /// It is not there.
    Absent(String),
    /// It takes privilege.
    Denied(String),
    /// Anything else: what, and why.
    Failed(String, String),
}

impl Unread {
    /// Why `what` was not read, by the system's error.
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
            Self::Absent(what) => write!(f, "{what} is not there"),
            Self::Denied(what) => write!(f, "{what} needs root"),
            Self::Failed(what, why) => write!(f, "{what}: {why}"),
        }
    }
}

/// A directory with the files of a host below it, and what is not in files below `calls`:
///
/// | file | holds |
/// |---|---|
/// | `calls/fifo` | a priority, or why there is none |
/// | `calls/own_address` | an IPv4 address |
/// | `calls/ethtool/INTERFACE/COMMAND` | the answer's bytes in hexadecimal; `COMMAND` as `0x0e` |
/// | `calls/is_lasting` | whether the host has its own address for good: `true` or `false` |
/// | `calls/free_disk` | free bytes |
/// | `calls/busy_frequency` | the frequency of any processor under load, in kHz |
/// | `calls/wake_ups`, `calls/loopback` | lines of a latency in microseconds and how often |
/// | `calls/round_trips` | a line of how many were sent and how many of these were answered, then as above |
#[derive(Clone, Debug)]
pub struct Tree {
    root: PathBuf,
}

impl Tree {
    /// The host whose files are below `root`.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    fn below(&self, path: &str) -> PathBuf {
        self.root.join(path.trim_start_matches('/'))
    }

    fn call(&self, name: &str) -> Result<String, Unread> {
        self.read(&format!("calls/{name}"))
    }

    /// A file that holds one value.
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

    /// Latencies of a thread with the priority that the host grants.
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

    /// The lines of a file of two numbers each.
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
        let bytes = fs::read(self.below(path)).map_err(|error| Unread::new(path, &error))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn list(&self, path: &str) -> Result<Vec<String>, Unread> {
        names_in(&self.below(path)).map_err(|error| Unread::new(path, &error))
    }

    fn link(&self, path: &str) -> Result<String, Unread> {
        match fs::read_link(self.below(path)) {
            Ok(target) => Ok(target.to_string_lossy().into_owned()),
            Err(error) => Err(Unread::new(path, &error)),
        }
    }

    fn kernel(&self) -> Kernel {
        Kernel::read_below(&self.root)
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

/// The names in a directory, sorted.
pub(crate) fn names_in(path: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(path)? {
        names.push(entry?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}
