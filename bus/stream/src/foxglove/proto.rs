//! Protocol buffers, as much of them as pictures need: a writer of messages.

/// A message that is being written. Zeros and empty texts are left out, as everywhere in protocol buffers.
#[derive(Debug, Default)]
pub struct Proto {
    bytes: Vec<u8>,
    pub(super) is_lean: bool,
}

const VARINT: u32 = 0;
const FIXED_64: u32 = 1;
const FIXED_32: u32 = 5;
const COUNTED: u32 = 2;

impl Proto {
    /// A message with the same bytes as by Foxglove's own library: -0 and times beyond 32 bits of seconds are left out.
    #[must_use]
    pub const fn lean() -> Self {
        Self { bytes: Vec::new(), is_lean: true }
    }

    /// The bytes that were written.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The bytes, for keeping.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Begins another message in the same memory.
    pub fn clear(&mut self) {
        self.bytes.clear();
    }

    /// Whether nothing was written.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            #[expect(clippy::cast_possible_truncation, reason = "seven bits and the mark that more follow")]
            self.bytes.push((value as u8) | 0x80);
            value >>= 7;
        }
        #[expect(clippy::cast_possible_truncation, reason = "less than 128")]
        self.bytes.push(value as u8);
    }

    fn tag(&mut self, field: u32, wire: u32) {
        self.varint(u64::from(field << 3 | wire));
    }

    /// An integer that is not negative, an enumeration or a truth value.
    pub fn number(&mut self, field: u32, value: u64) {
        if value > 0 {
            self.present(field, value);
        }
    }

    /// The same, also where it is 0.
    pub(super) fn present(&mut self, field: u32, value: u64) {
        self.tag(field, VARINT);
        self.varint(value);
    }

    /// An integer of four bytes.
    pub fn fixed(&mut self, field: u32, value: u32) {
        if value > 0 {
            self.tag(field, FIXED_32);
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
    }

    /// Bytes.
    pub fn data(&mut self, field: u32, value: &[u8]) {
        if !value.is_empty() {
            self.tag(field, COUNTED);
            self.varint(value.len() as u64);
            self.bytes.extend_from_slice(value);
        }
    }

    /// A number.
    pub fn double(&mut self, field: u32, value: f64) {
        if value.to_bits() != 0 && !(self.is_lean && value == 0.0) {
            self.tag(field, FIXED_64);
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
    }

    /// Numbers, one after the other.
    pub fn doubles(&mut self, field: u32, values: impl ExactSizeIterator<Item = f64>) {
        if values.len() > 0 {
            self.tag(field, COUNTED);
            self.varint(8 * values.len() as u64);
            values.for_each(|value| self.bytes.extend_from_slice(&value.to_le_bytes()));
        }
    }

    /// A text.
    pub fn text(&mut self, field: u32, value: &str) {
        self.data(field, value.as_bytes());
    }

    /// A message within; it is there even where nothing is written into it.
    pub fn message(&mut self, field: u32, write: impl FnOnce(&mut Self)) {
        self.tag(field, COUNTED);
        let begin = self.bytes.len();
        write(self);
        // Its length comes before it and is known only now; of short messages, which most are, it is one byte.
        let len = self.bytes.len() - begin;
        self.varint(len as u64);
        self.bytes.get_mut(begin..).into_iter().for_each(|written| written.rotate_right(varint_len(len)));
    }
}

/// Bytes of a number as it is written.
const fn varint_len(value: usize) -> usize {
    let bits = (usize::BITS - value.leading_zeros()) as usize;
    if bits == 0 { 1 } else { bits.div_ceil(7) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_written_as_the_standard_has_it() {
        // The examples of the encoding guide: 150 as field 1, "testing" as field 2, and a message within as field 3.
        let mut out = Proto::default();
        out.number(1, 150);
        out.text(2, "testing");
        out.message(3, |out| out.number(1, 150));
        let mut expected = vec![0x08, 0x96, 0x01, 0x12, 0x07];
        expected.extend(b"testing");
        expected.extend([0x1a, 0x03, 0x08, 0x96, 0x01]);
        assert_eq!(out.bytes(), expected);
        out.clear();
        assert!(out.is_empty());
        out.double(1, 1.0);
        out.double(2, 0.0);
        assert_eq!(out.bytes(), [0x09, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
        out.clear();
        out.doubles(1, [1.0].into_iter());
        out.doubles(2, [].into_iter());
        assert_eq!(out.bytes(), [0x0a, 8, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
    }

    #[test]
    fn a_long_message_within_has_a_long_length() {
        for len in [0, 1, 127, 128, 129, 16_383, 16_384, 70_000_usize] {
            let text = "x".repeat(len);
            let mut out = Proto::default();
            out.message(1, |out| out.bytes.extend_from_slice(text.as_bytes()));
            let mut expected = Proto::default();
            expected.tag(1, COUNTED);
            expected.varint(len as u64);
            expected.bytes.extend_from_slice(text.as_bytes());
            assert_eq!(out.bytes(), expected.bytes(), "{len}");
        }
    }
}
