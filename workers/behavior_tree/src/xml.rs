//! XML elements with their places; the only file that knows the XML reader.

use std::fmt;

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;
use socrates_model::{Fault, FaultCode};

/// Largest document, bytes.
pub(crate) const MAX_BYTES: usize = 1 << 20;
/// Deepest element.
pub(crate) const MAX_DEPTH: usize = 64;

/// A place in a document.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Site {
    /// Included file, or empty for the document itself.
    pub(crate) file: String,
    /// Line, from 1.
    pub(crate) line: usize,
    /// Column, from 1.
    pub(crate) column: usize,
}

impl fmt::Display for Site {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.file.is_empty() {
            write!(f, "{} ", self.file)?;
        }
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// An element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Element {
    pub(crate) tag: String,
    pub(crate) attrs: Vec<(String, String)>,
    pub(crate) children: Vec<Element>,
    pub(crate) site: Site,
}

impl Element {
    /// Value of an attribute.
    pub(crate) fn attr(&self, name: &str) -> Option<&str> {
        self.attrs.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The short form of an element and all below it: `<Action ID="RegularNav" …/>` says the same as
    /// `<RegularNav …/>`.
    pub(crate) fn short(mut self) -> Self {
        if matches!(self.tag.as_str(), "Action" | "Condition" | "Control" | "Decorator")
            && let Some(place) = self.attrs.iter().position(|(name, _)| name == "ID")
        {
            let (_, id) = self.attrs.remove(place);
            self.tag = id;
        }
        self.children = self.children.into_iter().map(Self::short).collect();
        self
    }

    /// Place and tag, as faults give it.
    pub(crate) fn at(&self) -> String {
        match self.attr("name") {
            Some(name) => format!("{} {} `{name}`", self.site, self.tag),
            None => format!("{} {}", self.site, self.tag),
        }
    }
}

/// Starts of lines, to turn byte offsets into places.
struct Lines<'a> {
    file: &'a str,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn new(file: &'a str, text: &str) -> Self {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { file, starts }
    }

    fn site(&self, offset: u64) -> Site {
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        let line = self.starts.partition_point(|start| *start <= offset).max(1);
        let start = self.starts.get(line - 1).copied().unwrap_or(0);
        Site { file: self.file.to_owned(), line, column: offset - start.min(offset) + 1 }
    }
}

fn broken(site: &Site, message: impl Into<String>) -> Fault {
    Fault::new(FaultCode::BXml, site, message)
}

/// Reads a document to its root element. `file` names an include and is empty for the document itself.
pub(crate) fn read(file: &str, text: &str) -> Result<Element, Fault> {
    let lines = Lines::new(file, text);
    if text.len() > MAX_BYTES {
        let message = format!("the document has `{}` bytes; allowed: at most {MAX_BYTES}", text.len());
        return Err(broken(&lines.site(0), message));
    }
    let mut reader = Reader::from_str(text.strip_prefix('\u{feff}').unwrap_or(text));
    reader.config_mut().check_comments = false;
    let mut open: Vec<Element> = Vec::new();
    let mut root: Option<Element> = None;
    loop {
        let site = lines.site(reader.buffer_position());
        let event = match reader.read_event() {
            Ok(event) => event,
            Err(error) => {
                let at = lines.site(reader.error_position());
                return Err(broken(&at, format!("not well-formed XML: {error}")));
            }
        };
        match event {
            Event::Start(start) => {
                if root.is_some() && open.is_empty() {
                    return Err(broken(&site, "a second root element; allowed: one `root`"));
                }
                if open.len() >= MAX_DEPTH {
                    return Err(broken(&site, format!("deeper than {MAX_DEPTH} elements")));
                }
                open.push(element(&start, site)?);
            }
            Event::Empty(start) => {
                if root.is_some() && open.is_empty() {
                    return Err(broken(&site, "a second root element; allowed: one `root`"));
                }
                let element = element(&start, site)?;
                close(element, &mut open, &mut root);
            }
            Event::End(_) => {
                if let Some(element) = open.pop() {
                    close(element, &mut open, &mut root);
                }
            }
            Event::DocType(_) => return Err(broken(&site, "a document type definition; allowed: none")),
            Event::GeneralRef(name) if !is_plain_reference(&name) => {
                return Err(broken(
                    &site,
                    format!("the entity `&{};`; allowed: &lt; &gt; &amp; &quot; &apos;", &*name),
                ));
            }
            Event::Text(_)
            | Event::CData(_)
            | Event::Comment(_)
            | Event::Decl(_)
            | Event::PI(_)
            | Event::GeneralRef(_) => {}
            Event::Eof => break,
        }
    }
    if let Some(element) = open.last() {
        return Err(broken(&element.site, format!("`<{}>` is never closed", element.tag)));
    }
    root.ok_or_else(|| broken(&lines.site(0), "there is no element; allowed: one `root`"))
}

/// Texts, comments and processing instructions have no meaning in a tree and are passed over.
fn close(element: Element, open: &mut [Element], root: &mut Option<Element>) {
    match open.last_mut() {
        Some(parent) => parent.children.push(element),
        None => *root = Some(element),
    }
}

fn is_plain_reference(name: &str) -> bool {
    name.starts_with('#') || matches!(name, "lt" | "gt" | "amp" | "quot" | "apos")
}

fn element(start: &BytesStart<'_>, site: Site) -> Result<Element, Fault> {
    let mut attrs: Vec<(String, String)> = Vec::new();
    for attr in start.attributes() {
        let attr = attr.map_err(|error| broken(&site, format!("not well-formed XML: {error}")))?;
        let value = attr
            .normalized_value(XmlVersion::Implicit1_0)
            .map_err(|error| broken(&site, format!("attribute `{}`: {error}", attr.key.0)))?;
        attrs.push((attr.key.0.to_owned(), value.into_owned()));
    }
    let tag = start.name().0.to_owned();
    Ok(Element { tag, attrs, children: Vec::new(), site })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_document_is_refused_with_its_place() {
        let fault = read("", "<root>\n  <a>\n</root>").unwrap_err();
        assert_eq!(fault.code, FaultCode::BXml);
        assert!(fault.at.starts_with("3:"), "{fault}");
    }

    #[test]
    fn definitions_and_entities_of_the_document_are_refused() {
        let bomb = "<!DOCTYPE r [<!ENTITY a \"b\">]><root x=\"&a;\"/>";
        assert!(read("", bomb).unwrap_err().message.contains("type definition"));
        assert!(read("", "<root x=\"&a;\"/>").is_err());
        assert!(read("", "<root>&a;</root>").is_err());
        assert_eq!(read("", "<root x=\"&lt;1\"/>").unwrap().attr("x"), Some("<1"));
    }

    #[test]
    fn too_deep_and_too_large_documents_are_refused() {
        let deep = "<a>".repeat(MAX_DEPTH + 2);
        assert!(read("", &deep).unwrap_err().message.contains("deeper"));
        let large = " ".repeat(MAX_BYTES + 1);
        assert!(read("", &large).unwrap_err().message.contains("bytes"));
    }

    #[test]
    fn an_unfinished_element_is_refused() {
        assert!(read("", "<root><a/>").is_err());
        assert!(read("", "").is_err());
        assert!(read("", "<a/><b/>").is_err());
    }
}
