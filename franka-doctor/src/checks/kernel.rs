//! The check for a real-time kernel, and the way to install such a kernel on this computer.

use super::host::{container, is_wsl};
use crate::finding::{Judged, Needs};
use crate::host::Unread;
use crate::readings::Readings;

pub(super) fn realtime(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let kernel = readings.host.kernel();
    readings.note("uname version", kernel.version.as_str());
    readings.note("uname release", kernel.release.as_str());
    if kernel.version.is_empty() && kernel.flag.is_none() && kernel.configured.is_none() {
        return Err(Unread::Absent("the version of the kernel".into()));
    }
    if kernel.is_realtime() {
        return Ok(Judged::good(format!("`{}`", kernel.version)));
    }
    Ok(match Remedy::of(readings, &kernel.release) {
        Remedy::Command(command) => Judged::failure(kernel.to_string()).fix(Needs::Reboot, command),
        Remedy::Words(words) => Judged::failure(format!("{kernel}; {words}")),
        Remedy::Unknown => Judged::failure(kernel.to_string()),
    })
}

pub(super) fn version(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let release = readings.host.kernel().release;
    if release.is_empty() {
        return Err(Unread::Absent("the release of the kernel".into()));
    }
    Ok(Judged::info(release))
}

/// Way to install a real-time kernel on a computer.
enum Remedy {
    /// One command installs the kernel.
    Command(&'static str),
    /// No single command exists. The text contains instructions.
    Words(String),
    /// The way is not known for this system.
    Unknown,
}

impl Remedy {
    /// Returns the remedy for a computer that runs this kernel release.
    fn of(readings: &Readings<'_>, release: &str) -> Self {
        if is_wsl(readings).unwrap_or(false) {
            return Self::words("WSL uses a kernel of Windows: run Linux directly on the computer");
        }
        if container(readings).is_some() {
            return Self::words(
                "a container uses the kernel of its host: install a real-time \
                kernel there",
            );
        }
        let model = readings.host.read("/proc/device-tree/model");
        let is_model = |name: &str| model.as_ref().is_ok_and(|model| model.contains(name));
        if is_model("Jetson") || release.contains("-tegra") {
            return Self::words(
                "on a Jetson, install the real-time packages of its Linux release, by NVIDIA",
            );
        }
        let system = readings.text("/etc/os-release").unwrap_or_default();
        let is_pi = is_model("Raspberry Pi");
        match field(&system, "ID") {
            "ubuntu" => {
                let (since, command) = if is_pi {
                    (24, "sudo pro enable realtime-kernel --variant=raspi")
                } else {
                    (22, "sudo pro enable realtime-kernel")
                };
                let version = field(&system, "VERSION_ID");
                let year = version.split('.').next().unwrap_or_default();
                match year.parse::<u32>() {
                    Ok(year) if year >= since => Self::Command(command),
                    Ok(_) => Self::Words(format!(
                        "Ubuntu {version} has no package of a real-time kernel: upgrade to \
                         {since}.04 or later, or build a kernel with PREEMPT_RT"
                    )),
                    Err(_) => Self::Unknown,
                }
            }
            "debian" if is_pi => Self::Command(
                "sudo apt install linux-image-rpi-v8-rt && echo kernel=kernel8_rt.img | sudo tee -a /boot/firmware/config.txt",
            ),
            "debian" => {
                Self::Command("sudo apt install linux-image-rt-$(dpkg --print-architecture)")
            }
            _ => Self::Unknown,
        }
    }

    fn words(words: &str) -> Self {
        Self::Words(words.into())
    }
}

/// Returns a value of `/etc/os-release`, without quotes; empty if the value is missing.
fn field<'a>(system: &'a str, name: &str) -> &'a str {
    system
        .lines()
        .find_map(|line| line.strip_prefix(name)?.strip_prefix('='))
        .map(|value| value.trim_matches(['"', '\'']))
        .unwrap_or_default()
}
