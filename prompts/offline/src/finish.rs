//! What the text leaves open, once all of it is read.

use socrates_model::{Action, Fault, FaultCode, Gesture, HumanId, PlaceClass, Relation, Trigger};

use crate::cast::{Person, ReadRule};
use crate::deed;
use crate::inside;
use crate::relation;
use crate::robot_deed::UP_TO_PLANNER;
use crate::rules;
use crate::statements::Unplayed;
use crate::story::Story;

/// A standing group is judged until the robot is within 3 m; its members react a little later.
pub(crate) const CIRCLE_M: f64 = 2.8;
/// The farthest from which the first sight of the robot startles somebody, m: in the elevator case of SocRATES
/// (arXiv 2412.19595) the door opens with the robot in front of it; 0.8 to 5 m is our reading of that.
const FIRST_SIGHT_M: f64 = 5.0;

impl Story {
    /// Fills relations that follow from the deeds, and finds wishes that exclude each other.
    pub(crate) fn finish(&mut self) {
        inside::settle(self);
        let inside = self.cast.people.iter().any(|p| is(p, Relation::Leaving) || is(p, Relation::Staying));
        match self.weak_place.take() {
            Some(weak) if self.place.is_none() || inside && weak.0 == PlaceClass::Elevator => self.place = Some(weak),
            Some(_) | None => {}
        }
        // `comes out of the ward and goes to the elevator`: met before the ward, on the way.
        let mut leavers = self.cast.people.iter().filter(|person| is(person, Relation::Leaving)).peekable();
        let of_rooms = leavers.peek().is_some() && leavers.all(|person| person.start == Some(PlaceClass::Room));
        let end = |quote: &str| ["to the elevator", "to the lift"].iter().any(|words| quote.contains(words));
        let place = &mut self.place;
        if of_rooms
            && let Some((_, quote)) = place.take_if(|(class, quote)| *class == PlaceClass::Elevator && end(quote))
        {
            let why = "people are met on their way; that they end at the elevator is not demanded";
            self.cast.leave_out(&quote, why);
        }
        let elevator = self.place.as_ref().is_some_and(|(class, _)| *class == PlaceClass::Elevator);
        let leaving = self.cast.people.iter().any(|p| is(p, Relation::Leaving));
        for who in 0..self.cast.people.len() {
            let Some(person) = self.cast.people.get(who) else { continue };
            if elevator && leaving && (person.relation.is_none() || is(person, Relation::Static)) {
                let quote = self.place.as_ref().map(|(_, quote)| quote.clone()).unwrap_or_default();
                if person.doings.is_empty() {
                    self.cast.notes.push(format!("nothing is said of human_{}; it stays in the elevator", who + 1));
                }
                relation::relate(&mut self.cast, who, Relation::Staying, &quote);
                if let Some(person) = self.cast.people.get_mut(who) {
                    person.start = Some(PlaceClass::Elevator);
                }
            } else if elevator
                && is(person, Relation::Leaving)
                && let Some(person) = self.cast.people.get_mut(who)
            {
                person.start = Some(PlaceClass::Elevator);
                for doing in person.doings.iter_mut().filter(|doing| *doing == "comes out of the room") {
                    "leaves the elevator".clone_into(doing);
                }
            }
        }
        for (id, person) in (1..).map(HumanId::new).zip(&mut self.cast.people) {
            // `when the worker says proceed, the robot goes on`: nobody answers its own word.
            let own = |read: &ReadRule| {
                read.rule.when.iter().any(|trigger| matches!(trigger, Trigger::HumanSays(who, _) if *who == id))
            };
            let left =
                person.rules.iter().filter(|read| own(read)).map(|read| Unplayed::of(&read.quote, UP_TO_PLANNER));
            self.cast.unplayed.extend(left);
            person.rules.retain(|read| !own(read));
            deed::settle_going_on(person);
            rules::settle(person);
            if rules::stays_then(person) {
                person.relation = None;
            }
        }
        if self.robot_part == Some("leading") && self.robot_enters.is_none() {
            self.robot_enters = self.headed.take();
        }
        self.stays_with_group();
        self.come_up_to();
        self.standing();
        self.startled();
        self.clashes();
        self.dubious();
    }

    /// The relation of a human: as said, or as its deeds and its group suggest.
    pub(crate) fn relation_of(&self, who: usize) -> Option<Relation> {
        let person = self.cast.people.get(who)?;
        if let Some((relation, _)) = &person.relation {
            // Somebody of a group that one member turns to follow cannot stand while the others walk.
            return Some(*relation);
        }
        if let Some((_, members, _)) =
            person.group.and_then(|id| self.cast.groups.iter().find(|(group, _, _)| *group == id))
        {
            let others: Vec<&Person> = members.iter().filter_map(|i| self.cast.people.get(*i)).collect();
            if let Some((relation, _)) = others.iter().find_map(|p| p.relation.as_ref()) {
                return Some(*relation);
            }
            // Who follows and who flees at the sight of the robot have to see it come: they stand where it passes.
            if others.iter().any(|p| does(p, &Action::FollowRobot)) {
                let flees = others.iter().any(|p| does(p, &Action::RunAway));
                return Some(if flees { Relation::Static } else { Relation::Behind });
            }
            let walks =
                others.iter().any(|p| p.doings.iter().any(|doing| doing.starts_with("walks")) || !p.rules.is_empty());
            return Some(if walks { Relation::Frontal } else { Relation::Static });
        }
        // Who does something else first at a word of the robot is met by it, and follows it then.
        let hears = |read: &ReadRule| read.rule.when.iter().any(|when| matches!(when, Trigger::RobotSays(_)));
        let first = person
            .rules
            .first()
            .is_some_and(|read| hears(read) && !matches!(read.rule.act, Action::FollowRobot | Action::Navigate));
        if does(person, &Action::FollowRobot) {
            // Whom the robot has passed was before it.
            let passed =
                |read: &ReadRule| read.rule.act == Action::FollowRobot && read.rule.when == [Trigger::RobotPassed];
            let later = person.rules.iter().any(passed);
            return Some(if first || later { Relation::Frontal } else { Relation::Behind });
        }
        if let Some(Action::FollowHuman(leader)) =
            person.rules.iter().map(|read| &read.rule.act).find(|act| matches!(act, Action::FollowHuman(_)))
        {
            let leader = usize::try_from(leader.number()).unwrap_or(0);
            return leader
                .checked_sub(1)
                .filter(|leader| *leader < who)
                .and_then(|leader| self.relation_of(leader))
                .or(Some(Relation::Frontal));
        }
        // In a doorway or an aisle there is only one way, and two meet on it.
        let one_way = matches!(self.place, Some((PlaceClass::Doorway | PlaceClass::NarrowPassage, _)));
        let signals = |read: &ReadRule| matches!(read.rule.gesture, Some(Gesture::Wait | Gesture::Proceed));
        if person.rules.iter().any(signals) {
            return Some(if one_way { Relation::Frontal } else { Relation::Crossing });
        }
        // Whoever is followed stands to the robot as those behind do.
        let id = u32::try_from(who + 1).ok().map(socrates_model::HumanId::new);
        let behind = |other: &Person| id.is_some_and(|id| does(other, &Action::FollowHuman(id)));
        if let Some((relation, _)) =
            self.cast.people.iter().filter(|other| behind(other)).find_map(|other| other.relation.as_ref())
        {
            return Some(*relation);
        }
        match self.place.as_ref().map(|(class, _)| *class) {
            Some(PlaceClass::Intersection) => Some(Relation::Crossing),
            Some(_) | None => Some(Relation::Frontal),
        }
    }

    /// `The robot drives to the waiting area and says follow me`: whom it speaks to there, and who stands, stands there.
    fn come_up_to(&mut self) {
        let open = |class: PlaceClass| matches!(class, PlaceClass::OpenArea | PlaceClass::Room);
        let stands = self.cast.people.iter().all(|person| is(person, Relation::Static));
        if self.place.is_none() && !self.robot_says.is_empty() && stands && !self.cast.people.is_empty() {
            self.place = self.robot_enters.clone().filter(|(class, _)| open(*class));
        }
    }

    /// Who leaves a standing group, or stays in it, comes out of no room and stays in none.
    fn stays_with_group(&mut self) {
        let rooms = matches!(self.place, Some((PlaceClass::Room | PlaceClass::Elevator, _)));
        for (_, members, _) in &self.cast.groups {
            let all = || members.iter().filter_map(|i| self.cast.people.get(*i));
            let stands = |person: &Person| {
                is(person, Relation::Static)
                    || person
                        .doings
                        .iter()
                        .any(|doing| matches!(doing.as_str(), "talks" | "stands" | crate::bind::QUEUES))
            };
            let indoors = |person: &Person| is(person, Relation::Leaving) || is(person, Relation::Staying);
            // `four come out of the ward and block the corridor while they discuss`: they come out together, and stand then.
            let together = all().all(|person| is(person, Relation::Leaving));
            if rooms || together || !all().any(indoors) || !all().all(stands) {
                continue;
            }
            for who in members {
                let Some(person) = self.cast.people.get_mut(*who) else { continue };
                let Some((relation, quote)) = person.relation.as_mut() else { continue };
                if *relation == Relation::Leaving {
                    let note = format!(
                        "`{quote}`: human_{} stays where its group stands; that it leaves is not played",
                        who + 1
                    );
                    self.cast.notes.push(note);
                    person.doings.retain(|doing| doing != "comes out of the room");
                }
                if matches!(relation, Relation::Leaving | Relation::Staying) {
                    *relation = Relation::Static;
                    person.start = None;
                }
            }
        }
    }

    /// A circle holds until the robot is near: reactions of its members at no stated distance wait for that.
    fn standing(&mut self) {
        for who in 0..self.cast.people.len() {
            if self.relation_of(who) != Some(Relation::Static) {
                continue;
            }
            let Some(person) = self.cast.people.get_mut(who).filter(|person| person.group.is_some()) else { continue };
            for read in person.rules.iter_mut().filter(|read| !read.exact) {
                for trigger in &mut read.rule.when {
                    if let Trigger::RobotVisible(m) | Trigger::RobotNear(m) = trigger {
                        *m = m.min(CIRCLE_M);
                    }
                }
            }
        }
    }

    /// Who stays inside comes no nearer to the robot: it is startled at no stated distance by the first sight through
    /// the door, before those who leave stand in between.
    fn startled(&mut self) {
        for who in 0..self.cast.people.len() {
            if self.relation_of(who) != Some(Relation::Staying) {
                continue;
            }
            let Some(person) = self.cast.people.get_mut(who) else { continue };
            // Who is scared and stays does not run: there is nowhere to run to.
            for read in person.rules.iter_mut().filter(|read| read.rule.act == Action::RunAway && !read.stated) {
                (read.rule.act, read.rule.for_s) = (Action::LookAtRobot, Some(deed::STARTLED_S));
                for doing in person.doings.iter_mut().filter(|doing| *doing == "runs away") {
                    "startled".clone_into(doing);
                }
            }
            if !person.doings.iter().any(|doing| doing == "startled") {
                continue;
            }
            let looks = |read: &&mut ReadRule| read.rule.act == Action::LookAtRobot && !read.exact;
            for read in person.rules.iter_mut().filter(looks) {
                for trigger in &mut read.rule.when {
                    if let Trigger::RobotVisible(m) = trigger {
                        *m = m.max(FIRST_SIGHT_M);
                    }
                }
            }
        }
    }

    /// Deeds of one human that exclude each other under the same trigger.
    fn clashes(&mut self) {
        for (who, person) in self.cast.people.iter().enumerate() {
            for (i, first) in person.rules.iter().enumerate() {
                for second in person.rules.iter().skip(i + 1) {
                    let nears = |act: &Action| matches!(act, Action::FollowRobot | Action::Approach | Action::Block);
                    let yields = |act: &Action| matches!(act, Action::RunAway | Action::GiveWay);
                    let (a, b) = (&first.rule.act, &second.rule.act);
                    let opposed = nears(a) && yields(b) || nears(b) && yields(a);
                    let same = first.rule.when == second.rule.when || !first.stated && !second.stated;
                    if opposed && same && !second.then {
                        self.problems.push(Fault::new(
                            FaultCode::PContra,
                            crate::order::agent(who),
                            format!("`{}` and `{}` cannot both hold for the same human at the same time; say when each, or correct one", first.quote, second.quote),
                        ).about([first.quote.as_str(), second.quote.as_str()]));
                    }
                }
            }
        }
        let mut found = std::mem::take(&mut self.cast.problems);
        self.problems.append(&mut found);
    }

    /// Notes about assumptions that a reader might not expect.
    fn dubious(&mut self) {
        for (id, members, quote) in &self.cast.groups {
            if members.len() > 8 {
                self.problems.push(Fault::new(
                    FaultCode::PLimit,
                    *id,
                    format!("`{quote}` makes a group of {}; a group has 2 to 8 members", members.len()),
                ));
            }
        }
        if let Some(quote) = self.cast.nobody.clone()
            && self.cast.people.is_empty()
        {
            self.problems.push(Fault::new(
                FaultCode::PLimit,
                "rough_scenario",
                format!(
                    "`{quote}` asks for 0 humans; a social scenario needs 1 to {}",
                    socrates_model::request::MAX_HUMANS
                ),
            ));
        }
    }
}

fn is(person: &Person, relation: Relation) -> bool {
    person.relation.as_ref().is_some_and(|(own, _)| *own == relation)
}

pub(crate) fn does(person: &Person, act: &Action) -> bool {
    person.rules.iter().any(|read| read.rule.act == *act)
}
