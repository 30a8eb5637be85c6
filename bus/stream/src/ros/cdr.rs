//! CDR, the form in which ROS 2 writes messages: a reader that never goes beyond its bytes, of both byte orders.

/// The header before every message: two bytes of encapsulation, two of options.
const HEADER_BYTES: usize = 4;
/// What a message begins with that was compressed by itself (`ros2 bag record --compression-mode message`).
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// What is wrong with the bytes of a message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum CdrFault {
    #[error("a message of {bytes} bytes has no CDR header")]
    NoHeader { bytes: usize },
    #[error("its encapsulation is `{first:02x} {second:02x}`; `00 00` and `00 01` (plain CDR) are read")]
    Encapsulation { first: u8, second: u8 },
    #[error("its messages are compressed one by one (zstd)")]
    Compressed,
    #[error("it needs {needed} bytes and {left} are left")]
    Ends { needed: usize, left: usize },
    #[error("its text claims {claimed} bytes and {left} are left")]
    Text { claimed: u32, left: usize },
    #[error("its text is not UTF-8")]
    NotUtf8,
    #[error("it claims {claimed} entries; at most {most} are read")]
    Many { claimed: u32, most: usize },
}

/// A number as CDR has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Primitive {
    /// Bytes and booleans are numbers too.
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl Primitive {
    /// Its length, which is what its place is a multiple of.
    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

/// A place in the bytes of a message. Places are counted from after its header.
#[derive(Debug, Clone)]
pub(super) struct Cursor<'a> {
    body: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Cursor<'a> {
    /// The begin of a message.
    pub(super) fn of(message: &'a [u8]) -> Result<Self, CdrFault> {
        if message.starts_with(&ZSTD) {
            return Err(CdrFault::Compressed);
        }
        let (Some([first, second, ..]), Some(body)) = (message.get(..HEADER_BYTES), message.get(HEADER_BYTES..)) else {
            return Err(CdrFault::NoHeader { bytes: message.len() });
        };
        let big_endian = match (first, second) {
            (0, 0) => true,
            (0, 1) => false,
            (first, second) => return Err(CdrFault::Encapsulation { first: *first, second: *second }),
        };
        Ok(Self { body, at: 0, big_endian })
    }

    fn left(&self) -> usize {
        self.body.len().saturating_sub(self.at)
    }

    /// Goes on to the next multiple of a length.
    fn align(&mut self, bytes: usize) {
        self.at = self.at.next_multiple_of(bytes.max(1));
    }

    fn take(&mut self, bytes: usize) -> Result<&'a [u8], CdrFault> {
        let end = self.at.saturating_add(bytes);
        let taken = self.body.get(self.at..end).ok_or_else(|| CdrFault::Ends { needed: bytes, left: self.left() })?;
        self.at = end;
        Ok(taken)
    }

    /// The bytes of a number, the least significant first, and zeros after them.
    fn little(&mut self, bytes: usize) -> Result<[u8; 8], CdrFault> {
        self.align(bytes);
        let mut wide = [0_u8; 8];
        let taken = self.take(bytes)?;
        let slots = wide.iter_mut().zip(0..bytes);
        if self.big_endian {
            slots.zip(taken.iter().rev()).for_each(|((slot, _), byte)| *slot = *byte);
        } else {
            slots.zip(taken).for_each(|((slot, _), byte)| *slot = *byte);
        }
        Ok(wide)
    }

    /// A number; whole numbers beyond 2^53 lose their last digits, which no message that is read here has.
    #[expect(clippy::cast_precision_loss, reason = "said above")]
    pub(super) fn number(&mut self, kind: Primitive) -> Result<f64, CdrFault> {
        let wide = self.little(kind.bytes())?;
        let [a, b, c, d, ..] = wide;
        Ok(match kind {
            Primitive::U8 => f64::from(a),
            Primitive::I8 => f64::from(i8::from_le_bytes([a])),
            Primitive::U16 => f64::from(u16::from_le_bytes([a, b])),
            Primitive::I16 => f64::from(i16::from_le_bytes([a, b])),
            Primitive::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Primitive::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Primitive::U64 => u64::from_le_bytes(wide) as f64,
            Primitive::I64 => i64::from_le_bytes(wide) as f64,
            Primitive::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Primitive::F64 => f64::from_le_bytes(wide),
        })
    }

    fn length(&mut self) -> Result<u32, CdrFault> {
        let [a, b, c, d, ..] = self.little(4)?;
        Ok(u32::from_le_bytes([a, b, c, d]))
    }

    /// A text; its length counts the zero byte at its end.
    pub(super) fn text(&mut self) -> Result<&'a str, CdrFault> {
        let claimed = self.length()?;
        let left = self.left();
        let bytes = usize::try_from(claimed).ok().filter(|bytes| *bytes <= left);
        let taken = self.take(bytes.ok_or(CdrFault::Text { claimed, left })?)?;
        let text = taken.strip_suffix(&[0]).unwrap_or(taken);
        std::str::from_utf8(text).map_err(|_why| CdrFault::NotUtf8)
    }

    /// The number of entries of a sequence.
    pub(super) fn count(&mut self, most: usize) -> Result<usize, CdrFault> {
        let claimed = self.length()?;
        usize::try_from(claimed).ok().filter(|count| *count <= most).ok_or(CdrFault::Many { claimed, most })
    }

    /// The number of entries of a sequence that is passed over: any, as its bytes have to be there.
    pub(super) fn any_count(&mut self) -> Result<usize, CdrFault> {
        self.count(usize::MAX)
    }

    /// Passes over numbers one after another.
    pub(super) fn pass(&mut self, kind: Primitive, count: usize) -> Result<(), CdrFault> {
        // Where there is none, nothing is aligned either.
        if count > 0 {
            self.align(kind.bytes());
            self.take(kind.bytes().saturating_mul(count))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_in_both_byte_orders_at_places_counted_from_after_the_header() {
        let little = [0, 1, 0, 0, 7, 0, 0, 0, 0xfe, 0xff, 0xff, 0xff, 0, 0, 0, 0, 0, 0, 0xf8, 0x3f];
        let big = [0, 0, 0, 0, 7, 0, 0, 0, 0xff, 0xff, 0xff, 0xfe, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0];
        for bytes in [little, big] {
            let mut cursor = Cursor::of(&bytes).unwrap();
            let read = [Primitive::U8, Primitive::I32, Primitive::F64].map(|kind| cursor.number(kind).unwrap());
            assert_eq!(read.map(|value| value.to_string()), ["7", "-2", "1.5"]);
            assert_eq!(cursor.number(Primitive::U8), Err(CdrFault::Ends { needed: 1, left: 0 }));
        }
    }

    #[test]
    fn a_text_ends_before_its_zero_and_a_length_beyond_the_message_is_refused() {
        let bytes = [0, 1, 0, 0, 4, 0, 0, 0, b'm', b'a', b'p', 0, 0xff, 0xff, 0xff, 0xff];
        let mut cursor = Cursor::of(&bytes).unwrap();
        assert_eq!(cursor.text(), Ok("map"));
        assert_eq!(cursor.text(), Err(CdrFault::Text { claimed: u32::MAX, left: 0 }));
        let mut cursor = Cursor::of(&bytes[..12]).unwrap();
        assert_eq!((cursor.text(), cursor.text()), (Ok("map"), Err(CdrFault::Ends { needed: 4, left: 0 })));
        let raw = [0, 1, 0, 0, 2, 0, 0, 0, 0xff, 0];
        assert_eq!(Cursor::of(&raw).unwrap().text(), Err(CdrFault::NotUtf8));
    }

    #[test]
    fn an_empty_sequence_aligns_nothing() {
        let bytes = [0, 1, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0];
        let mut cursor = Cursor::of(&bytes).unwrap();
        let count = cursor.any_count().unwrap();
        cursor.pass(Primitive::F64, count).unwrap();
        assert_eq!(cursor.number(Primitive::U32).map(|value| value.to_string()), Ok("9".to_owned()));
        assert_eq!(cursor.pass(Primitive::F64, usize::MAX), Err(CdrFault::Ends { needed: usize::MAX, left: 0 }));
    }

    #[test]
    fn other_encapsulations_and_messages_compressed_by_themselves_are_named() {
        let why = |bytes: &[u8]| Cursor::of(bytes).unwrap_err().to_string();
        assert!(why(&[0, 7, 0, 0]).contains("`00 07`"));
        assert!(why(&[0x28, 0xb5, 0x2f, 0xfd, 1]).contains("compressed one by one"));
        assert!(why(&[0, 1]).contains("2 bytes"));
    }
}
