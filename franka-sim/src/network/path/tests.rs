use std::collections::HashSet;

use franka_proto::{RobotCommand, RobotState, Version};

use super::*;
use crate::network::{BurstLoss, Loss, Reordering, Stalls};

const CLEAR: Conditions = Conditions {
    loss: Loss::Never,
    ..Conditions::cable()
};

/// Sizes of a state in protocols 5 and 10, in bytes.
const STATES: [usize; 2] = [2373, 1377];

fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// Sends `count` datagrams of this size, one per millisecond. Each contains its number. Returns the
/// arrivals.
fn pass(path: &mut Path, count: u64, size: usize) -> Vec<(Duration, u64)> {
    let mut arrived = Vec::new();
    for n in 0..count {
        let mut datagram = vec![0; size];
        datagram[..8].copy_from_slice(&n.to_le_bytes());
        path.send(ms(n), &datagram);
        while let Some(delivery) = path.take(ms(n + 1)) {
            arrived.push((delivery.at, number(&delivery)));
        }
    }
    while let Some(delivery) = path.take(Duration::MAX) {
        arrived.push((delivery.at, number(&delivery)));
    }
    arrived
}

fn number(delivery: &Delivery) -> u64 {
    u64::from_le_bytes(*delivery.datagram.first_chunk().expect("eight bytes"))
}

fn numbers(arrived: &[(Duration, u64)]) -> Vec<u64> {
    arrived.iter().map(|&(_, number)| number).collect()
}

#[test]
fn a_perfect_path_delivers_at_once_what_was_sent() {
    let mut path = Path::new(Conditions::default(), 3);
    let expected: Vec<_> = (0..100).map(|n| (ms(n), n)).collect();
    assert_eq!(pass(&mut path, 100, 371), expected);
    assert_eq!(
        path.tally(),
        Tally {
            sent: 100,
            ..Tally::default()
        }
    );
}

#[test]
fn delay_and_jitter_stay_in_their_bounds_and_keep_the_order() {
    let conditions = Conditions {
        delay: ms(3),
        jitter: ms(2),
        ..Conditions::default()
    };
    let arrived = pass(&mut Path::new(conditions, 3), 2000, 371);
    assert!(numbers(&arrived).is_sorted());
    assert_eq!(arrived.len(), 2000);
    let delays: Vec<_> = arrived.iter().map(|&(at, n)| at - ms(n)).collect();
    let (least, most) = (*delays.iter().min().unwrap(), *delays.iter().max().unwrap());
    assert!(
        least >= ms(3) && least < Duration::from_micros(3300),
        "{least:?}"
    );
    assert!(
        most <= ms(5) && most > Duration::from_micros(4700),
        "{most:?}"
    );
}

#[test]
fn a_cut_takes_what_leaves_within_it_and_nothing_else() {
    let mut path = Path::new(Conditions::default(), 3);
    path.cut(ms(10)..ms(30));
    path.cut(ms(20)..ms(40));
    path.cut(ms(90)..Duration::MAX);
    let arrived = numbers(&pass(&mut path, 200, 371));
    assert_eq!(arrived, (0..10).chain(40..90).collect::<Vec<_>>());
    assert_eq!(path.tally().lost, 140);
    assert_eq!(path.tally().fragment_lost, 0);
}

#[test]
fn so_many_are_dropped_as_it_was_told() {
    let mut path = Path::new(Conditions::default(), 3);
    path.drop_next(5);
    path.drop_next(3);
    assert_eq!(
        numbers(&pass(&mut path, 10, 371)),
        (3..10).collect::<Vec<_>>()
    );
}

#[test]
fn some_arrive_twice() {
    let conditions = Conditions {
        duplication: 0.1,
        ..Conditions::default()
    };
    let arrived = numbers(&pass(&mut Path::new(conditions, 3), 10_000, 371));
    let distinct: HashSet<_> = arrived.iter().collect();
    assert_eq!(distinct.len(), 10_000);
    let twice = arrived.len() - 10_000;
    assert!((900..1100).contains(&twice), "{twice}");
}

#[test]
fn some_are_overtaken_and_none_is_lost() {
    let conditions = Conditions {
        reordering: Reordering {
            probability: 0.1,
            delay: Duration::from_micros(2500),
        },
        ..Conditions::default()
    };
    let arrived = pass(&mut Path::new(conditions, 3), 10_000, 371);
    assert!(arrived.is_sorted_by_key(|&(at, _)| at));
    let mut in_order = numbers(&arrived);
    // The next two datagrams overtake a delayed datagram, unless they also take the longer path.
    let overtaken = in_order.windows(2).filter(|pair| pair[1] < pair[0]).count();
    assert!((700..1100).contains(&overtaken), "{overtaken}");
    in_order.sort_unstable();
    assert_eq!(in_order, (0..10_000).collect::<Vec<_>>());
}

#[test]
fn half_of_a_datagram_is_none() {
    let loss = Loss::Independent(0.1);
    let [large, small] = STATES.map(|size| {
        let mut path = Path::new(CLEAR.with_loss(loss), 3);
        let arrived = pass(&mut path, 10_000, size).len() as u64;
        let tally = path.tally();
        assert_eq!(arrived + tally.lost, tally.sent);
        tally
    });
    // With probability 0.81, none of two packets is lost; with 0.01, both are lost. Three standard
    // deviations are 120 and 115.
    assert!(large.lost.abs_diff(1900) < 120, "{large:?}");
    assert!(large.fragment_lost.abs_diff(1800) < 115, "{large:?}");
    assert!(small.lost.abs_diff(1000) < 90, "{small:?}");
    assert_eq!(small.fragment_lost, 0);
}

#[test]
fn bursts_take_datagrams_in_a_row() {
    let bursts = Loss::Bursts(BurstLoss::of(0.02, 8.0));
    let arrived = numbers(&pass(
        &mut Path::new(CLEAR.with_loss(bursts), 3),
        50_000,
        371,
    ));
    let gaps = arrived.windows(2).map(|pair| pair[1] - pair[0] - 1);
    let gaps: Vec<_> = gaps.filter(|&gap| gap > 0).collect();
    let mean = gaps.iter().sum::<u64>() as f64 / gaps.len() as f64;
    assert!((mean - 8.0).abs() < 2.0, "{mean}");
}

#[test]
fn stall_holds_datagrams_and_releases_them_at_line_rate() {
    let conditions = Conditions {
        stalls: Some(Stalls::FER),
        ..CLEAR
    };
    let spacing = STATES.map(|size| Duration::from_nanos(8 * on_the_wire(size) as u64));
    assert_eq!(spacing[0], Duration::from_nanos(19_976));
    for (size, spacing) in STATES.into_iter().zip(spacing) {
        let arrived = pass(&mut Path::new(conditions, 3), 30_000, size);
        assert_eq!(numbers(&arrived), (0..30_000).collect::<Vec<_>>());
        let gaps: Vec<_> = arrived
            .windows(2)
            .map(|pair| pair[1].0 - pair[0].0)
            .collect();
        let least = gaps.iter().min().expect("some");
        assert!(
            least.abs_diff(spacing) < Duration::from_nanos(2),
            "{least:?}"
        );
        let bursts = gaps.iter().filter(|&&gap| gap < 2 * spacing).count();
        // In every stall, two or three datagrams arrive together with an earlier datagram.
        assert!((200..600).contains(&bursts), "{bursts}");
    }
}

/// Compares with values that were measured on robots: see [`Stalls::FER`].
#[test]
fn the_silences_of_an_fer_are_those_measured() {
    let conditions = Conditions {
        stalls: Some(Stalls::FER),
        ..CLEAR
    };
    let (mut count, mut longest) = (0, Duration::ZERO);
    let runs = 20;
    for seed in 0..runs {
        let arrived = pass(&mut Path::new(conditions, seed), 30_000, STATES[0]);
        let mut gaps: Vec<_> = arrived
            .windows(2)
            .map(|pair| pair[1].0 - pair[0].0)
            .collect();
        gaps.sort_unstable();
        let middle = gaps[gaps.len() / 2];
        assert!(
            middle.abs_diff(ms(1)) < Duration::from_micros(5),
            "{middle:?}"
        );
        count += gaps
            .iter()
            .filter(|&&gap| gap >= Duration::from_micros(1500))
            .count();
        longest += *gaps.last().expect("some");
    }
    let rate = count as f64 / (30.0 * runs as f64);
    assert!((rate - 7.0).abs() < 0.4, "{rate} /s");
    let longest = longest / runs as u32;
    assert!(longest > Duration::from_micros(4800), "{longest:?}");
    assert!(longest < Duration::from_micros(6900), "{longest:?}");
}

#[test]
fn a_seed_repeats_itself_and_another_one_does_not() {
    let conditions = Conditions {
        stalls: Some(Stalls::FER),
        duplication: 0.02,
        reordering: Reordering {
            probability: 0.02,
            delay: ms(2),
        },
        ..CLEAR.with_loss(Loss::Independent(0.02))
    };
    let run = |seed| pass(&mut Path::new(conditions, seed), 3000, 2373);
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn loss_does_not_move_the_stalls() {
    let stalling = Conditions {
        stalls: Some(Stalls::FER),
        jitter: Duration::ZERO,
        ..CLEAR
    };
    let all = pass(&mut Path::new(stalling, 3), 3000, 2373);
    let lossy = stalling.with_loss(Loss::Independent(0.1));
    let some = pass(&mut Path::new(lossy, 3), 3000, 2373);
    assert!(some.len() < all.len());
    assert!(some.iter().all(|arrival| all.contains(arrival)));
}

#[test]
fn only_a_protocol_5_state_takes_two_packets() {
    assert_eq!(STATES.map(packets), [2, 1]);
    assert_eq!(packets(RobotCommand::MAX_SIZE), 1);
    let states = [Version::V5, Version::V10].map(|version| {
        let mut bytes = [0; RobotState::MAX_SIZE];
        RobotState::default()
            .encode(version, &mut bytes)
            .expect("it fits")
    });
    assert_eq!(states, STATES);
}
