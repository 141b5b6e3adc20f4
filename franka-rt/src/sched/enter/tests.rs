//! Tests of the effect that the scheduling options have in the kernel.

use super::*;

/// Runs `asked.enter()` in a new thread. Returns the result and the lines of `/proc` about that
/// thread.
fn entered(asked: Scheduling) -> (Result<Granted, SchedError>, String, String) {
    std::thread::spawn(move || {
        let granted = asked.enter();
        let read = |file| std::fs::read_to_string(file).expect("Linux has /proc");
        (
            granted,
            read("/proc/thread-self/stat"),
            read("/proc/thread-self/status"),
        )
    })
    .join()
    .expect("entering does not panic")
}

/// Returns real-time priority and policy: fields 40 and 41 of `proc_pid_stat(5)`, counted after the
/// name in parentheses.
fn priority_and_policy(stat: &str) -> (i32, i32) {
    let fields: Vec<&str> = stat[stat.rfind(')').expect("a name") + 1..]
        .split_whitespace()
        .collect();
    (
        fields[40 - 3].parse().expect("a number"),
        fields[41 - 3].parse().expect("a number"),
    )
}

#[test]
fn ignore_accepts_refusals_and_reports_what_the_kernel_did() {
    let asked = Scheduling {
        realtime: Realtime::Ignore,
        priority: Some(7),
        ..Scheduling::default()
    };
    let (granted, stat, _) = entered(asked);
    let granted = granted.expect("nothing is enforced");
    match granted.priority {
        Some(priority) => {
            assert_eq!(
                (priority, 1),
                priority_and_policy(&stat),
                "policy 1 is SCHED_FIFO"
            );
            assert_eq!(granted.refusals, []);
        }
        None => {
            assert_eq!(
                (0, 0),
                priority_and_policy(&stat),
                "policy 0 is the normal one"
            );
            assert_eq!(granted.refusals, [SchedError::SetScheduling(libc::EPERM)]);
        }
    }
}

#[test]
fn a_priority_out_of_range_is_refused() {
    let asked = Scheduling {
        priority: Some(1000),
        ..Scheduling::default()
    };
    assert_eq!(
        entered(asked.clone()).0,
        Err(SchedError::SetScheduling(libc::EINVAL))
    );
    assert_eq!(asked.probe(), Err(SchedError::SetScheduling(libc::EINVAL)));
    let (granted, stat, _) = entered(Scheduling {
        realtime: Realtime::Ignore,
        ..asked
    });
    assert_eq!(
        granted.expect("nothing is enforced").refusals,
        [SchedError::SetScheduling(libc::EINVAL)]
    );
    assert_eq!((0, 0), priority_and_policy(&stat));
}

#[test]
fn enforce_needs_both_the_right_to_fifo_and_a_realtime_kernel() {
    let enter = |version: &str| {
        let kernel = Kernel {
            version: version.into(),
            ..Kernel::default()
        };
        let asked = Scheduling {
            priority: Some(1),
            ..Scheduling::default()
        };
        let entered = std::thread::spawn(move || asked.enter_on(|| kernel));
        entered.join().expect("entering does not panic")
    };
    match enter("#1 SMP PREEMPT_RT") {
        Ok(granted) => {
            assert_eq!((granted.priority, granted.refusals.len()), (Some(1), 0));
            let refused = enter("#1 SMP PREEMPT_DYNAMIC");
            let Err(SchedError::KernelNotRealtime(kernel)) = refused else {
                panic!("{refused:?}")
            };
            assert_eq!(kernel.version, "#1 SMP PREEMPT_DYNAMIC");
        }
        Err(error) => {
            let fifo = SchedError::SetScheduling(libc::EPERM);
            assert_eq!(error, fifo, "the process may not use SCHED_FIFO");
            assert_eq!(
                enter("#1 SMP PREEMPT_DYNAMIC"),
                Err(fifo),
                "this comes first"
            );
        }
    }
}

#[test]
fn signals_are_blocked_but_for_those_that_report_a_fault() {
    let (_, _, status) = entered(Scheduling {
        realtime: Realtime::Ignore,
        ..Scheduling::default()
    });
    let mask = status.lines().find_map(|line| line.strip_prefix("SigBlk:"));
    let mask = u64::from_str_radix(mask.expect("a mask").trim(), 16).expect("a number");
    let blocked = |signal: i32| mask >> (signal - 1) & 1 == 1;
    for signal in [
        libc::SIGINT,
        libc::SIGTERM,
        libc::SIGALRM,
        libc::SIGPROF,
        libc::SIGUSR1,
    ] {
        assert!(blocked(signal), "{signal}: {status}");
    }
    for signal in [
        libc::SIGSEGV,
        libc::SIGBUS,
        libc::SIGFPE,
        libc::SIGILL,
        libc::SIGABRT,
    ] {
        assert!(!blocked(signal), "{signal}: {status}");
    }
}

#[test]
fn thread_runs_on_the_requested_processor_if_it_exists() {
    let asked = Scheduling {
        realtime: Realtime::Ignore,
        cpu: Some(0),
        ..Scheduling::default()
    };
    let (granted, _, status) = entered(asked.clone());
    let pinned = status.contains("Cpus_allowed_list:\t0\n");
    let refused = granted
        .expect("nothing is enforced")
        .refusals
        .iter()
        .any(|r| matches!(r, SchedError::Pin { .. }));
    assert_ne!(pinned, refused, "{status}");

    let absent = SchedError::Pin {
        cpu: 1023,
        errno: libc::EINVAL,
    };
    let granted = entered(Scheduling {
        cpu: Some(1023),
        ..asked
    })
    .0
    .expect("nothing is enforced");
    assert!(granted.refusals.contains(&absent), "{granted:?}");
}

#[test]
fn a_socket_is_polled_as_asked_or_the_refusal_is_told() {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let duration = Duration::from_micros(50);
    let mut asked = Scheduling {
        realtime: Realtime::Ignore,
        busy_poll: Some(duration),
        ..Scheduling::default()
    };
    let mut granted = Granted::default();
    let outcome = asked.tune(&socket, &mut granted);
    assert_eq!(outcome, Ok(()), "nothing is enforced");
    match granted.busy_poll {
        Some(polled) => {
            assert_eq!(polled, duration);
            assert_eq!(sys::busy_poll_of(&socket), Ok(50), "what the kernel says");
            assert_eq!(granted.refusals, []);
        }
        None => {
            let [refusal] = &granted.refusals[..] else {
                panic!("{granted:?}")
            };
            let refusal = refusal.clone();
            println!("not polled: {refusal}");
            asked.realtime = Realtime::Enforce;
            assert_eq!(asked.tune(&socket, &mut granted), Err(refusal));
        }
    }
}

#[test]
fn refused_busy_poll_is_an_error_only_under_enforce() {
    // This descriptor is not a socket.
    let file = std::fs::File::open("/dev/null").expect("Linux has it");
    let duration = Duration::from_micros(50);
    let errno = libc::ENOTSOCK;
    let refusal = SchedError::BusyPoll { duration, errno };
    for realtime in [Realtime::Enforce, Realtime::Ignore] {
        let asked = Scheduling {
            realtime,
            busy_poll: Some(duration),
            ..Scheduling::default()
        };
        let mut granted = Granted::default();
        let outcome = asked.tune(&file, &mut granted);
        match realtime {
            Realtime::Enforce => assert_eq!(outcome, Err(refusal.clone())),
            Realtime::Ignore => {
                assert_eq!(
                    (outcome, &granted.refusals[..]),
                    (Ok(()), core::slice::from_ref(&refusal))
                );
            }
        }
        assert_eq!(granted.busy_poll, None);
    }
}

#[test]
fn options_out_of_range_are_refused_whether_enforced_or_not() {
    let good = Scheduling {
        realtime: Realtime::Ignore,
        ..Scheduling::default()
    };
    for got in [Duration::ZERO, Duration::from_millis(1)] {
        let asked = Scheduling {
            busy_poll: Some(got),
            ..good.clone()
        };
        let refusal = SchedError::BusyPollRange { got };
        assert_eq!(asked.probe(), Err(refusal.clone()));
        assert_eq!(asked.enter(), Err(refusal));
    }
    let asked = Scheduling {
        prefault_stack: PREFAULT_MAX + 1,
        ..good.clone()
    };
    let text = asked.probe().expect_err("too much").to_string();
    assert_eq!(
        text,
        "the stack to prefault has 67108865 bytes, expected at most 67108864 bytes"
    );
    let most = Scheduling {
        prefault_stack: PREFAULT_MAX,
        ..good
    };
    most.probe().expect("the most that can be asked for");
}

#[test]
fn the_texts_are_those_of_libfranka() {
    for (error, text) in [
        (
            SchedError::MaximumPriority(libc::EINVAL),
            "libfranka: unable to get maximum possible thread priority: Invalid argument",
        ),
        (
            SchedError::SetScheduling(libc::EPERM),
            "libfranka: unable to set realtime scheduling: Operation not permitted",
        ),
        (
            SchedError::KernelNotRealtime(Box::default()),
            "libfranka: Running kernel does not have realtime capabilities. (uname: ``, expected \
             PREEMPT_RT in it; /sys/kernel/realtime: cannot be read; /boot/config- and \
             /lib/modules//config: cannot be read; /proc/config.gz: not read, because it is compressed)",
        ),
    ] {
        assert_eq!(error.to_string(), text);
    }
}
