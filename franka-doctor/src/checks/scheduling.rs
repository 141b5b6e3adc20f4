//! Checks of the control thread's rights in the kernel.

use super::{Check, VENDOR};
use crate::finding::{Group, Judged, Matters, Needs};
use crate::host::Unread;
use crate::readings::Readings;

const SCHEDULING: Check = Check {
    id: "",
    group: Group::Scheduling,
    matters: Matters::Moving,
    wanted: "",
    why: "",
    source: "",
    reads_only: true,
    of_card: false,
    judge: priority_limit,
};

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "rt.priority",
        wanted: "SCHED_FIFO at priority 99 for a thread of this process",
        why: "Without it any other program delays the control thread.",
        source: "vendor: group `realtime` with rtprio 99; libfranka 0.21 takes the highest priority",
        reads_only: false,
        judge: priority,
        ..SCHEDULING
    },
    Check {
        id: "rt.limits_file",
        wanted: "limits that allow rtprio 99 at login, and a session started after they were set",
        why: "Limits and groups take effect at the next login. Services of systemd ignore these \
            files and need LimitRTPRIO and LimitMEMLOCK.",
        source: VENDOR,
        judge: limits_file,
        ..SCHEDULING
    },
    Check {
        id: "rt.limit",
        wanted: "rtprio 99 or CAP_SYS_NICE",
        why: "The kernel refuses SCHED_FIFO above this limit.",
        source: VENDOR,
        judge: priority_limit,
        ..SCHEDULING
    },
    Check {
        id: "rt.memlock",
        wanted: "unlimited; the vendor's 102400 KiB suffice for small processes only",
        why: "With lock_memory and a limit that is too small, later allocations fail.",
        source: "vendor: memlock 102400; its effect on mlockall was not measured",
        judge: memlock,
        ..SCHEDULING
    },
    Check {
        id: "rt.throttle",
        wanted: "-1, or 950000 of 1000000 us",
        why: "The kernel stops a real-time thread that spins for the rest of each period; the \
            control thread sleeps instead.",
        source: "defaults of Linux",
        judge: throttle,
        ..SCHEDULING
    },
    Check {
        id: "rt.cgroup",
        wanted: "real-time runtime for the control group, if groups have their own",
        why: "With a runtime of 0, as in some containers, the kernel refuses SCHED_FIFO in the \
            group.",
        source: "general knowledge of Linux kernels",
        judge: cgroup,
        ..SCHEDULING
    },
    Check {
        id: "timer.slack",
        wanted: "any",
        why: "Timer slack: threads under the normal scheduler sleep longer by this time; threads \
            under SCHED_FIFO do not.",
        source: "general knowledge of Linux kernels",
        judge: timer_slack,
        ..SCHEDULING
    },
];

/// Command that creates a group `realtime`, whose members may use real-time priorities.
const FIX: &str = "sudo groupadd -f realtime && sudo usermod -aG realtime \"$USER\" && printf '@realtime soft rtprio 99\\n@realtime hard rtprio 99\\n@realtime soft memlock unlimited\\n@realtime hard memlock unlimited\\n' | sudo tee /etc/security/limits.d/franka.conf";

fn priority(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let fifo = readings.host.fifo();
    readings.note("SCHED_FIFO", format!("{fifo:?}"));
    Ok(match fifo {
        Ok(priority) if priority >= 99 => Judged::good(format!("granted at priority {priority}")),
        Ok(priority) => {
            Judged::warning(format!("granted at priority {priority} only")).fix(Needs::Login, FIX)
        }
        Err(refusal) => Judged::failure(format!("refused: {refusal}")).fix(Needs::Login, FIX),
    })
}

fn priority_limit(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let (soft, hard) = readings.limit("Max realtime priority")?;
    let capabilities = readings.field("/proc/self/status", "CapEff")?;
    let capabilities = u64::from_str_radix(&capabilities, 16)
        .map_err(|_| Unread::Failed("CapEff".into(), format!("`{capabilities}`")))?;
    let nice = capabilities & (1 << CAP_SYS_NICE) != 0;
    let with = if nice { "with" } else { "without" };
    let read = format!("rtprio {soft}, at most {hard}; {with} CAP_SYS_NICE");
    let enough =
        |limit: &str| limit == "unlimited" || limit.parse().is_ok_and(|limit: u64| limit >= 99);
    Ok(match nice || enough(&soft) {
        true => Judged::good(read),
        false => Judged::failure(read).fix(Needs::Login, FIX),
    })
}

const CAP_SYS_NICE: u32 = 23;

fn limits_file(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let directory = "/etc/security/limits.d";
    let mut files = vec!["/etc/security/limits.conf".to_owned()];
    let names = readings.host.list(directory).unwrap_or_default();
    files.extend(
        names
            .iter()
            .filter(|name| name.ends_with(".conf"))
            .map(|name| format!("{directory}/{name}")),
    );
    let mut groups = Vec::new();
    let mut anybody = false;
    let mut any_file = false;
    for file in files {
        let text = match readings.host.read(&file) {
            Ok(text) => text,
            Err(Unread::Absent(_)) => continue,
            Err(unread) => return Err(unread),
        };
        any_file = true;
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let ["soft" | "-", "rtprio", value] = words.get(1..4).unwrap_or_default() else {
                continue;
            };
            if words[0].starts_with('#') || value.parse().is_ok_and(|value: i64| value < 99) {
                continue;
            }
            readings.note(format!("{file}: rtprio"), line.trim());
            match words[0].strip_prefix('@') {
                Some(group) => groups.push(group.to_owned()),
                None => anybody = true,
            }
        }
    }
    if !any_file {
        return Err(Unread::Absent("/etc/security/limits.conf".into()));
    }
    if groups.is_empty() {
        return Ok(match anybody {
            true => Judged::info("rtprio 99 for single users"),
            false => Judged::info("no rtprio 99 in any file"),
        });
    }
    let group_file = readings.host.read("/etc/group")?;
    let mine = readings.field("/proc/self/status", "Groups")?;
    let mine: Vec<&str> = mine.split_whitespace().collect();
    for group in &groups {
        let line = group_file
            .lines()
            .find(|line| line.split(':').next() == Some(group));
        let Some(line) = line else { continue };
        let fields: Vec<&str> = line.split(':').collect();
        let [_, _, id, members] = fields[..] else {
            continue;
        };
        if mine.contains(&id) {
            return Ok(Judged::good(format!(
                "rtprio 99 for the group {group}, which this session is in"
            )));
        }
        if members.is_empty() {
            continue;
        }
        let members = members.split(',').count();
        return Ok(Judged::warning(format!(
            "rtprio 99 for the group {group} with {members} members, but this session is not in it: add the user, or log in again"
        ))
        .fix(Needs::Login, format!("sudo usermod -aG {group} \"$USER\"")));
    }
    let read = format!(
        "rtprio 99 for the group {}, which has no members",
        groups.join(", ")
    );
    Ok(Judged::warning(read).fix(Needs::Login, FIX))
}

fn memlock(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let (soft, hard) = readings.limit("Max locked memory")?;
    Ok(match soft.as_str() {
        "unlimited" => Judged::good("unlimited"),
        _ => Judged::warning(format!("{soft} bytes, at most {hard}")).fix(Needs::Login, FIX),
    })
}

fn throttle(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let runtime: i64 = readings.number("/proc/sys/kernel/sched_rt_runtime_us")?;
    let period: i64 = readings.number("/proc/sys/kernel/sched_rt_period_us")?;
    let read = format!("{runtime} of {period} us");
    Ok(match (runtime, period) {
        (-1, _) => Judged::good(read),
        (0, _) => Judged::failure(format!("{read}: no real-time thread runs")).fix(
            Needs::Nothing,
            "sudo sysctl kernel.sched_rt_runtime_us=950000",
        ),
        (950_000, 1_000_000) => Judged::good(read),
        _ => Judged::info(read),
    })
}

fn cgroup(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let groups = readings.text("/proc/self/cgroup")?;
    // Version 1: `4:cpu,cpuacct:/path`.
    let path = groups.lines().find_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?);
        controllers
            .split(',')
            .any(|name| name == "cpu")
            .then_some(path)
    });
    let Some(path) = path else {
        return Ok(Judged::info(
            "version 2 of control groups, which have no runtime of their own; see rt.priority",
        ));
    };
    // Inside a container, the path is the host's path.
    let files = [
        format!("/sys/fs/cgroup/cpu{path}/cpu.rt_runtime_us"),
        "/sys/fs/cgroup/cpu/cpu.rt_runtime_us".to_owned(),
    ];
    for file in files {
        match readings.number::<i64>(&file) {
            Ok(0) => {
                return Ok(Judged::failure(format!("0 us ({file})"))
                    .fix(Needs::Nothing, format!("echo 950000 | sudo tee {file}")));
            }
            Ok(runtime) => return Ok(Judged::good(format!("{runtime} us"))),
            Err(Unread::Absent(_)) => {}
            Err(unread) => return Err(unread),
        }
    }
    Ok(Judged::info("control groups have no runtime of their own"))
}

fn timer_slack(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let slack: u64 = readings.number("/proc/self/timerslack_ns")?;
    Ok(Judged::info(format!("{slack} ns")))
}
