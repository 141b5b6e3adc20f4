//! The cycle borrowed by another thread.

use std::panic::{AssertUnwindSafe, catch_unwind};

use franka_rt::control::{Command, WriteError};
use franka_rt::thread::{BorrowError, WriteFault};

use super::*;

#[test]
fn borrower_runs_the_cycle_and_gives_it_back() {
    let (mut handle, robot) = start(config(), Probe::default());
    robot.send(1);
    assert_eq!(robot.command().message_id, 1, "the thread answers");

    let mut lease = handle.lender.borrow().expect("no other borrower has it");
    assert_eq!(handle.lender.borrow().unwrap_err(), BorrowError::Lent);
    assert_eq!(lease.turn(), Ok(None), "no state, a tick later");
    for message_id in 2..=20 {
        robot.send(message_id);
        let state = lease.turn().expect("the thread lives").expect("a state");
        assert_eq!(state.message_id, message_id);
        assert_eq!(robot.command().message_id, message_id, "the core answers");
    }
    assert_eq!(lease.core().turnarounds, 20);
    let newest = handle.states.newest().expect("it is published");
    assert_eq!(newest.message_id, 20);

    drop(lease);
    robot.send(21);
    assert_eq!(robot.command().message_id, 21, "the thread answers again");
    for _ in 0..50 {
        drop(handle.lender.borrow().expect("it is back"));
    }
    let core = handle.thread.join().expect("nothing panics");
    assert_eq!(core.turnarounds, 21);
    assert_eq!(handle.lender.borrow().unwrap_err(), BorrowError::Ended);
}

#[test]
fn cycle_survives_many_borrowers_at_once() {
    let (handle, robot) = start(config(), Probe::default());
    for round in 1..=20 {
        let borrowers: Vec<_> = (0..4)
            .map(|_| {
                let lender = handle.lender.clone();
                std::thread::spawn(move || lender.borrow().map(drop))
            })
            .collect();
        let got = borrowers
            .into_iter()
            .map(|borrower| borrower.join().expect("no panic"))
            .filter(Result::is_ok)
            .count();
        assert!(got >= 1, "round {round}");
        robot.send(round);
        assert_eq!(robot.command().message_id, round);
    }
    handle.thread.join().expect("nothing panics");
}

#[test]
fn a_borrower_that_runs_no_turn_is_reported_until_it_does() {
    let timeout = LinkTimeout::new(LinkTimeout::MIN).expect("in range");
    let driver = Driver::new(VERSION).with_link_timeout(timeout);
    let (handle, robot) = start(config(), driver);
    assert_eq!(handle.thread.stalled(), None);
    let mut lease = handle.lender.borrow().expect("no other borrower has it");
    let stalled = wait_for("report", || handle.thread.stalled());
    assert_eq!(stalled, LinkTimeout::MIN);
    wait_for("ring", || (handle.event_fd.drain() > 0).then_some(()));
    wait_for("end of the stall", || {
        robot.send(1);
        lease.turn().expect("the thread lives");
        handle.thread.stalled().is_none().then_some(())
    });
    wait_for("report", || handle.thread.stalled());
    drop(lease);
    wait_for("end of the stall", || {
        handle.thread.stalled().is_none().then_some(())
    });
    handle.thread.join().map(drop).expect("nothing panics");
}

#[test]
fn a_thread_that_is_stopped_does_not_wait_for_its_borrower() {
    let (handle, _robot) = start(config(), Probe::default());
    let mut lease = handle.lender.borrow().expect("no other borrower has it");
    assert_eq!(handle.thread.join().expect_err("no core"), Lost::Lent);
    assert_eq!(lease.turn(), Err(BorrowError::Ended));
    drop(lease);
    assert_eq!(handle.lender.borrow().unwrap_err(), BorrowError::Ended);
}

#[test]
fn a_borrower_that_panics_gives_the_cycle_back() {
    let (handle, robot) = start(config(), Probe::default());
    let mut lease = handle.lender.borrow().expect("no other borrower has it");
    robot.send(1);
    let borrower = std::thread::spawn(move || {
        let state = lease.turn().expect("the thread lives").expect("a state");
        assert_eq!(state.message_id, 2, "the borrower fails");
    });
    assert!(borrower.join().is_err(), "the panic is the borrower's");
    assert_eq!(robot.command().message_id, 1);
    robot.send(2);
    assert_eq!(robot.command().message_id, 2, "the thread answers again");
    drop(handle.lender.borrow().expect("it is back"));
    let core = handle.thread.join().expect("the core is whole");
    assert_eq!(core.turnarounds, 2);
}

#[test]
fn a_core_that_panics_with_its_borrower_ends_the_thread() {
    let core = Probe {
        panics_at: Some(3),
        ..Probe::default()
    };
    let (handle, robot) = start(config(), core);
    let mut lease = handle.lender.borrow().expect("no other borrower has it");
    robot.send(3);
    let turned = catch_unwind(AssertUnwindSafe(|| lease.turn()));
    assert!(turned.is_err(), "the panic is the borrower's");
    assert_eq!(lease.turn(), Err(BorrowError::Ended));
    drop(lease);
    wait_for("end", || handle.thread.has_ended().then_some(()));
    assert_eq!(handle.thread.join().expect_err("no core"), Lost::Spoilt);
    assert_eq!(handle.lender.borrow().unwrap_err(), BorrowError::Ended);
}

#[test]
fn a_command_without_a_motion_is_refused() {
    let (handle, robot) = start(config(), Driver::new(VERSION));
    let mut lease = handle.lender.borrow().expect("no other borrower has it");
    robot.send(1);
    lease.turn().expect("the thread lives").expect("a state");
    let refused = lease.write(&Command::default(), false).unwrap_err();
    assert_eq!(refused, WriteFault::Refused(WriteError::NotRunning));
}
