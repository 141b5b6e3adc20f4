//! Asks Desk, over HTTPS.

use core::time::Duration;
use std::net::SocketAddr;
use std::sync::Arc;

use ureq::Agent;
use ureq::tls::{TlsConfig, TlsProvider};

use super::{DeskState, Page, read};

/// What Desk at this address, as a rule port 443 of the robot, says without a login; otherwise why
/// there is none.
///
/// Some `GET` requests, for 2 s each at most; nothing is changed, and no password is sent. Desk
/// signs its certificate itself, so the certificate is not checked: whoever sits on the way could
/// answer instead. Without TLS at the other end, plain HTTP is tried, at port 80 instead of 443.
pub fn ask_desk(desk: SocketAddr) -> Result<DeskState, String> {
    let agent = agent();
    ask(&agent, "https", desk).or_else(|why| {
        let mut plain = desk;
        if plain.port() == 443 {
            plain.set_port(80);
        }
        // The reason that counts is that of the way Desk is reached as a rule.
        ask(&agent, "http", plain).map_err(|_| why)
    })
}

fn ask(agent: &Agent, scheme: &str, address: SocketAddr) -> Result<DeskState, String> {
    read(&mut |path| {
        let answer = agent.get(format!("{scheme}://{address}{path}")).call();
        let mut answer = answer.map_err(|error| format!("no Desk at {address}: {error}"))?;
        let body = answer
            .body_mut()
            .with_config()
            .limit(BODY_MAX)
            .read_to_string();
        Ok(Page {
            status: answer.status().as_u16(),
            json: body.ok().and_then(|body| serde_json::from_str(&body).ok()),
        })
    })
}

/// Goes straight to the robot: by no proxy, and nowhere else than it is told.
fn agent() -> Agent {
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let tls = TlsConfig::builder()
        .provider(TlsProvider::Rustls)
        .unversioned_rustls_crypto_provider(provider)
        .disable_verification(true)
        .build();
    let config = Agent::config_builder()
        .tls_config(tls)
        .proxy(None)
        .max_redirects(0)
        .max_redirects_will_error(false)
        .http_status_as_error(false)
        .timeout_connect(Some(CONNECT))
        .timeout_global(Some(PATIENCE))
        .build();
    config.into()
}

const CONNECT: Duration = Duration::from_secs(1);

/// For each request.
const PATIENCE: Duration = Duration::from_secs(2);

/// The longest page that is read, in bytes.
const BODY_MAX: u64 = 1 << 20;
