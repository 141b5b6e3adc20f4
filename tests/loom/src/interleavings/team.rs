//! Members of a team: the others see a fault of one member, with any simultaneous operations.

use loom::thread;

use crate::team::{Carrying, MemberFault, Passage, TeamStop, team};

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
fn simultaneous_faults_are_heard_alike_by_all() {
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
        // It came before the round, which never opens then, or stops it.
        assert!(coordinator.stopped().is_some());
        assert!(only.take_stop().is_some(), "{passage:?}");
        only.leave();
    });
}

/// Reports of a member about an object that the team carries.
const SAID: [Carrying; 2] = [
    Carrying {
        remaining: 0.25,
        lags: true,
    },
    Carrying {
        remaining: 0.125,
        lags: false,
    },
];

#[test]
fn object_report_is_read_whole_and_in_order() {
    loom::model(|| {
        let (coordinator, [mut first, mut second]) = team();
        let round = coordinator.begin();
        let telling = thread::spawn(move || {
            for said in SAID {
                first.tell(round, said);
            }
            first.leave();
        });
        let order = |read: Carrying| match read {
            read if read == Carrying::default() => 0,
            read if read == SAID[0] => 1,
            read if read == SAID[1] => 2,
            mixed => panic!("no member said {mixed:?}"),
        };
        let read = [second.others(round), second.others(round)].map(order);
        assert!(read[0] <= read[1], "{read:?}");
        telling.join().expect("no panic");
        assert_eq!(second.others(round), SAID[1]);
        second.leave();
    });
}

#[test]
fn report_of_one_round_is_never_read_in_the_next() {
    loom::model(|| {
        let (coordinator, [first, mut second]) = team();
        let round = coordinator.begin();
        let telling = thread::spawn(move || {
            first.tell(round, SAID[0]);
            first
        });
        let next = coordinator.begin();
        assert_eq!(second.others(next), Carrying::default());
        let mut first = telling.join().expect("no panic");
        assert_eq!(second.others(next), Carrying::default());
        first.tell(next, SAID[1]);
        assert_eq!(second.others(next), SAID[1]);
        assert_eq!(second.others(round), Carrying::default());
        first.leave();
        second.leave();
    });
}

#[test]
fn reports_at_once_count_by_the_farthest_and_any_lag() {
    loom::model(|| {
        let (coordinator, [mut first, mut second, mut third]) = team();
        let round = coordinator.begin();
        let telling = thread::spawn(move || {
            first.tell(round, SAID[1]);
            first.leave();
        });
        second.tell(round, SAID[0]);
        // A member's own report does not count for itself.
        let others = second.others(round);
        assert!(
            [Carrying::default(), SAID[1]].contains(&others),
            "{others:?}"
        );
        assert_eq!(third.others(round), SAID[0]);
        telling.join().expect("no panic");
        assert_eq!(third.others(round), SAID[0]);
        second.leave();
        third.leave();
    });
}
