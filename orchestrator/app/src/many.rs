//! Several scenarios in one folder: made in one go, each written when it is done, and listed and counted together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;
use socrates_model::{ScenarioEnd, ScenarioId, Verdict};

use crate::batch::Card;
use crate::bundler::{Bundled, Bundler};
use crate::config::Config;
use crate::exit::{Code, Complaint};
use crate::output::Printer;
use crate::place::{self, Place};
use crate::prepare::Prepared;
use crate::reading::print_reading;
use crate::refused::Refused;
use crate::run_options::RunOptions;
use crate::session::Making;
use crate::wanted::{Wanted, wanted};
use crate::{bundle, index, layout, library_index, next, variants};

/// A folder of scenarios that was made.
#[derive(Debug)]
pub(crate) struct Library {
    /// The folder.
    pub(crate) root: PathBuf,
    /// The exit code.
    pub(crate) code: Code,
}

/// Makes every scenario of these requests in one folder, whose list and page are written at the end.
pub(crate) async fn batch(
    talk: &Printer,
    config: &Config,
    options: &RunOptions,
    mut prepared: Vec<Prepared>,
    refused: &[Refused],
) -> Result<Library, Complaint> {
    let names = distinct(prepared.iter().map(|one| one.name.as_str()));
    prepared.iter_mut().zip(names).for_each(|(one, name)| one.name = name);
    let base = options.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("library-{}", options.seed)));
    let chosen = if options.repeats { " repeats" } else { "" };
    let wishes: Vec<String> =
        prepared.iter().map(|one| format!("{} {}{chosen}", bundle::wish(one, options.seed), one.name)).collect();
    let wish = socrates_model::Digest::of(wishes.join("\n").as_bytes());
    let root = match place::place(&base, wish, prepared.iter().any(Prepared::is_driven)) {
        Place::Finished(root) => {
            talk.line(&format!("known      {} was made from these requests; nothing to do", root.display()));
            let code = finish(talk, options, &root, refused)?;
            return Ok(Library { root, code });
        }
        Place::New(root) => place::told(talk, &base, root),
    };
    crate::authors::check(config, prepared.iter().map(|one| &one.author)).await?;
    let work = place::claim(&root, wish)?;
    for one in &prepared {
        talk.line(&format!("request    {:<26}author  {}", one.name, one.author_note));
        print_reading(talk, one);
    }
    let prepared: Vec<Arc<Prepared>> = prepared.into_iter().map(Arc::new).collect();
    let plans = variants::plans(talk, prepared.iter().map(AsRef::as_ref), options.seed, options.repeats)?;
    let wanted = wanted(&prepared, options.seed, &plans)?;
    let count = u64::try_from(wanted.len()).unwrap_or(u64::MAX);
    let mut bundler = Bundler::start(&root, &work, &wanted, &prepared);
    // Until the last bundle is written, nobody else makes them.
    let _hold = Making { talk, config, options, work: &work, wanted: &wanted }.bundled(&mut bundler).await?;
    let (rows, cards) = rows(talk, &root, &wanted, bundler.finish(talk).await?);
    let readings = prepared.iter().map(|one| one.reading.clone()).collect();
    library_index::write(&root, &library_index::Library { wish, count, readings, scenarios: rows })?;
    if let Err(why) = crate::batch::write(talk, &root, cards)?.figures {
        talk.warn(&why.what);
    }
    // The work folder is only needed to resume.
    drop(std::fs::remove_dir_all(&work));
    let code = finish(talk, options, &root, refused)?;
    Ok(Library { root, code })
}

/// The names, of which those that an earlier one has already get a number.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut found = Vec::new();
    for name in names {
        let mut free = name.to_owned();
        for number in 2.. {
            if taken.insert(free.clone()) {
                break;
            }
            free = format!("{name}-{number}");
        }
        found.push(free);
    }
    found
}

/// The list of all scenarios, in order of submission, and the cards of those that have a bundle.
fn rows(
    talk: &Printer,
    root: &Path,
    wanted: &[Wanted<'_>],
    mut bundled: BTreeMap<ScenarioId, Bundled>,
) -> (Vec<library_index::Row>, BTreeMap<String, Card>) {
    let (mut rows, mut cards) = (Vec::new(), BTreeMap::new());
    let mut repeats = library_index::Repeats::default();
    for want in wanted {
        let Some(bundled) = bundled.remove(&want.id) else { continue };
        let dir = root.join(want.id.as_str());
        let (verdict, repeats, reason) = match bundled {
            Ok(card) => {
                let earlier = repeats.of(&want.id, card.likeness.clone());
                let verdict = ScenarioEnd::Judged(card.verdict);
                cards.insert(want.id.to_string(), card);
                (verdict, earlier, String::new())
            }
            Err(why) => {
                let reason = why.short();
                let earlier = repeats.of_failed(&want.id, &want.prepared.name, &reason);
                match &earlier {
                    Some(first) => talk.warn(&format!("{}: failed as `{first}` did", want.id)),
                    None => talk.warn(&format!("{}: {why}", want.id)),
                }
                (ScenarioEnd::Failed, earlier, reason)
            }
        };
        let request = want.prepared.name.clone();
        let bundle = dir.display().to_string();
        rows.push(library_index::Row { scenario: want.id.clone(), request, bundle, verdict, reason, repeats });
    }
    (rows, cards)
}

/// Prints what a library holds.
fn finish(talk: &Printer, options: &RunOptions, root: &Path, refused: &[Refused]) -> Result<Code, Complaint> {
    let library = library_index::read(root).ok_or_else(|| {
        Complaint::input(format!("`{}` has no {}", root.display(), library_index::FILE), "run the same command again")
    })?;
    let mut verdicts = BTreeMap::<ScenarioEnd, u64>::new();
    library.scenarios.iter().for_each(|row| *verdicts.entry(row.verdict).or_default() += 1);
    for line in library.told() {
        talk.line(&line);
    }
    talk.line(&format!("table      {}", root.join(index::FILE).display()));
    talk.line(&format!("look       {}", root.join(layout::PAGE.path).display()));
    talk.line(&format!("next       {}", next::after_batch(root, &library)));
    let whole = verdicts.get(&ScenarioEnd::Judged(Verdict::Realised)).copied().unwrap_or(0) == library.count;
    talk.result(&json!({
        "bundle": root.display().to_string(), "verdict": if whole { "realised" } else { "mixed" }, "stages": [], "metrics": {},
        "reading": library.readings, "scenarios": library.scenarios, "verdicts": verdicts,
        "distinct": library.distinct().count(), "index": root.join(index::FILE).display().to_string(),
        "refused": refused.iter().map(Refused::object).collect::<Vec<_>>(),
    }));
    Ok(if options.require.is_met(whole) { Code::Ok } else { Code::NotRealised })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_of_one_name_become_scenarios_of_different_names() {
        let names = ["x", "x-2", "x", "y", "x"];
        assert_eq!(distinct(names.into_iter()), ["x", "x-2", "x-3", "y", "x-4"]);
    }
}
