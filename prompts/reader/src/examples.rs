//! The examples of all rows, for the test that reads them.

use crate::lexicon::Lexicon;

/// An example of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Example<'a> {
    /// The file of its row.
    pub file: &'static str,
    /// The row by its name, or by what it gives.
    pub row: &'a str,
    /// The text.
    pub text: &'a str,
    /// A line of the story; of `rewrites.toml` and `scopes.toml` a text that is read the same way;
    /// of `edits.toml` what the first wish of the text asks for.
    pub gives: &'a str,
    /// Whether the text gives it, or must not.
    pub does: bool,
}

/// The examples in the order of the files.
pub(crate) fn all(lexicon: &Lexicon) -> Vec<Example<'_>> {
    let frames = lexicon.frames.iter().flat_map(|row| of("frames", &row.id, &row.reads, &row.not, &row.gives));
    let places = lexicon.places.iter().flat_map(|row| of("places", &row.gives, &row.reads, &row.not, &row.gives));
    let signs = lexicon.signs.iter().flat_map(|row| of("signs", &row.gives, &row.reads, &row.not, &row.gives));
    let rewrites = lexicon.rewrites.iter().flat_map(|row| of("rewrites", &row.id, &row.reads, &row.not, &row.gives));
    let scopes = lexicon.scopes.iter().flat_map(|row| of("scopes", &row.id, &row.reads, &row.not, &row.gives));
    let edits = lexicon.edits.rows.iter().flat_map(|row| {
        let name = row.edit.name();
        of("edits", name, &row.reads, &row.not, name)
    });
    frames.chain(places).chain(signs).chain(rewrites).chain(scopes).chain(edits).collect()
}

fn of<'a>(
    file: &'static str,
    row: &'a str,
    reads: &'a [String],
    not: &'a [String],
    gives: &'a str,
) -> Vec<Example<'a>> {
    let one = |text: &'a String, does| Example { file, row, text, gives, does };
    reads.iter().map(|text| one(text, true)).chain(not.iter().map(|text| one(text, false))).collect()
}
