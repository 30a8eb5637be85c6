//! Several scenarios in one folder: made in one go, then written, listed and counted together.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use socrates_model::wire::ScenarioStatus;

use crate::args::{Cli, RunOptions};
use crate::config::Config;
use crate::exit::{Code, Complaint};
use crate::place::{self, Place};
use crate::prepare::{Prepared, scenario_id};
use crate::progress::Progress;
use crate::run::{Refused, conclude, print_reading};
use crate::session::{Made, Wanted, make};
use crate::talk::Talk;
use crate::{bundle, library};

/// Makes every scenario of these requests in one folder, whose list and page are written at the end.
pub(crate) async fn batch(
    talk: &Talk,
    cli: &Cli,
    config: &Config,
    options: &RunOptions,
    mut prepared: Vec<Prepared>,
    refused: &[Refused],
) -> Result<Code, Complaint> {
    let names = distinct(prepared.iter().map(|one| one.name.as_str()));
    prepared.iter_mut().zip(names).for_each(|(one, name)| one.name = name);
    let count: u64 = prepared.iter().map(|one| u64::from(one.request.run.variants)).sum();
    let base = options.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("library-{}", options.seed)));
    let wishes: Vec<String> =
        prepared.iter().map(|one| format!("{} {}", bundle::wish(one, options.seed), one.name)).collect();
    let wish = socrates_model::Digest::of(wishes.join("\n").as_bytes());
    let root = match place::place(&base, wish) {
        Place::Finished(root) => {
            talk.line(&format!("known      {} was made from these requests; nothing to do", root.display()));
            return library::finish(talk, options, &root, refused);
        }
        Place::New(root) => place::told(talk, &base, root),
    };
    crate::authors::check(config, prepared.iter().map(|one| one.author.as_str())).await?;
    let work = place::claim(&root, wish)?;
    for one in &prepared {
        talk.line(&format!("request    {:<26}author  {}", one.name, one.author_note));
        print_reading(talk, one);
    }
    let wanted = wanted(&prepared, options.seed)?;
    let made = make(talk, &cli.flags, config, options, &work, &wanted, wanted.len()).await?;
    let rows = rows(talk, &root, &wanted, &made);
    let readings = prepared.iter().map(|one| one.reading.clone()).collect();
    library::write(&root, &library::Library { wish, count, readings, scenarios: rows })?;
    if let Err(why) = crate::batch::write(talk, &root)?.figures {
        talk.warn(&why.what);
    }
    // The work folder is only needed to resume.
    drop(std::fs::remove_dir_all(&work));
    library::finish(talk, options, &root, refused)
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

/// Every scenario of these requests, with its id and seed.
fn wanted(prepared: &[Prepared], seed: u64) -> Result<Vec<Wanted<'_>>, Complaint> {
    let mut wanted = Vec::new();
    for one in prepared {
        for index in 0..one.request.run.variants {
            let id = scenario_id(&one.name, seed, index, one.request.run.variants)?;
            wanted.push(Wanted { id, seed: seed + u64::from(index), prepared: one });
        }
    }
    Ok(wanted)
}

/// Writes the bundles that are not there yet, and the list of all.
fn rows(talk: &Talk, root: &Path, wanted: &[Wanted<'_>], made: &Made) -> Vec<library::Row> {
    let mut rows = Vec::new();
    let mut repeats = library::Repeats::default();
    let mut progress = Progress::new(*talk, "writing", made.statuses.len());
    for (index, status) in made.statuses.iter().enumerate() {
        progress.at(index, "");
        let Some(want) = wanted.iter().find(|want| want.id == status.id) else { continue };
        let dir = root.join(want.id.as_str());
        let (verdict, repeats, reason) = match written(&dir, want, status, made) {
            Ok((verdict, proposal)) => (verdict.to_string(), repeats.of(&want.id, &proposal), String::new()),
            Err(why) => {
                let reason = why.short();
                let earlier = repeats.of_failed(&want.id, &want.prepared.name, &reason);
                match &earlier {
                    Some(first) => talk.warn(&format!("{}: failed as `{first}` did", want.id)),
                    None => talk.warn(&format!("{}: {why}", want.id)),
                }
                (crate::index::FAILED.to_owned(), earlier, reason)
            }
        };
        let request = want.prepared.name.clone();
        let bundle = dir.display().to_string();
        rows.push(library::Row { scenario: want.id.clone(), request, bundle, verdict, reason, repeats });
    }
    rows
}

/// The bundle of one scenario, written unless it lies there: its verdict and its proposal.
fn written(
    dir: &Path,
    want: &Wanted<'_>,
    status: &ScenarioStatus,
    made: &Made,
) -> Result<(socrates_model::Verdict, socrates_model::Proposal), Complaint> {
    let known = bundle::manifest(dir).filter(|manifest| manifest.wish == bundle::wish(want.prepared, want.seed));
    let bundle = match known {
        Some(_) => bundle::read_some(dir, |_, _| false)?,
        None => conclude(dir, want.prepared, want.seed, status, made)?,
    };
    Ok((bundle.manifest.verdict, bundle.proposal))
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
