//! Animated GIF: one palette for all pictures, and of each picture only what changed since the one before.

use std::borrow::Cow;

use ::gif::{DisposalMethod, Encoder, Frame, Repeat};

/// Width and height up to which a GIF is written, px.
const MOST: u32 = 4096;
/// Index that leaves a pixel as it was.
const KEEP: u8 = 255;
/// Bits of a color channel in the histogram.
const BITS: u32 = 5;
const BINS: usize = 1 << (3 * BITS);

/// Why a GIF could not be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GifError {
    /// The size is impossible.
    #[error("a GIF of {width} by {height} px cannot be written; allowed: 1 to {MOST} px a side")]
    Size {
        /// Asked width, px.
        width: u32,
        /// Asked height, px.
        height: u32,
    },
    /// A picture has another size than was said.
    #[error("a picture has {found} bytes where {wanted} are needed")]
    Picture {
        /// Bytes of the picture.
        found: usize,
        /// Bytes of width, height and three colors.
        wanted: usize,
    },
    /// The encoder gave up.
    #[error("the GIF cannot be encoded: {why}")]
    Encode {
        /// What it says.
        why: String,
    },
}

impl From<::gif::EncodingError> for GifError {
    fn from(why: ::gif::EncodingError) -> Self {
        Self::Encode { why: why.to_string() }
    }
}

/// The colors of a GIF, found by looking at some of its pictures: the most common ones.
#[derive(Debug, Clone)]
pub struct Palette {
    colors: Vec<[u8; 3]>,
    nearest: Vec<u8>,
}

/// Counts colors.
#[derive(Debug, Clone)]
pub struct Histogram {
    bins: Vec<[u64; 4]>,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { bins: vec![[0; 4]; BINS] }
    }
}

fn bin(r: u8, g: u8, b: u8) -> usize {
    let part = |c: u8| usize::from(c >> (8 - BITS));
    (part(r) << (2 * BITS)) | (part(g) << BITS) | part(b)
}

impl Histogram {
    /// Counts the pixels of a picture (red, green, blue, row by row).
    pub fn add(&mut self, rgb: &[u8]) {
        for pixel in rgb.chunks_exact(3) {
            if let [r, g, b] = *pixel
                && let Some([count, red, green, blue]) = self.bins.get_mut(bin(r, g, b))
            {
                *count += 1;
                *red += u64::from(r);
                *green += u64::from(g);
                *blue += u64::from(b);
            }
        }
    }

    /// The palette of what was counted.
    #[must_use]
    pub fn palette(&self) -> Palette {
        let mean = |[count, red, green, blue]: [u64; 4]| -> [u8; 3] {
            let n = count.max(1);
            [red, green, blue].map(|sum| u8::try_from((sum + n / 2) / n).unwrap_or(u8::MAX))
        };
        let mut used: Vec<(u64, usize, [u8; 3])> = self
            .bins
            .iter()
            .enumerate()
            .filter(|(_, bin)| bin[0] > 0)
            .map(|(index, bin)| (bin[0], index, mean(*bin)))
            .collect();
        // The most common first; equal counts by place, so that the order is always the same.
        used.sort_by_key(|(count, index, _)| (u64::MAX - count, *index));
        let mut colors: Vec<[u8; 3]> = used.iter().take(usize::from(KEEP)).map(|(_, _, color)| *color).collect();
        if colors.is_empty() {
            colors.push([255; 3]);
        }
        let nearest = (0..BINS)
            .map(|index| {
                let channel = |shift: u32| -> i32 {
                    let step = 1 << (8 - BITS);
                    i32::try_from((index >> shift) & ((1 << BITS) - 1)).unwrap_or(0) * step + step / 2
                };
                let wanted = [channel(2 * BITS), channel(BITS), channel(0)];
                let distance = |color: &[u8; 3]| -> i32 {
                    color.iter().zip(wanted).map(|(c, w)| (i32::from(*c) - w) * (i32::from(*c) - w)).sum()
                };
                let best = colors.iter().enumerate().min_by_key(|(_, color)| distance(color));
                best.map_or(0, |(place, _)| u8::try_from(place).unwrap_or(0))
            })
            .collect();
        Palette { colors, nearest }
    }
}

impl Palette {
    fn index(&self, r: u8, g: u8, b: u8) -> u8 {
        self.nearest.get(bin(r, g, b)).copied().unwrap_or(0)
    }
}

/// A GIF being written, one picture after another.
pub struct Gif {
    width: u16,
    height: u16,
    palette: Palette,
    before: Vec<u8>,
    encoder: Encoder<Vec<u8>>,
    waiting: Option<Vec<u8>>,
    hundredths: u32,
}

impl std::fmt::Debug for Gif {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gif").field("width", &self.width).field("height", &self.height).finish_non_exhaustive()
    }
}

impl Gif {
    /// An endless GIF of this size.
    ///
    /// # Errors
    /// [`GifError::Size`] for an impossible size.
    pub fn new(width: u32, height: u32, palette: Palette) -> Result<Self, GifError> {
        let side = |side: u32| u16::try_from(side).ok().filter(|side| *side > 0 && u32::from(*side) <= MOST);
        let (Some(w), Some(h)) = (side(width), side(height)) else { return Err(GifError::Size { width, height }) };
        // A table of 256 colors for all pictures; the last one leaves a pixel as it was.
        let colors: Vec<u8> = (0..256).flat_map(|place| palette.colors.get(place).copied().unwrap_or([0; 3])).collect();
        let mut encoder = Encoder::new(Vec::new(), w, h, &colors)?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self { width: w, height: h, palette, before: Vec::new(), encoder, waiting: None, hundredths: 0 })
    }

    /// Adds a picture (red, green, blue, row by row) that is shown for so many hundredths of a second.
    ///
    /// # Errors
    /// [`GifError::Picture`] when it has another size, [`GifError::Encode`] when a picture before cannot be written.
    pub fn add(&mut self, rgb: &[u8], hundredths: u32) -> Result<(), GifError> {
        let wanted = usize::from(self.width) * usize::from(self.height) * 3;
        if rgb.len() != wanted {
            return Err(GifError::Picture { found: rgb.len(), wanted });
        }
        let now: Vec<u8> = rgb
            .chunks_exact(3)
            .map(|pixel| if let [r, g, b] = *pixel { self.palette.index(r, g, b) } else { 0 })
            .collect();
        // The same picture again only lasts longer.
        if self.waiting.as_ref() == Some(&now) && self.hundredths + hundredths < u32::from(u16::MAX) {
            self.hundredths += hundredths;
            return Ok(());
        }
        self.flush()?;
        self.waiting = Some(now);
        self.hundredths = hundredths;
        Ok(())
    }

    /// The finished file.
    ///
    /// # Errors
    /// [`GifError::Encode`] when the last picture cannot be written.
    pub fn finish(mut self) -> Result<Vec<u8>, GifError> {
        self.flush()?;
        self.encoder.into_inner().map_err(|why| GifError::Encode { why: why.to_string() })
    }

    fn flush(&mut self) -> Result<(), GifError> {
        let Some(now) = self.waiting.take() else { return Ok(()) };
        let width = usize::from(self.width);
        let (left, top, right, bottom) = self.changed(&now);
        let mut pixels = Vec::with_capacity((right - left) * (bottom - top));
        for row in top..bottom {
            let start = row * width;
            let line = now.get(start + left..start + right).unwrap_or(&[]);
            let old = self.before.get(start + left..start + right);
            match old {
                Some(old) => pixels.extend(line.iter().zip(old).map(|(new, old)| if new == old { KEEP } else { *new })),
                None => pixels.extend(line),
            }
        }
        let side = |pixels: usize| u16::try_from(pixels).unwrap_or(u16::MAX);
        self.encoder.write_frame(&Frame {
            delay: u16::try_from(self.hundredths).unwrap_or(u16::MAX),
            dispose: DisposalMethod::Keep,
            transparent: Some(KEEP),
            left: side(left),
            top: side(top),
            width: side(right - left),
            height: side(bottom - top),
            buffer: Cow::Owned(pixels),
            ..Frame::default()
        })?;
        self.before = now;
        Ok(())
    }

    /// The box of what differs from the picture before: left, top, right, bottom. At least one pixel.
    fn changed(&self, now: &[u8]) -> (usize, usize, usize, usize) {
        let (width, height) = (usize::from(self.width), usize::from(self.height));
        if self.before.is_empty() {
            return (0, 0, width, height);
        }
        let (mut left, mut top, mut right, mut bottom) = (width, height, 0, 0);
        for (row, (new, old)) in now.chunks_exact(width).zip(self.before.chunks_exact(width)).enumerate() {
            let differs = |pair: (&u8, &u8)| pair.0 != pair.1;
            let Some(first) = new.iter().zip(old).position(differs) else { continue };
            let last = new.iter().zip(old).rposition(differs).unwrap_or(first);
            (left, right) = (left.min(first), right.max(last + 1));
            (top, bottom) = (top.min(row), row + 1);
        }
        if right == 0 { (0, 0, 1, 1) } else { (left, top, right, bottom) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_is_read_back_with_its_place_and_its_time() {
        let blue = [0, 114, 178];
        let picture =
            |at: usize| -> Vec<u8> { (0..12).flat_map(|pixel| if pixel == at { blue } else { [255; 3] }).collect() };
        let mut histogram = Histogram::default();
        histogram.add(&picture(0));
        let mut gif = Gif::new(4, 3, histogram.palette()).unwrap();
        for (at, hundredths) in [(0, 10), (0, 10), (6, 5)] {
            gif.add(&picture(at), hundredths).unwrap();
        }
        let bytes = gif.finish().unwrap();
        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::RGBA);
        let mut reader = options.read_info(bytes.as_slice()).unwrap();
        let (mut screen, mut times) = (vec![0_u8; 4 * 3 * 3], Vec::new());
        while let Some(frame) = reader.read_next_frame().unwrap() {
            times.push((frame.delay, frame.width, frame.height));
            for (place, pixel) in frame.buffer.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] > 0) {
                let (x, y) = (place % usize::from(frame.width), place / usize::from(frame.width));
                let at = 3 * ((y + usize::from(frame.top)) * 4 + x + usize::from(frame.left));
                screen[at..at + 3].copy_from_slice(&pixel[..3]);
            }
        }
        // The second picture lasts as long as both that look so; only the box of what changed is in the third.
        assert_eq!((times, screen), (vec![(20, 4, 3), (5, 3, 2)], picture(6)));
    }

    #[test]
    fn few_colors_are_kept_exactly() {
        let mut histogram = Histogram::default();
        histogram.add(&[255, 255, 255, 0, 114, 178, 255, 255, 255, 213, 94, 0]);
        let palette = histogram.palette();
        for [r, g, b] in [[255, 255, 255], [0, 114, 178], [213, 94, 0]] {
            assert_eq!(palette.colors[usize::from(palette.index(r, g, b))], [r, g, b]);
        }
    }

    #[test]
    fn an_unchanged_picture_costs_nothing_and_a_wrong_one_is_refused() {
        let white = vec![255; 4 * 3 * 3];
        let mut histogram = Histogram::default();
        histogram.add(&white);
        let gif = |times: u32| {
            let mut gif = Gif::new(4, 3, histogram.palette()).unwrap();
            for _ in 0..times {
                gif.add(&white, 10).unwrap();
            }
            gif.finish().unwrap()
        };
        assert_eq!(gif(1).len(), gif(50).len());
        let mut small = Gif::new(4, 3, histogram.palette()).unwrap();
        assert_eq!(small.add(&[0; 5], 10), Err(GifError::Picture { found: 5, wanted: 36 }));
        assert!(matches!(Gif::new(0, 3, histogram.palette()), Err(GifError::Size { .. })));
    }
}
