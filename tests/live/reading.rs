//! Reading every state, at rest and in every motion.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Duration;

use franka_async::control::{Finish, Torques};
use franka_async::error::ReadError;
use franka_async::state::Reading;
use franka_async::{MotionError, Pose, Robot};
use franka_proto::RobotError;
use franka_sim::{Running, Sim, Tool};
use futures::StreamExt;
use tokio::task::JoinHandle;
use tokio::time::{sleep, timeout};

use crate::{SOON, alone, by_the_clock, robot_time, under_way};

/// A robot that tolerates the losses of a busy machine.
async fn patient() -> (Robot, Running) {
    by_the_clock(Sim::fr3().ideal().tool(Tool::hand())).await
}

/// `message_id` of all states of a stream, each with the number missed before it. Ends with the
/// connection.
fn collect(robot: &Robot) -> JoinHandle<BTreeMap<u64, u64>> {
    let stream = robot.state_stream();
    let entry = |reading: Reading| (reading.state.message_id, reading.missed);
    tokio::spawn(stream.map(entry).collect())
}

/// The same for the records: one for each state that the control thread has received.
fn records(robot: &Robot) -> JoinHandle<BTreeMap<u64, u64>> {
    let mut records = robot.records();
    tokio::spawn(async move {
        let mut seen = BTreeMap::new();
        loop {
            match records.recv().await {
                Ok(record) => seen.insert(record.time, record.skipped),
                Err(tokio::sync::broadcast::error::RecvError::Closed) => return seen,
                Err(lagged) => panic!("{lagged}"),
            };
        }
    })
}

/// Torques of zero for this many milliseconds.
async fn float(robot: &Robot, milliseconds: u64) -> Result<(), MotionError> {
    let mut time = Duration::ZERO;
    let control = robot.control_torques(move |_, step| {
        time += step;
        Torques([0.0; 7]).finish_if(time >= Duration::from_millis(milliseconds))
    });
    control.await.map(drop)
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stream_has_every_state_whatever_moves() {
    let _alone = alone();
    let (robot, sim) = patient().await;
    let (states, records) = (collect(&robot), records(&robot));
    robot_time(&robot, 200).await;
    let up = Pose::translation(0.0, 0.0, 0.03) * robot.pose();
    robot.move_to(up).await.expect("it arrives");
    float(&robot, 300).await.expect("it floats");

    let mut control = robot.active_torques().await.expect("nothing else runs");
    let active = tokio::task::spawn_blocking(move || {
        for _ in 0..300 {
            control.read_once().expect("the motion goes on");
            control.write_once(Torques([0.0; 7])).expect("it fits");
        }
        control.read_once().expect("the motion goes on");
        let last = control.write_once(Torques([0.0; 7]).finish());
        last.expect("the robot ends it");
    });
    active.await.expect("no panic");

    let tripped = async {
        under_way(&robot).await;
        sim.with(|robot| robot.trip(RobotError::CartesianReflex))
            .await
    };
    let (outcome, tripped) = tokio::join!(float(&robot, 60_000), tripped);
    tripped.expect("the simulator runs");
    assert!(
        matches!(outcome, Err(MotionError::Control(_))),
        "{outcome:?}"
    );
    robot_time(&robot, 100).await;
    robot.shutdown().await;

    let (mut states, mut records) = (states.await.unwrap(), records.await.unwrap());
    assert!(states.len() > 1500, "{} states", states.len());
    // One of them may have begun, or ended, a state earlier; and before its first state a stream
    // has missed none.
    let first = states.keys().next().max(records.keys().next()).copied();
    let last = states.keys().last().min(records.keys().last()).copied();
    let both = first.unwrap() + 1..=last.unwrap();
    states.retain(|time, _| both.contains(time));
    records.retain(|time, _| both.contains(time));
    assert_eq!(states, records, "the same states, with the same gaps");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_slow_reader_is_told_how_many_states_it_missed() {
    let _alone = alone();
    let (robot, _sim) = patient().await;
    let eager = collect(&robot);
    let mut slow = robot.state_stream();
    let first = slow.next().await.expect("states come");
    // More than the reader may lag behind.
    robot_time(&robot, 1800).await;
    let late = slow.next().await.expect("states come");
    let prompt = slow.next().await.expect("states come");
    let mut never = robot.state_stream();
    robot_time(&robot, 1800).await;
    let lagged = never.next().await.expect("states come");
    robot.shutdown().await;
    while slow.next().await.is_some() {}

    let eager = eager.await.unwrap();
    let between = eager.range(first.state.message_id + 1..late.state.message_id);
    // States that came meanwhile, and states that never came.
    let came = between.clone().count() as u64;
    let lost = eager
        .range(first.state.message_id + 1..=late.state.message_id)
        .map(|(_, missed)| missed);
    assert!(came > 300, "{came} came meanwhile");
    assert_eq!(late.missed, came + lost.sum::<u64>());
    assert_eq!(Some(&prompt.missed), eager.get(&prompt.state.message_id));
    assert!(lagged.missed > 300, "{} before the first", lagged.missed);
}

/// While no subscriber waits for states, the newest published one may be fifty states old.
#[tokio::test(flavor = "multi_thread")]
async fn watch_begins_with_newest_state_and_moves_to_newer_ones() {
    let _alone = alone();
    let (robot, _sim) = patient().await;
    for pause in (100..150).step_by(7) {
        sleep(Duration::from_millis(pause)).await;
        let now = robot.state().message_id;
        let mut states = robot.states();
        let first = states.newest().message_id;
        assert!(first >= now, "{first} after {now}");
        let second = states.changed().await.expect("states come").message_id;
        // Newer than when the watch began: `first` may be newer, too.
        assert!(second > now, "{second} after {now}");
    }
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn reading_ends_when_the_closure_says_so() {
    let _alone = alone();
    let (robot, _sim) = patient().await;
    let reading = async {
        let mut times = Vec::new();
        let all = robot.read(|state| {
            times.push(state.message_id);
            match times.len() {
                100 => ControlFlow::Break(std::mem::take(&mut times)),
                _ => ControlFlow::Continue(()),
            }
        });
        all.await.expect("the connection lives")
    };
    let moving = robot.move_to(Pose::translation(0.0, 0.0, 0.02) * robot.pose());
    let (times, moved) = tokio::join!(reading, moving);
    moved.expect("it arrives all the same");
    assert_eq!(times.len(), 100);
    assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn reading_fails_on_silence_or_end_of_the_connection() {
    let forever = |robot: &Robot| {
        let robot = robot.clone();
        tokio::spawn(async move { robot.read::<()>(|_| ControlFlow::Continue(())).await })
    };
    let _alone = alone();
    let (robot, sim) = patient().await;
    let (release, held) = std::sync::mpsc::channel::<()>();
    // A reader from before the robot's silence, and a reader that begins during it.
    let readings = async {
        for _ in 0..2 {
            let silent = timeout(SOON, forever(&robot)).await.expect("no hang");
            let error = silent.unwrap().unwrap_err();
            assert!(matches!(error, ReadError::LinkLost { .. }), "{error:?}");
            let text = "libfranka: UDP receive: Timeout";
            assert!(error.to_string().starts_with(text), "{error}");
        }
        drop(release);
    };
    let silence = sim.with(move |_| held.recv().is_err());
    let ((), silent) = tokio::join!(readings, silence);
    assert_eq!(silent, Ok(true));

    // The robot is back, and the stream with it.
    let mut stream = robot.state_stream();
    assert!(stream.next().await.is_some());
    let reading = forever(&robot);
    sim.stop().await;
    let ended = timeout(SOON, reading).await.expect("no hang").unwrap();
    let text = "libfranka: server closed connection";
    let error = ended.unwrap_err();
    assert!(error.to_string().starts_with(text), "{error}");
    let drained = timeout(SOON, async { while stream.next().await.is_some() {} });
    drained.await.expect("the stream ends");
    let after = robot.read(|_| ControlFlow::Break(())).await;
    assert_eq!(after, Err(error));
}
