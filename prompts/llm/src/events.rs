//! Server-sent events: how an answer comes in parts.
//!
//! Lines `event: NAME` and `data: TEXT`, an empty line after each event; a line that begins with a colon is a sign of life. Other
//! lines are told apart from these and refused: a server that breaks off into a page of words is not to be taken for one that is
//! still thinking.

use crate::error::ChatError;

/// Characters of a line that are shown where it cannot be read.
const SHOWN: usize = 80;

/// One event.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Event {
    /// Whether it is called an error; what other names say stands in the text as well.
    pub(crate) is_error: bool,
    /// Its text.
    pub(crate) data: String,
}

/// Reads events out of bytes, in whatever pieces these come.
#[derive(Debug)]
pub(crate) struct Events {
    /// What came of a line that has not ended.
    line: Vec<u8>,
    next: Event,
    /// Whether the event has a text, be it an empty one.
    begun: bool,
    /// Lines so far.
    lines: u64,
    /// Bytes of an event at most.
    most: usize,
}

impl Events {
    /// Of which none may be larger than this, bytes.
    pub(crate) fn new(most: usize) -> Self {
        Self { line: Vec::new(), next: Event::default(), begun: false, lines: 0, most }
    }

    /// Takes the next bytes; gives the events that they end.
    ///
    /// # Errors
    /// [`ChatError::TooLarge`], and [`ChatError::Unreadable`] for a line that belongs to no event.
    pub(crate) fn take(&mut self, bytes: &[u8]) -> Result<Vec<Event>, ChatError> {
        let mut found = Vec::new();
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            if self.line.len() + self.next.data.len() + piece.len() > self.most {
                return Err(ChatError::TooLarge { most: self.most });
            }
            self.line.extend_from_slice(piece);
            if piece.ends_with(b"\n") {
                let line = std::mem::take(&mut self.line);
                found.extend(self.line(&line)?);
            }
        }
        Ok(found)
    }

    /// What the end of the bytes ends: an event whose empty line did not come any more.
    ///
    /// # Errors
    /// As [`Events::take`].
    pub(crate) fn end(mut self) -> Result<Option<Event>, ChatError> {
        let line = std::mem::take(&mut self.line);
        let last = if line.is_empty() { None } else { self.line(&line)? };
        Ok(last.or_else(|| self.begun.then_some(self.next)))
    }

    fn line(&mut self, bytes: &[u8]) -> Result<Option<Event>, ChatError> {
        self.lines += 1;
        let text = String::from_utf8_lossy(bytes);
        let line = text.trim_end_matches(['\r', '\n']);
        let line = if self.lines == 1 { line.trim_start_matches('\u{feff}') } else { line };
        if line.is_empty() {
            let ended = std::mem::take(&mut self.next);
            return Ok(std::mem::take(&mut self.begun).then_some(ended));
        }
        let (field, value) = line.split_once(':').unwrap_or((line, ""));
        let value = value.strip_prefix(' ').unwrap_or(value);
        match field {
            "data" => {
                if std::mem::replace(&mut self.begun, true) {
                    self.next.data.push('\n');
                }
                self.next.data.push_str(value);
            }
            "event" => self.next.is_error = value == "error",
            "" | "id" | "retry" => {}
            _ => {
                let shown: String = line.chars().filter(|c| !c.is_control()).take(SHOWN).collect();
                let why = format!("line {} of the stream is no part of an event: `{shown}`", self.lines);
                return Err(ChatError::Unreadable { why });
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(pieces: &[&[u8]]) -> Result<Vec<(bool, String)>, ChatError> {
        let mut events = Events::new(100);
        let mut found = Vec::new();
        for piece in pieces {
            found.extend(events.take(piece)?);
        }
        found.extend(events.end()?);
        Ok(found.into_iter().map(|event| (event.is_error, event.data)).collect())
    }

    #[test]
    fn events_are_the_same_in_whatever_pieces_they_come() {
        let text =
            "\u{feff}event: error\r\ndata: {\"x\": \"ü\"}\r\n\r\n: alive\n\nid: 3\ndata:one\ndata: two\n\ndata: [DONE]"
                .as_bytes();
        let wanted = [(true, "{\"x\": \"ü\"}"), (false, "one\ntwo"), (false, "[DONE]")];
        let wanted = wanted.map(|(is_error, data)| (is_error, data.to_owned()));
        assert_eq!(read(&[text]).unwrap(), wanted);
        let bytes: Vec<&[u8]> = text.chunks(1).collect();
        assert_eq!(read(&bytes).unwrap(), wanted);
    }

    #[test]
    fn a_line_of_no_event_is_named_and_an_endless_one_is_left() {
        let told = read(&[b"data: {}\n\n<html>busy</html>\n"]).unwrap_err().to_string();
        assert!(told.contains("line 3") && told.contains("<html>busy"), "{told}");
        assert!(read(&[b"{\"error\": \"x\"}\n"]).is_err());
        assert_eq!(read(&[&[b'x'; 101]]), Err(ChatError::TooLarge { most: 100 }));
        let lines = "data: 0123456789\n".repeat(20);
        assert_eq!(read(&[lines.as_bytes()]), Err(ChatError::TooLarge { most: 100 }));
        assert_eq!(read(&[b""]), Ok(Vec::new()));
    }
}
