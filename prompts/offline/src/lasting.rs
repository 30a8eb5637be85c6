//! Words that mean all of the time, or never.

/// Whether the words leave no exception.
pub(crate) fn always(quote: &str) -> bool {
    let lower = quote.to_lowercase();
    whole(&lower)
        || ["never", "at any time", "at no ", "under no ", "at all", "any point"]
            .iter()
            .any(|words| lower.contains(words))
}

/// Whether the words mean all of the time.
pub(crate) fn whole(quote: &str) -> bool {
    [
        "the whole run",
        "the whole time",
        "the entire",
        "throughout",
        "all the time",
        "at all times",
        "from beginning to end",
        "from start to finish",
        "from start to end",
        "from the beginning to the end",
        "from the begining to the end",
        "from beginning",
        "from the start to the end",
        "the whole scenario",
        "the complete run",
        "during the whole",
        "for the whole of",
    ]
    .iter()
    .any(|words| quote.contains(words))
}
