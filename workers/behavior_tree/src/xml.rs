//! XML elements with their places; the only file that knows the XML reader.

use std::collections::BTreeSet;
use std::fmt;

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;
use socrates_model::{Fault, FaultCode, Where};

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

impl From<&Site> for Where {
    fn from(site: &Site) -> Self {
        let at = if site.file.is_empty() { Self::default() } else { Self::file(&site.file) };
        at.line(site.line).column(site.column)
    }
}

impl fmt::Display for Site {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Where::from(self).fmt(f)
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
    pub(crate) fn at(&self) -> Where {
        let (at, tag) = (Where::from(&self.site), short_text(&self.tag));
        match self.attr("name") {
            Some(name) => at.at_key(format_args!("{tag} `{}`", short_text(name))),
            None => at.at_key(tag),
        }
    }
}

/// Turns byte offsets into places. Offsets mostly grow, so that a document is walked once.
struct Lines<'a> {
    file: &'a str,
    text: &'a str,
    offset: usize,
    line: usize,
    column: usize,
}

impl<'a> Lines<'a> {
    const fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, text, offset: 0, line: 1, column: 1 }
    }

    fn site(&mut self, offset: u64) -> Site {
        let offset = usize::try_from(offset).unwrap_or(usize::MAX).min(self.text.len());
        if offset < self.offset {
            *self = Self::new(self.file, self.text);
        }
        for letter in self.text.get(self.offset..).unwrap_or("").chars() {
            if self.offset >= offset {
                break;
            }
            self.offset += letter.len_utf8();
            if letter == '\n' {
                self.line += 1;
                self.column = 1;
            } else {
                self.column += 1;
            }
        }
        Site { file: self.file.to_owned(), line: self.line, column: self.column }
    }
}

/// A text for a message: cut where it is long.
pub(crate) fn short_text(text: &str) -> String {
    const MOST: usize = 80;
    if text.chars().nth(MOST).is_none() {
        return text.to_owned();
    }
    text.chars().take(MOST).chain(std::iter::once('…')).collect()
}

/// The text of a file: UTF-8, with or without a byte order mark.
///
/// # Errors
/// `B-XML` for another encoding, with the line and column of the first byte that is none.
pub fn decode(bytes: &[u8]) -> Result<&str, Fault> {
    let at = |line: usize, column: usize| Site { file: String::new(), line, column };
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(broken(&at(1, 1), "the file is in UTF-16; allowed: UTF-8"));
    }
    std::str::from_utf8(bytes).map_err(|why| {
        let good = bytes.get(..why.valid_up_to()).and_then(|good| std::str::from_utf8(good).ok()).unwrap_or("");
        let site = Lines::new("", good).site(good.len() as u64);
        let byte = bytes.get(why.valid_up_to()).copied().unwrap_or(0);
        broken(&site, format!("the byte `0x{byte:02x}` is not UTF-8; save the file in UTF-8"))
    })
}

fn broken(site: &Site, message: impl Into<String>) -> Fault {
    Fault::new(FaultCode::BXml, site, message)
}

/// Reads a document to its root element. `file` names an include and is empty for the document itself.
pub(crate) fn read(file: &str, text: &str) -> Result<Element, Fault> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = Lines::new(file, text);
    if text.len() > MAX_BYTES {
        let message = format!("the document has `{}` bytes; allowed: at most {MAX_BYTES}", text.len());
        return Err(broken(&lines.site(0), message));
    }
    let mut reader = Reader::from_str(text);
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
                    format!("the entity `&{};`; allowed: &lt; &gt; &amp; &quot; &apos;", short_text(&name)),
                ));
            }
            Event::Decl(declaration) => {
                if let Some(Ok(encoding)) = declaration.encoding()
                    && !["utf-8", "utf8", "us-ascii", "ascii"].contains(&encoding.to_lowercase().as_str())
                {
                    let message = format!("the encoding `{}` is declared; allowed: UTF-8", short_text(&encoding));
                    return Err(broken(&site, message));
                }
            }
            Event::Text(_) | Event::CData(_) | Event::Comment(_) | Event::PI(_) | Event::GeneralRef(_) => {}
            Event::Eof => break,
        }
    }
    if let Some(element) = open.last() {
        return Err(broken(&element.site, format!("`<{}>` is never closed", short_text(&element.tag))));
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
    let mut names: BTreeSet<String> = BTreeSet::new();
    // The reader would compare every name with every other one.
    for attr in start.attributes().with_checks(false) {
        let attr = attr.map_err(|error| broken(&site, format!("not well-formed XML: {error}")))?;
        let name = attr.key.0.to_owned();
        let value = attr
            .normalized_value(XmlVersion::Implicit1_0)
            .map_err(|error| broken(&site, format!("attribute `{}`: {error}", short_text(&name))))?;
        if !names.insert(name.clone()) {
            let message =
                format!("`{}` has the attribute `{}` twice; allowed: once", start.name().0, short_text(&name));
            return Err(broken(&site, message));
        }
        attrs.push((name, value.into_owned()));
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
        assert!(fault.at.to_string().starts_with("3:"), "{fault}");
    }

    #[test]
    fn places_count_letters_and_a_byte_order_mark_is_none() {
        let fault = read("", "\u{feff}<root>\n<a b='äöü'/><c\n").unwrap_err();
        assert!(fault.at.to_string().starts_with("2:13") || fault.at.to_string().starts_with("3:1"), "{fault}");
        assert_eq!(read("", "\u{feff}<root>\n<!-- äöü --><a/></root>").unwrap().children[0].site.column, 13);
    }

    #[test]
    fn other_encodings_are_refused_with_their_place() {
        assert_eq!(decode(b"<a/>").unwrap(), "<a/>");
        assert!(decode(b"<a>\n\xe4").unwrap_err().at.to_string().starts_with("2:1"));
        assert!(decode(&[0xff, 0xfe, b'<', 0]).unwrap_err().message.to_string().contains("UTF-16"));
        let latin = "<?xml version='1.0' encoding='ISO-8859-1'?><a/>";
        assert!(read("", latin).unwrap_err().message.to_string().contains("ISO-8859-1"));
    }

    #[test]
    fn an_attribute_that_stands_twice_is_named() {
        assert!(read("", "<a b='1' c='2' b='3'/>").unwrap_err().message.to_string().contains("attribute `b` twice"));
    }

    #[test]
    fn definitions_and_entities_of_the_document_are_refused() {
        let bomb = "<!DOCTYPE r [<!ENTITY a \"b\">]><root x=\"&a;\"/>";
        assert!(read("", bomb).unwrap_err().message.to_string().contains("type definition"));
        assert!(read("", "<root x=\"&a;\"/>").is_err());
        assert!(read("", "<root>&a;</root>").is_err());
        assert_eq!(read("", "<root x=\"&lt;1\"/>").unwrap().attr("x"), Some("<1"));
    }

    #[test]
    fn too_deep_and_too_large_documents_are_refused() {
        let deep = "<a>".repeat(MAX_DEPTH + 2);
        assert!(read("", &deep).unwrap_err().message.to_string().contains("deeper"));
        let large = " ".repeat(MAX_BYTES + 1);
        assert!(read("", &large).unwrap_err().message.to_string().contains("bytes"));
    }

    #[test]
    fn an_unfinished_element_is_refused() {
        assert!(read("", "<root><a/>").is_err());
        assert!(read("", "").is_err());
        assert!(read("", "<a/><b/>").is_err());
    }
}
