//! Locking memory concerns the whole process, so this test has its own process.

use franka_rt::sched::{Realtime, SchedError, Scheduling};

#[test]
fn locked_memory_shows_in_the_process_or_the_refusal_is_told() {
    let asked = Scheduling {
        realtime: Realtime::Ignore,
        lock_memory: true,
        ..Scheduling::default()
    };
    let granted = std::thread::spawn(move || asked.enter())
        .join()
        .expect("entering does not panic");
    let refusals = granted.expect("nothing is enforced").refusals;
    let refused = refusals
        .iter()
        .any(|refusal| matches!(refusal, SchedError::LockMemory(_)));
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux has /proc");
    let line = status
        .lines()
        .find(|line| line.starts_with("VmLck:"))
        .expect("proc_pid_status(5)");
    let locked: u64 = line
        .split_whitespace()
        .nth(1)
        .and_then(|kb| kb.parse().ok())
        .expect("a number of kB");
    assert_eq!(locked > 0, !refused, "{line}, {refusals:?}");
}
