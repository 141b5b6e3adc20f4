//! The running host. The module `linux` contains the Linux-specific part. On other systems, and
//! with `--cfg franka_portable`, the module `portable` replaces it.

#[cfg(all(target_os = "linux", not(franka_portable)))]
mod linux;
// The test of this module also runs on Linux.
#[cfg(any(test, not(target_os = "linux"), franka_portable))]
#[cfg_attr(all(target_os = "linux", not(franka_portable)), allow(dead_code))]
mod portable;

use core::hint;
use core::time::Duration;
use std::fs::{self, File};
use std::io::{self, Read as _};
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Instant;

use franka_rt::sched::{Kernel, Realtime, Scheduling};
use nix::sys::statvfs::statvfs;

use crate::host::{Ethtool, Host, Unread, names_in};
use crate::latencies::Latencies;
use crate::loopback;
use crate::round_trip::{self, RoundTrips};
#[cfg(all(target_os = "linux", not(franka_portable)))]
use linux as host;
#[cfg(any(not(target_os = "linux"), franka_portable))]
use portable as host;

/// The host that runs this program.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// Processor on which the control thread will run. The measurement of wake-ups uses it.
    pub cpu: Option<usize>,
}

impl System {
    /// Returns the scheduling that the driver's control thread would request. If the system refuses
    /// it, this is not an error.
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
        let what = || format!("the route to {robot}");
        // `connect` on a UDP socket determines the route and sends nothing. The port does not
        // matter.
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
        host::ethtool(interface, question)
    }

    fn is_lasting(&self, interface: &str, own: Ipv4Addr) -> Result<bool, Unread> {
        let what = || format!("the address {own} of {interface}");
        match host::is_lasting(own) {
            Ok(Some(lasting)) => Ok(lasting),
            Ok(None) => Err(Unread::Absent(what())),
            Err(error) => Err(Unread::new(what(), &error)),
        }
    }

    fn free_disk(&self) -> Result<u64, Unread> {
        let free = statvfs(".").map(|disk| {
            // The integer width of these values depends on the system.
            let (blocks, size) = (disk.blocks_available(), disk.fragment_size());
            u64::try_from(u128::from(blocks) * u128::from(size)).unwrap_or(u64::MAX)
        });
        free.map_err(|error| Unread::new("the current directory", &error.into()))
    }

    fn busy_frequency(&self, cpu: usize) -> Result<u64, Unread> {
        let path = format!("/sys/devices/system/cpu/cpu{cpu}/cpufreq/scaling_cur_freq");
        let failed = |error: io::Error| {
            Unread::Failed(format!("a thread on processor {cpu}"), error.to_string())
        };
        let busy = || {
            host::pin_to(cpu).map_err(failed)?;
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
    ) -> Result<Latencies, Unread> {
        let cycles = milliseconds(duration);
        let measured = self.measured(cycles, progress, |priority, done| {
            host::wake_ups(priority, cycles, done)
        });
        measured.map_err(|why| Unread::Failed("the wake-up of a thread".into(), why))
    }

    fn loopback(
        &self,
        duration: Duration,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Latencies, Unread> {
        let count = milliseconds(duration);
        let measured = self.measured(count, progress, |priority, done| {
            loopback::measure(priority, count, done).map_err(|error| error.to_string())
        });
        measured.map_err(|why| Unread::Failed("datagrams of this computer to itself".into(), why))
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
    /// Runs `measure` on a thread that has the scheduling of the control thread. `measure` receives
    /// the thread's priority, and counts the completed part of `total`.
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

fn milliseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis())
        .unwrap_or(u64::MAX)
        .max(1)
}

/// Time for which a thread computes before the frequency of its processor is read.
const BUSY: Duration = Duration::from_secs(1);

/// Largest number of bytes of a file that are read.
const READ_MAX: u64 = 1 << 20;
