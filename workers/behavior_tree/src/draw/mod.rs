//! Trees as drawings: text for a terminal, SVG for a page. Subtrees are drawn unfolded, as they run.

mod svg;
mod text;

pub use svg::draw_svg;
pub use text::draw_text;

use crate::sheet::{Kind, NodeSheet};
use crate::tree::Node;

/// What a box or line says of a node.
fn title(node: &Node) -> &str {
    node.document_tag()
}

/// The name, where it says more than the tag. The name of a subtree in version 3 is its tree, which its ID tells.
fn own_name(node: &Node) -> Option<&str> {
    let told = node.name == title(node) || node.attrs.iter().any(|(name, value)| name == "ID" && *value == node.name);
    (!told).then_some(node.name.as_str())
}

/// Whether a node runs another tree.
fn is_subtree(sheet: &NodeSheet) -> bool {
    matches!(sheet.tag, "SubTree" | "SubTreePlus")
}

/// Word for the kind of a node in legends.
fn kind_word(sheet: &NodeSheet) -> &'static str {
    match sheet.kind {
        Kind::Decorator if is_subtree(sheet) => "subtree",
        Kind::Control | Kind::Decorator | Kind::Condition | Kind::Action => sheet.kind.name(),
    }
}
