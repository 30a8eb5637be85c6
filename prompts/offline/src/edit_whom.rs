//! The people that an edit speaks of, among the people of a scenario.

use socrates_model::{HumanProposal, Proposal};

use crate::cast::{Cast, Person, plain};
use crate::edit_wish::Wish;
use crate::lexicon::lexicon;
use crate::mention::{Mention, Who, mentions};

/// The people as the grammar knows them.
pub(crate) struct Crowd {
    pub(crate) cast: Cast,
}

/// The people that an edit speaks of.
pub(crate) enum Whom {
    Robot,
    People(Vec<usize>),
    /// Nobody by name.
    Unsaid,
}

impl Crowd {
    pub(crate) fn of(proposal: &Proposal) -> Self {
        Self { cast: Cast::known(proposal.humans.iter().map(person).collect()) }
    }

    /// Whether words speak of one of several as a man or a woman, and nobody is called so: then it is anybody's guess who is meant.
    pub(crate) fn is_guess(&self, wish: &Wish) -> bool {
        let called = |role: &str| self.cast.people.iter().any(|person| person.role == role);
        let one = |mention: &Mention| {
            let role = mention.role.as_deref().filter(|role| plain(role));
            matches!(mention.who, Who::Definite { plural: false, .. }) && role.is_some_and(|role| !called(role))
        };
        self.cast.people.len() > 1 && wish.clauses.iter().any(|clause| mentions(&clause.words).iter().any(one))
    }

    /// The people that the words mean; those who are not there are nobody.
    pub(crate) fn whom(&mut self, wish: &Wish) -> Whom {
        let mut found = Vec::new();
        let mut robot = false;
        for clause in &wish.clauses {
            robot |= clause.words.iter().any(|word| {
                matches!(word.text.as_str(), "robot" | "robots" | "robot's" | "amr" | "agv")
                    || word.stem == "robot" && word.text == "its"
            });
            for mention in mentions(&clause.words) {
                let before = self.cast.clone();
                let some = self.cast.resolve(&mention, false, "");
                if self.cast.people.len() > before.people.len() {
                    self.cast = before;
                    continue;
                }
                if !some.is_empty() {
                    self.cast.last.clone_from(&some);
                }
                found.extend(some.into_iter().filter(|i| !found.contains(i)).collect::<Vec<_>>());
            }
        }
        let pronoun = wish.clauses.iter().flat_map(|clause| &clause.words);
        let pronoun =
            pronoun.clone().any(|word| matches!(word.text.as_str(), "her" | "his" | "him" | "their" | "them"));
        if found.is_empty() && !robot && pronoun {
            found.clone_from(&self.cast.last);
        }
        match (found.is_empty(), robot) {
            (false, _) => Whom::People(found),
            (true, true) => Whom::Robot,
            (true, false) => Whom::Unsaid,
        }
    }
}

/// A human under the noun by which an edit can call them: of a role in several words (`elderly man`) the last that is one.
pub(crate) fn person(human: &HumanProposal) -> Person {
    let known = |word: &&str| plain(word) || lexicon().roles.contains_key(*word);
    let words = || human.role.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let whole = lexicon().roles.contains_key(&human.role);
    let noun = if whole { None } else { words().rfind(known) };
    let role = if human.role == "person" { "" } else { noun.unwrap_or(&human.role) }.to_owned();
    Person { role, group: human.group, bound: true, ..Person::default() }
}
