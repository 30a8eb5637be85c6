//! `AlwaysSuccess` and `AlwaysFailure`.

use crate::nodes::halt_leaf;
use crate::sheet::{Arity, Kind, Library, NodeSheet, Role};
use crate::status::Status;
use crate::tick::Ticker;

/// `AlwaysSuccess`.
pub(super) const SUCCESS: NodeSheet = NodeSheet {
    tag: "AlwaysSuccess",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[],
    about: "does nothing and succeeds",
    role: Role::Quiet,
    tick: tick_success,
    halt: halt_leaf,
};
/// `AlwaysFailure`.
pub(super) const FAILURE: NodeSheet = NodeSheet {
    tag: "AlwaysFailure",
    v3_tag: None,
    kind: Kind::Action,
    library: Library::BuiltIn,
    arity: Arity::NONE,
    ports: &[],
    about: "does nothing and fails",
    role: Role::Quiet,
    tick: tick_failure,
    halt: halt_leaf,
};

fn tick_success(_t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::Success
}

fn tick_failure(_t: &mut Ticker<'_>, _node: usize) -> Status {
    Status::Failure
}
