//! Impossible connections: each returns its error in time, and leaves nothing behind.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use franka_async::error::{ConnectError, Party};
use franka_async::{Realtime, Robot};
use franka_proto::Version;
use franka_proto::framing::next_message;
use franka_proto::server::{Event, Session};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

use crate::{SOON, alone, simulated};

async fn refused(endpoint: impl Into<franka_async::connection::Endpoint>) -> ConnectError {
    let begun = Instant::now();
    let connecting = Robot::builder(endpoint)
        .realtime(Realtime::Ignore)
        .connect();
    let error = connecting.await.expect_err("there is no robot");
    assert!(begun.elapsed() < SOON, "{error} took {:?}", begun.elapsed());
    // And the process can connect again.
    let (robot, _sim) = simulated().await;
    robot.shutdown().await;
    error
}

/// A server on this machine whose only client is served by `serve`.
async fn server<F: Future<Output = ()> + Send + 'static>(
    serve: impl Fn(TcpStream) -> F + Send + 'static,
) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        while let Ok((stream, _)) = listener.accept().await {
            serve(stream).await;
        }
    });
    address
}

/// Answers the first message as a robot of `version` does, and returns the stream.
async fn handshake(mut stream: TcpStream, version: Version) -> TcpStream {
    let mut received = Vec::new();
    let mut session = Session::new(version);
    loop {
        assert!(stream.read_buf(&mut received).await.unwrap() > 0);
        let Some(message) = next_message(&received).unwrap() else {
            continue;
        };
        let reply = match session.on_message(message).unwrap() {
            Event::Connect { reply, .. } | Event::Incompatible { reply, .. } => reply,
            other => panic!("{other:?}"),
        };
        stream.write_all(reply.as_bytes()).await.unwrap();
        return stream;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_closed_port_refuses() {
    let _alone = alone();
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let error = refused(address).await;
    assert!(matches!(error, ConnectError::Refused { .. }), "{error:?}");
    let text = "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk.";
    assert_eq!(error.to_string(), format!("{text} ({address})"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_host_that_does_not_exist_is_not_found() {
    let _alone = alone();
    let error = refused("no-host-of-this-name.invalid").await;
    assert_eq!(
        error.to_string(),
        "libfranka: Connection error: Host not found (no-host-of-this-name.invalid)"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_host_that_does_not_answer_times_out() {
    let _alone = alone();
    // A listener whose queue is full drops all other packets, as a host without a route would.
    let socket = socket2::Socket::new(socket2::Domain::IPV4, socket2::Type::STREAM, None).unwrap();
    socket
        .bind(&SocketAddr::from(([127, 0, 0, 1], 0)).into())
        .unwrap();
    socket.listen(0).unwrap();
    let address = socket.local_addr().unwrap().as_socket().unwrap();
    let mut fill = Vec::new();
    while let Ok(Ok(stream)) =
        tokio::time::timeout(Duration::from_millis(300), TcpStream::connect(address)).await
    {
        fill.push(stream);
    }
    let error = refused(address).await;
    assert!(matches!(error, ConnectError::Timeout { .. }), "{error:?}");
    assert_eq!(
        error.to_string(),
        format!(
            "libfranka: Connection timeout. Please check your network connection or settings. ({address})"
        )
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn another_version_is_named() {
    let _alone = alone();
    // A robot of version 9, which no version of this crate speaks: status 1, version 9.
    let address = server(|mut stream| async move {
        let mut request = [0; 16];
        stream.read_exact(&mut request).await.unwrap();
        let reply = [0, 0, 0, 0, 0, 0, 0, 0, 15, 0, 0, 0, 1, 9, 0];
        stream.write_all(&reply).await.unwrap();
    })
    .await;
    let error = refused(address).await;
    assert_eq!(
        error.to_string(),
        "libfranka: Incompatible library version (server version: 9, library version: 10): a \
         Franka Research 3 \
         with system image 5.7.2 speaks version 9: update the robot's system to 5.9.0 or later (Desk, Settings, \
         System)"
    );
    // The robot keeps to its protocol, so there is nothing to report.
    assert_eq!(error.party(), Party::Robot);
    let error: &dyn std::error::Error = &error;
    assert!(error.source().is_none());
}

#[tokio::test(flavor = "multi_thread")]
async fn garbage_in_the_handshake_is_an_error_at_once() {
    let _alone = alone();
    for (garbage, text) in [
        (&[0_u8; 40][..], "libfranka: Incorrect TCP message size."),
        (
            b"HTTP/1.1 400 Bad Request\r\n\r\n",
            "the header announces a message of 808465440 bytes",
        ),
        (
            &[0, 0, 0, 0, 0, 0, 0, 0, 13, 0, 0, 0, 0],
            "libfranka: Incorrect TCP message size.",
        ),
        (
            &[0, 0, 0, 0, 0, 0, 0, 0, 15, 0, 0, 0, 77, 10, 0],
            "libfranka: Protocol error during connection attempt",
        ),
    ] {
        let address = server(move |mut stream| async move {
            stream.write_all(garbage).await.unwrap();
            let mut rest = Vec::new();
            let _ = stream.read_to_end(&mut rest).await;
        })
        .await;
        let error = refused(address).await.to_string();
        assert!(error.starts_with(text), "{error}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn silent_closing_and_stateless_servers_are_told_apart() {
    let _alone = alone();
    let silent = server(|stream| async move {
        tokio::time::sleep(SOON).await;
        drop(stream);
    })
    .await;
    assert_eq!(
        refused(silent).await.to_string(),
        format!("libfranka: TCP receive: Timeout ({silent})")
    );
    let closing = server(|mut stream| async move {
        let mut request = [0; 16];
        stream.read_exact(&mut request).await.unwrap();
    })
    .await;
    assert_eq!(
        refused(closing).await.to_string(),
        "the connection was closed before the first answer: another client may be connected, or \
         the address belongs to another device (libfranka: server closed connection)"
    );
    let stateless = server(|stream| async move {
        let stream = handshake(stream, Version::V10).await;
        tokio::time::sleep(SOON).await;
        drop(stream);
    })
    .await;
    assert_eq!(
        refused(stateless).await.to_string(),
        format!("libfranka: UDP receive: Timeout ({stateless})")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_second_client_is_refused_and_the_first_is_not_disturbed() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let second = Robot::builder(sim.addr())
        .realtime(Realtime::Ignore)
        .connect()
        .await;
    let error = second.expect_err("the robot has a client");
    assert_eq!(error.entry(), "closed-by-peer", "{error}");
    let error = error.to_string();
    assert!(error.contains("another client may be connected"), "{error}");
    let up = franka_async::Pose::translation(0.0, 0.0, 0.02) * robot.pose();
    robot.move_to(up).await.unwrap();
    robot.shutdown().await;
    // Without the first connection the queue has room.
    let robot = crate::connect(&sim).await;
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn enforce_without_realtime_kernel_fails_before_sending() {
    let _alone = alone();
    if franka_rt::sched::kernel_is_realtime() {
        return;
    }
    // No server listens at this port, but the host is checked first.
    let error = Robot::connect("127.0.0.1:1").await.expect_err("refused");
    let ConnectError::Realtime(error) = error else {
        panic!("{error:?}")
    };
    let text = error.to_string();
    assert!(
        text.starts_with("libfranka: Running kernel does not have realtime capabilities. (")
            || text.starts_with("libfranka: unable to set realtime scheduling: ")
            || text.starts_with("libfranka: unable to get maximum possible thread priority: "),
        "{text}"
    );
}
