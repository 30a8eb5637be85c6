//! The story as the reading that the solver takes: people with their rules, facts with their quotes, and what became of every piece.
//!
//! ```text
//! human_1: block when near until says EXCUSE_ME
//!   ─► rule 1: when the robot says EXCUSE_ME they walk on         (earlier rules win)
//!      rule 2: when the robot is within 3 m they block the robot
//! ```
//!
//! Never: a map. What a map lacks, and what excludes each other, the solver says.

use std::ops::Range;

use socrates_model::fault::{Message, Span};
use socrates_model::proposal::WayPart;
use socrates_model::reading::ReadHuman;
use socrates_model::statement::{Became, TextKey};
use socrates_model::{Action, AgentId, FORMAT, Fact, FactKind, Gesture, GroupId, HumanId, Reading, Rule, Trigger};

use crate::account::{Fate, Piece, Read};
use crate::cast::People;
use crate::rows::{Act, Cue};
use crate::statement::Reason;
use crate::story::{Line, Person, Step, Story, amount_of};

impl Read {
    /// The reading of the text that was read, under its key in the request.
    #[must_use]
    pub fn reading(&self, text: &str, key: TextKey) -> Reading {
        let quoted = self.facts(text);
        let facts: Vec<Fact> = (1..)
            .zip(&quoted)
            .map(|(number, (kind, at))| {
                let quote = at.clone().and_then(|at| text.get(at)).unwrap_or_default().to_owned();
                Fact { id: format!("f{number}"), quote, kind: kind.clone() }
            })
            .collect();
        let at: Vec<Option<Range<usize>>> = quoted.into_iter().map(|(_, at)| at).collect();
        let statements = self.pieces.iter().filter_map(|piece| statement(piece, text, key, &facts, &at)).collect();
        Reading {
            format: FORMAT,
            humans: self.story.people.iter().enumerate().map(|(at, person)| human(at, person)).collect(),
            place: self.story.place,
            facts,
            statements,
            ..Reading::default()
        }
    }

    /// Every fact, with the bytes of the words that say it.
    fn facts(&self, text: &str) -> Vec<(FactKind, Option<Range<usize>>)> {
        let story = &self.story;
        let count = u32::try_from(story.people.len()).unwrap_or(u32::MAX);
        let mut facts = Vec::new();
        if count > 0 {
            facts.push((FactKind::Humans(count), self.said(|line| matches!(line, Line::Person(0)))));
        }
        facts.extend(groups(story).into_iter().map(|(group, members)| {
            let at = self.said(|line| matches!(line, Line::Group(person) if members.contains(person)));
            let members = members.iter().map(|member| human_id(*member)).collect();
            (FactKind::Group { group, members }, at)
        }));
        for (at, person) in story.people.iter().enumerate() {
            facts.extend(self.of_person(at, person));
        }
        facts.extend(story.place.map(|class| (FactKind::Place(class), self.said(|line| *line == Line::Place(class)))));
        for gesture in &story.robot_says {
            facts.push((FactKind::RobotSays(*gesture), self.said(|line| *line == Line::RobotSays(*gesture))));
        }
        facts.extend(
            story
                .robot_start
                .map(|class| (FactKind::RobotStart(class), self.said(|line| *line == Line::RobotStart(class)))),
        );
        facts.extend(
            story
                .robot_goal
                .map(|class| (FactKind::RobotGoal(class), self.said(|line| *line == Line::RobotGoal(class)))),
        );
        // A place by name is found on a map by whoever has one: here it is a class.
        for class in &story.robot_via {
            let at = self.said(|line| *line == Line::RobotVia(*class));
            let name = at.clone().and_then(|at| text.get(at)).unwrap_or_else(|| class.name()).to_owned();
            facts.push((FactKind::RobotAt { part: WayPart::Via, name, nodes: Vec::new() }, at));
        }
        facts
    }

    /// The first words that say a line.
    fn said(&self, wanted: impl Fn(&Line) -> bool) -> Option<Range<usize>> {
        self.lines.iter().find(|(line, _)| wanted(line)).map(|(_, at)| at.clone())
    }

    /// Facts about somebody.
    fn of_person(&self, at: usize, person: &Person) -> Vec<(FactKind, Option<Range<usize>>)> {
        let human = human_id(at);
        let mut facts = Vec::new();
        facts.extend(person.relation.map(|relation| {
            (FactKind::Relates { human, relation }, self.said(|line| *line == Line::Relation(at, relation)))
        }));
        facts.extend(
            person.side.map(|side| (FactKind::Side { human, side }, self.said(|line| *line == Line::Side(at)))),
        );
        facts.extend(
            person.pace_mps.map(|mps| (FactKind::Pace { human, mps }, self.said(|line| *line == Line::Pace(at)))),
        );
        for (number, step, rules) in rules(person) {
            let quote = self.said(|line| *line == Line::Step(at, number));
            for rule in rules {
                match rule.gesture {
                    Some(gesture) => {
                        facts.push((FactKind::Gestures { human, gesture }, quote.clone()));
                        let to = to_whom(step).map(|to| FactKind::GesturesTo { human, gesture, to });
                        facts.extend(to.map(|kind| (kind, quote.clone())));
                    }
                    None => facts.push((FactKind::Reacts { human, rule }, quote.clone())),
                }
            }
        }
        facts
    }
}

/// The groups of a story, each with its members.
fn groups(story: &Story) -> Vec<(GroupId, People)> {
    let number = |person: &Person| person.group.and_then(|group| u32::try_from(group).ok());
    let mut groups: Vec<(GroupId, People)> = Vec::new();
    for (at, group) in story.people.iter().enumerate().filter_map(|(at, person)| Some((at, GroupId(number(person)?)))) {
        match groups.iter_mut().find(|(own, _)| *own == group) {
            Some((_, members)) => members.push(at),
            None => groups.push((group, vec![at])),
        }
    }
    groups
}

fn human(at: usize, person: &Person) -> ReadHuman {
    let rules: Vec<Rule> = rules(person).into_iter().flat_map(|(_, _, rules)| rules).collect();
    let relation = person.relation.map(|relation| relation.name().to_owned());
    let summary: Vec<String> = relation.into_iter().chain(rules.iter().map(Rule::phrase)).collect();
    ReadHuman {
        id: human_id(at),
        role: person.role.clone(),
        summary: summary.join(", "),
        relation: person.relation,
        rules,
        group: person.group.and_then(|group| u32::try_from(group).ok()).map(GroupId),
    }
}

/// The rules of somebody, by their steps. A step without a reason of its own begins with the one before it, and after it; what
/// ends a step is a rule before it by which they walk on.
fn rules(person: &Person) -> Vec<(usize, &Step, Vec<Rule>)> {
    let mut when: Vec<Trigger> = vec![Trigger::Always];
    let mut all = Vec::new();
    for (number, step) in person.steps.iter().enumerate() {
        if !step.when.is_empty() {
            when = step.when.iter().map(trigger).collect();
        }
        let mut rules = Vec::new();
        if !step.until.is_empty() {
            rules.push(Rule {
                when: step.until.iter().map(trigger).collect(),
                act: Action::Navigate,
                ..Rule::default()
            });
        }
        rules.push(Rule {
            when: when.clone(),
            act: action(step),
            gesture: step.says,
            to: to_whom(step),
            for_s: step.for_s,
            ..Rule::default()
        });
        all.push((number, step, rules));
    }
    all
}

fn action(step: &Step) -> Action {
    match (step.act, step.whom) {
        (Act::GiveWay, _) => Action::GiveWay,
        (Act::Block, _) => Action::Block,
        (Act::Look, _) => Action::LookAtRobot,
        (Act::StandStill, _) => Action::StandStill,
        (Act::RunAway, _) => Action::RunAway,
        (Act::Approach, _) => Action::Approach,
        (Act::Follow, Some(whom)) => Action::FollowHuman(human_id(whom)),
        (Act::Follow, None) => Action::FollowRobot,
        (Act::TurnBack, _) => Action::TurnBack,
        (Act::Navigate | Act::Sign, _) => Action::Navigate,
    }
}

/// To whom a sign is made, where that is somebody else than the robot.
fn to_whom(step: &Step) -> Option<AgentId> {
    step.whom.filter(|_| step.act == Act::Sign).map(|whom| AgentId::Human(human_id(whom)))
}

fn trigger(reason: &Reason<People>) -> Trigger {
    let amount = amount_of(reason);
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

/// A piece as a statement of the reading; read, it names the facts whose words it has.
fn statement(
    piece: &Piece,
    text: &str,
    key: TextKey,
    facts: &[Fact],
    at: &[Option<Range<usize>>],
) -> Option<socrates_model::Statement> {
    let overlaps = |at: &Range<usize>| at.start < piece.at.end && piece.at.start < at.end;
    let own = || facts.iter().zip(at).filter(|(_, at)| at.as_ref().is_some_and(overlaps)).map(|(fact, _)| fact);
    let became = match &piece.fate {
        Fate::Read => {
            let lines = own().map(|fact| line(&fact.kind)).collect();
            Became::Read { lines, facts: own().map(|fact| fact.id.clone()).collect() }
        }
        Fate::Background(reason) => Became::Background(*reason),
        Fate::NotPlayed(why) => Became::NotPlayed { why: Message::new(why.as_str()) },
        Fate::NotRead => Became::NotRead { rewording: None },
    };
    let quote = text.get(piece.at.clone())?.to_owned();
    Some(socrates_model::Statement { at: key, span: span(text, &piece.at)?, quote, became, waived: false })
}

/// Bytes of a text as a span of characters.
fn span(text: &str, bytes: &Range<usize>) -> Option<Span> {
    let characters = |end: usize| u32::try_from(text.get(..end)?.chars().count()).ok();
    Some(Span { from: characters(bytes.start)?, to: characters(bytes.end)? })
}

/// A fact in a line.
fn line(kind: &FactKind) -> String {
    match kind {
        FactKind::Humans(count) => format!("humans: {count}"),
        FactKind::Group { group, members } => {
            let members: Vec<String> = members.iter().map(ToString::to_string).collect();
            format!("{group}: {}", members.join(", "))
        }
        FactKind::Reacts { human, rule } => format!("{human}: {}", rule.phrase()),
        FactKind::Relates { human, relation } => format!("{human}: relation = \"{}\"", relation.name()),
        FactKind::Side { human, side } => format!("{human}: side = \"{}\"", side.name()),
        FactKind::Pace { human, mps } => format!("{human}: pace = {mps}"),
        FactKind::Gestures { human, gesture } => format!("{human}: say = \"{gesture}\""),
        FactKind::GesturesTo { human, gesture, to } => format!("{human}: say = \"{gesture}\", to = \"{to}\""),
        FactKind::Place(class) => format!("place: {class}"),
        FactKind::RobotSays(gesture) => format!("robot: says {gesture}"),
        FactKind::RobotStart(class) => format!("robot: start = \"{class}\""),
        FactKind::RobotGoal(class) => format!("robot: goal = \"{class}\""),
        FactKind::RobotAt { name, .. } => format!("robot: via = \"{name}\""),
        // The reader makes no others.
        FactKind::Facing { .. }
        | FactKind::Goal { .. }
        | FactKind::MeetsTimes { .. }
        | FactKind::Before { .. }
        | FactKind::RobotTask(_)
        | FactKind::RobotDoes(_)
        | FactKind::Asked { .. }
        | FactKind::Pattern(_) => String::new(),
    }
}
