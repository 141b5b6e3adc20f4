//! Futures of a team, dropped after any number of polls.

use super::grasp::{bases, object};
use super::*;

/// Polls `future` this many times, each time when it was woken; `None` if it has not resolved by
/// then.
async fn polled<F: Future + Unpin>(future: &mut F, polls: u32) -> Option<F::Output> {
    let mut left = polls;
    poll_fn(|context| {
        if left == 0 {
            return Poll::Ready(None);
        }
        left -= 1;
        match std::pin::Pin::new(&mut *future).poll(context) {
            Poll::Pending if left > 0 => Poll::Pending,
            Poll::Pending => Poll::Ready(None),
            Poll::Ready(output) => Poll::Ready(Some(output)),
        }
    })
    .await
}

/// A team of both, once earlier dropped motions have ended.
async fn engaged(robots: &[Robot; 2]) -> Team<2> {
    for _ in 0..500 {
        match engaging(robots).await {
            Ok(team) => return team,
            Err(refused) => assert_eq!(refused.error, MotionError::Busy),
        }
        for robot in robots {
            robot_time(robot, 10).await;
        }
    }
    panic!("what was dropped goes on");
}

fn engaging(robots: &[Robot; 2]) -> impl Future<Output = Result<Team<2>, NotEngaged>> {
    let [left, right] = robots;
    Team::engage_tolerating(
        SOON,
        [(left, Engage::default()), (right, Engage::default())],
    )
}

async fn both_idle(robots: &[Robot; 2]) {
    for robot in robots {
        until(robot, |state| !state.motion_running()).await;
        assert!(robot.state().errors.is_empty(), "{:?}", robot.state());
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn team_futures_may_be_dropped_at_any_poll() {
    let _alone = alone();
    let Two {
        team,
        robots,
        sims: _sims,
    } = two().await;
    drop(team);
    both_idle(&robots).await;
    let mut polls = 0;
    loop {
        let begun = polled(&mut Box::pin(engaging(&robots)), polls).await;
        if let Some(Ok(_)) = begun {
            break;
        }
        let refused = begun.and_then(Result::err).map(|it| it.error);
        assert!(matches!(refused, None | Some(MotionError::Busy)));
        // It leaves no session behind.
        let team = engaged(&robots).await;
        let mut ending = Box::pin(team.disengage());
        if let Some(ended) = polled(&mut ending, polls).await {
            assert!(ended.iter().all(Result::is_ok), "{ended:?}");
        }
        drop(ending);
        both_idle(&robots).await;
        polls += 1;
        assert!(polls < 60, "it takes ever more polls");
    }
    assert!(polls > 1, "dropped {polls} times on the way");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_future_of_an_object_may_be_dropped_at_every_poll() {
    let _alone = alone();
    let two = two().await;
    let grasp = two.team.grasp(bases(), object()).expect("both hold");
    let mut dropped = 0;
    for polls in 0..60 {
        let way = if polls % 2 == 0 { 0.01 } else { 0.0 };
        let mut motion = grasp.move_to(up(way) * object());
        if let Some(outcomes) = polled(&mut motion, polls).await {
            assert!(outcomes.iter().all(Result::is_ok), "{outcomes:?}");
            break;
        }
        drop(motion);
        let stopped = (polls > 0).then_some(TeamStop::Requested);
        assert_eq!(two.team.stopped(), stopped, "after {polls} polls");
        dropped += 1;
        for robot in &two.robots {
            robot_time(robot, u64::from(polls) % 4 * 10).await;
            assert!(robot.state().errors.is_empty());
        }
    }
    // Before the first poll and after it; on a busy machine it may have arrived by the second.
    assert!((2..60).contains(&dropped), "dropped {dropped} times");
    for outcome in grasp.move_to(object()).await {
        outcome.expect("it arrives");
    }
}

/// The drop of a motion that a newer one has superseded stops nothing.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_motion_that_was_superseded_may_be_dropped_at_every_poll() {
    let _alone = alone();
    let two = two().await;
    let grasp = two.team.grasp(bases(), object()).expect("both hold");
    for (of_older, of_newer) in (0..3).flat_map(|older| (1..4).map(move |newer| (older, newer))) {
        let mut older = grasp.move_with(up(0.1) * object(), |motion| motion.speed(0.2));
        let ended = polled(&mut older, of_older).await;
        // The wake-ups before its end may merge into one, and then its second poll is the last.
        let may_end = of_older > 1;
        let as_expected = ended
            .as_ref()
            .is_none_or(|it| may_end && it.iter().all(Result::is_ok));
        assert!(as_expected, "{of_older} polls: {ended:?}");
        let mut newer = grasp.move_to(object());
        let ended = polled(&mut newer, of_newer).await;
        drop(older);
        let outcomes = match ended {
            Some(outcomes) => outcomes,
            None => newer.await,
        };
        let arrived = outcomes.iter().all(Result::is_ok);
        assert!(arrived, "{of_older} and {of_newer} polls: {outcomes:?}");
    }
}
