//! Trees as text.

use crate::draw::{own_name, title};
use crate::tree::{Node, Tree};

/// The tree as lines, one node each, with its name and ports; branches hang on connectors as in `tree(1)`.
///
/// ```
/// # use socrates_bt::{Tree, draw_text};
/// let tree = Tree::parse(
///     "<root main_tree_to_execute='T'><BehaviorTree ID='T'><Inverter><RobotMoved agent_id='{id}'/></Inverter></BehaviorTree></root>",
/// )?;
/// assert_eq!(draw_text(&tree), "T (v3, 2 nodes)\n└─ Inverter\n   └─ RobotMoved agent_id={id}\n");
/// # Ok::<(), Vec<socrates_model::Fault>>(())
/// ```
#[must_use]
pub fn draw_text(tree: &Tree) -> String {
    let n = tree.nodes.len();
    let noun = if n == 1 { "node" } else { "nodes" };
    let mut text = format!("{} ({}, {n} {noun})\n", tree.document.main, tree.format.name());
    // Indents of the nodes still to be drawn, the next one last.
    let mut open: Vec<(usize, String, bool)> = vec![(0, String::new(), true)];
    while let Some((index, indent, is_last)) = open.pop() {
        let Some(node) = tree.nodes.get(index) else { continue };
        text.push_str(&indent);
        text.push_str(if is_last { "└─ " } else { "├─ " });
        line(node, &mut text);
        let inner = indent + if is_last { "   " } else { "│  " };
        for (place, child) in node.children.iter().enumerate().rev() {
            open.push((*child, inner.clone(), place + 1 == node.children.len()));
        }
    }
    text
}

fn line(node: &Node, text: &mut String) {
    text.push_str(title(node));
    if let Some(name) = own_name(node) {
        text.push_str(&format!(" `{name}`"));
    }
    for (name, value) in &node.attrs {
        let needs_quotes = value.is_empty() || value.contains(|c: char| c.is_whitespace() || c == '"');
        let value = value.replace(['\n', '\r', '\t'], " ");
        if needs_quotes {
            text.push_str(&format!(" {name}=\"{value}\""));
        } else {
            text.push_str(&format!(" {name}={value}"));
        }
    }
    text.push('\n');
}
