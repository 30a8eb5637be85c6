//! Whom words for people mean.

/// Whom a mention means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Who {
    /// Somebody not spoken of before: `two nurses`, `a visitor`.
    New {
        /// How many; `None` for a bare plural.
        count: Option<u32>,
        /// By `a` or `an`, which never picks from those who are there.
        article: bool,
    },
    /// `another`, `two more`.
    More(u32),
    /// `one of them`.
    PartOf(u32),
    /// `one of three visitors`: so many, of how many.
    PartOfNew(u32, u32),
    /// `both visitors`, `neither of the two nurses`: all of so many.
    AllOf(u32),
    /// `the taller one`: somebody told from the others by a word.
    ToldApart,
    /// `one`, `two` without a noun.
    Bare(u32),
    /// `the other`, `the rest`; `None` for all the others.
    Other(Option<u32>),
    /// `the first`, `the second`; 0 for `the last`.
    Ordinal(u32),
    /// `the first two`, `the last three`.
    Some {
        /// From the beginning, else from the end.
        first: bool,
        /// How many.
        count: u32,
    },
    /// `the nurse`, `the employees`.
    Definite {
        /// More than one.
        plural: bool,
        /// `the two nurses`.
        count: Option<u32>,
    },
    /// `they`, `both`, `everyone`.
    All,
    /// `all three`, `all three of them`: those who are there, told to be so many.
    SoMany(u32),
    /// `all but one`: so many are left out.
    AllBut(u32),
    /// `the second of two visitors`.
    OrdinalOf {
        /// Which, from 1; 0 for the last.
        number: u32,
        /// Of how many.
        count: u32,
    },
    /// `he`, `she`, `who`.
    Same,
    /// `him`, `her`: somebody spoken of before, as the object.
    Object,
    /// `a third`, `a fourth one`.
    Further(u32),
    /// `human 2`.
    Number(u32),
    /// `nobody`, `no people`.
    Nobody,
}
