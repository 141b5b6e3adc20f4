//! Checks of requests, for services over HTTP, WebSockets and gRPC through which clients can move
//! or recover an arm.
//!
//! A listener on a loopback address does not keep web pages out. A page of any site, open in a
//! browser on this computer, can send requests there, and can open WebSockets. The site can also
//! rebind its own name to `127.0.0.1`; its page then has the same origin as the service. A proxy on
//! this computer makes requests of other computers look local. [`Admission`] refuses all such
//! requests:
//!
//! | request | without a token set | with a token set |
//! |---|---|---|
//! | peer, `Host` or `:authority`, and `Origin` are loopback; no header of a proxy | answered | needs the token |
//! | one of them is another address, or a name given to [`Admission::host`] | refused | needs the token |
//! | a header of a proxy, such as `Forwarded` or `X-Forwarded-For` | refused | needs the token |
//! | any other name in `Host` or `:authority` | refused | refused |
//! | a page of another origin, according to `Origin` or `Sec-Fetch-Site` | refused | refused |
//!
//! Programs send the token as `Authorization: Bearer TOKEN`. A page in a browser cannot set headers
//! of a WebSocket, so it sends the token as the subprotocol `token.TOKEN`.
//!
//! # Example
//!
//! The layer encloses all routes of an axum service, and sees each request first:
//!
//! ```text
//! let admission = Admission::default(); // this computer only
//! let peer = |of: &Extensions| of.get::<ConnectInfo<SocketAddr>>().map(|peer| peer.0);
//! let refuse = |refused: Refused| (refused.status(), refused.to_string()).into_response();
//! let app = router.layer(admission.layer(peer, refuse));
//! let app = app.into_make_service_with_connect_info::<SocketAddr>();
//! axum::serve(listener, app).await?;
//! ```
//!
//! # Limits
//!
//! Nothing is encrypted, so a token can be read on a network that is not trusted. Use a proxy with
//! TLS there. A proxy that adds no header and replaces `Host` cannot be recognised. Therefore a
//! service behind a proxy needs a token.

mod layer;
mod token;

use std::net::{IpAddr, SocketAddr};

use http::uri::Authority;
use http::{HeaderMap, Request, StatusCode, header};

pub use layer::{AdmissionLayer, Admitted};
pub use token::{TOKEN_VARIABLE, Token, TokenError};

/// Rules for the requests that a service answers. By default, only requests from this computer are
/// answered.
#[derive(Clone, Debug, Default)]
#[must_use = "rules do nothing until requests are checked by them"]
pub struct Admission {
    token: Option<Token>,
    hosts: Vec<String>,
}

/// Reason why a request is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refused {
    /// The request names no host or several hosts, or its host name is invalid.
    #[error("the Host header is missing, repeated or invalid, expected exactly one")]
    NoHost,
    /// The host name is not a name of the service. A page of a different site may have rebound its
    /// name to this address.
    #[error(
        "the Host header is {got:?}, expected localhost, an IP address or a name of the service"
    )]
    Host {
        /// The host name in the request.
        got: String,
    },
    /// The request comes from a page of a different origin.
    #[error("the request comes from a web page of another origin, expected a page of this service")]
    Origin,
    /// Without a token, only requests from this computer are answered.
    #[error(
        "got a request from another computer ({why}), expected one from this computer: start the \
         service with a token to admit other computers"
    )]
    NeedsToken {
        /// Sign that the request comes from another computer.
        why: Elsewhere,
    },
    /// The token is missing or wrong.
    #[error("the token is missing or wrong: send `Authorization: Bearer TOKEN`")]
    Token,
}

/// Sign that a request may come from another computer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Elsewhere {
    /// The address of the peer is not a loopback address.
    #[error("the peer is another computer")]
    Peer,
    /// The address of the peer is not known.
    #[error(
        "the address of the peer is unknown: serve with axum's \
         into_make_service_with_connect_info::<SocketAddr>()"
    )]
    UnknownPeer,
    /// `Host`, `:authority` or `Origin` names something other than this computer.
    #[error("the Host header is not a loopback address")]
    Host,
    /// A proxy has forwarded the request.
    #[error("a proxy forwarded the request")]
    Forwarded,
}

/// Error: other computers can reach a listener that requires no token.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{address} can be reached from other computers: set a token, or use a loopback address")]
pub struct NoToken {
    /// Address of the listener.
    pub address: SocketAddr,
}

impl Refused {
    /// Returns the HTTP status of the answer: bad request, unauthorized or forbidden.
    pub fn status(&self) -> StatusCode {
        match self {
            Self::NoHost => StatusCode::BAD_REQUEST,
            Self::Token => StatusCode::UNAUTHORIZED,
            _ => StatusCode::FORBIDDEN,
        }
    }
}

impl Admission {
    /// Requires this token in every request. Requests from other computers are then answered, too.
    pub fn token(mut self, token: Token) -> Self {
        self.token = Some(token);
        self
    }

    /// Allows this name as a `Host`, in addition to `localhost` and IP addresses. Requests with
    /// this name need the token.
    pub fn host(mut self, name: impl Into<String>) -> Self {
        self.hosts.push(name.into());
        self
    }

    /// True if a token is set.
    pub fn has_token(&self) -> bool {
        self.token.is_some()
    }

    /// Checks the address on which a service is about to listen.
    ///
    /// # Errors
    /// Returns [`NoToken`] if the address is not a loopback address and no token is set.
    pub fn check_listener(&self, address: SocketAddr) -> Result<(), NoToken> {
        match is_loopback(address.ip()) || self.token.is_some() {
            true => Ok(()),
            false => Err(NoToken { address }),
        }
    }

    /// Checks a request that changes nothing and whose answer is not secret, such as a request for
    /// a file of a web page. `Origin` and the token are not checked, because other sites may link
    /// to the page, and the page may then ask for the token.
    ///
    /// # Errors
    /// Returns [`Refused`], but never [`Refused::Origin`] or [`Refused::Token`].
    pub fn check_file<B>(
        &self,
        request: &Request<B>,
        peer: Option<SocketAddr>,
    ) -> Result<(), Refused> {
        let hosts = hosts(request).ok_or(Refused::NoHost)?;
        for host in &hosts {
            self.check_host(host.host())?;
        }
        let elsewhere = elsewhere(request.headers(), &hosts, peer);
        match (elsewhere, &self.token) {
            (Some(why), None) => Err(Refused::NeedsToken { why }),
            _ => Ok(()),
        }
    }

    /// Checks a request of any other kind. `peer` is the address of the client; `None` if it is
    /// unknown.
    ///
    /// # Errors
    /// Returns [`Refused`] with the reason.
    pub fn check<B>(&self, request: &Request<B>, peer: Option<SocketAddr>) -> Result<(), Refused> {
        let (headers, hosts) = (request.headers(), hosts(request).ok_or(Refused::NoHost)?);
        check_origin(headers, &hosts)?;
        self.check_file(request, peer)?;
        match &self.token {
            Some(token) if !offered(headers).any(|it| token.is(it)) => Err(Refused::Token),
            _ => Ok(()),
        }
    }

    /// Returns a tower layer that checks every request, for example for axum and tonic. `peer`
    /// reads the client's address from the extensions of a request; if it returns `None`, the token
    /// is needed. `refuse` makes the answer to a refused request.
    pub fn layer<P, A>(&self, peer: P, refuse: A) -> AdmissionLayer<P, A> {
        AdmissionLayer::new(self.clone(), peer, refuse)
    }

    fn check_host(&self, name: &str) -> Result<(), Refused> {
        let is_known = self.hosts.iter().any(|own| name.eq_ignore_ascii_case(own));
        match is_this_computer(name) || address(name).is_some() || is_known {
            true => Ok(()),
            false => Err(Refused::Host {
                got: name.to_owned(),
            }),
        }
    }
}

/// Returns the hosts in `:authority` and `Host`; `None` if both are missing, or if they differ.
fn hosts<B>(request: &Request<B>) -> Option<Vec<Authority>> {
    let headers = request.headers().get_all(header::HOST).iter();
    let said = headers.map(|host| Authority::try_from(host.as_bytes()).ok());
    let asked = request.uri().authority().cloned().map(Some);
    let hosts: Vec<_> = asked.into_iter().chain(said).collect::<Option<_>>()?;
    let first = hosts.first()?;
    let is_plain = |host: &Authority| !host.as_str().contains('@');
    (hosts.len() <= 2 && hosts.iter().all(|host| host == first && is_plain(host))).then_some(hosts)
}

/// Checks the origin of a request. Browsers send it with every request that changes something, and
/// with every WebSocket. Other programs send no origin.
fn check_origin(headers: &HeaderMap, hosts: &[Authority]) -> Result<(), Refused> {
    let is_own = |origin: &[u8]| {
        let origin = std::str::from_utf8(origin).unwrap_or_default();
        let scheme = origin.strip_prefix("http://");
        let origin = scheme.or_else(|| origin.strip_prefix("https://"));
        origin.is_some_and(|origin| hosts.iter().all(|host| host == origin))
    };
    let origins = headers.get_all(header::ORIGIN).iter();
    let sites = headers.get_all("sec-fetch-site").iter();
    let is_fine = origins.map(|it| it.as_bytes()).all(is_own)
        && sites.map(|it| it.as_bytes()).all(|site| {
            // The value is `none` if a person has typed the address.
            [&b"same-origin"[..], b"none"].contains(&site)
        });
    is_fine.then_some(()).ok_or(Refused::Origin)
}

/// Returns the first sign that a request comes from another computer. Ignores the origin, which
/// [`check_origin`] has found to equal the host.
fn elsewhere(
    headers: &HeaderMap,
    hosts: &[Authority],
    peer: Option<SocketAddr>,
) -> Option<Elsewhere> {
    let forwarded = |name: &header::HeaderName| {
        let name = name.as_str();
        name.starts_with("x-forwarded") || FORWARDED.contains(&name)
    };
    match peer {
        None => Some(Elsewhere::UnknownPeer),
        Some(peer) if !is_loopback(peer.ip()) => Some(Elsewhere::Peer),
        Some(_) if !hosts.iter().all(|host| is_this_computer(host.host())) => Some(Elsewhere::Host),
        Some(_) if headers.keys().any(forwarded) => Some(Elsewhere::Forwarded),
        Some(_) => None,
    }
}

/// Returns the tokens in a request.
fn offered(headers: &HeaderMap) -> impl Iterator<Item = &str> {
    let texts = |name| {
        let values = headers.get_all(name).iter();
        values.filter_map(|value| value.to_str().ok())
    };
    let bearer = texts(header::AUTHORIZATION).filter_map(|value| {
        let (scheme, token) = value.split_once(' ')?;
        scheme.eq_ignore_ascii_case("bearer").then(|| token.trim())
    });
    let protocols = texts(header::SEC_WEBSOCKET_PROTOCOL).flat_map(|value| value.split(','));
    bearer.chain(protocols.filter_map(|protocol| protocol.trim().strip_prefix(TOKEN_PREFIX)))
}

fn is_this_computer(host: &str) -> bool {
    host.eq_ignore_ascii_case("localhost") || address(host).is_some_and(is_loopback)
}

fn address(host: &str) -> Option<IpAddr> {
    host.trim_matches(['[', ']']).parse().ok()
}

fn is_loopback(address: IpAddr) -> bool {
    address.to_canonical().is_loopback()
}

/// Prefix of the token among the subprotocols of a WebSocket.
const TOKEN_PREFIX: &str = "token.";

/// Headers that proxies add, in addition to those that begin with `x-forwarded`.
const FORWARDED: [&str; 6] = [
    "forwarded",
    "via",
    "x-real-ip",
    "x-client-ip",
    "cf-connecting-ip",
    "true-client-ip",
];

#[cfg(test)]
mod tests {
    use super::*;

    const SECRET: &str = "correct-horse-battery";
    const HERE: &str = "127.0.0.1:40000";

    fn admission(token: bool) -> Admission {
        let admission = Admission::default().host("lab.example");
        match token {
            true => admission.token(Token::new(SECRET).expect("a token")),
            false => admission,
        }
    }

    fn request(lines: &[(&str, &str)]) -> Request<()> {
        let mut request = Request::builder();
        for (name, value) in lines {
            request = match *name {
                ":authority" => request.uri(format!("http://{value}/")),
                name => request.header(name, *value),
            };
        }
        request.body(()).expect("a request")
    }

    fn check(token: bool, peer: &str, lines: &[(&str, &str)]) -> Result<(), Refused> {
        let peer = peer.parse().ok();
        admission(token).check(&request(lines), peer)
    }

    #[test]
    fn only_this_computer_is_served_without_a_token() {
        let needs = |why| Err(Refused::NeedsToken { why });
        for (peer, host, wanted) in [
            (HERE, "localhost:8080", Ok(())),
            (HERE, "LocalHost", Ok(())),
            (HERE, "127.0.0.1", Ok(())),
            (HERE, "[::1]:80", Ok(())),
            ("[::1]:40000", "[::1]:80", Ok(())),
            ("[::ffff:127.0.0.1]:40000", "localhost", Ok(())),
            (HERE, "192.168.0.7:80", needs(Elsewhere::Host)),
            (HERE, "lab.example:80", needs(Elsewhere::Host)),
            ("192.168.0.9:40000", "localhost", needs(Elsewhere::Peer)),
            ("unknown", "localhost", needs(Elsewhere::UnknownPeer)),
        ] {
            for name in ["host", ":authority"] {
                let got = check(false, peer, &[(name, host)]);
                assert_eq!(got, wanted, "{peer} {name} {host}");
            }
            // With the token, each of these requests is answered; without it, none is.
            let bearer = ("authorization", &*format!("Bearer {SECRET}"));
            assert_eq!(check(true, peer, &[("host", host), bearer]), Ok(()));
            assert_eq!(check(true, peer, &[("host", host)]), Err(Refused::Token));
        }
    }

    #[test]
    fn a_name_that_was_not_allowed_is_refused_with_any_token() {
        let bearer = ("authorization", &*format!("Bearer {SECRET}"));
        for host in [
            "evil.example",
            "localhost.evil.example",
            "localhost.",
            "127.1",
        ] {
            for name in ["host", ":authority"] {
                let got = check(true, HERE, &[(name, host), bearer]);
                assert!(matches!(got, Err(Refused::Host { .. })), "{host}: {got:?}");
            }
        }
    }

    #[test]
    fn a_request_says_once_for_whom_it_is() {
        for lines in [
            &[][..],
            &[("host", "")],
            &[("host", "localhost"), ("host", "evil.example")],
            &[("host", "localhost"), (":authority", "evil.example")],
            &[("host", "evil@localhost")],
            &[("host", "local host")],
        ] {
            assert_eq!(check(false, HERE, lines), Err(Refused::NoHost), "{lines:?}");
        }
        let both = [("host", "localhost:80"), (":authority", "localhost:80")];
        assert_eq!(check(false, HERE, &both), Ok(()));
    }

    #[test]
    fn a_request_is_for_pages_of_this_server() {
        let bearer = ("authorization", &*format!("Bearer {SECRET}"));
        for (line, fine) in [
            (("origin", "http://localhost:8080"), true),
            (("origin", "https://localhost:8080"), true),
            (("origin", "http://localhost:8081"), false),
            (("origin", "http://localhost"), false),
            (("origin", "http://evil.example"), false),
            (("origin", "localhost:8080"), false),
            (("origin", "null"), false),
            (("origin", ""), false),
            (("sec-fetch-site", "same-origin"), true),
            (("sec-fetch-site", "none"), true),
            (("sec-fetch-site", "same-site"), false),
            (("sec-fetch-site", "cross-site"), false),
        ] {
            let lines = [("host", "localhost:8080"), line, bearer];
            assert_eq!(check(true, HERE, &lines).is_ok(), fine, "{line:?}");
        }
        let two = [
            ("host", "localhost"),
            ("origin", "http://localhost"),
            ("origin", "http://evil.example"),
        ];
        assert_eq!(check(false, HERE, &two), Err(Refused::Origin));
    }

    #[test]
    fn forwarded_request_needs_a_token() {
        let bearer = ("authorization", &*format!("Bearer {SECRET}"));
        for name in [
            "Forwarded",
            "X-Forwarded-For",
            "x-forwarded-host",
            "X-Real-IP",
            "Via",
        ] {
            let lines = [("host", "localhost"), (name, "for=192.168.0.9")];
            let why = Elsewhere::Forwarded;
            let got = check(false, HERE, &lines);
            assert_eq!(got, Err(Refused::NeedsToken { why }), "{name}");
            assert_eq!(check(true, HERE, &lines), Err(Refused::Token), "{name}");
            let [host, proxy] = lines;
            assert_eq!(check(true, HERE, &[host, proxy, bearer]), Ok(()), "{name}");
        }
    }

    #[test]
    fn a_token_has_to_be_offered_exactly() {
        let (protocol, bearer) = ("sec-websocket-protocol", "authorization");
        for (name, offered, fine) in [
            (protocol, format!("franka-dash, token.{SECRET}"), true),
            (protocol, format!("token.{SECRET}"), true),
            (protocol, SECRET.to_owned(), false),
            (protocol, format!("token.{SECRET}2"), false),
            (protocol, format!("token.{}", &SECRET[1..]), false),
            (protocol, format!("token.{}", SECRET.to_uppercase()), false),
            (protocol, "token.".to_owned(), false),
            (protocol, "franka-dash".to_owned(), false),
            (bearer, format!("Bearer {SECRET}"), true),
            (bearer, format!("bearer {SECRET}"), true),
            (bearer, format!("Basic {SECRET}"), false),
            (bearer, "Bearer ".to_owned(), false),
            (bearer, SECRET.to_owned(), false),
        ] {
            let got = check(true, HERE, &[("host", "localhost"), (name, &offered)]);
            let wanted = if fine { Ok(()) } else { Err(Refused::Token) };
            assert_eq!(got, wanted, "{offered}");
        }
    }

    #[test]
    fn files_are_for_whoever_may_have_a_token() {
        let file = |token, peer: &str, lines: &[_]| {
            admission(token).check_file(&request(lines), peer.parse().ok())
        };
        // A link of another site leads here.
        let link = [("host", "localhost"), ("sec-fetch-site", "cross-site")];
        assert_eq!(file(false, HERE, &link), Ok(()));
        let far = [("host", "192.168.0.7")];
        assert_eq!(file(true, "192.168.0.9:40000", &far), Ok(()));
        assert!(file(false, "192.168.0.9:40000", &far).is_err());
        assert!(file(true, HERE, &[("host", "evil.example")]).is_err());
    }

    #[test]
    fn other_computers_reach_no_listener_without_a_token() {
        for (address, here) in [
            ("127.0.0.1:80", true),
            ("[::1]:80", true),
            ("0.0.0.0:80", false),
            ("[::]:80", false),
            ("192.168.0.7:80", false),
        ] {
            let address = address.parse().expect("an address");
            assert_eq!(admission(false).check_listener(address).is_ok(), here);
            assert!(admission(true).check_listener(address).is_ok());
        }
    }
}
