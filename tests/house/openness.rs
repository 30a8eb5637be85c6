//! Files of an open repository: the toolchain, the policy about dependencies, the checks on every push.

use socrates_tests::root;

use super::members;

fn text(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap_or_else(|why| panic!("{file}: {why}"))
}

fn toml_of(file: &str) -> toml::Table {
    text(file).parse().unwrap_or_else(|why| panic!("{file}: {why}"))
}

#[test]
fn the_toolchain_is_the_one_that_the_workspace_asks_for() {
    let workspace = toml_of("Cargo.toml");
    let version = workspace["workspace"]["package"]["rust-version"].as_str().unwrap().to_owned();
    let toolchain = toml_of("rust-toolchain.toml");
    let channel = toolchain["toolchain"]["channel"].as_str().unwrap();
    assert!(channel == version || channel.starts_with(&format!("{version}.")), "{channel} is not {version}");
    let components: Vec<&str> =
        toolchain["toolchain"]["components"].as_array().unwrap().iter().filter_map(toml::Value::as_str).collect();
    assert_eq!(components, ["clippy", "rustfmt"]);
}

#[test]
fn dependencies_come_from_one_registry_under_named_licenses() {
    let deny = toml_of("deny.toml");
    let sources = &deny["sources"];
    for key in ["unknown-registry", "unknown-git"] {
        assert_eq!(sources[key].as_str(), Some("deny"), "deny.toml: sources.{key}");
    }
    for key in ["allow-registry", "allow-git"] {
        assert!(sources.get(key).is_none(), "deny.toml: sources.{key} widens the default, crates.io alone");
    }
    let allowed = deny["licenses"]["allow"].as_array().unwrap();
    for (member, manifest) in members() {
        let inherited = manifest["package"]["license"].get("workspace").and_then(toml::Value::as_bool);
        assert_eq!(inherited, Some(true), "{member} has a license of its own");
    }
    let own = toml_of("Cargo.toml")["workspace"]["package"]["license"].clone();
    assert!(allowed.contains(&own), "deny.toml does not allow {own}");
    let lock = toml_of("Cargo.lock");
    let package = lock["package"].as_array().unwrap();
    let elsewhere: Vec<&str> = package
        .iter()
        .filter(|package| {
            let source = package.get("source").and_then(toml::Value::as_str);
            source.is_some_and(|source| !source.ends_with("github.com/rust-lang/crates.io-index"))
        })
        .map(|package| package["name"].as_str().unwrap())
        .collect();
    assert!(elsewhere.is_empty(), "Cargo.lock: from elsewhere: {elsewhere:?}");
    let names: Vec<&str> = package.iter().map(|package| package["name"].as_str().unwrap()).collect();
    for exception in deny["licenses"]["exceptions"].as_array().unwrap() {
        let named = exception["crate"].as_str().unwrap();
        assert!(names.contains(&named), "deny.toml: an exception for `{named}`, which Cargo.lock does not name");
    }
}

#[test]
fn every_push_runs_the_gate_on_a_pinned_system() {
    let workflow = text(".github/workflows/gate.yml");
    let runs: Vec<&str> =
        workflow.lines().filter_map(|line| line.trim().trim_start_matches("- ").strip_prefix("run: ")).collect();
    assert_eq!(runs, [".ci/run", "./gate --sweep"]);
    assert!(workflow.contains("cron:") && workflow.contains("pull_request:"), "{workflow}");
    let version = toml_of("rust-toolchain.toml")["toolchain"]["channel"].as_str().unwrap().to_owned();
    let (mut systems, mut images) = (0, 0);
    for line in workflow.lines().map(|line| line.trim().trim_start_matches("- ")) {
        if let Some(system) = line.strip_prefix("runs-on: ") {
            systems += 1;
            assert!(system.starts_with("ubuntu-") && !system.ends_with("latest"), "{system}");
        }
        if let Some(image) = line.strip_prefix("image: ") {
            images += 1;
            assert!(image.starts_with(&format!("rust:{version}-")), "{image} is not Rust {version}");
        }
    }
    assert_eq!((systems, images), (2, 2));
}

#[test]
fn updates_of_libraries_and_actions_are_grouped_and_weekly() {
    let updates = text(".github/dependabot.yml");
    for (words, times) in [
        ("package-ecosystem: cargo", 1),
        ("package-ecosystem: github-actions", 1),
        ("interval: weekly", 2),
        ("groups:", 2),
    ] {
        assert_eq!(updates.matches(words).count(), times, "{words}");
    }
}

#[test]
fn weaknesses_are_reported_in_private_and_the_front_page_says_where() {
    assert!(text("SECURITY.md").contains("Report a vulnerability"));
    assert!(text("README.md").contains("](SECURITY.md)"));
}

#[test]
fn the_first_command_of_the_readme_means_one_program() {
    assert!(text("README.md").contains("\ncargo run --release -- demo"));
    let workspace = toml_of("Cargo.toml");
    let default: Vec<&str> =
        workspace["workspace"]["default-members"].as_array().unwrap().iter().filter_map(toml::Value::as_str).collect();
    let programs = |room: &&&str| {
        let manifest = toml_of(&format!("{room}/Cargo.toml"));
        manifest.contains_key("bin") || root().join(room).join("src/main.rs").is_file()
    };
    assert_eq!(default.iter().filter(programs).collect::<Vec<_>>(), [&"orchestrator/cli"]);
    let tools = members().into_keys().filter(|room| !default.contains(&room.as_str()));
    assert_eq!(tools.collect::<Vec<_>>(), ["tests/dev"]);
}
