//! Recordings of exchanges, replayed byte for byte.
//!
//! One file per exchange, `<folder>/<first 2 hex>/<key>.json`, where the key is the BLAKE3 of the request. Files are
//! written beside their place and renamed, so that many recorders may share a folder. The model is not part of
//! the key: keep one folder per model.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::chat::{ChatAnswer, ChatRequest};

/// Format of the files.
const FORMAT: u32 = 1;

/// Why a recording could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum CassetteError {
    /// The file could not be read or written.
    #[error("`{path}` could not be used")]
    File {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is not a recording.
    #[error("`{path}` is not a recorded exchange: {why}")]
    Broken {
        /// Which file.
        path: PathBuf,
        /// Why.
        why: String,
    },
}

/// A folder of recorded exchanges.
#[derive(Debug, Clone)]
pub struct Cassette {
    folder: PathBuf,
}

/// One file.
#[derive(Serialize, Deserialize)]
struct Exchange {
    format: u32,
    key: String,
    request: Value,
    answer: ChatAnswer,
}

impl Cassette {
    /// The recordings in this folder; it need not exist before the first one is kept.
    #[must_use]
    pub fn at(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into() }
    }

    /// The key of a request: BLAKE3 of its canonical JSON (sorted members, pictures as digests), 64 hex digits.
    #[must_use]
    pub fn key(request: &ChatRequest) -> String {
        blake3::hash(canonical(request).to_string().as_bytes()).to_hex().to_string()
    }

    /// The recorded answer to this request, if there is one.
    ///
    /// # Errors
    /// [`CassetteError`] when the file is there but cannot be read.
    pub fn find(&self, request: &ChatRequest) -> Result<Option<ChatAnswer>, CassetteError> {
        let path = self.place(&Self::key(request));
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(CassetteError::File { path, source }),
        };
        let exchange: Exchange = serde_json::from_slice(&bytes)
            .map_err(|error| CassetteError::Broken { path: path.clone(), why: error.to_string() })?;
        if exchange.format > FORMAT {
            return Err(CassetteError::Broken {
                path,
                why: format!("its format {} is newer than {FORMAT}", exchange.format),
            });
        }
        Ok(Some(exchange.answer))
    }

    /// Keeps an exchange, in place of an earlier one with the same request.
    ///
    /// # Errors
    /// [`CassetteError::File`] when it cannot be written.
    pub fn keep(&self, request: &ChatRequest, answer: &ChatAnswer) -> Result<(), CassetteError> {
        let key = Self::key(request);
        let path = self.place(&key);
        let at = |source| CassetteError::File { path: path.clone(), source };
        let exchange =
            Exchange { format: FORMAT, key: key.clone(), request: canonical(request), answer: answer.clone() };
        let text = serde_json::to_string_pretty(&exchange)
            .map_err(|error| CassetteError::Broken { path: path.clone(), why: error.to_string() })?;
        let folder = path.parent().map_or_else(|| self.folder.clone(), Path::to_path_buf);
        fs::create_dir_all(&folder).map_err(at)?;
        let draft = folder.join(format!(".{key}.{}", std::process::id()));
        fs::write(&draft, text + "\n").map_err(at)?;
        fs::rename(&draft, &path).map_err(at)
    }

    /// Number of recorded exchanges; 0 where the folder is missing.
    #[must_use]
    pub fn len(&self) -> usize {
        let files =
            |folder: &Path| fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok).collect::<Vec<_>>();
        files(&self.folder)
            .iter()
            .flat_map(|entry| files(&entry.path()))
            .filter(|entry| entry.path().extension().is_some_and(|ending| ending == "json"))
            .count()
    }

    /// Whether nothing is recorded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn place(&self, key: &str) -> PathBuf {
        self.folder.join(key.get(..2).unwrap_or("__")).join(format!("{key}.json"))
    }
}

/// The request with pictures as digests; members are sorted by `serde_json`'s map.
fn canonical(request: &ChatRequest) -> Value {
    let turns: Vec<Value> = request
        .turns
        .iter()
        .map(|turn| {
            let picture = turn.png.as_ref().map(|png| blake3::hash(png).to_hex().to_string());
            json!({"speaker": turn.speaker, "text": turn.text, "picture": picture})
        })
        .collect();
    json!({
        "format": FORMAT,
        "turns": turns,
        "form": request.form,
        "schema": request.schema,
        "seed": request.seed,
        "temperature": request.temperature,
        "max_tokens": request.max_tokens,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chat::{Finish, Speaker, Turn};

    fn request(text: &str) -> ChatRequest {
        let turn = Turn { speaker: Speaker::User, text: text.into(), png: Some(vec![0; 10]) };
        ChatRequest {
            turns: vec![turn],
            form: "f".into(),
            schema: None,
            seed: Some(3),
            temperature: Some(0.5),
            max_tokens: 9,
        }
    }

    fn answer() -> ChatAnswer {
        ChatAnswer {
            text: "{\"a\": \"ü\\n\"}".into(),
            finish: Finish::Stop,
            model: "m".into(),
            tokens: (1, 2),
            estimated: false,
        }
    }

    #[test]
    fn what_is_kept_is_found_byte_for_byte_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let cassette = Cassette::at(folder.path().join("tape"));
        assert!(cassette.is_empty() && cassette.find(&request("a")).unwrap().is_none());
        cassette.keep(&request("a"), &answer()).unwrap();
        assert_eq!(cassette.find(&request("a")).unwrap(), Some(answer()));
        assert_eq!(cassette.find(&request("b")).unwrap(), None);
        assert_eq!(cassette.len(), 1);
    }

    #[test]
    fn a_broken_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let cassette = Cassette::at(folder.path());
        cassette.keep(&request("a"), &answer()).unwrap();
        fs::write(cassette.place(&Cassette::key(&request("a"))), "{").unwrap();
        assert!(matches!(cassette.find(&request("a")), Err(CassetteError::Broken { .. })));
    }

    #[test]
    fn every_part_of_the_request_is_in_the_key() {
        let base = request("a");
        let mut others = vec![request("b"), base.clone(), base.clone(), base.clone()];
        others[1].seed = Some(4);
        others[2].schema = Some(json!({}));
        others[3].turns[0].png = Some(vec![1; 10]);
        for other in others {
            assert_ne!(Cassette::key(&base), Cassette::key(&other));
        }
    }
}
