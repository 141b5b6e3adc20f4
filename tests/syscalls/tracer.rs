//! A tracer of system calls: the kernel stops a child process at each call and notifies this one.
//!
//! ```text
//! this process --fork--> child: PTRACE_TRACEME, exec of this same program for one test
//!      ^                   |-- thread with another name: runs free
//!      +---- every call ---+-- thread with a name that is asked for: stopped at each call
//! ```
//!
//! Tracing a child process needs no privilege. No thread escapes: new threads are traced from their
//! first instruction, and released only once they have set another name.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};

use nix::errno::Errno;
use nix::sys::ptrace::{self, Options};
use nix::sys::signal::Signal;
use nix::sys::wait::{WaitPidFlag, WaitStatus, waitpid};
use nix::unistd::Pid;

/// Set in the child.
const TRACED: &str = "FRANKA_TESTS_TRACED";

/// True if this process is the traced child.
pub(crate) fn in_the_child() -> bool {
    env::var_os(TRACED).is_some()
}

/// One system call, at its entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Call {
    /// Its number on this platform.
    pub(crate) number: i64,
    /// For `write`: the target of the descriptor in `/proc`.
    pub(crate) target: Option<String>,
}

/// The calls of one thread, in order.
#[derive(Debug, Default)]
pub(crate) struct Calls {
    /// The name of the thread.
    pub(crate) name: String,
    /// The calls from the setting of its name to its end.
    pub(crate) calls: Vec<Call>,
}

/// Runs this program's test `test` in a child, and returns the calls of all its threads that have
/// one of these `names`.
///
/// # Errors
/// If the system refuses to start or to trace the child.
///
/// # Panics
/// If the test fails in the child.
pub(crate) fn run(test: &str, names: &[&str]) -> io::Result<Vec<Calls>> {
    let mut command = Command::new(env::current_exe()?);
    command
        .args([test, "--exact", "--nocapture", "--test-threads=1"])
        .env(TRACED, "1")
        .stdin(Stdio::null())
        .stdout(Stdio::null());
    // SAFETY: between fork and exec the closure makes one system call, which takes no lock and
    // allocates nothing; its error is a number.
    unsafe { command.pre_exec(|| ptrace::traceme().map_err(io::Error::from)) };
    // Only the thread that forks a child is its tracer and may wait for it.
    let child = command.spawn()?;
    let root = Pid::from_raw(child.id().cast_signed());
    // The child stops at the exec.
    waitpid(root, Some(WaitPidFlag::__WALL))?;
    let options =
        Options::PTRACE_O_EXITKILL | Options::PTRACE_O_TRACECLONE | Options::PTRACE_O_TRACESYSGOOD;
    ptrace::setoptions(root, options)?;
    ptrace::cont(root, None)?;
    let mut tracer = Tracer {
        root,
        names,
        threads: BTreeMap::from([(root, Followed::Free)]),
        done: Vec::new(),
    };
    while tracer.step()? {}
    Ok(tracer.done)
}

/// Tracing level of a thread.
enum Followed {
    /// Only its end and its new threads.
    Free,
    /// Every call, until it sets its name: before that, it has the name of the thread that created
    /// it.
    Unnamed,
    /// Inside the call that sets its name.
    Naming,
    /// Every call, recorded.
    Noted(Calls),
}

struct Tracer<'a> {
    root: Pid,
    names: &'a [&'a str],
    threads: BTreeMap<Pid, Followed>,
    done: Vec<Calls>,
}

impl Tracer<'_> {
    /// Waits for one event and resumes the thread. False after the end of the child.
    fn step(&mut self) -> io::Result<bool> {
        // Children of this process's other threads are not waited for here.
        let flags = WaitPidFlag::__WALL | WaitPidFlag::__WNOTHREAD;
        match waitpid(None, Some(flags))? {
            WaitStatus::PtraceSyscall(thread) => {
                self.note(thread)?;
                self.go_on(thread, None)?;
            }
            WaitStatus::PtraceEvent(thread, ..) => self.go_on(thread, None)?,
            WaitStatus::Stopped(thread, signal) => {
                // A new thread begins with a stop by ptrace, not by a signal.
                let begins = !self.threads.contains_key(&thread);
                self.threads.entry(thread).or_insert(Followed::Unnamed);
                self.go_on(thread, (!begins).then_some(signal))?;
            }
            WaitStatus::Exited(thread, code) => {
                self.end(thread);
                if thread == self.root {
                    assert_eq!(code, 0, "the test fails in the child");
                    return Ok(false);
                }
            }
            WaitStatus::Signaled(thread, signal, _) => {
                self.end(thread);
                assert_ne!(thread, self.root, "the child died of {signal}");
            }
            WaitStatus::Continued(_) | WaitStatus::StillAlive => {}
        }
        Ok(true)
    }

    /// Records a call at its entry. At the return of the call that names a thread, decides how to
    /// follow that thread.
    fn note(&mut self, thread: Pid) -> io::Result<()> {
        let info = match ptrace::syscall_info(thread) {
            Ok(info) => info,
            // Killed during the stop, by the end of its process.
            Err(Errno::ESRCH) => return Ok(()),
            Err(error) => return Err(error.into()),
        };
        let entry = (info.op == libc::PTRACE_SYSCALL_INFO_ENTRY).then(|| {
            // SAFETY: `op` states that the kernel has filled in this member of the union, which is
            // plain integers.
            let entry = unsafe { info.u.entry };
            (entry.nr.cast_signed(), entry.args)
        });
        let followed = self.threads.get_mut(&thread);
        match (followed, entry) {
            (Some(Followed::Noted(calls)), Some((number, arguments))) => {
                let target = (number == libc::SYS_write).then(|| {
                    let link = format!("/proc/{thread}/fd/{}", arguments[0]);
                    let target = fs::read_link(link).unwrap_or_default();
                    target.to_string_lossy().into_owned()
                });
                calls.calls.push(Call { number, target });
            }
            (Some(followed @ Followed::Unnamed), Some((libc::SYS_prctl, arguments)))
                if arguments[0] == libc::PR_SET_NAME as u64 =>
            {
                *followed = Followed::Naming;
            }
            (Some(followed @ Followed::Naming), None) => {
                let name = fs::read_to_string(format!("/proc/{}/task/{thread}/comm", self.root))?;
                let name = name.trim_end();
                *followed = if self.names.contains(&name) {
                    Followed::Noted(Calls {
                        name: name.to_owned(),
                        calls: Vec::new(),
                    })
                } else {
                    Followed::Free
                };
            }
            _ => {}
        }
        Ok(())
    }

    fn go_on(&self, thread: Pid, signal: Option<Signal>) -> io::Result<()> {
        let free = matches!(self.threads.get(&thread), Some(Followed::Free));
        let gone_on = if free {
            ptrace::cont(thread, signal)
        } else {
            ptrace::syscall(thread, signal)
        };
        match gone_on {
            Ok(()) | Err(Errno::ESRCH) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    fn end(&mut self, thread: Pid) {
        if let Some(Followed::Noted(calls)) = self.threads.remove(&thread) {
            self.done.push(calls);
        }
    }
}
