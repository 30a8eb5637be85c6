//! Which of those who are there a number or a word picks.

use socrates_model::{Fault, FaultCode, Relation};

use crate::cast::{Cast, Together};
use crate::mention::Mention;

impl Cast {
    pub(crate) fn declared_open(&self) -> bool {
        self.sets.last().is_some_and(|set| set.total && self.open(set).next().is_some())
    }

    pub(crate) fn open<'a>(&'a self, set: &'a Together) -> impl Iterator<Item = usize> + 'a {
        set.members.iter().copied().filter(|i| self.people.get(*i).is_some_and(|person| !person.bound))
    }

    pub(crate) fn fits(&self, i: usize, role: Option<&String>) -> bool {
        role.is_none_or(|role| self.people.get(i).is_some_and(|person| person.role.is_empty() || person.role == *role))
    }

    /// Whether those who are there were counted for what comes after, or one of them was told apart already.
    pub(crate) fn parted(&self) -> bool {
        let idle = |i: &usize| self.people.get(*i).is_some_and(|person| person.doings.is_empty());
        let bound = |i: &usize| self.people.get(*i).is_some_and(|person| person.bound);
        self.sets.iter().any(|set| {
            set.members.len() > 1 && (set.total || set.members.iter().all(idle) || set.members.iter().any(bound))
        })
    }

    /// Whether the same was told of all who were introduced last: `two drivers wait there; one …`.
    pub(crate) fn alike_so_far(&self) -> bool {
        let Some(set) = self.sets.last().filter(|set| set.members.len() > 1) else { return false };
        let mut told =
            set.members.iter().filter_map(|who| self.people.get(*who)).map(|person| (person.bound, &person.doings));
        let first = told.next();
        first.is_some_and(|(bound, _)| bound) && told.all(|other| Some(other) == first)
    }

    /// Whether nothing was told of any of these.
    pub(crate) fn idle(&self, people: &[usize]) -> bool {
        people.iter().all(|i| self.people.get(*i).is_some_and(|person| person.doings.is_empty()))
    }

    /// Some of the open people of the newest set that fit.
    pub(crate) fn pick_open(&self, n: u32, mention: &Mention) -> Option<Vec<usize>> {
        let wanted = usize::try_from(n).ok()?;
        self.sets.iter().rev().find_map(|set| {
            let open: Vec<usize> = self.open(set).filter(|i| self.fits(*i, mention.role.as_ref())).collect();
            if set.members.len() > 1 && open.len() >= wanted && wanted < set.members.len() {
                open.get(..wanted).map(<[usize]>::to_vec)
            } else {
                None
            }
        })
    }

    /// Whether the text said how many there are in all, and not yet who: `there are four people. A doctor …`
    pub(crate) fn counted_for_all(&self) -> bool {
        let nameless = |i: &usize| self.people.get(*i).is_some_and(|person| person.role.is_empty());
        self.sets
            .first()
            .is_some_and(|set| set.total && set.members.len() == self.people.len() && set.members.iter().any(nameless))
    }

    /// Some of the newest set of whom nothing says who they are: `two people who …: a nurse and a visitor`.
    pub(crate) fn pick_nameless(&self, n: u32) -> Option<Vec<usize>> {
        let wanted = usize::try_from(n).ok()?;
        let nameless = |i: &usize| self.people.get(*i).is_some_and(|person| person.role.is_empty());
        self.sets.iter().rev().find_map(|set| {
            let found: Vec<usize> = set.members.iter().copied().filter(nameless).take(wanted).collect();
            (found.len() == wanted).then_some(found)
        })
    }

    /// As [`Self::pick_open`]; says so where a total that was given is too small.
    pub(crate) fn pick(&mut self, n: u32, mention: &Mention, quote: &str) -> Option<Vec<usize>> {
        if let Some(found) = self.pick_open(n, mention) {
            return Some(found);
        }
        let (total, first) =
            self.sets.iter().find(|set| set.total).map(|set| (set.members.len(), set.quote.clone()))?;
        let open: Vec<usize> =
            (0..self.people.len()).filter(|i| self.people.get(*i).is_some_and(|p| !p.bound)).collect();
        let all_named = self.people.iter().any(|person| person.bound);
        if !all_named || mention.role.is_some() && open.len() == total {
            return None;
        }
        self.problems.push(Fault::new(
            FaultCode::PContra,
            "rough_scenario",
            format!("`{first}` gives {total} humans, but `{quote}` asks for {n} more than the {} left; correct one of the two", open.len()),
        ).about([first.as_str(), quote]));
        Some(open)
    }

    /// Whom a robot that comes from behind gets past: those spoken of last, if they may go its way.
    pub(crate) fn overtaken(&self) -> Vec<usize> {
        let ahead = |i: &usize| {
            let relation = self.people.get(*i).and_then(|person| person.relation.as_ref());
            relation.is_none_or(|(relation, _)| *relation == Relation::Ahead)
        };
        if self.last.iter().all(ahead) { self.last.clone() } else { Vec::new() }
    }

    /// So many of the newest set who were not counted apart yet, though all of them did something already.
    pub(crate) fn counted(&mut self, n: u32) -> Option<Vec<usize>> {
        let wanted = usize::try_from(n).ok()?;
        let set = self.sets.last_mut().filter(|set| set.members.len() > wanted)?;
        let open: Vec<usize> = set.members.iter().copied().filter(|i| !set.counted.contains(i)).take(wanted).collect();
        if open.len() < wanted {
            return None;
        }
        set.counted.extend(&open);
        Some(open)
    }
}
