//! SVG to PNG, with the font compiled in: the same picture on every machine.

use std::sync::{Arc, OnceLock};

use resvg::{tiny_skia, usvg};

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

fn fonts() -> Arc<usvg::fontdb::Database> {
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    FONTS
        .get_or_init(|| {
            let mut database = usvg::fontdb::Database::new();
            database.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
            database.load_font_data(epaint_default_fonts::HACK_REGULAR.to_vec());
            database.set_sans_serif_family("Ubuntu");
            database.set_monospace_family("Hack");
            Arc::new(database)
        })
        .clone()
}

/// Renders an SVG drawing at so many pixels per drawing unit.
///
/// # Errors
/// [`PngError`] when the drawing is not valid or has an impossible size.
pub fn png_from_svg(svg: &str, scale: f32) -> Result<Vec<u8>, PngError> {
    let options = usvg::Options { fontdb: fonts(), font_family: "Ubuntu".to_owned(), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(PngError::Svg)?;
    let size = tree.size().to_int_size();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "the result is checked against the allowed size"
    )]
    let (width, height) = ((size.width() as f32 * scale).round() as u32, (size.height() as f32 * scale).round() as u32);
    if !(1..=10_000).contains(&width) || !(1..=10_000).contains(&height) {
        return Err(PngError::Size { width, height });
    }
    let mut pixels = tiny_skia::Pixmap::new(width, height).ok_or(PngError::Size { width, height })?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    encode(&pixels)
}

/// A picture as PNG: opaque, lightly compressed, for pictures are made on the way of every run.
fn encode(pixels: &tiny_skia::Pixmap) -> Result<Vec<u8>, PngError> {
    // Colors are stored multiplied with their opacity: over white, what is missing to opaque is added.
    let colors: Vec<u8> = pixels
        .pixels()
        .iter()
        .flat_map(|pixel| {
            [pixel.red(), pixel.green(), pixel.blue()].map(|color| color.saturating_add(255 - pixel.alpha()))
        })
        .collect();
    let wrong = |why: png::EncodingError| PngError::Encode(why.to_string());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(wrong)?;
    writer.write_image_data(&colors).map_err(wrong)?;
    writer.finish().map_err(wrong)?;
    Ok(bytes)
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
