//! Members of a team: whatever they do at once, a fault of one is seen by the others.

use loom::thread;

use crate::team::{MemberFault, Passage, TeamStop, team};

#[test]
fn a_fault_reaches_who_begins_at_the_same_time() {
    loom::model(|| {
        let (coordinator, [mut first, mut second]) = team();
        let round = coordinator.begin();
        let beginning = thread::spawn(move || {
            let passage = first.pass(round, 0);
            (first, passage)
        });
        second.pass(round, 0);
        second.give_up(round, MemberFault::GivenUp);
        let (mut first, passage) = beginning.join().expect("no panic");
        let stop = TeamStop::Member {
            member: 1,
            fault: MemberFault::GivenUp,
        };
        assert!(
            matches!(passage, Passage::Waiting | Passage::Open)
                || passage == Passage::Stopped(stop)
        );
        // Its next look.
        assert_eq!(first.take_stop(), Some(stop));
        first.leave();
        second.leave();
    });
}

#[test]
fn of_two_faults_at_once_all_hear_the_same() {
    loom::model(|| {
        let (coordinator, [mut first, mut second, mut third]) = team();
        let round = coordinator.begin();
        let failing = thread::spawn(move || {
            first.give_up(round, MemberFault::GivenUp);
            let heard = first.take_stop();
            first.leave();
            heard
        });
        second.give_up(round, MemberFault::NotReached);
        let heard = second.take_stop();
        assert!(heard.is_some());
        assert_eq!(failing.join().expect("no panic"), heard);
        assert_eq!(third.take_stop(), heard);
        second.leave();
        third.leave();
    });
}

#[test]
fn a_stop_and_a_new_round_at_once_never_open_a_stopped_round() {
    loom::model(|| {
        let (coordinator, [mut only]) = team();
        let stopping = coordinator.clone();
        let stopping = thread::spawn(move || stopping.stop());
        let round = coordinator.begin();
        let passage = only.pass(round, 0);
        stopping.join().expect("no panic");
        let stopped = coordinator.stopped().is_some();
        // The stop came before the round, or is seen with the next look.
        assert_eq!(only.take_stop().is_some(), stopped);
        assert!(stopped || passage == Passage::Open);
        only.leave();
    });
}
