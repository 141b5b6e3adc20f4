//! The beginning and the end of the thread.

use super::*;

/// A busy machine may delay single attempts, so only one of them must be in time.
#[test]
fn stopping_takes_less_than_a_tenth_of_a_second() {
    for silent in [true, false] {
        wait_for("timely end", || {
            let (mut handle, robot) = start(config(), Driver::new(VERSION));
            robot.send(1);
            wait_for("state", || handle.states.newest());
            let sender = (!silent).then(|| {
                std::thread::spawn(move || {
                    for message_id in 2..100 {
                        // The port closes during the send.
                        let _ = robot.0.send(&state(message_id));
                        std::thread::sleep(Duration::from_millis(1));
                    }
                })
            });
            assert!(!handle.thread.has_ended());
            let start = Instant::now();
            handle.thread.join().expect("nothing panics");
            let duration = start.elapsed();
            if let Some(sender) = sender {
                sender.join().expect("sending does not panic");
            }
            (duration < Duration::from_millis(100)).then_some(())
        });
    }
}

#[test]
fn dropping_the_owner_stops_the_thread_without_waiting() {
    let (handle, _robot) = start(config(), Driver::new(VERSION));
    let stats = handle.stats.clone();
    drop(handle);
    // The thread's own clone of the counters is dropped with the thread.
    wait_for("end", || {
        (std::sync::Arc::strong_count(&stats) == 1).then_some(())
    });
}

#[test]
fn refused_enforced_setting_starts_no_thread() {
    let (socket, _) = socket();
    let scheduling = Scheduling {
        priority: Some(1_000),
        ..Scheduling::default()
    };
    let config = ThreadConfig {
        scheduling,
        ..ThreadConfig::default()
    };
    let error = thread::spawn(config, Driver::new(VERSION), socket, ROBOT, VERSION)
        .expect_err("no such priority");
    let why = match cfg!(all(target_os = "linux", not(franka_portable))) {
        true => "Invalid argument",
        false => "Operation not supported",
    };
    assert_eq!(
        error.to_string(),
        format!("libfranka: unable to set realtime scheduling: {why}")
    );

    if !kernel_is_realtime() {
        let (socket, _) = self::socket();
        let outcome = thread::spawn(
            ThreadConfig::default(),
            Driver::new(VERSION),
            socket,
            ROBOT,
            VERSION,
        );
        let Err(StartError::Scheduling(error)) = outcome else {
            panic!("this kernel is not a real-time one")
        };
        assert!(
            matches!(
                error,
                SchedError::KernelNotRealtime(_)
                    | SchedError::SetScheduling(_)
                    | SchedError::MaximumPriority(_)
            ),
            "{error}"
        );
    }
}
