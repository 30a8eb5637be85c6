//! What the proposal's question says only where the words of a request call for it: what is seldom needed would cost every other request
//! its tokens. Nothing here decides what an answer may say: the form and the checks know every test.

/// Something to say of requests with certain words.
struct Hint {
    /// Beginnings of words, in lower case.
    words: &'static [&'static str],
    /// What is said.
    says: &'static str,
}

/// Hints in the order in which they are told.
const HINTS: [Hint; 9] = [
    Hint {
        words: &[
            "group", "together", "team", "pair", "couple", "talk", "chat", "convers", "discuss", "friend", "family",
        ],
        says: "People who stand or walk together are a group; people who only come at the same time are none. Talking is standing in a \
               group: `formation` is its test as well, a line for each fact. What one member does besides has a rule and a test of their \
               own. Distances in their rules: at most 2.5, as a standing group holds until 3.",
    },
    Hint {
        words: &["inside", "elevator", "lift", "room", "out", "leav", "exit", "emerg"],
        says: "Inside at the beginning: relation `leaving` or `staying`, tests `leaves`, `stays_inside`. How many are inside is \
               shown by `humans`, and is no fact of its own if stated. Out of a door and across the robot's way: relation `leaving`, \
               tests `leaves` and `crosses`. Doors open by themselves.",
    },
    Hint {
        words: &["startl", "surpris", "frighten", "scare", "afraid", "shock", "fear", "nervous"],
        says: "A feeling shows as an action: startled or surprised people `look_at_robot`, frightened ones `run_away`.",
    },
    Hint {
        words: &["follow", "guid", "accompan", "escort", "lead"],
        says: "Following the robot: relation `behind` or `ahead`, a rule such as `robot_near:5 -> follow_robot`, the test `follows \
               follower=human_1 leader=robot`.",
    },
    Hint {
        words: &["block", "obstruct", "let", "while", "until", "then"],
        says: "One thing and then another: a rule with `for` ends, and the next with the same trigger goes on, as in `robot_near:3 -> \
               block for=6`, `robot_near:3 -> give_way`.",
    },
    Hint {
        words: &["carry", "carri", "bring", "deliver", "fetch", "push", "take", "move", "transport", "load"],
        says: "What the robot carries or delivers, and where it goes on to, is its errand: no fact of the run.",
    },
    Hint {
        words: &["wait"],
        says: "Waiting for the robot: `stand_still` under a trigger. The robot's waiting is a line of its script, or an outcome.",
    },
    Hint { words: &["queu"], says: "A queue is a standing group with `queues`." },
    Hint {
        words: &["wheelchair", "phone", "cart", "trolley", "crutch", "suitcase"],
        says: "What people hold or sit in is not played: their pace and what they do is; say it with `cannot_be_played`.",
    },
];

/// The words of a request, in lower case.
pub(crate) struct Words(Option<Vec<String>>);

impl Words {
    /// The words of a text.
    pub(crate) fn of(text: &str) -> Self {
        let lower = text.to_lowercase();
        Self(Some(lower.split(|c: char| !c.is_alphanumeric()).map(str::to_owned).collect()))
    }

    /// Those of which nobody can tell what they call for: everything.
    pub(crate) const fn unknown() -> Self {
        Self(None)
    }

    /// Whether one of them begins so.
    pub(crate) fn call_for(&self, beginnings: &[&str]) -> bool {
        let begins = |word: &String| beginnings.iter().any(|beginning| word.starts_with(beginning));
        self.0.as_ref().is_none_or(|words| words.iter().any(begins))
    }
}

/// The hints that words call for.
pub(crate) fn of(words: &Words) -> impl Iterator<Item = &'static str> {
    HINTS.iter().filter(|hint| words.call_for(hint.words)).map(|hint| hint.says)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hint_comes_with_its_words_and_without_them_stays_away() {
        let told = |text: &str| of(&Words::of(text)).collect::<Vec<_>>();
        assert!(told("A nurse crosses its way.").is_empty());
        assert_eq!(told("Two nurses CHAT.").len(), 1);
        assert!(told("Two nurses chat.")[0].contains("`formation`"));
        // A word inside another one calls for nothing.
        assert!(told("An unfriendly steam pipe").is_empty());
        assert_eq!(of(&Words::unknown()).count(), HINTS.len());
    }

    #[test]
    fn every_hint_speaks_of_what_the_tables_have() {
        let tables = crate::vocabulary::proposal_tables() + &crate::vocabulary::called_for(&Words::unknown());
        for Hint { words, says } in &HINTS {
            assert!(words.iter().all(|word| !word.is_empty() && *word == word.to_lowercase()), "{words:?}");
            for name in says.split('`').skip(1).step_by(2).flat_map(|code| code.split([' ', ':', '='])) {
                let known = name.starts_with(|c: char| c.is_lowercase()) && name.contains('_');
                assert!(!known || name == "cannot_be_played" || name == "human_1" || tables.contains(name), "{name}");
            }
        }
    }
}
