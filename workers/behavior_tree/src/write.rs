//! Trees as XML, in either version.

use quick_xml::escape::escape;

use crate::blackboard::read_flag;
use crate::parse::{Document, GUARDS};
use crate::sheet::{Library, NodeSheet};
use crate::tree::Format;
use crate::xml::Element;

/// Writes the trees of the document itself; included files stay includes.
pub(crate) fn write(document: &Document, format: Format) -> String {
    Writer { from: document.format, to: format, library: None }.document(document)
}

/// The same for the simulators of a library: other names are used where they have others, and ports that they do not
/// have are left out.
pub(crate) fn write_for(document: &Document, format: Format, library: Library) -> String {
    Writer { from: document.format, to: format, library: Some(library) }.document(document)
}

struct Writer {
    from: Format,
    to: Format,
    library: Option<Library>,
}

impl Writer {
    fn document(&self, document: &Document) -> String {
        let main = attribute(&document.main);
        let mut text = match self.to {
            Format::V3 => format!("<root main_tree_to_execute=\"{main}\">\n"),
            Format::V4 => format!("<root BTCPP_format=\"4\" main_tree_to_execute=\"{main}\">\n"),
        };
        for include in &document.includes {
            text.push_str(&format!("  <include path=\"{}\"/>\n", attribute(include)));
        }
        for tree in document.trees.iter().filter(|tree| tree.root.site.file.is_empty()) {
            text.push_str(&format!("  <BehaviorTree ID=\"{}\">\n", attribute(&tree.id)));
            self.element(&tree.root, 2, &mut text);
            text.push_str("  </BehaviorTree>\n");
        }
        text.push_str("</root>\n");
        text
    }

    /// Elements are nested at most [`crate::xml::MAX_DEPTH`] deep.
    fn element(&self, it: &Element, depth: usize, text: &mut String) {
        let indent = "  ".repeat(depth);
        let sheet = crate::nodes::sheet_of(&it.tag);
        let tag = self.tag(it, sheet);
        let theirs = self.library.and_then(|library| crate::nodes::sheet_in(tag, library));
        let is_subtree = matches!(it.tag.as_str(), "SubTree" | "SubTreePlus");
        text.push_str(&format!("{indent}<{tag}"));
        for (name, value) in &it.attrs {
            let (name, value) = if is_subtree {
                self.subtree_attr(&it.tag, name, value)
            } else {
                (port_name(sheet, name, self.to).to_owned(), value.clone())
            };
            let is_guard = GUARDS.contains(&name.as_str());
            let is_port = !is_subtree && !is_guard && !matches!(name.as_str(), "name" | "_uid" | "_description");
            let is_lost = (self.to == Format::V3 && is_guard)
                || (is_port && theirs.is_some_and(|sheet| !sheet.ports.iter().any(|port| port.is_called(&name))));
            if !is_lost {
                text.push_str(&format!(" {name}=\"{}\"", attribute(&value)));
            }
        }
        if it.children.is_empty() {
            text.push_str("/>\n");
        } else {
            text.push_str(">\n");
            for child in &it.children {
                self.element(child, depth + 1, text);
            }
            text.push_str(&format!("{indent}</{tag}>\n"));
        }
    }

    fn tag<'a>(&self, it: &'a Element, sheet: Option<&'static NodeSheet>) -> &'a str {
        let Some(sheet) = sheet else { return &it.tag };
        if let Some(other) = self.library.and_then(|library| crate::nodes::alias(sheet.tag, library)) {
            return other;
        }
        match (sheet.tag, self.from, self.to) {
            ("SubTreePlus", _, Format::V4) => "SubTree",
            // A version 4 subtree with constants is what version 3 calls SubTreePlus.
            ("SubTree", Format::V4, Format::V3) => "SubTreePlus",
            (tag, _, Format::V3) => sheet.v3_tag.unwrap_or(tag),
            (tag, _, Format::V4) => tag,
        }
    }

    /// Hand-overs of a subtree: plain names in version 3, braces in `SubTreePlus` and version 4.
    fn subtree_attr(&self, tag: &str, name: &str, value: &str) -> (String, String) {
        let own = (name.to_owned(), value.to_owned());
        if self.from == self.to || matches!(name, "ID" | "name") {
            return own;
        }
        match (self.from, name) {
            // Sharing the whole blackboard is, seen from inside, a hand-over of every entry.
            (Format::V3, "__autoremap" | "__shared_blackboard") => ("_autoremap".to_owned(), truth(value).to_owned()),
            (Format::V4, "_autoremap") => ("__autoremap".to_owned(), truth(value).to_owned()),
            (Format::V3, _) if tag == "SubTree" => (name.to_owned(), format!("{{{value}}}")),
            (Format::V3 | Format::V4, _) => own,
        }
    }
}

fn truth(value: &str) -> &'static str {
    if read_flag(value) == Some(true) { "true" } else { "false" }
}

/// The text of an attribute. Breaks and tabs are written as references, or a reader would take them for blanks.
fn attribute(text: &str) -> String {
    let escaped = escape(text);
    escaped.replace('\n', "&#10;").replace('\r', "&#13;").replace('\t', "&#9;")
}

fn port_name<'a>(sheet: Option<&'static NodeSheet>, name: &'a str, to: Format) -> &'a str {
    let port = sheet.and_then(|sheet| {
        sheet.ports.iter().find(|port| port.v4_name.is_some() && (port.name == name || port.v4_name == Some(name)))
    });
    match (port, to) {
        (Some(port), Format::V3) => port.name,
        (Some(port), Format::V4) => port.v4_name.unwrap_or(port.name),
        (None, _) => name,
    }
}
