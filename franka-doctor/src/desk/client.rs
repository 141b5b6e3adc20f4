//! Requests to Desk over HTTPS.

use core::time::Duration;
use std::net::SocketAddr;
use std::sync::Arc;

use ureq::Agent;
use ureq::tls::{TlsConfig, TlsProvider};

use super::{DeskState, Page, read};

/// Returns the state that Desk reports without a login, or the reason why no state could be read.
/// `desk` is usually port 443 of the robot.
///
/// This function sends a few `GET` requests, each with a time limit of 2 s. It changes nothing and
/// sends no password. Desk signs its own certificate, so this function does not check the
/// certificate. Therefore an attacker on the network path could answer instead. If the other end
/// does not support TLS, the function tries plain HTTP, with port 80 instead of 443.
pub fn ask_desk(desk: SocketAddr) -> Result<DeskState, String> {
    let agent = agent();
    ask(&agent, "https", desk).or_else(|why| {
        let mut plain = desk;
        if plain.port() == 443 {
            plain.set_port(80);
        }
        // The first error is returned, because HTTPS is the usual way to reach Desk.
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

/// Returns an agent that connects directly to the robot, without a proxy and without redirects.
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
