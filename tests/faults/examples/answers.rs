//! `E-`: answers that are none.

use socrates_author::FaultKind;
use socrates_model::job::Stage;
use socrates_model::{Family, FaultCode};

use super::{Examples, injected, keep};

pub(super) async fn examples() -> Examples {
    let mut all =
        injected(Stage::Paths, |kind: FaultKind| kind.code().family() == Family::Answer && !kind.is_of_server()).await;
    let said = socrates_prompts::json::object(r#"{"cannot": "the map has no elevator"}"#).unwrap_err();
    keep(&mut all, said);
    let large = format!("{{\"a\": \"{}\"}}", "x".repeat(socrates_prompts::json::MAX_ANSWER_BYTES));
    let large = socrates_prompts::json::object(&large).unwrap_err();
    keep(&mut all, large.into_iter().filter(|fault| fault.code == FaultCode::TOversize));
    all
}
