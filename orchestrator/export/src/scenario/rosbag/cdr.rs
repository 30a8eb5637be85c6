//! Messages in CDR, little-endian: values are aligned to their size, counted from behind the four bytes of the head.

use socrates_model::Point;

/// Bytes of a message as it grows.
#[derive(Debug, Clone)]
pub(super) struct Cdr {
    bytes: Vec<u8>,
}

impl Cdr {
    pub(super) fn new() -> Self {
        Self { bytes: vec![0, 1, 0, 0] }
    }

    pub(super) fn bytes(self) -> Vec<u8> {
        self.bytes
    }

    fn put<const N: usize>(&mut self, value: [u8; N]) {
        while !(self.bytes.len() - 4).is_multiple_of(N) {
            self.bytes.push(0);
        }
        self.bytes.extend(value);
    }

    pub(super) fn byte(&mut self, value: u8) {
        self.bytes.push(value);
    }

    pub(super) fn int(&mut self, value: i32) {
        self.put(value.to_le_bytes());
    }

    pub(super) fn count(&mut self, value: usize) {
        self.put(u32::try_from(value).unwrap_or(u32::MAX).to_le_bytes());
    }

    #[expect(clippy::cast_possible_truncation, reason = "the messages have single precision")]
    pub(super) fn single(&mut self, value: f64) {
        self.put((value as f32).to_le_bytes());
    }

    pub(super) fn double(&mut self, value: f64) {
        self.put(value.to_le_bytes());
    }

    pub(super) fn text(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.bytes.extend(text.bytes().chain([0]));
    }

    pub(super) fn doubles(&mut self, values: &[f64]) {
        values.iter().for_each(|value| self.double(*value));
    }

    pub(super) fn time(&mut self, nanos: u64) {
        self.int(i32::try_from(nanos / 1_000_000_000).unwrap_or(i32::MAX));
        self.put(u32::try_from(nanos % 1_000_000_000).unwrap_or(0).to_le_bytes());
    }

    pub(super) fn header(&mut self, nanos: u64, frame: &str) {
        self.time(nanos);
        self.text(frame);
    }

    /// The turn by a yaw.
    pub(super) fn turn(&mut self, yaw: f64) {
        let (sin, cos) = libm::sincos(0.5 * yaw);
        self.doubles(&[0.0, 0.0, sin, cos]);
    }

    pub(super) fn pose(&mut self, at: Point, yaw: f64) {
        self.doubles(&[at.x, at.y, 0.0]);
        self.turn(yaw);
    }

    pub(super) fn twist(&mut self, [x, y]: [f64; 2], turning: f64) {
        self.doubles(&[x, y, 0.0, 0.0, 0.0, turning]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_aligned_to_their_size() {
        let mut cdr = Cdr::new();
        cdr.byte(7);
        cdr.int(1);
        cdr.text("ab");
        cdr.double(1.0);
        let bytes = cdr.bytes();
        assert_eq!(bytes[..12], [0, 1, 0, 0, 7, 0, 0, 0, 1, 0, 0, 0]);
        assert_eq!(bytes[12..19], [3, 0, 0, 0, b'a', b'b', 0]);
        assert_eq!(bytes.len(), 4 + 16 + 8);
    }
}
