//! Behaviour of the thread with any core.

use super::*;

/// A core for tests: answers states, counts, reports many events at once, panics on demand.
#[derive(Debug, Default)]
pub(crate) struct Probe {
    pub(crate) orders: Vec<u32>,
    pub(crate) panics_at: Option<u64>,
    pub(crate) to_say: std::ops::Range<u32>,
    /// Number of commands whose times were passed to the core before the record of their cycle.
    pub(crate) turnarounds: u64,
    /// Cycles that were passed to the core after all their work.
    pub(crate) cycles: Vec<CycleTimes>,
    pub(crate) skipped: u64,
}

impl Core for Probe {
    type Order = u32;
    type Event = u32;
    type Record = u64;

    fn on_order(&mut self, order: u32) {
        self.orders.push(order);
    }

    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        assert_ne!(Some(state.message_id), self.panics_at, "the core fails");
        Some(RobotCommand {
            message_id: state.message_id,
            ..RobotCommand::default()
        })
    }

    fn on_silence(&mut self, _: Duration) {}

    fn on_skipped(&mut self, states: u64) {
        self.skipped += states;
    }

    fn after_send(&mut self, state: &RobotState, _: &Arrival, sent: Option<&CycleTimes>) {
        assert_eq!(sent.map(|sent| sent.time), Some(state.message_id));
        self.turnarounds += 1;
    }

    fn record(&self) -> u64 {
        self.turnarounds
    }

    fn note_cycle(&mut self, cycle: &CycleTimes) -> Option<&MotionStatistics> {
        self.cycles.push(*cycle);
        None
    }

    fn take_event(&mut self) -> Option<u32> {
        self.to_say.next()
    }
}

#[test]
fn state_is_answered_before_its_record_is_made() {
    let (mut handle, robot) = start(config(), Probe::default());
    for message_id in 1..=100 {
        robot.send(message_id);
        assert_eq!(robot.command().message_id, message_id);
    }
    let core = handle.thread.join().expect("nothing panics");
    assert_eq!(core.turnarounds, 100);
    assert_eq!(handle.stats.commands.get(), 100);
    let stats = &handle.stats;
    assert_eq!((stats.turnaround.count(), stats.slack.count()), (100, 100));
    let records: Vec<u64> = std::iter::from_fn(|| handle.records.pop()).collect();
    assert_eq!(
        records,
        (1..=100).collect::<Vec<_>>(),
        "the core has heard of the turnaround before"
    );
    let times: Vec<_> = core.cycles.iter().map(|cycle| cycle.time).collect();
    assert_eq!(times, records, "and of the whole cycle after");
    let worst = core.cycles.iter().max_by_key(|cycle| cycle.total());
    assert_eq!(stats.worst_cycle().as_ref(), worst);
    let overruns = core.cycles.iter().filter(|c| c.slack.overrun().is_some());
    assert_eq!(stats.overrun.count(), overruns.count() as u64);
    for cycle in &core.cycles {
        let gone = cycle.late + cycle.turnaround;
        assert_eq!(
            i128::from(cycle.slack.as_nanos()),
            1_000_000 - gone.as_nanos() as i128
        );
        assert_eq!(cycle.phases.is_some(), cfg!(feature = "cycle-phases"));
        if let Some(phases) = cycle.phases {
            let before = phases.orders + phases.decode + phases.program + phases.send;
            assert_eq!(before, cycle.turnaround, "the phases leave no gap");
            assert!(phases.program > Duration::ZERO && phases.publish > Duration::ZERO);
        }
    }
}

#[test]
fn every_state_comes_once_and_in_order_and_the_rest_is_counted() {
    let mut config = config();
    config.capacity.states = 50;
    let (mut handle, robot) = start(config, Probe::default());
    let exchange = |message_ids: std::ops::RangeInclusive<u64>| {
        for message_id in message_ids {
            robot.send(message_id);
            assert_eq!(robot.command().message_id, message_id);
        }
    };
    let mut take = || -> Vec<u64> {
        std::iter::from_fn(|| handle.sequence.pop())
            .map(|state| {
                assert_eq!(state.q, [state.message_id as f64; 7]);
                state.message_id
            })
            .collect()
    };
    exchange(1..=30);
    // The last command leaves before its state is in the ring, so that state is read next time.
    let mut taken = take();
    exchange(31..=40);
    taken.extend(take());
    exchange(41..=140);
    let core = handle.thread.join().expect("nothing panics");
    taken.extend(take());
    let lost = handle.stats.states_lost.get();
    assert!((50..=51).contains(&lost), "{lost} of 100 found 50 places");
    assert!(taken.iter().copied().eq(1..=140 - lost), "{taken:?}");
    assert_eq!((core.turnarounds, core.skipped), (140, 0));
}

#[test]
fn orders_arrive_in_their_order_while_the_robot_is_silent() {
    let (mut handle, _robot) = start(config(), Probe::default());
    for order in 0..40 {
        wait_for("room", || handle.orders.push(order).ok());
    }
    wait_for("empty queue", || {
        (handle.orders.free() == Capacity::default().orders).then_some(())
    });
    let core = handle.thread.join().expect("nothing panics");
    assert_eq!(core.orders, (0..40).collect::<Vec<_>>());
}

#[test]
fn events_wait_for_room_and_none_is_lost() {
    let capacity = Capacity {
        notices: 1,
        records: 4,
        ..Capacity::default()
    };
    let (mut handle, robot) = start(
        ThreadConfig {
            capacity,
            ..config()
        },
        Probe {
            to_say: 0..30,
            ..Probe::default()
        },
    );
    for expected in 0..30 {
        let notice = wait_for("event", || handle.notices.pop());
        assert!(
            matches!(notice, Notice::Core(event) if event == expected),
            "{notice:?}"
        );
        robot.send(u64::from(expected) + 1);
        robot.command();
    }
    handle.thread.join().expect("nothing panics");
    assert_eq!(
        handle.stats.records_lost.get(),
        26,
        "the ring holds 4 of 30 records"
    );
}

#[test]
fn a_panic_of_the_core_ends_the_thread_and_nothing_else() {
    let (mut handle, robot) = start(
        config(),
        Probe {
            panics_at: Some(2),
            ..Probe::default()
        },
    );
    robot.send(1);
    assert_eq!(wait_for("state", || handle.states.newest()).message_id, 1);
    handle.event_fd.drain();
    robot.send(2);
    wait_for("end", || handle.thread.has_ended().then_some(()));
    wait_for("ring", || (handle.event_fd.drain() > 0).then_some(()));
    let lost = handle.thread.join().expect_err("it panicked");
    let Lost::Panicked { message } = lost else {
        panic!("{lost}")
    };
    assert!(message.contains("the core fails"), "{message}");

    let (mut handle, robot) = start(config(), Probe::default());
    robot.send(1);
    assert_eq!(
        wait_for("state of a new thread", || handle.states.newest()).message_id,
        1
    );
    handle.thread.join().expect("nothing panics");
}
