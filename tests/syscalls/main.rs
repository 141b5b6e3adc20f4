//! The system calls of the control thread, one by one.
//!
//! Each test runs a scenario in a separate child process: this same program, traced with `ptrace`.
//! It checks every system call that the thread of the cycle makes between its first and its last
//! wait for the robot. Only receives, sends, polls, the clock and the eventfd are allowed. A
//! contended lock, an allocation that reaches the system, a log or a file would show as another
//! call.
//!
//! An uncontended lock and an allocation from memory that the process already has make no call.
//! `no_alloc` counts allocations.

mod calls;
mod scenarios;
mod tracer;

use std::any::type_name_of_val;
use std::collections::BTreeMap;
use std::future::Future;
use std::sync::{Mutex, PoisonError};

use tokio::runtime::Builder;

use crate::calls::{counted, is_allowed};
use crate::tracer::Calls;

/// The driver's own thread.
const CONTROL: &str = "franka-rt";

/// Held while a child runs: each child simulates a robot, which keeps a processor busy.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Runs `scenario` in a child, in which only `test` runs, and passes the calls of the threads with
/// these `names` to `judge`.
fn trace(
    test: impl Fn(),
    names: &[&str],
    scenario: impl Future<Output = ()>,
    judge: impl FnOnce(&[Calls]),
) {
    if tracer::in_the_child() {
        let runtime = Builder::new_multi_thread().enable_all().build();
        return runtime.expect("a runtime").block_on(scenario);
    }
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let path = type_name_of_val(&test);
    let test = path.rsplit("::").next().expect("it has a name");
    match tracer::run(test, names) {
        Ok(threads) => judge(&threads),
        Err(refusal) => {
            let ci = std::env::var("CI").is_ok_and(|value| value == "true" || value == "1");
            assert!(!ci, "a child cannot be traced here: {refusal}");
            println!("NOTHING WAS CHECKED: a child cannot be traced here: {refusal}");
        }
    }
}

/// Prints the calls of a thread's cycles, and returns those that are not allowed.
fn forbidden(thread: &Calls) -> BTreeMap<String, u64> {
    let calls = thread.of_the_cycle();
    println!(
        "{}: {} calls, {:?}",
        thread.name,
        calls.len(),
        counted(calls)
    );
    counted(calls.iter().filter(|call| !is_allowed(call)))
}

/// Asserts that the control thread has made many calls, all of them allowed in a cycle.
fn assert_clean(threads: &[Calls]) {
    let [thread] = threads else {
        panic!("one control thread: {threads:?}")
    };
    assert_eq!(forbidden(thread), BTreeMap::new());
    // At least three calls for each of a thousand states.
    assert!(thread.of_the_cycle().len() > 2000, "the trace is too short");
}

#[test]
fn idle_thread_only_receives_and_notifies() {
    trace(
        idle_thread_only_receives_and_notifies,
        &[CONTROL],
        scenarios::watching(),
        assert_clean,
    );
}

#[test]
fn targets_are_followed_with_allowed_calls_only() {
    trace(
        targets_are_followed_with_allowed_calls_only,
        &[CONTROL],
        scenarios::targets(),
        assert_clean,
    );
}

#[test]
fn an_engaged_session_makes_allowed_calls_only() {
    trace(
        an_engaged_session_makes_allowed_calls_only,
        &[CONTROL],
        scenarios::engaged(),
        assert_clean,
    );
}

#[test]
fn control_functions_and_reflexes_make_allowed_calls_only() {
    trace(
        control_functions_and_reflexes_make_allowed_calls_only,
        &[CONTROL],
        scenarios::functions(),
        assert_clean,
    );
}

#[test]
fn asynchronous_targets_make_allowed_calls_only() {
    trace(
        asynchronous_targets_make_allowed_calls_only,
        &[CONTROL],
        scenarios::asynchronous(),
        assert_clean,
    );
}

#[test]
fn user_thread_makes_only_allowed_calls_in_the_cycle() {
    let names = [CONTROL, scenarios::ACTIVE];
    trace(
        user_thread_makes_only_allowed_calls_in_the_cycle,
        &names,
        scenarios::active(),
        |threads| {
            let called = |name| threads.iter().find(|thread| thread.name == name);
            let user = called(scenarios::ACTIVE).expect("it ran");
            assert_eq!(forbidden(user), BTreeMap::new());
            assert!(user.of_the_cycle().len() > 2000, "the trace is too short");
            // The driver's own thread only waits meanwhile.
            let driver = forbidden(called(CONTROL).expect("it ran"));
            assert_eq!(driver.keys().collect::<Vec<_>>(), ["futex"]);
        },
    );
}

#[test]
fn failing_receives_cause_only_allowed_calls_and_a_wait() {
    trace(
        failing_receives_cause_only_allowed_calls_and_a_wait,
        &[CONTROL],
        scenarios::failing(),
        |threads| {
            let [thread] = threads else {
                panic!("one control thread: {threads:?}")
            };
            assert_eq!(forbidden(thread).keys().collect::<Vec<_>>(), ["futex"]);
            let calls = counted(thread.of_the_cycle());
            let pauses = calls.get("poll").or(calls.get("ppoll"));
            assert!(pauses >= Some(&1000), "{calls:?}");
            assert!(
                calls.contains_key("write to anon_inode:[eventfd]"),
                "{calls:?}"
            );
        },
    );
}

#[test]
fn any_other_call_is_detected() {
    trace(
        any_other_call_is_detected,
        &[CONTROL],
        scenarios::asking(),
        |threads| {
            let seen = threads.iter().map(forbidden).collect::<Vec<_>>();
            let expected = BTreeMap::from([("getppid".to_owned(), 200)]);
            assert_eq!(seen, [expected]);
        },
    );
}

#[test]
fn a_write_to_anything_but_the_eventfd_is_detected() {
    trace(
        a_write_to_anything_but_the_eventfd_is_detected,
        &[CONTROL],
        scenarios::writing(),
        |threads| {
            let seen = threads.iter().map(forbidden).collect::<Vec<_>>();
            let expected = BTreeMap::from([("write to /dev/null".to_owned(), 200)]);
            assert_eq!(seen, [expected]);
        },
    );
}
