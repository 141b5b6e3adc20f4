//! The values that were read from a host, recorded for the report.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::net::Ipv4Addr;

use crate::host::{Ethtool, Host, Unread};
use crate::route::Route;

/// Reader for a host's values. It records each value by its path.
pub struct Readings<'a> {
    pub(crate) host: &'a dyn Host,
    pub(crate) robot: Option<Ipv4Addr>,
    /// Processor to which the control thread is pinned, if any.
    pub(crate) cpu: Option<usize>,
    /// True if checks may keep processors busy for a second.
    pub(crate) may_load: bool,
    raw: RefCell<BTreeMap<String, String>>,
}

impl<'a> Readings<'a> {
    /// Creates a reader for `host`. `robot` is the address of the robot that the host will control.
    pub fn new(host: &'a dyn Host, robot: Option<Ipv4Addr>) -> Self {
        Self {
            host,
            robot,
            cpu: None,
            may_load: false,
            raw: RefCell::default(),
        }
    }

    /// Sets the processor to which the control thread will be pinned.
    pub fn pinned(mut self, cpu: Option<usize>) -> Self {
        self.cpu = cpu;
        self
    }

    /// Sets whether checks may keep processors busy for a second.
    pub(crate) fn loading(mut self, may_load: bool) -> Self {
        self.may_load = may_load;
        self
    }

    /// Returns all values read so far.
    pub(crate) fn raw(self) -> BTreeMap<String, String> {
        self.raw.into_inner()
    }

    pub(crate) fn note(&self, what: impl Into<String>, text: impl Into<String>) {
        self.raw.borrow_mut().insert(what.into(), text.into());
    }

    /// Returns the contents of a file, without surrounding white space.
    pub(crate) fn text(&self, path: &str) -> Result<String, Unread> {
        let read = self.host.read(path).map(|text| text.trim().to_owned());
        match &read {
            Ok(text) => self.note(path, text.chars().take(NOTED_MAX).collect::<String>()),
            Err(unread) => self.note(path, format!("({unread})")),
        }
        read
    }

    /// Returns the number at the beginning of a file.
    pub(crate) fn number<T: std::str::FromStr>(&self, path: &str) -> Result<T, Unread> {
        let text = self.text(path)?;
        let first = text.split_whitespace().next().unwrap_or_default();
        first
            .parse()
            .map_err(|_| Unread::Failed(path.into(), format!("`{text}`, expected a number")))
    }

    /// Returns the value of `name` in a file with lines such as `Name: value`.
    pub(crate) fn field(&self, path: &str, name: &str) -> Result<String, Unread> {
        let text = self.text(path)?;
        text.lines()
            .find_map(|line| line.strip_prefix(name)?.trim_start().strip_prefix(':'))
            .map(|value| value.trim().to_owned())
            .ok_or_else(|| Unread::Absent(format!("`{name}` in {path}")))
    }

    /// Returns the soft and the hard limit of the process in the kernel's words, such as `99` or
    /// `unlimited`.
    pub(crate) fn limit(&self, name: &str) -> Result<(String, String), Unread> {
        let path = "/proc/self/limits";
        let text = self.text(path)?;
        let line = text.lines().find_map(|line| line.strip_prefix(name));
        let mut words = line.unwrap_or_default().split_whitespace();
        match (words.next(), words.next()) {
            (Some(soft), Some(hard)) => Ok((soft.into(), hard.into())),
            _ => Err(Unread::Absent(format!("`{name}` in {path}"))),
        }
    }

    /// Returns the names of the directories `cpu0`, `cpu1` and so on, in order.
    pub(crate) fn processors(&self) -> Result<Vec<String>, Unread> {
        let mut numbers: Vec<usize> = self
            .host
            .list(CPUS)?
            .iter()
            .filter_map(|name| name.strip_prefix("cpu")?.parse().ok())
            .collect();
        numbers.sort_unstable();
        Ok(numbers
            .iter()
            .map(|cpu| format!("{CPUS}/cpu{cpu}"))
            .collect())
    }

    /// Returns the different values that a file has for the processors. Each value comes with its
    /// number of processors.
    pub(crate) fn per_processor(&self, file: &str) -> Result<BTreeMap<String, usize>, Unread> {
        let mut values = BTreeMap::new();
        for cpu in self.processors()? {
            match self.text(&format!("{cpu}/{file}")) {
                Ok(value) => *values.entry(value).or_default() += 1,
                // An offline processor has no such file.
                Err(Unread::Absent(_)) => {}
                Err(unread) => return Err(unread),
            }
        }
        if values.is_empty() {
            return Err(Unread::Absent(format!("{CPUS}/cpu*/{file}")));
        }
        Ok(values)
    }

    /// Returns the names in `names` that belong to running programs, as in `/proc`.
    pub(crate) fn running(&self, names: &[&'static str]) -> Result<Vec<&'static str>, Unread> {
        let mut found = Vec::new();
        let entries = self.host.list("/proc")?;
        let pids = entries
            .iter()
            .filter(|name| name.bytes().all(|byte| byte.is_ascii_digit()));
        for pid in pids {
            // A process may have ended meanwhile.
            let Ok(comm) = self.host.read(&format!("/proc/{pid}/comm")) else {
                continue;
            };
            // The kernel cuts each name after 15 characters.
            let comm = comm.trim();
            found.extend(
                names
                    .iter()
                    .filter(|name| &name[..name.len().min(15)] == comm),
            );
        }
        found.sort_unstable();
        found.dedup();
        for name in names {
            let running = if found.contains(name) { "yes" } else { "no" };
            self.note(format!("running {name}"), running);
        }
        Ok(found)
    }

    /// Returns the route to the robot.
    ///
    /// # Errors
    /// Returns an error if no address was given, or if the host does not report the route.
    pub(crate) fn route(&self) -> Result<Route, Unread> {
        let robot = self
            .robot
            .ok_or_else(|| Unread::Absent("the robot's IPv4 address".into()))?;
        let own = self.host.own_address(robot)?;
        self.note("own address", own.to_string());
        if own.is_loopback() || own == robot {
            return Ok(Route::own_host(own));
        }
        Route::find(&self.text("/proc/net/route")?, robot, own)
            .ok_or_else(|| Unread::Absent(format!("a route to {robot} in /proc/net/route")))
    }

    /// Returns the network interface on the route to the robot.
    pub(crate) fn interface(&self) -> Result<String, Unread> {
        Ok(self.route()?.interface)
    }

    /// Returns the contents of a file for the network card on the route to the robot.
    pub(crate) fn card(&self, file: &str) -> Result<String, Unread> {
        self.text(&format!("{NET}/{}/{file}", self.interface()?))
    }

    /// Returns the answer of the driver of the network card on the route to the robot.
    pub(crate) fn ethtool(&self, question: Ethtool) -> Result<Answer, Unread> {
        let interface = self.interface()?;
        let what = format!("ethtool {interface} {:#04x}", question.command());
        match self.host.ethtool(&interface, question) {
            Ok(bytes) if bytes.len() >= question.size() => {
                let words: Vec<String> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
                self.note(what, words.join(" "));
                Ok(Answer(bytes))
            }
            Ok(bytes) => {
                let why = format!("{} bytes, expected {}", bytes.len(), question.size());
                Err(Unread::Failed(what, why))
            }
            Err(unread) => {
                self.note(what, format!("({unread})"));
                Err(unread)
            }
        }
    }
}

/// The bytes of a structure from `linux/ethtool.h`.
pub(crate) struct Answer(Vec<u8>);

impl Answer {
    /// Returns the unsigned integer at this byte offset.
    pub(crate) fn word(&self, offset: usize) -> u32 {
        let bytes: [u8; 4] = self.0[offset..offset + 4].try_into().expect("four bytes");
        u32::from_ne_bytes(bytes)
    }

    /// Returns the text in this range, up to its first zero byte.
    pub(crate) fn text(&self, range: core::ops::Range<usize>) -> String {
        let bytes = self.0[range]
            .split(|byte| *byte == 0)
            .next()
            .unwrap_or_default();
        String::from_utf8_lossy(bytes).into_owned()
    }
}

/// Largest number of characters of a file that are recorded.
const NOTED_MAX: usize = 2000;

const CPUS: &str = "/sys/devices/system/cpu";

/// Directory of the network interfaces.
pub(crate) const NET: &str = "/sys/class/net";
