//! The requests that the server answers.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};

use franka_async::connection::admission::Token;
use franka_dash::{BindError, Options};

use crate::viewer::Served;

/// Lines of a request that opens a socket.
const UPGRADE: &str = "Connection: Upgrade\r\nUpgrade: websocket\r\n\
    Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n";

const SECRET: &str = "correct-horse-battery";

/// Returns the status of the answer to a request for a socket with these lines.
fn status(address: SocketAddr, lines: &str) -> u16 {
    status_of(address, "/ws", lines)
}

/// Like [`status`], at another path.
fn status_of(address: SocketAddr, path: &str, lines: &str) -> u16 {
    let mut stream = TcpStream::connect(address).expect("a connection");
    let request = format!("GET {path} HTTP/1.1\r\n{UPGRADE}{lines}\r\n\r\n");
    stream.write_all(request.as_bytes()).expect("a request");
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).expect("an answer");
    let status = std::str::from_utf8(&answer[9..]).expect("a status");
    status.parse().expect("a status")
}

fn token() -> Token {
    Token::new(SECRET).expect("a token")
}

#[test]
fn foreign_pages_names_and_proxies_are_refused_and_move_nothing() {
    let served = Served::movable();
    let (address, start) = (served.address, served.height());
    for (lines, wanted) in [
        ("Host: localhost", 101),
        ("Host: localhost\r\nOrigin: http://localhost", 101),
        ("Host: localhost\r\nOrigin: http://evil.example", 403),
        ("Host: localhost\r\nOrigin: null", 403),
        ("Host: localhost\r\nSec-Fetch-Site: cross-site", 403),
        ("Host: evil.example\r\nOrigin: http://evil.example", 403),
        ("Host: 192.168.0.7", 403),
        ("Host: localhost\r\nX-Forwarded-For: 192.168.0.9", 403),
        ("Host: localhost\r\nForwarded: for=192.168.0.9", 403),
        ("Host: localhost\r\nHost: evil.example", 400),
    ] {
        assert_eq!(status(address, lines), wanted, "{lines}");
        let rest = if wanted == 101 { 204 } else { wanted };
        assert_eq!(status_of(address, "/access", lines), rest, "{lines}");
    }
    assert!((served.height() - start).abs() < 1e-3 && !served.robot.state().motion_running());
}

#[test]
fn a_token_is_asked_for() {
    let served = Served::new(|_| Options::default().allow_motion().token(token()));
    let (address, start) = (served.address, served.height());
    let protocol = |token: &str| {
        format!("Sec-WebSocket-Protocol: franka-dash, token.{token}\r\nX-Forwarded-For: ::2")
    };
    for (lines, wanted) in [
        ("Host: localhost".to_owned(), 401),
        (format!("Host: localhost\r\n{}", protocol("")), 401),
        (format!("Host: localhost\r\n{}", protocol("beef")), 401),
        (format!("Host: localhost\r\n{}", protocol(SECRET)), 101),
        (format!("Host: 192.168.0.7\r\n{}", protocol(SECRET)), 101),
        (format!("Host: evil.example\r\n{}", protocol(SECRET)), 403),
    ] {
        assert_eq!(status(address, &lines), wanted, "{lines}");
    }
    // A page is public, and explains the missing token.
    assert_eq!(status_of(address, "/", "Host: 192.168.0.7"), 200);
    let bearer = format!("Host: localhost\r\nAuthorization: Bearer {SECRET}");
    assert_eq!(status_of(address, "/access", &bearer), 204);
    assert!((served.height() - start).abs() < 1e-3 && !served.robot.state().motion_running());
}

/// The client writes the header, so it is not evidence of the client's location.
#[test]
fn a_peer_elsewhere_that_says_localhost_needs_a_token() {
    let far = |peer: &str, options: Options| {
        let peer: SocketAddr = peer.parse().expect("an address");
        let served = Served::seen_from(peer, options);
        status(served.address, "Host: localhost")
    };
    let (here, elsewhere) = ("127.0.0.1:40000", "192.0.2.7:40000");
    let options = || Options::default().allow_motion();
    assert_eq!(far(here, options()), 101);
    assert_eq!(far(elsewhere, options()), 403);
    assert_eq!(far(elsewhere, options().token(token())), 401);
}

#[tokio::test]
async fn without_a_token_only_this_computer_is_served() {
    let everywhere = "0.0.0.0:0".parse().expect("an address");
    let refused = franka_dash::bind(everywhere, &Options::default()).await;
    assert!(matches!(refused, Err(BindError::NoToken { .. })));
    let options = Options::default().token(token());
    franka_dash::bind(everywhere, &options)
        .await
        .expect("a port");
}

#[tokio::test]
async fn accepted_socket_has_nodelay_set() {
    let here = "127.0.0.1:0".parse().expect("an address");
    let bound = franka_dash::bind(here, &Options::default()).await;
    let listener = bound.expect("a port");
    let address = listener.local_addr().expect("an address");
    let _client = TcpStream::connect(address).expect("a connection");
    let (accepted, _) = listener.accept().await.expect("a connection");
    assert!(accepted.nodelay().expect("an option"));
}

#[test]
fn page_policy_allows_only_content_of_the_server() {
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
