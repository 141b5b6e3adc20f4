//! Admission of HTTP requests, with one check for the files of a page and one check for all other
//! requests.

use std::net::SocketAddr;
use std::sync::Arc;

use axum::extract::{ConnectInfo, Request, State};
use axum::http::{HeaderValue, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use franka_async::connection::admission::{Admission, Refused};

/// Checks a request for a file of the page.
pub(crate) async fn files(
    State(admissions): State<Arc<[Admission]>>,
    request: Request,
    next: Next,
) -> Response {
    let peer = peer(&request);
    let checks = admissions.iter().map(|it| it.check_file(&request, peer));
    answer(any(checks), request, next).await
}

/// Checks any other request.
pub(crate) async fn rest(
    State(admissions): State<Arc<[Admission]>>,
    request: Request,
    next: Next,
) -> Response {
    let peer = peer(&request);
    let checks = admissions.iter().map(|it| it.check(&request, peer));
    answer(any(checks), request, next).await
}

/// Accepts a request if any robot accepts it. Otherwise returns the refusal of the last robot.
fn any(mut checks: impl Iterator<Item = Result<(), Refused>>) -> Result<(), Refused> {
    let first = checks.next().expect("a page has a robot");
    checks.fold(first, Result::or)
}

async fn answer(checked: Result<(), Refused>, request: Request, next: Next) -> Response {
    secured(match checked {
        Ok(()) => next.run(request).await,
        Err(refused) => (refused.status(), refused.to_string()).into_response(),
    })
}

fn peer(request: &Request) -> Option<SocketAddr> {
    let peer = request.extensions().get::<ConnectInfo<SocketAddr>>();
    peer.map(|peer| peer.0)
}

/// Adds headers that forbid content from other origins.
fn secured(mut response: Response) -> Response {
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
    ] {
        let headers = response.headers_mut();
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

const POLICY: &str = "default-src 'self'; frame-ancestors 'none'; base-uri 'none'";
