//! Several scenarios in one folder: made in one go, each written when it is done, and listed and counted together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;
use socrates_model::{Digest, ScenarioEnd, ScenarioId, Verdict};

use crate::bundler::{Bundled, Bundler};
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::keep::{self, Keep};
use crate::kept::Lines;
use crate::output::Printer;
use crate::place::{self, Place};
use crate::prepare::Prepared;
use crate::reading::print_reading;
use crate::refused::Refused;
use crate::run_options::{Require, RunOptions};
use crate::session::Making;
use crate::shard::Shard;
use crate::wanted::{Wanted, wanted};
use crate::words::plural;
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
) -> Result<Library, Diagnostic> {
    told_apart(&mut prepared);
    let base = base(options);
    let (wish, part) = wish(&prepared, options);
    let root = match place::place(&base, wish, prepared.iter().any(Prepared::is_driven)) {
        Place::Finished(root) => {
            keep::agreed(&root, place::fixed(&root), options.keep)?;
            talk.line(&format!("known      {} was made from these requests; nothing to do", root.display()));
            let code = finish(talk, options.require, &root, refused)?;
            return Ok(Library { root, code });
        }
        Place::New(root) => place::told(talk, &base, root),
    };
    let fixed = keep::agreed(&root, place::fixed(&root), options.keep)?;
    crate::authors::check(config, prepared.iter().filter_map(Prepared::asked)).await?;
    let work = place::claim(&root, wish)?;
    for one in &prepared {
        talk.line(&format!("request    {:<26}author  {}", one.name, one.author_note));
        print_reading(talk, one);
    }
    let prepared: Vec<Arc<Prepared>> = prepared.into_iter().map(Arc::new).collect();
    let plans = variants::plans(talk, prepared.iter().map(AsRef::as_ref), options.seed, options.repeats)?;
    let wanted = wanted(&prepared, options.seed, &plans)?;
    // Shards keep what one run would.
    let keep = fixed.unwrap_or_else(|| Keep::of(wanted.len()));
    place::fix(&work, keep)?;
    let wanted = shared(talk, options.shard, wanted);
    let mut bundler = Bundler::start(&root, &work, keep, &wanted, &prepared);
    // Until the last bundle is written, nobody else makes them. Of more shards than scenarios some are empty.
    let making = Making { talk, config, options, work: &work, wanted: &wanted };
    let _hold = if wanted.is_empty() { None } else { Some(making.bundled(&mut bundler).await?) };
    let made = ended(&wanted, bundler.finish(talk).await?);
    let readings = prepared.iter().map(|one| one.reading.clone()).collect();
    let list = library_index::Library::new(wish, part, Some(keep), wanted.len(), readings);
    write(talk, &root, &work, list, made)?;
    // The work folder is only needed to resume.
    drop(std::fs::remove_dir_all(&work));
    let code = finish(talk, options.require, &root, refused)?;
    Ok(Library { root, code })
}

/// The folder of a library where nothing else stands in it.
pub(crate) fn base(options: &RunOptions) -> PathBuf {
    let share = options.shard.map_or_else(String::new, |shard| format!("-{}-of-{}", shard.index(), shard.of()));
    let own = || PathBuf::from("runs").join(format!("library-{}{share}", options.seed));
    options.out.clone().unwrap_or_else(own)
}

/// The share of these scenarios that is made.
pub(crate) fn shared<'a>(talk: &Printer, shard: Option<Shard>, mut wanted: Vec<Wanted<'a>>) -> Vec<Wanted<'a>> {
    if let Some(shard) = shard {
        let whole = wanted.len();
        let mut place = 0..whole;
        wanted.retain(|_| place.next().is_some_and(|place| shard.holds(place)));
        talk.line(&format!("shard      {shard} · {} of {}", wanted.len(), plural(whole, "scenario")));
    }
    wanted
}

/// What a folder is made from, and of which batch it is a share. With other options another folder is taken.
pub(crate) fn wish(prepared: &[Prepared], options: &RunOptions) -> (Digest, Option<library_index::Part>) {
    let chosen = if options.repeats { " repeats" } else { "" };
    let wishes: Vec<String> =
        prepared.iter().map(|one| format!("{} {}{chosen}", bundle::wish(one, options.seed), one.name)).collect();
    let whole = Digest::of(wishes.join("\n").as_bytes());
    match options.shard {
        Some(shard) => {
            (Digest::of(format!("{whole} shard {shard}").as_bytes()), Some(library_index::Part { shard, whole }))
        }
        None => (whole, None),
    }
}

/// Gives every request a name of its own.
pub(crate) fn told_apart(prepared: &mut [Prepared]) {
    let names = distinct(prepared.iter().map(|one| one.name.as_str()));
    prepared.iter_mut().zip(names).for_each(|(one, name)| one.name = name);
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

/// A scenario of a library: which, of which request, and what became of it: the card of its bundle, or why there is none.
#[derive(Debug)]
pub(crate) struct Ended {
    /// Which.
    pub(crate) scenario: ScenarioId,
    /// Name of its request.
    pub(crate) request: String,
    /// What became of it.
    pub(crate) what: Bundled,
}

/// What became of the scenarios, in their order. Those of which nothing is known are left out.
fn ended(wanted: &[Wanted<'_>], mut bundled: BTreeMap<ScenarioId, Bundled>) -> Vec<Ended> {
    let one = |want: &Wanted<'_>| {
        let what = bundled.remove(&want.id)?;
        Some(Ended { scenario: want.id.clone(), request: want.prepared.name.clone(), what })
    };
    wanted.iter().filter_map(one).collect()
}

/// Writes the list, the page and the tables of a folder whose bundles are written. The list is filled with the scenarios, which stand
/// in their order. `work`: its work folder, with the lines of scenarios whose bundles are not kept.
pub(crate) fn write(
    talk: &Printer,
    root: &Path,
    work: &Path,
    mut list: library_index::Library,
    made: Vec<Ended>,
) -> Result<(), Diagnostic> {
    let mut cards = BTreeMap::new();
    let mut repeats = library_index::Repeats::default();
    for Ended { scenario, request, what } in made {
        let (verdict, repeats, reason, bundle) = match what {
            Ok(card) => {
                let earlier = repeats.of(&scenario, card.likeness.clone());
                let (verdict, bundle) = (ScenarioEnd::Judged(card.verdict), card.lies());
                // The others are read from the file of the library, one at a time.
                if !bundle.is_empty() {
                    cards.insert(scenario.to_string(), card);
                }
                (verdict, earlier, String::new(), bundle)
            }
            Err(why) => {
                let reason = why.short();
                let earlier = repeats.of_failed(&scenario, &request, &reason);
                match &earlier {
                    Some(first) => talk.warn(&format!("{scenario}: failed as `{first}` did")),
                    None => talk.warn(&format!("{scenario}: {why}")),
                }
                (ScenarioEnd::Failed, earlier, reason, scenario.to_string())
            }
        };
        list.scenarios.push(library_index::Row { scenario, request, bundle, verdict, reason, repeats });
    }
    let kept = list.scenarios.iter().filter(|row| row.bundle.is_empty());
    Lines::of(work).assemble(root, kept.map(|row| &row.scenario))?;
    library_index::write(root, &list)?;
    if list.scenarios.is_empty() {
        return Ok(());
    }
    if let Err(why) = crate::batch::write(talk, root, cards)?.figures {
        talk.warn(&why.what);
    }
    Ok(())
}

/// Prints what a library holds.
pub(crate) fn finish(talk: &Printer, require: Require, root: &Path, refused: &[Refused]) -> Result<Code, Diagnostic> {
    let library = library_index::read(root).ok_or_else(|| {
        Diagnostic::input(format!("`{}` has no {}", root.display(), library_index::FILE), "run the same command again")
    })?;
    let mut verdicts = BTreeMap::<ScenarioEnd, u64>::new();
    library.scenarios.iter().for_each(|row| *verdicts.entry(row.verdict).or_default() += 1);
    for line in library.told() {
        talk.line(&line);
    }
    if !library.scenarios.is_empty() {
        talk.line(&format!("table      {}", root.join(index::FILE).display()));
        talk.line(&format!("look       {}", root.join(layout::PAGE.path).display()));
    }
    talk.line(&format!("next       {}", next::after_batch(root, &library)));
    let whole = verdicts.get(&ScenarioEnd::Judged(Verdict::Realised)).copied().unwrap_or(0) == library.count;
    let scenarios: Vec<library_index::Row> = library.scenarios.iter().map(|row| row.seen_from(root)).collect();
    talk.result(&json!({
        "bundle": root.display().to_string(), "verdict": if whole { "realised" } else { "mixed" }, "stages": [], "metrics": {},
        "reading": library.readings, "scenarios": scenarios, "verdicts": verdicts, "shard": library.shard.map(|part| part.shard),
        "distinct": library.distinct().count(), "index": root.join(index::FILE).display().to_string(),
        "refused": refused.iter().map(Refused::object).collect::<Vec<_>>(),
    }));
    Ok(if require.is_met(whole) { Code::Ok } else { Code::NotRealised })
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
