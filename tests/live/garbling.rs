//! A robot whose replies are complete and wrong, or correct and incomplete.

use std::net::UdpSocket;
use std::time::Duration;

use franka_async::MotionError;
use franka_async::connection::Version;
use franka_async::error::CommandError;
use franka_async::state::RobotState;
use franka_proto::framing::Header;
use franka_proto::{Command, Violation};
use tokio::time::{sleep, timeout};

use crate::peer::{Manners, Peer};
use crate::{SOON, alone, long_way, robot_time, under_way, until};

const STIFFNESS: [f64; 7] = [3000.0; 7];

fn is(reply: &[u8], command: Command) -> bool {
    let number = Version::V10.command_number(command).expect("it has it");
    reply[..4] == number.to_le_bytes()
}

#[tokio::test(flavor = "multi_thread")]
async fn replies_that_come_twice_count_once() {
    let _alone = alone();
    let peer = Peer::start(Manners {
        reply: |reply| [&reply[..], &reply[..]].concat(),
        ..Manners::default()
    });
    let robot = peer.connect().await;
    for _ in 0..5 {
        robot.set_joint_impedance(STIFFNESS).await.unwrap();
        robot.recover().await.unwrap();
    }
    // So does the end of a motion. That it begins twice is named, and the robot told to stop.
    let outcome = timeout(SOON, robot.move_to(robot.pose()).into_future()).await;
    let error = outcome.expect("no hang").unwrap_err();
    assert_eq!(
        error.to_string(),
        "libfranka: Move received unexpected motion started message."
    );
    // The state may be of before the motion: that it is over is shown by a parameter that the robot
    // takes.
    let rest = async {
        while robot.set_joint_impedance(STIFFNESS).await.is_err() {
            sleep(Duration::from_millis(5)).await;
        }
    };
    timeout(SOON, rest).await.expect("it stops");
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn replies_may_be_split_padded_and_of_any_command_number() {
    let _alone = alone();
    let peer = Peer::start(Manners {
        reply: |mut reply| {
            // Only the id names the request.
            reply[..4].copy_from_slice(&77_u32.to_le_bytes());
            if reply.len() == Header::SIZE + 1 {
                reply.extend([0xff; 3]);
                reply[8] += 3;
            }
            reply
        },
        piecewise: true,
        ..Manners::default()
    });
    let robot = peer.connect().await;
    robot.set_joint_impedance(STIFFNESS).await.unwrap();
    assert!(robot.urdf().await.unwrap().contains("<robot"));
    robot.move_to(robot.pose()).await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_reply_without_its_status_fails_its_request_and_no_other() {
    let _alone = alone();
    let peer = Peer::start(Manners {
        reply: |mut reply| {
            if is(&reply, Command::SetJointImpedance) {
                reply.truncate(Header::SIZE);
                reply[8] = Header::SIZE as u8;
            }
            reply
        },
        ..Manners::default()
    });
    let robot = peer.connect().await;
    for _ in 0..3 {
        let error = robot.set_joint_impedance(STIFFNESS).await.unwrap_err();
        assert!(
            matches!(error, CommandError::Violation(Violation::Reply { .. })),
            "{error:?}"
        );
        assert_eq!(error.to_string(), "libfranka: Incorrect TCP message size.");
        robot.recover().await.unwrap();
    }
    robot.move_to(robot.pose()).await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn half_a_message_leaves_requests_unanswered_not_hanging() {
    let _alone = alone();
    let peer = Peer::start(Manners::default());
    let robot = peer.connect().await;
    // Any following bytes count as its rest.
    let header = Header {
        command: 1,
        command_id: 99,
        size: 1 << 20,
    };
    peer.inject(&header.to_bytes());
    sleep(Duration::from_millis(50)).await;
    let error = robot.set_joint_impedance(STIFFNESS).await.unwrap_err();
    assert_eq!(
        error.to_string(),
        "no answer to Set Joint Impedance within 5000 ms"
    );
    timeout(SOON, robot.shutdown()).await.expect("no hang");
    let robot = peer.connect().await;
    robot.set_joint_impedance(STIFFNESS).await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_state_from_the_far_future_is_dropped_and_counted() {
    let _alone = alone();
    let peer = Peer::start(Manners::default());
    let robot = peer.connect().await;
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    // From the robot's own host: taken, every true state after it would be an old one.
    let state = RobotState {
        message_id: u64::MAX,
        ..robot.state()
    };
    let mut bytes = [0; RobotState::MAX_SIZE];
    let length = state.encode(Version::V10, &mut bytes).expect("room");
    let stray = UdpSocket::bind("127.0.0.1:0").unwrap();
    stray.send_to(&bytes[..length], peer.client_udp()).unwrap();
    until(&robot, |_| robot.stats().malformed.get() == 1).await;
    robot_time(&robot, 100).await;
    assert!(!moving.is_finished(), "the motion goes on");
    robot.stop().await.unwrap();
    assert_eq!(moving.await.unwrap(), Err(MotionError::Stopped));
    robot.shutdown().await;
}
