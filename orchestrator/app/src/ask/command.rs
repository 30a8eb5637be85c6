//! What a person types at a look: a few commands; everything else is a wish in words.

use socrates_model::job::Stage;

/// One line of a person.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Command {
    /// Goes on with what is shown.
    Accept,
    /// Has these stages made again, with a reason or none; without a stage: what the look is about.
    Again(Option<Stage>, String),
    /// Opens a part in the person's editor; nothing named: what the look is about.
    Edit(String),
    /// Takes the last change back.
    Undo,
    /// Goes back to the look before.
    Back,
    /// Shows everything again.
    Show,
    /// Shows the map.
    Map,
    /// Shows what changed since the authors wrote it.
    Diff,
    /// Takes another of the proposals that were made.
    Take(u32),
    /// Leaves; the same command resumes.
    Quit,
    /// Says what can be typed.
    Help,
    /// What should change, in words.
    Words(String),
}

impl Command {
    /// Reads a line. A command is one word, or one of `again`, `reject`, `edit`, `take` with what belongs to it; any other
    /// line is a wish.
    pub(super) fn read(line: &str) -> Self {
        let line = line.trim();
        let (first, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let (first, rest) = (first.trim_end_matches([':', ',']).to_lowercase(), rest.trim());
        let alone = rest.is_empty();
        match first.as_str() {
            "" | "help" | "h" | "?" if alone => Self::Help,
            "accept" | "a" | "ok" | "y" | "yes" if alone => Self::Accept,
            "undo" | "u" if alone => Self::Undo,
            "back" | "b" if alone => Self::Back,
            "show" | "s" if alone => Self::Show,
            "map" | "m" if alone => Self::Map,
            "diff" | "d" if alone => Self::Diff,
            "quit" | "q" | "exit" | "leave" if alone => Self::Quit,
            "reject" | "r" | "no" | "n" if alone || first == "reject" => Self::Again(None, reason(rest)),
            "again" | "regenerate" => {
                let (word, why) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                match stage(word.trim_end_matches([':', ','])) {
                    Some(stage) => Self::Again(Some(stage), reason(why)),
                    None => Self::Again(None, reason(rest)),
                }
            }
            "edit" | "e" if alone || stage(rest).is_some() || rest.starts_with("human_") && !rest.contains(' ') => {
                Self::Edit(rest.to_lowercase())
            }
            "take" if rest.parse::<u32>().is_ok() => Self::Take(rest.parse().unwrap_or(1)),
            _ => Self::Words(line.to_owned()),
        }
    }
}

/// A reason without the word that leads it.
fn reason(text: &str) -> String {
    let text = text.trim();
    text.strip_prefix("because ").unwrap_or(text).trim_start().to_owned()
}

/// An authoring stage by the names people give it.
pub(super) fn stage(word: &str) -> Option<Stage> {
    match word.to_lowercase().as_str() {
        "proposal" | "scenario" => Some(Stage::Proposal),
        "paths" | "path" | "ways" => Some(Stage::Paths),
        "behaviors" | "behavior" | "behaviours" | "behaviour" | "trees" => Some(Stage::Behaviors),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_word_is_a_command_and_a_sentence_is_a_wish() {
        assert_eq!(Command::read(" accept "), Command::Accept);
        assert_eq!(Command::read(""), Command::Help);
        assert_eq!(Command::read("no"), Command::Again(None, String::new()));
        assert_eq!(Command::read("reject: too crowded"), Command::Again(None, "too crowded".to_owned()));
        assert_eq!(Command::read("again paths, longer"), Command::Again(Some(Stage::Paths), "longer".to_owned()));
        assert_eq!(Command::read("again too crowded"), Command::Again(None, "too crowded".to_owned()));
        assert_eq!(Command::read("again because it is dull"), Command::Again(None, "it is dull".to_owned()));
        assert_eq!(Command::read("edit human_2"), Command::Edit("human_2".to_owned()));
        assert_eq!(Command::read("take 2"), Command::Take(2));
        for wish in ["make the robot's path longer", "no gestures", "back human_1 off", "edit it so that", "take care"]
        {
            assert_eq!(Command::read(wish), Command::Words(wish.to_owned()));
        }
    }
}
