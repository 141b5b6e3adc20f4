//! System calls of a program, and the calls that could change a host.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output};
use std::{env, fs};

/// Runs a program with these arguments under `strace`. Returns its output, and its system calls,
/// one per line. The calls go through `file`, which must not exist. `None` if programs cannot be
/// traced; with `CI=true` this is a failure.
pub(crate) fn traced(
    file: &Path,
    program: &OsStr,
    arguments: &[&str],
    variable: (&str, &OsStr),
) -> Option<(Output, String)> {
    let calls = format!("trace=%file,%network,%process,ioctl,{}", SYSTEM.join(","));
    let ran = Command::new("strace")
        // Traces all threads, with the addresses of sockets.
        .args(["-f", "-qq", "-yy", "-e", &calls, "-o"])
        .arg(file)
        .arg(program)
        .args(arguments)
        .env(variable.0, variable.1)
        .output();
    let why = match ran {
        Err(error) => format!("strace: {error}"),
        Ok(output) => match fs::read_to_string(file) {
            Ok(calls) if calls.contains("execve(") => return Some((output, calls)),
            _ => String::from_utf8_lossy(&output.stderr).into_owned(),
        },
    };
    let ci = env::var("CI").is_ok_and(|value| value == "true" || value == "1");
    assert!(!ci, "no program can be traced here: {why}");
    println!("NOTHING WAS CHECKED: no program can be traced here: {why}");
    None
}

/// Returns the calls that could change the host, or another system.
pub(crate) fn harmful(calls: &str) -> Vec<&str> {
    calls.lines().filter(|call| is_harmful(call)).collect()
}

fn is_harmful(call: &str) -> bool {
    // The end of a call that another thread interrupted has no arguments.
    let (_, call) = call.split_once(' ').expect("a process, then a call");
    let Some((name, arguments)) = call.trim_start().split_once('(') else {
        return false;
    };
    let has = |texts: &[&str]| texts.iter().any(|text| arguments.contains(text));
    match name {
        "open" | "openat" | "openat2" => has(&[
            "O_WRONLY",
            "O_RDWR",
            "O_CREAT",
            "O_TRUNC",
            "cpu_dma_latency",
        ]),
        // A connection to this computer itself; connecting a UDP socket sends nothing.
        "connect" => !has(&["127.0.0.1", "<UDP:"]),
        // A dump of all addresses: type 0x16 is RTM_GETADDR, 0x300 NLM_F_DUMP.
        "sendto" | "sendmsg" | "sendmmsg" => {
            let asks_for_addresses = has(&["nlmsg_type=0x16 ", "nlmsg_type=RTM_GETADDR"])
                && has(&["NLM_F_REQUEST|0x300", "NLM_F_DUMP"]);
            !asks_for_addresses && !has(&["127.0.0.1"])
        }
        "ioctl" => !has(&["SIOCETHTOOL", "TCGETS", "TIOCGWINSZ", "FIOCLEX", "FIONBIO"]),
        name => {
            CHANGES.contains(&name) || SYSTEM.iter().any(|it| it.trim_start_matches('?') == name)
        }
    }
}

/// Calls on files and processes that are traced together with similar calls.
const CHANGES: [&str; 28] = [
    "creat",
    "unlink",
    "unlinkat",
    "rename",
    "renameat",
    "renameat2",
    "mkdir",
    "mkdirat",
    "rmdir",
    "link",
    "linkat",
    "symlink",
    "symlinkat",
    "mknod",
    "mknodat",
    "chmod",
    "fchmodat",
    "chown",
    "fchownat",
    "lchown",
    "truncate",
    "utimensat",
    "setxattr",
    "mount",
    "umount2",
    "swapon",
    "kill",
    "tgkill",
];

/// Calls that change system-wide settings. Calls marked with `?` do not exist on all systems.
const SYSTEM: [&str; 12] = [
    "settimeofday",
    "clock_settime",
    "adjtimex",
    "clock_adjtime",
    "sethostname",
    "setdomainname",
    "init_module",
    "finit_module",
    "reboot",
    "bpf",
    "?iopl",
    "?ioperm",
];

/// Harmful calls are detected, and no others.
#[test]
fn harmful_calls_are_told_from_others() {
    for (call, expected) in [
        (
            r#"7 openat(AT_FDCWD, "/etc/passwd", O_RDONLY|O_CLOEXEC) = 3"#,
            false,
        ),
        (
            r#"7 openat(AT_FDCWD, "/sys/x", O_WRONLY|O_CLOEXEC <unfinished ...>"#,
            true,
        ),
        (
            r#"7  openat(AT_FDCWD, "/dev/cpu_dma_latency", O_RDONLY) = 3"#,
            true,
        ),
        ("7 <... openat resumed>) = 3", false),
        (r#"7 unlink("/tmp/x") = 0"#, true),
        ("7 clock_settime(CLOCK_REALTIME, {}) = 0", true),
        ("7 ioperm(0, 1, 1) = 0", true),
        (
            r#"7 sendto(5<UDP:[127.0.0.1:1]>, "x", 1, 0, NULL, 0) = 1"#,
            false,
        ),
        (
            r#"7 sendto(5<UDP:[10.0.0.1:1]>, "x", 1, 0, NULL, 0) = 1"#,
            true,
        ),
        (
            "7 connect(5<TCP:[7]>, {sin_port=htons(1337), inet_addr(\"10.0.0.2\")}, 16) = 0",
            true,
        ),
        (
            "7 connect(5<UDP:[7]>, {sin_port=htons(1337), inet_addr(\"10.0.0.2\")}, 16) = 0",
            false,
        ),
        ("7 ioctl(5<UDP:[7]>, SIOCETHTOOL, 0x7) = 0", false),
        ("7 ioctl(5<UDP:[7]>, SIOCSIFFLAGS, 0x7) = 0", true),
        ("7 tgkill(7, 8, SIGTERM) = 0", true),
    ] {
        assert_eq!(is_harmful(call), expected, "{call}");
    }
}
