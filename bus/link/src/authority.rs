//! Makes the keys of a deployment: one authority, and for each role a certificate that it signs.
//!
//! The authority's own key is forgotten at once. Nobody can sign a further certificate, and new keys are made for all roles together.

use std::net::IpAddr;

use crate::error::LinkError;
use crate::rules::Role;

/// Longest time that certificates may hold, days: ten years.
const MOST_DAYS: u32 = 3650;
/// Most hosts in a certificate.
const MOST_HOSTS: usize = 64;
/// Hosts that are always named.
const HERE: [&str; 2] = ["localhost", "127.0.0.1"];

/// What keys are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeysWish {
    /// Names and addresses by which others connect, each read by [`host_of`]; `localhost` and `127.0.0.1` are always among them.
    pub hosts: Vec<String>,
    /// Days that the certificates hold, 1 to 3650.
    pub days: u32,
    /// Wall time, s since 1970.
    pub now_s: u64,
}

/// The keys of one role.
#[derive(Clone)]
pub struct RoleKeys {
    /// The role.
    pub role: Role,
    /// Names and texts of the files of its folder.
    pub files: Vec<(&'static str, String)>,
}

/// Reads a host that others connect to.
///
/// # Errors
/// [`LinkError::Keys`] for anything but an IP address or a host name of at most 253 letters, digits, `-` and `.`.
pub fn host_of(text: &str) -> Result<String, LinkError> {
    let label = |label: &str| {
        let signs = label.chars().all(|c| c.is_ascii_alphanumeric() || c == '-');
        signs && (1..=63).contains(&label.len()) && !label.starts_with('-') && !label.ends_with('-')
    };
    let named = text.len() <= 253 && text.split('.').all(label);
    // What is all digits and dots without being an address would be looked up as one.
    let numbers = text.chars().all(|c| c.is_ascii_digit() || c == '.');
    if text.parse::<IpAddr>().is_ok() || named && !numbers {
        return Ok(text.to_ascii_lowercase());
    }
    Err(LinkError::Keys {
        what: format!("`{}` is no host", text.chars().take(80).collect::<String>()),
        hint: "name it as others connect to it, without a port: --host lab-3.example or --host 192.0.2.7".to_owned(),
    })
}

/// Makes the keys of every role. Two calls make different ones.
///
/// # Errors
/// [`LinkError::Keys`] for a host that is none, more than 64 of them, or days outside 1 to 3650; [`LinkError::Absent`] in a program
/// without the feature `zenoh`.
pub fn keys_of(wish: &KeysWish) -> Result<Vec<RoleKeys>, LinkError> {
    let bad = |what: String, hint: &str| LinkError::Keys { what, hint: hint.to_owned() };
    if !(1..=MOST_DAYS).contains(&wish.days) {
        return Err(bad(format!("keys cannot hold for {} days", wish.days), "--days is 1 to 3650; 365 by default"));
    }
    if wish.hosts.len() > MOST_HOSTS {
        return Err(bad(format!("{} hosts are given", wish.hosts.len()), "at most 64 of them fit a certificate"));
    }
    let mut hosts: Vec<String> = wish.hosts.iter().map(|host| host_of(host)).collect::<Result<_, _>>()?;
    hosts.extend(HERE.map(str::to_owned));
    hosts.sort();
    hosts.dedup();
    signed(&hosts, wish)
}

/// Signs them.
#[cfg(feature = "zenoh")]
fn signed(hosts: &[String], wish: &KeysWish) -> Result<Vec<RoleKeys>, LinkError> {
    crate::certificates::made(hosts, wish).map_err(|why| LinkError::Keys {
        what: format!("keys cannot be made: {why}"),
        hint: "`socrates doctor` checks this machine".to_owned(),
    })
}

/// Signs none.
#[cfg(not(feature = "zenoh"))]
fn signed(_hosts: &[String], _wish: &KeysWish) -> Result<Vec<RoleKeys>, LinkError> {
    Err(LinkError::Absent { feature: "zenoh" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_host_is_a_name_or_an_address_and_nothing_else() {
        for good in ["lab-3", "a.b.example", "192.0.2.7", "::1", "2001:db8::7", "LAB"] {
            assert_eq!(host_of(good).unwrap(), good.to_lowercase());
        }
        for bad in
            ["", "a b", "*.lab", "a:7447", "quic/a:1", "-a", "a-", "a..b", "256.1.1.1", "1.2", "ä", &"a".repeat(64)]
        {
            let why = host_of(bad).unwrap_err().to_string();
            assert!(why.contains("is no host") && why.contains("--host"), "`{bad}`: {why}");
        }
    }

    #[test]
    fn keys_that_nobody_could_use_are_refused() {
        let wish = |hosts: Vec<String>, days| KeysWish { hosts, days, now_s: 1_800_000_000 };
        for days in [0, MOST_DAYS + 1] {
            assert!(keys_of(&wish(vec![], days)).is_err(), "{days}");
        }
        assert!(keys_of(&wish(vec!["a".to_owned(); MOST_HOSTS + 1], 1)).is_err());
        assert!(keys_of(&wish(vec!["a/b".to_owned()], 1)).is_err());
    }

    #[cfg(feature = "zenoh")]
    #[test]
    fn each_role_has_a_folder_of_its_own_and_no_key_is_used_twice() {
        let keys = keys_of(&KeysWish { hosts: vec![], days: 1, now_s: 1_800_000_000 }).unwrap();
        assert_eq!(keys.len(), Role::ALL.len());
        let mut secrets: Vec<&String> = keys
            .iter()
            .flat_map(|keys| &keys.files)
            .filter(|(name, _)| *name == "key.pem")
            .map(|(_, text)| text)
            .collect();
        secrets.sort();
        secrets.dedup();
        assert_eq!(secrets.len(), Role::ALL.len());
    }
}
