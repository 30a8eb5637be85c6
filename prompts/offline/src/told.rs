//! From what the reader read to the story that the layers above use: steps become rules, each with the words that say it.
//!
//! ```text
//! text ─► socrates_reader::Read ─┬─► Story (people, rules, place) ─► settle ─► reading, proposal, paths
//!                                └─► statements: what became of every piece
//! ```
//!
//! Never: a word of the text. What the reader made nothing of is said as it says it.

use socrates_model::request::MAX_HUMANS;
use socrates_model::{Action, AgentId, Fault, FaultCode, Gesture, GroupId, Relation, Rule, Trigger};
use socrates_reader::{Act, Cue, Line, Read, Reader, Reason, Step};

use crate::manner;
use crate::story::{Before, Group, Person, ReadRule, Story, agent, human_id, is_closed, stands};

/// Words that say no more of somebody than that they are there, as roles of a study.
const CALLED: [&str; 6] = ["participant", "confederate", "bystander", "passenger", "occupant", "pedestrian"];
/// Words that say nothing of somebody at all.
const ANYBODY: [&str; 7] = ["person", "people", "human", "individual", "actor", "agent", "somebody"];

/// The story of a text that was read so, each at the pace that is usual in their role.
pub(crate) fn story(text: &str, read: &Read) -> Story {
    let mut story = told(text, read);
    for person in &mut story.people {
        person.speed_mps = person.speed_mps.or_else(|| Reader::shipped().pace_of(&person.role));
    }
    story
}

/// The story that was read of a text.
pub(crate) fn told(text: &str, read: &Read) -> Story {
    let telling = Telling { text, read };
    let mut story = Story::default();
    for (who, person) in read.story.people.iter().enumerate() {
        let mut own = someone(&person.role);
        telling.stands(&mut own, who, person);
        story.people.push(own);
    }
    for (who, person) in read.story.people.iter().enumerate() {
        telling.acts(&mut story, who, person);
    }
    telling.groups(&mut story);
    telling.scene(&mut story);
    story
}

/// A text with what was read of it.
struct Telling<'a> {
    text: &'a str,
    read: &'a Read,
}

impl Telling<'_> {
    /// The words that say a line first; none where nothing of the text does.
    fn quote(&self, wanted: impl Fn(&Line) -> bool) -> String {
        let at = self.read.lines.iter().find(|(line, _)| wanted(line)).map(|(_, at)| at.clone());
        at.and_then(|at| self.text.get(at)).unwrap_or_default().to_owned()
    }

    /// The sentence that says a line first, up to the words that do.
    fn sentence(&self, wanted: impl Fn(&Line) -> bool) -> Option<String> {
        let (_, at) = self.read.lines.iter().find(|(line, _)| wanted(line))?;
        let said = self.text.get(..at.end)?;
        said.rsplit(['.', '!', '?', '\n']).next().map(|own| own.trim().to_owned())
    }

    /// Place and robot, and who comes first.
    fn scene(&self, story: &mut Story) {
        let told = &self.read.story;
        let many = told.people.len() > usize::try_from(MAX_HUMANS).unwrap_or(usize::MAX);
        story.count_quote = Some(self.quote(|line| *line == Line::Person(0)))
            .filter(|quote| !quote.is_empty() && !told.people.is_empty())
            .or_else(|| self.sentence(|line| line.person() == Some(0)).filter(|_| many));
        story.place = told.place.map(|class| (class, self.quote(|line| *line == Line::Place(class))));
        story.robot_leaves = told.robot_start.map(|class| (class, self.quote(|line| *line == Line::RobotStart(class))));
        story.robot_enters = told.robot_goal.map(|class| (class, self.quote(|line| *line == Line::RobotGoal(class))));
        let signs = told.robot_says.iter();
        story.robot_says = signs.map(|sign| (*sign, self.quote(|line| *line == Line::RobotSays(*sign)))).collect();
        story.order.extend(told.robot_first.iter().map(|who| Before {
            first: AgentId::Robot,
            then: agent(*who),
            at_door: false,
            quote: self.quote(|line| *line == Line::RobotFirst(*who)),
        }));
        story.order.extend(told.order.iter().map(|(first, then)| Before {
            first: agent(*first),
            then: agent(*then),
            at_door: false,
            quote: self.quote(|line| *line == Line::Before(*first, *then)),
        }));
        if told.nobody {
            let message =
                format!("the text says that nobody is there; a social scenario needs 1 to {MAX_HUMANS} humans");
            story.problems.push(Fault::new(FaultCode::PLimit, "rough_scenario", message));
            story.nobody = true;
        }
        for class in &told.robot_via {
            let quote = self.quote(|line| *line == Line::RobotVia(*class));
            let why = "what the robot's way leads past is said by its task, or by `via` of a form".to_owned();
            story.unplayed.push(crate::story::Unplayed { quote, why });
        }
    }

    /// How somebody stands to the robot's way.
    fn stands(&self, own: &mut Person, who: usize, person: &socrates_reader::Person) {
        let said = self.quote(|line| matches!(line, Line::Relation(other, _) if *other == who));
        // Whoever blocks the robot and of whom no more is said may come from anywhere.
        let blocks = person.steps.first().is_some_and(|step| step.act == Act::Block);
        // Whoever follows is behind by that alone.
        let follows = person.relation == Some(Relation::Behind) && self.is_step_of(who, Act::Follow);
        let relation = person.relation.filter(|_| !follows && (!said.is_empty() || !blocks));
        let any = || self.quote(|line| line.person() == Some(who));
        if let Some(relation) = relation {
            let quote = self.quote(|line| *line == Line::Relation(who, relation));
            let quote = if quote.is_empty() { any() } else { quote };
            let indoors = matches!(relation, Relation::Leaving | Relation::Staying);
            let place = person.start.or(self.read.story.place).filter(|class| indoors && is_closed(*class));
            own.start = place;
            let standing = relation == Relation::Static && person.group.is_some();
            match standing {
                true if person.queues => own.tell("queues".to_owned()),
                true => own.tell("talks".to_owned()),
                // Said behind what they do.
                false if relation == Relation::Staying => {}
                false => own.tell(stands(relation, place)),
            }
            own.relation = Some((relation, quote));
        }
        if person.walks && person.relation.is_none() && person.steps.is_empty() {
            own.walks = true;
            own.tell("walks".to_owned());
        }
        if person.crosses {
            own.crosses = Some(self.quote(|line| *line == Line::Relation(who, Relation::Crossing)));
            own.tell(stands(Relation::Crossing, None));
        }
        own.side = person.side.map(|side| (side, self.quote(|line| *line == Line::Side(who))));
        own.speed_mps = person.pace_mps;
        own.twice = person.twice.map(|place| (place, self.quote(|line| *line == Line::Twice(who))));
        own.never = person.denied.iter().map(|act| (*act, any())).collect();
    }

    /// Whether the words that say how somebody stands to the robot's way are those of a step of theirs.
    fn is_step_of(&self, who: usize, act: Act) -> bool {
        let at =
            |wanted: &dyn Fn(&Line) -> bool| self.read.lines.iter().find(|(line, _)| wanted(line)).map(|(_, at)| at);
        let relation = at(&|line| matches!(line, Line::Relation(own, _) if *own == who));
        let steps = self.read.story.people.get(who).map_or(&[][..], |person| &person.steps);
        let of_act = |number: &usize| steps.get(*number).is_some_and(|step| step.act == act);
        let mut numbers = (0..steps.len()).filter(of_act);
        relation.is_some() && numbers.any(|number| at(&|line| *line == Line::Step(who, number)) == relation)
    }

    /// What somebody does, step by step.
    fn acts(&self, story: &mut Story, who: usize, person: &socrates_reader::Person) {
        let mut own = story.people.get(who).cloned().unwrap_or_default();
        let mut when: &[Reason<Vec<usize>>] = &[];
        let mut goes_on = None;
        for (number, step) in person.steps.iter().enumerate() {
            let quote = self.quote(|line| *line == Line::Step(who, number));
            if !step.when.is_empty() {
                when = &step.when;
            }
            let joined = step.when.is_empty() && number > 0;
            // `stops and looks`: the one goes with the other. `stops and then looks`: for the same reason, after it.
            let of = if joined && !step.then { &[][..] } else { when };
            let doing = Doing { step, when: of.iter().map(trigger).collect(), of, joined, quote };
            doing.ends(&mut own);
            match step.act {
                Act::Navigate => goes_on = doing.walks_on(&mut own).or(goes_on),
                Act::Sign => doing.signs(&mut own),
                Act::GiveWay
                | Act::Block
                | Act::Look
                | Act::Startle
                | Act::StandStill
                | Act::RunAway
                | Act::Approach
                | Act::Follow
                | Act::TurnBack => match called_by(story, step) {
                    Some(asker) => doing.does(&mut own, Trigger::HumanSays(asker, Gesture::FollowMe)),
                    None => doing.does(&mut own, Trigger::Always),
                },
            }
        }
        if let Some(quote) = goes_on {
            walks_on_at_last(&mut own, quote);
        }
        if own.is(Relation::Staying) {
            own.tell("stays".to_owned());
        }
        if let Some(slot) = story.people.get_mut(who) {
            *slot = own;
        }
    }

    fn groups(&self, story: &mut Story) {
        for (who, person) in self.read.story.people.iter().enumerate() {
            let Some(id) = person.group.and_then(|group| u32::try_from(group).ok()).map(GroupId) else { continue };
            match story.groups.iter_mut().find(|group| group.id == id) {
                Some(group) => group.members.push(who),
                None => {
                    let quote = self.quote(|line| *line == Line::Group(who));
                    story.groups.push(Group { id, members: vec![who], queue: person.queues, quote });
                }
            }
            if let Some(own) = story.people.get_mut(who) {
                own.group = Some(id);
            }
        }
    }
}

/// Somebody of a role; a word that says no more than that they are there is none.
fn someone(role: &str) -> Person {
    let called = CALLED.contains(&role);
    let anybody = called || ANYBODY.contains(&role);
    Person {
        role: if anybody { String::new() } else { role.to_owned() },
        called: called.then(|| role.to_owned()),
        ..Person::default()
    }
}

/// Whoever is followed because they asked for it.
fn called_by(story: &Story, step: &Step) -> Option<socrates_model::HumanId> {
    let leader = step.whom.filter(|_| step.act == Act::Follow)?;
    let asks = |read: &ReadRule| read.rule.gesture == Some(Gesture::FollowMe);
    story.people.get(leader)?.rules.iter().any(asks).then(|| human_id(leader))
}

/// Two wishes that exclude each other.
pub(crate) fn exclude(who: usize, first: &str, second: &str) -> Fault {
    let message = format!(
        "`{first}` and `{second}` cannot both hold for the same human at the same time; say when each, or correct one"
    );
    Fault::new(FaultCode::PContra, agent(who), message).about([first, second])
}

/// Says that something of somebody is not played.
pub(crate) fn unplayed(problems: &mut Vec<Fault>, quote: &str, what: &str) {
    let message = format!("`{quote}` is not played in full: {what} is not played");
    problems.push(Fault::new(FaultCode::PRead, "rough_scenario", message).about([quote]));
}

/// One step while it becomes a rule.
struct Doing<'a> {
    step: &'a Step,
    /// The reasons for which it begins, as triggers and as read.
    when: Vec<Trigger>,
    of: &'a [Reason<Vec<usize>>],
    /// Whether it has the reason of the step before it.
    joined: bool,
    quote: String,
}

impl Doing<'_> {
    fn read(&self, rule: Rule, (stated, exact): (bool, bool)) -> ReadRule {
        let (lasts, then) = (self.step.for_s.is_some(), self.joined && self.step.then);
        ReadRule { rule, quote: self.quote.clone(), stated, exact, lasts, then }
    }

    /// `until it passes`: from then on somebody walks on, whatever they did before. Earlier rules win.
    fn ends(&self, own: &mut Person) {
        if self.step.until.is_empty() {
            return;
        }
        let rule = walks(self.step.until.iter().map(trigger).collect());
        own.rules.insert(0, ReadRule { then: false, lasts: false, ..self.read(rule, (true, true)) });
    }

    /// Walks on for a reason; gives back its words where it has none of its own, so that it comes after all else.
    fn walks_on(&self, own: &mut Person) -> Option<String> {
        own.tell(manner::words(Act::Navigate, None, None));
        let answers = |trigger: &Trigger| {
            use Trigger::{AfterSecs, HumanSays, RobotMoving, RobotPassed, RobotSays, RobotStopped};
            matches!(trigger, RobotSays(_) | HumanSays(..) | RobotStopped | AfterSecs(_) | RobotMoving | RobotPassed)
        };
        let own_reason = self.when.first().is_some_and(answers);
        if own_reason && self.since_last(own, Act::Navigate).is_none() {
            let read = ReadRule { then: false, lasts: false, ..self.read(walks(self.when.clone()), (true, true)) };
            if !own.rules.contains(&read) {
                own.rules.insert(0, read);
            }
            return None;
        }
        // `follows it and then walks on`: they follow no longer then.
        if let Some(last) = own.rules.last_mut().filter(|last| self.joined && self.step.then && follows_on(last)) {
            last.rule.for_s = Some(manner::FOLLOWS_S);
        }
        let more = !own.rules.is_empty() || !self.when.is_empty() || own.doings.len() > 1;
        more.then(|| self.quote.clone())
    }

    /// `blocks it; after ten seconds steps aside`: so long after that began. Gives back for what the step before waits.
    fn since_last(&self, own: &mut Person, act: Act) -> Option<Vec<Trigger>> {
        let Some(Trigger::AfterSecs(secs)) = self.when.first() else { return None };
        let standing = own.is(Relation::Static);
        let last = own.rules.last_mut()?;
        let [when] = last.rule.when.as_slice() else { return None };
        let same = manner::of(act).is_some_and(|manner| manner.act == last.rule.act);
        let waits = !matches!(when, Trigger::Always | Trigger::AfterSecs(_))
            && (last.rule.act != Action::Navigate || last.rule.gesture.is_some())
            && (!last.lasts || last.rule.for_s == Some(*secs))
            // Whoever stands there from the start waits from the start of the run on.
            && !(last.rule.act == Action::StandStill && !last.stated && standing);
        if !waits || same {
            return None;
        }
        let when = vec![when.clone()];
        (last.rule.for_s, last.lasts) = (Some(*secs), true);
        // Whoever makes two signs stays there in between.
        if act == Act::Sign && last.rule.act == Action::Navigate {
            last.rule.act = Action::StandStill;
        }
        Some(when)
    }

    /// Makes a sign, with what is done already or by itself.
    fn signs(&self, own: &mut Person) {
        let Some(gesture) = self.step.says else { return };
        own.tell(manner::words(Act::Sign, None, Some(gesture)));
        let goes_with = self.joined && !self.step.then;
        if let Some(last) = own.rules.last_mut().filter(|last| goes_with && last.rule.gesture.is_none()) {
            last.rule.gesture = Some(gesture);
            return;
        }
        let (act, m, for_s) = manner::sign(gesture);
        let since = self.since_last(own, Act::Sign);
        let when = since.clone().unwrap_or_else(|| self.when.clone());
        let m = self.distance_m().unwrap_or(m);
        let stated = !when.is_empty();
        let when = if when.is_empty() { vec![Trigger::RobotVisible(m)] } else { when };
        let to = self.step.whom.map(agent);
        let for_s = Some(self.step.for_s.unwrap_or(for_s));
        let rule = Rule { when, act, gesture: Some(gesture), for_s, to, latched: true, ..Rule::default() };
        let read = self.read(rule, (stated, false));
        own.rules.push(ReadRule { then: read.then || since.is_some(), ..read });
    }

    /// Does what has a manner of its own. `called`: for what somebody waits who follows somebody else.
    fn does(&self, own: &mut Person, called: Trigger) {
        let Some(usual) = manner::of(self.step.act) else { return };
        let whom = self.step.whom.filter(|_| self.step.act == Act::Follow).map(human_id);
        own.tell(manner::words(self.step.act, whom, None));
        own.startled |= self.step.act == Act::Startle;
        let since = self.since_last(own, self.step.act);
        let said = since.clone().unwrap_or_else(|| self.when.clone());
        let vague = self.of.iter().all(|reason| reason.amount.is_none());
        let distance_m = self.distance_m();
        let when = match (said.as_slice(), whom) {
            ([Trigger::RobotVisible(_), rest @ ..], _) if vague && since.is_none() => [&[usual.when], rest].concat(),
            ([_, ..], _) => said.clone(),
            ([], Some(_)) => vec![called],
            ([], None) => vec![usual.when],
        };
        let act = whom.map_or(usual.act, Action::FollowHuman);
        let rule = Rule {
            when,
            act,
            gesture: self.step.says,
            for_s: self.step.for_s.or(usual.for_s),
            latched: true,
            ..Rule::default()
        };
        let stated = !said.is_empty();
        let exact = distance_m.is_some() || stated && (!vague || since.is_some());
        let read = self.read(rule, (stated, exact));
        let mut read = ReadRule { then: read.then || since.is_some(), ..read };
        // `stops and looks`: the look begins when the stop ends, so it waits for the same.
        let goes_with = self.joined && !self.step.then && matches!(self.step.act, Act::Look | Act::Startle) && !stated;
        if let Some(last) = own.rules.last_mut().filter(|last| goes_with && last.rule.act == Action::StandStill) {
            read.rule.when.clone_from(&last.rule.when);
            if !last.lasts {
                last.rule.for_s = Some(manner::HALT_S);
            }
            return own.rules.push(read);
        }
        // `stands in its way and does not move for ten seconds`
        if let (true, Act::StandStill, Some(last)) = (goes_on(self), self.step.act, own.rules.last_mut())
            && last.rule.act == Action::Block
        {
            if self.step.for_s.is_some() {
                (last.rule.for_s, last.lasts) = (self.step.for_s, true);
            }
            return;
        }
        once(own, read);
    }

    /// How near the robot is when it begins, m, as the text says.
    fn distance_m(&self) -> Option<f64> {
        let near = |reason: &&Reason<Vec<usize>>| matches!(reason.cue, Cue::Visible | Cue::Near | Cue::Blocking);
        self.of.iter().filter(near).find_map(|reason| reason.amount)
    }
}

/// Whether a step without a reason of its own goes with the one before it.
const fn goes_on(doing: &Doing<'_>) -> bool {
    doing.joined && !doing.step.then && doing.when.is_empty()
}

/// Adds a rule, unless the text only says again what another rule holds already: `is surprised, stops and looks`.
fn once(own: &mut Person, read: ReadRule) {
    // `until it says EXCUSE_ME, whereupon he gives way`: what is done then is more than walking on.
    let walks = |old: &&mut ReadRule| {
        old.rule.act == Action::Navigate && old.rule.gesture.is_none() && old.rule.when == read.rule.when
    };
    if let Some(old) = own.rules.iter_mut().find(walks).filter(|_| !read.then) {
        *old = read;
        return;
    }
    let same = |old: &&mut ReadRule| old.rule.act == read.rule.act && old.rule.gesture.is_none() && !read.then;
    // `blocks it, holding this position for 15 seconds`
    let longer = |old: &&mut ReadRule| !old.lasts && read.lasts && (!read.stated || old.rule.when == read.rule.when);
    if let Some(old) = own.rules.iter_mut().rev().filter(same).find(longer) {
        (old.rule.for_s, old.lasts) = (read.rule.for_s, true);
    }
    let again = |old: &ReadRule| {
        let same = old.rule.act == read.rule.act && old.rule.gesture.is_none() && !read.then;
        same && (old.rule.when == read.rule.when || !read.stated)
    };
    if !own.rules.iter().any(again) {
        own.rules.push(read);
    }
}

fn walks(when: Vec<Trigger>) -> Rule {
    Rule { when, act: Action::Navigate, latched: true, ..Rule::default() }
}

/// Whether somebody follows without an end.
fn follows_on(read: &ReadRule) -> bool {
    matches!(read.rule.act, Action::FollowRobot | Action::FollowHuman(_)) && read.rule.for_s.is_none()
}

/// After all that they do somebody walks on, where the text says so.
fn walks_on_at_last(own: &mut Person, quote: String) {
    let walks_already = own.rules.iter().any(|read| read.rule.act == Action::Navigate && read.rule.gesture.is_none());
    // Whoever follows walks on by following.
    if walks_already || own.rules.last().is_some_and(follows_on) {
        return;
    }
    let last = own.rules.last().map(|last| last.rule.when.clone());
    let rule = walks(last.unwrap_or_else(|| vec![Trigger::RobotVisible(manner::WALKS_ON_M)]));
    own.rules.push(ReadRule { rule, quote, stated: false, exact: false, then: true, lasts: false });
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
