//! Tokens of a Rust source with their lines, comments among them, and which of them belong to tests.
//!
//! A parser forgets comments and needs seconds for the whole workspace; the house rules about lines and about English need
//! neither types nor expressions.

/// Kind of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A comment, one token a line of `//` or a whole `/* … */`; its text is without the marks.
    Comment,
    /// A string literal; its text is as written, without the quotes.
    Text,
    /// A name or keyword.
    Word,
    /// A number, character, byte or lifetime; its text is empty.
    Other,
    /// A single sign of punctuation.
    Sign(char),
}

/// A token.
#[derive(Debug, Clone)]
pub(crate) struct Token<'a> {
    /// Line where it begins, from 1.
    pub(crate) line: usize,
    /// Line where it ends.
    pub(crate) last: usize,
    /// Its kind.
    pub(crate) kind: Kind,
    /// Its text, as [`Kind`] says.
    pub(crate) text: &'a str,
    /// Whether it stands in an item for tests.
    pub(crate) tests: bool,
}

impl Token<'_> {
    fn is_word(&self, word: &str) -> bool {
        self.kind == Kind::Word && self.text == word
    }

    fn is_sign(&self, sign: char) -> bool {
        self.kind == Kind::Sign(sign)
    }
}

struct Cursor<'a> {
    text: &'a str,
    at: usize,
    line: usize,
}

impl<'a> Cursor<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn next(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Advances by this many bytes.
    fn skip(&mut self, bytes: usize) {
        let end = (self.at + bytes).min(self.text.len());
        self.line += self.text[self.at..end].bytes().filter(|byte| *byte == b'\n').count();
        self.at = end;
    }

    /// The length in bytes of a `/* … */` comment, nested ones included.
    fn block_comment(&self) -> usize {
        let (bytes, mut at, mut depth) = (self.rest().as_bytes(), 0, 0_usize);
        while at < bytes.len() {
            if bytes[at..].starts_with(b"/*") {
                (depth, at) = (depth + 1, at + 2);
            } else if bytes[at..].starts_with(b"*/") {
                (depth, at) = (depth.saturating_sub(1), at + 2);
                if depth == 0 {
                    break;
                }
            } else {
                at += 1;
            }
        }
        at
    }

    /// The bytes before the text of a string literal that begins here, its text's and those after it.
    fn string(&self) -> Option<(usize, usize, usize)> {
        let rest = self.rest();
        if !rest.starts_with(['"', 'b', 'c', 'r']) {
            return None;
        }
        let prefix = ["br", "cr", "b", "c", "r", ""].into_iter().find(|prefix| {
            rest.strip_prefix(prefix).is_some_and(|after| {
                after.starts_with('"') || prefix.ends_with('r') && after.trim_start_matches('#').starts_with('"')
            })
        })?;
        let after = &rest[prefix.len()..];
        if prefix.ends_with('r') {
            let hashes = after.len() - after.trim_start_matches('#').len();
            let end = format!("\"{}", "#".repeat(hashes));
            let begin = prefix.len() + hashes + 1;
            let length = rest[begin..].find(&end)?;
            return Some((begin, length, end.len()));
        }
        let (mut escaped, begin) = (false, prefix.len() + 1);
        let length = rest[begin..].bytes().position(|byte| {
            let ends = byte == b'"' && !escaped;
            escaped = byte == b'\\' && !escaped;
            ends
        })?;
        Some((begin, length, 1))
    }

    /// The length in bytes of a character or of a lifetime; the cursor is at its `'`.
    fn character_or_lifetime(&self) -> usize {
        let rest = &self.rest()[1..];
        let mut letters = rest.char_indices();
        let first = letters.next().map_or('\'', |(_, letter)| letter);
        if first == '\\' {
            return rest[2..].find('\'').map_or(rest.len(), |end| end + 4);
        }
        match letters.next() {
            Some((at, '\'')) => at + 2,
            _ => 1 + rest.find(|letter: char| !is_name(letter)).unwrap_or(rest.len()),
        }
    }
}

fn is_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// The tokens of a source.
pub(crate) fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut cursor = Cursor { text, at: 0, line: 1 };
    let mut found = Vec::new();
    while let Some(letter) = cursor.next() {
        if letter.is_whitespace() {
            let rest = cursor.rest();
            cursor.skip(rest.len() - rest.trim_start().len());
            continue;
        }
        let (line, rest) = (cursor.line, cursor.rest());
        let (kind, text, length) = if rest.starts_with("//") {
            let length = rest.find('\n').unwrap_or(rest.len());
            let text = rest[2..length].strip_prefix(['/', '!']).unwrap_or_else(|| &rest[2..length]);
            (Kind::Comment, text, length)
        } else if rest.starts_with("/*") {
            let length = cursor.block_comment();
            (Kind::Comment, rest[2..length].trim_end_matches("*/").trim_start_matches(['*', '!']), length)
        } else if let Some((before, length, after)) = cursor.string() {
            (Kind::Text, &rest[before..before + length], before + length + after)
        } else if rest.starts_with("b'") {
            cursor.skip(1);
            (Kind::Other, "", cursor.character_or_lifetime())
        } else if letter == '\'' {
            (Kind::Other, "", cursor.character_or_lifetime())
        } else if is_name(letter) {
            let length = rest.find(|letter: char| !is_name(letter)).unwrap_or(rest.len());
            let number = letter.is_ascii_digit();
            (if number { Kind::Other } else { Kind::Word }, if number { "" } else { &rest[..length] }, length)
        } else {
            (Kind::Sign(letter), "", letter.len_utf8())
        };
        cursor.skip(length);
        found.push(Token { line, last: cursor.line, kind, text, tests: false });
    }
    mark_tests(&mut found);
    found
}

/// Whether an attribute, from after its `[` to its `]`, keeps what it stands on for tests.
fn is_for_tests(attribute: &[&Token<'_>]) -> bool {
    let path: Vec<&&Token<'_>> =
        attribute.iter().take_while(|token| token.kind == Kind::Word || token.is_sign(':')).collect();
    if path.len() == 1 && path[0].is_word("cfg") {
        let has = |word: &str| attribute.iter().any(|token| token.is_word(word));
        return has("test") && !has("not") && !has("any");
    }
    path.last().is_some_and(|last| last.is_word("test"))
}

/// Marks every token that stands in an item for tests, its attributes and comments included.
fn mark_tests(tokens: &mut [Token<'_>]) {
    for (from, to) in spans_of_tests(tokens) {
        // Comments after the item belong to the next one.
        let to = (from..to).rev().find(|index| tokens[*index].kind != Kind::Comment).map_or(from, |last| last + 1);
        tokens[from..to].iter_mut().for_each(|token| token.tests = true);
    }
}

/// First token and the one after the last of each item for tests.
fn spans_of_tests(tokens: &[Token<'_>]) -> Vec<(usize, usize)> {
    let code: Vec<(usize, &Token<'_>)> =
        tokens.iter().enumerate().filter(|(_, token)| token.kind != Kind::Comment).collect();
    let (mut spans, mut at) = (Vec::new(), 0);
    while at < code.len() {
        let begin = at;
        let mut tests = false;
        while let Some((after, whole, of)) = attribute(&code, at) {
            if whole && of {
                return vec![(0, tokens.len())];
            }
            (tests, at) = (tests || of, after);
        }
        if tests {
            at = item_end(&code, at);
            spans.push((first_of(tokens, code[begin].0), code.get(at).map_or(tokens.len(), |(index, _)| *index)));
        } else if at == begin {
            at += 1;
        }
    }
    spans
}

/// The first of the comments right before this token, or the token itself.
fn first_of(tokens: &[Token<'_>], index: usize) -> usize {
    (0..index).rev().take_while(|before| tokens[*before].kind == Kind::Comment).last().unwrap_or(index)
}

/// The attribute that begins here: the place after it, whether it is of the whole file or module, whether it is for tests.
fn attribute(code: &[(usize, &Token<'_>)], at: usize) -> Option<(usize, bool, bool)> {
    let sign = |at: usize, sign: char| code.get(at).is_some_and(|(_, token)| token.is_sign(sign));
    let inner = sign(at + 1, '!');
    let open = at + 1 + usize::from(inner);
    if !sign(at, '#') || !sign(open, '[') {
        return None;
    }
    let mut depth = 0_usize;
    let close = (open..code.len()).find(|place| {
        depth += usize::from(sign(*place, '['));
        depth -= usize::from(sign(*place, ']'));
        depth == 0
    })?;
    let inside: Vec<&Token<'_>> = code[open + 1..close].iter().map(|(_, token)| *token).collect();
    Some((close + 1, inner, is_for_tests(&inside)))
}

/// The place after the item, field, variant or arm that begins here.
fn item_end(code: &[(usize, &Token<'_>)], at: usize) -> usize {
    const ITEMS: [&str; 14] = [
        "pub",
        "fn",
        "mod",
        "struct",
        "impl",
        "enum",
        "trait",
        "async",
        "unsafe",
        "extern",
        "macro_rules",
        "type",
        "union",
        "use",
    ];
    const TO_SEMICOLON: [&str; 5] = ["use", "const", "static", "let", "type"];
    let mut depth = 0_usize;
    let (mut item, mut semicolon) = (false, false);
    for place in at..code.len() {
        let (_, token) = code[place];
        match token.kind {
            Kind::Word if depth == 0 && place < at + 8 && !semicolon => {
                item |= ITEMS.contains(&token.text);
                let function = code.get(place + 1).is_some_and(|(_, next)| next.is_word("fn"));
                semicolon |= TO_SEMICOLON.contains(&token.text) && !function && !item_of_block(&code[at..place]);
            }
            Kind::Sign('(' | '[' | '{') => depth += 1,
            Kind::Sign(')' | ']' | '}') if depth == 0 => return place,
            Kind::Sign(')' | ']') => depth -= 1,
            Kind::Sign('}') => {
                depth -= 1;
                if depth == 0 && !semicolon {
                    return place + 1;
                }
            }
            Kind::Sign(';') if depth == 0 => return place + 1,
            Kind::Sign(',') if depth == 0 && !item && !semicolon => return place + 1,
            Kind::Comment | Kind::Text | Kind::Word | Kind::Other | Kind::Sign(_) => {}
        }
    }
    code.len()
}

/// Whether an item that ends with a block was named already.
fn item_of_block(before: &[(usize, &Token<'_>)]) -> bool {
    const BLOCKS: [&str; 6] = ["fn", "mod", "struct", "impl", "enum", "trait"];
    before.iter().any(|(_, token)| BLOCKS.iter().any(|word| token.is_word(word)))
}

/// Modules in files of their own that only tests have, each with the path that an attribute gives.
pub(crate) fn test_modules<'a>(tokens: &[Token<'a>]) -> Vec<(&'a str, Option<&'a str>)> {
    let code: Vec<(usize, &Token<'a>)> =
        tokens.iter().enumerate().filter(|(_, token)| token.kind != Kind::Comment).collect();
    let mut found = Vec::new();
    for (place, window) in code.windows(3).enumerate() {
        let [(_, word), (_, name), (_, end)] = window else { continue };
        if word.tests && word.is_word("mod") && name.kind == Kind::Word && end.is_sign(';') {
            // `#[path = "…"]`: the text stands right before its `]`, within the attributes of the module.
            let attributes = code[..place].iter().rev().take_while(|(_, token)| token.tests);
            let before: Vec<&Token<'a>> = attributes.map(|(_, token)| *token).take(24).collect();
            let since: Vec<&&Token<'a>> =
                before.iter().take_while(|token| !token.is_sign(';') && !token.is_sign('}')).collect();
            let path = since.windows(3).find(|near| near[0].kind == Kind::Text && near[2].is_word("path"));
            found.push((name.text, path.map(|near| near[0].text)));
        }
    }
    found
}

#[test]
fn strings_characters_and_comments_are_told_apart() {
    let text = "// one \"x\"\nlet a = \"two // no\\\" still\"; let b = '\"'; let c: &'a str = r#\"th\"ree\"#; /* fo /* u */ r */ b'\\'' x";
    let found = tokens(text);
    let of = |kind: Kind| found.iter().filter(|token| token.kind == kind).map(|token| token.text).collect::<Vec<_>>();
    assert_eq!(of(Kind::Text), ["two // no\\\" still", "th\"ree"]);
    assert_eq!(of(Kind::Comment), [" one \"x\"", " fo /* u */ r "]);
    assert_eq!(of(Kind::Word), ["let", "a", "let", "b", "let", "c", "str", "x"]);
    assert_eq!(found.last().unwrap().line, 2);
}

#[test]
fn items_for_tests_are_marked_and_their_neighbors_are_not() {
    let text = "fn a<T, U>() {}\n/// of b\n#[derive(X)]\n#[cfg(test)]\nfn b<T, U>() { 1; }\n/// of c\nfn c() {}\n\
                #[cfg(test)]\nuse d::{e, f};\nstruct G { #[cfg(test)] h: Vec<u8>, i: u8 }\n#[tokio::test(x = 1)] async fn j() {}\n\
                #[cfg(not(test))] fn k() {}\n#[cfg(test)]\nconst L: [u8; 1] = [1];\n#[cfg(all(test, unix))]\nmod m;\n\
                #[cfg(test)]\n#[path = \"other.rs\"]\nmod n;\nmod o;";
    let found = tokens(text);
    let kept: Vec<&str> = found
        .iter()
        .filter(|token| !token.tests && matches!(token.kind, Kind::Word | Kind::Comment))
        .map(|token| token.text)
        .collect();
    let wanted = "fn a T U| of c|fn c struct G i u8 cfg not test fn k mod o";
    assert_eq!(
        kept,
        wanted
            .split('|')
            .flat_map(|part| if part.starts_with(' ') { vec![part] } else { part.split(' ').collect() })
            .collect::<Vec<_>>()
    );
    assert_eq!(test_modules(&found), [("m", None), ("n", Some("other.rs"))]);
    assert!(tokens("#![cfg(test)]\nfn a() {}").iter().all(|token| token.tests));
}
