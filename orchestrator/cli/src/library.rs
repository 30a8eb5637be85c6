//! The list of a library: one file at the root of a folder of bundles.

use std::collections::{BTreeMap, VecDeque};
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::json;
use socrates_checks::{Likeness, Signature, check_repeats};
use socrates_model::{Digest, Proposal, Reading, ScenarioId};

use crate::args::RunOptions;
use crate::exit::{Code, Complaint};
use crate::run::Refused;
use crate::talk::Talk;

/// A scenario is compared with at most so many different ones of its kind, the newest: a library of a hundred thousand is no reason
/// for ten thousand million comparisons.
const COMPARED: usize = 500;
/// File that lists a library.
const FILE: &str = "library.json";

/// One scenario of a library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// Which.
    pub(crate) scenario: ScenarioId,
    /// Its folder.
    pub(crate) bundle: String,
    /// Verdict, or `failed` where no bundle could be made.
    pub(crate) verdict: String,
    /// Why there is no bundle; empty where there is one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) reason: String,
    /// The earlier scenario that it repeats (P-DUP).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) repeats: Option<ScenarioId>,
}

/// A finished library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Library {
    /// What it was made from.
    pub(crate) wish: Digest,
    /// Scenarios asked for.
    pub(crate) count: u64,
    /// Readings of its requests.
    pub(crate) readings: Vec<Reading>,
    /// Scenarios, in order of submission.
    pub(crate) scenarios: Vec<Row>,
}

/// The library of a folder, if it is one.
pub(crate) fn read(root: &Path) -> Option<Library> {
    serde_json::from_str(&std::fs::read_to_string(root.join(FILE)).ok()?).ok()
}

/// Writes the list.
pub(crate) fn write(root: &Path, library: &Library) -> Result<(), Complaint> {
    let path = root.join(FILE);
    let text = serde_json::to_string_pretty(library)
        .map_err(|why| Complaint::input(why.to_string(), "").with_code(Code::Ours))?;
    std::fs::write(&path, text).map_err(|why| {
        Complaint::input(format!("cannot write `{}`: {why}", path.display()), "--out chooses another folder")
    })
}

/// Finds scenarios that repeat earlier ones.
#[derive(Debug, Default)]
pub(crate) struct Repeats(BTreeMap<Signature, VecDeque<(ScenarioId, Likeness)>>);

impl Repeats {
    /// The earlier scenario that this one repeats; it is remembered itself where it repeats none.
    pub(crate) fn of(&mut self, id: &ScenarioId, proposal: &Proposal) -> Option<ScenarioId> {
        let proposal = Likeness::of(proposal);
        let alike = self.0.entry(proposal.signature.clone()).or_default();
        let earlier = alike.iter().find(|(other, earlier)| check_repeats(&proposal, other, earlier).is_some());
        if let Some((other, _)) = earlier {
            return Some(other.clone());
        }
        if alike.len() == COMPARED {
            alike.pop_front();
        }
        alike.push_back((id.clone(), proposal));
        None
    }
}

/// Prints what a library holds.
pub(crate) fn finish(talk: &Talk, options: &RunOptions, root: &Path, refused: &[Refused]) -> Result<Code, Complaint> {
    let library = read(root)
        .ok_or_else(|| Complaint::input(format!("`{}` has no {FILE}", root.display()), "run the same command again"))?;
    let mut verdicts = BTreeMap::<&str, u64>::new();
    for row in &library.scenarios {
        *verdicts.entry(row.verdict.as_str()).or_default() += 1;
    }
    let realised = verdicts.get("realised").copied().unwrap_or(0);
    let words: Vec<String> = verdicts.iter().map(|(verdict, count)| format!("{count} {verdict}")).collect();
    talk.line(&format!("made       {} of {} · {}", library.scenarios.len(), library.count, words.join(" · ")));
    let again = library.scenarios.iter().filter(|row| row.repeats.is_some()).count();
    if again > 0 {
        talk.line(&format!("alike      {again} repeat an earlier proposal (P-DUP); the request leaves little open"));
    }
    talk.line(&format!("look       {}", root.join("report.html").display()));
    talk.line(&format!("next       {}", crate::next::after_batch(root, &library)));
    let whole = realised == library.count;
    talk.result(&json!({
        "bundle": root.display().to_string(), "verdict": if whole { "realised" } else { "mixed" }, "stages": [], "metrics": {},
        "reading": library.readings, "scenarios": library.scenarios, "verdicts": verdicts,
        "refused": refused.iter().map(Refused::object).collect::<Vec<_>>(),
    }));
    Ok(if options.require == "any" || whole { Code::Ok } else { Code::NotRealised })
}
