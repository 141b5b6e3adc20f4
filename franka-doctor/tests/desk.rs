//! Desk as a server on this computer, over HTTPS with a self-signed certificate, and over plain
//! HTTP.

use std::io::{BufRead as _, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread;

use franka_doctor::{Purpose, Verdict, ask_desk, web};
use rustls::pki_types::PrivatePkcs8KeyDer;
use rustls::{ServerConfig, ServerConnection, StreamOwned};

/// Returns the answer for a path: status and JSON.
type Pages = fn(&str) -> (u16, &'static str);

/// The newest generation: brakes closed, FCI not active.
fn cold(path: &str) -> (u16, &'static str) {
    match path {
        "/api/system" => (
            200,
            r#"{"status": "Started", "operatingMode": {"status": "Execution"}, "controlSerialNumber": "123456-7654321"}"#,
        ),
        "/api/arm/joints" => (
            200,
            r#"[{"brakeStatus": "Locked"}, {"brakeStatus": "Locked"}, {"brakeStatus": "Locked"},
                {"brakeStatus": "Locked"}, {"brakeStatus": "Locked"}, {"brakeStatus": "Locked"},
                {"brakeStatus": "Locked"}]"#,
        ),
        "/api/fci" => (200, r#"{"status": "Inactive"}"#),
        "/api/safety/self-tests" => (401, r#"{"code": "Unauthorized"}"#),
        _ => (404, "{}"),
    }
}

/// Answers the requests of one connection until it ends.
fn answer(stream: impl Read + Write, pages: Pages) {
    let mut stream = BufReader::new(stream);
    loop {
        let mut path = None;
        loop {
            let mut line = String::new();
            match stream.read_line(&mut line) {
                Ok(1..) if line == "\r\n" => break,
                Ok(1..) => {}
                // The client has gone.
                _ => return,
            }
            if let Some(rest) = line.strip_prefix("GET ") {
                path = rest.split(' ').next().map(str::to_owned);
            }
            let header = line.to_lowercase();
            assert!(!header.starts_with("authorization"), "no login: {line}");
        }
        let (status, json) = pages(&path.expect("only GET"));
        let head = format!("HTTP/1.1 {status} X\r\nContent-Type: application/json\r\n");
        let length = json.len();
        let text = format!("{head}Content-Length: {length}\r\n\r\n{json}");
        let sent = stream.get_mut().write_all(text.as_bytes());
        if sent.and_then(|()| stream.get_mut().flush()).is_err() {
            return;
        }
    }
}

fn listener() -> (TcpListener, SocketAddr) {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let address = listener.local_addr().expect("bound");
    (listener, address)
}

/// Starts a server that runs until the process ends. Returns its address.
fn serve(pages: Pages, tls: Option<Arc<ServerConfig>>) -> SocketAddr {
    let (listener, address) = listener();
    thread::spawn(move || {
        for stream in listener.incoming() {
            let stream = stream.expect("a client");
            match &tls {
                Some(tls) => {
                    let tls = ServerConnection::new(tls.clone()).expect("a session");
                    answer(StreamOwned::new(tls, stream), pages);
                }
                None => answer(stream, pages),
            }
        }
    });
    address
}

/// Returns a configuration with a self-signed certificate. The name in it differs from the server's
/// address.
fn self_signed() -> Arc<ServerConfig> {
    let made = rcgen::generate_simple_self_signed(["robot.franka.de".to_owned()]);
    let made = made.expect("a certificate");
    let key = PrivatePkcs8KeyDer::from(made.signing_key.serialize_der());
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .expect("versions")
        .with_no_client_auth()
        .with_single_cert(vec![made.cert.into()], key.into());
    Arc::new(config.expect("a certificate with its key"))
}

#[test]
fn self_signed_desk_says_why_a_connection_is_refused() {
    let address = serve(cold, Some(self_signed()));
    let state = ask_desk(address);
    let finding = web(&state, Purpose::Move);
    assert_eq!(finding.verdict, Verdict::Failure, "{finding:?}");
    let expected =
        "the brakes are closed: open them in Desk; FCI is not active: activate it in Desk";
    assert_eq!(finding.read, expected);
    let state = state.expect("a state");
    assert_eq!(
        (state.system.as_deref(), state.self_test),
        (Some("Started"), None)
    );
    assert!(
        !format!("{state:?}").contains("123456"),
        "no serial number: {state:?}"
    );
}

#[test]
fn a_desk_without_tls_is_asked_plainly() {
    let address = serve(cold, None);
    let state = ask_desk(address).expect("a state");
    assert_eq!(state.fci, Some(false));
}

#[test]
fn web_finding_is_unknown_without_a_desk() {
    let (free, address) = listener();
    drop(free);
    let refused = web(&ask_desk(address), Purpose::Move);
    assert_eq!(refused.verdict, Verdict::Unknown, "{refused:?}");
    assert!(
        refused
            .read
            .contains(&format!("cannot reach Desk at {address}")),
        "{refused:?}"
    );
    let elsewhere = |_: &str| (302, "{}");
    let address = serve(elsewhere, Some(self_signed()));
    let other = web(&ask_desk(address), Purpose::Move);
    assert_eq!(other.verdict, Verdict::Unknown, "{other:?}");
    assert!(
        other.read.contains("not from a known version of Desk"),
        "{other:?}"
    );
}
