//! The end effectors: the driver's handles and the simulated devices over real sockets.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use franka_async::Pose;
use franka_async::error::{ConnectError, GripperError, Party};
use franka_async::gripper::{Grasp, Gripper};
use franka_async::vacuum::{Profile, Vacuum, VacuumGripper};
use franka_proto::gripper;
use franka_sim::{Fingers, Running, Sim, Suction};
use franka_tests::PATIENCE;
use tokio::time::{sleep, timeout};

use crate::{SOON, alone, connect};

const ABORTED: &str = "libfranka gripper: Command aborted!";

/// A robot with a hand that has an object of 5 cm between its fingers and knows its width.
async fn with_hand() -> (Gripper, Running) {
    let sim = Sim::fr3().ideal().hand(Fingers::new().with_object(0.05), 0);
    let sim = sim.wait_for_commands(PATIENCE).start().await;
    let sim = sim.expect("a simulator starts");
    let gripper = hand_of(&sim).await.expect("a hand takes a client");
    assert_eq!(gripper.state().max_width, 0.0);
    let early = gripper.move_to(0.05, 0.1).await.expect_err("no homing");
    let unhomed =
        "(width 0.05 m, but the gripper does not know its greatest width yet: home it first)";
    assert!(early.to_string().ends_with(unhomed), "{early}");
    assert!(gripper.homing().await.expect("a homing"));
    assert_eq!(gripper.state().max_width, 0.08);
    (gripper, sim)
}

async fn hand_of(sim: &Running) -> Result<Gripper, ConnectError<gripper::Version>> {
    Gripper::connect(sim.hand().expect("a hand").addr()).await
}

fn object() -> Grasp {
    Grasp::new(0.05, 0.1, 40.0)
}

fn slow_grasp() -> Grasp {
    Grasp::new(0.05, 0.002, 40.0)
}

/// Waits until the fingers have begun to move.
async fn fingers_move(gripper: &Gripper) {
    let begin = gripper.state().width;
    let mut states = gripper.states();
    let moved = states.wait_for(|state| state.width != begin);
    timeout(SOON, moved)
        .await
        .expect("the fingers move")
        .expect("a connection");
}

/// Waits for a width at which the fingers then stay.
async fn width_at_rest(gripper: &Gripper) -> f64 {
    let mut states = gripper.states();
    let mut last = f64::NAN;
    let rest = async {
        let mut still = 0;
        while still < 5 {
            let width = states.changed().await.expect("a connection").width;
            still = if width == last { still + 1 } else { 0 };
            last = width;
        }
    };
    timeout(SOON, rest).await.expect("the fingers stop");
    last
}

#[tokio::test(flavor = "multi_thread")]
async fn a_hand_moves_grasps_and_lets_go_while_the_arm_moves() {
    let _alone = alone();
    let (gripper, sim) = with_hand().await;
    let robot = connect(&sim).await;
    let up = Pose::translation(0.0, 0.0, 0.1) * robot.pose();
    let moving = tokio::spawn(robot.move_to(up).speed(0.25).into_future());
    assert!(gripper.move_to(0.06, 0.1).await.expect("a move"));
    assert!((gripper.state().width - 0.06).abs() < 1e-9);
    let refused = |error: GripperError| {
        let text = error.to_string();
        let why = text.strip_prefix("libfranka gripper: Command failed! (");
        (error.party(), why.map(ToOwned::to_owned))
    };
    let caller = |why: &str| (Party::Caller, Some(format!("{why})")));
    for (width, speed, why) in [
        (0.09, 0.1, "width 0.09 m, expected 0 to 0.08 m"),
        (-0.01, 0.1, "width -0.01 m, expected 0 to 0.08 m"),
        (f64::NAN, 0.1, "width NaN m, expected 0 to 0.08 m"),
        (0.05, 0.0, "speed 0 m/s, expected more than 0"),
        (0.05, f64::INFINITY, "speed inf m/s, expected more than 0"),
    ] {
        let error = gripper.move_to(width, speed).await.unwrap_err();
        assert_eq!(refused(error), caller(why));
    }
    for (grasp, why) in [
        (
            Grasp::new(0.03, 0.1, -1.0),
            "force -1 N, expected more than 0",
        ),
        (
            Grasp {
                epsilon_outer: -0.01,
                ..Grasp::new(0.03, 0.1, 40.0)
            },
            "epsilon_outer -0.01 m, expected 0 or more",
        ),
    ] {
        let error = gripper.grasp(grasp).await.unwrap_err();
        assert_eq!(refused(error), caller(why));
    }

    assert!(
        !gripper
            .grasp(Grasp::new(0.03, 0.1, 40.0))
            .await
            .expect("no grasp")
    );
    assert!(!gripper.state().is_grasped);
    assert!(gripper.grasp(object()).await.expect("a grasp"));
    assert!(gripper.state().is_grasped);

    let hand = sim.hand().expect("a hand");
    let taken = hand.with(|hand| hand.mechanism_mut().take_object()).await;
    assert_eq!(taken, Ok(Some(0.05)));
    let mut states = gripper.states();
    let lost = states.wait_for(|state| !state.is_grasped);
    timeout(SOON, lost)
        .await
        .expect("it shows")
        .expect("a state");
    moving.await.expect("no panic").expect("the arm arrives");
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn stop_interrupts_the_action_that_runs() {
    let _alone = alone();
    let (gripper, _sim) = with_hand().await;
    let other = gripper.clone();
    let moving = tokio::spawn(async move { other.move_to(0.06, 0.002).await });
    fingers_move(&gripper).await;
    assert!(gripper.stop().await.expect("a stop"));
    let error = moving.await.expect("no panic").unwrap_err();
    assert_eq!(error.to_string(), ABORTED);
    assert!(width_at_rest(&gripper).await > 0.07);
    // And so does a newer action.
    let other = gripper.clone();
    let homing = tokio::spawn(async move { other.homing().await });
    fingers_move(&gripper).await;
    assert!(gripper.move_to(0.08, 0.1).await.expect("a move"));
    assert_eq!(homing.await.unwrap().unwrap_err().to_string(), ABORTED);
}

#[tokio::test(flavor = "multi_thread")]
async fn dropping_an_action_stops_it_and_nothing_else() {
    let _alone = alone();
    let (gripper, _sim) = with_hand().await;
    for action in 0..3 {
        assert!(gripper.move_to(0.08, 0.1).await.expect("a move"));
        let dropped = async {
            match action {
                0 => gripper.grasp(slow_grasp()).await,
                1 => gripper.move_to(0.06, 0.002).await,
                _ => gripper.homing().await,
            }
        };
        tokio::select! {
            outcome = dropped => panic!("{outcome:?}"),
            () = fingers_move(&gripper) => {}
        }
        let width = width_at_rest(&gripper).await;
        assert!(width > 0.06 && width < 0.08, "{action}: {width}");
        assert!(!gripper.state().is_grasped);
    }
    // A superseded action stops nothing.
    assert!(gripper.move_to(0.08, 0.1).await.expect("a move"));
    let mut older = Box::pin(gripper.move_to(0.06, 0.001));
    tokio::select! {
        outcome = &mut older => panic!("{outcome:?}"),
        () = fingers_move(&gripper) => {}
    }
    let newer = gripper.grasp(Grasp::new(0.05, 0.03, 40.0));
    let (grasped, ()) = tokio::join!(newer, async {
        sleep(Duration::from_millis(100)).await;
        drop(older);
    });
    assert!(grasped.expect("a grasp"));
    assert!(gripper.state().is_grasped);
}

#[tokio::test(flavor = "multi_thread")]
async fn one_client_at_a_time_and_one_that_goes_stops_its_action() {
    let _alone = alone();
    let (gripper, sim) = with_hand().await;
    assert!(hand_of(&sim).await.is_err());
    assert!(gripper.grasp(object()).await.expect("a grasp"));
    drop(gripper);
    // The first may be on its way out still.
    let gripper = eventually(&sim).await;
    assert!(gripper.state().is_grasped, "a grasp outlasts its client");
    assert!(gripper.move_to(0.08, 0.1).await.expect("a move"));
    let other = gripper.clone();
    let moving = tokio::spawn(async move { other.move_to(0.06, 0.002).await });
    fingers_move(&gripper).await;
    drop(gripper);
    moving.abort();
    let gripper = eventually(&sim).await;
    assert!(width_at_rest(&gripper).await > 0.07);
}

async fn eventually(sim: &Running) -> Gripper {
    let deadline = Instant::now() + SOON;
    loop {
        match hand_of(sim).await {
            Ok(gripper) => return gripper,
            Err(error) if Instant::now() > deadline => panic!("{error}"),
            Err(_) => sleep(Duration::from_millis(20)).await,
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_hand_that_goes_ends_everything_and_says_why() {
    let _alone = alone();
    let (gripper, sim) = with_hand().await;
    let (other, mut states) = (gripper.clone(), gripper.states());
    let moving = tokio::spawn(async move { other.move_to(0.06, 0.001).await });
    fingers_move(&gripper).await;
    sim.stop().await;
    let error = timeout(SOON, moving).await.expect("no hang").unwrap();
    let text = "libfranka: server closed connection";
    assert_eq!(error.unwrap_err().to_string(), text);
    assert_eq!(gripper.stop().await.unwrap_err().to_string(), text);
    timeout(SOON, async { while states.changed().await.is_ok() {} })
        .await
        .expect("listeners hear of the end");
}

#[tokio::test(flavor = "multi_thread")]
async fn garbage_costs_a_client_its_connection_and_nobody_else() {
    let _alone = alone();
    let sim = Sim::fr3()
        .ideal()
        .hand(Fingers::new(), 0)
        .start()
        .await
        .expect("a simulator");
    let address = sim.hand().expect("a hand").addr();
    for garbage in [
        &[0; 40][..],
        b"GET / HTTP/1.1\r\n\r\n",
        &[1, 0, 0, 0, 0, 0, 10, 0, 0, 0],
    ] {
        let closed = tokio::task::spawn_blocking(move || {
            let mut stream = TcpStream::connect(address)?;
            stream.set_read_timeout(Some(SOON))?;
            stream.write_all(garbage)?;
            stream.read(&mut [0; 16])
        });
        // An orderly end, or a reset if the hand had not read everything.
        assert!(!matches!(closed.await.unwrap(), Ok(1..)));
        drop(eventually(&sim).await);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn connect_without_a_listener_is_refused() {
    let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let address = port.local_addr().unwrap();
    drop(port);
    let error = Gripper::connect(address).await.unwrap_err();
    assert!(matches!(error, ConnectError::Refused { .. }), "{error}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_vacuum_gripper_holds_drops_and_stops() {
    let _alone = alone();
    let sim = Sim::fr3()
        .ideal()
        .vacuum_gripper(Suction::new().with_object(), 0);
    let sim = sim.start().await.expect("a simulator starts");
    let address = sim.vacuum_gripper().expect("a gripper").addr();
    let gripper = VacuumGripper::connect(address).await.expect("a session");
    let suck = |vacuum, timeout| {
        gripper.vacuum(Vacuum {
            vacuum,
            profile: Profile::P0,
            timeout,
        })
    };
    assert!(suck(50, 2000).await.expect("a vacuum"));
    assert!(gripper.state().part_present);
    assert!(
        gripper
            .drop_off(Duration::from_secs(1))
            .await
            .expect("a drop")
    );
    assert!(gripper.state().part_detached && !gripper.state().part_present);
    assert!(!suck(70, 100).await.expect("not in time"));
    let (aborted, stopped) = tokio::join!(suck(200, 60_000), async {
        sleep(Duration::from_millis(100)).await;
        gripper.stop().await
    });
    assert!(stopped.expect("a stop"));
    let text = "libfranka vacuum gripper: Command aborted!";
    assert_eq!(aborted.unwrap_err().to_string(), text);
    let text = "libfranka vacuum gripper: Command failed!";
    assert_eq!(suck(50, -1).await.unwrap_err().to_string(), text);
}
