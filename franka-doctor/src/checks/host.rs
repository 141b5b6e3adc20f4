//! Checks of memory, clock, power and virtual machines. The module [`kernel`] contains the kernel's
//! checks.

use super::{Check, VENDOR, kernel};
use crate::finding::{Group, Judged, Matters, Needs};
use crate::host::Unread;
use crate::readings::Readings;

const HOST: Check = Check {
    id: "",
    group: Group::Host,
    matters: Matters::Moving,
    wanted: "",
    why: "",
    source: "",
    reads_only: true,
    of_card: false,
    judge: kernel::realtime,
};

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "kernel.rt",
        wanted: "a kernel with PREEMPT_RT",
        why: "Other kernels delay threads by milliseconds; Realtime::Enforce refuses them.",
        source: VENDOR,
        judge: kernel::realtime,
        ..HOST
    },
    Check {
        id: "kernel.version",
        wanted: "any real-time kernel; the vendor names those of Ubuntu Pro 22.04 and 24.04, 6.8.0-rt8, 5.9.1-rt20, 5.4.19 and 4.14.12",
        why: "Users report 6.12 to be smoother than Ubuntu's 6.8 (libfranka issue 207).",
        source: VENDOR,
        judge: kernel::version,
        ..HOST
    },
    Check {
        id: "virt",
        wanted: "no virtual machine, no WSL; a container is fine",
        why: "A virtual machine adds 100 us or more, since its processors are threads of another \
            kernel.",
        source: "measured by others: servobox, 100 to 120 us in a virtual machine",
        judge: virt,
        ..HOST
    },
    Check {
        id: "clock",
        wanted: "tsc, or arch_sys_counter",
        why: "Each reading of hpet or acpi_pm takes a microsecond or more.",
        source: "general knowledge of Linux kernels",
        judge: clock,
        ..HOST
    },
    Check {
        id: "mem.thp",
        wanted: "madvise or never",
        why: "With `always`, the kernel merges pages in the background and stalls threads that use them.",
        source: "general knowledge of Linux kernels",
        judge: thp,
        ..HOST
    },
    Check {
        id: "mem.swap",
        wanted: "no swap in use",
        why: "A swapped-out page costs milliseconds, unless memory is locked (lock_memory).",
        source: "general knowledge of Linux kernels",
        judge: swap,
        ..HOST
    },
    Check {
        id: "mem.numa",
        wanted: "numa_balancing 0",
        why: "Balancing unmaps pages to see which processors use them; the next access costs a \
            page fault.",
        source: "general knowledge of Linux kernels",
        judge: numa,
        ..HOST
    },
    Check {
        id: "power",
        wanted: "mains supply, and no program that changes governors",
        why: "On battery, and under such programs, the governor changes to a power-saving one.",
        source: "general knowledge of Linux distributions",
        judge: power,
        ..HOST
    },
    Check {
        id: "gpu",
        wanted: "no NVIDIA driver on a real-time kernel",
        why: "The vendor of the driver does not officially support PREEMPT_RT.",
        source: VENDOR,
        judge: gpu,
        ..HOST
    },
    Check {
        id: "tuned",
        wanted: "the profile realtime or latency-performance, if tuned is installed",
        why: "Other profiles of tuned set governors that save power.",
        source: "general knowledge of Linux distributions",
        judge: tuned,
        ..HOST
    },
    Check {
        id: "smi",
        wanted: "no interruption by firmware within 10 s; a warning above 10 us, a failure above \
            200 us",
        why: "System management interrupts stop every processor, unseen by the kernel.",
        source: "general knowledge; measured by `hwlatdetect` of rt-tests as root",
        judge: smi,
        ..HOST
    },
    Check {
        id: "secureboot",
        wanted: "off for an unsigned real-time kernel",
        why: "Firmware with Secure Boot does not start an unsigned kernel.",
        source: VENDOR,
        judge: secureboot,
        ..HOST
    },
    Check {
        id: "clock.sync",
        wanted: "any",
        why: "Steps of the wall clock show in time stamps of recordings; the control thread does not use it.",
        source: "general knowledge of Linux distributions",
        judge: clock_sync,
        ..HOST
    },
    Check {
        id: "limits.fd",
        wanted: "1024 open files or more",
        why: "Each robot needs about ten; recordings and dashboards need more.",
        source: "this driver",
        judge: open_files,
        ..HOST
    },
    Check {
        id: "disk",
        wanted: "2 GB free in the current directory for each hour of recording",
        why: "A recording ends when the disk is full.",
        source: "this driver: 1.94 GB an hour, measured over ten minutes of all cycles",
        judge: disk,
        ..HOST
    },
];

/// Returns true on the Windows Subsystem for Linux, according to the kernel's version text.
pub(super) fn is_wsl(readings: &Readings<'_>) -> Result<bool, Unread> {
    let version = readings.text("/proc/version")?;
    Ok(version.to_lowercase().contains("microsoft"))
}

/// Returns the file that shows that this host is a container, if such a file exists.
pub(super) fn container(readings: &Readings<'_>) -> Option<&'static str> {
    [
        "/.dockerenv",
        "/run/.containerenv",
        "/run/systemd/container",
    ]
    .into_iter()
    .find(|path| readings.host.read(path).is_ok())
}

fn virt(readings: &Readings<'_>) -> Result<Judged, Unread> {
    if is_wsl(readings)? {
        return Ok(Judged::warning("Windows Subsystem for Linux"));
    }
    let cpuinfo = readings.host.read("/proc/cpuinfo").unwrap_or_default();
    let hypervisor = cpuinfo
        .lines()
        .filter(|line| line.starts_with("flags"))
        .any(|line| line.split_whitespace().any(|flag| flag == "hypervisor"));
    readings.note("cpuinfo flag hypervisor", hypervisor.to_string());
    let container = container(readings);
    readings.note("container", container.unwrap_or("none seen"));
    Ok(match (hypervisor, container) {
        (true, None) => Judged::warning("a virtual machine (the processor's flag `hypervisor`)"),
        (true, Some(path)) => Judged::warning(format!("a container ({path}) in a virtual machine")),
        (false, Some(path)) => Judged::info(format!("a container ({path})")),
        (false, None) if cpuinfo.lines().any(|line| line.starts_with("flags")) => {
            Judged::good("neither virtual machine nor container seen")
        }
        // Only x86 processors have the flag.
        (false, None) => Judged::unknown(
            "unknown: no container, and this processor has no flag that shows virtual machines",
        ),
    })
}

fn clock(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let path = "/sys/devices/system/clocksource/clocksource0/current_clocksource";
    let source = readings.text(path)?;
    Ok(match source.as_str() {
        "tsc" | "arch_sys_counter" => Judged::good(source),
        "hpet" | "acpi_pm" => Judged::warning(source),
        _ => Judged::info(source),
    })
}

fn thp(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let path = "/sys/kernel/mm/transparent_hugepage/enabled";
    let modes = readings.text(path)?;
    Ok(if modes.contains("[always]") {
        Judged::warning(modes).fix(Needs::Nothing, format!("echo madvise | sudo tee {path}"))
    } else if modes.contains("[madvise]") || modes.contains("[never]") {
        Judged::good(modes)
    } else {
        Judged::unknown(format!("unknown: {path} is `{modes}`"))
    })
}

fn swap(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let text = readings.text("/proc/swaps")?;
    let used: u64 = text
        .lines()
        .skip(1)
        .filter_map(|line| line.split_whitespace().nth(3)?.parse::<u64>().ok())
        .sum();
    Ok(match used {
        0 => Judged::good("none in use"),
        _ => Judged::warning(format!("{used} KiB in use")).fix(Needs::Nothing, "sudo swapoff -a"),
    })
}

fn numa(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let path = "/proc/sys/kernel/numa_balancing";
    Ok(match readings.text(path) {
        Ok(value) if value == "0" => Judged::good("0"),
        Ok(value) => Judged::info(value).fix(Needs::Nothing, "sudo sysctl kernel.numa_balancing=0"),
        Err(Unread::Absent(_)) => {
            // If this directory is missing, the missing file proves nothing.
            readings.host.list("/proc/sys/kernel")?;
            Judged::good("the kernel has no balancing")
        }
        Err(unread) => return Err(unread),
    })
}

fn power(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let mut seen = Vec::new();
    let supplies = readings
        .host
        .list("/sys/class/power_supply")
        .unwrap_or_default();
    for supply in supplies {
        let path = format!("/sys/class/power_supply/{supply}/status");
        if readings.host.read(&path).is_ok() && readings.text(&path)? == "Discharging" {
            seen.push(format!("on battery ({supply} is discharging)"));
        }
    }
    if let Ok(profile) = readings.text("/sys/firmware/acpi/platform_profile")
        && profile != "performance"
    {
        seen.push(format!("platform profile {profile}"));
    }
    let savers = ["auto-cpufreq", "power-profiles-daemon", "thermald", "tlp"];
    for running in readings.running(&savers)? {
        seen.push(format!("{running} runs"));
    }
    Ok(match seen.is_empty() {
        true => Judged::good("no battery in use, no program that changes governors"),
        false => Judged::warning(seen.join(", ")),
    })
}

fn gpu(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let version = match readings.text("/proc/driver/nvidia/version") {
        Ok(version) => version.lines().next().unwrap_or_default().to_owned(),
        Err(Unread::Absent(_)) => {
            let modules = readings.host.list("/sys/module")?;
            if !modules.iter().any(|name| name == "nvidia") {
                return Ok(Judged::good("none"));
            }
            "the module nvidia, without a version".into()
        }
        Err(unread) => return Err(unread),
    };
    Ok(match readings.host.kernel().is_realtime() {
        true => Judged::warning(version),
        false => Judged::info(version),
    })
}

fn tuned(readings: &Readings<'_>) -> Result<Judged, Unread> {
    Ok(match readings.text("/etc/tuned/active_profile") {
        Ok(profile) if ["realtime", "latency-performance"].contains(&profile.as_str()) => {
            Judged::good(profile)
        }
        Ok(profile) => {
            Judged::info(profile).fix(Needs::Nothing, "sudo tuned-adm profile latency-performance")
        }
        Err(Unread::Absent(_)) => Judged::info("tuned is not installed"),
        Err(unread) => return Err(unread),
    })
}

fn smi(_: &Readings<'_>) -> Result<Judged, Unread> {
    Err(Unread::Denied("`hwlatdetect --duration=10s`".into()))
}

fn secureboot(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let directory = "/sys/firmware/efi/efivars";
    let names = readings.host.list(directory)?;
    let name = names.iter().find(|name| name.starts_with("SecureBoot-"));
    let name = name.ok_or_else(|| Unread::Absent(format!("SecureBoot in {directory}")))?;
    // The file contains four bytes of attributes, then the value.
    let value = readings.host.read(&format!("{directory}/{name}"))?;
    let on = match value.as_bytes() {
        [_, _, _, _, on] => *on == 1,
        other => {
            let why = format!("{} bytes, expected 5", other.len());
            return Err(Unread::Failed(name.clone(), why));
        }
    };
    readings.note("Secure Boot", on.to_string());
    Ok(match on {
        true => Judged::info("on"),
        false => Judged::good("off"),
    })
}

fn clock_sync(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let running = readings.running(&["chronyd", "ntpd", "systemd-timesyncd"])?;
    Ok(Judged::info(match running.is_empty() {
        true => "no program found that sets the clock".into(),
        false => running.join(", "),
    }))
}

fn open_files(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let (soft, hard) = readings.limit("Max open files")?;
    let read = format!("{soft}, at most {hard}");
    Ok(match soft.parse::<u64>() {
        Ok(files) if files < 1024 => Judged::info(read),
        _ => Judged::good(read),
    })
}

fn disk(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let bytes = readings.host.free_disk()?;
    readings.note("free disk, bytes", bytes.to_string());
    let gigabytes = bytes as f64 / 1e9;
    let read = format!(
        "{gigabytes:.1} GB free: {:.1} h of recordings",
        gigabytes / GIGABYTES_PER_HOUR
    );
    Ok(match gigabytes >= GIGABYTES_PER_HOUR {
        true => Judged::good(read),
        false => Judged::info(read),
    })
}

/// Disk space for a recording of all cycles, in gigabytes per hour.
const GIGABYTES_PER_HOUR: f64 = 2.0;
