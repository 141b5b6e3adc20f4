//! The doctor on the host that the tests run on: nothing is good that cannot be, and nothing is
//! changed.

use std::net::Ipv4Addr;
use std::process::Command;

use franka_doctor::{Doctor, Host as _, Purpose, System, Verdict};

/// Set in the child that is traced.
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
    // There is no card on the way to this very host.
    for id in ["nic.route", "nic.kind", "nic.link", "nic.coalesce"] {
        assert_eq!(verdict(id), Verdict::Info, "{id}");
    }
}

#[test]
fn wake_ups_are_measured_and_progress_is_told() {
    let mut parts = Vec::new();
    let duration = core::time::Duration::from_millis(200);
    let measured = System::default()
        .wake_ups(duration, &mut |part| parts.push(part))
        .expect("a thread can be started");
    assert_eq!(measured.count(), 200);
    assert!(measured.min() <= measured.max());
    assert_eq!(measured.buckets().map(|(_, count)| count).sum::<u64>(), 200);
    assert_eq!(parts.last(), Some(&1.0));
}

/// Runs this test in a child under `strace`, and looks at what it opens and calls.
#[test]
fn no_call_changes_the_host() {
    if std::env::var_os(TRACED).is_some() {
        // An address of another host on any way that there is; nothing is sent.
        let doctor = Doctor::new(Purpose::Move)
            .robot(Ipv4Addr::new(192, 0, 2, 1))
            .timing(false);
        let report = doctor.run(&System::default(), &mut |_, _| ());
        assert!(!report.findings.is_empty());
        return;
    }
    let program = std::env::current_exe().expect("it runs");
    let traced = Command::new("strace")
        .args(["-f", "-qq", "-e", "trace=%file,%network,ioctl,%process"])
        .arg(program)
        .args(["no_call_changes_the_host", "--exact", "--test-threads=1"])
        .env(TRACED, "1")
        .output();
    let Ok(output) = traced else {
        println!("NOTHING WAS CHECKED: there is no strace here");
        return;
    };
    let calls = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() && calls.contains("ptrace") {
        println!("NOTHING WAS CHECKED: a child cannot be traced here: {calls}");
        return;
    }
    assert!(output.status.success(), "{calls}");
    assert!(
        calls.contains("/proc/self/limits"),
        "the trace has the checks: {calls}"
    );
    let harmful = |line: &&str| {
        let opens = line.contains("open(") || line.contains("openat(");
        let writes = ["O_WRONLY", "O_RDWR", "O_CREAT", "O_TRUNC"];
        let changes = [
            "unlink",
            "rename(",
            "renameat",
            "mkdir",
            "rmdir",
            "chmod",
            "chown",
            "truncate(",
            "symlink",
            "mount(",
            "sendto(",
            "sendmsg(",
            "connect(",
            "kill(",
            "cpu_dma_latency",
        ];
        // Connecting a UDP socket sends nothing.
        let looks_up_the_way = line.contains("connect(") && line.contains("htons(1337)");
        // A dump of all addresses: type 0x16 is RTM_GETADDR, 0x300 NLM_F_DUMP.
        let asks_for_addresses = line.contains("sendto(")
            && (line.contains("nlmsg_type=0x16 ") || line.contains("nlmsg_type=RTM_GETADDR"))
            && (line.contains("NLM_F_REQUEST|0x300") || line.contains("NLM_F_DUMP"));
        let is_harmless = looks_up_the_way || asks_for_addresses;
        let asks = !line.contains("ioctl(")
            || line.contains("SIOCETHTOOL")
            || line.contains("TCGETS")
            || line.contains("FIOCLEX")
            || line.contains("TIOCGWINSZ");
        (opens && writes.iter().any(|flag| line.contains(flag)))
            || (changes.iter().any(|call| line.contains(call)) && !is_harmless)
            || !asks
    };
    let found: Vec<&str> = calls.lines().filter(harmful).collect();
    assert!(found.is_empty(), "{found:#?}");
}
