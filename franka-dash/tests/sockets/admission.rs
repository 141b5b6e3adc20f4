//! Which requests the server answers.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};

use franka_dash::{BindError, Options};

use crate::viewer::Served;

/// The status of the answer to a request for a socket with these lines.
fn status(address: SocketAddr, lines: &str) -> u16 {
    let mut stream = TcpStream::connect(address).expect("a connection");
    let request = format!(
        "GET /ws HTTP/1.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n{lines}\r\n\r\n"
    );
    stream.write_all(request.as_bytes()).expect("a request");
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).expect("an answer");
    let status = std::str::from_utf8(&answer[9..]).expect("a status");
    status.parse().expect("a status")
}

#[test]
fn foreign_pages_and_names_are_refused() {
    let served = Served::new(|_| Options::default());
    let address = served.address;
    for (lines, wanted) in [
        ("Host: localhost", 101),
        ("Host: localhost\r\nOrigin: http://localhost", 101),
        ("Host: localhost\r\nOrigin: http://evil.example", 403),
        ("Host: localhost\r\nOrigin: null", 403),
        ("Host: evil.example\r\nOrigin: http://evil.example", 403),
        ("Host: 192.168.0.7", 403),
    ] {
        assert_eq!(status(address, lines), wanted, "{lines}");
    }
}

#[test]
fn a_token_is_asked_for() {
    let served = Served::new(|_| Options::default().token("f00d"));
    let address = served.address;
    for (lines, wanted) in [
        ("Host: localhost", 401),
        (
            "Host: localhost\r\nSec-WebSocket-Protocol: franka-dash, token.beef",
            401,
        ),
        (
            "Host: localhost\r\nSec-WebSocket-Protocol: franka-dash, token.f00d",
            101,
        ),
        (
            "Host: 192.168.0.7\r\nSec-WebSocket-Protocol: franka-dash, token.f00d",
            101,
        ),
    ] {
        assert_eq!(status(address, lines), wanted, "{lines}");
    }
}

#[tokio::test]
async fn without_a_token_only_this_computer_is_served() {
    let everywhere = "0.0.0.0:0".parse().expect("an address");
    let refused = franka_dash::bind(everywhere, &Options::default()).await;
    assert!(matches!(refused, Err(BindError::NoToken { .. })));
    let options = Options::default().token("f00d");
    franka_dash::bind(everywhere, &options)
        .await
        .expect("a port");
}

#[tokio::test]
async fn what_is_sent_does_not_wait_for_an_acknowledgement() {
    let here = "127.0.0.1:0".parse().expect("an address");
    let bound = franka_dash::bind(here, &Options::default()).await;
    let listener = bound.expect("a port");
    let address = listener.local_addr().expect("an address");
    let _client = TcpStream::connect(address).expect("a connection");
    let (accepted, _) = listener.accept().await.expect("a connection");
    assert!(accepted.nodelay().expect("an option"));
}

#[test]
fn the_page_is_served_with_a_policy_that_keeps_everything_else_out() {
    let served = Served::new(|_| Options::default());
    for (path, kind) in [
        ("", "text/html"),
        ("dash.js", "text/javascript"),
        ("dash.css", "text/css"),
        ("licenses", "text/plain"),
    ] {
        let answer = ureq::get(format!("http://{}/{path}", served.address)).call();
        let answer = answer.unwrap_or_else(|error| panic!("{path}: {error}"));
        let header = |name| answer.headers()[name].to_str().expect("text");
        assert!(header("content-type").starts_with(kind), "{path}");
        let policy = header("content-security-policy");
        assert!(policy.starts_with("default-src 'self';"), "{path}");
    }
}
