//! Reports about hosts whose files are in `fixtures`, compared exactly with the texts in `golden`.
//!
//! The texts contain the files that the checks read, modelled after real hosts; none is a copy of a
//! real host. With `FRANKA_DOCTOR_REWRITE=1` the texts are rewritten.

use std::fs;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};

use franka_doctor::{
    Doctor, Evidence, Purpose, Readings, Report, Selection, Tree, Verdict, likely_causes,
};

const HOSTS: [&str; 7] = [
    "ubuntu_pro_realtime",
    "debian13_realtime",
    "raspberry_pi5",
    "container",
    "wsl",
    "laptop_on_battery",
    "usb_card",
];

const ROBOT: Ipv4Addr = Ipv4Addr::new(172, 16, 0, 2);

fn directory(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(name)
}

fn tree(host: &str) -> Tree {
    let text = fs::read_to_string(directory("fixtures").join(format!("{host}.txt")));
    Tree::new(&text.expect("a host"))
}

/// Returns the robot address to which this host has a route.
fn robot(host: &str) -> Ipv4Addr {
    match host {
        "laptop_on_battery" => Ipv4Addr::new(192, 168, 1, 30),
        _ => ROBOT,
    }
}

fn report(host: &str, purpose: Purpose) -> Report {
    let doctor = Doctor::new(purpose).robot(robot(host)).ping(true);
    doctor.run(&tree(host), &mut |_, _| ())
}

fn verdict(report: &Report, id: &str) -> Verdict {
    let finding = report.findings.iter().find(|finding| finding.id == id);
    finding.unwrap_or_else(|| panic!("no {id}")).verdict
}

#[test]
fn reports_are_those_in_golden() {
    let rewrite = std::env::var_os("FRANKA_DOCTOR_REWRITE").is_some();
    for host in HOSTS {
        let moving = report(host, Purpose::Move);
        let text = format!(
            "{}\n{}\nexit code {}\n\n{}",
            moving.to_text(false),
            report(host, Purpose::Read)
                .to_text(false)
                .lines()
                .last()
                .expect("a count"),
            moving.exit_code(),
            moving.fix_script(),
        );
        let path = directory("golden").join(format!("{host}.txt"));
        if rewrite {
            fs::write(&path, text).expect("a file");
            continue;
        }
        let golden = fs::read_to_string(&path).expect("a golden text");
        assert_eq!(text, golden, "{host}");
    }
}

#[test]
fn report_finds_the_known_facts_of_each_host() {
    use Verdict::{Failure, Good, Info, Unknown, Warning};
    for (host, id, expected) in [
        ("ubuntu_pro_realtime", "kernel.rt", Good),
        ("ubuntu_pro_realtime", "timing.wake_up", Good),
        ("ubuntu_pro_realtime", "timing.loopback", Good),
        ("raspberry_pi5", "timing.loopback", Info),
        ("wsl", "timing.loopback", Failure),
        ("container", "timing.loopback", Unknown),
        ("ubuntu_pro_realtime", "smi", Unknown),
        // This host has no /sys/kernel/realtime.
        ("debian13_realtime", "kernel.rt", Good),
        // The user is in the group, but the session is not yet.
        ("debian13_realtime", "rt.limits_file", Warning),
        ("debian13_realtime", "rt.priority", Failure),
        ("debian13_realtime", "cpu.cstates", Warning),
        ("raspberry_pi5", "kernel.rt", Failure),
        ("raspberry_pi5", "virt", Unknown),
        ("raspberry_pi5", "mem.thp", Unknown),
        ("container", "virt", Info),
        ("container", "rt.cgroup", Failure),
        ("container", "cpu.governor", Unknown),
        ("container", "nic.route", Warning),
        ("container", "timing.wake_up", Unknown),
        ("wsl", "virt", Warning),
        ("wsl", "timing.wake_up", Failure),
        ("laptop_on_battery", "power", Warning),
        ("laptop_on_battery", "nic.kind", Failure),
        ("laptop_on_battery", "nic.link", Unknown),
        ("usb_card", "nic.kind", Warning),
        ("usb_card", "nic.coalesce", Failure),
        ("usb_card", "nic.errors", Warning),
        ("ubuntu_pro_realtime", "robot.ping", Good),
        ("debian13_realtime", "robot.ping", Info),
        ("container", "robot.ping", Unknown),
        ("container", "nic.mtu", Warning),
        ("usb_card", "nic.errors_now", Good),
        ("laptop_on_battery", "robot.ping", Failure),
        ("usb_card", "robot.ping", Failure),
        ("debian13_realtime", "cpu.freq_now", Good),
        ("laptop_on_battery", "cpu.freq_now", Info),
        ("container", "cpu.freq_now", Unknown),
        ("ubuntu_pro_realtime", "nic.nm", Good),
        ("laptop_on_battery", "nic.nm", Info),
        ("ubuntu_pro_realtime", "nic.pause", Good),
        ("debian13_realtime", "nic.pause", Info),
        ("usb_card", "nic.ring", Unknown),
        ("ubuntu_pro_realtime", "disk", Good),
        ("raspberry_pi5", "disk", Info),
    ] {
        assert_eq!(
            verdict(&report(host, Purpose::Move), id),
            expected,
            "{host}: {id}"
        );
    }
}

#[test]
fn kernel_advice_works_on_the_host() {
    let advice = |files: &[(&str, &str)]| {
        let plain = [("proc/sys/kernel/version", "#1 SMP PREEMPT")];
        let files = plain.iter().chain(files);
        let blocks = files.map(|(path, content)| format!("== /{path} ==\n{content}\n"));
        let host = Tree::new(&blocks.collect::<String>());
        let kernel = Selection::new(vec!["kernel.rt".into()], Vec::new());
        let doctor = Doctor::new(Purpose::Move).select(kernel);
        let report = doctor.run(&host, &mut |_, _| ());
        let [finding] = &report.findings[..] else {
            panic!("{:?}", report.findings)
        };
        assert_eq!(finding.verdict, Verdict::Failure);
        let command = finding.fix.as_ref().map(|fix| fix.command.clone());
        (command, finding.read.clone())
    };
    let system = |id: &str, version: &str| format!("ID={id}\nVERSION_ID=\"{version}\"\n");
    let (model, release) = ("proc/device-tree/model", "proc/sys/kernel/osrelease");
    let pi = (model, "Raspberry Pi 5 Model B Rev 1.0\0");
    let orin = (model, "NVIDIA Jetson AGX Orin Developer Kit\0");
    for (id, version, extra, command, words) in [
        (
            "ubuntu",
            "22.04",
            None,
            "sudo pro enable realtime-kernel",
            "",
        ),
        (
            "ubuntu",
            "26.04",
            None,
            "sudo pro enable realtime-kernel",
            "",
        ),
        ("ubuntu", "24.04", Some(pi), "--variant=raspi", ""),
        ("ubuntu", "22.04", Some(pi), "", "24.04 or later"),
        ("ubuntu", "20.04", None, "", "Ubuntu 20.04 has no package"),
        ("ubuntu", "18.04", None, "", "upgrade to 22.04 or later"),
        ("ubuntu", "22.04", Some(orin), "", "real-time packages"),
        (
            "ubuntu",
            "22.04",
            Some((release, "5.10.216-tegra")),
            "",
            "Jetson",
        ),
        ("debian", "13", None, "sudo apt install linux-image-rt-", ""),
        ("debian", "12", Some(pi), "linux-image-rpi-v8-rt", ""),
        ("debian", "12", Some((".dockerenv", "")), "", "its host"),
        (
            "ubuntu",
            "24.04",
            Some(("proc/version", "Linux 5.15-microsoft")),
            "",
            "WSL",
        ),
        ("fedora", "43", None, "", ""),
    ] {
        let system = system(id, version);
        let files: Vec<_> = extra
            .into_iter()
            .chain([("etc/os-release", &*system)])
            .collect();
        let (fix, read) = advice(&files);
        assert_eq!(fix.is_some(), !command.is_empty(), "{files:?}: {fix:?}");
        assert!(fix.unwrap_or_default().contains(command), "{files:?}");
        assert!(read.contains(words), "{files:?}: {read}");
    }
}

#[test]
fn only_what_is_selected_is_checked() {
    let selection = Selection::new(vec!["nic".into()], vec!["nic.kind".into()]);
    let doctor = Doctor::new(Purpose::Move).robot(ROBOT).ping(true);
    let report = doctor
        .select(selection)
        .run(&tree("usb_card"), &mut |_, _| ());
    let ids: Vec<&str> = report.findings.iter().map(|finding| finding.id).collect();
    assert!(ids.contains(&"nic.coalesce") && ids.contains(&"nic.errors_now"));
    assert!(ids.iter().all(|id| id.starts_with("nic.")), "{ids:?}");
    assert!(!ids.contains(&"nic.kind"), "{ids:?}");
}

#[test]
fn any_host_may_simulate_and_only_the_good_one_may_move() {
    for host in HOSTS {
        assert_eq!(report(host, Purpose::Sim).exit_code(), 0, "{host}");
        let expected = u8::from(host != "ubuntu_pro_realtime");
        assert_eq!(report(host, Purpose::Move).exit_code(), expected, "{host}");
    }
}

#[test]
fn unknown_findings_say_what_is_missing_and_have_no_fix() {
    // A host without files: no check can be good.
    let nothing = Tree::default();
    let report = Doctor::new(Purpose::Move).run(&nothing, &mut |_, _| ());
    assert_eq!(
        report.count(Verdict::Good),
        0,
        "{}",
        report.to_detailed_text(false)
    );
    for finding in report
        .findings
        .iter()
        .filter(|found| found.verdict == Verdict::Unknown)
    {
        assert!(finding.read.starts_with("unknown: "), "{finding:?}");
        assert_eq!(finding.fix, None);
    }
    assert_eq!(verdict(&report, "nic.route"), Verdict::Unknown);
}

#[test]
fn findings_have_wish_reason_source_and_unique_id() {
    let report = report("usb_card", Purpose::Move);
    let book = include_str!("../../docs/src/doctor.md");
    for (index, finding) in report.findings.iter().enumerate() {
        for text in [
            finding.wanted,
            finding.why,
            finding.source,
            finding.read.as_str(),
        ] {
            assert!(!text.is_empty(), "{finding:?}");
        }
        let id = format!("`{}`", finding.id);
        assert!(book.contains(&id), "the book has no {id}");
        let others = &report.findings[index + 1..];
        assert!(
            others.iter().all(|other| other.id != finding.id),
            "{}",
            finding.id
        );
    }
}

#[test]
fn json_hides_names_and_serial_numbers_unless_asked() {
    let doctor = Doctor::new(Purpose::Move).robot(ROBOT);
    for (host, hidden) in [
        ("raspberry_pi5", "serial=10000000abcdef01"),
        (
            "ubuntu_pro_realtime",
            "6f1d1b7a-0c1e-4b1e-9d6e-0123456789ab",
        ),
    ] {
        let shown = doctor
            .clone()
            .redact(false)
            .run(&tree(host), &mut |_, _| ())
            .to_json();
        assert!(shown.contains(hidden), "{shown}");
        let json = doctor.run(&tree(host), &mut |_, _| ()).to_json();
        assert!(!json.contains(hidden), "{json}");
        assert!(json.contains("\"schema\": 1"), "{json}");
        assert!(
            json.contains("/proc/sys/kernel/sched_rt_runtime_us"),
            "{json}"
        );
    }
}

#[test]
fn the_two_likeliest_causes_are_failures_first() {
    let causes = |host, evidence| {
        let tree = tree(host);
        let readings = Readings::new(&tree, Some(robot(host)));
        likely_causes(&readings, evidence)
            .iter()
            .map(|finding| finding.id)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        causes("usb_card", Evidence::Lost),
        ["nic.coalesce", "nic.kind"]
    );
    assert_eq!(
        causes("laptop_on_battery", Evidence::Late),
        ["kernel.rt", "rt.limit"]
    );
    assert_eq!(
        causes("laptop_on_battery", Evidence::LinkLost),
        ["nic.kind", "nic.power"]
    );
    assert_eq!(
        causes("ubuntu_pro_realtime", Evidence::Late),
        Vec::<&str>::new()
    );
}
