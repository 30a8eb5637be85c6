//! A network of its own for one of the machines: it can be cut off, and lose packets, without anything else being touched.

use std::process::{Command, Stdio};

/// The table of rules within the machine's network.
const TABLE: &str = "chaos";
/// The machine's end of the cable.
const FAR: &str = "far";

/// What is done to the packets of the machine, both ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trouble {
    /// None gets through.
    Cut,
    /// This number of a hundred does not.
    Loses(u32),
}

/// A namespace with a cable to this machine; gone with this.
pub(super) struct Network {
    name: String,
    /// This machine, as the other one sees it.
    pub(super) address: String,
}

/// Runs a command; what it prints, or why it fails.
fn run(words: &[&str]) -> Result<String, String> {
    let (program, args) = words.split_first().ok_or("no command")?;
    let done =
        Command::new(program).args(args).stdin(Stdio::null()).output().map_err(|why| format!("`{program}`: {why}"))?;
    if done.status.success() {
        return Ok(String::from_utf8_lossy(&done.stdout).into_owned());
    }
    Err(format!("`{}`: {}", words.join(" "), String::from_utf8_lossy(&done.stderr).trim()))
}

impl Network {
    /// Makes one. It needs root, `ip`, and `nft` with random numbers in the kernel.
    pub(super) fn make() -> Result<Self, String> {
        let id = std::process::id() % 10_000;
        let (name, near) = (format!("chaos{id}"), format!("near{id}"));
        let net = format!("10.{}.{}", 200 + id % 50, id / 50);
        let network = Self { name: name.clone(), address: format!("{net}.1") };
        let inside = |words: &[&str]| run(&[&["ip", "netns", "exec", &name], words].concat());
        let made = || -> Result<(), String> {
            run(&["ip", "netns", "add", &name])?;
            run(&["ip", "link", "add", &near, "type", "veth", "peer", "name", FAR, "netns", &name])?;
            run(&["ip", "addr", "add", &format!("{net}.1/30"), "dev", &near])?;
            run(&["ip", "link", "set", &near, "up"])?;
            inside(&["ip", "addr", "add", &format!("{net}.2/30"), "dev", FAR])?;
            inside(&["ip", "link", "set", FAR, "up"])?;
            inside(&["ip", "link", "set", "lo", "up"])?;
            inside(&["nft", "add", "table", "inet", TABLE])?;
            Ok(())
        };
        made().map_err(|why| {
            format!("no network of its own for a machine, so none is cut off and no packets are lost: {why}")
        })?;
        if network.begin(Trouble::Loses(1)) && network.end().is_some() {
            return Ok(network);
        }
        Err("nftables of this kernel cannot drop packets at random: no machine is cut off and no packets are lost"
            .to_owned())
    }

    /// What a command begins with that runs on the machine.
    pub(super) fn enter(&self) -> Vec<String> {
        ["ip", "netns", "exec", &self.name].map(str::to_owned).to_vec()
    }

    fn nft(&self, words: &[&str]) -> Result<String, String> {
        run(&[&["ip", "netns", "exec", &self.name, "nft"], words].concat())
    }

    /// Begins with it; whether the rules stand.
    pub(super) fn begin(&self, trouble: Trouble) -> bool {
        let which = match trouble {
            Trouble::Cut => String::new(),
            Trouble::Loses(of_hundred) => format!("numgen random mod 100 < {of_hundred} "),
        };
        let rules: Vec<String> = [("input", "iifname"), ("output", "oifname")]
            .into_iter()
            .map(|(hook, side)| {
                format!(
                    "add chain inet {TABLE} {hook} {{ type filter hook {hook} priority 0; policy accept; }}; \
                     add rule inet {TABLE} {hook} {side} {FAR} {which}counter drop"
                )
            })
            .collect();
        self.nft(&[&rules.join("; ")]).is_ok()
    }

    /// Ends it; how many packets were dropped, as the kernel counted them, or none where the rules cannot be taken away.
    pub(super) fn end(&self) -> Option<u64> {
        let told = self.nft(&["list", "table", "inet", TABLE]).ok()?;
        let words: Vec<&str> = told.split_whitespace().collect();
        let counts = words.windows(3).filter(|pair| pair[0] == "counter" && pair[1] == "packets");
        let dropped = counts.filter_map(|pair| pair[2].parse::<u64>().ok()).sum();
        let away = format!("delete table inet {TABLE}; add table inet {TABLE}");
        self.nft(&[&away]).is_ok().then_some(dropped)
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        // Both ends of the cable go with it.
        drop(run(&["ip", "netns", "del", &self.name]));
    }
}
