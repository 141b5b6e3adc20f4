//! The doctor on the host of the tests: no check passes that cannot pass here, and nothing is
//! changed.

#[path = "trace/harm.rs"]
mod harm;

use std::ffi::OsStr;
use std::net::Ipv4Addr;
use std::time::Duration;

use franka_doctor::{Doctor, Ethtool, Host as _, Purpose, System, Verdict};

/// Environment variable that marks the traced child process.
const TRACED: &str = "FRANKA_DOCTOR_TRACED";

#[test]
fn this_host_is_judged_without_a_wrong_good() {
    let host = System::default();
    let doctor = Doctor::new(Purpose::Move)
        .robot(Ipv4Addr::LOCALHOST)
        .timing(false);
    let report = doctor.run(&host, &mut |_, _| ());
    let verdict = |id: &str| {
        let finding = report.findings.iter().find(|finding| finding.id == id);
        finding.expect("each check has a finding").verdict
    };
    if !host.kernel().is_realtime() {
        assert_eq!(verdict("kernel.rt"), Verdict::Failure);
        assert_eq!(report.exit_code(), 1);
    }
    let granted = host.fifo().is_ok();
    assert_eq!(verdict("rt.priority") == Verdict::Failure, !granted);
    assert_eq!(verdict("smi"), Verdict::Unknown);
    for (id, path) in [
        (
            "cpu.governor",
            "/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor",
        ),
        ("cpu.cstates", "/sys/devices/system/cpu/cpu0/cpuidle"),
        ("cpu.load", "/proc/pressure/cpu"),
        ("mem.thp", "/sys/kernel/mm/transparent_hugepage/enabled"),
    ] {
        let there = std::path::Path::new(path).exists();
        assert!(there || verdict(id) == Verdict::Unknown, "{id}");
    }
    // The route to this host itself has no card.
    for id in ["nic.route", "nic.kind", "nic.link", "nic.coalesce"] {
        assert_eq!(verdict(id), Verdict::Info, "{id}");
    }
}

#[test]
fn wake_ups_are_measured_and_progress_is_told() {
    let mut parts = Vec::new();
    let duration = Duration::from_millis(200);
    let measured = System::default()
        .wake_ups(duration, &mut |part| parts.push(part))
        .expect("a thread can be started");
    assert_eq!(measured.count(), 200);
    assert!(measured.min() <= measured.max());
    assert_eq!(measured.buckets().map(|(_, count)| count).sum::<u64>(), 200);
    assert_eq!(parts.last(), Some(&1.0));
}

/// Runs this test in a child process under `strace`, and checks its files and system calls.
#[test]
fn no_call_changes_the_host() {
    if std::env::var_os(TRACED).is_some() {
        check_everything();
        return;
    }
    let name = format!("franka-doctor-{}.calls", std::process::id());
    let file = std::env::temp_dir().join(name);
    let program = std::env::current_exe().expect("it runs");
    let arguments = ["no_call_changes_the_host", "--exact", "--test-threads=1"];
    let variable = (TRACED, OsStr::new("1"));
    let traced = harm::traced(&file, program.as_os_str(), &arguments, variable);
    // Missing if tracing is impossible.
    let _ = std::fs::remove_file(&file);
    let Some((output, calls)) = traced else {
        return;
    };
    assert!(output.status.success(), "{output:?}");
    let mut expected = vec!["/proc/self/limits", "<UDP:[127.0.0.1:"];
    if cfg!(not(franka_portable)) {
        expected.push("SIOCETHTOOL");
    }
    for call in expected {
        assert!(calls.contains(call), "no {call}: {calls}");
    }
    let found = harm::harmful(&calls);
    assert!(found.is_empty(), "{found:#?}");
}

/// Runs all checks of a host and of a robot, with short measurements. Echo requests are excluded,
/// because their socket does not show the destination.
fn check_everything() {
    let host = System::default();
    // The address of another host on any existing route; nothing is sent.
    let doctor = Doctor::new(Purpose::Move)
        .robot(Ipv4Addr::new(192, 0, 2, 1))
        .timing(false);
    assert!(!doctor.run(&host, &mut |_, _| ()).findings.is_empty());
    let (short, here) = (Duration::from_millis(20), Ipv4Addr::LOCALHOST);
    for measured in [
        host.wake_ups(short, &mut |_| ()),
        host.loopback(short, &mut |_| ()),
    ] {
        assert_eq!(measured.expect("a thread, and sockets").count(), 20);
    }
    // The loopback interface has no card, so its driver does not answer.
    let _ = host.ethtool("lo", Ethtool::Coalescing);
    // Refused if the host has no readable frequency.
    let _ = host.busy_frequency(0);
    // Most likely no service listens there.
    let ports = franka_doctor::ports(here.into(), Purpose::Move);
    assert_eq!(ports.len(), 3);
    assert!(!franka_doctor::answers((here, 1).into()).is_empty());
    let _ = franka_doctor::ask_desk((here, 1).into());
}
