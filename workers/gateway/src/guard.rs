//! The rules of the door: hosts, origins, the token, and how many at once. Pure, but for the count.
//!
//! Even on loopback, a page of a stranger that is open in somebody's browser can reach this port: its origin tells it apart, and a name that
//! a stranger's server points at this machine is told apart by the host it was asked for.

use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, Mutex, PoisonError};

use axum::http::{HeaderMap, header};
use socrates_model::Digest;

/// Beginning of the subprotocol by which a socket brings its token.
const TOKEN_PROTOCOL: &str = "soc.token.";
/// Name of the cookie that keeps a page in.
pub const COOKIE: &str = "soc_token";
/// Least length of a token, characters: 128 bits as hex digits.
pub const TOKEN_CHARS: usize = 32;

/// What is let in.
#[derive(Debug, Clone)]
pub struct Rules {
    /// The token; none where anybody on this machine may look.
    pub token: Option<String>,
    /// Names under which this server may be asked for, besides `localhost` and addresses.
    pub hosts: Vec<String>,
    /// Pages of others that may look, such as `https://app.foxglove.dev`.
    pub origins: Vec<String>,
    /// Connections at once.
    pub most: usize,
    /// Connections at once from one address that is not this machine's.
    pub most_each: usize,
}

impl Default for Rules {
    fn default() -> Self {
        Self { token: None, hosts: Vec::new(), origins: Vec::new(), most: 256, most_each: 32 }
    }
}

/// Why somebody is not let in: a status and words.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// Asked under a name that is not this server's.
    #[error("the host `{found}` is not this server's; allowed: localhost, an address, {allowed}")]
    Host {
        /// The name.
        found: String,
        /// Names that are.
        allowed: String,
    },
    /// A page of somebody else.
    #[error("pages of `{found}` may not look here; `--allow-origin {found}` lets them")]
    Origin {
        /// Where it comes from.
        found: String,
    },
    /// No token, or a wrong one.
    #[error("the token is missing or wrong; it stands behind `#token=` of the address that `socrates view` printed")]
    Token,
}

/// A header as text, shortened; what is no text is empty.
fn text<'h>(headers: &'h HeaderMap, name: &header::HeaderName) -> Option<&'h str> {
    headers.get(name).map(|value| value.to_str().unwrap_or_default())
}

/// A name shortened for a message.
fn shown(name: &str) -> String {
    name.chars().filter(|c| !c.is_control()).take(80).collect()
}

/// The host of `host:port`, without brackets.
fn host_of(authority: &str) -> &str {
    match authority.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => authority.rsplit_once(':').map_or(authority, |(host, _)| host),
    }
}

impl Rules {
    /// Whether a request comes to this server and from a page that may look.
    ///
    /// # Errors
    /// [`Refusal::Host`], [`Refusal::Origin`].
    pub fn address(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let authority = text(headers, &header::HOST).unwrap_or_default();
        let host = host_of(authority);
        let is_ours = host.eq_ignore_ascii_case("localhost")
            || host.parse::<IpAddr>().is_ok()
            || self.hosts.iter().any(|name| name.eq_ignore_ascii_case(host));
        if !is_ours {
            return Err(Refusal::Host { found: shown(authority), allowed: self.hosts.join(", ") });
        }
        match text(headers, &header::ORIGIN) {
            // Programs send none.
            None => Ok(()),
            Some(origin) if self.may_look(origin, authority) => Ok(()),
            Some(origin) => Err(Refusal::Origin { found: shown(origin) }),
        }
    }

    fn may_look(&self, origin: &str, authority: &str) -> bool {
        let own = ["http://", "https://"].iter().any(|scheme| origin.strip_prefix(scheme) == Some(authority));
        own || self.origins.iter().any(|allowed| allowed == origin)
    }

    /// The origin that an answer may be read by: that of a page of others that may look.
    #[must_use]
    pub fn reader<'h>(&self, headers: &'h HeaderMap) -> Option<&'h str> {
        text(headers, &header::ORIGIN).filter(|origin| self.origins.iter().any(|allowed| allowed == origin))
    }

    /// Whether a request brings the token, where one is needed.
    ///
    /// # Errors
    /// [`Refusal::Token`].
    pub fn token(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let Some(token) = &self.token else { return Ok(()) };
        let bearer = text(headers, &header::AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
        let protocols = text(headers, &header::SEC_WEBSOCKET_PROTOCOL).unwrap_or_default();
        let spoken = protocols.split(',').find_map(|protocol| protocol.trim().strip_prefix(TOKEN_PROTOCOL));
        let cookies = text(headers, &header::COOKIE).unwrap_or_default();
        let kept = cookies.split(';').find_map(|cookie| cookie.trim().strip_prefix(COOKIE)?.strip_prefix('='));
        // Digests are compared, so that the time of an answer tells nothing of the token.
        let wanted = Digest::of(token.as_bytes());
        let right = [bearer, spoken, kept].into_iter().flatten().any(|given| Digest::of(given.as_bytes()) == wanted);
        if right { Ok(()) } else { Err(Refusal::Token) }
    }
}

/// Counts connections; a guest leaves when it is dropped.
#[derive(Debug, Clone, Default)]
pub struct Guests(Arc<Mutex<BTreeMap<IpAddr, usize>>>);

/// One connection.
#[derive(Debug)]
pub struct Guest {
    guests: Guests,
    from: IpAddr,
}

impl Guests {
    /// Lets one more in; none where there are enough.
    #[must_use]
    pub fn admit(&self, from: SocketAddr, rules: &Rules) -> Option<Guest> {
        let mut counts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (all, from) = (counts.values().sum::<usize>(), from.ip());
        let own = counts.get(&from).copied().unwrap_or_default();
        if all >= rules.most || (!from.is_loopback() && own >= rules.most_each) {
            return None;
        }
        counts.insert(from, own + 1);
        drop(counts);
        Some(Guest { guests: self.clone(), from })
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).values().sum()
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        let mut counts = self.guests.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = counts.get_mut(&self.from) {
            *count -= 1;
            if *count == 0 {
                counts.remove(&self.from);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(header::HeaderName, &str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.clone(), value.parse().unwrap())).collect()
    }

    #[test]
    fn a_strangers_page_and_a_strangers_name_are_told_apart_from_our_own() {
        let rules = Rules {
            hosts: vec!["lab.example".to_owned()],
            origins: vec!["https://app.foxglove.dev".to_owned()],
            ..Rules::default()
        };
        let ask = |host: &str, origin: Option<&str>| {
            let mut pairs = vec![(header::HOST, host)];
            pairs.extend(origin.map(|origin| (header::ORIGIN, origin)));
            rules.address(&headers(&pairs))
        };
        for (host, origin) in [
            ("127.0.0.1:8780", None),
            ("localhost:8780", Some("http://localhost:8780")),
            ("[::1]:8780", Some("http://[::1]:8780")),
            ("LAB.example", Some("https://LAB.example")),
            ("127.0.0.1:8780", Some("https://app.foxglove.dev")),
        ] {
            assert_eq!(ask(host, origin), Ok(()), "{host} {origin:?}");
        }
        for (host, origin) in [
            ("evil.example:8780", None),
            ("", None),
            ("127.0.0.1.evil.example", None),
            ("localhost:8780", Some("http://localhost:3000")),
            ("localhost:8780", Some("https://evil.example")),
            ("localhost:8780", Some("null")),
            ("evil.example", Some("http://evil.example")),
        ] {
            assert!(ask(host, origin).is_err(), "{host} {origin:?}");
        }
        let told = ask("localhost:8780", Some("https://evil.example")).unwrap_err().to_string();
        assert!(told.contains("--allow-origin https://evil.example"), "{told}");
    }

    #[test]
    fn a_token_comes_by_header_subprotocol_or_cookie_and_no_other_way() {
        let token = "0123456789abcdef0123456789abcdef";
        let rules = Rules { token: Some(token.to_owned()), ..Rules::default() };
        let ask = |name: header::HeaderName, value: &str| rules.token(&headers(&[(name, value)]));
        assert!(ask(header::AUTHORIZATION, &format!("Bearer {token}")).is_ok());
        assert!(ask(header::SEC_WEBSOCKET_PROTOCOL, &format!("socrates.live.v1, soc.token.{token}")).is_ok());
        assert!(ask(header::COOKIE, &format!("a=b; soc_token={token}")).is_ok());
        for wrong in ["Bearer", "Bearer ", token, "Bearer 0123456789abcdef0123456789abcdee"] {
            assert_eq!(ask(header::AUTHORIZATION, wrong), Err(Refusal::Token), "{wrong}");
        }
        assert_eq!(ask(header::COOKIE, &format!("soc_tokenx={token}")), Err(Refusal::Token));
        assert_eq!(rules.token(&HeaderMap::new()), Err(Refusal::Token));
        assert_eq!(Rules::default().token(&HeaderMap::new()), Ok(()));
    }

    #[test]
    fn guests_are_counted_by_address_and_leave() {
        let rules = Rules { most: 3, most_each: 1, ..Rules::default() };
        let guests = Guests::default();
        let (here, there): (SocketAddr, SocketAddr) = ("127.0.0.1:1".parse().unwrap(), "10.0.0.7:1".parse().unwrap());
        let first = guests.admit(there, &rules);
        assert!(first.is_some() && guests.admit(there, &rules).is_none(), "one from each address");
        let held = [guests.admit(here, &rules), guests.admit(here, &rules)];
        assert!(held.iter().all(Option::is_some) && guests.admit(here, &rules).is_none(), "three at once");
        drop(first);
        assert_eq!(guests.count(), 2);
        assert!(guests.admit(there, &rules).is_some());
    }
}
