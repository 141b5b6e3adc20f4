//! Requests to Desk, over HTTPS.

use core::time::Duration;
use std::net::SocketAddr;
use std::sync::Arc;

use ureq::Agent;
use ureq::tls::{TlsConfig, TlsProvider};

use super::{DeskState, Page, read};

/// Returns the state that Desk at this address (usually port 443 of the robot) provides without a
/// login; otherwise the reason for the failure.
///
/// This sends a few `GET` requests, of at most 2 s each. It changes nothing and sends no password.
/// Desk signs its own certificate, so the certificate is not checked: an attacker on the network
/// path could answer instead. If the other end has no TLS, this tries plain HTTP, at port 80
/// instead of 443.
pub fn ask_desk(desk: SocketAddr) -> Result<DeskState, String> {
    let agent = agent();
    ask(&agent, "https", desk).or_else(|why| {
        let mut plain = desk;
        if plain.port() == 443 {
            plain.set_port(80);
        }
        // Reports the first error, because HTTPS is the usual way to reach Desk.
        ask(&agent, "http", plain).map_err(|_| why)
    })
}

fn ask(agent: &Agent, scheme: &str, address: SocketAddr) -> Result<DeskState, String> {
    read(&mut |path| {
        let answer = agent.get(format!("{scheme}://{address}{path}")).call();
        let mut answer =
            answer.map_err(|error| format!("cannot reach Desk at {address}: {error}"))?;
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

/// Returns an agent that connects directly to the robot, without proxy and without redirects.
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

/// Time limit of each request.
const PATIENCE: Duration = Duration::from_secs(2);

/// Largest number of bytes of a page that are read.
const BODY_MAX: u64 = 1 << 20;
