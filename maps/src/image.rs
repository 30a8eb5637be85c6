//! Map images: PGM (P2, P5) and PNG, as shades of gray.

use std::io::Cursor;

use crate::map_file::MAX_PIXELS;

/// A picture: brightness 0 (black) to 1 (white) and whether it is opaque, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<(f64, bool)>,
}

/// Reads a picture; the error says what is wrong with it.
pub(crate) fn read(bytes: &[u8]) -> Result<Picture, String> {
    match bytes {
        [b'P', b'2' | b'5', ..] => pgm(bytes),
        [0x89, b'P', b'N', b'G', ..] => png(bytes),
        [] => Err("the image is empty".to_owned()),
        _ => Err(format!(
            "the image starts with the bytes {:02x?}; only PGM (`P2`, `P5`) and PNG are read",
            bytes.get(..4).unwrap_or(bytes)
        )),
    }
}

fn sized(width: usize, height: usize) -> Result<usize, String> {
    match width.checked_mul(height) {
        Some(pixels) if pixels > 0 && pixels <= MAX_PIXELS => Ok(pixels),
        Some(_) | None => Err(format!("the image is {width} by {height} pixels; allowed: 1 to {MAX_PIXELS} in all")),
    }
}

fn pgm(bytes: &[u8]) -> Result<Picture, String> {
    let mut words = Words { bytes, at: 2 };
    let (width, height) = (words.number("width")?, words.number("height")?);
    let most = words.number("largest value")?;
    let pixels = sized(width, height)?;
    let most = u16::try_from(most).ok().filter(|most| *most > 0);
    let most = most.ok_or_else(|| "the image's largest value is not 1 to 65535".to_owned())?;
    let shade = |value: u16| (f64::from(value.min(most)) / f64::from(most), true);
    if bytes.get(1) == Some(&b'2') {
        let mut values = Vec::new();
        for at in 0..pixels {
            let value = words.number("pixel").map_err(|why| format!("{why} (pixel {at} of {pixels})"))?;
            values.push(shade(u16::try_from(value).unwrap_or(u16::MAX)));
        }
        return Ok(Picture { width, height, pixels: values });
    }
    // Exactly one blank stands between the header and the pixels.
    let body = bytes.get(words.at + 1..).unwrap_or_default();
    let each = if most > 255 { 2 } else { 1 };
    if body.len() < pixels * each {
        return Err(format!("the image has {} of {} bytes of pixels; it is cut off", body.len(), pixels * each));
    }
    let value = |pixel: &[u8]| match pixel {
        [high, low] => u16::from_be_bytes([*high, *low]),
        [only] => u16::from(*only),
        _ => 0,
    };
    let values = body.chunks_exact(each).take(pixels).map(|pixel| shade(value(pixel))).collect();
    Ok(Picture { width, height, pixels: values })
}

/// Numbers of a PGM header, comments skipped.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Words<'_> {
    fn number(&mut self, what: &str) -> Result<usize, String> {
        loop {
            match self.bytes.get(self.at) {
                Some(b'#') => {
                    while self.bytes.get(self.at).is_some_and(|byte| *byte != b'\n') {
                        self.at += 1;
                    }
                }
                Some(byte) if byte.is_ascii_whitespace() => self.at += 1,
                Some(_) | None => break,
            }
        }
        let start = self.at;
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_digit) {
            self.at += 1;
        }
        let digits = self.bytes.get(start..self.at).unwrap_or_default();
        std::str::from_utf8(digits)
            .ok()
            .and_then(|digits| digits.parse().ok())
            .ok_or_else(|| format!("the image's {what} is missing or no number at byte {start}"))
    }
}

fn png(bytes: &[u8]) -> Result<Picture, String> {
    let broken = |why: png::DecodingError| format!("the PNG image is broken: {why}");
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(broken)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    sized(width, height)?;
    let size = reader.output_buffer_size().ok_or_else(|| "the PNG image does not fit in memory".to_owned())?;
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(broken)?;
    let channels = frame.color_type.samples();
    let pixel = |samples: &[u8]| {
        let byte = f64::from;
        match *samples {
            [gray] => (byte(gray) / 255.0, true),
            [gray, alpha] => (byte(gray) / 255.0, alpha == 255),
            [r, g, b] => ((byte(r) + byte(g) + byte(b)) / 765.0, true),
            [r, g, b, alpha] => ((byte(r) + byte(g) + byte(b)) / 765.0, alpha == 255),
            _ => (0.0, false),
        }
    };
    let pixels: Vec<(f64, bool)> = buffer.chunks_exact(channels.max(1)).map(pixel).take(width * height).collect();
    if pixels.len() == width * height {
        Ok(Picture { width, height, pixels })
    } else {
        Err(format!("the PNG image has {} of {} pixels", pixels.len(), width * height))
    }
}

/// An 8-bit gray PNG of these bytes, row by row from the top, one a pixel; the same input gives the same bytes.
///
/// # Errors
/// In words, where a side is 0 or the bytes are not `width` by `height`.
pub fn gray_png(width: usize, height: usize, shades: &[u8]) -> Result<Vec<u8>, String> {
    let side = |n: usize| u32::try_from(n).map_err(|_too_large| format!("an image side of {n} pixels is too large"));
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(width)?, side(height)?);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().map_err(|why| why.to_string())?;
    writer.write_image_data(shades).map_err(|why| why.to_string())?;
    writer.finish().map_err(|why| why.to_string())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_and_packed_pgm_agree_and_skip_comments() {
        let plain = read(b"P2\n# made by hand\n3 2\n255\n0 255 205\n1 2 3\n").unwrap();
        let packed = read(b"P5 3 2 # c\n255\n\x00\xff\xcd\x01\x02\x03").unwrap();
        assert_eq!(plain, packed);
        let deep = read(b"P5 1 1 65535\n\x80\x00").unwrap();
        assert!((deep.pixels[0].0 - 0.5).abs() < 1e-4);
    }

    #[test]
    fn a_png_survives_the_round_trip_and_is_the_same_each_time() {
        let shades: Vec<u8> = (0..60).map(|n| n * 4).collect();
        let bytes = gray_png(10, 6, &shades).unwrap();
        assert_eq!(bytes, gray_png(10, 6, &shades).unwrap());
        let picture = read(&bytes).unwrap();
        assert_eq!((picture.width, picture.height), (10, 6));
        assert!(
            picture
                .pixels
                .iter()
                .zip(&shades)
                .all(|((v, opaque), s)| *opaque && (v * 255.0 - f64::from(*s)).abs() < 1e-9)
        );
    }

    #[test]
    fn broken_images_are_refused_with_a_reason() {
        let png = gray_png(10, 6, &[0; 60]).unwrap();
        let cases: [(&[u8], &str); 7] = [
            (b"", "empty"),
            (b"BM42", "only PGM"),
            (b"P5 3 2 255\nabc", "cut off"),
            (b"P2 3 2 255\n1 2 x", "pixel 2 of 6"),
            (b"P5 99999999 99999999 255\n", "allowed: 1 to"),
            (b"P5 0 2 255\n", "allowed: 1 to"),
            (&png[..png.len() / 2], "broken"),
        ];
        for (bytes, part) in cases {
            let why = read(bytes).unwrap_err();
            assert!(why.contains(part), "{why}");
        }
    }
}
