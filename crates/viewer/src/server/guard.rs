//! Access to the server.
//!
//! On the loopback interface every program of this machine has access, browsers included, and with them any page that they show.
//! So a request must name this very server in `Host`: a page whose own name was made to point here (DNS rebinding) names
//! another one. What connects must have the same origin as the page: browsers say the origin, and cannot be made to lie.
//! Anywhere else the address has a random token in it, without which there is nothing to see.

use crate::ViewerError;
use crate::secret::secret;
use axum::Router;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn};
use axum::response::IntoResponse;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};

/// Headers of every answer: nothing from elsewhere, nobody's frame, nothing kept, no address given away.
const HEADERS: &[(&str, &str)] = &[
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; \
         frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("x-frame-options", "DENY"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cache-control", "no-store"),
];

/// Address and token that a request has to know.
#[derive(Clone)]
pub(super) struct Guard {
    address: SocketAddr,
    /// In the address of the page; none on the loopback interface.
    token: Option<String>,
}

impl Guard {
    /// The guard of a server that listens on an address.
    ///
    /// # Errors
    /// If a token is needed, and the system has no random numbers.
    pub(super) fn of(address: SocketAddr) -> Result<Guard, ViewerError> {
        let token = if address.ip().is_loopback() { None } else { Some(secret()?) };
        Ok(Guard { address, token })
    }

    /// The address of the page. A server that listens on all addresses says the one by which other machines reach this one.
    pub(super) fn address(&self) -> String {
        let mut shown = self.address;
        if shown.ip().is_unspecified() {
            shown.set_ip(outward(shown.ip()).unwrap_or(Ipv4Addr::LOCALHOST.into()));
        }
        format!("http://{shown}{}/", self.prefix())
    }

    /// Beginning of every path.
    pub(super) fn prefix(&self) -> String {
        self.token.as_ref().map_or_else(String::new, |token| format!("/{token}"))
    }

    /// Lets only those in who may come in.
    pub(super) fn around(self, inner: Router) -> Router {
        inner.layer(from_fn(move |request: Request, next: Next| {
            let guard = self.clone();
            async move {
                let mut response = match guard.refusal(&request) {
                    Some(refusal) => refusal.into_response(),
                    None => next.run(request).await,
                };
                for (name, value) in HEADERS {
                    response.headers_mut().insert(*name, HeaderValue::from_static(value));
                }
                response
            }
        }))
    }

    /// Why a request is refused, if it is.
    fn refusal(&self, request: &Request) -> Option<(StatusCode, &'static str)> {
        let headers = request.headers();
        match &self.token {
            Some(token) => {
                let given = request.uri().path().split('/').nth(1).unwrap_or_default();
                (!is_same(given, token)).then_some((
                    StatusCode::FORBIDDEN,
                    "use the whole address that the viewer has printed, with the token in it\n",
                ))
            }
            None if !self.is_own_host(headers) => Some((
                StatusCode::FORBIDDEN,
                "this name is not that of the viewer: use the address that it has printed\n",
            )),
            None => is_embedded(headers)
                .then_some((StatusCode::FORBIDDEN, "pages of other origins may not use the viewer\n")),
        }
    }

    /// True if `Host` names this server.
    fn is_own_host(&self, headers: &HeaderMap) -> bool {
        let Some(host) = headers.get(header::HOST).and_then(|host| host.to_str().ok()) else { return false };
        let port = self.address.port();
        [self.address.to_string(), format!("localhost:{port}")]
            .iter()
            .any(|own| own.eq_ignore_ascii_case(host))
    }
}

/// True if a page of another origin asks for it, as far as the browser says so.
fn is_embedded(headers: &HeaderMap) -> bool {
    let said = |name: &str| headers.get(name).and_then(|value| value.to_str().ok());
    let is_other = matches!(said("sec-fetch-site"), Some("cross-site" | "same-site"));
    is_other && said("sec-fetch-mode") != Some("navigate")
}

/// True unless a browser says that a page of another origin connects.
pub(super) fn is_same_origin(headers: &HeaderMap) -> bool {
    let Some(origin) = headers.get(header::ORIGIN) else { return true };
    let Ok(origin) = origin.to_str() else { return false };
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
    let place = origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://"));
    place.is_some_and(|place| !place.is_empty() && place.eq_ignore_ascii_case(host))
}

/// Compares in a time that does not depend on where texts differ.
fn is_same(given: &str, token: &str) -> bool {
    let (given, token) = (given.as_bytes(), token.as_bytes());
    given.len() == token.len() && given.iter().zip(token).fold(0, |sum, (a, b)| sum | (a ^ b)) == 0
}

/// This machine's address on the way to others; `None` without a network. A datagram socket asks only the table of routes: it
/// sends nothing. The addresses are of ranges that nobody has: they are for documentation (RFC 5737, RFC 3849).
fn outward(unspecified: IpAddr) -> Option<IpAddr> {
    let elsewhere = if unspecified.is_ipv4() { "192.0.2.1" } else { "2001:db8::1" };
    let elsewhere: IpAddr = elsewhere.parse().ok()?;
    let socket = UdpSocket::bind((unspecified, 0)).ok()?;
    socket.connect((elsewhere, 9)).ok()?;
    Some(socket.local_addr().ok()?.ip())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(all: &[(&'static str, &'static str)]) -> HeaderMap {
        all.iter().map(|&(name, value)| (name.parse().unwrap(), HeaderValue::from_static(value))).collect()
    }

    #[test]
    fn only_its_own_names_are_accepted() {
        let guard = Guard::of("127.0.0.1:8000".parse().unwrap()).unwrap();
        assert_eq!(guard.address(), "http://127.0.0.1:8000/");
        for (host, is_own) in [
            ("127.0.0.1:8000", true),
            ("LocalHost:8000", true),
            ("127.0.0.1", false),
            ("localhost:8001", false),
            ("evil.example:8000", false),
            ("127.0.0.1:8000.evil.example", false),
            ("", false),
        ] {
            assert_eq!(guard.is_own_host(&headers(&[("host", host)])), is_own, "{host}");
        }
        assert!(!guard.is_own_host(&HeaderMap::new()));
    }

    #[test]
    fn the_address_of_a_server_on_all_addresses_can_be_opened() {
        for all in ["0.0.0.0:8000", "[::]:8000"] {
            let guard = Guard::of(all.parse().unwrap()).unwrap();
            let address = guard.address();
            let (host, token) = address.strip_prefix("http://").unwrap().split_once('/').unwrap();
            let host: SocketAddr = host.parse().unwrap();
            assert!(!host.ip().is_unspecified() && host.port() == 8000, "{address}");
            assert_eq!(token.len(), 32 + 1, "{address}");
        }
    }

    #[test]
    fn pages_of_other_origins_are_recognised() {
        for (origin, is_own) in [
            ("http://127.0.0.1:8000", true),
            ("https://127.0.0.1:8000", true),
            ("http://127.0.0.1:8001", false),
            ("http://evil.example", false),
            ("http://127.0.0.1:8000.evil.example", false),
            ("null", false),
            ("", false),
            ("http://", false),
        ] {
            assert_eq!(
                is_same_origin(&headers(&[("host", "127.0.0.1:8000"), ("origin", origin)])),
                is_own,
                "{origin}"
            );
        }
        assert!(is_same_origin(&headers(&[("host", "127.0.0.1:8000")])), "not a browser");
    }

    /// Another port of this machine, and another name of the same domain, are the same site, but another origin (Fetch
    /// Metadata Request Headers, 2.3). What a person types or a link leads to is a navigation.
    #[test]
    fn pages_of_the_same_site_are_other_origins_too() {
        for (site, is_other) in
            [("cross-site", true), ("same-site", true), ("same-origin", false), ("none", false)]
        {
            for (mode, embeds) in
                [("no-cors", true), ("cors", true), ("websocket", true), ("navigate", false)]
            {
                let all = headers(&[("sec-fetch-site", site), ("sec-fetch-mode", mode)]);
                assert_eq!(is_embedded(&all), is_other && embeds, "{site} {mode}");
            }
            assert_eq!(
                is_embedded(&headers(&[("sec-fetch-site", site)])),
                is_other,
                "{site}, without a mode"
            );
        }
        assert!(!is_embedded(&HeaderMap::new()), "not a browser");
    }

    #[test]
    fn tokens_are_random_and_compared_whole() {
        let tokens: Vec<String> =
            (0..2).map(|_| Guard::of("0.0.0.0:80".parse().unwrap()).unwrap().token.unwrap()).collect();
        assert_ne!(tokens[0], tokens[1]);
        assert_eq!(tokens[0].len(), 32);
        assert!(is_same(&tokens[0], &tokens[0]) && !is_same(&tokens[0], &tokens[1]));
        assert!(!is_same("", &tokens[0]) && !is_same(&tokens[0][1..], &tokens[0]));
    }
}
