//! Keys of a deployment: `cluster keys` makes them, and every verb that joins the bus with keys reads those of its role.

use std::fs::Permissions;
use std::os::unix::fs::{DirBuilderExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_link::rules::Role;
use socrates_link::{Credentials, KeysWish, LinkError, SECURE, keys_of, wall_ms};

use crate::config::Config;
use crate::exit::Diagnostic;
use crate::folder::write_private;
use crate::output::Printer;
use crate::words::plural;

/// The value of the configuration that names the folder of a role.
pub const SETTING: &str = "bus.keys";
/// Days before the end of keys from which on it is told: time to make new ones and to copy them.
const FEW_DAYS: u64 = 14;
/// A folder that its owner alone can enter.
const OWNER_FOLDER: u32 = 0o700;

/// What keys are made.
#[derive(Debug, Clone)]
pub struct KeysOptions {
    /// Folder that gets a folder for each role.
    pub dir: PathBuf,
    /// Names and addresses by which others connect, besides `localhost` and `127.0.0.1`.
    pub hosts: Vec<String>,
    /// Days that they hold.
    pub days: u32,
    /// Whether keys that are there are replaced.
    pub force: bool,
}

/// What a role is for, and what its folder is used with.
const fn purpose(role: Role) -> &'static str {
    match role {
        Role::Orchestrator => {
            "the machine of `socrates cluster up`, which listens or connects with it; it may do everything"
        }
        Role::Worker => "machines of `socrates cluster work`",
        Role::Client => {
            "people who use `socrates cluster submit`, `collect`, `pause` and the like, `socrates status`, `top` and `explain`"
        }
        Role::Viewer => "people who use `socrates watch` and `socrates view`; it reads runs and nothing else",
        Role::Driver => "programs that drive a robot or people from outside",
        Role::Router => "a machine of `zenohd -c router.json5`, where the orchestrator is not the router itself",
    }
}

/// Makes the keys of a deployment.
pub fn make(talk: &Printer, options: &KeysOptions) -> Result<(), Diagnostic> {
    let wish = KeysWish { hosts: options.hosts.clone(), days: options.days, now_s: wall_ms() / 1000 };
    let keys = keys_of(&wish).map_err(|why| told(why, "keys cannot be made", "`socrates cluster keys --help`"))?;
    let dir = &options.dir;
    let there = keys.iter().map(|keys| dir.join(keys.role.name())).find(|folder| folder.exists());
    if let (Some(folder), false) = (there, options.force) {
        return Err(Diagnostic::input(
            format!("there are keys in `{}`", folder.display()),
            "name another folder; --force makes all of them anew, and those that were handed out are then refused",
        ));
    }
    let cannot = |path: &Path, why: std::io::Error| {
        Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "name a folder of your own")
    };
    private_folder(dir).map_err(|why| cannot(dir, why))?;
    for of_role in &keys {
        let folder = dir.join(of_role.role.name());
        private_folder(&folder).map_err(|why| cannot(&folder, why))?;
        for (name, text) in &of_role.files {
            let file = folder.join(name);
            write_private(&file, text).map_err(|why| cannot(&file, why))?;
        }
    }
    let mut hosts = options.hosts.clone();
    hosts.extend(["localhost".to_owned(), "127.0.0.1".to_owned()]);
    talk.line(&format!(
        "keys       {} · for {} · {}",
        dir.display(),
        hosts.join(", "),
        plural(options.days as usize, "day")
    ));
    for of_role in &keys {
        let folder = dir.join(of_role.role.name());
        talk.line(&format!("copy       {:<24} to {}", folder.display(), purpose(of_role.role)));
    }
    talk.line("note       a folder is all that its role takes: copy it by ssh, alone, and keep it from others");
    talk.line(
        "note       the key of the authority is not kept: a further host, or a lost folder, needs new keys for all",
    );
    let up = dir.join(Role::Orchestrator.name());
    let host = options.hosts.first().map_or("localhost", String::as_str);
    talk.line(&format!("next       socrates cluster up --dir jobs --listen quic/0.0.0.0:7447 --keys {}", up.display()));
    talk.line(&format!("then       socrates cluster work --connect quic/{host}:7447 --keys worker"));
    let folders: Vec<_> = keys.iter().map(|keys| dir.join(keys.role.name()).display().to_string()).collect();
    talk.result(&json!({ "folders": folders, "hosts": hosts, "days": options.days }));
    Ok(())
}

/// Makes a folder that its owner alone can enter; one that is there is closed to others.
fn private_folder(folder: &Path) -> std::io::Result<()> {
    std::fs::DirBuilder::new().recursive(true).mode(OWNER_FOLDER).create(folder)?;
    std::fs::set_permissions(folder, Permissions::from_mode(OWNER_FOLDER))
}

/// The keys of the configuration for an endpoint that takes them, of this role or the orchestrator's; none for other endpoints.
pub(crate) fn of(config: &Config, role: Role, endpoint: &str) -> Result<Option<Credentials>, Diagnostic> {
    let folder = config.text(SETTING);
    if folder.is_empty() || !endpoint.starts_with(SECURE) {
        return Ok(None);
    }
    let keys = Credentials::read(Path::new(&folder), wall_ms() / 1000)
        .map_err(|why| told(why, &format!("the keys in `{folder}` cannot be used"), ""))?;
    // What a role may not do is dropped without a word: said here, where it can be said.
    if keys.role() != role && keys.role() != Role::Orchestrator {
        let what = format!("the keys in `{folder}` are of the role `{}`, which may not do this", keys.role());
        return Err(Diagnostic::input(what, format!("--keys with the folder of the role `{role}`")));
    }
    let days = keys.days_left();
    if days < FEW_DAYS {
        tracing::warn!(
            folder,
            days,
            "the keys hold only a few more days; `socrates cluster keys` makes new ones for all"
        );
    }
    Ok(Some(keys))
}

/// What the bus says, for a person: keys bring their own hint.
pub(crate) fn told(why: LinkError, what: &str, hint: &str) -> Diagnostic {
    if let LinkError::Keys { what: wrong, hint } = &why {
        return Diagnostic::input(format!("{what}: {wrong}"), hint.as_str());
    }
    Diagnostic::input(format!("{what}: {why}"), hint)
}

#[cfg(test)]
#[cfg(feature = "zenoh")]
mod tests {
    use super::*;
    use crate::output::Format;

    fn options(dir: &Path, force: bool) -> KeysOptions {
        KeysOptions { dir: dir.to_path_buf(), hosts: vec!["lab-3".to_owned()], days: 30, force }
    }

    #[test]
    fn each_role_gets_a_folder_that_its_owner_alone_can_use() {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("keys");
        make(&Printer::to_nobody(Format::Text), &options(&dir, false)).unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&dir), 0o700);
        for role in Role::ALL {
            let of_role = dir.join(role.name());
            assert_eq!(mode(&of_role), 0o700);
            let mut names: Vec<String> = Vec::new();
            for file in std::fs::read_dir(&of_role).unwrap() {
                let file = file.unwrap().path();
                assert_eq!(mode(&file), 0o600, "{}", file.display());
                names.push(file.file_name().unwrap().to_str().unwrap().to_owned());
            }
            names.sort();
            let more: &[&str] = if role == Role::Router { &["router.json5"] } else { &[] };
            assert_eq!(names, [&["ca.pem", "cert.pem", "key.pem"], more].concat(), "{role}");
            assert_eq!(Credentials::read(&of_role, wall_ms() / 1000).unwrap().role(), role);
        }
    }

    #[test]
    fn keys_that_are_there_are_replaced_only_when_that_is_meant() {
        let folder = tempfile::tempdir().unwrap();
        let key = folder.path().join("viewer").join("key.pem");
        make(&Printer::to_nobody(Format::Text), &options(folder.path(), false)).unwrap();
        let before = std::fs::read(&key).unwrap();
        let why = make(&Printer::to_nobody(Format::Text), &options(folder.path(), false)).unwrap_err();
        assert!(why.what.contains("there are keys in") && why.hint.contains("--force"), "{why}");
        assert_eq!(std::fs::read(&key).unwrap(), before);
        make(&Printer::to_nobody(Format::Text), &options(folder.path(), true)).unwrap();
        assert_ne!(std::fs::read(&key).unwrap(), before);
    }

    #[test]
    fn keys_of_another_role_are_refused_before_anything_is_asked() {
        let folder = tempfile::tempdir().unwrap();
        make(&Printer::to_nobody(Format::Text), &options(folder.path(), false)).unwrap();
        let config = |role: Role| {
            let keys = format!("{SETTING}={}", folder.path().join(role.name()).display());
            Config::load(None, std::iter::empty(), &[keys]).unwrap()
        };
        let lab = "quic/lab-3:7447";
        let why = of(&config(Role::Viewer), Role::Client, lab).unwrap_err();
        assert!(why.what.contains("`viewer`") && why.hint.contains("`client`"), "{why}");
        for role in [Role::Client, Role::Orchestrator] {
            assert_eq!(of(&config(role), Role::Client, lab).unwrap().unwrap().role(), role);
        }
        for plain in ["unixsock-stream//run/x", "tcp/127.0.0.1:7447"] {
            assert_eq!(of(&config(Role::Viewer), Role::Client, plain).unwrap(), None);
        }
    }
}
