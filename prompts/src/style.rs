//! How a question is put and in which form it is answered. Experiments vary it; results do not mix styles unseen, as every
//! exchange names its own.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use socrates_model::{Fault, FaultCode, Where};

/// Prefix of the settings that choose a style.
const PREFIX: &str = "prompt.";

/// An enum whose values are words of a setting.
macro_rules! words {
    ($(#[$about:meta])* $name:ident { $($(#[$each:meta])* $variant:ident = $word:literal),+ $(,)? }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum $name { $($(#[$each])* $variant),+ }

        impl $name {
            /// Every value.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The word of the setting.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $word),+ }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }

        impl FromStr for $name {
            type Err = String;

            fn from_str(word: &str) -> Result<Self, String> {
                Self::ALL.iter().copied().find(|value| value.name() == word).ok_or_else(|| {
                    let known: Vec<&str> = Self::ALL.iter().map(|value| value.name()).collect();
                    format!("`{word}` is unknown; allowed: {}", known.join(", "))
                })
            }
        }
    };
}

words! {
    /// How much a question explains.
    Mode {
        /// Rules, tables, worked examples, an enforced form, the picture of the map.
        #[default]
        Structured = "structured",
        /// The task and the form in a few sentences: the baseline of ablations.
        Naive = "naive",
    }
}

words! {
    /// How paths are written.
    PathsForm {
        /// Start, places on the way, encounter, goal; the shortest ways between them are ours.
        #[default]
        Anchors = "anchors",
        /// Every node.
        Nodes = "nodes",
        /// Every node, in a form in which only a neighbor can come next.
        Walk = "walk",
    }
}

words! {
    /// How behaviors are written.
    BehaviorsForm {
        /// A list of typed rules, compiled to a tree by us.
        #[default]
        Rules = "rules",
        /// The tree as nested objects.
        JsonTree = "json_tree",
        /// The tree as XML.
        Xml = "xml",
    }
}

words! {
    /// The picture of the map.
    Image {
        /// None.
        Off = "off",
        /// Small: at most 512 pixels.
        #[default]
        Low = "low",
        /// At most 1024 pixels.
        High = "high",
    }
}

words! {
    /// What an author is told of its refused answer.
    Telling {
        /// Every fault with where it is and what is allowed.
        #[default]
        Named = "named",
        /// That it was wrong.
        Vague = "vague",
        /// Nothing: the same question again.
        Silent = "none",
    }
}

impl Image {
    /// Longest side of the picture, pixels.
    #[must_use]
    pub const fn side_px(self) -> u32 {
        match self {
            Self::Off => 0,
            Self::Low => 512,
            Self::High => 1024,
        }
    }
}

/// One way to put a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Style {
    /// How much is explained.
    pub mode: Mode,
    /// How paths are written.
    pub paths: PathsForm,
    /// How behaviors are written.
    pub behaviors: BehaviorsForm,
    /// The picture of the map.
    pub image: Image,
    /// What is told of a refused answer.
    pub feedback: Telling,
    /// Proposals in one answer, of which the best by the checks goes on. Default 1, at most [`MOST_VARIANTS`].
    pub variants: u32,
}

/// Most proposals in one answer.
pub const MOST_VARIANTS: u32 = 8;

impl Default for Style {
    fn default() -> Self {
        Self {
            mode: Mode::default(),
            paths: PathsForm::default(),
            behaviors: BehaviorsForm::default(),
            image: Image::default(),
            feedback: Telling::default(),
            variants: 1,
        }
    }
}

impl Style {
    /// The style that a job's settings ask for: `prompt.mode`, `prompt.paths`, `prompt.behaviors`, `prompt.image`,
    /// `prompt.feedback`, `prompt.variants`.
    ///
    /// # Errors
    /// `J-REQUEST` that names the setting and what it takes.
    pub fn from_settings(settings: &BTreeMap<String, String>) -> Result<Self, Fault> {
        let mut style = Self::default();
        for (key, word) in settings.range(PREFIX.to_owned()..).take_while(|(key, _)| key.starts_with(PREFIX)) {
            let read = match key.trim_start_matches(PREFIX) {
                "mode" => word.parse().map(|mode| style.mode = mode),
                "paths" => word.parse().map(|form| style.paths = form),
                "behaviors" => word.parse().map(|form| style.behaviors = form),
                "image" => word.parse().map(|image| style.image = image),
                "feedback" => word.parse().map(|telling| style.feedback = telling),
                "variants" => match word.parse() {
                    Ok(count) if (1..=MOST_VARIANTS).contains(&count) => {
                        style.variants = count;
                        Ok(())
                    }
                    Ok(_) | Err(_) => Err(format!("`{word}` is no number of proposals; allowed: 1 to {MOST_VARIANTS}")),
                },
                _ => Err("is no setting; allowed: prompt.mode, prompt.paths, prompt.behaviors, prompt.image, \
                          prompt.feedback, prompt.variants"
                    .to_owned()),
            };
            read.map_err(|why| Fault::new(FaultCode::JRequest, Where::key(key), why))?;
        }
        if style.mode == Mode::Naive {
            // Who explains nothing shows nothing, and asks for what the baseline asks for.
            style = Self {
                mode: Mode::Naive,
                paths: PathsForm::Nodes,
                behaviors: BehaviorsForm::Xml,
                image: Image::Off,
                ..style
            };
        }
        Ok(style)
    }

    /// The settings that ask for this style; only what differs from the default.
    #[must_use]
    pub fn settings(&self) -> BTreeMap<String, String> {
        let plain = Self::default();
        let mut settings = BTreeMap::new();
        let mut put = |name: &str, word: &str, differs: bool| {
            if differs {
                settings.insert(format!("{PREFIX}{name}"), word.to_owned());
            }
        };
        put("mode", self.mode.name(), self.mode != plain.mode);
        put("paths", self.paths.name(), self.paths != plain.paths);
        put("behaviors", self.behaviors.name(), self.behaviors != plain.behaviors);
        put("image", self.image.name(), self.image != plain.image);
        put("feedback", self.feedback.name(), self.feedback != plain.feedback);
        put("variants", &self.variants.to_string(), self.variants != plain.variants);
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
        pairs.iter().map(|(key, word)| ((*key).to_owned(), (*word).to_owned())).collect()
    }

    #[test]
    fn a_style_is_read_back_from_its_settings() {
        let style = Style { paths: PathsForm::Walk, image: Image::Off, ..Style::default() };
        assert_eq!(Style::from_settings(&style.settings()), Ok(style));
        assert!(Style::default().settings().is_empty());
        let others = settings(&[("author", "offline"), ("prompt.behaviors", "xml"), ("pace", "max")]);
        assert_eq!(Style::from_settings(&others).unwrap().behaviors, BehaviorsForm::Xml);
    }

    #[test]
    fn a_word_that_means_nothing_is_answered_with_those_that_do() {
        for (key, word) in
            [("prompt.paths", "edges"), ("prompt.color", "red"), ("prompt.variants", "9"), ("prompt.variants", "0")]
        {
            let fault = Style::from_settings(&settings(&[(key, word)])).unwrap_err();
            assert!(fault.at.to_string().contains(key) && fault.message.to_string().contains("allowed: "), "{fault}");
        }
    }

    #[test]
    fn the_naive_mode_is_the_baseline_whatever_else_is_asked() {
        let style = Style::from_settings(&settings(&[("prompt.mode", "naive"), ("prompt.paths", "walk")])).unwrap();
        assert_eq!((style.paths, style.image), (PathsForm::Nodes, Image::Off));
    }
}
