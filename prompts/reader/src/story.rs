//! Pass 7: statements of people to a story, and the story as a form.

use std::collections::BTreeSet;
use std::ops::Range;

use socrates_model::{Gesture, PlaceClass, Relation, Side};

use crate::cast::{ANYBODY, People};
use crate::discourse::Told;
use crate::line::Line;
use crate::rows::{Act, Cue};
use crate::statement::{Deed, Reason, Says};

/// Distances at which a reason holds of which the text gives none, m: seen, near, in the way. As the offline author's.
const DISTANCES_M: [(Cue, f64); 3] = [(Cue::Visible, 5.0), (Cue::Near, 3.0), (Cue::Blocking, 2.0)];

impl<W> Reason<W> {
    /// Its distance or time, m or s, as said, or as is usual where the text gives none.
    #[must_use]
    pub fn usual_amount(&self) -> f64 {
        let usual = DISTANCES_M.iter().find(|(cue, _)| *cue == self.cue).map_or(0.0, |(_, usual)| *usual);
        self.amount.unwrap_or(usual)
    }
}

/// One step of somebody.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// All of these have to hold.
    pub when: Vec<Reason<People>>,
    /// What is done.
    pub act: Act,
    /// To whom, where it is not the robot.
    pub whom: Option<usize>,
    /// It ends when these hold.
    pub until: Vec<Reason<People>>,
    /// For how long, s.
    pub for_s: Option<f64>,
    /// A sign made with it.
    pub says: Option<Gesture>,
    /// Whether it comes after the step before it: `and then`.
    pub then: bool,
}

/// One person as read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Person {
    /// Role word.
    pub role: String,
    /// How they stand to the robot's way, where that is said.
    pub relation: Option<Relation>,
    /// Out of which room or car they come.
    pub start: Option<PlaceClass>,
    /// Whether they cross the robot's way once they have come out.
    pub crosses: bool,
    /// On which side.
    pub side: Option<Side>,
    /// How fast they walk, m/s.
    pub pace_mps: Option<f64>,
    /// Number of their group, from 1.
    pub group: Option<usize>,
    /// Whether they stand in it one behind the other.
    pub queues: bool,
    /// Whether they meet the robot twice; the second time there, where that is said.
    pub twice: Option<Option<PlaceClass>>,
    /// What they do, in the order of the text.
    pub steps: Vec<Step>,
    /// What the text says that they do not do.
    pub denied: Vec<Act>,
    /// Whether it says that they walk, and not how.
    pub walks: bool,
}

/// Everything that a text states.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Story {
    /// Everybody, in the order in which they are named.
    pub people: Vec<Person>,
    /// Whether the text says that nobody is there, and names nobody.
    pub nobody: bool,
    /// Where people meet the robot.
    pub place: Option<PlaceClass>,
    /// Where the robot's way begins.
    pub robot_start: Option<PlaceClass>,
    /// Where it ends.
    pub robot_goal: Option<PlaceClass>,
    /// What it leads past.
    pub robot_via: Vec<PlaceClass>,
    /// Those before whom the robot is there.
    pub robot_first: People,
    /// Those of whom the first comes before the second.
    pub order: Vec<(usize, usize)>,
    /// Signs that the robot makes.
    pub robot_says: Vec<Gesture>,
}

/// A story with what says each line of it, and what of the statements is not in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Telling {
    pub(crate) story: Story,
    /// Lines of the story, each with the tokens that say it.
    pub(crate) lines: Vec<(Line, Range<usize>)>,
    /// Numbers of the statements of which a line is not in the story: another one took its place, or somebody was not made out.
    pub(crate) lost: BTreeSet<usize>,
    /// Tokens by which those are named of whom less was read than of the others.
    pub(crate) unplaced: Vec<Range<usize>>,
}

/// Tells the story that statements make.
pub(crate) fn story(told: &Told) -> Telling {
    let people = told.roles.iter().map(|role| Person { role: role.clone(), ..Person::default() }).collect();
    let mut teller = Teller { story: Story { people, ..Story::default() }, ..Teller::default() };
    for (number, statement) in told.statements.iter().enumerate() {
        teller.tell(number, &statement.says, &statement.tokens);
    }
    let Teller { mut story, lines, unsaid, there, goal_there, closed, .. } = teller;
    if goal_there && story.robot_goal.is_none() {
        story.robot_goal = closed;
    }
    let out = unsure(told);
    story.without(&out);
    story.settle(told, there);
    let mut telling = Telling { story, lost: unsaid, ..Telling::default() };
    let mut lost: Vec<(usize, Range<usize>)> = Vec::new();
    for (number, mut line, tokens) in lines {
        let named = matches!(line, Line::Person(_));
        if line.without(&out) && telling.story.holds(&line) {
            telling.lines.push((line, tokens));
        } else if !named {
            lost.push((number, tokens));
        }
    }
    // `follows it` puts somebody behind, and they do so all the same.
    let follows = |line: &Line| {
        let Line::Step(person, step) = line else { return false };
        let steps = telling.story.people.get(*person).map_or(&[][..], |person| &person.steps);
        steps.get(*step).is_some_and(|step| step.act == Act::Follow)
    };
    let others = |tokens: &Range<usize>| telling.lines.iter().any(|(line, own)| own == tokens && follows(line));
    telling
        .lost
        .extend(lost.into_iter().filter(|(_, tokens)| !others(tokens)).map(|(number, _)| number).collect::<Vec<_>>());
    // Whoever makes the very sign that they wait for was not made out.
    let echoes: Vec<Range<usize>> =
        telling.lines.iter().filter(|(line, _)| telling.story.echoes(line)).map(|(_, at)| at.clone()).collect();
    telling.unplaced.extend(echoes);
    let unplaced = telling.story.unplaced();
    for person in unplaced.into_iter().filter(|person| *person >= told.known) {
        let line = telling.lines.iter().find(|(line, _)| line.person() == Some(person));
        telling.unplaced.extend(line.map(|(_, tokens)| tokens.clone()));
    }
    telling
}

/// A story as it is being told.
#[derive(Default)]
struct Teller {
    story: Story,
    /// Lines with the numbers of their statements, and their tokens.
    lines: Vec<(usize, Line, Range<usize>)>,
    /// Numbers of the statements that say something for which the story has no line.
    unsaid: BTreeSet<usize>,
    groups: usize,
    /// How much the place counts that was told so far.
    ranked: u8,
    /// Whether it happens where the robot's way ends.
    there: bool,
    /// Whether the robot's way ends in the room or car of which is spoken.
    goal_there: bool,
    closed: Option<PlaceClass>,
}

impl Teller {
    fn tell(&mut self, number: usize, says: &Says<People>, tokens: &Range<usize>) {
        let story = &mut self.story;
        let steps: Vec<usize> = story.people.iter().map(|person| person.steps.len()).collect();
        let mut lines: Vec<Line> = Vec::new();
        match says {
            Says::Relate(who, relation, side) => {
                story.relate(who, *relation, *side);
                lines.extend(relation.iter().flat_map(|of| who.iter().map(move |person| Line::Relation(*person, *of))));
                lines.extend(side.iter().flat_map(|_| who.iter().map(|person| Line::Side(*person))));
            }
            // Those who talk on are no new group.
            Says::Group(who) if who.len() > 1 && !story.share_a_group(who) => {
                self.groups += 1;
                let group = self.groups;
                story.each(who, |person| person.group = Some(group));
                lines.extend(who.iter().map(|person| Line::Group(*person)));
            }
            Says::Twice(who, place) => {
                story.each(who, |person| person.twice = Some(*place));
                lines.extend(who.iter().map(|person| Line::Twice(*person)));
            }
            Says::Queue(who) => story.each(who, |person| person.queues = true),
            Says::Pace(who, mps) => {
                story.each(who, |person| person.pace_mps = Some(*mps));
                lines.extend(who.iter().map(|person| Line::Pace(*person)));
            }
            Says::Do(deed) => lines.extend(story.does(deed).into_iter().map(Line::RobotSays)),
            Says::RobotSays(Some(gesture), _)
            | Says::Then(Reason { who: None, cue: Cue::Says, sign: Some(gesture), .. }, _) => {
                story.robot_sign(*gesture);
                lines.push(Line::RobotSays(*gesture));
            }
            Says::Happens(class, rank) => {
                if matches!(class, PlaceClass::Elevator | PlaceClass::Room) {
                    self.closed = Some(*class);
                }
                if *rank > self.ranked {
                    (story.place, self.ranked) = (Some(*class), *rank);
                }
                lines.push(Line::Place(*class));
            }
            Says::From(who, class) => story.each(who, |person| person.start = Some(*class)),
            Says::RobotFirst(who) => {
                let who = who.iter().flatten().copied();
                let new: People = who.filter(|person| !story.robot_first.contains(person)).collect();
                lines.extend(new.iter().map(|person| Line::RobotFirst(*person)));
                story.robot_first.extend(new);
            }
            Says::After(first, then) => {
                let pairs = first.iter().flatten().flat_map(|first| then.iter().map(move |then| (*first, *then)));
                for (first, then) in pairs.filter(|pair| !story.order.contains(pair)).collect::<Vec<_>>() {
                    story.order.push((first, then));
                    lines.push(Line::Before(first, then));
                }
            }
            Says::There => self.there = true,
            Says::GoalThere => self.goal_there = true,
            Says::RobotVia(class) => {
                story.robot_via.push(*class);
                lines.push(Line::RobotVia(*class));
            }
            Says::RobotStart(class) => {
                story.robot_start = Some(*class);
                lines.push(Line::RobotStart(*class));
            }
            Says::RobotGoal(class) => {
                story.robot_goal = Some(*class);
                lines.push(Line::RobotGoal(*class));
            }
            // Whoever does something and walks then would have to walk on: that is not what was read.
            Says::Walks(who) if who.iter().any(|person| steps.get(*person).is_some_and(|steps| *steps > 0)) => {
                self.unsaid.insert(number);
            }
            Says::Walks(who) => {
                story.each(who, |person| person.walks = true);
                lines.extend(who.iter().map(|person| Line::Person(*person)));
            }
            Says::Introduce(who) | Says::Noted(who) => lines.extend(who.iter().map(|person| Line::Person(*person))),
            Says::Group(_)
            | Says::RobotSays(None, _)
            | Says::Then(..)
            | Says::Background(_)
            | Says::NotPlayed(_)
            | Says::Goes
            | Says::NotRead => {}
        }
        for (person, before) in steps.into_iter().enumerate() {
            let now = self.story.people.get(person).map_or(0, |person| person.steps.len());
            lines.extend((before..now).map(|step| Line::Step(person, step)));
        }
        self.lines.extend(lines.into_iter().map(|line| (number, line, tokens.clone())));
    }
}

/// How much is told of somebody.
#[derive(Clone, Copy, Default)]
struct Known {
    /// Something is: how they stand, or what they do.
    told: bool,
    /// It is in a clause that is read without a word left.
    whole: bool,
    /// They are named in one.
    named: bool,
}

/// People who are named in clauses that are not read, and of whom nothing is read anywhere; and anybody in general, where others are
/// named.
fn unsure(told: &Told) -> Vec<usize> {
    let mut known = vec![Known::default(); told.roles.len()];
    for statement in &told.statements {
        let (who, tells): (Vec<usize>, bool) = match &statement.says {
            Says::Relate(who, ..) | Says::Group(who) | Says::Pace(who, _) => (who.clone(), true),
            Says::Do(deed) => (deed.who.iter().chain(deed.whom.iter().flatten()).copied().collect(), true),
            Says::Introduce(who) | Says::Noted(who) | Says::Walks(who) | Says::RobotSays(_, Some(who)) => {
                (who.clone(), false)
            }
            Says::RobotSays(..)
            | Says::Then(..)
            | Says::RobotFirst(_)
            | Says::After(..)
            | Says::Queue(_)
            | Says::Twice(..)
            | Says::From(..)
            | Says::Happens(..)
            | Says::RobotVia(_)
            | Says::GoalThere
            | Says::There
            | Says::RobotStart(_)
            | Says::RobotGoal(_)
            | Says::Background(_)
            | Says::NotPlayed(_)
            | Says::Goes
            | Says::NotRead => continue,
        };
        for person in who {
            if let Some(own) = known.get_mut(person) {
                own.told |= tells;
                own.whole |= tells && !statement.partly;
                own.named |= !statement.partly;
            }
        }
    }
    let anybody = |person: usize| told.roles.get(person).is_some_and(|role| ANYBODY.contains(&role.as_str()));
    let sure = |person: usize, own: &Known| (own.told || own.named) && !told.vague.contains(&person);
    let others = known.iter().enumerate().any(|(person, own)| sure(person, own));
    let somebody = known.iter().enumerate().any(|(person, own)| own.whole && sure(person, own) && !anybody(person));
    let sure: Vec<bool> = known
        .iter()
        .enumerate()
        .map(|(person, own)| {
            // Those of whom is spoken in general are nobody where others are named; nor is anybody of whom less is read.
            let vague = others && told.vague.contains(&person);
            let less = somebody && anybody(person) && !own.whole;
            let heading = others && told.plain.contains(&person) && !own.told;
            person < told.known || (own.told || own.named) && !vague && !less && !heading
        })
        .collect();
    let unsure: Vec<usize> = (0..sure.len()).filter(|person| sure.get(*person) == Some(&false)).collect();
    if unsure.len() < sure.len() { unsure } else { Vec::new() }
}

impl Story {
    /// Whether it says so. Somebody who stands there and then walks, or is inside, stood there as well.
    fn holds(&self, line: &Line) -> bool {
        match line {
            Line::Relation(person, relation) => {
                let own = self.people.get(*person).and_then(|person| person.relation);
                let crosses = self.people.get(*person).is_some_and(|person| person.crosses);
                own == Some(*relation)
                    || own.is_some() && *relation == Relation::Static
                    || crosses && *relation == Relation::Crossing
                    // Of those who come out one who stays was inside with them.
                    || own == Some(Relation::Staying) && *relation == Relation::Leaving
            }
            Line::RobotStart(class) => self.robot_start == Some(*class),
            Line::RobotGoal(class) => self.robot_goal == Some(*class),
            Line::Person(_)
            | Line::Side(_)
            | Line::Pace(_)
            | Line::Group(_)
            | Line::Twice(_)
            | Line::Step(..)
            | Line::Place(_)
            | Line::RobotVia(_)
            | Line::RobotFirst(_)
            | Line::Before(..)
            | Line::RobotSays(_) => true,
        }
    }

    /// Whether it is a step by which somebody makes a sign as soon as it is made.
    fn echoes(&self, line: &Line) -> bool {
        let Line::Step(person, number) = line else { return false };
        let step = self.people.get(*person).and_then(|person| person.steps.get(*number));
        let same = |step: &Step, sign: Gesture| {
            sign != Gesture::Acknowledged
                && step.when.iter().any(|reason| reason.cue == Cue::Says && reason.sign == Some(sign))
        };
        step.is_some_and(|step| step.says.is_some_and(|sign| same(step, sign)))
    }

    fn relate(&mut self, who: &[usize], relation: Option<Relation>, side: Option<Side>) {
        // `Three get out; one of them stays inside.`
        let leaves = |person: &Person| person.relation == Some(Relation::Leaving);
        let rest_leaves = self.people.iter().enumerate().any(|(other, person)| leaves(person) && !who.contains(&other));
        self.each(who, |person| {
            person.side = side.or(person.side);
            let Some(relation) = relation else { return };
            // What is said first holds: `stands in the corridor and crosses it then` does not happen at once.
            let follows = relation == Relation::Behind;
            let stands = person.relation.is_none() || person.relation == Some(Relation::Static) && !follows;
            // Whoever comes out and crosses does both.
            let both = [Some(Relation::Leaving), Some(Relation::Crossing)];
            if both.contains(&person.relation) && both.contains(&Some(relation)) && person.relation != Some(relation) {
                (person.relation, person.crosses) = (Some(Relation::Leaving), true);
            }
            let stays = leaves(person) && relation == Relation::Staying && rest_leaves;
            if stands || stays || person.relation == Some(Relation::Staying) && relation == Relation::Leaving {
                person.relation = Some(relation);
            }
        });
    }

    /// Settles what follows from the whole: who stands, and who is inside.
    fn settle(&mut self, told: &Told, there: bool) {
        // Whoever is in the robot's way from the start stands there.
        for person in self.people.iter_mut().filter(|person| person.relation.is_none()) {
            let blocks = |step: &&Step| step.act == Act::Block && step.when.is_empty();
            if person.steps.first().as_ref().is_some_and(blocks) {
                person.relation = Some(Relation::Static);
            }
        }
        // Whoever comes out, or stays inside, is where the robot goes.
        let inside = |person: &Person| matches!(person.relation, Some(Relation::Leaving | Relation::Staying));
        if self.place.is_none() && (there || self.people.iter().any(inside)) {
            self.place = self.robot_goal;
        }
        // Of several, some of whom come out, those who stay are inside.
        if self.people.iter().any(|person| person.relation == Some(Relation::Leaving)) {
            for person in self.people.iter_mut().filter(|person| person.relation == Some(Relation::Static)) {
                if person.steps.iter().any(|step| step.act == Act::StandStill) {
                    person.relation = Some(Relation::Staying);
                }
            }
        }
        // Whoever stays where they are as the robot comes into their room or car is inside.
        let elevator = self.place == Some(PlaceClass::Elevator);
        let closed = elevator || self.place == Some(PlaceClass::Room);
        let enters = told.statements.iter().any(|statement| {
            matches!(&statement.says, Says::Then(Reason { who: None, cue: Cue::Visible, .. }, _))
                || matches!(&statement.says, Says::RobotGoal(class) if Some(*class) == self.place)
        });
        let comes_in =
            |step: &Step| step.when.iter().any(|reason| reason.cue == Cue::Visible) || enters && step.when.is_empty();
        for person in self.people.iter_mut().filter(|person| closed && person.relation.is_none_or(Relation::stands)) {
            if person
                .steps
                .iter()
                .any(|step| step.act == Act::StandStill && (comes_in(step) || elevator && step.when.is_empty()))
            {
                person.relation = Some(Relation::Staying);
            }
        }
        // In the open nobody is inside.
        let open = self.place.is_some_and(|place| {
            !matches!(place, PlaceClass::Elevator | PlaceClass::Room | PlaceClass::Doorway | PlaceClass::ElevatorLobby)
        });
        for person in self.people.iter_mut().filter(|person| open && person.relation == Some(Relation::Staying)) {
            person.relation = Some(Relation::Static);
        }
    }

    /// Those of whom nothing says how they stand to the robot's way, where of others something does; and anybody at all among
    /// others who have a role. Mostly something that tells of them was not made out.
    fn unplaced(&self) -> People {
        let placed = |person: &Person| {
            // Whoever follows is behind by that; whoever comes up or runs away may come from anywhere.
            let comes = |step: &Step| matches!(step.act, Act::Follow | Act::Approach | Act::RunAway);
            let group = |other: &&Person| person.group.is_some() && other.group == person.group;
            person.relation.is_some()
                || person.steps.iter().any(comes)
                || self.people.iter().filter(group).any(|other| other.relation.is_some())
        };
        let anybody = |person: &Person| ANYBODY.contains(&person.role.as_str());
        let any_placed = self.people.iter().any(|person| person.relation.is_some());
        let any_role = self.people.iter().any(|person| !anybody(person));
        let less = |person: &Person| {
            any_placed && !placed(person)
                || any_role && anybody(person)
                || person.relation.is_none() && person.steps.is_empty()
        };
        self.people.iter().enumerate().filter(|(_, person)| less(person)).map(|(at, _)| at).collect()
    }

    /// Takes people out, and numbers the others anew.
    fn without(&mut self, out: &[usize]) {
        let anew = |person: usize| person - out.iter().filter(|gone| **gone < person).count();
        let mut number = 0;
        self.people.retain(|_| {
            number += 1;
            !out.contains(&(number - 1))
        });
        self.robot_first = self.robot_first.iter().filter(|person| !out.contains(person)).copied().map(anew).collect();
        self.order.retain(|(first, then)| !out.contains(first) && !out.contains(then));
        self.order.iter_mut().for_each(|pair| *pair = (anew(pair.0), anew(pair.1)));
        for step in self.people.iter_mut().flat_map(|person| &mut person.steps) {
            step.whom = step.whom.map(anew);
            for reason in step.when.iter_mut().chain(&mut step.until) {
                reason.who = reason.who.as_ref().map(|who| who.iter().copied().map(anew).collect());
            }
        }
    }

    /// Whether all of some people are in one group already.
    fn share_a_group(&self, who: &[usize]) -> bool {
        let group = |person: &usize| self.people.get(*person).and_then(|person| person.group);
        who.first().and_then(group).is_some_and(|first| who.iter().all(|person| group(person) == Some(first)))
    }

    fn each(&mut self, who: &[usize], mut change: impl FnMut(&mut Person)) {
        for number in who {
            if let Some(person) = self.people.get_mut(*number) {
                change(person);
            }
        }
    }

    fn robot_sign(&mut self, gesture: Gesture) {
        if !self.robot_says.contains(&gesture) {
            self.robot_says.push(gesture);
        }
    }

    /// Somebody does something; the signs of the robot for which that waits.
    fn does(&mut self, deed: &Deed<People>) -> Vec<Gesture> {
        let signs = deed.when.iter().chain(&deed.until);
        let by_robot: Vec<Gesture> = signs
            .filter(|reason| reason.cue == Cue::Says && reason.who.is_none())
            .filter_map(|reason| reason.sign)
            .collect();
        for gesture in &by_robot {
            self.robot_sign(*gesture);
        }
        if deed.not {
            self.each(&deed.who, |person| person.denied.push(deed.act));
            return by_robot;
        }
        let whom = deed.whom.as_ref().and_then(|whom| whom.first().copied());
        let step = Step {
            when: deed.when.clone(),
            act: deed.act,
            whom,
            until: deed.until.clone(),
            for_s: deed.for_s,
            says: deed.says,
            then: deed.then,
        };
        self.each(&deed.who, |person| {
            // Somebody of whom nothing else is known stands there from the start.
            if step.act == Act::StandStill
                && step.when.is_empty()
                && person.relation.is_none()
                && person.steps.is_empty()
                && !person.walks
            {
                person.relation = Some(Relation::Static);
            }
            if !person.steps.contains(&step) {
                person.steps.push(step.clone());
            }
        });
        by_robot
    }
}

/// `human_1` of the first.
pub(crate) fn name(number: usize) -> String {
    format!("human_{}", number + 1)
}
