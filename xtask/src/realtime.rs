//! The right to real-time scheduling, with which some tests check more.

use std::process::{self, Command, Stdio};

/// Obtains the right to `SCHED_FIFO` for child processes. If it is missing, raises the limit if
/// this user may do that; with `CI=true` also by sudo without a password.
///
/// # Errors
/// If the right cannot be obtained.
pub fn obtain() -> Result<(), String> {
    let limit = |program: &[&str]| {
        let process = process::id().to_string();
        let limit = ["prlimit", "--rtprio=99:99", "--pid", &process];
        succeeds(&[program, &limit].concat())
    };
    let granted = || succeeds(&["chrt", "--fifo", "1", "true"]);
    if granted()
        || limit(&[]) && granted()
        || crate::workspace::is_ci() && limit(&["sudo", "--non-interactive"]) && granted()
    {
        return Ok(());
    }
    Err("the system did not grant SCHED_FIFO: threads ran without priority".to_owned())
}

/// Set for the tests if the right is available: the control thread must then have its priority.
pub const GRANTED: &str = "FRANKA_REALTIME_GRANTED";

/// True if a program can be run without input, and succeeds.
pub fn succeeds(line: &[&str]) -> bool {
    let mut command = Command::new(line[0]);
    command.args(&line[1..]).stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_fails_or_is_not_there_does_not_succeed() {
        assert!(succeeds(&["true"]));
        assert!(!succeeds(&["false"]));
        assert!(!succeeds(&["no-such-program"]));
    }
}
