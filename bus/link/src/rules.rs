//! Access rules of a router: what each role may do on the bus. Written once, as data; everything that is not here is refused.
//!
//! A router knows the role of a link by the common name of the certificate that it showed. What a rule refuses is dropped without
//! a word: a question finds nobody, a publication is not heard.

use std::fmt::Write as _;

/// The part that somebody plays on the bus; also the common name of their certificate and the name of the folder of their keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Owns the jobs. Everything is allowed.
    Orchestrator,
    /// Serves a stage, and tells of the runs that it makes.
    Worker,
    /// Hands in work and asks how it stands.
    Client,
    /// Reads what runs tell, and nothing else.
    Viewer,
    /// Moves a robot, or people, from outside.
    Driver,
    /// A router that is a program of its own; it is nobody's guest, so no rule names it.
    Router,
}

impl Role {
    /// Every role.
    pub const ALL: [Self; 6] =
        [Self::Orchestrator, Self::Worker, Self::Client, Self::Viewer, Self::Driver, Self::Router];

    /// Common name of the certificate.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Orchestrator => "orchestrator",
            Self::Worker => "worker",
            Self::Client => "client",
            Self::Viewer => "viewer",
            Self::Driver => "driver",
            Self::Router => "router",
        }
    }

    /// The role of a common name; none for another name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }

    /// Whether others may connect to it: its certificate names hosts.
    #[must_use]
    pub const fn listens(self) -> bool {
        match self {
            Self::Orchestrator | Self::Router => true,
            Self::Worker | Self::Client | Self::Viewer | Self::Driver => false,
        }
    }

    /// Whether it connects to a router.
    #[must_use]
    pub const fn connects(self) -> bool {
        match self {
            Self::Router => false,
            Self::Orchestrator | Self::Worker | Self::Client | Self::Viewer | Self::Driver => true,
        }
    }
}

impl std::fmt::Display for Role {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// What is done with a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Act {
    /// Everything.
    Anything,
    /// Questions are put and their answers heard.
    Ask,
    /// Questions are answered.
    Serve,
    /// Something is published; the teller learns whether anybody listens.
    Tell,
    /// What is published is heard.
    Hear,
    /// A presence token is shown.
    Show,
    /// Presence tokens are seen.
    See,
}

/// Direction in which the router sees a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Flow {
    /// From the link.
    Ingress,
    /// To the link.
    Egress,
}

impl Act {
    /// The router's words for it: direction, and the kinds of messages that pass in it.
    const fn passes(self) -> &'static [(Flow, &'static [&'static str])] {
        const ALL: &[&str] = &[
            "put",
            "delete",
            "declare_subscriber",
            "query",
            "declare_queryable",
            "reply",
            "liveliness_token",
            "liveliness_query",
            "declare_liveliness_subscriber",
        ];
        match self {
            Self::Anything => &[(Flow::Ingress, ALL), (Flow::Egress, ALL)],
            Self::Ask => &[(Flow::Ingress, &["query"]), (Flow::Egress, &["reply"])],
            Self::Serve => &[(Flow::Ingress, &["declare_queryable", "reply"]), (Flow::Egress, &["query"])],
            Self::Tell => &[(Flow::Ingress, &["put"]), (Flow::Egress, &["declare_subscriber"])],
            Self::Hear => &[(Flow::Ingress, &["declare_subscriber"]), (Flow::Egress, &["put"])],
            Self::Show => &[(Flow::Ingress, &["liveliness_token"])],
            Self::See => &[
                (Flow::Ingress, &["liveliness_query", "declare_liveliness_subscriber"]),
                (Flow::Egress, &["liveliness_token"]),
            ],
        }
    }

    const fn word(self) -> &'static str {
        match self {
            Self::Anything => "anything",
            Self::Ask => "ask",
            Self::Serve => "serve",
            Self::Tell => "tell",
            Self::Hear => "hear",
            Self::Show => "show",
            Self::See => "see",
        }
    }
}

/// One line of the rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grant {
    /// Role that it is granted to.
    pub role: Role,
    /// What it may do.
    pub act: Act,
    /// With these keys, as in [`crate::keys`].
    pub keys: &'static [&'static str],
}

const fn grant(role: Role, act: Act, keys: &'static [&'static str]) -> Grant {
    Grant { role, act, keys }
}

/// Everything that is allowed. A request is covered by one key as a whole: `live/**` lets a viewer hear `live/r/meta`, not `**`.
pub const GRANTS: &[Grant] = &[
    grant(Role::Orchestrator, Act::Anything, &["**"]),
    grant(
        Role::Worker,
        Act::Ask,
        &[
            crate::keys::HELLO,
            crate::keys::ACQUIRE,
            crate::keys::BEAT,
            crate::keys::REPORT,
            crate::keys::RELEASE,
            crate::keys::BLOB_GET,
            crate::keys::BLOB_PUT,
            "drive/*/mission",
            "drive/*/step",
        ],
    ),
    grant(Role::Worker, Act::Serve, &["live/*/*"]),
    grant(Role::Worker, Act::Tell, &["live/*/*"]),
    grant(Role::Worker, Act::Hear, &["hint/*", "cmd/*"]),
    grant(Role::Worker, Act::Show, &[crate::keys::WORKERS_ALIVE]),
    grant(Role::Worker, Act::See, &[crate::keys::DRIVERS_ALIVE, crate::keys::ORCHESTRATORS_ALIVE]),
    grant(
        Role::Client,
        Act::Ask,
        &[
            crate::keys::SUBMIT,
            crate::keys::CONTROL,
            crate::keys::STATUS,
            crate::keys::PAST,
            crate::keys::BLOB_GET,
            crate::keys::BLOB_PUT,
        ],
    ),
    grant(Role::Client, Act::Hear, &[crate::keys::EVENTS]),
    grant(Role::Viewer, Act::Ask, &["live/**", crate::keys::BLOB_GET]),
    grant(Role::Viewer, Act::Hear, &["live/**"]),
    grant(Role::Driver, Act::Serve, &["drive/*/mission", "drive/*/step"]),
    grant(Role::Driver, Act::Show, &[crate::keys::DRIVERS_ALIVE]),
    grant(Role::Driver, Act::Ask, &[crate::keys::SERVE_RUN]),
];

/// The part `access_control` of a router's configuration, JSON5.
#[must_use]
pub fn access_control() -> String {
    let mut rules = String::new();
    let mut policies = String::new();
    for role in Role::ALL {
        let mut ids = Vec::new();
        for granted in GRANTS.iter().filter(|granted| granted.role == role) {
            for (flow, messages) in granted.act.passes() {
                let (way, mark) = match flow {
                    Flow::Ingress => ("ingress", ""),
                    Flow::Egress => ("egress", ", answered"),
                };
                let id = format!("{role}: {}{mark}", granted.act.word());
                let keys: Vec<String> = granted.keys.iter().map(|key| format!("soc/v1/*/{key}")).collect();
                // Debug of a list of strings is JSON5.
                let rule = format!(
                    "    {{\n      id: {id:?}, flows: [{way:?}], permission: \"allow\",\n      messages: {messages:?},\n      \
                     key_exprs: [\n{}      ],\n    }},\n",
                    keys.iter().fold(String::new(), |mut lines, key| {
                        let _written = writeln!(lines, "        {key:?},");
                        lines
                    }),
                );
                rules.push_str(&rule);
                ids.push(id);
            }
        }
        if !ids.is_empty() {
            let policy = format!("    {{ subjects: [{:?}], rules: {ids:?} }},\n", role.name());
            policies.push_str(&policy);
        }
    }
    let subjects: String = Role::ALL
        .iter()
        .filter(|role| role.connects())
        .map(|role| format!("    {{ id: {0:?}, cert_common_names: [{0:?}] }},\n", role.name()))
        .collect();
    format!(
        "{{\n  enabled: true,\n  default_permission: \"deny\",\n  rules: [\n{rules}  ],\n  subjects: [\n{subjects}  ],\n  \
         policies: [\n{policies}  ],\n}}"
    )
}

/// Comment at the head of [`router_config`].
const ABOUT: &str = "\
// A zenoh router (zenohd 1.x) between the processes of a deployment: mutual TLS over QUIC, and what each role may do. Made by `socrates
// cluster keys`, which puts it into the folder `router` beside the certificates that it names:
//
//     cd router && zenohd -c router.json5
//
// The role of a link is the common name of its certificate. What no rule here allows is dropped without a word.
";

/// The whole configuration of a router that is a program of its own, JSON5: mutual TLS over QUIC with `ca.pem`, `cert.pem` and `key.pem` of the
/// folder that it is started in, and [`access_control`].
#[must_use]
pub fn router_config() -> String {
    let rules = access_control().replace('\n', "\n  ");
    format!(
        "{ABOUT}{{
  mode: \"router\",
  listen: {{ endpoints: [\"quic/0.0.0.0:7447\"] }},
  scouting: {{ multicast: {{ enabled: false }}, gossip: {{ enabled: false }} }},
  adminspace: {{ enabled: false }},
  transport: {{
    link: {{
      protocols: [\"quic\"],
      rx: {{ max_message_size: {MOST_BYTES} }},
      tls: {{
        enable_mtls: true,
        close_link_on_expiration: true,
        root_ca_certificate: \"ca.pem\",
        listen_certificate: \"cert.pem\",
        listen_private_key: \"key.pem\",
      }},
    }},
  }},
  access_control: {rules},
}}
"
    )
}

/// Longest message that is put together from fragments, bytes: sixteen of the longest that this bus sends, so that one with its
/// addresses always fits and nobody fills the memory of a router.
pub(crate) const MOST_BYTES: usize = 16 * socrates_model::job::MESSAGE_BYTES;

#[cfg(test)]
#[cfg(feature = "zenoh")]
mod tests {
    use zenoh::key_expr::keyexpr;

    use super::*;
    use crate::keys;

    /// Whether a role may do this with a key.
    fn may(role: Role, act: Act, key: &str) -> bool {
        let mine = GRANTS.iter().filter(|granted| granted.role == role);
        let mut fits = mine.filter(|granted| granted.act == act || granted.act == Act::Anything);
        let asked = keyexpr::new(key).unwrap();
        fits.any(|granted| granted.keys.iter().any(|allowed| keyexpr::new(*allowed).unwrap().includes(asked)))
    }

    #[test]
    fn each_question_to_the_orchestrator_is_for_the_roles_that_put_it() {
        let who = |key: &str| -> Vec<&str> {
            let asks = Role::ALL.into_iter().filter(|role| *role != Role::Orchestrator && may(*role, Act::Ask, key));
            asks.map(Role::name).collect()
        };
        for key in keys::RPC {
            let meant: &[&str] = match key {
                keys::HELLO | keys::ACQUIRE | keys::BEAT | keys::REPORT | keys::RELEASE => &["worker"],
                keys::SUBMIT | keys::CONTROL | keys::STATUS | keys::PAST => &["client"],
                keys::BLOB_GET => &["worker", "client", "viewer"],
                keys::BLOB_PUT => &["worker", "client"],
                other => panic!("`{other}` is new: say in GRANTS who may ask it, and here"),
            };
            assert_eq!(who(key), meant, "{key}");
        }
    }

    #[test]
    fn nobody_but_a_worker_tells_of_runs_and_nobody_but_a_driver_drives() {
        for role in Role::ALL {
            let all = role == Role::Orchestrator;
            assert_eq!(may(role, Act::Tell, "live/r/agents"), all || role == Role::Worker, "{role}");
            assert_eq!(may(role, Act::Serve, "live/r/*"), all || role == Role::Worker, "{role}");
            assert_eq!(may(role, Act::Serve, "drive/mine/step"), all || role == Role::Driver, "{role}");
            assert_eq!(may(role, Act::Serve, keys::ACQUIRE), all, "{role}");
            assert_eq!(may(role, Act::Hear, "**"), all, "{role}");
        }
    }

    #[test]
    fn a_role_is_named_once_and_read_back() {
        for role in Role::ALL {
            assert_eq!(Role::of_name(role.name()), Some(role));
        }
        assert_eq!(Role::of_name("root"), None);
    }

    #[test]
    fn the_shipped_router_is_the_one_that_is_made() {
        let shipped = include_str!("../../../deploy/zenoh/router.json5");
        if shipped != router_config() {
            let right = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/router.json5");
            let right =
                std::env::var_os("SOCRATES_WRITE_PAGES").map_or(right, |_| "../../deploy/zenoh/router.json5".into());
            std::fs::create_dir_all(right.parent().unwrap()).unwrap();
            std::fs::write(&right, router_config()).unwrap();
            panic!("deploy/zenoh/router.json5 differs from the rules; the right one is `{}`", right.display());
        }
    }
}
