//! Why there is no answer.

/// What a server objects to when it rejects a request, as far as the body of its answer tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objection {
    /// The form that the answer was to have: a schema, a grammar or a tool. The same question in a simpler form may be taken.
    Form,
    /// The picture that came with the question.
    Picture,
    /// That the answer was to come in parts.
    Stream,
    /// The model that was asked.
    Model,
    /// It does not say.
    Unsaid,
    /// Nothing: it took the request, and failed at the answer.
    Nothing,
}

/// Why a request got no answer. Messages hold no address and no key.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChatError {
    /// The server could not be reached, or the connection broke.
    #[error("the server could not be reached: {why}")]
    Unreachable {
        /// The transport's own words.
        why: String,
    },
    /// Nothing came from the server for as long as it may be silent.
    #[error("nothing came from the server within {limit_ms} ms")]
    Timeout {
        /// How long it may be silent, ms.
        limit_ms: u64,
    },
    /// Something came all the time, and no whole answer within the time of a call.
    #[error("no whole answer within {limit_ms} ms")]
    Late {
        /// The time of a call, ms.
        limit_ms: u64,
    },
    /// An answer that came in parts ended before it was whole.
    #[error("the answer broke off after {characters} characters: {why}")]
    Broken {
        /// Characters that had come.
        characters: u64,
        /// What ended it.
        why: String,
    },
    /// The server asks to slow down (429, 529).
    #[error("the server asks to slow down (status {status}): {why}")]
    SlowDown {
        /// HTTP status.
        status: u16,
        /// How long it wants us to wait, ms, capped at two minutes.
        retry_after_ms: Option<u64>,
        /// Its words.
        why: String,
    },
    /// The server failed (5xx, 408, 409).
    #[error("the server failed (status {status}): {why}")]
    Server {
        /// HTTP status.
        status: u16,
        /// How long it wants us to wait, ms.
        retry_after_ms: Option<u64>,
        /// What it objects to, where it fails at something that it does not know.
        to: Objection,
        /// Its words.
        why: String,
    },
    /// The key is missing, wrong, or has nothing left to spend (401, 403, exhausted quota).
    #[error("the server refuses the key (status {status}): {why}")]
    Key {
        /// HTTP status.
        status: u16,
        /// Its words.
        why: String,
    },
    /// The server will never take this request (400, 404, 413, 422): wrong model or form.
    #[error("the server rejects the request (status {status}): {why}")]
    Rejected {
        /// HTTP status.
        status: u16,
        /// What it objects to.
        to: Objection,
        /// Its words.
        why: String,
    },
    /// The answer is larger than is read.
    #[error("the answer is larger than {most} bytes")]
    TooLarge {
        /// Bytes that are read.
        most: usize,
    },
    /// The model will not answer.
    #[error("the model refuses to answer: {why}")]
    Refused {
        /// Its words.
        why: String,
    },
    /// The server's envelope is not of the agreed form.
    #[error("the server's answer has not the agreed form: {why}")]
    Unreadable {
        /// What was wrong.
        why: String,
    },
    /// The client cannot be set up as configured.
    #[error("the client cannot be set up: {why}")]
    Setup {
        /// What was wrong.
        why: String,
    },
}
