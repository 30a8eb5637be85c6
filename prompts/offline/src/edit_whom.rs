//! The people that an edit speaks of, among the people of a scenario.

use socrates_model::Proposal;
use socrates_reader::{Read, Reader};

use crate::edit_wish::Wish;

/// The people of a scenario by their roles, and those of whom an edit spoke last.
#[derive(Clone)]
pub(crate) struct Crowd {
    roles: Vec<String>,
    last: Vec<usize>,
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
        Self { roles: proposal.humans.iter().map(|human| human.role.clone()).collect(), last: Vec::new() }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.roles.len()
    }

    /// The same people as they are now; those of whom was spoken last are these.
    pub(crate) fn now(&mut self, proposal: &Proposal, last: Vec<usize>) {
        *self = Self { last, ..Self::of(proposal) };
    }

    /// Whether words speak of one of several as a man or a woman, and nobody is called so: then it is anybody's guess who is meant.
    pub(crate) fn is_guess(&self, wish: &Wish) -> bool {
        Reader::shipped().whom(&wish.quote, &self.roles, &self.last).guess
    }

    /// The people that the words mean; those who are not there are nobody.
    pub(crate) fn whom(&mut self, wish: &Wish) -> Whom {
        let found = Reader::shipped().whom(&wish.quote, &self.roles, &self.last);
        if !found.people.is_empty() {
            self.last.clone_from(&found.people);
        }
        match (found.people.is_empty(), found.robot) {
            (false, _) => Whom::People(found.people),
            (true, true) => Whom::Robot,
            (true, false) => Whom::Unsaid,
        }
    }

    /// What the words say of them, and of others who join.
    pub(crate) fn read(&self, wish: &Wish) -> Read {
        Reader::shipped().read_of(&wish.quote, &self.roles, &self.last)
    }
}
