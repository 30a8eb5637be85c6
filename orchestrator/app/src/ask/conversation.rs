//! One look: what is shown, what the person says, and what becomes of it. No terminal and no bus here.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use similar::{Algorithm, ChangeTag, capture_diff_slices};
use socrates_checks::check_proposal;
use socrates_model::fault::hard;
use socrates_model::job::Stage;
use socrates_model::report::Repair;
use socrates_model::{AuthorSpec, Fault, FaultCode, HumanBehavior, HumanId, Proposal};
use socrates_offline::{Draft, edit};
use socrates_prompts::Question;

use super::command::{Command, stage as stage_named};
use super::keep::{Shown, kept};
use super::log::{Log, MADE, MADE_AGAIN};
use super::version::{Version, broken, lines, named};
use crate::exit::Diagnostic;

/// How a line is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tone {
    /// As it is.
    Plain,
    /// A heading.
    Head,
    /// Came in, or was done.
    Good,
    /// Went away, or is wrong.
    Bad,
    /// Beside the point.
    Quiet,
}

/// The person who looks: the terminal, or a test.
pub(super) trait Person {
    /// Shows a line.
    fn say(&mut self, tone: Tone, line: &str);
    /// Letters that fit into a line.
    fn columns(&self) -> usize;
    /// Shows the map with the ways of a version.
    fn picture(&mut self, look: &Look, version: &Version);
    /// Asks for a line; `None` when the person has gone.
    fn ask(&mut self, prompt: &str) -> Option<String>;
    /// Lets the person edit a text in a file of this name; an error says why it was not possible.
    fn edit(&mut self, name: &str, text: &str) -> Result<String, String>;
    /// Keeps the log, so that whoever leaves can come back.
    fn keep(&mut self, log: &Log) -> Result<(), Diagnostic>;
}

/// What a look is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum About {
    /// The proposal, before there are paths.
    Proposal,
    /// Proposal, paths and behaviors together.
    Draft,
}

impl About {
    /// Its place among the two looks.
    pub(super) const fn number(self) -> u8 {
        match self {
            Self::Proposal => 1,
            Self::Draft => 2,
        }
    }
}

/// One look at what was made.
#[derive(Debug, Clone)]
pub(super) struct Look {
    /// Its job.
    pub(super) job: String,
    /// What it is about.
    pub(super) about: About,
    /// What the authors made of it, with what the person left before.
    pub(super) came: Version,
    /// Every proposal that the author made, where it made several.
    pub(super) others: Vec<Proposal>,
    /// Why it was made again.
    pub(super) reasons: Vec<Fault>,
    /// Request, location and seed; the rest of it is filled in for each edit.
    pub(super) question: Question,
    /// The author that was asked.
    pub(super) author: AuthorSpec,
    /// Stages that the request pins; nobody is asked for them.
    pub(super) pinned: Vec<Stage>,
}

/// What the person decided.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Decision {
    /// What is left: what is accepted, or kept beside what is made again.
    pub(super) left: Version,
    /// Stages to be made again, with reasons; empty goes on.
    pub(super) anew: Vec<Repair>,
    /// What the person typed.
    pub(super) said: Vec<String>,
}

/// Shows a look and follows the person until there is a decision; `None` when the person left.
///
/// # Errors
/// Only what [`Person::keep`] says.
pub(super) fn converse(look: &Look, log: &mut Log, person: &mut dyn Person) -> Result<Option<Decision>, Diagnostic> {
    let how = if look.reasons.is_empty() { MADE } else { MADE_AGAIN };
    let edits = log.edits();
    let shown = if look.author == AuthorSpec::Offline { Shown::Nothing } else { Shown::Changes };
    let before = log.begin(&look.job, look.came.clone(), how);
    if let (About::Proposal, MADE_AGAIN, Some(_), Some((base, mine))) = (look.about, how, &before, edits)
        && let Some(version) = kept(&look.question, &base, &mine, &look.came, shown)
    {
        log.push("what you had changed, kept", version);
    }
    let mut talk = Conversation { look, log, person, page: look.about, texts: BTreeMap::new() };
    talk.greet(before.as_ref());
    talk.person.keep(talk.log)?;
    loop {
        let Some(line) = talk.person.ask(&format!("look {}> ", look.about.number())) else { return Ok(None) };
        if !line.trim().is_empty() {
            talk.log.said.push(line.trim().to_owned());
        }
        let next = talk.follow(&Command::read(&line));
        talk.person.keep(talk.log)?;
        match next {
            Next::Ask => {}
            Next::Leave => return Ok(None),
            Next::Decide(decision) => return Ok(Some(*decision)),
        }
    }
}

enum Next {
    Ask,
    Leave,
    Decide(Box<Decision>),
}

struct Conversation<'a> {
    look: &'a Look,
    log: &'a mut Log,
    person: &'a mut dyn Person,
    /// What is shown: `back` shows the proposal while the look is at the draft.
    page: About,
    /// Texts that were edited by hand and could not be read, by file name: nothing typed is lost.
    texts: BTreeMap<String, String>,
}

impl Conversation<'_> {
    fn now(&self) -> Version {
        self.log.now().cloned().unwrap_or_else(|| self.look.came.clone())
    }

    /// What stands is left; these stages are made again.
    fn decision(&self, anew: Vec<Repair>) -> Decision {
        Decision { left: self.now(), anew, said: self.log.said.clone() }
    }

    fn say(&mut self, tone: Tone, line: &str) {
        let columns = self.person.columns();
        if line.chars().count() <= columns {
            self.person.say(tone, line);
            return;
        }
        for part in broken(line, columns.max(1)) {
            self.person.say(tone, &part);
        }
    }

    /// Says a text under a name.
    fn named(&mut self, tone: Tone, name: &str, text: &str) {
        for line in named(name, text, self.person.columns()) {
            self.person.say(tone, &line);
        }
    }

    /// The first words of a look.
    fn greet(&mut self, before: Option<&Version>) {
        let about = match self.look.about {
            About::Proposal => "the proposal",
            About::Draft => "paths and behaviors",
        };
        let number = self.look.about.number();
        self.say(Tone::Head, &format!("look {number} of 2  {about}, by {}", self.look.author));
        for reason in &self.look.reasons.clone() {
            let words = if reason.code == FaultCode::PPerson { reason.message.to_string() } else { reason.to_string() };
            self.named(Tone::Quiet, "because", &words);
        }
        self.show();
        self.list();
        let came = self.now();
        // What was not there before is no change; what was there and is made again is.
        if let Some(before) = before.filter(|before| self.look.about == About::Proposal || before.paths.is_some()) {
            self.difference(before, &came);
        }
        self.help_short();
    }

    /// The proposals to choose from, where there are several.
    fn list(&mut self) {
        let now = self.now();
        for (number, other) in (1..).zip(&self.look.others) {
            // Whoever wrote it, what is proposed is the same.
            let shown = Proposal { author: now.proposal.author.clone(), ..other.clone() } == now.proposal;
            let humans = crate::words::plural(other.humans.len(), "human");
            let words = format!("{} · {humans} · {}{}", other.title, other.place, if shown { " (shown)" } else { "" });
            self.named(Tone::Plain, &format!("take {number}"), &words);
        }
    }

    fn take(&mut self, number: u32) {
        let place = usize::try_from(number).ok().and_then(|number| number.checked_sub(1));
        match place.and_then(|place| self.look.others.get(place)) {
            Some(other) if self.look.about == About::Proposal => {
                let now = self.now();
                let proposal = Proposal { author: now.proposal.author.clone(), ..other.clone() };
                self.changed(&format!("proposal {number} taken"), Version { proposal, ..now });
            }
            Some(_) | None => {
                let have = self.look.others.len();
                self.say(
                    Tone::Bad,
                    &format!("there is no proposal {number} to take, of {have}; `again` has others made"),
                );
            }
        }
    }

    fn show(&mut self) {
        let now = self.now();
        let location = &self.look.question.location;
        let entries = match self.page {
            About::Proposal => now.proposal_entries(),
            About::Draft => now.draft_entries(location),
        };
        let shown = lines(&entries, self.person.columns());
        for line in shown {
            self.say(Tone::Plain, &line);
        }
        if self.page == About::Draft {
            self.person.picture(self.look, &now);
        }
        self.faults();
    }

    /// Everything that the checks find; what refuses it first.
    fn faults(&mut self) {
        let found = self.now().faults(&self.look.question.location);
        let all: Vec<Fault> = found.into_values().flatten().collect();
        let refusing = hard(&all);
        for fault in &refusing {
            self.named(Tone::Bad, "wrong", &fault.to_string());
        }
        for fault in all.iter().filter(|fault| fault.is_soft()) {
            self.named(Tone::Quiet, "mind", &fault.to_string());
        }
        if refusing.is_empty() {
            self.say(Tone::Quiet, &format!("{:<11}nothing found against it", "checks"));
        }
    }

    fn difference(&mut self, before: &Version, after: &Version) {
        let location = &self.look.question.location;
        let (old, new) = (before.entries(location), after.entries(location));
        let mut same = true;
        let ops = capture_diff_slices(Algorithm::Myers, &old, &new);
        for change in ops.iter().flat_map(|op| op.iter_changes(&old, &new)) {
            let (tone, sign) = match change.tag() {
                ChangeTag::Equal => continue,
                ChangeTag::Delete => (Tone::Bad, '-'),
                ChangeTag::Insert => (Tone::Good, '+'),
            };
            same = false;
            // Two columns are the sign's.
            for line in change.value().lines(self.person.columns().saturating_sub(2)) {
                self.person.say(tone, &format!("{sign} {line}"));
            }
        }
        if same {
            let words = if before == after { "no difference" } else { "no difference in what is shown here" };
            self.say(Tone::Quiet, words);
        }
    }

    fn help_short(&mut self) {
        self.say(
            Tone::Quiet,
            "type what should change, or: accept · again [why] · undo · edit · map · back · quit · ? for more",
        );
    }

    fn help(&mut self) {
        const HELP: [(&str, &str); 12] = [
            ("a sentence", "changes what it speaks of: \"human_2 walks slower\", \"make the robot's path longer\""),
            ("accept", "goes on with what is shown; what no longer fits a changed proposal is made again"),
            ("again", "has it made again; `again paths because …` one stage only, the others are kept"),
            ("reject", "the same as `again`"),
            ("edit", "opens it in $EDITOR; `edit proposal`, `edit paths`, `edit human_1` (its tree)"),
            ("take 2", "takes another of several proposals (`--set author.variants=3`)"),
            ("undo", "takes the last change back, an `again` included"),
            ("back", "shows the proposal once more; `back` again returns"),
            ("show", "shows everything again"),
            ("map", "shows the map with the paths"),
            ("diff", "shows what changed since the authors wrote it"),
            ("quit", "leaves; the same command comes back to this look"),
        ];
        for (name, words) in HELP {
            self.named(Tone::Plain, name, words);
        }
    }

    fn follow(&mut self, command: &Command) -> Next {
        match command {
            Command::Help => self.help(),
            Command::Show => self.show(),
            Command::Map => {
                let now = self.now();
                if now.paths.is_none() {
                    self.say(Tone::Quiet, "there are no paths yet: the map with the places is shown");
                }
                self.person.picture(self.look, &now);
            }
            Command::Diff => {
                let (came, now) = (self.look.came.clone(), self.now());
                self.difference(&came, &now);
            }
            Command::Undo => self.undo(),
            Command::Back => self.back(),
            Command::Edit(what) => self.by_hand(what),
            Command::Words(words) => return self.in_words(words),
            Command::Take(number) => self.take(*number),
            Command::Again(stage, why) => return self.again(*stage, why),
            Command::Accept => return self.accept(),
            Command::Quit => return Next::Leave,
        }
        Next::Ask
    }

    fn undo(&mut self) {
        let whole = self.look.about == About::Draft;
        let undone = self.now();
        match self.log.undo(whole) {
            Some(how) => {
                self.say(Tone::Good, &format!("undone: {how}"));
                // A text that could not be read belongs to what is undone.
                self.texts.clear();
                let now = self.now();
                self.difference(&undone, &now);
                if now.paths != undone.paths {
                    self.person.picture(self.look, &now);
                }
                self.faults();
            }
            None => self.say(Tone::Quiet, "nothing to undo in this look"),
        }
    }

    fn back(&mut self) {
        self.page = match (self.look.about, self.page) {
            (About::Proposal, _) => {
                self.say(Tone::Quiet, "this is the first look");
                return;
            }
            (About::Draft, About::Draft) => About::Proposal,
            (About::Draft, About::Proposal) => About::Draft,
        };
        self.show();
    }

    /// A new version stands: what it changed, and what is wrong with it now.
    fn changed(&mut self, how: &str, mut version: Version) {
        let before = self.now();
        version.sign(&before);
        if version == before {
            self.say(Tone::Quiet, "no difference");
            return;
        }
        self.log.push(how, version.clone());
        self.difference(&before, &version);
        if version.paths != before.paths {
            self.person.picture(self.look, &version);
        }
        self.faults();
    }

    /// A wish in words: done by the grammar, or handed to the author that can read what the grammar cannot.
    fn in_words(&mut self, words: &str) -> Next {
        let now = self.now();
        let question = Question { reading: now.reading.clone(), ..self.look.question.clone() };
        let whole = self.look.about == About::Draft;
        let draft = Draft {
            proposal: now.proposal.clone(),
            paths: now.paths.clone().filter(|_| whole),
            behaviors: now.behaviors.clone().filter(|_| whole),
        };
        let edited = edit(&question, &draft, words);
        for done in &edited.done {
            self.named(Tone::Good, "done", done);
        }
        for words in &edited.left_out {
            self.named(Tone::Bad, "left out", &format!("`{words}` was not understood; the rest was done"));
        }
        // One word is a slip of a command rather than a wish.
        let nothing = edited.done.is_empty() && edited.draft == draft;
        let handed_on = nothing && self.look.author != AuthorSpec::Offline && words.split_whitespace().nth(1).is_some();
        for fault in edited.not_done.iter().filter(|_| !handed_on) {
            self.named(Tone::Bad, "not done", &fault.message.to_string());
        }
        if nothing {
            if !handed_on {
                return Next::Ask;
            }
            let told = format!("{} is asked: \"{words}\"", self.look.author);
            self.say(Tone::Quiet, &told);
            return self.again(None, words);
        }
        let Draft { proposal, paths, behaviors } = edited.draft;
        self.changed(&format!("\"{words}\""), Version { proposal, paths, behaviors, reading: edited.reading });
        Next::Ask
    }

    fn again(&mut self, stage: Option<Stage>, why: &str) -> Next {
        let stages = match (stage, self.page) {
            (Some(stage), _) => vec![stage],
            (None, About::Proposal) => vec![Stage::Proposal],
            (None, About::Draft) => vec![Stage::Paths, Stage::Behaviors],
        };
        let (pinned, stages): (Vec<Stage>, Vec<Stage>) =
            stages.into_iter().partition(|stage| self.look.pinned.contains(stage));
        for stage in &pinned {
            self.say(Tone::Bad, &format!("the {stage} are pinned by the request: `edit {stage}` changes them"));
        }
        if self.look.about == About::Proposal && stages.iter().any(|stage| *stage != Stage::Proposal) {
            self.say(Tone::Bad, "there are no paths and behaviors yet: `accept` has them made");
            return Next::Ask;
        }
        if stages.is_empty() {
            return Next::Ask;
        }
        let why = if why.is_empty() { "a person wants another one" } else { why };
        let repair = |stage: Stage| Repair { stage, faults: vec![Fault::new(FaultCode::PPerson, stage, why)] };
        Next::Decide(Box::new(self.decision(stages.into_iter().map(repair).collect())))
    }

    fn accept(&mut self) -> Next {
        if self.page != self.look.about {
            // Back in the proposal of a draft: first the draft is shown with what was changed.
            self.back();
            return Next::Ask;
        }
        let now = self.now();
        let mut found = now.faults(&self.look.question.location);
        found.values_mut().for_each(|faults| *faults = hard(faults));
        found.retain(|stage, faults| {
            !faults.is_empty() && (*stage == Stage::Proposal || self.look.about == About::Draft)
        });
        if found.is_empty() {
            return Next::Decide(Box::new(self.decision(Vec::new())));
        }
        let stuck = found.keys().find(|stage| **stage == Stage::Proposal || self.look.pinned.contains(stage)).copied();
        for fault in found.values().flatten() {
            self.named(Tone::Bad, "wrong", &fault.to_string());
        }
        if let Some(stage) = stuck {
            let hint = format!("not accepted: say what should change, `edit {stage}`, `undo`, or `again {stage}`");
            self.say(Tone::Bad, &hint);
            return Next::Ask;
        }
        let stages: Vec<&str> = found.keys().map(|stage| stage.name()).collect();
        self.say(Tone::Quiet, &format!("{} no longer fit and are made again", stages.join(" and ")));
        let anew = found.into_iter().map(|(stage, faults)| Repair { stage, faults }).collect();
        Next::Decide(Box::new(self.decision(anew)))
    }

    fn by_hand(&mut self, what: &str) {
        let now = self.now();
        let human = what.strip_prefix("human_").and_then(|number| number.parse::<u32>().ok()).map(HumanId::new);
        let stage = match (what, self.page) {
            ("", About::Proposal) => Some(Stage::Proposal),
            ("", About::Draft) => Some(Stage::Paths),
            (what, _) => stage_named(what).or_else(|| human.map(|_| Stage::Behaviors)),
        };
        let mut version = now.clone();
        let done = match (stage, now.paths, now.behaviors) {
            (Some(Stage::Proposal), ..) => self.edited("proposal.json", &now.proposal).map(|proposal| {
                version.proposal = proposal;
                self.give_up(&mut version);
            }),
            (Some(Stage::Paths), Some(paths), _) => {
                self.edited("paths.json", &paths).map(|paths| version.paths = Some(paths))
            }
            (Some(Stage::Behaviors), _, Some(mut behaviors)) => {
                let only = behaviors.humans.keys().next().copied().filter(|_| behaviors.humans.len() == 1);
                let Some((id, tree)) =
                    human.or(only).and_then(|id| behaviors.humans.get(&id).map(|tree| (id, tree.tree.clone())))
                else {
                    let ids: Vec<String> = behaviors.humans.keys().map(|id| format!("`edit {id}`")).collect();
                    self.say(Tone::Bad, &format!("each human has its own tree: {}", ids.join(", ")));
                    return;
                };
                self.opened(&format!("{id}.xml"), &tree).filter(|edited| *edited != tree).map(|tree| {
                    let description = "edited by hand".to_owned();
                    behaviors.humans.insert(id, HumanBehavior { tree, description });
                    version.behaviors = Some(behaviors);
                })
            }
            _ => {
                let all = if self.look.about == About::Draft { ", paths, human_1 …" } else { "" };
                self.say(Tone::Bad, &format!("there is no `{what}` to edit here; there is: proposal{all}"));
                return;
            }
        };
        if done.is_some() {
            self.changed("edited by hand", version);
        }
    }

    /// Lets the person edit a value as JSON. What cannot be read is said and kept for the next try.
    fn edited<T: DeserializeOwned + serde::Serialize>(&mut self, name: &str, value: &T) -> Option<T> {
        let text = serde_json::to_string_pretty(value).unwrap_or_default();
        let text = self.opened(name, &text)?;
        match serde_json::from_str(&text) {
            Ok(value) => Some(value),
            Err(why) => {
                self.say(Tone::Bad, &format!("{name} cannot be read: {why}; `edit` opens it again as you left it"));
                self.texts.insert(name.to_owned(), text);
                None
            }
        }
    }

    fn opened(&mut self, name: &str, text: &str) -> Option<String> {
        let text = self.texts.remove(name).unwrap_or_else(|| text.to_owned());
        match self.person.edit(name, &text) {
            Ok(text) => Some(text),
            Err(why) => {
                self.say(Tone::Bad, &why);
                None
            }
        }
    }

    /// What a person writes by hand wins over what the request was read as: wishes that it does not fulfill are given up, aloud.
    fn give_up(&mut self, version: &mut Version) {
        let location = &self.look.question.location;
        let refusals = |facts: &[socrates_model::Fact]| {
            let reading = socrates_model::Reading { facts: facts.to_vec(), ..version.reading.clone() };
            hard(&check_proposal(&version.proposal, &reading, location)).len()
        };
        let alone = refusals(&[]);
        let (kept, lost): (Vec<socrates_model::Fact>, Vec<socrates_model::Fact>) =
            version.reading.facts.iter().cloned().partition(|fact| refusals(std::slice::from_ref(fact)) <= alone);
        for fact in &lost {
            self.say(Tone::Quiet, &format!("{:<11}\"{}\" is no longer asked for", "given up", fact.quote));
        }
        version.reading.facts = kept;
    }
}
