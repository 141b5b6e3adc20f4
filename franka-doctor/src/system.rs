//! The running host: the only file of this crate with `unsafe`.

use core::hint;
use core::time::Duration;
use std::fs::{self, File};
use std::io::{self, Read as _};
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::os::fd::AsRawFd as _;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Instant;

use franka_rt::sched::{Kernel, Realtime, Scheduling};
use nix::sched::{CpuSet, sched_setaffinity};
use nix::sys::statvfs::statvfs;
use nix::sys::time::TimeSpec;
use nix::time::{ClockId, ClockNanosleepFlags, clock_gettime, clock_nanosleep};
use nix::unistd::Pid;

use crate::host::{Ethtool, Host, Unread, names_in};
use crate::lease;
use crate::round_trip::{self, RoundTrips};
use crate::wake_up::WakeUps;

/// The host that this runs on.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// The processor that the control thread is to be pinned to, for the measurement of wake-ups.
    pub cpu: Option<usize>,
}

impl System {
    /// What the driver's thread would ask for; refusals are no errors.
    fn scheduling(&self) -> Scheduling {
        Scheduling {
            realtime: Realtime::Ignore,
            cpu: self.cpu,
            ..Scheduling::default()
        }
    }
}

impl Host for System {
    fn read(&self, path: &str) -> Result<String, Unread> {
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(READ_MAX).read_to_end(&mut bytes))
            .map_err(|error| Unread::new(path, &error))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn list(&self, path: &str) -> Result<Vec<String>, Unread> {
        names_in(Path::new(path)).map_err(|error| Unread::new(path, &error))
    }

    fn link(&self, path: &str) -> Result<String, Unread> {
        match fs::read_link(path) {
            Ok(target) => Ok(target.to_string_lossy().into_owned()),
            Err(error) => Err(Unread::new(path, &error)),
        }
    }

    fn kernel(&self) -> Kernel {
        Kernel::read()
    }

    fn fifo(&self) -> Result<i32, String> {
        let asked = Scheduling {
            cpu: None,
            ..self.scheduling()
        };
        let granted = asked.probe().map_err(|error| error.to_string())?;
        granted.priority.ok_or_else(|| {
            let refusals: Vec<String> = granted.refusals.iter().map(ToString::to_string).collect();
            refusals.join("; ")
        })
    }

    fn own_address(&self, robot: Ipv4Addr) -> Result<Ipv4Addr, Unread> {
        let what = || format!("the way to {robot}");
        // Connecting a UDP socket looks up the way and sends nothing. The port does not matter.
        let local = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))
            .and_then(|socket| socket.connect((robot, 1337)).map(|()| socket))
            .and_then(|socket| socket.local_addr())
            .map_err(|error| Unread::Failed(what(), error.to_string()))?;
        match local {
            SocketAddr::V4(local) => Ok(*local.ip()),
            SocketAddr::V6(_) => Err(Unread::Failed(what(), "an IPv6 address".into())),
        }
    }

    fn ethtool(&self, interface: &str, question: Ethtool) -> Result<Vec<u8>, Unread> {
        let what = format!("ethtool {interface} {:#04x}", question.command());
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))
            .map_err(|error| Unread::new(what.as_str(), &error))?;
        // SAFETY: `ifreq` is a C struct of integers, a pointer and arrays, for which all zeros is
        // a valid value.
        let mut ifreq: libc::ifreq = unsafe { core::mem::zeroed() };
        if interface.len() >= ifreq.ifr_name.len() {
            return Err(Unread::Absent(what));
        }
        for (to, from) in ifreq.ifr_name.iter_mut().zip(interface.bytes()) {
            *to = from as libc::c_char;
        }
        let mut answer = [0_u32; ANSWER_WORDS];
        answer[0] = question.command();
        ifreq.ifr_ifru.ifru_data = (&raw mut answer).cast();
        // SAFETY: the descriptor is open during the call. The kernel reads the name, which ends
        // with a zero, and behind the pointer it reads and writes the structure of the command: at
        // most 196 bytes, of members of four bytes at most (`linux/ethtool.h`). `answer` is
        // initialised, aligned for these and larger.
        let done = unsafe { libc::ioctl(socket.as_raw_fd(), SIOCETHTOOL, &raw mut ifreq) };
        if done == -1 {
            let error = io::Error::last_os_error();
            return Err(match error.raw_os_error() {
                Some(libc::EOPNOTSUPP) => {
                    Unread::Failed(what, "the driver of the card does not say".into())
                }
                _ => Unread::new(what, &error),
            });
        }
        let mut bytes: Vec<u8> = answer.iter().flat_map(|word| word.to_ne_bytes()).collect();
        bytes.truncate(question.size());
        Ok(bytes)
    }

    fn is_lasting(&self, interface: &str, own: Ipv4Addr) -> Result<bool, Unread> {
        let what = || format!("the address {own} of {interface}");
        match lease::is_lasting(own) {
            Ok(Some(lasting)) => Ok(lasting),
            Ok(None) => Err(Unread::Absent(what())),
            Err(error) => Err(Unread::new(what(), &error)),
        }
    }

    fn free_disk(&self) -> Result<u64, Unread> {
        let free = statvfs(".").map(|disk| {
            let (blocks, size) = (disk.blocks_available(), disk.fragment_size());
            blocks.saturating_mul(size)
        });
        free.map_err(|error| Unread::new("the current directory", &error.into()))
    }

    fn busy_frequency(&self, cpu: usize) -> Result<u64, Unread> {
        let path = format!("/sys/devices/system/cpu/cpu{cpu}/cpufreq/scaling_cur_freq");
        let failed = |error: nix::Error| {
            Unread::Failed(format!("a thread on processor {cpu}"), error.to_string())
        };
        let busy = || {
            let mut only = CpuSet::new();
            only.set(cpu).map_err(failed)?;
            // 0: this thread.
            sched_setaffinity(Pid::from_raw(0), &only).map_err(failed)?;
            let begin = Instant::now();
            while begin.elapsed() < BUSY {
                hint::spin_loop();
            }
            self.read(&path)
        };
        let text = thread::scope(|scope| {
            let busy = thread::Builder::new().spawn_scoped(scope, busy);
            let busy = busy.map_err(|error| Unread::new("a thread", &error))?;
            busy.join().expect("computing does not panic")
        })?;
        let text = text.trim();
        text.parse()
            .map_err(|_| Unread::Failed(path, format!("`{text}`, expected a number")))
    }

    fn wake_ups(
        &self,
        duration: Duration,
        progress: &mut dyn FnMut(f64),
    ) -> Result<WakeUps, Unread> {
        let cycles = u64::try_from(duration.as_millis())
            .unwrap_or(u64::MAX)
            .max(1);
        let measured = self.measured(cycles, progress, |priority, done| {
            wake_ups(priority, cycles, done)
        });
        measured.map_err(|why| Unread::Failed("the wake-up of a thread".into(), why))
    }

    fn round_trips(
        &self,
        robot: Ipv4Addr,
        count: u64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<RoundTrips, Unread> {
        let measured = self.measured(count, progress, |_, done| {
            round_trip::measure(robot, count, done).map_err(|error| match error.kind() {
                io::ErrorKind::PermissionDenied => {
                    "net.ipv4.ping_group_range has no group of this user".to_owned()
                }
                _ => error.to_string(),
            })
        });
        measured.map_err(|why| Unread::Failed(format!("echo requests to {robot}"), why))
    }
}

impl System {
    /// What `measure` returns on a thread with the scheduling of the control thread. It gets the
    /// priority of this thread and counts what is done, of `total`.
    fn measured<T: Send>(
        &self,
        total: u64,
        progress: &mut dyn FnMut(f64),
        measure: impl FnOnce(Option<i32>, &AtomicU64) -> Result<T, String> + Send,
    ) -> Result<T, String> {
        let done = AtomicU64::new(0);
        let scheduling = self.scheduling();
        thread::scope(|scope| {
            let measuring = thread::Builder::new()
                .name("franka-doctor".into())
                .spawn_scoped(scope, || {
                    let granted = scheduling.enter().map_err(|error| error.to_string())?;
                    measure(granted.priority, &done)
                })
                .map_err(|error| error.to_string())?;
            while !measuring.is_finished() {
                thread::sleep(Duration::from_millis(100));
                progress(done.load(Ordering::Relaxed) as f64 / total as f64);
            }
            measuring.join().expect("measuring does not panic")
        })
    }
}

/// Sleeps until each of `cycles` milliseconds, and notes how late it was each time.
fn wake_ups(priority: Option<i32>, cycles: u64, done: &AtomicU64) -> Result<WakeUps, String> {
    let mut wake_ups = WakeUps::new(priority);
    let clock = ClockId::CLOCK_MONOTONIC;
    let now = || {
        clock_gettime(clock)
            .map(Duration::from)
            .map_err(|error| error.to_string())
    };
    let mut due = now()?;
    for cycle in 0..cycles {
        due += Duration::from_millis(1);
        let until = TimeSpec::from_duration(due);
        clock_nanosleep(clock, ClockNanosleepFlags::TIMER_ABSTIME, &until)
            .map_err(|error| error.to_string())?;
        let woken = now()?;
        wake_ups.note(woken.saturating_sub(due));
        // A wake-up that is later than the next one is due is counted once.
        while due + Duration::from_millis(1) <= woken {
            due += Duration::from_millis(1);
        }
        done.store(cycle + 1, Ordering::Relaxed);
    }
    Ok(wake_ups)
}

/// How long a thread computes before the frequency of its processor is read.
const BUSY: Duration = Duration::from_secs(1);

/// Most of a file that is read.
const READ_MAX: u64 = 1 << 20;

/// Room for the answer to an ethtool question, in words of four bytes.
const ANSWER_WORDS: usize = 64;

/// `linux/sockios.h`; libc types requests as the platform's `ioctl` does.
const SIOCETHTOOL: libc::Ioctl = 0x8946;
