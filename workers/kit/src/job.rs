//! One job as a stage sees it.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use serde::de::DeserializeOwned;
use socrates_link::{Bus, MemoryBus};
use socrates_model::job::JobSpec;
use socrates_model::wire::Grant;
use socrates_model::{FailureClass, Fault, FaultCode, Role, Where};

use crate::cancel::Cancel;
use crate::stage::Failure;

/// A job with its inputs fetched.
pub struct Job {
    pub(crate) grant: Grant,
    pub(crate) inputs: BTreeMap<Role, Vec<u8>>,
    pub(crate) refused: Option<String>,
    pub(crate) cancel: Cancel,
    pub(crate) characters: Arc<AtomicU64>,
    pub(crate) live: Arc<dyn Bus>,
}

impl Job {
    /// A job outside of any worker: for tests and for stages run in one process.
    #[must_use]
    pub fn detached(spec: JobSpec, inputs: BTreeMap<Role, Vec<u8>>) -> Self {
        let idem_key = spec.idem_key("detached");
        let (inline, traceparent) = (BTreeMap::new(), None);
        let (lease_ms, deadline_ms) = (15_000, 600_000);
        let grant = Grant { spec, attempt: 1, fence: 1, lease_ms, deadline_ms, idem_key, inline, traceparent };
        Self {
            grant,
            inputs,
            refused: None,
            cancel: Cancel::new(),
            characters: Arc::default(),
            live: Arc::new(MemoryBus::new()),
        }
    }

    /// What is to be done.
    #[must_use]
    pub const fn spec(&self) -> &JobSpec {
        &self.grant.spec
    }

    /// The grant: attempt, fence, limits.
    #[must_use]
    pub const fn grant(&self) -> &Grant {
        &self.grant
    }

    /// A setting of the job, such as `pace`.
    #[must_use]
    pub fn setting(&self, name: &str) -> Option<&str> {
        self.grant.spec.settings.get(name).map(String::as_str)
    }

    /// Whether the job has this input.
    #[must_use]
    pub fn has(&self, role: Role) -> bool {
        self.inputs.contains_key(&role)
    }

    /// The bytes of an input.
    ///
    /// # Errors
    /// A poison [`Failure`] (`J-SPEC`) when the job has no such input.
    pub fn bytes(&self, role: Role) -> Result<&[u8], Failure> {
        self.inputs.get(&role).map(Vec::as_slice).ok_or_else(|| {
            let there: Vec<&str> = self.inputs.keys().map(|role| role.name()).collect();
            self.poison(role, &format!("input `{role}` is missing; the job has {there:?}"))
        })
    }

    /// The text of an input.
    ///
    /// # Errors
    /// As [`Job::bytes`], also when it is not UTF-8.
    pub fn text(&self, role: Role) -> Result<&str, Failure> {
        std::str::from_utf8(self.bytes(role)?)
            .map_err(|why| self.poison(role, &format!("input `{role}` is not text: {why}")))
    }

    /// An input read from JSON.
    ///
    /// # Errors
    /// As [`Job::bytes`], also when it is not JSON of this type.
    pub fn json<T: DeserializeOwned>(&self, role: Role) -> Result<T, Failure> {
        serde_json::from_slice(self.bytes(role)?)
            .map_err(|why| self.poison(role, &format!("input `{role}` cannot be read: {why}")))
    }

    /// An input read from JSON, if the job has it.
    ///
    /// # Errors
    /// As [`Job::json`], but not for a missing input.
    pub fn json_if_there<T: DeserializeOwned>(&self, role: Role) -> Result<Option<T>, Failure> {
        if self.has(role) { self.json(role).map(Some) } else { Ok(None) }
    }

    /// The newest refused answer, for the author.
    #[must_use]
    pub fn refused(&self) -> Option<&str> {
        self.refused.as_deref()
    }

    /// The cancel token.
    #[must_use]
    pub const fn cancel(&self) -> &Cancel {
        &self.cancel
    }

    /// Says how many characters an author has written so far; told with the next beat.
    pub fn hears(&self) -> impl Fn(u64) + Send + Sync + use<> {
        let characters = Arc::clone(&self.characters);
        move |count| characters.store(count, Ordering::Relaxed)
    }

    /// The bus for live streams; never the one that carries jobs where the worker has two.
    #[must_use]
    pub fn live_bus(&self) -> Arc<dyn Bus> {
        Arc::clone(&self.live)
    }

    fn poison(&self, role: Role, message: &str) -> Failure {
        let at = Where::key(format_args!("{} {role}", self.grant.spec.key));
        Failure::new(FailureClass::Poison, vec![Fault::new(FaultCode::JSpec, at, message)])
    }
}
