//! SVG to PNG, with the font compiled in: the same picture on every machine, but for characters that only a font of the
//! system has.

use std::io::Write as _;

use resvg::{tiny_skia, usvg};

use crate::fonts;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The SVG text is not valid.
    #[error("the drawing is not valid SVG")]
    Svg(#[source] usvg::Error),
    /// The picture would be empty or larger than 10 000 px a side.
    #[error("a picture of {width} by {height} px cannot be drawn; allowed: 1 to 10000 px a side")]
    Size {
        /// Asked width, px.
        width: u32,
        /// Asked height, px.
        height: u32,
    },
    /// The PNG could not be encoded.
    #[error("the picture could not be encoded: {0}")]
    Encode(String),
}

/// A drawing, read with the fonts that its words need.
fn tree(svg: &str) -> Result<usvg::Tree, PngError> {
    let (text, fonts) = fonts::readable(svg);
    usvg::Tree::from_str(&text, &fonts::options(fonts)).map_err(PngError::Svg)
}

/// Renders an SVG drawing at so many pixels per drawing unit.
///
/// # Errors
/// [`PngError`] when the drawing is not valid or has an impossible size.
pub fn png_from_svg(svg: &str, scale: f32) -> Result<Vec<u8>, PngError> {
    encode(&render(svg, scale)?, None)
}

/// Renders an SVG drawing with a size on paper at so many pixels per inch, and says so in the file.
///
/// # Errors
/// [`PngError`] when the drawing is not valid or has an impossible size.
pub fn png_at_dpi(svg: &str, dpi: f32) -> Result<Vec<u8>, PngError> {
    // A drawing's own pixel is a 96th of an inch.
    encode(&render(svg, dpi / 96.0)?, Some(dpi))
}

fn render(svg: &str, scale: f32) -> Result<tiny_skia::Pixmap, PngError> {
    let tree = tree(svg)?;
    let size = tree.size();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the result is checked against the allowed size"
    )]
    let (width, height) = ((size.width() * scale).round() as u32, (size.height() * scale).round() as u32);
    if !(1..=10_000).contains(&width) || !(1..=10_000).contains(&height) {
        return Err(PngError::Size { width, height });
    }
    let mut pixels = tiny_skia::Pixmap::new(width, height).ok_or(PngError::Size { width, height })?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    Ok(pixels)
}

/// A drawing that stays, on which others are drawn one after another: the ground of a film.
#[derive(Debug, Clone)]
pub struct Ground {
    pixels: tiny_skia::Pixmap,
}

impl Ground {
    /// Renders a drawing at one pixel per drawing unit.
    ///
    /// # Errors
    /// [`PngError`] when the drawing is not valid or has an impossible size.
    pub fn new(svg: &str) -> Result<Self, PngError> {
        Ok(Self { pixels: render(svg, 1.0)? })
    }

    /// The colors (red, green, blue, row by row) of the ground with a drawing of the same size on it.
    ///
    /// # Errors
    /// [`PngError::Svg`] when the drawing is not valid.
    pub fn with(&self, svg: &str) -> Result<Vec<u8>, PngError> {
        let tree = tree(svg)?;
        let mut pixels = self.pixels.clone();
        resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixels.as_mut());
        Ok(opaque(pixels.pixels()))
    }
}

/// A picture as PNG: opaque, lightly compressed, for pictures are made on the way of every run.
fn encode(pixels: &tiny_skia::Pixmap, dpi: Option<f32>) -> Result<Vec<u8>, PngError> {
    let wrong = |why: png::EncodingError| PngError::Encode(why.to_string());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    if let Some(dpi) = dpi {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive number of pixels per meter"
        )]
        let per_meter = (dpi / 0.0254).round() as u32;
        encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_meter, yppu: per_meter, unit: png::Unit::Meter }));
    }
    let mut writer = encoder.write_header().map_err(wrong)?;
    // Row by row: the colors of the whole picture once more would be most of what a bundle needs.
    let mut rows = writer.stream_writer().map_err(wrong)?;
    for row in pixels.pixels().chunks(pixels.width().max(1) as usize) {
        rows.write_all(&opaque(row)).map_err(|why| PngError::Encode(why.to_string()))?;
    }
    rows.finish().map_err(wrong)?;
    writer.finish().map_err(wrong)?;
    Ok(bytes)
}

/// Colors over white: they are stored multiplied with their opacity, so what is missing to opaque is added.
fn opaque(pixels: &[tiny_skia::PremultipliedColorU8]) -> Vec<u8> {
    let mut colors = vec![0; pixels.len() * 3];
    for (color, pixel) in colors.as_chunks_mut::<3>().0.iter_mut().zip(pixels) {
        let rest = 255 - pixel.alpha();
        *color = [pixel.red(), pixel.green(), pixel.blue()].map(|part| part.saturating_add(rest));
    }
    colors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_drawn_with_the_compiled_in_font() {
        let drawing = |words: &str| {
            format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"80\" height=\"20\"><text x=\"2\" y=\"15\" font-family=\"Ubuntu\" font-size=\"14\">{words}</text></svg>"
            )
        };
        let with = png_from_svg(&drawing("corridor"), 1.0).unwrap();
        let without = png_from_svg(&drawing(""), 1.0).unwrap();
        assert!(with.starts_with(&[0x89, b'P', b'N', b'G']));
        assert_ne!(with, without);
    }

    #[test]
    fn a_broken_drawing_is_an_error() {
        assert!(matches!(png_from_svg("<svg", 1.0), Err(PngError::Svg(_))));
    }
}
