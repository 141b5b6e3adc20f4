//! Who gets in: `Host`, `Origin` and the token of a request.

use std::net::IpAddr;

use axum::http::{HeaderMap, StatusCode, header};

/// Which requests are answered.
#[derive(Clone, Debug, Default)]
pub(crate) struct Admission {
    pub(crate) token: Option<String>,
    /// Names under which the server may be reached, besides addresses and `localhost`.
    pub(crate) hosts: Vec<String>,
}

/// Status and text of a refusal.
pub(crate) type Refused = (StatusCode, &'static str);

impl Admission {
    /// Checks the `Host` of any request. A name that is not known may be one that a foreign page
    /// has rebound to this address. Without a token only this computer is served.
    pub(crate) fn check_host(&self, headers: &HeaderMap) -> Result<(), Refused> {
        let host = host(headers).ok_or((StatusCode::BAD_REQUEST, "no Host header"))?;
        let name = without_port(host);
        let address = name.trim_matches(['[', ']']).parse::<IpAddr>().ok();
        let is_local = name.eq_ignore_ascii_case("localhost")
            || address.is_some_and(|address| address.is_loopback());
        let is_known = self.hosts.iter().any(|own| name.eq_ignore_ascii_case(own));
        match (is_local, address.is_some() || is_known) {
            (true, _) => Ok(()),
            (false, true) if self.token.is_some() => Ok(()),
            (false, true) => Err((StatusCode::FORBIDDEN, "other computers need a token")),
            (false, false) => Err((
                StatusCode::FORBIDDEN,
                "this Host is not one of the server's",
            )),
        }
    }

    /// Checks `Origin` and token of the request for a socket. Browsers always say the origin;
    /// programs that are no browser say none.
    pub(crate) fn check_socket(&self, headers: &HeaderMap) -> Result<(), Refused> {
        if let Some(origin) = headers.get(header::ORIGIN) {
            let origin = origin.to_str().unwrap_or_default();
            let scheme = origin.strip_prefix("http://");
            let scheme = scheme.or_else(|| origin.strip_prefix("https://"));
            if scheme.is_none() || scheme != host(headers) {
                return Err((StatusCode::FORBIDDEN, "the Origin is another site"));
            }
        }
        let Some(token) = &self.token else {
            return Ok(());
        };
        let protocols = headers.get_all(header::SEC_WEBSOCKET_PROTOCOL).iter();
        let mut offered = protocols
            .filter_map(|value| value.to_str().ok())
            .flat_map(|value| value.split(','))
            .filter_map(|protocol| protocol.trim().strip_prefix(TOKEN_PREFIX));
        match offered.any(|offered| is_same(offered.as_bytes(), token.as_bytes())) {
            true => Ok(()),
            false => Err((StatusCode::UNAUTHORIZED, "the token is missing or wrong")),
        }
    }
}

fn host(headers: &HeaderMap) -> Option<&str> {
    headers.get(header::HOST)?.to_str().ok()
}

fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|digit| digit.is_ascii_digit()) => name,
        _ => host,
    }
}

/// Compares without an early end, which would tell how much of a guess is right.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |all, (a, b)| all | (a ^ b)) == 0
}

/// Precedes the token among the subprotocols: a page can set no other header of a socket.
pub(crate) const TOKEN_PREFIX: &str = "token.";

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(lines: &[(header::HeaderName, &str)]) -> HeaderMap {
        let parsed = |(name, value): &(header::HeaderName, &str)| {
            (name.clone(), value.parse().expect("a header value"))
        };
        lines.iter().map(parsed).collect()
    }

    fn admission(token: Option<&str>) -> Admission {
        Admission {
            token: token.map(str::to_owned),
            hosts: vec!["lab.example".to_owned()],
        }
    }

    #[test]
    fn only_this_computer_is_served_without_a_token() {
        for (host, open, guarded) in [
            ("localhost:8080", true, true),
            ("127.0.0.1", true, true),
            ("[::1]:80", true, true),
            ("192.168.0.7:80", false, true),
            ("lab.example:80", false, true),
            ("evil.example", false, false),
            ("localhost.evil.example", false, false),
            ("", false, false),
        ] {
            let headers = headers(&[(header::HOST, host)]);
            let got = admission(None).check_host(&headers).is_ok();
            assert_eq!(got, open, "{host}");
            let got = admission(Some("secret")).check_host(&headers).is_ok();
            assert_eq!(got, guarded, "{host} with a token");
        }
        assert!(admission(None).check_host(&HeaderMap::new()).is_err());
    }

    #[test]
    fn a_socket_is_for_pages_of_this_server() {
        for (origin, ok) in [
            ("http://localhost:8080", true),
            ("https://localhost:8080", true),
            ("http://localhost:8081", false),
            ("http://evil.example", false),
            ("localhost:8080", false),
            ("null", false),
        ] {
            let of = [(header::HOST, "localhost:8080"), (header::ORIGIN, origin)];
            let got = admission(None).check_socket(&headers(&of));
            assert_eq!(got.is_ok(), ok, "{origin}");
        }
    }

    #[test]
    fn a_token_has_to_be_offered_exactly() {
        for (offered, ok) in [
            ("franka-dash, token.secret", true),
            ("token.secret", true),
            ("franka-dash", false),
            ("token.secre", false),
            ("token.secret2", false),
            ("token.Secret", false),
        ] {
            let of = [
                (header::HOST, "localhost"),
                (header::SEC_WEBSOCKET_PROTOCOL, offered),
            ];
            let got = admission(Some("secret")).check_socket(&headers(&of));
            assert_eq!(got.is_ok(), ok, "{offered}");
        }
    }
}
