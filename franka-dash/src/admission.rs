//! Who gets in: the checks in front of the files of a page, and of everything else.

use std::net::SocketAddr;
use std::sync::Arc;

use axum::extract::{ConnectInfo, Request, State};
use axum::http::{HeaderValue, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use franka_async::connection::admission::{Admission, Refused};

/// Lets requests for files through.
pub(crate) async fn files(
    State(admissions): State<Arc<[Admission]>>,
    request: Request,
    next: Next,
) -> Response {
    let peer = peer(&request);
    let checks = admissions.iter().map(|it| it.check_file(&request, peer));
    answer(any(checks), request, next).await
}

/// Lets requests for everything else through.
pub(crate) async fn rest(
    State(admissions): State<Arc<[Admission]>>,
    request: Request,
    next: Next,
) -> Response {
    let peer = peer(&request);
    let checks = admissions.iter().map(|it| it.check(&request, peer));
    answer(any(checks), request, next).await
}

/// What is fine for one of several robots is; else the reason of the last.
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

/// A response that says that nothing comes from elsewhere.
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
