//! A deployment with keys: their folders, and its router on loopback.

use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use socrates_link::rules::Role;
use socrates_link::{Credentials, KeysWish, Mode, ZenohBus, ZenohConfig, keys_of, wall_ms};
use tempfile::TempDir;

use crate::promises::over_zenoh::free_udp_port;

/// Seconds of a day.
pub(crate) const DAY_S: u64 = 24 * 3600;

/// How long somebody who may come in waits until the router answers.
const PATIENCE: Duration = Duration::from_secs(30);

/// The folders of its keys.
pub(crate) struct Deployment {
    folder: TempDir,
}

impl Deployment {
    /// One whose keys hold now, for loopback.
    pub(crate) fn new() -> Self {
        Self::made(&KeysWish { hosts: vec![], days: 2, now_s: now_s() })
    }

    pub(crate) fn made(wish: &KeysWish) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for keys in keys_of(wish).unwrap() {
            let of_role = folder.path().join(keys.role.name());
            std::fs::create_dir(&of_role).unwrap();
            for (name, text) in keys.files {
                write_private(&of_role.join(name), &text);
            }
        }
        Self { folder }
    }

    pub(crate) fn folder(&self, role: Role) -> PathBuf {
        self.folder.path().join(role.name())
    }

    pub(crate) fn keys(&self, role: Role) -> Credentials {
        Credentials::read(&self.folder(role), now_s()).unwrap()
    }

    /// The router, with the orchestrator in it.
    pub(crate) async fn router(&self) -> (ZenohBus, String) {
        let endpoint = format!("quic/127.0.0.1:{}", free_udp_port());
        let config = ZenohConfig::new(Mode::Router, "t", "orchestrator").listen(&endpoint);
        let config = config.credentials(Some(self.keys(Role::Orchestrator)));
        (ZenohBus::open(config).await.unwrap(), endpoint)
    }

    /// A guest of this role. It waits long: the router may be busy with what fills its memory.
    pub(crate) async fn guest(&self, role: Role, endpoint: &str) -> ZenohBus {
        let mut config = self.guest_config(role, endpoint);
        config.patience = PATIENCE;
        ZenohBus::open(config).await.unwrap()
    }

    /// Settings of such a guest that gives up after a second, for those who are refused.
    pub(crate) fn guest_config(&self, role: Role, endpoint: &str) -> ZenohConfig {
        let mut config = ZenohConfig::new(Mode::Client, "t", role.name()).connect(endpoint);
        config.patience = Duration::from_millis(1_000);
        config.credentials(Some(self.keys(role)))
    }

    /// A guest that is no program of ours, without its limits.
    pub(crate) async fn raw_guest(&self, role: Role, endpoint: &str) -> zenoh::Session {
        let folder = self.folder(role);
        let mut config = raw_client(endpoint);
        for (key, value) in [
            ("transport/link/tls/root_ca_certificate", text_of(&folder.join("ca.pem"))),
            ("transport/link/tls/connect_certificate", text_of(&folder.join("cert.pem"))),
            ("transport/link/tls/connect_private_key", text_of(&folder.join("key.pem"))),
            ("transport/link/tls/enable_mtls", "true".to_owned()),
        ] {
            config.insert_json5(key, &value).unwrap();
        }
        config.insert_json5("connect/timeout_ms", &PATIENCE.as_millis().to_string()).unwrap();
        zenoh::open(config).await.unwrap()
    }
}

/// Settings of a client that is no program of ours.
pub(crate) fn raw_client(endpoint: &str) -> zenoh::Config {
    let mut config = zenoh::Config::default();
    for (key, value) in [
        ("mode", "\"client\"".to_owned()),
        ("connect/endpoints", format!("[{endpoint:?}]")),
        ("connect/timeout_ms", "1000".to_owned()),
        ("connect/exit_on_failure", "true".to_owned()),
        ("scouting/multicast/enabled", "false".to_owned()),
        ("scouting/gossip/enabled", "false".to_owned()),
    ] {
        config.insert_json5(key, &value).unwrap();
    }
    config
}

/// A path in JSON5.
pub(crate) fn text_of(path: &Path) -> String {
    format!("{:?}", path.display().to_string())
}

pub(crate) fn write_private(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap();
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o600)).unwrap();
}

pub(crate) fn now_s() -> u64 {
    wall_ms() / 1000
}
