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
use crate::key::strike_shapes;

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
    /// By what its recorder knows it, such as the version of the question; none in recordings of before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    note: Option<String>,
}

/// The recording that is most like a request without one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Nearest {
    /// Its key.
    pub key: String,
    /// Members in which the requests differ; turns by their number.
    pub differs: Vec<String>,
    /// The note that was kept with it; none in recordings of before.
    pub note: Option<String>,
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

    /// Keeps an exchange with a note, in place of an earlier one with the same request.
    ///
    /// # Errors
    /// [`CassetteError::File`] when it cannot be written.
    pub fn keep(&self, request: &ChatRequest, answer: &ChatAnswer, note: Option<&str>) -> Result<(), CassetteError> {
        let key = Self::key(request);
        let path = self.place(&key);
        let at = |source| CassetteError::File { path: path.clone(), source };
        let exchange = Exchange {
            format: FORMAT,
            key: key.clone(),
            request: canonical(request),
            answer: answer.clone(),
            note: note.map(str::to_owned),
        };
        let text = serde_json::to_string_pretty(&exchange)
            .map_err(|error| CassetteError::Broken { path: path.clone(), why: error.to_string() })?;
        // Neither a request nor an answer should hold a key; a person's text or a server's echo may.
        let text = strike_shapes(&text);
        let folder = path.parent().map_or_else(|| self.folder.clone(), Path::to_path_buf);
        fs::create_dir_all(&folder).map_err(at)?;
        let draft = folder.join(format!(".{key}.{}", std::process::id()));
        fs::write(&draft, text + "\n").map_err(at)?;
        fs::rename(&draft, &path).map_err(at)
    }

    /// The recorded request that is most like this one. For messages about a miss.
    #[must_use]
    pub fn nearest(&self, request: &ChatRequest) -> Option<Nearest> {
        let wanted = canonical(request);
        let mut best: Option<Nearest> = None;
        for path in self.files() {
            let Some(exchange) = fs::read(path).ok().and_then(|bytes| serde_json::from_slice::<Exchange>(&bytes).ok())
            else {
                continue;
            };
            let differs = differing(&exchange.request, &wanted);
            if best.as_ref().is_none_or(|fewest| differs.len() < fewest.differs.len()) {
                best = Some(Nearest { key: exchange.key, differs, note: exchange.note });
            }
        }
        best
    }

    /// Number of recorded exchanges; 0 where the folder is missing.
    #[must_use]
    pub fn len(&self) -> usize {
        self.files().len()
    }

    /// Whether nothing is recorded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Every recording, in order of the keys.
    fn files(&self) -> Vec<PathBuf> {
        let inside = |folder: &Path| -> Vec<PathBuf> {
            let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
            entries.map(|entry| entry.path()).collect()
        };
        let mut files: Vec<PathBuf> = inside(&self.folder)
            .iter()
            .flat_map(|folder| inside(folder))
            .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
            .collect();
        files.sort();
        files
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
        "grammar": request.grammar,
        "detail": request.detail,
        "seed": request.seed,
        "temperature": request.temperature,
        "max_tokens": request.max_tokens,
    })
}

/// Names of the members in which two requests differ; turns by their number.
fn differing(one: &Value, other: &Value) -> Vec<String> {
    let mut names = Vec::new();
    let Some(members) = other.as_object() else { return names };
    for (name, member) in members.iter().filter(|(name, member)| one.get(name.as_str()) != Some(member)) {
        match (one.get(name).and_then(Value::as_array), member.as_array()) {
            (Some(before), Some(now)) if before.len() == now.len() => {
                let turns = before.iter().zip(now).enumerate().filter(|(_, (a, b))| a != b);
                names.extend(turns.map(|(index, _)| format!("{name}[{index}]")));
            }
            _ => names.push(name.clone()),
        }
    }
    names
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
            grammar: None,
            detail: crate::chat::Detail::High,
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
            cached: 0,
            thought: 0,
            estimated: false,
            rung: None,
            steps: Vec::new(),
            without_picture: false,
            limits: None,
        }
    }

    #[test]
    fn what_is_kept_is_found_byte_for_byte_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let cassette = Cassette::at(folder.path().join("tape"));
        assert!(cassette.is_empty() && cassette.find(&request("a")).unwrap().is_none());
        cassette.keep(&request("a"), &answer(), Some("of a test")).unwrap();
        assert_eq!(cassette.find(&request("a")).unwrap(), Some(answer()));
        assert_eq!(cassette.find(&request("b")).unwrap(), None);
        assert_eq!(cassette.len(), 1);
    }

    #[test]
    fn a_miss_is_told_what_differs_from_the_nearest_recording() {
        let folder = tempfile::tempdir().unwrap();
        let cassette = Cassette::at(folder.path());
        assert_eq!(cassette.nearest(&request("a")), None);
        cassette.keep(&request("a"), &answer(), Some("of a test")).unwrap();
        let other = ChatRequest { seed: Some(9), ..request("b") };
        let Nearest { key, differs, note } = cassette.nearest(&other).unwrap();
        assert_eq!(note.as_deref(), Some("of a test"));
        assert_eq!((key, differs), (Cassette::key(&request("a")), vec!["seed".to_owned(), "turns[0]".to_owned()]));
    }

    #[test]
    fn no_key_is_recorded() {
        let folder = tempfile::tempdir().unwrap();
        let cassette = Cassette::at(folder.path());
        let secret = "sk-ant-REDACTED";
        let told = ChatAnswer { text: format!("{{\"a\": \"{secret}\"}}"), ..answer() };
        cassette.keep(&request(&format!("my key is {secret}")), &told, None).unwrap();
        let text = fs::read_to_string(&cassette.files()[0]).unwrap();
        assert!(!text.contains("abc123DEF"), "{text}");
        // The key of the exchange is that of the request as it was asked.
        assert!(cassette.find(&request(&format!("my key is {secret}"))).unwrap().is_some());
    }

    #[test]
    fn a_broken_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let cassette = Cassette::at(folder.path());
        cassette.keep(&request("a"), &answer(), Some("of a test")).unwrap();
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
