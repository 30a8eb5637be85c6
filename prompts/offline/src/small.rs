//! From what the small reader read to the story that the layers above use: relations and steps become deeds, as if the grammar had found them.
//!
//! ```text
//! text ─► socrates_reader::Read ─┬─► Story (people, rules, place) ─► reading, proposal, paths
//!                                └─► statements: what became of every piece
//! ```
//!
//! Never: a word of the text. What the small reader made nothing of is said as it says it.

use std::ops::Range;

use socrates_model::fault::{Message, Span};
use socrates_model::statement::{Background, Became, Statement, TextKey};
use socrates_model::{AgentId, Fault, Gesture, GroupId, HumanId, PlaceClass, Reading, Relation, Request, Trigger};
use socrates_reader::{Act as Said, Cue, Fate, Line, Piece, Read, Reason, Step};

use crate::aside;
use crate::cast::Person;
use crate::deed::{self, Around};
use crate::lexicon::Act;
use crate::order;
use crate::story::Story;
use crate::understand::Understood;

/// A text as the small reader reads it, and the story that it tells.
pub(crate) fn story(text: &str) -> Story {
    told(text, socrates_reader::read(text))
}

/// The story that was read of a text.
pub(crate) fn told(text: &str, read: Read) -> Story {
    Telling { text, read }.story()
}

/// What the text says that somebody does not do.
pub(crate) fn denied(person: &socrates_reader::Person) -> Vec<Act> {
    person.denied.iter().map(|said| act(*said)).collect()
}

/// A text with what was read of it.
struct Telling<'a> {
    text: &'a str,
    read: Read,
}

impl Telling<'_> {
    fn story(&self) -> Story {
        let mut story = Story::default();
        let told = &self.read.story;
        story.cast.people = told.people.iter().map(|person| someone(&person.role)).collect();
        for who in 0..told.people.len() {
            self.person(&mut story, who);
        }
        self.groups(&mut story);
        story.cast.count_quote = Some(self.quote(|line| *line == Line::Person(0)))
            .filter(|quote| !quote.is_empty() && !told.people.is_empty());
        story.place = told.place.map(|class| (class, self.quote(|line| *line == Line::Place(class))));
        story.robot_leaves = told.robot_start.map(|class| (class, self.quote(|line| *line == Line::RobotStart(class))));
        story.robot_enters = told.robot_goal.map(|class| (class, self.quote(|line| *line == Line::RobotGoal(class))));
        let signs = told.robot_says.iter();
        story.robot_says = signs
            .map(|sign| (*sign, self.quote(|line| *line == Line::RobotSays(*sign))))
            .collect::<Vec<(Gesture, String)>>();
        for who in &told.robot_first {
            let quote = self.quote(|line| *line == Line::RobotFirst(*who));
            order::state(&mut story.order, (AgentId::Robot, AgentId::Human(human_id(*who))), false, &quote);
        }
        for class in &told.robot_via {
            let quote = self.quote(|line| *line == Line::RobotVia(*class));
            story.cast.leave_out(&quote, "what the robot's way leads past is said by its task, or by `via` of a form");
        }
        story
    }

    /// The words that say a line first; none where nothing of the text does.
    fn quote(&self, wanted: impl Fn(&Line) -> bool) -> String {
        let at = self.read.lines.iter().find(|(line, _)| wanted(line)).map(|(_, at)| at.clone());
        at.and_then(|at| self.text.get(at)).unwrap_or_default().to_owned()
    }

    /// Whether the words that say how somebody stands to the robot's way are those of a step of theirs.
    fn is_step_of(&self, who: usize, act: Said) -> bool {
        let at =
            |wanted: &dyn Fn(&Line) -> bool| self.read.lines.iter().find(|(line, _)| wanted(line)).map(|(_, at)| at);
        let relation = at(&|line| matches!(line, Line::Relation(own, _) if *own == who));
        let steps = self.read.story.people.get(who).map_or(&[][..], |person| &person.steps);
        let numbers = (0..steps.len()).filter(|number| steps.get(*number).is_some_and(|step| step.act == act));
        relation.is_some() && numbers.into_iter().any(|number| at(&|line| *line == Line::Step(who, number)) == relation)
    }

    fn person(&self, story: &mut Story, who: usize) {
        let Some(person) = self.read.story.people.get(who) else { return };
        // Whoever blocks the robot and of whom no more is said may come from anywhere.
        let said = self.quote(|line| matches!(line, Line::Relation(own, _) if *own == who));
        let blocks = person.steps.first().is_some_and(|step| step.act == Said::Block);
        // Whoever follows is behind by that alone.
        let follows = person.relation == Some(Relation::Behind) && self.is_step_of(who, Said::Follow);
        if let Some(relation) = person.relation.filter(|_| !follows && (!said.is_empty() || !blocks)) {
            let grouped = person.group.is_some();
            let quote = self.quote(|line| *line == Line::Relation(who, relation));
            let quote = if quote.is_empty() { self.quote(|line| line.person() == Some(who)) } else { quote };
            let place = person
                .start
                .or(self.read.story.place)
                .filter(|class| matches!(class, PlaceClass::Room | PlaceClass::Elevator));
            deed::apply(&mut story.cast, who, comes(relation, grouped), &Around { place, quote, ..Around::default() });
        }
        if person.walks && person.relation.is_none() && person.steps.is_empty() {
            let quote = self.quote(|line| line.person() == Some(who));
            deed::apply(&mut story.cast, who, Act::Walk, &Around { quote, ..Around::default() });
        }
        if person.crosses {
            let quote = self.quote(|line| *line == Line::Relation(who, Relation::Crossing));
            deed::apply(&mut story.cast, who, Act::Cross, &Around { quote, ..Around::default() });
        }
        if let Some(own) = story.cast.people.get_mut(who) {
            own.side = person.side.map(|side| (side, self.quote(|line| *line == Line::Side(who))));
            own.speed_mps = person.pace_mps.or(own.speed_mps);
        }
        let mut when: Vec<Reason<Vec<usize>>> = Vec::new();
        for (number, step) in person.steps.iter().enumerate() {
            if !step.when.is_empty() {
                when.clone_from(&step.when);
            }
            let joined = step.when.is_empty() && number > 0;
            // `stops and looks`: the one goes with the other. `stops and then looks`: for the same reason, after it.
            let of = if joined && !step.then { &[][..] } else { &when };
            self.step(story, (who, number), step, of, joined);
        }
    }

    /// A step, which begins for these reasons.
    fn step(
        &self,
        story: &mut Story,
        (who, number): (usize, usize),
        step: &Step,
        when: &[Reason<Vec<usize>>],
        joined: bool,
    ) {
        let quote = self.quote(|line| *line == Line::Step(who, number));
        if let Some((first, more)) = step.until.split_first() {
            deed::walk_on(&mut story.cast, who, trigger(first), &quote);
            let ends = story.cast.people.get_mut(who).and_then(|person| person.rules.first_mut());
            if let Some(ends) = ends {
                ends.rule.when.extend(more.iter().map(trigger));
            }
        }
        let vague = when.iter().all(|reason| reason.amount.is_none());
        let around = Around {
            trigger: when.first().map(trigger),
            vague,
            distance_m: when.iter().filter(|reason| is_distance(reason.cue)).find_map(|reason| reason.amount),
            lasts_s: step.for_s,
            gesture: step.says,
            object: step.whom.filter(|_| step.act == Said::Follow).map(human_id),
            then: joined && step.then,
            goes_on: joined && !step.then,
            startled: step.act == Said::Startle,
            quote,
            ..Around::default()
        };
        let made = deed::apply(&mut story.cast, who, act(step.act), &around);
        let rule = made.and_then(|made| story.cast.people.get_mut(who)?.rules.get_mut(made));
        let Some(read) = rule else { return };
        read.rule.when.extend(when.iter().skip(1).map(trigger));
        read.rule.gesture = read.rule.gesture.or(step.says);
        let to = step.whom.filter(|_| step.act == Said::Sign);
        read.rule.to = to.map(|whom| AgentId::Human(human_id(whom)));
    }

    fn groups(&self, story: &mut Story) {
        for (who, person) in self.read.story.people.iter().enumerate() {
            let Some(number) = person.group.and_then(|group| u32::try_from(group).ok()) else { continue };
            let id = GroupId(number);
            match story.cast.groups.iter_mut().find(|(own, ..)| *own == id) {
                Some((_, members, _)) => members.push(who),
                None => {
                    let quote = self.quote(|line| *line == Line::Group(who));
                    story.cast.groups.push((id, vec![who], quote));
                }
            }
            if let Some(own) = story.cast.people.get_mut(who) {
                own.group = Some(id);
            }
        }
    }
}

/// Somebody of a role; a word that says no more than that they are there is none.
fn someone(role: &str) -> Person {
    let called = ["participant", "confederate", "bystander", "passenger", "occupant", "pedestrian"].contains(&role);
    let anybody = called || ["person", "people", "human", "individual", "actor", "agent", "somebody"].contains(&role);
    Person {
        role: if anybody { String::new() } else { role.to_owned() },
        called: called.then(|| role.to_owned()),
        bound: true,
        ..Person::default()
    }
}

/// The deed that puts somebody so to the robot's way.
const fn comes(relation: Relation, grouped: bool) -> Act {
    match relation {
        Relation::Frontal => Act::Toward,
        Relation::Behind => Act::Behind,
        Relation::Ahead => Act::Ahead,
        Relation::Crossing => Act::Cross,
        Relation::Leaving => Act::ComeOut,
        Relation::Staying => Act::Stay,
        Relation::Abreast => Act::Abreast,
        Relation::Aside => Act::Aside,
        Relation::Static if grouped => Act::Talk,
        Relation::Static => Act::Stand,
    }
}

const fn act(said: Said) -> Act {
    match said {
        Said::GiveWay => Act::GiveWay,
        Said::Block => Act::Block,
        Said::Look | Said::Startle => Act::Look,
        Said::StandStill => Act::Stop,
        Said::RunAway => Act::RunAway,
        Said::Approach => Act::Approach,
        Said::Follow => Act::Follow,
        Said::Navigate => Act::GoOn,
        Said::TurnBack => Act::TurnBack,
        Said::Sign => Act::Gesture,
    }
}

const fn is_distance(cue: Cue) -> bool {
    matches!(cue, Cue::Visible | Cue::Near | Cue::Blocking)
}

fn trigger(reason: &Reason<Vec<usize>>) -> Trigger {
    let amount = reason.usual_amount();
    let sign = reason.sign.unwrap_or(Gesture::ExcuseMe);
    let speaker = reason.who.as_ref().and_then(|who| who.first());
    match (reason.cue, speaker) {
        (Cue::Visible, _) => Trigger::RobotVisible(amount),
        (Cue::Near, _) => Trigger::RobotNear(amount),
        (Cue::Blocking, _) => Trigger::RobotBlocking(amount),
        (Cue::Moving, _) => Trigger::RobotMoving,
        (Cue::Stopped, _) => Trigger::RobotStopped,
        (Cue::Passed, _) => Trigger::RobotPassed,
        (Cue::Says, Some(who)) => Trigger::HumanSays(human_id(*who), sign),
        (Cue::Says, None) => Trigger::RobotSays(sign),
        (Cue::Encounter, _) => Trigger::AtEncounter,
        (Cue::Goal, _) => Trigger::GoalReached,
        (Cue::After, _) => Trigger::AfterSecs(amount),
    }
}

/// The first human is `human_1`.
fn human_id(at: usize) -> HumanId {
    HumanId::new(u32::try_from(at + 1).unwrap_or(u32::MAX))
}

/// What became of every piece of the rough scenario. `reading` has the facts, `whole` what was understood of the text alone.
pub(crate) fn statements(request: &Request, whole: &Understood, reading: &Reading) -> Vec<Statement> {
    let key = TextKey::RoughScenario;
    let text = key.text_of(request);
    let told = aside::split(text);
    let read = socrates_reader::read(&told.story);
    let mut found: Vec<(Range<usize>, Became)> = Vec::new();
    for piece in &read.pieces {
        let became = match &piece.fate {
            Fate::Read => became(text, &piece.at, whole, reading),
            Fate::Background(reason) => Became::Background(*reason),
            Fate::NotPlayed(why) => Became::NotPlayed { why: Message::new(why.as_str()) },
            Fate::NotRead => Became::NotRead { rewording: rewording(&told.story, &read, piece) },
        };
        found.push((piece.at.clone(), became));
    }
    let at = |quote: &str| text.find(quote).filter(|_| !quote.is_empty()).map(|from| from..from + quote.len());
    found.extend(
        told.instructions
            .iter()
            .filter_map(|sentence| Some((at(sentence)?, Became::Background(Background::Instruction)))),
    );
    // What a layer above leaves out is said of its words, also where they are read.
    let of_text = |fault: &&Fault| fault.at.is_key(key.name()) || fault.at.agent.is_some();
    let problems = whole
        .reading
        .problems
        .iter()
        .filter(of_text)
        .filter(|fault| !fault.quotes.iter().any(|quote| told.instructions.contains(quote)));
    let quoted = problems.flat_map(|fault| fault.quotes.iter().map(|quote| (quote.clone(), fault.message.clone())));
    let unplayed = whole.unplayed.iter().map(|unplayed| (unplayed.quote.clone(), Message::new(unplayed.why.as_str())));
    found.extend(quoted.chain(unplayed).filter_map(|(quote, why)| Some((at(&quote)?, Became::NotPlayed { why }))));
    found.sort_by_key(|(at, _)| (at.start, at.end));
    found.into_iter().filter_map(|(at, became)| statement(request, text, &at, became)).collect()
}

/// The clause of a piece without the words that were not read, where that is read whole and the story stays the same.
fn rewording(text: &str, read: &Read, piece: &Piece) -> Option<String> {
    let own = || read.pieces.iter().filter(|other| other.clause.is_some() && other.clause == piece.clause);
    let lost = |fate: &Fate| matches!(fate, Fate::NotRead | Fate::NotPlayed(_));
    own().find(|other| other.fate == Fate::Read)?;
    let (from, to) = (own().map(|other| other.at.start).min()?, own().map(|other| other.at.end).max()?);
    let kept: Vec<&str> =
        own().filter(|other| !lost(&other.fate)).filter_map(|other| text.get(other.at.clone())).collect();
    let clause = kept.join(" ");
    let again = format!("{}{clause}{}", text.get(..from)?, text.get(to..)?);
    let reads = socrates_reader::read(&again);
    let within = |other: &Piece| other.at.start < from + clause.len() && from < other.at.end;
    let whole = !reads.pieces.iter().any(|other| within(other) && lost(&other.fate));
    (whole && reads.story == read.story).then_some(clause)
}

/// The lines and facts whose words a piece has.
fn became(text: &str, piece: &Range<usize>, whole: &Understood, reading: &Reading) -> Became {
    let meets = |quote: &str| {
        let mut places = text.match_indices(quote);
        !quote.is_empty() && places.any(|(from, _)| from < piece.end && piece.start < from + quote.len())
    };
    let own = || reading.facts.iter().filter(|fact| meets(&fact.quote));
    let line = |fact: &socrates_model::Fact| {
        let mut lines = whole.lines.iter().filter(|line| line.shown && line.fact.as_ref() == Some(&fact.kind));
        lines.next().map(|line| line.text.clone())
    };
    Became::Read { lines: own().filter_map(line).collect(), facts: own().map(|fact| fact.id.clone()).collect() }
}

fn statement(request: &Request, text: &str, at: &Range<usize>, became: Became) -> Option<Statement> {
    let quote = text.get(at.clone())?.to_owned();
    let statement = Statement { at: TextKey::RoughScenario, span: Span::of(text, at)?, quote, became, waived: false };
    Some(statement.waived_by(request))
}
