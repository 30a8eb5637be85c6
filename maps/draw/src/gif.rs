//! Animated GIF, written by ourselves: one palette for all pictures, only what changed from one to the next.

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
#[derive(Debug)]
pub struct Gif {
    width: u16,
    height: u16,
    palette: Palette,
    before: Vec<u8>,
    bytes: Vec<u8>,
    waiting: Option<Vec<u8>>,
    hundredths: u32,
}

impl Gif {
    /// An endless GIF of this size.
    ///
    /// # Errors
    /// [`GifError::Size`] for an impossible size.
    pub fn new(width: u32, height: u32, palette: Palette) -> Result<Self, GifError> {
        let side = |side: u32| u16::try_from(side).ok().filter(|side| *side > 0 && u32::from(*side) <= MOST);
        let (Some(w), Some(h)) = (side(width), side(height)) else { return Err(GifError::Size { width, height }) };
        let mut bytes = b"GIF89a".to_vec();
        bytes.extend(w.to_le_bytes());
        bytes.extend(h.to_le_bytes());
        // A table of 256 colors for all pictures, 8 bits a color.
        bytes.extend([0xf7, 0, 0]);
        for place in 0..256 {
            bytes.extend(palette.colors.get(place).copied().unwrap_or([0; 3]));
        }
        // Repeat for ever.
        bytes.extend(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00");
        Ok(Self { width: w, height: h, palette, before: Vec::new(), bytes, waiting: None, hundredths: 0 })
    }

    /// Adds a picture (red, green, blue, row by row) that is shown for so many hundredths of a second.
    ///
    /// # Errors
    /// [`GifError::Picture`] when it has another size.
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
        self.flush();
        self.waiting = Some(now);
        self.hundredths = hundredths;
        Ok(())
    }

    /// The finished file.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.flush();
        self.bytes.push(0x3b);
        self.bytes
    }

    fn flush(&mut self) {
        let Some(now) = self.waiting.take() else { return };
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
        let delay = u16::try_from(self.hundredths).unwrap_or(u16::MAX).to_le_bytes();
        // Leave what stands, index 255 is transparent.
        self.bytes.extend([0x21, 0xf9, 4, 0b0000_0101, delay[0], delay[1], KEEP, 0, 0x2c]);
        for part in [left, top, right - left, bottom - top] {
            self.bytes.extend(u16::try_from(part).unwrap_or(0).to_le_bytes());
        }
        self.bytes.push(0);
        compress(&pixels, &mut self.bytes);
        self.before = now;
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

/// LZW with codes of 9 to 12 bits, in blocks of at most 255 bytes, as GIF wants it.
fn compress(pixels: &[u8], out: &mut Vec<u8>) {
    const CLEAR: u16 = 256;
    const END: u16 = 257;
    out.push(8);
    let mut bits = Bits::default();
    let mut width = 9;
    let mut next = END + 1;
    // Code of a known run and one more pixel, by run * 256 + pixel; 0: not known.
    let mut longer = vec![0_u16; 4096 * 256];
    let mut touched: Vec<usize> = Vec::new();
    bits.push(CLEAR, width);
    let mut run: Option<u16> = None;
    for pixel in pixels {
        let Some(code) = run else {
            run = Some(u16::from(*pixel));
            continue;
        };
        let slot = usize::from(code) * 256 + usize::from(*pixel);
        let known = longer.get(slot).copied().unwrap_or(0);
        if known != 0 {
            run = Some(known);
            continue;
        }
        bits.push(code, width);
        if next < 4096 {
            if let Some(place) = longer.get_mut(slot) {
                *place = next;
                touched.push(slot);
            }
            if next == 1 << width && width < 12 {
                width += 1;
            }
            next += 1;
        } else {
            bits.push(CLEAR, width);
            for slot in touched.drain(..) {
                if let Some(place) = longer.get_mut(slot) {
                    *place = 0;
                }
            }
            (width, next) = (9, END + 1);
        }
        run = Some(u16::from(*pixel));
    }
    if let Some(code) = run {
        bits.push(code, width);
        // The reader has learned one more run by now.
        if next == 1 << width && width < 12 {
            width += 1;
        }
    }
    bits.push(END, width);
    for block in bits.finish().chunks(255) {
        out.push(u8::try_from(block.len()).unwrap_or(0));
        out.extend(block);
    }
    out.push(0);
}

/// Codes packed from the lowest bit up.
#[derive(Debug, Default)]
struct Bits {
    bytes: Vec<u8>,
    held: u32,
    count: u32,
}

impl Bits {
    fn push(&mut self, code: u16, width: u32) {
        self.held |= u32::from(code) << self.count;
        self.count += width;
        while self.count >= 8 {
            self.bytes.push((self.held & 0xff) as u8);
            self.held >>= 8;
            self.count -= 8;
        }
    }

    fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push((self.held & 0xff) as u8);
        }
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reader of the pixel stream, after the specification of GIF89a.
    fn expand(stream: &[u8]) -> Vec<u8> {
        assert_eq!(stream[0], 8);
        let (mut packed, mut at) = (Vec::new(), 1);
        while stream[at] != 0 {
            let n = usize::from(stream[at]);
            packed.extend_from_slice(&stream[at + 1..at + 1 + n]);
            at += n + 1;
        }
        let (mut bit, mut width) = (0_usize, 9);
        let mut read = |width: usize| {
            let code =
                (0..width).map(|i| usize::from(packed[(bit + i) / 8] >> ((bit + i) % 8) & 1) << i).sum::<usize>();
            bit += width;
            code
        };
        let fresh =
            || -> Vec<Vec<u8>> { (0..258_u16).map(|i| u8::try_from(i).map_or(Vec::new(), |i| vec![i])).collect() };
        let (mut table, mut out, mut last) = (fresh(), Vec::new(), None::<usize>);
        loop {
            let code = read(width);
            match code {
                256 => (table, width, last) = (fresh(), 9, None),
                257 => return out,
                _ => {
                    if let Some(last) = last
                        && table.len() < 4096
                    {
                        let mut entry = table[last].clone();
                        let first = if code < table.len() { table[code][0] } else { table[last][0] };
                        entry.push(first);
                        table.push(entry);
                    }
                    out.extend_from_slice(&table[code]);
                    last = Some(code);
                    if table.len() == 1 << width && width < 12 {
                        width += 1;
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_packed_comes_out_again() {
        let noise = |n: usize, kinds: u32| -> Vec<u8> {
            let mut state = 12_345_u32;
            (0..n)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    u8::try_from((state >> 16) % kinds).unwrap()
                })
                .collect()
        };
        let cases =
            [vec![], vec![7], vec![9; 70_000], noise(300, 256), noise(90_000, 256), noise(90_000, 3), noise(3837, 256)];
        for pixels in cases.into_iter().chain((250..270).map(|n| noise(n, 256))) {
            let mut stream = Vec::new();
            compress(&pixels, &mut stream);
            assert_eq!(expand(&stream), pixels, "{} pixels", pixels.len());
        }
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
            gif.finish()
        };
        assert_eq!(gif(1).len(), gif(50).len());
        let mut small = Gif::new(4, 3, histogram.palette()).unwrap();
        assert_eq!(small.add(&[0; 5], 10), Err(GifError::Picture { found: 5, wanted: 36 }));
        assert!(matches!(Gif::new(0, 3, histogram.palette()), Err(GifError::Size { .. })));
    }
}
