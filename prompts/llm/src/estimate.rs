//! Tokens where a server does not count them.
//!
//! Text: UTF-8 bytes / 4, and 4 for the frame of each turn. On prompts of the kind asked here this is off by at most a fifth
//! from the o200k tokenizer. Pictures by the rule of the family of models; see [`picture_tokens`].

use crate::chat::{ChatRequest, Detail};
use crate::dialect::Dialect;

/// Bytes of a token, on average.
const BYTES: u64 = 4;
/// Tokens of the frame of a turn.
const FRAME: u64 = 4;

/// Tokens of a text.
#[must_use]
pub fn text_tokens(text: &str) -> u64 {
    (text.len() as u64).div_ceil(BYTES)
}

/// Tokens of a request: its turns, its schema, its pictures.
#[must_use]
pub fn request_tokens(request: &ChatRequest, dialect: Dialect) -> u64 {
    let schema = request.schema.as_ref().map_or(0, |schema| text_tokens(&schema.to_string()));
    let turn = |turn: &crate::chat::Turn| {
        let picture = turn.png.as_ref().map_or(0, |png| picture_tokens(png_size(png), request.detail, dialect));
        text_tokens(&turn.text) + FRAME + picture
    };
    schema + request.turns.iter().map(turn).sum::<u64>()
}

/// Tokens of a picture of `size` pixels (width, height).
///
/// * Chat Completions and Responses, by tiles: fitted into 2048 × 2048, then the short side to 768, then 170 for each tile of 512 and 85
///   once; 85 at low detail.
/// * Anthropic: width × height / 750, the long side at most 1568.
/// * Gemini: 258 up to 384 × 384 and at low detail, else 258 for each tile of 768.
#[must_use]
pub fn picture_tokens(size: (u32, u32), detail: Detail, dialect: Dialect) -> u64 {
    let (width, height) = (f64::from(size.0), f64::from(size.1));
    if width < 1.0 || height < 1.0 {
        return 0;
    }
    let tiles = |width: f64, height: f64, side: f64| (width / side).ceil() * (height / side).ceil();
    let tokens = match dialect {
        Dialect::OpenAi
        | Dialect::Responses
        | Dialect::Vllm
        | Dialect::Ollama
        | Dialect::LlamaCpp
        | Dialect::LmStudio
        | Dialect::Console => {
            if detail == Detail::Low {
                85.0
            } else {
                let fit = (2048.0 / width.max(height)).min(1.0);
                let short = (768.0 / (width.min(height) * fit)).min(1.0);
                85.0 + 170.0 * tiles((width * fit * short).round(), (height * fit * short).round(), 512.0)
            }
        }
        Dialect::Anthropic => {
            let fit = (1568.0 / width.max(height)).min(1.0);
            (width * fit * height * fit / 750.0).ceil()
        }
        Dialect::Gemini if detail == Detail::Low || width <= 384.0 && height <= 384.0 => 258.0,
        Dialect::Gemini => 258.0 * tiles(width, height, 768.0),
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive whole number")]
    {
        tokens as u64
    }
}

/// Width and height in the head of a PNG; zeros where it is none.
#[must_use]
pub fn png_size(png: &[u8]) -> (u32, u32) {
    let number =
        |at: usize| png.get(at..at + 4).and_then(|bytes| <[u8; 4]>::try_from(bytes).ok()).map_or(0, u32::from_be_bytes);
    if png.get(1..4) == Some(b"PNG".as_slice()) { (number(16), number(20)) } else { (0, 0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_cost_what_the_vendors_pages_say() {
        let tokens = |size, detail, dialect| picture_tokens(size, detail, dialect);
        assert_eq!(tokens((1250, 1250), Detail::High, Dialect::OpenAi), 765);
        assert_eq!(tokens((512, 512), Detail::High, Dialect::OpenAi), 255);
        assert_eq!(tokens((4000, 100), Detail::Low, Dialect::OpenAi), 85);
        assert_eq!(tokens((750, 1000), Detail::High, Dialect::Anthropic), 1000);
        assert_eq!(tokens((300, 300), Detail::High, Dialect::Gemini), 258);
        assert_eq!(tokens((900, 700), Detail::High, Dialect::Gemini), 516);
    }

    #[test]
    fn the_size_stands_in_the_head() {
        let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        png.extend([0, 0, 2, 0, 0, 0, 1, 4]);
        assert_eq!(png_size(&png), (512, 260));
        assert_eq!(png_size(b"GIF"), (0, 0));
    }
}
