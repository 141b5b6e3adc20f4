//! Detects whether the running kernel is a real-time kernel.
//!
//! Up to Linux 6.11, real time (`PREEMPT_RT`) was a patch that also added the file
//! `/sys/kernel/realtime`. Since 6.12 it is an option of the kernel itself, and most of these
//! kernels do not have that file. In either case the version text of `uname` contains the option's
//! name. The release name (`-rt`) is free text and proves nothing.
//!
//! `/proc/config.gz` is not read, because decompression would need another crate. A kernel with
//! this file also has a version text, and its build made both from the same options.

use core::fmt;
use std::fs;

/// Description of a host's kernel. [`Kernel::read`] reads the running kernel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Kernel {
    /// Release name, such as `6.12.43-rt`.
    pub release: String,
    /// Version text of `uname`, such as `#1 SMP PREEMPT_RT Debian 6.12.43-1`.
    pub version: String,
    /// Contents of `/sys/kernel/realtime`; `None` if it cannot be read.
    pub flag: Option<String>,
    /// True if the kernel's configuration file contains `CONFIG_PREEMPT_RT=y`; `None` if no such
    /// file can be read.
    pub configured: Option<bool>,
}

impl Kernel {
    /// Reads the files of the running host.
    pub fn read() -> Self {
        Self::read_by(|path| fs::read_to_string(path).ok())
    }

    /// Reads the files of a host with `read`, which returns the content of a file, or `None`.
    pub fn read_by(read: impl Fn(&str) -> Option<String>) -> Self {
        let line = |path| read(path).unwrap_or_default().trim().to_owned();
        let release = line("/proc/sys/kernel/osrelease");
        let configuration = configuration_files(&release)
            .iter()
            .find_map(|path| read(path));
        Self {
            version: line("/proc/sys/kernel/version"),
            flag: read("/sys/kernel/realtime").map(|flag| flag.trim().to_owned()),
            configured: configuration.map(|text| {
                text.lines()
                    .any(|line| line.trim() == "CONFIG_PREEMPT_RT=y")
            }),
            release,
        }
    }

    /// True if any of these sources shows a real-time kernel.
    pub fn is_realtime(&self) -> bool {
        self.names_realtime() || self.flag.as_deref() == Some("1") || self.configured == Some(true)
    }

    /// True if the version text contains the word `PREEMPT_RT` or, in kernels with an older patch,
    /// the words `PREEMPT RT`. `PREEMPT` and `PREEMPT_DYNAMIC` do not mark real-time kernels.
    fn names_realtime(&self) -> bool {
        let words: Vec<&str> = self.version.split_whitespace().collect();
        words.contains(&"PREEMPT_RT") || words.windows(2).any(|pair| pair == ["PREEMPT", "RT"])
    }
}

/// Prints the files that were read, and their content.
impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "uname: `{}`, expected PREEMPT_RT in it", self.version)?;
        match &self.flag {
            Some(flag) => write!(f, "; /sys/kernel/realtime: `{flag}`, expected `1`")?,
            None => write!(f, "; /sys/kernel/realtime: cannot be read")?,
        }
        match self.configured {
            Some(_) => write!(f, "; kernel configuration: no CONFIG_PREEMPT_RT=y"),
            None => {
                let [boot, modules] = configuration_files(&self.release);
                write!(f, "; {boot} and {modules}: cannot be read")?;
                write!(f, "; /proc/config.gz: not read, because it is compressed")
            }
        }
    }
}

/// Returns the paths where distributions keep the configuration of a kernel.
fn configuration_files(release: &str) -> [String; 2] {
    [
        format!("/boot/config-{release}"),
        format!("/lib/modules/{release}/config"),
    ]
}

/// True if the running kernel is a real-time kernel: see [`Kernel::is_realtime`].
pub fn kernel_is_realtime() -> bool {
    Kernel::read().is_realtime()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a kernel with this version text, flag and configuration.
    fn kernel(version: &str, flag: Option<&str>, configured: Option<bool>) -> Kernel {
        Kernel {
            release: "6.12.43".into(),
            version: version.into(),
            flag: flag.map(Into::into),
            configured,
        }
    }

    #[test]
    fn kernel_with_any_real_time_reading_is_real_time() {
        let plain = "#1 SMP PREEMPT_DYNAMIC Debian 6.12.43-1 (2025-08-27)";
        for (version, flag, configured, expected) in [
            // Debian 13 does not have the file since 6.12.
            ("#1 SMP PREEMPT_RT Debian 6.12.43-1", None, None, true),
            // Patched kernels up to 6.11 have the file. Older kernels spell the words as follows.
            ("#14 SMP PREEMPT_RT Thu Oct 6", Some("1"), None, true),
            ("#1 SMP PREEMPT RT Mon Mar 9", None, None, true),
            // This distribution has its own version text.
            ("custom", Some("1"), None, true),
            ("custom", None, Some(true), true),
            (plain, None, None, false),
            (plain, Some("0"), Some(false), false),
            ("#1 SMP PREEMPT Tue Mar 5", None, None, false),
            ("#1 SMP PREEMPT_RTX RT", None, None, false),
            ("", None, None, false),
        ] {
            let kernel = kernel(version, flag, configured);
            assert_eq!(kernel.is_realtime(), expected, "{kernel:?}");
        }
        let named = Kernel {
            release: "6.8.0-rt8".into(),
            ..kernel(plain, None, None)
        };
        assert!(!named.is_realtime(), "a name proves nothing");
    }

    #[test]
    fn the_text_says_what_was_looked_at_and_what_was_read() {
        assert_eq!(
            kernel("#1 SMP PREEMPT", None, None).to_string(),
            "uname: `#1 SMP PREEMPT`, expected PREEMPT_RT in it; /sys/kernel/realtime: cannot be \
             read; /boot/config-6.12.43 and /lib/modules/6.12.43/config: cannot be read; \
             /proc/config.gz: not read, because it is compressed"
        );
        assert_eq!(
            kernel("#2", Some("0"), Some(false)).to_string(),
            "uname: `#2`, expected PREEMPT_RT in it; /sys/kernel/realtime: `0`, expected `1`; \
             kernel configuration: no CONFIG_PREEMPT_RT=y"
        );
    }

    #[test]
    fn the_files_of_a_host_are_read() {
        let read = |files: &[(&str, &str)]| {
            let content = |path: &str| {
                let file = files.iter().find(|(name, _)| *name == path);
                file.map(|(_, content)| (*content).to_owned())
            };
            Kernel::read_by(content)
        };
        assert_eq!(read(&[]), Kernel::default(), "nothing there");
        let configuration = "CONFIG_PREEMPT=y\n# CONFIG_PREEMPT_RT is not set\n";
        let mut files = vec![
            ("/proc/sys/kernel/osrelease", "6.6.1-x\n"),
            ("/proc/sys/kernel/version", "#3 SMP PREEMPT\n"),
            ("/sys/kernel/realtime", "0\n"),
            ("/lib/modules/6.6.1-x/config", configuration),
        ];
        let expected = Kernel {
            release: "6.6.1-x".into(),
            ..kernel("#3 SMP PREEMPT", Some("0"), Some(false))
        };
        assert_eq!(read(&files), expected);
        files.push(("/boot/config-6.6.1-x", "CONFIG_PREEMPT_RT=y\n"));
        assert!(read(&files).is_realtime());
    }

    #[test]
    fn the_running_host_has_a_release_and_a_version() {
        let kernel = Kernel::read();
        assert!(!kernel.release.is_empty() && !kernel.version.is_empty());
        assert_eq!(kernel.is_realtime(), kernel_is_realtime());
    }
}
