//! `B-`: trees that do not do what they should.

use socrates_model::Family;
use socrates_model::job::Stage;

use super::{Examples, injected};

pub(super) async fn examples() -> Examples {
    injected(Stage::Behaviors, |kind| kind.code().family() == Family::Behaviors).await
}
