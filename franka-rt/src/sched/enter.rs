//! Requests to the operating system, and their results.

use core::time::Duration;
use std::net::{Ipv4Addr, UdpSocket};
use std::os::fd::AsFd;

use super::{
    BUSY_POLL_MAX, Granted, Kernel, PREFAULT_MAX, Realtime, SchedError, Scheduling, stack,
};
use crate::sys;

impl Scheduling {
    /// Applies the options to the calling thread, touches its stack, and blocks signals so that no
    /// signal handler of the process runs on it. As in libfranka 0.21, the scheduling is set before
    /// the kernel is checked.
    ///
    /// Signals that report a fault of the thread itself (such as `SIGSEGV`) are not blocked.
    /// Threads and processes that the thread starts later inherit the other settings.
    ///
    /// # Errors
    /// Under [`Realtime::Enforce`], returns the first refusal; earlier requests stay granted. Under
    /// either [`Realtime`], returns an error if an option is out of range, and makes no request.
    pub fn enter(&self) -> Result<Granted, SchedError> {
        self.enter_on(Kernel::read)
    }

    /// Does the same as [`Self::enter`], on a host with this kernel.
    fn enter_on(&self, kernel: impl FnOnce() -> Kernel) -> Result<Granted, SchedError> {
        self.check()?;
        sys::block_signals();
        let mut granted = Granted::default();
        match self.set_fifo() {
            Ok(priority) => granted.priority = Some(priority),
            Err(error) => self.refused(error, &mut granted)?,
        }
        if self.realtime == Realtime::Enforce {
            let kernel = kernel();
            if !kernel.is_realtime() {
                return Err(SchedError::KernelNotRealtime(kernel.into()));
            }
        }
        if let Some(cpu) = self.cpu
            && let Err(errno) = sys::pin_to(cpu)
        {
            self.refused(SchedError::Pin { cpu, errno }, &mut granted)?;
        }
        if self.lock_memory
            && let Err(errno) = sys::lock_memory()
        {
            self.refused(SchedError::LockMemory(errno), &mut granted)?;
        }
        stack::touch(self.prefault_stack);
        Ok(granted)
    }

    /// Applies the options to the socket that the thread receives from, and adds the result to
    /// `granted`.
    ///
    /// # Errors
    /// Under [`Realtime::Enforce`], returns [`SchedError::BusyPoll`] if the system refuses to poll.
    pub fn tune(&self, socket: &impl AsFd, granted: &mut Granted) -> Result<(), SchedError> {
        self.check()?;
        let Some(duration) = self.busy_poll else {
            return Ok(());
        };
        match sys::busy_poll(socket, duration) {
            Ok(()) => granted.busy_poll = Some(duration),
            Err(errno) => self.refused(SchedError::BusyPoll { duration, errno }, granted)?,
        }
        Ok(())
    }

    /// Returns the size of the stack that the thread needs, in bytes.
    pub(crate) fn stack_size(&self) -> usize {
        stack::size(self.prefault_stack.min(PREFAULT_MAX))
    }

    /// Checks that every option is in its range.
    fn check(&self) -> Result<(), SchedError> {
        let polled = Duration::from_micros(1)..=BUSY_POLL_MAX;
        match self.busy_poll {
            Some(got) if !polled.contains(&got) => Err(SchedError::BusyPollRange { got }),
            _ if self.prefault_stack > PREFAULT_MAX => Err(SchedError::PrefaultRange {
                got: self.prefault_stack,
            }),
            _ => Ok(()),
        }
    }

    /// Checks whether this process would be granted the requests for a thread, except for memory.
    /// Call it before contacting a robot. The checks run in a short-lived thread, so the caller
    /// keeps its own scheduling.
    ///
    /// # Errors
    /// Returns the errors of [`Self::enter`] and [`Self::tune`]. If the thread cannot be started,
    /// returns the error for refused scheduling.
    pub fn probe(&self) -> Result<Granted, SchedError> {
        self.check()?;
        let asked = Self {
            lock_memory: false,
            ..self.clone()
        };
        let probe = std::thread::Builder::new()
            .name("franka-probe".into())
            .stack_size(self.stack_size())
            .spawn(move || {
                let mut granted = asked.enter()?;
                if let Ok(socket) = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)) {
                    asked.tune(&socket, &mut granted)?;
                }
                Ok(granted)
            })
            .map_err(|error| {
                SchedError::SetScheduling(error.raw_os_error().unwrap_or(libc::EAGAIN))
            })?;
        probe
            .join()
            .expect("asking the operating system does not panic")
    }

    fn set_fifo(&self) -> Result<i32, SchedError> {
        let priority = match self.priority {
            Some(priority) => priority,
            None => sys::max_fifo_priority().map_err(SchedError::MaximumPriority)?,
        };
        sys::set_fifo(priority).map_err(SchedError::SetScheduling)?;
        Ok(priority)
    }

    fn refused(&self, error: SchedError, granted: &mut Granted) -> Result<(), SchedError> {
        match self.realtime {
            Realtime::Enforce => Err(error),
            Realtime::Ignore => {
                granted.refusals.push(error);
                Ok(())
            }
        }
    }
}

#[cfg(all(test, target_os = "linux", not(franka_portable)))]
mod tests;

#[cfg(all(test, any(not(target_os = "linux"), franka_portable)))]
mod portable_tests {
    use super::*;

    #[test]
    fn elsewhere_than_on_linux_nothing_is_granted() {
        let asked = Scheduling {
            cpu: Some(0),
            lock_memory: true,
            busy_poll: Some(Duration::from_micros(50)),
            ..Scheduling::default()
        };
        let refusal = asked.probe().expect_err("a robot takes a real-time thread");
        let text = "libfranka: unable to get maximum possible thread priority: ";
        assert!(refusal.to_string().starts_with(text), "{refusal}");
        let ignored = Scheduling {
            realtime: Realtime::Ignore,
            ..asked
        };
        let granted = ignored.probe().expect("a simulated robot takes none");
        assert_eq!((granted.priority, granted.busy_poll), (None, None));
        let [
            SchedError::MaximumPriority(_),
            SchedError::Pin { cpu: 0, .. },
            SchedError::BusyPoll { .. },
        ] = &granted.refusals[..]
        else {
            panic!("{granted:?}")
        };
    }
}
