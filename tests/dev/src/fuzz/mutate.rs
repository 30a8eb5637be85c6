//! Damage: one input made out of a good one, as copying, editing by hand and chance do it.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};
use socrates_model::seeds::stream_seed;

/// Numbers at which readers break.
const NUMBERS: &[&str] = &[
    "0",
    "-1",
    "1",
    "3",
    "65536",
    "2147483648",
    "4294967296",
    "9007199254740993",
    "18446744073709551616",
    "-9223372036854775809",
    "1e9",
    "1e19",
    "1e265",
    "-1e308",
    "1e400",
    "1e-320",
    "-0.0",
    "0.1",
    "NaN",
    "inf",
    "nan",
    ".inf",
    "0x10",
    "1_000",
    "",
    "null",
    "true",
    "\"7\"",
];
/// Pieces of text at which readers break.
const PIECES: &[&str] = &[
    "\u{202e}",
    "\u{feff}",
    "\0",
    "\r",
    "\t",
    "\u{1f6b6}",
    "中文",
    "ß",
    "'",
    "\"",
    "\\",
    "\\u0000",
    "{",
    "}",
    "[",
    "]",
    "<",
    ">",
    "<!--",
    "&amp;",
    "&x;",
    ",",
    ";",
    ":",
    "=",
    "#",
    "- ",
    "~",
    "*a",
    "&a ",
    "!!binary ",
    "../",
    "/",
    "\n",
    "\n\n",
    "robot",
    "human_1",
    "human_99999",
    "[[human]]",
    "[run]\n",
];
/// Most changes beyond the first that are made to one input; most inputs have one, so that many come far.
const MORE_CHANGES: u64 = 4;
/// Deepest nesting that is put in.
const DEEPEST: u64 = 20_000;
/// Longest stretch that is cut, copied or scattered, bytes.
const STRETCH: usize = 400;

/// A generator of one seed and one door.
pub(super) struct Chance(ChaCha8Rng);

impl Chance {
    /// The same seed and stream give the same damage.
    pub(super) fn of(seed: u64, stream: &str) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream_seed(0, stream));
        Self(rng)
    }

    /// A number below `end`; 0 where there is none.
    pub(super) fn below(&mut self, end: u64) -> u64 {
        self.0.next_u64().checked_rem(end).unwrap_or(0)
    }

    /// A place in something of this length.
    pub(super) fn place(&mut self, len: usize) -> usize {
        usize::try_from(self.below(len as u64)).unwrap_or(0)
    }

    /// Something out of a list.
    pub(super) fn pick<'a, T>(&mut self, from: &'a [T]) -> Option<&'a T> {
        let place = self.place(from.len());
        from.get(place)
    }

    /// Any bits, as a float: large, tiny, NaN and infinite ones among them.
    pub(super) fn float(&mut self) -> f64 {
        match self.below(4) {
            0 => f64::from_bits(self.0.next_u64()),
            1 => 1e265,
            2 => f64::NAN,
            _ => -1e7,
        }
    }
}

/// A good input with a few changes.
pub(super) fn damaged(good: &[u8], chance: &mut Chance) -> Vec<u8> {
    let mut bytes = good.to_vec();
    let more = chance.below(2) * chance.below(MORE_CHANGES);
    for _ in 0..=more {
        let is_text = std::str::from_utf8(&bytes).is_ok();
        // What is text gets most of its damage as text: a flipped bit in it is only a strange letter.
        if is_text && chance.below(4) > 0 { edit(&mut bytes, chance) } else { corrupt(&mut bytes, chance) }
    }
    bytes
}

/// Damage to bytes.
fn corrupt(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let at = chance.place(bytes.len());
    let end = bytes.len().min(at + 1 + chance.place(STRETCH));
    match chance.below(7) {
        0 => {
            let flip = 1_u8 << chance.below(8);
            bytes.get_mut(at).into_iter().for_each(|byte| *byte ^= flip);
        }
        1 => bytes.truncate(at),
        2 => drop(bytes.drain(at..end)),
        3 => {
            let piece: Vec<u8> = bytes.get(at..end).unwrap_or_default().to_vec();
            let to = chance.place(bytes.len());
            bytes.splice(to..to, piece);
        }
        4 => bytes.iter_mut().skip(at).take(end - at).for_each(|byte| *byte = 0),
        5 => {
            for byte in bytes.iter_mut().skip(at).take(end - at) {
                *byte = u8::try_from(chance.below(256)).unwrap_or(0);
            }
        }
        _ => {
            // A length or a count, wherever it stands: eight bytes of a number.
            let number = chance.float().to_le_bytes();
            bytes.iter_mut().skip(at).zip(number).for_each(|(byte, new)| *byte = new);
        }
    }
}

/// Damage to text, as a person does it.
fn edit(bytes: &mut Vec<u8>, chance: &mut Chance) {
    match chance.below(8) {
        0 | 1 => {
            let numbers = spans(bytes, |byte| byte.is_ascii_digit() || b".-+eE".contains(&byte), u8::is_ascii_digit);
            if let (Some((from, to)), Some(new)) = (chance.pick(&numbers).copied(), chance.pick(NUMBERS)) {
                bytes.splice(from..to, new.bytes());
            }
        }
        2 | 3 => {
            // One word in place of another of the same file.
            let word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
            let words = spans(bytes, word, u8::is_ascii_alphabetic);
            if let (Some((from, to)), Some(other)) = (chance.pick(&words).copied(), chance.pick(&words).copied()) {
                let new: Vec<u8> = bytes.get(other.0..other.1).unwrap_or_default().to_vec();
                bytes.splice(from..to, new);
            }
        }
        4 => {
            let mut lines: Vec<Vec<u8>> = bytes.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
            let (from, to) = (chance.place(lines.len()), chance.place(lines.len()));
            let line =
                if chance.below(2) == 0 { lines.remove(from) } else { lines.get(from).cloned().unwrap_or_default() };
            lines.insert(to.min(lines.len()), line);
            *bytes = lines.join(&b'\n');
        }
        5 => {
            let lines: Vec<&[u8]> = bytes.split(|byte| *byte == b'\n').collect();
            let gone = chance.place(lines.len());
            let kept: Vec<&[u8]> =
                lines.iter().enumerate().filter(|(index, _)| *index != gone).map(|(_, line)| *line).collect();
            *bytes = kept.join(&b'\n');
        }
        6 => {
            if let Some(piece) = chance.pick(PIECES) {
                let at = chance.place(bytes.len() + 1);
                bytes.splice(at..at, piece.bytes());
            }
        }
        _ => {
            let deep = usize::try_from(chance.below(DEEPEST)).unwrap_or(0);
            let open = *chance.pick(&["[", "{\"a\":", "<Sequence>", "(", "- ", "a.", "and "]).unwrap_or(&"[");
            let at = chance.place(bytes.len() + 1);
            bytes.splice(at..at, open.repeat(deep).into_bytes());
        }
    }
}

/// Stretches of bytes that all belong and of which one is of the kind.
fn spans(bytes: &[u8], belongs: impl Fn(u8) -> bool, kind: impl Fn(&u8) -> bool) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut from = 0;
    for stretch in bytes.chunk_by(|a, b| belongs(*a) == belongs(*b)) {
        let to = from + stretch.len();
        if stretch.first().is_some_and(|byte| belongs(*byte)) && stretch.iter().any(&kind) {
            found.push((from, to));
        }
        from = to;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_seed_gives_one_damage_and_many_seeds_many() {
        let good = b"location = \"office\"\ntask = \"Deliver mail\"\n[run]\nseed = 17\n";
        let make = |seed| damaged(good, &mut Chance::of(seed, "requests"));
        assert_eq!(make(3), make(3));
        let all: std::collections::BTreeSet<Vec<u8>> = (0..100).map(make).collect();
        assert!(all.len() > 80, "{}", all.len());
        assert!(damaged(b"", &mut Chance::of(1, "x")).len() < 1_000_000);
    }
}
