//! Trees as XML, in either version.

use quick_xml::escape::escape;

use crate::parse::Document;
use crate::sheet::NodeSheet;
use crate::tree::Format;
use crate::xml::Element;

/// Writes the trees of the document itself; included files stay includes.
pub(crate) fn write(document: &Document, format: Format) -> String {
    let mut text = match format {
        Format::V3 => format!("<root main_tree_to_execute=\"{}\">\n", escape(&document.main)),
        Format::V4 => format!("<root BTCPP_format=\"4\" main_tree_to_execute=\"{}\">\n", escape(&document.main)),
    };
    for include in &document.includes {
        text.push_str(&format!("  <include path=\"{}\"/>\n", escape(include)));
    }
    for tree in document.trees.iter().filter(|tree| tree.root.site.file.is_empty()) {
        text.push_str(&format!("  <BehaviorTree ID=\"{}\">\n", escape(&tree.id)));
        element(&tree.root, document.format, format, 2, &mut text);
        text.push_str("  </BehaviorTree>\n");
    }
    text.push_str("</root>\n");
    text
}

fn element(it: &Element, from: Format, to: Format, depth: usize, text: &mut String) {
    let indent = "  ".repeat(depth);
    let sheet = crate::nodes::sheet_of(&it.tag);
    let tag = match (sheet, to) {
        (Some(sheet), Format::V3) => sheet.v3_tag.unwrap_or(sheet.tag),
        (Some(sheet), Format::V4) if sheet.tag == "SubTreePlus" => "SubTree",
        (Some(sheet), Format::V4) => sheet.tag,
        (None, _) => it.tag.as_str(),
    };
    let is_subtree = matches!(it.tag.as_str(), "SubTree" | "SubTreePlus");
    // A version 4 subtree with constants is what version 3 calls SubTreePlus.
    let tag = if is_subtree && from == Format::V4 && to == Format::V3 { "SubTreePlus" } else { tag };
    text.push_str(&format!("{indent}<{tag}"));
    for (name, value) in &it.attrs {
        let (name, value) = if is_subtree {
            subtree_attr(&it.tag, name, value, from, to)
        } else {
            (port_name(sheet, name, to).to_owned(), value.clone())
        };
        text.push_str(&format!(" {name}=\"{}\"", escape(value.as_str())));
    }
    if it.children.is_empty() {
        text.push_str("/>\n");
    } else {
        text.push_str(">\n");
        for child in &it.children {
            element(child, from, to, depth + 1, text);
        }
        text.push_str(&format!("{indent}</{tag}>\n"));
    }
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

/// Hand-overs of a subtree: plain names in version 3, braces in `SubTreePlus` and version 4.
fn subtree_attr(tag: &str, name: &str, value: &str, from: Format, to: Format) -> (String, String) {
    let own = (name.to_owned(), value.to_owned());
    if from == to || matches!(name, "ID" | "name") {
        return own;
    }
    match (from, name) {
        (Format::V3, "__autoremap") => ("_autoremap".to_owned(), "true".to_owned()),
        // Sharing the whole blackboard is, seen from inside, a hand-over of every entry.
        (Format::V3, "__shared_blackboard") => ("_autoremap".to_owned(), value.to_owned()),
        (Format::V4, "_autoremap") => ("__autoremap".to_owned(), "1".to_owned()),
        (Format::V3, _) if tag == "SubTree" => (name.to_owned(), format!("{{{value}}}")),
        (Format::V3 | Format::V4, _) => own,
    }
}
