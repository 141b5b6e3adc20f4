//! A robot that violates the protocol, or sends nothing: errors that name the violation, motions
//! that resolve, and a next connection.

use std::net::UdpSocket;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use franka_async::error::CommandError;
use franka_async::settings::Load;
use franka_async::state::RobotState;
use franka_async::{MotionError, Pose};
use franka_proto::Command;
use franka_proto::framing::Header;
use tokio::task::JoinSet;
use tokio::time::{sleep, timeout};

use crate::peer::{Manners, Peer, Treatment, reply};
use crate::{SOON, alone, long_way, under_way};

const LOAD: Load = Load {
    m_load: 0.1,
    F_x_Cload: [0.0; 3],
    I_load: [1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 1e-4],
};

/// Streams that end a connection, and their names in the error.
const GARBAGE: [(&[u8], &str); 5] = [
    (&[0; 40], "libfranka: Incorrect TCP message size."),
    // A size below the header's, and the largest there is.
    (
        &[1, 0, 0, 0, 1, 0, 0, 0, 11, 0, 0, 0],
        "libfranka: Incorrect TCP message size.",
    ),
    (
        &[1, 0, 0, 0, 1, 0, 0, 0, 0xff, 0xff, 0xff, 0xff],
        "the header announces a message of 4294967295 bytes",
    ),
    (
        b"HTTP/1.1 400 Bad Request\r\n\r\n",
        "the header announces a message of 808465440 bytes",
    ),
    // A message that is announced, and cut off.
    (
        &[1, 0, 0, 0, 1, 0, 0, 0, 13, 0, 0, 0],
        "libfranka: server closed connection",
    ),
];

#[tokio::test(flavor = "multi_thread")]
async fn garbage_in_mid_session_closes_everything_and_says_why() {
    let _alone = alone();
    let peer = Peer::start(Manners::default());
    for in_motion in [false, true] {
        for (garbage, text) in GARBAGE {
            let robot = peer.connect().await;
            let (mut states, mut records) = (robot.states(), robot.records());
            let moving = in_motion.then(|| tokio::spawn(long_way(&robot).into_future()));
            if in_motion {
                under_way(&robot).await;
            }
            peer.inject(garbage);
            if text.ends_with("closed connection") {
                peer.close();
            }
            if let Some(moving) = moving {
                let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
                let error = outcome.unwrap_err();
                assert!(error.to_string().starts_with(text), "{error}");
            }
            let ended = timeout(SOON, async {
                while states.changed().await.is_ok() {}
                while !matches!(
                    records.recv().await,
                    Err(tokio::sync::broadcast::error::RecvError::Closed)
                ) {}
            });
            ended.await.expect("listeners hear of the end");
            assert!(robot.records().recv().await.is_err());
            for error in [
                robot.recover().await.unwrap_err().to_string(),
                robot.stop().await.unwrap_err().to_string(),
                robot.move_to(robot.pose()).await.unwrap_err().to_string(),
            ] {
                assert!(error.starts_with(text), "{error}");
            }
            robot.shutdown().await;
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn replies_that_nobody_waits_for_change_nothing() {
    let _alone = alone();
    let peer = Peer::start(Manners::default());
    let robot = peer.connect().await;
    let moving = tokio::spawn(robot.move_to(robot.pose()).into_future());
    for command_id in [0, 77, u32::MAX] {
        let header = Header {
            command: 1,
            command_id,
            size: 0,
        };
        peer.inject(&reply(header, 0));
        peer.inject(&reply(header, 200));
    }
    moving.await.unwrap().unwrap();
    robot.set_load(LOAD).await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn unknown_status_is_named_and_the_connection_lives() {
    let _alone = alone();
    let peer = Peer::start(Manners {
        request: |command| match command {
            Some(Command::SetLoad | Command::Move) => Treatment::Answer(200),
            _ => Treatment::Pass,
        },
        ..Manners::default()
    });
    let robot = peer.connect().await;
    let error = robot.set_load(LOAD).await.unwrap_err();
    assert!(matches!(error, CommandError::Violation(_)), "{error:?}");
    assert_eq!(
        error.to_string(),
        "libfranka: Unexpected response while handling Set Load command!"
    );
    // Again and again: an abandoned attempt must not occupy a place indefinitely.
    for _ in 0..40 {
        let error = robot.move_to(robot.pose()).await.unwrap_err();
        assert_eq!(
            error.to_string(),
            "libfranka: Unexpected response while handling Move command!"
        );
    }
    robot.set_joint_impedance([3000.0; 7]).await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_motion_whose_start_cannot_be_read_is_stopped() {
    static GARBLED: AtomicBool = AtomicBool::new(false);
    let _alone = alone();
    let peer = Peer::start(Manners {
        reply: |mut reply| {
            let started = reply[0] == 1 && reply[Header::SIZE] == 1;
            if started && !GARBLED.swap(true, Ordering::Relaxed) {
                reply[Header::SIZE] = 200;
            }
            reply
        },
        ..Manners::default()
    });
    let robot = peer.connect().await;
    let error = long_way(&robot).await.unwrap_err();
    assert!(matches!(error, MotionError::Violation(_)), "{error:?}");
    let still = timeout(SOON, async {
        while robot.state().motion_running() {
            sleep(Duration::from_millis(5)).await;
        }
    });
    still.await.expect("the robot was told to stop");
    // An immediate motion may meet the end of the abandoned one. It resolves, and another motion
    // arrives.
    let arrived = timeout(SOON, async {
        while let Err(error) = robot.move_to(robot.pose()).await {
            assert!(
                !matches!(error, MotionError::ConnectionClosed { .. }),
                "{error}"
            );
            // Refused while the arm still brakes.
            let _ = robot.recover().await;
        }
    });
    arrived.await.expect("the connection is still of use");
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_that_does_not_begin_is_told_to_stop_and_given_up() {
    let _alone = alone();
    let silent = Manners {
        request: |command| match command {
            Some(Command::Move | Command::StopMove) => Treatment::Swallow,
            _ => Treatment::Pass,
        },
        ..Manners::default()
    };
    let pretending = Manners {
        request: |command| match command {
            Some(Command::Move) => Treatment::Answer(1),
            _ => Treatment::Pass,
        },
        ..Manners::default()
    };
    let mut trials = JoinSet::new();
    for manners in [silent, pretending] {
        trials.spawn(async move {
            let peer = Peer::start(manners);
            let robot = peer.connect().await;
            let begun = Instant::now();
            let error = robot.move_to(robot.pose()).await.unwrap_err();
            assert!(matches!(error, MotionError::Protocol { .. }), "{error:?}");
            assert!(begun.elapsed() < 2 * SOON, "{error}");
            robot.set_load(LOAD).await.unwrap();
            robot.shutdown().await;
        });
    }
    while let Some(trial) = trials.join_next().await {
        trial.unwrap();
    }
}

/// As one may that rounds the numbers that it is given.
#[tokio::test(flavor = "multi_thread")]
async fn set_load_waits_a_limited_time_for_the_load_to_show() {
    let _alone = alone();
    let peer = Peer::start(Manners {
        request: |command| match command {
            Some(Command::SetLoad) => Treatment::Answer(0),
            _ => Treatment::Pass,
        },
        ..Manners::default()
    });
    let robot = peer.connect().await;
    let begun = robot.state().message_id;
    robot.set_load(LOAD).await.unwrap();
    assert!(robot.state().message_id > begun + 200);
    assert_eq!(robot.state().m_load, 0.0);
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_that_reads_no_requests_holds_up_no_stop() {
    let _alone = alone();
    let peer = Peer::start(Manners::default());
    let robot = peer.connect().await;
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    peer.stop_reading();
    // More than may wait for their answers at once: the rest waits for its turn.
    let mut calls = JoinSet::new();
    for _ in 0..40 {
        let robot = robot.clone();
        calls.spawn(async move { robot.set_load(LOAD).await });
    }
    robot.stop().await.unwrap();
    assert_eq!(moving.await.unwrap(), Err(MotionError::Stopped));
    for _ in 0..20 {
        let error = calls.join_next().await.unwrap().unwrap().unwrap_err();
        assert_eq!(error.to_string(), "no answer to Set Load within 5000 ms");
    }
    robot.shutdown().await;
    while let Some(call) = calls.join_next().await {
        assert!(call.unwrap().is_err());
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn stray_datagrams_do_not_disturb_a_motion() {
    let _alone = alone();
    let peer = Peer::start(Manners::default());
    let robot = peer.connect().await;
    let moving = tokio::spawn(long_way(&robot).speed(0.5).into_future());
    for address in ["127.0.0.1:0", "127.0.0.2:0"] {
        let stray = UdpSocket::bind(address).unwrap();
        for length in [0, 1, 371, 1376, 1377, 9000] {
            // From the robot's own address, a whole state is a state: only a stranger sends one
            // here.
            if length < 1377 || address.starts_with("127.0.0.2") {
                stray
                    .send_to(&vec![0xff; length], peer.client_udp())
                    .unwrap();
            }
        }
        sleep(Duration::from_millis(100)).await;
    }
    moving.await.unwrap().unwrap();
    assert_eq!(robot.stats().malformed.get(), 4);
    assert_eq!(robot.stats().foreign.get(), 6);
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn no_pose_is_followed_after_the_robot_has_gone() {
    let _alone = alone();
    let peer = Peer::start(Manners::default());
    let robot = peer.connect().await;
    let (sender, targets) = tokio::sync::watch::channel(robot.pose());
    let following = tokio::spawn(robot.follow(targets).into_future());
    under_way(&robot).await;
    drop(peer);
    let outcome = timeout(SOON, following).await.expect("no hang").unwrap();
    assert!(
        matches!(outcome, Err(MotionError::ConnectionClosed { .. })),
        "{outcome:?}"
    );
    assert!(
        sender.send(Pose::identity()).is_err(),
        "no program follows any more"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn moving_arm_is_braked_when_robot_closes_connection() {
    let _alone = alone();
    let peer = Peer::start(Manners::default());
    let robot = peer.connect().await;
    // Some four seconds at 0.26 rad/s.
    let mut turned = robot.state().q_d;
    turned[0] += 1.0;
    let moving = tokio::spawn(robot.move_joints(turned).speed(0.5).into_future());
    let mut states = robot.states();
    let fast = |state: &RobotState| state.dq.iter().any(|dq| dq.abs() > 0.1);
    let under_way = timeout(SOON, states.wait_for(fast)).await;
    under_way.expect("it moves").expect("it is connected");
    peer.close();
    let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
    assert!(
        matches!(outcome, Err(MotionError::ConnectionClosed { .. })),
        "{outcome:?}"
    );
    let speed = timeout(2 * SOON, async {
        loop {
            match peer.speed_at_goodbye() {
                Some(speed) => break speed,
                None => sleep(Duration::from_millis(5)).await,
            }
        }
    });
    let speed = speed.await.expect("the client goes");
    assert!(speed < 0.02, "{speed} rad/s when the client went");
}
