//! The cast: who is there, and whom a mention means.

use socrates_model::proposal::Facing;
use socrates_model::{Fault, FaultCode, GroupId, PlaceClass, Relation, Rule, Side};

use crate::lexicon::{Act, lexicon};
use crate::mention::{Mention, Who};
use crate::statements::Unplayed;

/// A rule with where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ReadRule {
    pub(crate) rule: Rule,
    /// The words it was read from.
    pub(crate) quote: String,
    /// Whether the text says when.
    pub(crate) stated: bool,
    /// Whether the text says how near.
    pub(crate) exact: bool,
    /// Whether the text says how long.
    pub(crate) lasts: bool,
    /// Whether it follows the one before: `and then`.
    pub(crate) then: bool,
}

/// One human as it is being read.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Person {
    pub(crate) role: String,
    pub(crate) relation: Option<(Relation, String)>,
    /// Side of the robot's way, with the words.
    pub(crate) side: Option<(Side, String)>,
    /// Where they face at first, with the words.
    pub(crate) facing: Option<(Facing, String)>,
    pub(crate) rules: Vec<ReadRule>,
    pub(crate) group: Option<GroupId>,
    pub(crate) speed_mps: Option<f64>,
    /// Where it comes from, or is.
    pub(crate) start: Option<PlaceClass>,
    /// Where it goes in.
    pub(crate) goal: Option<PlaceClass>,
    /// Words for the reading line, in order.
    pub(crate) doings: Vec<String>,
    /// Whether something was said of this one that sets it apart.
    pub(crate) bound: bool,
    /// What it is called.
    pub(crate) name: Option<String>,
    /// Words by which it stands still all of the time.
    pub(crate) still: Option<String>,
    /// `he` or `she`, once one was used.
    pub(crate) pronoun: Option<String>,
    /// `participant`, `bystander`: a word that says no more than that somebody is there.
    pub(crate) called: Option<String>,
    /// Words that say that it stays where it is, which may be inside.
    pub(crate) stays: Option<String>,
    /// Words that say that it walks on after all it did.
    pub(crate) goes_on: Option<String>,
    /// Words by which whoever comes out crosses the robot's way then.
    pub(crate) crosses: Option<String>,
    /// Whether it meets the robot more than once.
    pub(crate) again: Option<crate::again::Again>,
    /// What was ruled out for it, with the words.
    pub(crate) never: Vec<(Act, String)>,
}

/// People who were introduced together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Together {
    pub(crate) members: Vec<usize>,
    /// `there are 3 people`: this is everybody.
    pub(crate) total: bool,
    pub(crate) quote: String,
    /// Who was told apart by a bare number since: `four get out: two turn left, two turn right`.
    pub(crate) counted: Vec<usize>,
}

/// Everybody so far.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Cast {
    pub(crate) people: Vec<Person>,
    pub(crate) groups: Vec<(GroupId, Vec<usize>, String)>,
    pub(crate) sets: Vec<Together>,
    /// Whom the last clause spoke of.
    pub(crate) last: Vec<usize>,
    pub(crate) notes: Vec<String>,
    /// What was understood and is not played as it was said.
    pub(crate) unplayed: Vec<Unplayed>,
    pub(crate) problems: Vec<Fault>,
    /// Words that said how many, for the fact.
    pub(crate) count_quote: Option<String>,
    /// Somebody was said not to be there.
    pub(crate) nobody: Option<String>,
    /// Whom the text spoke of before [`Self::last`].
    pub(crate) before: Vec<usize>,
    /// The sentence makes an exception: `only when …`, `until …`.
    pub(crate) excepting: bool,
    /// The sentence only supposes something: `What if a nurse …?`, `Sometimes a nurse …`.
    pub(crate) supposed: bool,
    /// Whom such sentences spoke of, who may be spoken of again as somebody new.
    pub(crate) supposed_people: Vec<usize>,
    /// Numbers that are no counts, as names: `patient 12`.
    pub(crate) labels: Vec<(u32, usize)>,
    /// Names that the text gives to people, in order.
    pub(crate) names: Vec<String>,
    /// A colon stood before: what comes lists those who are there.
    pub(crate) listing: bool,
    overflow: bool,
}

/// More people than are kept while reading; the request is refused anyway.
const READ_AT_MOST: usize = 40;

/// Words for people that only say man or woman, old or young: another word may have named them before.
pub(crate) fn plain(role: &str) -> bool {
    matches!(role, "man" | "woman" | "guy" | "lady" | "gentleman" | "boy" | "girl" | "adult")
}

/// How fast people of a role usually walk, if that is another speed than everybody's, m/s.
fn usual_mps(role: &str) -> Option<f64> {
    lexicon().roles.get(role).and_then(|word| word.speed_mps)
}

/// Words for people that only say that they are there.
const CALLED: &[&str] = &["participant", "confederate", "bystander", "passenger", "occupant", "pedestrian"];

impl Cast {
    /// Remembers words that were understood and are not played as they were said.
    pub(crate) fn leave_out(&mut self, quote: &str, why: &str) {
        let unplayed = Unplayed::of(quote, why);
        if !self.unplayed.contains(&unplayed) {
            self.unplayed.push(unplayed);
        }
    }

    /// The people whom a mention means; new ones join.
    pub(crate) fn resolve(&mut self, mention: &Mention, declares: bool, quote: &str) -> Vec<usize> {
        let found = match &mention.who {
            Who::Nobody => {
                self.nobody = Some(quote.to_owned());
                Vec::new()
            }
            Who::New { count: None, .. } => {
                let n = if mention.group { 3 } else { 2 };
                self.notes.push(format!("`{quote}` names no number; it was read as {n} humans"));
                self.join(n, mention, declares, quote)
            }
            Who::New { count: Some(n), .. }
                if mention.parts > 1 && self.latest().len() == usize::try_from(*n).unwrap_or(usize::MAX) =>
            {
                self.latest()
            }
            Who::New { count: Some(n), article } => {
                let pick = if let Some(found) = self.supposes(*n, mention) {
                    self.supposed_people.retain(|i| !found.contains(i));
                    self.forget(&found);
                    Some(found)
                } else if self.listing {
                    self.pick_nameless(*n).or_else(|| self.pick_open(*n, mention))
                } else if *article && self.counted_for_all() {
                    self.pick_nameless(*n)
                } else if !*article || mention.role.as_deref().is_none_or(plain) && self.declared_open() {
                    self.pick(*n, mention, quote)
                } else {
                    None
                };
                pick.unwrap_or_else(|| self.join(*n, mention, declares, quote))
            }
            // `Ten, I said.`
            Who::Bare(n) if *n > 1 && declares && self.latest().len() == usize::try_from(*n).unwrap_or(usize::MAX) => {
                self.latest()
            }
            Who::Bare(n) => {
                let some = self.pick_open(*n, mention);
                let some = some.or_else(|| if self.alike_so_far() { self.counted(*n) } else { None });
                let some = some.or_else(|| self.pick(*n, mention, quote)).or_else(|| self.counted(*n));
                some.unwrap_or_else(|| {
                    let joined = self.join(*n, mention, declares, quote);
                    // `2 leave, 1 stays`: another one, not one of the two.
                    if let Some(set) = self.sets.last_mut().filter(|set| set.members == joined) {
                        set.counted.clone_from(&joined);
                    }
                    joined
                })
            }
            Who::More(n) => match self.pick_open(*n, mention) {
                // `five people chat, plus one doctor`: of those nobody is left of whom nothing was told.
                Some(found) if *n == 1 && self.parted() && (mention.role.is_none() || self.idle(&found)) => found,
                Some(_) | None => self.join(*n, &self.alike(mention), declares, quote),
            },
            Who::PartOf(n) => self.part_of(*n, mention, quote),
            Who::ToldApart => self.part_of(1, mention, quote),
            // `two stay; one of the two looks`
            Who::PartOfNew(n, of) if mention.role.is_none() && self.last.len() == usize::try_from(*of).unwrap_or(0) => {
                self.last.iter().copied().take(usize::try_from(*n).unwrap_or(1)).collect()
            }
            Who::PartOfNew(n, of) => {
                let known = self.latest().len() == usize::try_from(*of).unwrap_or(usize::MAX)
                    && self.latest().iter().all(|i| self.fits(*i, mention.role.as_ref()));
                if !known {
                    self.join(*of, mention, declares, quote);
                }
                self.part_of(*n, mention, quote)
            }
            Who::AllOf(n) => {
                let wanted = usize::try_from(*n).unwrap_or(usize::MAX);
                let fitting =
                    |set: &[usize]| set.len() == wanted && set.iter().all(|i| self.fits(*i, mention.role.as_ref()));
                let total = self.sets.iter().find(|set| set.total && set.members.len() != wanted);
                let same = |set: &Together| {
                    mention.role.is_none() || set.members.iter().all(|i| self.fits(*i, mention.role.as_ref()))
                };
                if let Some(set) = total.filter(|set| same(set)) {
                    let (members, first) = (set.members.clone(), set.quote.clone());
                    self.problems.push(
                        Fault::new(
                            FaultCode::PContra,
                            "rough_scenario",
                            format!(
                                "`{first}` gives {} humans, but `{quote}` speaks of {n}; correct one of the two",
                                members.len()
                            ),
                        )
                        .about([first, quote.to_owned()]),
                    );
                    return members;
                }
                // `at a corner that neither of them can see around`, before anybody was spoken of
                if self.people.is_empty() && mention.role.is_none() && quote.contains("them") {
                    return Vec::new();
                }
                // `neither of the two is in a hurry`: neither of it and the robot
                if self.people.len() == 1 && wanted == 2 && mention.role.is_none() {
                    return vec![0];
                }
                // `neither of the two professionals`: a word for some of those who are there.
                if let Some(role) = mention.role.as_ref().filter(|role| !lexicon().roles.contains_key(*role)) {
                    let set = self.latest();
                    if set.len() > wanted
                        && set.iter().all(|i| self.people.get(*i).is_some_and(|person| person.role != *role))
                    {
                        return set.into_iter().take(wanted).collect();
                    }
                }
                let sets = [self.last.clone(), self.latest()];
                let everybody: Vec<usize> = (0..self.people.len()).collect();
                let alike: Vec<usize> = (0..self.people.len())
                    .filter(|i| mention.role.is_some() && self.people.get(*i).map(|p| &p.role) == mention.role.as_ref())
                    .collect();
                // `two secretaries …; all three secretaries`
                if mention.role.is_some() && alike.len() > 1 && alike.len() != wanted {
                    let message = format!(
                        "the text speaks of {} of them, but `{quote}` of {n}; correct one of the two",
                        alike.len()
                    );
                    self.problems.push(Fault::new(FaultCode::PContra, "rough_scenario", message));
                    return alike;
                }
                sets.into_iter()
                    .chain([alike, everybody])
                    .find(|set| fitting(set))
                    .unwrap_or_else(|| self.join(*n, mention, declares, quote))
            }
            Who::Other(count) => self.others(*count, mention, quote),
            Who::Ordinal(n) => {
                // `three wait, two come out; the former …, the latter …`
                let sets: Vec<&Vec<usize>> =
                    self.sets.iter().map(|set| &set.members).filter(|members| members.len() > 1).collect();
                if let [.., former, latter] = sets.as_slice()
                    && matches!(mention.word.as_str(), "former" | "latter")
                    && former.iter().all(|i| !latter.contains(i))
                {
                    return if *n == 0 { (*latter).clone() } else { (*former).clone() };
                }
                self.beyond(*n, quote);
                let set = self.latest();
                let index = if *n == 0 { set.last() } else { set.get(usize::try_from(n - 1).unwrap_or(usize::MAX)) };
                index.copied().map_or_else(|| self.join(1, mention, false, quote), |i| vec![i])
            }
            Who::Some { first, count } => {
                let set = self.latest();
                let wanted = usize::try_from(*count).unwrap_or(usize::MAX);
                if wanted > set.len() {
                    self.join(*count, mention, declares, quote)
                } else if *first {
                    set.into_iter().take(wanted).collect()
                } else {
                    set.iter().skip(set.len() - wanted).copied().collect()
                }
            }
            Who::Number(n) if self.is_label(*n) => self.labelled(*n, mention, quote),
            Who::Number(n) => {
                self.beyond(*n, quote);
                let wanted = usize::try_from((*n).max(1)).unwrap_or(usize::MAX);
                if wanted > self.people.len() {
                    let missing = u32::try_from(wanted - self.people.len()).unwrap_or(u32::MAX);
                    let _new = self.join(missing, mention, false, quote);
                }
                if wanted <= self.people.len() { vec![wanted - 1] } else { Vec::new() }
            }
            Who::Definite { plural, count } => self.definite(*plural, *count, mention, declares, quote),
            Who::All => {
                let whole = self.sets.iter().map(|set| &set.members).filter(|members| {
                    members.len() > self.last.len() && self.last.iter().all(|who| members.contains(who))
                });
                if let Some(members) = whole.max_by_key(|members| members.len()).filter(|_| mention.word == "all") {
                    members.clone()
                } else if self.last.len() > 1 {
                    self.last.clone()
                } else {
                    self.latest()
                }
            }
            Who::Same => {
                let found = self.single(&mention.word);
                if let ([only], "he" | "she") = (found.as_slice(), mention.word.as_str())
                    && let Some(person) = self.people.get_mut(*only)
                {
                    person.pronoun.get_or_insert_with(|| mention.word.clone());
                }
                found
            }
            Who::Object => self.last.clone(),
            Who::Further(n) => {
                let there = self.people.len() >= usize::try_from(*n).unwrap_or(usize::MAX);
                let open = if there { self.pick_open(1, mention) } else { None };
                open.unwrap_or_else(|| self.join(1, &self.alike(mention), declares, quote))
            }
            Who::SoMany(n) => self.so_many(*n, mention, quote),
            Who::AllBut(n) => {
                let set = if self.last.len() > 1 { self.last.clone() } else { self.latest() };
                let kept = set.len().saturating_sub(usize::try_from(*n).unwrap_or(usize::MAX));
                set.into_iter().take(kept).collect()
            }
            Who::OrdinalOf { number, count } => {
                let of = Mention { who: Who::New { count: Some(*count), article: false }, ..mention.clone() };
                let set = self.resolve(&of, declares, quote);
                let place = if *number == 0 { set.len() } else { usize::try_from(*number).unwrap_or(usize::MAX) };
                place.checked_sub(1).and_then(|place| set.get(place)).map(|i| vec![*i]).unwrap_or_default()
            }
        };
        if let Some(role) = &mention.role {
            for i in &found {
                // A name gives way to what somebody is.
                let open = |person: &&mut Person| {
                    person.role.is_empty() || mention.who == Who::Same && !lexicon().roles.contains_key(&person.role)
                };
                if let Some(person) = self.people.get_mut(*i).filter(open) {
                    role.clone_into(&mut person.role);
                }
            }
        }
        let singles = matches!(mention.who, Who::Bare(_)) && !declares
            || matches!(
                mention.who,
                Who::PartOf(_)
                    | Who::PartOfNew(..)
                    | Who::ToldApart
                    | Who::Further(_)
                    | Who::Other(_)
                    | Who::Ordinal(_)
                    | Who::Some { .. }
                    | Who::Number(_)
                    | Who::More(_)
            );
        let picked = matches!(mention.who, Who::New { .. } | Who::Definite { .. }) && self.latest().len() > found.len();
        for i in &found {
            if let Some(person) = self.people.get_mut(*i) {
                person.bound |= singles || picked;
            }
        }
        // `the groups` are those that are there.
        let grouped = found.iter().all(|i| self.people.get(*i).is_some_and(|person| person.group.is_some()));
        if mention.group && found.len() > 1 && !(grouped && matches!(mention.who, Who::Definite { .. })) {
            let parts = usize::try_from(mention.parts).unwrap_or(1).clamp(1, found.len());
            for members in found.chunks(found.len().div_ceil(parts)) {
                self.group(members, quote);
            }
        }
        found
    }

    /// In a new sentence, `one` is one of those who were counted before: `Two oncoming. One stops.`
    pub(crate) fn sentence(&mut self) {
        for set in self.sets.iter_mut().filter(|set| set.counted == set.members) {
            set.counted.clear();
        }
    }

    /// Remembers `participant` and its like, which say no more than that somebody is there.
    pub(crate) fn call(&mut self, mention: &Mention, words: &[crate::words::Word], people: &[usize]) {
        let weak = words.iter().find(|word| CALLED.contains(&word.stem.as_str())).filter(|_| mention.role.is_none());
        let Some(weak) = weak else { return };
        for i in people {
            if let Some(person) = self.people.get_mut(*i) {
                person.called.get_or_insert_with(|| weak.stem.clone());
            }
        }
    }

    /// `a confederate …, a bystander …; the confederate`: who was called so, where the word tells nothing else of who it is.
    pub(crate) fn called_so(&self, mention: &Mention, words: &[crate::words::Word]) -> Option<Vec<usize>> {
        let one = matches!(mention.who, Who::Definite { plural: false, .. }) && mention.role.is_none();
        let word = words.last().filter(|word| one && CALLED.contains(&word.stem.as_str()))?;
        let of = |i: &usize| self.people.get(*i).is_some_and(|person| person.called.as_ref() == Some(&word.stem));
        let mut known = (0..self.people.len()).filter(of);
        known.next().filter(|_| known.next().is_none()).map(|who| vec![who])
    }

    /// Gives people the names that stand beside who they are.
    pub(crate) fn name(&mut self, people: &[usize], names: &[&String]) {
        if people.len() != names.len() {
            return;
        }
        for (i, name) in people.iter().zip(names) {
            if let Some(person) = self.people.get_mut(*i) {
                person.name = Some((*name).clone());
            }
        }
    }

    /// The people of a mention of whom a list tells what each is.
    pub(crate) fn made_of(&mut self, mention: &Mention, declares: bool, quote: &str, roles: &[String]) -> Vec<usize> {
        let count = u32::try_from(roles.len()).ok();
        let all = Mention { who: Who::New { count, article: false }, role: None, ..mention.clone() };
        let found = self.resolve(&all, declares, quote);
        for (i, role) in found.iter().zip(roles) {
            if let Some(person) = self.people.get_mut(*i) {
                role.clone_into(&mut person.role);
                person.speed_mps = usual_mps(role);
            }
        }
        found
    }

    /// Makes a group of these people.
    pub(crate) fn group(&mut self, members: &[usize], quote: &str) {
        if members.len() < 2 || self.groups.iter().any(|(_, known, _)| members.iter().all(|i| known.contains(i))) {
            return;
        }
        let id = GroupId(u32::try_from(self.groups.len() + 1).unwrap_or(u32::MAX));
        for i in members {
            if let Some(person) = self.people.get_mut(*i) {
                person.group = Some(id);
            }
        }
        self.groups.push((id, members.to_vec(), quote.to_owned()));
    }

    /// From here to the end of the sentence, people are those of the newest set of whom nothing is known yet.
    pub(crate) fn lists(&mut self) {
        let plain = |i: &usize| self.people.get(*i).is_some_and(|person| !person.bound || person.role.is_empty());
        self.listing = self.sets.last().is_some_and(|set| set.members.iter().all(plain));
    }

    /// Takes `a nurse and two visitors` as one set.
    pub(crate) fn together(&mut self, members: &[usize], quote: &str) {
        if members.len() > 1 && !self.sets.iter().any(|set| set.members == members) {
            self.sets.push(Together {
                members: members.to_vec(),
                total: false,
                quote: quote.to_owned(),
                counted: Vec::new(),
            });
        }
    }

    /// The newest set of more than one, else everybody.
    pub(crate) fn latest(&self) -> Vec<usize> {
        self.sets
            .iter()
            .rev()
            .find(|set| set.members.len() > 1)
            .map_or_else(|| (0..self.people.len()).collect(), |set| set.members.clone())
    }

    /// New people.
    pub(crate) fn join(&mut self, n: u32, mention: &Mention, declares: bool, quote: &str) -> Vec<usize> {
        let from = self.people.len();
        let wanted = usize::try_from(n).unwrap_or(usize::MAX);
        if n == 0 {
            self.nobody = Some(quote.to_owned());
        }
        if from.saturating_add(wanted) > usize::try_from(socrates_model::request::MAX_HUMANS).unwrap_or(READ_AT_MOST)
            && !self.overflow
        {
            self.overflow = true;
            self.problems.push(Fault::new(
                FaultCode::PLimit,
                "rough_scenario",
                format!(
                    "`{quote}` asks for {} humans; 1 to {} are simulated",
                    from.saturating_add(wanted),
                    socrates_model::request::MAX_HUMANS
                ),
            ));
        }
        let speed = mention.role.as_deref().and_then(usual_mps);
        for _ in 0..wanted.min(READ_AT_MOST.saturating_sub(from)) {
            self.people.push(Person {
                role: mention.role.clone().unwrap_or_default(),
                speed_mps: speed,
                ..Person::default()
            });
        }
        let members: Vec<usize> = (from..self.people.len()).collect();
        if self.supposed {
            self.supposed_people.extend(&members);
        }
        if members.len() > 1 || declares {
            self.sets.push(Together {
                members: members.clone(),
                total: declares && members.len() > 1,
                quote: quote.to_owned(),
                counted: Vec::new(),
            });
        }
        if self.count_quote.is_none() && !members.is_empty() {
            self.count_quote = Some(quote.to_owned());
        }
        members
    }
}
