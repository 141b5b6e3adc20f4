//! A tower layer that checks requests.

use std::future::{Ready, ready};
use std::net::SocketAddr;
use std::task::{Context, Poll};

use futures::future::Either;
use http::{Extensions, Request, Response};
use tower_layer::Layer;
use tower_service::Service;

use super::{Admission, Refused};

/// A tower layer that passes on only the requests that an [`Admission`] admits: see
/// [`Admission::layer`].
#[derive(Clone, Debug)]
pub struct AdmissionLayer<P, A> {
    admission: Admission,
    peer: P,
    refuse: A,
}

/// The service inside an [`AdmissionLayer`].
#[derive(Clone, Debug)]
pub struct Admitted<S, P, A> {
    inner: S,
    layer: AdmissionLayer<P, A>,
}

impl<P, A> AdmissionLayer<P, A> {
    pub(super) fn new(admission: Admission, peer: P, refuse: A) -> Self {
        Self {
            admission,
            peer,
            refuse,
        }
    }
}

impl<S, P: Clone, A: Clone> Layer<S> for AdmissionLayer<P, A> {
    type Service = Admitted<S, P, A>;

    fn layer(&self, inner: S) -> Self::Service {
        let layer = self.clone();
        Admitted { inner, layer }
    }
}

impl<S, P, A, B, R> Service<Request<B>> for Admitted<S, P, A>
where
    S: Service<Request<B>, Response = Response<R>>,
    P: Fn(&Extensions) -> Option<SocketAddr>,
    A: Fn(Refused) -> Response<R>,
{
    type Response = S::Response;
    type Error = S::Error;
    type Future = Either<S::Future, Ready<Result<S::Response, S::Error>>>;

    fn poll_ready(&mut self, cx: &mut Context<'_>) -> Poll<Result<(), Self::Error>> {
        self.inner.poll_ready(cx)
    }

    fn call(&mut self, request: Request<B>) -> Self::Future {
        let AdmissionLayer {
            admission,
            peer,
            refuse,
        } = &self.layer;
        match admission.check(&request, peer(request.extensions())) {
            Ok(()) => Either::Left(self.inner.call(request)),
            Err(refused) => Either::Right(ready(Ok(refuse(refused)))),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::task::Waker;

    use futures::FutureExt as _;
    use http::StatusCode;

    use super::*;

    /// Counts the requests that reach the service.
    #[derive(Clone, Default)]
    struct Counter(Arc<AtomicUsize>);

    impl Service<Request<()>> for Counter {
        type Response = Response<String>;
        type Error = Infallible;
        type Future = Ready<Result<Response<String>, Infallible>>;

        fn poll_ready(&mut self, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
            Poll::Ready(Ok(()))
        }

        fn call(&mut self, _: Request<()>) -> Self::Future {
            self.0.fetch_add(1, Ordering::Relaxed);
            ready(Ok(Response::default()))
        }
    }

    /// Is never ready for a request.
    struct Busy;

    impl Service<Request<()>> for Busy {
        type Response = Response<String>;
        type Error = Infallible;
        type Future = Ready<Result<Response<String>, Infallible>>;

        fn poll_ready(&mut self, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
            Poll::Pending
        }

        fn call(&mut self, _: Request<()>) -> Self::Future {
            unreachable!("it is not ready")
        }
    }

    #[test]
    fn service_is_ready_only_if_the_inner_one_is() {
        let refuse = |_: Refused| Response::default();
        let layer = Admission::default().layer(|_: &Extensions| None, refuse);
        let mut context = Context::from_waker(Waker::noop());
        let mut idle = layer.layer(Counter::default());
        assert!(idle.poll_ready(&mut context).is_ready());
        assert!(layer.layer(Busy).poll_ready(&mut context).is_pending());
    }

    #[test]
    fn refused_requests_do_not_reach_the_service() {
        let peer = |of: &Extensions| of.get::<SocketAddr>().copied();
        let refuse = |refused: Refused| {
            let mut answer = Response::new(refused.to_string());
            *answer.status_mut() = refused.status();
            answer
        };
        let reached = Counter::default();
        let mut service = Admission::default()
            .layer(peer, refuse)
            .layer(reached.clone());
        let mut ask = |peer: Option<&str>, origin: &str| {
            let mut request = Request::builder()
                .header("host", "localhost")
                .header("origin", origin)
                .body(())
                .expect("a request");
            if let Some(peer) = peer {
                let peer: SocketAddr = peer.parse().expect("an address");
                request.extensions_mut().insert(peer);
            }
            let answer = service.call(request).now_or_never().expect("it is ready");
            let Ok(answer) = answer;
            answer.status()
        };
        let (own, foreign) = ("http://localhost", "http://evil.example");
        let here = Some("127.0.0.1:40000");
        assert_eq!(ask(here, foreign), StatusCode::FORBIDDEN);
        assert_eq!(ask(None, own), StatusCode::FORBIDDEN);
        assert_eq!(ask(Some("192.0.2.7:40000"), own), StatusCode::FORBIDDEN);
        assert_eq!(reached.0.load(Ordering::Relaxed), 0);
        assert_eq!(ask(here, own), StatusCode::OK);
        assert_eq!(reached.0.load(Ordering::Relaxed), 1);
    }
}
