//! Tests of the members of one team, on one thread.

use super::*;

fn stop_of(member: usize, fault: MemberFault) -> TeamStop {
    TeamStop::Member { member, fault }
}

#[test]
fn round_opens_with_the_last_goal_each_time_anew() {
    let (coordinator, [mut first, mut second]) = team();
    for now in [100, 5000] {
        let round = coordinator.begin();
        assert_eq!(first.pass(round, now), Passage::Waiting);
        assert_eq!(first.pass(round, now + 1), Passage::Waiting);
        assert_eq!(second.pass(round, 7), Passage::Open);
        assert_eq!(first.pass(round, now + 2), Passage::Open);
    }
    first.leave();
    drop(first);
    assert_eq!(coordinator.stopped(), None, "it left");
}

#[test]
fn the_first_fault_of_a_round_stays_and_is_seen_once() {
    let (coordinator, [mut first, mut second, mut third]) = team();
    let round = coordinator.begin();
    for member in [&mut first, &mut second, &mut third] {
        member.pass(round, 0);
    }
    second.give_up(round, MemberFault::GivenUp);
    third.give_up(round, MemberFault::TakenBack);
    let stop = stop_of(1, MemberFault::GivenUp);
    assert_eq!(coordinator.stopped(), Some(stop));
    assert_eq!(first.take_stop(), Some(stop));
    assert_eq!(first.take_stop(), None);
    assert_eq!(first.pass(round, 1), Passage::Stopped(stop));
    // The next round starts afresh: if an arm fails while it brakes for the stop of an earlier
    // round, it does not stop the next round.
    assert_eq!(second.take_stop(), Some(stop));
    let next = coordinator.begin();
    second.give_up(round, MemberFault::NotReached);
    assert_eq!((first.take_stop(), coordinator.stopped()), (None, None));
    assert_eq!(first.pass(next, 2), Passage::Waiting);
    // A goal of the earlier round comes too late.
    let late = stop_of(2, MemberFault::TakenBack);
    assert_eq!(third.pass(round, 3), Passage::Stopped(late));
    // The cancellation stops neither round, even if its member already waits in the next one.
    assert_eq!(second.pass(next, 4), Passage::Waiting);
    let late = stop_of(1, MemberFault::TakenBack);
    assert_eq!(second.pass(round, 5), Passage::Stopped(late));
    assert_eq!(second.pass(next, 6), Passage::Waiting);
    assert_eq!(third.pass(next, 7), Passage::Open);
}

#[test]
fn a_session_that_ends_stops_what_is_done_after_a_stop_too() {
    let (coordinator, [mut first, second]) = team();
    coordinator.stop();
    assert_eq!(first.take_stop(), Some(TeamStop::Requested));
    second.stop(MemberFault::RobotStopped);
    let stop = stop_of(1, MemberFault::RobotStopped);
    assert_eq!(first.take_stop(), Some(stop));
    drop(second);
    let stop = stop_of(1, MemberFault::Gone);
    assert_eq!(first.take_stop(), Some(stop));
}

#[test]
fn stop_is_seen_by_each_member_despite_new_rounds() {
    let (coordinator, [mut first, mut second]) = team();
    let round = coordinator.begin();
    first.pass(round, 0);
    second.pass(round, 0);
    coordinator.stop();
    assert_eq!(first.take_stop(), Some(TeamStop::Requested));
    // The second member has not checked yet.
    let next = coordinator.begin();
    assert_eq!(coordinator.stopped(), Some(TeamStop::Requested));
    let stopped = Passage::Stopped(TeamStop::Requested);
    assert_eq!(first.pass(next, 1), stopped);
    assert_eq!(second.take_stop(), Some(TeamStop::Requested));
    assert_eq!(second.pass(next, 1), stopped);
    first.take_stop();
    let next = coordinator.begin();
    assert_eq!(first.take_stop(), None);
    assert_eq!(first.pass(next, 2), Passage::Waiting);
    assert_eq!(second.pass(next, 2), Passage::Open, "all have seen it");
}

#[test]
fn fault_is_seen_by_each_member_and_frees_the_next_round() {
    let (coordinator, [mut first, mut second]) = team();
    let round = coordinator.begin();
    first.pass(round, 0);
    second.pass(round, 0);
    second.give_up(round, MemberFault::GivenUp);
    let next = coordinator.begin();
    assert_eq!(first.take_stop(), Some(stop_of(1, MemberFault::GivenUp)));
    assert_eq!(first.take_stop(), None);
    assert_eq!(first.pass(next, 1), Passage::Waiting);
    assert_eq!(second.pass(next, 1), Passage::Open);
}

#[test]
fn a_member_that_never_looks_stops_each_round_until_it_has_left() {
    let (coordinator, [mut first, mut second]) = team();
    coordinator.stop();
    for _ in 0..3 {
        let round = coordinator.begin();
        assert_eq!(
            first.pass(round, 0),
            Passage::Stopped(TeamStop::Requested),
            "it does not wait"
        );
        first.take_stop();
    }
    // A session that has left may still check.
    second.leave();
    assert_eq!(second.take_stop(), Some(TeamStop::Requested));
    coordinator.stop();
    first.take_stop();
    let round = coordinator.begin();
    assert_eq!(first.pass(round, 0), Passage::Waiting);
}

#[test]
fn a_stop_is_seen_once_where_the_numbers_of_rounds_begin_anew() {
    let (coordinator, [mut only]) = team();
    let last = Word(u64::from(u32::MAX) << 32);
    coordinator.shared.word.store(last.0, Ordering::Relaxed);
    for _ in 0..3 {
        coordinator.take_back(coordinator.begin());
        let next = coordinator.begin();
        assert_eq!(only.take_stop(), Some(TeamStop::Requested), "{next:?}");
        assert_eq!(only.take_stop(), None);
        assert_eq!(only.pass(next, 0), Passage::Open);
    }
}

#[test]
fn taken_back_round_stops_only_if_it_is_the_newest() {
    let (coordinator, [mut first]) = team();
    let (older, round) = (coordinator.begin(), coordinator.begin());
    coordinator.take_back(older);
    assert_eq!(first.pass(round, 0), Passage::Open);
    coordinator.take_back(round);
    let requested = Passage::Stopped(TeamStop::Requested);
    assert_eq!(first.pass(round, 1), requested);
    coordinator.refuse(round, 0);
    assert_eq!(first.pass(round, 2), requested, "the first stays");
}

#[test]
fn fault_in_the_round_after_a_stop_stops_it() {
    let (coordinator, [mut first, mut second]) = team();
    for _ in 0..3 {
        let round = coordinator.begin();
        assert_eq!(first.pass(round, 0), Passage::Waiting);
        assert_eq!(second.pass(round, 0), Passage::Open);
        first.give_up(round, MemberFault::GivenUp);
        let stop = stop_of(0, MemberFault::GivenUp);
        assert_eq!(second.take_stop(), Some(stop), "{round:?}");
        assert_eq!(first.take_stop(), Some(stop), "{round:?}");
    }
}

#[test]
fn fault_under_way_stops_the_round_that_waits() {
    for fault in FAULTS {
        let (coordinator, [mut first, mut second]) = team();
        let round = coordinator.begin();
        assert_eq!(first.pass(round, 0), Passage::Waiting);
        assert_eq!(second.pass(round, 0), Passage::Open);
        let next = coordinator.begin();
        first.give_up(round, fault);
        use MemberFault::{Refused, TakenBack, TimedOut};
        let own = [TakenBack, Refused, TimedOut].contains(&fault);
        let stop = (!own).then(|| stop_of(0, fault));
        assert_eq!(second.take_stop(), stop, "{fault}");
        let passage = stop.map_or(Passage::Waiting, Passage::Stopped);
        assert_eq!(second.pass(next, 1), passage, "{fault}");
    }
}

#[test]
fn report_of_a_member_reaches_the_others_of_its_round() {
    let (coordinator, [first, second, third]) = team();
    let (older, round) = (coordinator.begin(), coordinator.begin());
    let told = |remaining, lags| Carrying { remaining, lags };
    assert_eq!(first.others(round), Carrying::default());
    first.tell(round, told(0.7, true));
    assert_eq!(first.others(round), Carrying::default(), "of itself");
    second.tell(round, told(0.25, true));
    third.tell(round, told(0.125, false));
    assert_eq!(first.others(round), told(0.25, true), "the longest, any");
    assert_eq!(second.others(round), told(0.7, true));
    assert_eq!(first.others(older), Carrying::default());
    second.tell(older, told(0.25, true));
    assert_eq!(first.others(round), told(0.125, false));
    // Distances are whole micrometres, up to the largest value.
    for (way, read) in [
        (-1.0, 0.0),
        (f64::NAN, 0.0),
        (1.5e-6, 1e-6),
        (1e4, WAY_MAX as f64 * 1e-6),
        (f64::INFINITY, WAY_MAX as f64 * 1e-6),
    ] {
        third.tell(round, told(way, false));
        assert_eq!(first.others(round), told(read, false), "{way} m");
    }
}

#[test]
fn waiting_ends_at_the_timeout() {
    let (coordinator, [mut first, _second]) = team();
    let round = coordinator.begin();
    let last = START_TIMEOUT.as_millis() as u64 + 100;
    assert_eq!(first.pass(round, 100), Passage::Waiting);
    assert_eq!(first.pass(round, last - 1), Passage::Waiting);
    let stop = stop_of(0, MemberFault::TimedOut);
    assert_eq!(first.pass(round, last), Passage::Stopped(stop));
}

#[test]
fn stop_names_its_member_and_fault() {
    let requested = TeamStop::Requested.to_string();
    assert_eq!(requested, "the team was stopped on request");
    let silent = stop_of(1, MemberFault::Silent).to_string();
    let expected = "member 1 of the team: no states arrive from its robot";
    assert_eq!(silent, expected);
}

#[test]
fn every_fault_survives_its_word() {
    for fault in FAULTS {
        for member in [0, 253] {
            let word = Word(0x1234_5678_0000_0002).stopped(member, Cause::Member(fault));
            assert_eq!(word.stop(), Some(stop_of(member.into(), fault)));
            assert_eq!(word.present(), 2);
            assert_eq!(Round::to_word(word.round()), 0x1234_5678);
        }
    }
    let word = Word::default().stopped(CALLER, Cause::Requested);
    assert_eq!(word.stop(), Some(TeamStop::Requested));
    assert_eq!(Word(u64::MAX).next_round().round(), Round::from_word(1));
}
