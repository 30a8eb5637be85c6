//! What a bundle is written from besides the artifacts of its jobs: stored with the scenarios of a cluster, so that whoever collects
//! them needs neither the request files nor the machine that submitted them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use socrates_model::wire::ScenarioSpec;
use socrates_model::{AuthorSpec, Digest, FORMAT};

use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::prepare::Prepared;

/// The part of a [`Prepared`] request that its scenarios do not name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Order {
    /// Format number.
    format: u32,
    /// What the whole batch is made from.
    pub(crate) library: Digest,
    /// Name of the request.
    pub(crate) name: String,
    author: AuthorSpec,
    author_note: String,
    location_files: BTreeMap<String, Digest>,
    #[serde(default)]
    injected: BTreeMap<String, String>,
    #[serde(default)]
    style: BTreeMap<String, String>,
    keep_answers: bool,
}

/// Where contents are read from by their digests.
pub(crate) type Get<'a> = dyn Fn(&Digest) -> Result<Vec<u8>, Diagnostic> + 'a;

impl Order {
    /// The order of a request in a batch. `put` stores a content.
    pub(crate) fn of(
        prepared: &Prepared,
        library: Digest,
        put: &dyn Fn(&[u8]) -> Result<Digest, Diagnostic>,
    ) -> Result<Self, Diagnostic> {
        let file = |(name, bytes): (&String, &Vec<u8>)| Ok((name.clone(), put(bytes)?));
        Ok(Self {
            format: FORMAT,
            library,
            name: prepared.name.clone(),
            author: prepared.author.clone(),
            author_note: prepared.author_note.clone(),
            location_files: prepared.location_files.iter().map(file).collect::<Result<_, Diagnostic>>()?,
            injected: prepared.injected.clone(),
            style: prepared.style.clone(),
            keep_answers: prepared.keep_answers,
        })
    }

    /// The order as it is stored.
    pub(crate) fn text(&self) -> Result<String, Diagnostic> {
        serde_json::to_string(self).map_err(|why| Diagnostic::input(why.to_string(), "").with_code(Code::Ours))
    }

    /// Contents that it names.
    pub(crate) fn contents(&self) -> impl Iterator<Item = Digest> {
        self.location_files.values().copied()
    }

    /// The order that a scenario was submitted with.
    ///
    /// # Errors
    /// When there is none, it cannot be read, or it is of a newer program.
    pub(crate) fn read(spec: &ScenarioSpec, get: &Get<'_>) -> Result<Self, Diagnostic> {
        let digest = spec.order.ok_or_else(|| {
            Diagnostic::input(
                format!("scenario `{}` was submitted without what its bundle is written from", spec.id),
                "`socrates cluster submit` of this version hands it over; `socrates run` writes its bundles itself",
            )
        })?;
        let order: Self = parsed(&spec.id.to_string(), "order", &get(&digest)?)?;
        if order.format > FORMAT {
            let what = format!("the order of `{}` has format {}; this program knows {FORMAT}", spec.id, order.format);
            return Err(Diagnostic::input(what, "collect with the version that submitted it"));
        }
        Ok(order)
    }

    /// The prepared request that the scenario is made from.
    pub(crate) fn prepared(self, spec: &ScenarioSpec, get: &Get<'_>, config: &Config) -> Result<Prepared, Diagnostic> {
        let id = spec.id.to_string();
        let file = |(name, digest): (String, Digest)| Ok((plain(&id, name)?, get(&digest)?));
        let pins = spec.pinned.iter().map(|(role, digest)| {
            let text =
                String::from_utf8(get(digest)?).map_err(|why| damaged(&id, &role.to_string(), &why.to_string()))?;
            Ok((*role, text))
        });
        Ok(Prepared {
            name: self.name,
            file: None,
            request: parsed(&id, "request", &get(&spec.request)?)?,
            location: parsed(&id, "location", &get(&spec.location)?)?,
            location_files: self.location_files.into_iter().map(file).collect::<Result<_, Diagnostic>>()?,
            reading: parsed(&id, "reading", &get(&spec.reading)?)?,
            pins: pins.collect::<Result<_, Diagnostic>>()?,
            injected: self.injected,
            style: self.style,
            notes: Vec::new(),
            looked_at: spec.review,
            build: config.program().build.clone(),
            keep_answers: self.keep_answers,
            author: self.author,
            author_note: self.author_note,
        })
    }
}

/// A name without folders: it becomes a file of the bundle.
fn plain(id: &str, name: String) -> Result<String, Diagnostic> {
    let inside = !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\', '\0']);
    if inside { Ok(name) } else { Err(damaged(id, "order", &format!("`{name}` is no name of a file"))) }
}

fn parsed<T: serde::de::DeserializeOwned>(id: &str, what: &str, bytes: &[u8]) -> Result<T, Diagnostic> {
    serde_json::from_slice(bytes).map_err(|why| damaged(id, what, &why.to_string()))
}

fn damaged(id: &str, what: &str, why: &str) -> Diagnostic {
    Diagnostic::input(
        format!("the {what} of `{id}` cannot be read: {why}"),
        "it was submitted by another program, or is damaged",
    )
}
