//! Tests of the tickets of one start, on one thread.

use super::*;

#[test]
fn the_gate_opens_for_all_when_the_last_has_arrived() {
    let mut tickets = StartBarrier::new().tickets_for(5);
    for now in 0..4 {
        for ticket in &mut tickets[..4] {
            assert_eq!(ticket.pass(now), Gate::Closed);
        }
    }
    assert_eq!(tickets[4].pass(17), Gate::Open);
    for ticket in &mut tickets {
        assert_eq!(ticket.pass(4), Gate::Open);
    }
    // The end of a member no longer affects the other members.
    drop(tickets.remove(0));
    tickets[0].end();
    for ticket in &mut tickets {
        assert_eq!((ticket.pass(5), ticket.fault()), (Gate::Open, None));
    }
    // The end of a member that has not seen the start yet affects no other member either.
    let [mut first, mut second] = StartBarrier::new().tickets();
    assert_eq!(first.pass(0), Gate::Closed);
    assert_eq!(second.pass(0), Gate::Open);
    drop(first);
    assert_eq!(second.fault(), None);
    let [mut alone] = StartBarrier::new().tickets();
    assert_eq!(alone.pass(0), Gate::Open);
}

#[test]
fn a_member_that_leaves_lets_the_others_go_with_its_number() {
    type Leaving = fn(StartTicket);
    let ways: [(Leaving, StartFault); 3] = [
        (drop, StartFault::Dropped { member: 1 }),
        (
            |mut ticket| ticket.withdraw(),
            StartFault::Withdrawn { member: 1 },
        ),
        (|mut ticket| ticket.end(), StartFault::Ended { member: 1 }),
    ];
    for (leave, fault) in ways {
        for arrived in [false, true] {
            let [mut first, mut second, mut third] = StartBarrier::new().tickets();
            assert_eq!(first.pass(0), Gate::Closed);
            if arrived {
                assert_eq!(second.pass(0), Gate::Closed);
            }
            assert_eq!(first.fault(), None);
            leave(second);
            assert_eq!(first.fault(), Some(fault));
            assert_eq!(first.pass(1), Gate::Broken(fault));
            assert_eq!(first.refusal(), Some(fault));
            // A later member also receives the fault, and its next calls change nothing.
            assert_eq!(third.pass(1), Gate::Broken(fault));
            drop(third);
            assert_eq!(first.pass(2), Gate::Broken(fault));
        }
    }
}

#[test]
fn withdrawn_member_goes_on_by_itself() {
    let [mut first, mut second] = StartBarrier::new().tickets();
    assert_eq!(first.pass(0), Gate::Closed);
    first.withdraw();
    assert_eq!((first.pass(1), first.refusal()), (Gate::Open, None));
    assert_eq!(
        second.pass(0),
        Gate::Broken(StartFault::Withdrawn { member: 0 })
    );
}

#[test]
fn waiting_ends_at_the_timeout_of_whoever_came_first() {
    let waited = Duration::from_millis(250);
    let [mut first, mut second, third] = StartBarrier::new().timeout(waited).tickets();
    assert_eq!(first.pass(1000), Gate::Closed);
    assert_eq!(second.pass(70), Gate::Closed);
    assert_eq!(first.pass(1249), Gate::Closed);
    assert_eq!(second.pass(319), Gate::Closed);
    let fault = StartFault::TimedOut {
        present: 2,
        members: 3,
        waited,
    };
    assert_eq!(first.pass(1250), Gate::Broken(fault));
    assert_eq!(second.pass(320), Gate::Broken(fault));
    assert_eq!(third.fault(), Some(fault));
    assert_eq!(
        fault.to_string(),
        "2 of 3 motions were ready to start together within 250 ms, expected all of them"
    );
}

#[test]
fn a_word_survives_its_number() {
    let words = [
        Cause::Dropped,
        Cause::Withdrawn,
        Cause::Ended,
        Cause::TimedOut,
    ]
    .map(|cause| Word::Broken {
        present: 65_534,
        member: 65_535,
        cause,
    })
    .into_iter()
    .chain([0, 1, 65_535].map(|present| Word::Waiting { present }));
    for word in words {
        assert_eq!(Word::from(u64::from(word)), word);
    }
}
