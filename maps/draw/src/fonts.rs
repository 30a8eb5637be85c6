//! Fonts of pictures: letters and emoji that are compiled in, and for what they lack those of the system, where there are some.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, OnceLock};

use resvg::usvg::{self, fontdb};

/// Stands for a character that no font has, so that a reader sees that something is missing.
const MISSING: char = '\u{25a1}';

/// The fonts that are compiled in.
fn shipped() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    FONTS
        .get_or_init(|| {
            let mut database = fontdb::Database::new();
            database.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
            database.load_font_data(epaint_default_fonts::HACK_REGULAR.to_vec());
            database.load_font_data(epaint_default_fonts::NOTO_EMOJI_REGULAR.to_vec());
            database.set_sans_serif_family("Ubuntu");
            database.set_monospace_family("Hack");
            Arc::new(database)
        })
        .clone()
}

/// The fonts of this system, listed when a text first needs one.
fn system() -> &'static fontdb::Database {
    static FONTS: OnceLock<fontdb::Database> = OnceLock::new();
    FONTS.get_or_init(|| {
        let mut database = fontdb::Database::new();
        database.load_system_fonts();
        database
    })
}

/// Whether a face has an outline for a character. Fonts of pictures (emoji in color) have none.
fn draws(database: &fontdb::Database, face: fontdb::ID, c: char) -> bool {
    let outline = |data: &[u8], index: u32| {
        let face = ttf_parser::Face::parse(data, index).ok()?;
        face.glyph_bounding_box(face.glyph_index(c)?)
    };
    database.with_face_data(face, outline).flatten().is_some()
}

/// Whether a face knows a character, with an outline or as a space.
fn knows(database: &fontdb::Database, face: fontdb::ID, c: char) -> bool {
    let glyph = |data: &[u8], index: u32| ttf_parser::Face::parse(data, index).ok()?.glyph_index(c);
    database.with_face_data(face, glyph).flatten().is_some()
}

/// Characters below this one have a width of their own.
const MEASURED: usize = 0x250;
/// Width of a character that is as wide as high, and of one that is not known, in heights of the letters.
const WIDE: f64 = 1.0;
const PLAIN: f64 = 0.6;

/// How far a character moves the next one, in heights of the letters, in the font that is compiled in.
pub(crate) fn advance(c: char) -> f64 {
    static WIDTHS: OnceLock<Vec<f64>> = OnceLock::new();
    let widths = WIDTHS.get_or_init(|| {
        let face = ttf_parser::Face::parse(epaint_default_fonts::UBUNTU_LIGHT, 0).ok();
        let width = |c: char| {
            let face = face.as_ref()?;
            let units = face.glyph_hor_advance(face.glyph_index(c)?)?;
            Some(f64::from(units) / f64::from(face.units_per_em().max(1)))
        };
        let measured = 0..u32::try_from(MEASURED).unwrap_or(0);
        measured.map(|code| char::from_u32(code).and_then(width).unwrap_or(PLAIN)).collect()
    });
    let wide = matches!(c, '\u{1100}'..='\u{115f}' | '\u{2e80}'..='\u{a4cf}' | '\u{ac00}'..='\u{d7a3}' | '\u{f900}'..='\u{faff}'
        | '\u{fe30}'..='\u{fe4f}' | '\u{ff00}'..='\u{ff60}' | '\u{1f000}'..='\u{1faff}' | '\u{20000}'..='\u{3fffd}');
    widths.get(c as usize).copied().unwrap_or(if wide { WIDE } else { PLAIN })
}

/// Characters that only tell how their neighbors are joined, ordered or colored.
const fn is_silent(c: char) -> bool {
    matches!(c,
        '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}'
        | '\u{1f3fb}'..='\u{1f3ff}' | '\u{e0000}'..='\u{e01ef}')
}

/// A drawing in which every character has a font, and the fonts for it.
pub(crate) fn readable(svg: &str) -> (Cow<'_, str>, Arc<fontdb::Database>) {
    let fonts = shipped();
    let lacking: BTreeSet<char> = svg
        .chars()
        .filter(|c| !c.is_ascii())
        .collect::<BTreeSet<char>>()
        .into_iter()
        .filter(|c| !fonts.faces().any(|face| knows(&fonts, face.id, *c)))
        .collect();
    if lacking.is_empty() { (Cow::Borrowed(svg), fonts) } else { completed(svg, &lacking, &fonts, system()) }
}

/// The drawing with the faces of `system` that have what is lacking; what none of them has is replaced visibly.
fn completed<'a>(
    svg: &'a str,
    lacking: &BTreeSet<char>,
    shipped: &fontdb::Database,
    system: &fontdb::Database,
) -> (Cow<'a, str>, Arc<fontdb::Database>) {
    let mut faces: Vec<&fontdb::FaceInfo> = system.faces().collect();
    // Upright and of middle weight first; by name, so that the order is that of no folder.
    faces.sort_by_key(|face| {
        let slant = face.style != fontdb::Style::Normal;
        (slant, face.weight.0.abs_diff(400), face.monospaced, face.post_script_name.clone(), face.index)
    });
    let mut fonts = shipped.clone();
    let mut taken: Vec<fontdb::ID> = Vec::new();
    let mut instead: BTreeMap<char, Option<char>> = BTreeMap::new();
    for c in lacking {
        if is_silent(*c) {
            instead.insert(*c, None);
        } else if taken.iter().any(|face| draws(system, *face, *c)) {
            // A face that is there already has it.
        } else if let Some(face) = faces.iter().find(|face| draws(system, face.id, *c)) {
            taken.push(face.id);
            fonts.push_face_info((*face).clone());
        } else {
            instead.insert(*c, Some(MISSING));
        }
    }
    if instead.is_empty() {
        return (Cow::Borrowed(svg), Arc::new(fonts));
    }
    let text: String = svg.chars().filter_map(|c| instead.get(&c).copied().unwrap_or(Some(c))).collect();
    (Cow::Owned(text), Arc::new(fonts))
}

/// How a drawing is read with these fonts.
pub(crate) fn options(fonts: Arc<fontdb::Database>) -> usvg::Options<'static> {
    let font_resolver = usvg::FontResolver {
        select_font: usvg::FontResolver::default_font_selector(),
        select_fallback: Box::new(|c, used, fonts| {
            let fonts: &fontdb::Database = fonts;
            fonts.faces().find(|face| !used.contains(&face.id) && knows(fonts, face.id, c)).map(|face| face.id)
        }),
    };
    usvg::Options { fontdb: fonts, font_family: "Ubuntu".to_owned(), font_resolver, ..usvg::Options::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(words: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"300\" height=\"20\"><text y=\"15\" font-family=\"Ubuntu\">{words}</text></svg>"
        )
    }

    /// Glyphs of a drawing that no font could draw, and the number of all of them.
    fn glyphs(svg: &str, fonts: Arc<fontdb::Database>) -> (usize, usize) {
        fn of(group: &usvg::Group, found: &mut Vec<u16>) {
            for node in group.children() {
                match node {
                    usvg::Node::Group(group) => of(group, found),
                    usvg::Node::Text(text) => {
                        let spans = text.layouted().iter().flat_map(|span| &span.positioned_glyphs);
                        found.extend(spans.map(|glyph| glyph.id.0));
                    }
                    usvg::Node::Path(_) | usvg::Node::Image(_) => {}
                }
            }
        }
        let tree = usvg::Tree::from_str(svg, &options(fonts)).unwrap();
        let mut found = Vec::new();
        of(tree.root(), &mut found);
        (found.iter().filter(|id| **id == 0).count(), found.len())
    }

    #[test]
    fn every_character_is_drawn_or_replaced_visibly() {
        let words = "a nurse 一位护士 😀🤖 → é ŝ \u{10ffff}";
        let svg = drawing(words);
        let (text, fonts) = readable(&svg);
        assert_eq!(glyphs(&text, fonts), (0, words.chars().count()));
        // Without any font of the system nothing is left out either.
        let (shipped, none) = (shipped(), fontdb::Database::new());
        let lacking: BTreeSet<char> = "一位护士\u{10ffff}".chars().collect();
        let (text, fonts) = completed(&svg, &lacking, &shipped, &none);
        assert!(text.contains("a nurse □□□□ 😀"), "{text}");
        assert_eq!(fonts.len(), shipped.len());
        assert!(shipped.faces().any(|face| draws(&shipped, face.id, MISSING)), "the sign itself can be drawn");
    }

    #[test]
    fn what_is_not_seen_is_no_missing_character() {
        let svg = drawing("a\u{200d}b\u{fe0f}c");
        let (text, _) = readable(&svg);
        assert!(text.contains(">abc<"), "{text}");
    }

    #[test]
    fn a_font_of_the_system_draws_what_the_shipped_ones_lack() {
        // Shipped fonts stand for those of a system: of the two only one has this character.
        let all = shipped();
        let having = |c: char| all.faces().filter(|face| draws(&all, face.id, c)).count();
        let c = ('\u{2190}'..'\u{2700}').find(|c| having(*c) == 1).unwrap();
        let mut few = fontdb::Database::new();
        for face in all.faces().filter(|face| !draws(&all, face.id, c)) {
            few.push_face_info(face.clone());
        }
        assert_eq!(few.len() + 1, all.len());
        let drawn = c.to_string();
        let (text, fonts) = completed(&drawn, &BTreeSet::from([c]), &few, &all);
        assert_eq!((text.as_ref(), fonts.len()), (drawn.as_str(), all.len()));
        assert!(fonts.faces().any(|face| draws(&fonts, face.id, c)));
    }
}
