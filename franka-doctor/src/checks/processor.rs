//! Checks of the processors' frequencies, sleep states, load and interrupts.

use super::Check;
use crate::finding::{Group, Judged, Matters, Needs};
use crate::host::Unread;
use crate::readings::Readings;

const PROCESSOR: Check = Check {
    id: "",
    group: Group::Processor,
    matters: Matters::Moving,
    wanted: "",
    why: "",
    source: "",
    reads_only: true,
    of_card: false,
    judge: governor,
};

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "cpu.governor",
        wanted: "performance on every processor",
        why: "Other governors lower the frequency while the thread sleeps, so each cycle starts \
            slowly.",
        source: "vendor: FCI documentation, CPU frequency scaling; libfranka issue 123",
        judge: governor,
        ..PROCESSOR
    },
    Check {
        id: "cpu.epp",
        wanted: "performance on every processor",
        why: "Processors that choose their own frequency follow this preference, regardless of \
            the governor.",
        source: "general knowledge of the driver intel_pstate",
        judge: epp,
        ..PROCESSOR
    },
    Check {
        id: "cpu.turbo",
        wanted: "any",
        why: "Frequency changes matter only below 20 us.",
        source: "measured by others: servobox, no gain from turning it off",
        judge: turbo,
        ..PROCESSOR
    },
    Check {
        id: "cpu.cstates",
        wanted: "no enabled sleep state that takes more than 10 us to leave; a warning above 50 us",
        why: "Each wake-up of the thread takes longer by this time.",
        source: "general knowledge; cyclictest forbids them while it measures, by /dev/cpu_dma_latency",
        judge: cstates,
        ..PROCESSOR
    },
    Check {
        id: "cpu.pm_qos",
        wanted: "any",
        why: "A limit for the sleep states of a processor; 0 means no limit.",
        source: "general knowledge of Linux kernels",
        judge: pm_qos,
        ..PROCESSOR
    },
    Check {
        id: "cpu.count",
        wanted: "2 or more; with SMT, nothing else on the sibling of the control thread's processor",
        why: "With one processor, the control thread shares it with network interrupts and all \
            other programs.",
        source: "this driver: a thread of its own beside the program's",
        judge: count,
        ..PROCESSOR
    },
    Check {
        id: "cpu.isolated",
        wanted: "the processor of the control thread, if the thread is pinned",
        why: "An isolated processor runs only threads that are pinned to it.",
        source: "general knowledge of Linux kernels",
        judge: isolated,
        ..PROCESSOR
    },
    Check {
        id: "cpu.load",
        wanted: "programs waited for a processor for less than 5 % of the last minute",
        why: "Load on the same computer has broken control loops (libfranka issue 60).",
        source: "threshold: this project's; report: libfranka issue 60",
        judge: load,
        ..PROCESSOR
    },
    Check {
        id: "cpu.freq_now",
        wanted: "within 10 % of the highest, after a second of load",
        why: "Shows the effect of governor and power settings.",
        source: "threshold: this project's",
        reads_only: false,
        judge: frequency,
        ..PROCESSOR
    },
    Check {
        id: "irq.balance",
        wanted: "interrupts of the robot's network card off the control thread's processor, unless chosen so",
        why: "A control thread at priority 99 delays the card's interrupt thread, at 50, on the \
            same processor.",
        source: "general knowledge of PREEMPT_RT; threads of interrupts have SCHED_FIFO 50",
        of_card: true,
        judge: interrupts,
        ..PROCESSOR
    },
];

const CPUS: &str = "/sys/devices/system/cpu";

/// Formats counts such as `performance (4), powersave (4)`.
fn counted(values: &std::collections::BTreeMap<String, usize>) -> String {
    let parts: Vec<String> = values
        .iter()
        .map(|(value, count)| format!("{value} ({count})"))
        .collect();
    parts.join(", ")
}

fn governor(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let values = readings.per_processor("cpufreq/scaling_governor")?;
    let read = counted(&values);
    Ok(match values.keys().all(|value| value == "performance") {
        true => Judged::good(read),
        false => {
            Judged::warning(read).fix(Needs::Nothing, "sudo cpupower frequency-set -g performance")
        }
    })
}

fn epp(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let file = "cpufreq/energy_performance_preference";
    let values = readings.per_processor(file)?;
    let read = counted(&values);
    Ok(match values.keys().all(|value| value == "performance") {
        true => Judged::good(read),
        false => Judged::warning(read).fix(
            Needs::Nothing,
            format!("echo performance | sudo tee {CPUS}/cpu*/{file}"),
        ),
    })
}

fn turbo(readings: &Readings<'_>) -> Result<Judged, Unread> {
    if let Ok(off) = readings.text(&format!("{CPUS}/intel_pstate/no_turbo")) {
        return Ok(Judged::info(if off == "0" { "on" } else { "off" }));
    }
    let on = readings.text(&format!("{CPUS}/cpufreq/boost"))?;
    Ok(Judged::info(if on == "0" { "off" } else { "on" }))
}

fn cstates(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let mut deepest: Option<(u64, String)> = None;
    let mut any = false;
    for cpu in readings.processors()? {
        let Ok(states) = readings.host.list(&format!("{cpu}/cpuidle")) else {
            continue;
        };
        for state in states {
            let path = format!("{cpu}/cpuidle/{state}");
            any = true;
            if readings
                .text(&format!("{path}/disable"))
                .is_ok_and(|value| value != "0")
            {
                continue;
            }
            let latency = readings.number(&format!("{path}/latency"))?;
            if deepest.as_ref().is_none_or(|(most, _)| latency > *most) {
                deepest = Some((latency, readings.text(&format!("{path}/name"))?));
            }
        }
    }
    if !any {
        return Err(Unread::Absent(format!("{CPUS}/cpu*/cpuidle")));
    }
    let Some((us, name)) = deepest else {
        return Ok(Judged::good("none enabled"));
    };
    let read = format!("{name} takes {us} us to leave");
    let judged = match us {
        0..=10 => Judged::good(read),
        11..=50 => Judged::info(read),
        _ => Judged::warning(read),
    };
    Ok(judged.fix(Needs::Nothing, "sudo cpupower idle-set -D 10"))
}

fn pm_qos(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let values = readings.per_processor("power/pm_qos_resume_latency_us")?;
    Ok(Judged::info(counted(&values)))
}

fn count(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let online = readings.text(&format!("{CPUS}/online"))?;
    let Some(count) = members(&online).map(|members| members.len()) else {
        return Err(Unread::Failed(
            format!("{CPUS}/online"),
            format!("`{online}`"),
        ));
    };
    let smt = readings.text(&format!("{CPUS}/smt/active"));
    let mut read = format!("{count} online ({online})");
    if smt.is_ok_and(|active| active == "1") {
        read += ", with SMT";
        if let Some(cpu) = readings.cpu {
            let siblings =
                readings.text(&format!("{CPUS}/cpu{cpu}/topology/thread_siblings_list"))?;
            read += &format!(": the control thread's {cpu} is one of {siblings}");
        }
    }
    Ok(match count {
        0 | 1 => Judged::warning(read),
        _ => Judged::good(read),
    })
}

/// Returns the numbers in a list such as `0-3,8`; `None` if the text is not such a list.
fn members(list: &str) -> Option<Vec<usize>> {
    let mut members = Vec::new();
    for part in list
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
    {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last) = (first.parse().ok()?, last.parse::<usize>().ok()?);
        if last > CPU_MAX {
            return None;
        }
        members.extend(first..=last);
    }
    Some(members)
}

/// Upper bound for processor numbers. No kernel uses larger numbers.
const CPU_MAX: usize = 1 << 16;

fn isolated(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let path = format!("{CPUS}/isolated");
    let isolated = readings.text(&path)?;
    let command_line = readings.text("/proc/cmdline")?;
    let options: Vec<&str> = command_line
        .split_whitespace()
        .filter(|word| {
            let name = word.split('=').next().unwrap_or_default();
            OPTIONS.contains(&name)
        })
        .collect();
    let mut read = match isolated.as_str() {
        "" => "none isolated".to_owned(),
        _ => format!("{isolated} isolated"),
    };
    if !options.is_empty() {
        read += &format!("; {}", options.join(" "));
    }
    let Some(cpu) = readings.cpu else {
        return Ok(Judged::info(format!(
            "{read}; the control thread is not pinned"
        )));
    };
    let members =
        members(&isolated).ok_or_else(|| Unread::Failed(path, format!("`{isolated}`")))?;
    Ok(match members.contains(&cpu) {
        true => Judged::good(read),
        false => Judged::info(format!("{read}; the control thread's {cpu} is not")),
    })
}

/// Kernel options that affect the punctuality of a processor.
const OPTIONS: [&str; 13] = [
    "isolcpus",
    "nohz_full",
    "rcu_nocbs",
    "irqaffinity",
    "mitigations",
    "processor.max_cstate",
    "intel_idle.max_cstate",
    "idle",
    "skew_tick",
    "nosoftlockup",
    "tsc",
    "preempt",
    "threadirqs",
];

fn load(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let path = "/proc/pressure/cpu";
    let text = readings.text(path)?;
    let waited = text
        .lines()
        .find(|line| line.starts_with("some"))
        .and_then(|line| {
            line.split_whitespace()
                .find_map(|word| word.strip_prefix("avg60="))
        })
        .and_then(|value| value.parse::<f64>().ok());
    let Some(waited) = waited else {
        return Err(Unread::Failed(
            path.into(),
            format!("`{text}`, expected `some .. avg60=`"),
        ));
    };
    let read = format!("programs waited for {waited:.1} % of the last minute");
    Ok(match waited < 5.0 {
        true => Judged::good(read),
        false => Judged::warning(read),
    })
}

/// Checks the frequency of the control thread's processor. If no such processor is set, checks the
/// first processor. If load is allowed, the check first loads the processor for a second.
fn frequency(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let cpu = readings.cpu.unwrap_or(0);
    let file = |name: &str| format!("{CPUS}/cpu{cpu}/cpufreq/{name}");
    let highest: u64 = readings.number(&file("cpuinfo_max_freq"))?;
    let before: u64 = readings.number(&file("scaling_cur_freq"))?;
    let (mhz, of) = (before / 1000, highest / 1000);
    if !readings.may_load {
        return Ok(Judged::info(format!(
            "processor {cpu} at {mhz} of {of} MHz, without load"
        )));
    }
    let after = readings.host.busy_frequency(cpu)?;
    readings.note("frequency after a second of load, kHz", after.to_string());
    let read = format!(
        "processor {cpu} at {mhz} of {of} MHz, and at {} after a second of load",
        after / 1000
    );
    Ok(match after as f64 >= 0.9 * highest as f64 {
        true => Judged::good(read),
        false => Judged::info(read),
    })
}

fn interrupts(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let interface = readings.interface()?;
    let directory = format!("{}/{interface}/device/msi_irqs", crate::readings::NET);
    let vectors = readings.host.list(&directory)?;
    let mut processors = Vec::new();
    for vector in vectors {
        let path = format!("/proc/irq/{vector}/effective_affinity_list");
        let list = readings.text(&path)?;
        let members = members(&list).ok_or_else(|| Unread::Failed(path, format!("`{list}`")))?;
        processors.extend(members);
    }
    processors.sort_unstable();
    processors.dedup();
    let names: Vec<String> = processors.iter().map(ToString::to_string).collect();
    let balanced = readings.running(&["irqbalance"])?;
    let mut read = format!("{interface} interrupts processors {}", names.join(","));
    if !balanced.is_empty() {
        read += "; irqbalance runs, which moves them";
    }
    Ok(match readings.cpu {
        Some(cpu) if processors.contains(&cpu) => {
            Judged::warning(format!("{read}; the control thread is pinned to {cpu}"))
        }
        Some(_) if balanced.is_empty() => Judged::good(read),
        _ => Judged::info(read),
    })
}
