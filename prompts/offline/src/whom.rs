//! Whom a mention means among those who are there: `he`, `the other`, `one of them`, `the nurse`.

use socrates_model::{Fault, FaultCode};

use crate::cast::{Cast, plain};
use crate::lexicon::lexicon;
use crate::mention::Mention;

const WOMEN: &[&str] = &[
    "woman",
    "lady",
    "girl",
    "mother",
    "wife",
    "sister",
    "aunt",
    "grandmother",
    "grandma",
    "daughter",
    "mom",
    "waitress",
    "niece",
];
const MEN: &[&str] = &[
    "man",
    "gentleman",
    "boy",
    "father",
    "husband",
    "brother",
    "uncle",
    "grandfather",
    "grandpa",
    "son",
    "dad",
    "guy",
    "nephew",
];

/// A number that is so much larger than the number of those who are there is a name.
const LABEL_GAP: u32 = 4;

impl Cast {
    /// Whom `he` or `she` means: one of those spoken of last whom the word fits.
    pub(crate) fn single(&self, word: &str) -> Vec<usize> {
        let of = |i: usize, words: &[&str]| {
            let own = if words == WOMEN { "she" } else { "he" };
            self.people.get(i).is_some_and(|person| {
                person.pronoun.as_deref().map_or_else(|| words.contains(&person.role.as_str()), |said| said == own)
            })
        };
        if self.last.is_empty() {
            return Vec::new();
        }
        let (own, other) = match word {
            "she" => (WOMEN, MEN),
            "he" => (MEN, WOMEN),
            _ => return self.last.clone(),
        };
        // Whoever asks is `I`.
        let asks = |i: usize| self.people.get(i).is_some_and(|person| person.role == crate::asker::NAME);
        let else_of = |i: usize| of(i, other) || asks(i);
        if let [only] = self.last.as_slice()
            && !else_of(*only)
        {
            return self.last.clone();
        }
        // `a manager shows three visitors around …; she …`
        if let ([only], true) = (self.before.as_slice(), self.last.len() > 1)
            && !self.last.contains(only)
            && !else_of(*only)
            && !self.last.iter().any(|i| of(*i, own))
        {
            return vec![*only];
        }
        let near = || self.last.iter().copied().chain((0..self.people.len()).rev());
        let found =
            near().find(|i| of(*i, own)).filter(|_| !self.last.iter().any(|i| !else_of(*i) && self.last.len() == 1));
        found.or_else(|| near().find(|i| !else_of(*i))).map_or_else(|| self.last.clone(), |i| vec![i])
    }

    /// `What if a human competes with the robot?`: those of a question of whom nothing is told that could be played are nobody.
    pub(crate) fn forget_idle(&mut self) {
        let idle = |person: &crate::cast::Person| {
            person.doings.is_empty() && person.rules.is_empty() && person.relation.is_none() && !person.bound
        };
        while let Some(last) = self.people.len().checked_sub(1).filter(|last| self.supposed_people.contains(last)) {
            if !self.people.last().is_some_and(idle) {
                return;
            }
            self.drop_last(last);
        }
    }

    fn drop_last(&mut self, last: usize) {
        self.people.pop();
        self.supposed_people.retain(|i| *i != last);
        self.last.retain(|i| *i != last);
        self.before.retain(|i| *i != last);
        for set in &mut self.sets {
            set.members.retain(|i| *i != last);
            set.counted.retain(|i| *i != last);
        }
        self.sets.retain(|set| !set.members.is_empty());
    }

    /// Those who were only supposed with somebody of whom it is now said what is wanted, if they are the last ones.
    pub(crate) fn forget(&mut self, wanted: &[usize]) {
        while let Some(last) = self.people.len().checked_sub(1).filter(|last| self.supposed_people.contains(last)) {
            let together = self
                .sets
                .iter()
                .any(|set| set.members.contains(&last) && wanted.iter().any(|i| set.members.contains(i)));
            if !together {
                return;
            }
            self.drop_last(last);
        }
    }

    /// Whether a number names somebody rather than counting: nobody counts to 12 at once.
    pub(crate) fn is_label(&self, n: u32) -> bool {
        let there = u32::try_from(self.people.len()).unwrap_or(u32::MAX);
        !self.labels.is_empty() || n > there.saturating_add(LABEL_GAP)
    }

    /// Whoever is called by this number.
    pub(crate) fn labelled(&mut self, n: u32, mention: &Mention, quote: &str) -> Vec<usize> {
        if let Some((_, who)) = self.labels.iter().find(|(label, _)| *label == n) {
            return vec![*who];
        }
        let joined = self.join(1, mention, false, quote);
        self.labels.extend(joined.iter().map(|who| (n, *who)));
        joined
    }

    /// `all three`: those of whom the text spoke, if they are so many; else it says so.
    pub(crate) fn so_many(&mut self, n: u32, mention: &Mention, quote: &str) -> Vec<usize> {
        let wanted = usize::try_from(n).unwrap_or(usize::MAX);
        let everybody: Vec<usize> = (0..self.people.len()).collect();
        let sets = self.sets.iter().rev().map(|set| &set.members);
        if let Some(found) = std::iter::once(&self.last).chain(sets).chain([&everybody]).find(|set| set.len() == wanted)
        {
            return found.clone();
        }
        if everybody.is_empty() {
            return self.join(n, mention, false, quote);
        }
        let them = if self.last.len() > 1 { self.last.clone() } else { self.latest() };
        let exactly = self.sets.iter().any(|set| set.total);
        if !exactly && everybody.len() > 1 && wanted == everybody.len() + 1 {
            self.notes.push(format!("`{quote}` was read as the {} humans and the robot", everybody.len()));
            return everybody;
        }
        let first = self.count_quote.as_ref().map_or_else(|| "the text".to_owned(), |quote| format!("`{quote}`"));
        self.problems.push(Fault::new(
            FaultCode::PContra,
            "rough_scenario",
            format!("{first} speaks of {} humans, but `{quote}` of {n}; correct one of the two", them.len()),
        ));
        them
    }

    /// The third of exactly two, said of everybody who is there.
    pub(crate) fn beyond(&mut self, n: u32, quote: &str) {
        let last = self.sets.iter().rev().find(|set| set.members.len() > 1).filter(|set| set.total);
        let Some((first, members)) = last
            .filter(|set| {
                usize::try_from(n).is_ok_and(|n| n > set.members.len()) && set.members.len() == self.people.len()
            })
            .map(|set| (set.quote.clone(), set.members.len()))
        else {
            return;
        };
        self.problems.push(Fault::new(
            FaultCode::PContra,
            "rough_scenario",
            format!("`{first}` gives {members} humans, but `{quote}` speaks of one more; correct one of the two"),
        ));
    }

    /// `Sometimes a patient follows it. Make a patient follow it …`: the same one, of whom it is now said what is wanted.
    pub(crate) fn supposes(&self, n: u32, mention: &Mention) -> Option<Vec<usize>> {
        if self.supposed || n == 0 {
            return None;
        }
        let wanted = usize::try_from(n).ok()?;
        let fitting = |i: &usize| self.fits(*i, mention.role.as_ref());
        let found: Vec<usize> = self.supposed_people.iter().copied().filter(fitting).take(wanted).collect();
        if found.len() == wanted { Some(found) } else { None }
    }

    pub(crate) fn part_of(&mut self, n: u32, mention: &Mention, quote: &str) -> Vec<usize> {
        let wanted = usize::try_from(n).unwrap_or(usize::MAX);
        if let Some(found) = self.pick_open(n, mention) {
            return found;
        }
        let mut set = self.latest();
        // `one of the visitors`, where others are there too
        if let Some(role) = &mention.role {
            let is = |i: &usize| self.people.get(*i).is_some_and(|person| person.role == *role);
            let alike: Vec<usize> = (0..self.people.len()).filter(is).collect();
            if alike.len() > wanted {
                set = alike;
            }
        }
        // `Those people who wait there: give me three of them.`
        if let Some(first) =
            set.first().copied().filter(|_| self.supposed_people.len() == set.len() && wanted > set.len())
        {
            let model = self.people.get(first).cloned().unwrap_or_default();
            while set.len() < wanted {
                set.push(self.people.len());
                self.people.push(model.clone());
            }
            self.supposed_people.clear();
            self.together(&set, quote);
            return set;
        }
        if !set.is_empty() && wanted <= set.len() {
            // `the taller one follows the other; the shorter one …`: rather somebody else than who did the last thing.
            set.sort_by_key(|i| self.last.contains(i));
            return set.into_iter().take(wanted).collect();
        }
        self.join(n, mention, false, quote)
    }

    pub(crate) fn others(&mut self, count: Option<u32>, mention: &Mention, quote: &str) -> Vec<usize> {
        let open: Vec<usize> = self
            .sets
            .iter()
            .rev()
            .map(|set| self.open(set).filter(|i| !self.last.contains(i)).collect::<Vec<_>>())
            .find(|open| !open.is_empty())
            .unwrap_or_default();
        let wanted = count.map_or(open.len(), |n| usize::try_from(n).unwrap_or(usize::MAX));
        if wanted > 0 && open.len() >= wanted {
            return open.into_iter().take(wanted).collect();
        }
        // `the other` of two who were both spoken of already: whoever is not the last one.
        let set = self.latest();
        let rest: Vec<usize> = set.iter().copied().filter(|i| !self.last.contains(i)).collect();
        if set.len() > 1 && count.is_none_or(|_| rest.len() == wanted) && !rest.is_empty() {
            return rest;
        }
        self.join(count.unwrap_or(1), &self.alike(&Mention { word: "one".to_owned(), ..mention.clone() }), false, quote)
    }

    /// `one visitor flees, another one looks`: another visitor.
    pub(crate) fn alike(&self, mention: &Mention) -> Mention {
        let alike = self.last.first().and_then(|i| self.people.get(*i)).map(|person| person.role.clone());
        let alike =
            alike.filter(|role| !role.is_empty() && mention.word == "one" && lexicon().roles.contains_key(role));
        Mention { role: mention.role.clone().or(alike), ..mention.clone() }
    }

    pub(crate) fn definite(
        &mut self,
        plural: bool,
        count: Option<u32>,
        mention: &Mention,
        declares: bool,
        quote: &str,
    ) -> Vec<usize> {
        if mention.group && !self.groups.is_empty() {
            // `the pair` and `the group` of those that there are.
            let wanted = count.and_then(|n| usize::try_from(n).ok());
            let fits = |members: &&Vec<usize>| wanted.map_or(members.len() > 2, |n| members.len() == n);
            let named = self.groups.iter().rev().map(|(_, members, _)| members);
            let last = self.groups.last().map(|(_, members, _)| members);
            if let Some(members) = named.clone().find(fits).or_else(|| last.filter(|_| wanted.is_none())) {
                return members.clone();
            }
        }
        // `Two students come. Mia moves aside, Ben does not.`
        if mention.word == "name"
            && let Some(name) = &mention.role
            && !self.people.iter().any(|person| person.name.as_ref() == Some(name) || person.role == *name)
        {
            let nameless = |i: &usize| {
                self.people.get(*i).is_some_and(|person| {
                    person.name.is_none() && (person.role.is_empty() || lexicon().roles.contains_key(&person.role))
                })
            };
            let set = self.sets.iter().rev().find(|set| set.members.len() > 1 && set.members.len() == self.names.len());
            let place = self.names.iter().position(|known| known == name).unwrap_or(0);
            if let Some(who) = set.and_then(|set| set.members.get(place).copied().filter(nameless)) {
                if let Some(person) = self.people.get_mut(who) {
                    person.name = Some(name.clone());
                }
                return vec![who];
            }
        }
        let called = self.people.iter().position(|person| mention.role.is_some() && person.name == mention.role);
        if let Some(who) = called.filter(|_| !plural) {
            return vec![who];
        }
        if let Some(role) = &mention.role {
            let same: Vec<usize> =
                (0..self.people.len()).filter(|i| self.people.get(*i).is_some_and(|p| p.role == *role)).collect();
            if plural && same.len() > 1 && count.is_none_or(|n| usize::try_from(n) == Ok(same.len())) {
                return same;
            }
            if !plural && let Some(first) = same.first() {
                return vec![self.last.iter().copied().find(|i| same.contains(i)).unwrap_or(*first)];
            }
            // `a couple …; the husband …, his wife …`, `one of two guards …, his partner …`: of those who are there.
            const OF_THEM: &[&str] =
                &["husband", "wife", "partner", "companion", "colleague", "friend", "mate", "buddy", "coworker"];
            // `only one reacts, whereas her two colleagues …`
            if plural
                && OF_THEM.contains(&role.as_str())
                && let Some(n) = count
                && let Some(found) = self.pick_open(n, &Mention { role: None, ..mention.clone() })
            {
                return found;
            }
            // `a mother, a father and a girl …; the parents …, the kid …`
            let kin = |words: &[&str]| -> Vec<usize> {
                let is = |i: &usize| self.people.get(*i).is_some_and(|person| words.contains(&person.role.as_str()));
                (0..self.people.len()).filter(is).collect()
            };
            let found = match role.as_str() {
                "parent" if plural => kin(&["mother", "father", "mom", "dad"]),
                // `a mother and their daughter …; the girl …`
                "girl" if !plural => kin(&["daughter"]),
                "boy" if !plural => kin(&["son"]),
                "kid" | "child" if !plural => kin(&["girl", "boy", "son", "daughter", "toddler", "baby"]),
                _ => Vec::new(),
            };
            if found.len() == if plural { 2 } else { 1 } {
                return found;
            }
            // `her two sons …, but the boys …`
            if plural && count.is_none() && (plain(role) || matches!(role.as_str(), "kid" | "child")) {
                let set = self.latest();
                if set.len() > 1 && set.len() < self.people.len() {
                    return set;
                }
            }
            if !plural
                && OF_THEM.contains(&role.as_str())
                && let Some(found) = self.pick_open(1, &Mention { role: None, ..mention.clone() })
            {
                return found;
            }
            // `waves his colleague through`: the other one of two.
            if !plural
                && OF_THEM.contains(&role.as_str())
                && self.people.len() == 2
                && let [only] = self.last.as_slice()
            {
                return vec![1 - only.min(&1)];
            }
            // `a family of four …; the father …`: one of them of whom is not known yet who it is.
            const OF_FAMILY: &[&str] = &[
                "father",
                "mother",
                "parent",
                "dad",
                "mom",
                "child",
                "kid",
                "son",
                "daughter",
                "boy",
                "girl",
                "baby",
                "husband",
                "wife",
                "grandmother",
                "grandfather",
                "granny",
                "leader",
            ];
            if !plural && OF_FAMILY.contains(&role.as_str()) {
                let unknown = |i: &usize| self.people.get(*i).is_some_and(|person| person.role.is_empty());
                let who = self.groups.last().and_then(|(_, members, _)| members.iter().copied().find(unknown));
                if let Some(who) = who {
                    return vec![who];
                }
            }
            // `the man` may be the visitor of whom was spoken; he is not the woman.
            if !plural && plain(role) && mention.word != "own" {
                let men = MEN.contains(&role.as_str());
                let women = WOMEN.contains(&role.as_str());
                let other: &[&str] = if men {
                    WOMEN
                } else if women {
                    MEN
                } else {
                    &[]
                };
                let may = |i: &usize| {
                    self.people
                        .get(*i)
                        .is_some_and(|person| !plain(&person.role) && !other.contains(&person.role.as_str()))
                };
                let who = self.last.iter().chain(&self.latest()).copied().find(may);
                if let Some(who) = who {
                    return vec![who];
                }
            }
        } else if !self.people.is_empty() {
            if plural {
                let set = self.latest();
                let wanted = count.and_then(|n| usize::try_from(n).ok());
                // `the other two come towards it, and only these two make way`
                if wanted.is_some_and(|n| n > 1 && n == self.last.len() && n < set.len()) && mention.word == "these" {
                    return self.last.clone();
                }
                if let Some(found) = count.and_then(|n| self.pick_open(n, mention)) {
                    return found;
                }
                // `five come …: the three in front step aside, the two at the back do not`
                let others: Vec<usize> = set.iter().copied().filter(|i| !self.last.contains(i)).collect();
                let parted = self.last.len() < set.len() && self.last.iter().all(|i| set.contains(i));
                return match wanted {
                    Some(n) if n > 1 && n < set.len() && parted && others.len() >= n => {
                        others.into_iter().take(n).collect()
                    }
                    Some(n) if n > 1 && n < set.len() => set.into_iter().take(n).collect(),
                    Some(_) | None => set,
                };
            }
            return self
                .last
                .first()
                .copied()
                .or_else(|| self.latest().first().copied())
                .map(|i| vec![i])
                .unwrap_or_default();
        }
        let n = count.unwrap_or(if !plural {
            1
        } else if mention.group {
            3
        } else {
            2
        });
        if plural && count.is_none() {
            self.notes.push(format!("`{quote}` names no number; it was read as {n} humans"));
        }
        self.join(n, mention, declares, quote)
    }
}
