//! From the story to the reading: facts with their quotes, and every wish that has no place in the simulation.

use socrates_model::proposal::WayPart;
use socrates_model::reading::ReadHuman;
use socrates_model::{
    Action, FORMAT, Fact, FactKind, Fault, FaultCode, GroupId, HumanId, Location, PlaceClass, Reading, Relation,
    Request,
};
use socrates_reader::{Familiar, Read, Reader};

use crate::card::Ends;
use crate::lines::{Line, lines};
use crate::story::{Before, Extra, ReadRule, Story, Unplayed, agent, human_id};
use crate::task::{self, End, Task};
use crate::{
    again, aside, chance, default_cast, expect, facing, form, named_way, pattern, place, settle, sides, spot, told,
};

/// The reading with what the model has no field for.
pub(crate) struct Understood {
    pub(crate) reading: Reading,
    /// What the rough scenario was read as; empty where a form takes its place.
    pub(crate) said: Read,
    /// Per human: desired speed, where it starts, whether its rules' triggers were said.
    pub(crate) extras: Vec<Extra>,
    /// Whether the people are those of the pattern, because the text names none.
    pub(crate) by_card: bool,
    /// What was understood, line by line.
    pub(crate) lines: Vec<Line>,
    /// Words that were understood, and are not played as they were said.
    pub(crate) unplayed: Vec<Unplayed>,
    /// What was read of the task.
    pub(crate) task: Task,
    /// Sentences that speak to the program.
    pub(crate) instructions: Vec<String>,
}

/// Reads a request. Never fails: what cannot be read stands in `problems`.
pub(crate) fn understand(request: &Request, location: &Location) -> Understood {
    understood(request, location, true)
}

/// Reads a request. A text of which words are hidden is not `whole`: it is not held to be in another language, nor against a form.
pub(crate) fn understood(request: &Request, location: &Location, whole: bool) -> Understood {
    let told = aside::split(request.rough_scenario.as_deref().unwrap_or_default());
    let rough = Some(told.story.trim()).filter(|text| !text.is_empty());
    let asked = aside::split(&request.task);
    let stated = !request.form.is_empty();
    let said = rough.filter(|_| !stated).map(|_| socrates_reader::read(&told.story)).unwrap_or_default();
    let mut story = match rough {
        _ if stated => form::story(request, location),
        Some(_) => told::story(&told.story, &said),
        None => Story::default(),
    };
    let mut task = task::read(&asked.story, location);
    // The ends that a form states take the place of those of the task.
    for (slot, stated) in [(&mut task.start, &request.robot.start), (&mut task.goal, &request.robot.goal)] {
        *slot = slot.take().filter(|_| stated.is_none());
    }
    let mut reading = Reading { format: FORMAT, task: shortened(&asked.story), ..Reading::default() };
    let context = aside::split(&request.social_context);
    for (at, found) in [("rough_scenario", &told), ("task", &asked), ("social_context", &context)] {
        reading.problems.extend(found.instructions.iter().map(|sentence| {
            let message =
                format!("`{sentence}` speaks to the program and is no part of a scenario; nothing was done about it");
            Fault::new(FaultCode::PRead, at, message).about([sentence.as_str()])
        }));
    }
    if whole {
        language(request, &mut reading);
    }
    expect::settle(request, &mut story, &mut reading);
    // What a form states is not filled in.
    if !stated {
        settle::settle(&mut story);
        chance::settle(&mut story);
    }
    unplaceable(location, &mut story, &mut task, &mut reading);
    let wanted = request.expect.pattern.as_deref().or_else(|| form::robot_part(request));
    let told_of = rough.is_some() || stated;
    reading.pattern = told_of.then(|| pattern::of(&story, wanted)).flatten().or_else(|| wanted.map(str::to_owned));
    if let Some(id) = request.expect.pattern.as_ref().filter(|id| crate::card::card(id).is_none()) {
        let known: Vec<&str> = crate::card::catalog().iter().map(|card| card.id.as_str()).collect();
        reading.problems.push(Fault::new(
            FaultCode::PLimit,
            "expect.pattern",
            format!("`{id}` is no pattern; patterns: {}", known.join(", ")),
        ));
        reading.pattern = None;
    }
    people(request, &story, &mut reading);
    let mut extras: Vec<Extra> = story
        .people
        .iter()
        .map(|person| Extra {
            speed_mps: person.speed_mps,
            start: person.start,
            goal: person.goal,
            stated: person.rules.iter().map(|read| read.stated).collect(),
            open: person.rules.iter().map(|read| !read.exact).collect(),
        })
        .collect();
    // A text without people, or only a number of them: the pattern says what they do.
    if story.nobody {
        reading.pattern = None;
    }
    let foreign = reading.problems.iter().any(|fault| fault.code == FaultCode::PLang);
    let empty = reading.humans.is_empty() && !story.nobody && !foreign;
    let by_card = empty && rough.is_some();
    if by_card {
        extras = default_cast::fill(&mut reading, &story, request, location);
    }
    unfitting(request, location, &mut reading);
    facts(&story, &task, request, location, &mut reading);
    if request.expect.pattern.is_some()
        && let Some(id) = &reading.pattern
    {
        let id_of_fact = format!("f{}", reading.facts.len() + 1);
        let kind = FactKind::Pattern(id.clone());
        reading.facts.push(Fact { id: id_of_fact, quote: format!("expect.pattern = \"{id}\""), kind });
    }
    let lines = lines((&story, &task), &reading, &extras, location);
    leftovers(request, location, &mut story, &task, &mut reading);
    crate::spans::mark(request, &mut reading.problems);
    if whole && stated && rough.is_some() {
        let text = Request { form: socrates_model::form::Form::default(), ..request.clone() };
        reading.notes.extend(form::differs(&reading, &understand(&text, location).reading));
    }
    let instructions = [&told, &asked, &context].into_iter().flat_map(|told| told.instructions.clone()).collect();
    Understood { reading, said, extras, by_card, lines, unplayed: story.unplayed, task, instructions }
}

/// A pattern by name that this map cannot hold: a fault that says what is missing.
fn unfitting(request: &Request, location: &Location, reading: &mut Reading) {
    let Some(card) = request.expect.pattern.as_deref().and_then(crate::card::card) else { return };
    let Err(why) = card.fit(location) else { return };
    reading.problems.push(Fault::new(
        FaultCode::PPlace,
        "expect.pattern",
        format!("`{}` does not fit this map: {why}; it has: {}", card.id, place::listed(location)),
    ));
    reading.pattern = None;
}

pub(crate) fn shortened(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let line = line.trim_end_matches('.');
    if line.chars().count() <= 120 {
        line.to_owned()
    } else {
        format!("{} …", line.chars().take(118).collect::<String>().trim_end())
    }
}

/// P-LANG where hardly a word is known.
fn language(request: &Request, reading: &mut Reading) {
    let texts =
        [("rough_scenario", request.rough_scenario.as_deref().unwrap_or_default()), ("task", request.task.as_str())];
    for (key, text) in texts {
        let Familiar { words, known } = Reader::shipped().familiar(text);
        // English texts of a few words still have half of theirs in the tables; other languages share single words only.
        let script = known == 0 && words < 4 && aside::language(text).is_some();
        if script || words >= 4 && known * 10 < words * 3 || aside::foreign(text).is_some() {
            let named = aside::language(text).map_or_else(String::new, |name| format!(" (this looks like {name})"));
            let message =
                format!("{known} of {words} words are known{named}; the offline author reads plain English only");
            reading.problems.push(Fault::new(FaultCode::PLang, key, message));
        }
    }
}

/// Places by name that this map does not have: a fault, and the next best place.
fn unplaceable(location: &Location, story: &mut Story, task: &mut Task, reading: &mut Reading) {
    let task_ends: Vec<End> = task.starts.iter().chain(&task.goals).cloned().collect();
    let mut absent = |slot: &mut Option<(PlaceClass, String)>, at: &'static str| {
        let Some((class, quote)) = slot.clone().filter(|(class, _)| !place::has(location, *class)) else { return };
        *slot = None;
        let message = format!(
            "`{quote}` asks for {}, which this map does not have; it has: {}",
            place::an(class),
            place::listed(location)
        );
        // Of a task the name alone is not played: what the robot carries is its errand.
        let mut ends = task_ends.iter().filter(|end| at == "task" && end.nodes.is_empty() && end.class == Some(class));
        let name = ends.next().map_or(quote, |end| end.name.clone());
        reading.problems.push(Fault::new(FaultCode::PPlace, at, message).about([name]));
    };
    // The reading keeps the place as it was said; the fault says that the map has none.
    let said = story.place.as_ref().map(|(class, _)| *class);
    absent(&mut story.place, "rough_scenario");
    absent(&mut story.robot_enters, "rough_scenario");
    absent(&mut story.robot_leaves, "rough_scenario");
    absent(&mut task.start, "task");
    absent(&mut task.goal, "task");
    absent(&mut task.via, "task");
    reading.place = said;
    let rooms = !place::inside(location, None).is_empty();
    let cars = !place::inside(location, Some(PlaceClass::Elevator)).is_empty();
    for who in 0..story.people.len() {
        let next = story.relation_of(who);
        let Some(person) = story.people.get_mut(who) else { continue };
        if person.start.is_some_and(|class| !place::has(location, class)) {
            person.start = None;
        }
        if matches!(next, Some(Relation::Leaving | Relation::Staying)) {
            let wants_car = person.start == Some(PlaceClass::Elevator);
            if wants_car && cars || !wants_car && rooms {
                continue;
            }
            if rooms || cars {
                person.start = Some(if rooms { PlaceClass::Room } else { PlaceClass::Elevator });
                continue;
            }
            let quote = person.relation.as_ref().map(|(_, quote)| quote.clone()).unwrap_or_default();
            person.relation = None;
            let fault = Fault::new(
                FaultCode::PPlace,
                agent(who),
                format!(
                    "`{quote}` needs a room or an elevator with a place inside, which this map does not have{}",
                    place::open_plan(location)
                ),
            );
            if !reading.problems.contains(&fault) {
                reading.problems.push(fault);
            }
        }
    }
}

fn people(request: &Request, story: &Story, reading: &mut Reading) {
    let from_context = Reader::shipped().scene(&request.social_context).role;
    for (i, person) in story.people.iter().enumerate() {
        let number = u32::try_from(i + 1).unwrap_or(u32::MAX);
        let generic = person.role.is_empty();
        let role = if generic {
            person.called.clone().or_else(|| from_context.clone()).unwrap_or_else(|| "person".to_owned())
        } else {
            person.role.clone()
        };
        reading.humans.push(ReadHuman {
            id: HumanId::new(number),
            role,
            summary: person.doings.join(", "),
            relation: story.relation_of(i),
            rules: person.rules.iter().map(|read| read.rule.clone()).collect(),
            group: person.group,
        });
    }
}

fn facts(story: &Story, task: &Task, request: &Request, location: &Location, reading: &mut Reading) {
    let mut facts: Vec<(String, FactKind)> = Vec::new();
    let read = Some(u32::try_from(reading.humans.len()).unwrap_or(u32::MAX)).filter(|count| *count > 0);
    // An unguided request may still say how many there are.
    let expected = request.expect.headcount().filter(|_| !story.nobody);
    if let Some(count) = read.or(expected) {
        let quote = match (&story.count_quote, request.expect.humans) {
            (Some(quote), _) => quote.clone(),
            (None, Some(humans)) => format!("expect.humans = {humans}"),
            (None, None) if read.is_none() => "expect.groups".to_owned(),
            (None, None) => String::new(),
        };
        facts.push((quote, FactKind::Humans(count)));
    }
    let id = human_id;
    if story.people.is_empty() && (read.is_some() || expected.is_some()) {
        let groups = (1..).map(GroupId).zip(&request.expect.groups);
        facts.extend(groups.map(|(group, members)| {
            let members = members.iter().copied().map(HumanId::new).collect();
            ("expect.groups".to_owned(), FactKind::Group { group, members })
        }));
    }
    for group in &story.groups {
        let members = group.members.iter().copied().map(id).collect();
        facts.push((group.quote.clone(), FactKind::Group { group: group.id, members }));
    }
    for (i, person) in story.people.iter().enumerate() {
        if let Some((relation, quote)) = person.relation.clone() {
            facts.push((quote, FactKind::Relates { human: id(i), relation }));
            let crosses = person.crosses.clone().filter(|_| relation == Relation::Leaving);
            facts
                .extend(crosses.map(|quote| (quote, FactKind::Relates { human: id(i), relation: Relation::Crossing })));
        }
        let relation = story.relation_of(i);
        let said = [
            sides::fact(id(i), relation, person, &mut reading.problems),
            facing::fact(id(i), relation, person, &mut reading.problems),
        ];
        for (quote, kind) in said.into_iter().flatten() {
            let words = if let FactKind::Side { side, .. } = &kind {
                sides::words(relation, *side)
            } else {
                facing::words(&kind)
            };
            if let Some(human) = reading.humans.get_mut(i) {
                human.summary.push_str(if human.summary.is_empty() { "" } else { ", " });
                human.summary.push_str(&words);
            }
            facts.push((quote, kind));
        }
        let twice = person.twice.as_ref();
        let twice = twice.and_then(|said| again::fact(id(i), story.relation_of(i), said, location, reading));
        if let Some(human) = reading.humans.get_mut(i).filter(|_| twice.is_some()) {
            let joint = if human.summary.is_empty() { "" } else { ", " };
            human.summary.push_str(&format!("{joint}meets the robot twice"));
        }
        facts.extend(twice);
        facts.extend(person.rules.iter().flat_map(|read| facts_of_rule(id(i), read)));
    }
    for Before { first, then, at_door, quote } in &story.order {
        facts.push((quote.clone(), FactKind::Before { first: *first, then: *then, at_door: *at_door }));
    }
    story.order.iter().for_each(|before| before.tell(&mut reading.humans));
    if let Some((class, quote)) = &story.place {
        facts.push((quote.clone(), FactKind::Place(*class)));
        reading.place = Some(*class);
    }
    if !reading.task.is_empty() {
        facts.push((reading.task.clone(), FactKind::RobotTask(reading.task.clone())));
    }
    for (gesture, quote) in &story.robot_says {
        facts.push((quote.clone(), FactKind::RobotSays(*gesture)));
    }
    facts.extend(form::facts(request, location));
    for (class, quote) in story.robot_leaves.iter().chain(&task.start).take(1) {
        facts.push((quote.clone(), FactKind::RobotStart(*class)));
    }
    for (class, quote) in story.robot_enters.iter().chain(&task.goal).take(1) {
        facts.push((quote.clone(), FactKind::RobotGoal(*class)));
    }
    facts.dedup_by(|a, b| a.1 == b.1);
    reading.facts = facts
        .into_iter()
        .enumerate()
        .map(|(i, (quote, kind))| Fact { id: format!("f{}", i + 1), quote, kind })
        .collect();
}

/// What a rule asks for: a sign and to whom it is made, or a reaction.
fn facts_of_rule(human: HumanId, read: &ReadRule) -> Vec<(String, FactKind)> {
    // That somebody walks on after all it did is no demand of its own.
    if !read.stated && read.rule.act == Action::Navigate && read.rule.gesture.is_none() {
        return Vec::new();
    }
    let kinds = match read.rule.gesture {
        Some(gesture) => {
            let to = read.rule.to.map(|to| FactKind::GesturesTo { human, gesture, to });
            [FactKind::Gestures { human, gesture }].into_iter().chain(to).collect()
        }
        None => vec![FactKind::Reacts { human, rule: read.rule.clone() }],
    };
    kinds.into_iter().map(|kind| (read.quote.clone(), kind)).collect()
}

/// What of the task is no start and no goal: the way over a place, and the way back.
fn errand(task: &Task, location: &Location, reading: &mut Reading) {
    if let Some((class, quote)) = &task.via {
        reading
            .notes
            .push(format!("`{quote}`: the robot's way leads past {} where the map has such a way", place::an(*class)));
    }
    // What is named is kept out of.
    let open = task.denied.iter().filter(|quote| named_way::avoided_by(quote, location).is_empty());
    reading.problems.extend(open.map(|quote| {
        let message =
            format!("`{quote}`: where the robot may not go is up to its planner and is not judged; say where it goes");
        Fault::new(FaultCode::PRead, "task", message).about([quote.as_str()])
    }));
    if let Some(quote) = task.back.as_ref().filter(|_| !task.comes_home) {
        let message = format!(
            "`{quote}`: the robot comes back to where it began, or stays at its goal; another way on is not played"
        );
        reading.problems.push(Fault::new(FaultCode::PRead, "task", message).about([quote.as_str()]));
    }
}

/// Says where the robot's way begins or ends otherwise than its task says by name.
fn ends((story, task): (&Story, &Task), request: &Request, location: &Location, reading: &mut Reading) {
    let ends_of = reading.pattern.as_deref().and_then(crate::card::card);
    let car = story.people.iter().any(|person| {
        let inside = person
            .relation
            .as_ref()
            .is_some_and(|(relation, _)| matches!(relation, Relation::Leaving | Relation::Staying));
        inside && person.start == Some(PlaceClass::Elevator)
    });
    // Where the scenario has the robot begin and end, whatever the task says.
    let enters = story.robot_enters.as_ref().map(|(class, _)| *class).or_else(|| car.then_some(PlaceClass::Elevator));
    let leaves = story.robot_leaves.as_ref().map(|(class, _)| *class);
    let starts = ends_of.and_then(|card| card.start);
    let stays = ends_of.is_some_and(|card| card.ends == Ends::With);
    let leaves_people = ends_of.is_some_and(|card| card.ends == Ends::From);
    let mut played: Vec<(WayPart, &End)> = Vec::new();
    let stated = [&request.robot.start, &request.robot.goal];
    let ends = [("start", &task.starts, leaves.or(starts), leaves_people), ("goal", &task.goals, enters, stays)];
    for ((what, named, other, people), stated) in ends.into_iter().zip(stated) {
        if let Some(place) = stated {
            // What a form states wins.
            let others = named.iter().filter(|end| !end.name.eq_ignore_ascii_case(&place.to_string()));
            reading.notes.extend(
                others.map(|end| format!("the robot's {what} is `{place}` as the form states, not `{}`", end.name)),
            );
            continue;
        }
        let known = named.iter().find(|end| !end.nodes.is_empty());
        for end in named {
            let missing = end.nodes.is_empty();
            // That the map has no such kind of place is said as a fault.
            if missing && end.class.is_some_and(|class| !place::has(location, class)) {
                continue;
            }
            let instead = if let Some(class) = other.filter(|class| end.class != Some(*class)) {
                let ends = if what == "start" { "begin" } else { "end" };
                format!("the scenario has its way {ends} at {}", place::an(class))
            } else if people {
                format!("in this scenario the robot's {what} is with the people")
            } else if missing {
                let place = known.map(|known| format!("`{}`", known.name));
                let place = place.or_else(|| end.class.map(place::an));
                let place = place
                    .map_or_else(|| "a place that suits the scenario".to_owned(), |place| format!("{place} instead"));
                format!("this map has no place of that name; the robot's {what} is {place}")
            } else if !end.exact {
                "this map has no place of that number; one of the same name is taken".to_owned()
            } else {
                // The first that the map knows is where the way begins or ends.
                if known == Some(end) {
                    played.push((if what == "start" { WayPart::Start } else { WayPart::Goal }, end));
                }
                continue;
            };
            let message = format!("the robot's {what} `{}`: {instead}", end.name);
            reading.problems.push(Fault::new(FaultCode::PRead, "task", message).about([end.name.as_str()]));
        }
    }
    // The story's own ends win over the task's.
    played.retain(|(part, _)| match part {
        WayPart::Start => story.robot_leaves.is_none(),
        WayPart::Goal => story.robot_enters.is_none() && !car,
        WayPart::Via | WayPart::Avoid | WayPart::Back => true,
    });
    named_way::ends(&played, reading);
}

/// Said of every request with a social context.
pub const CONTEXT_NOTE: &str = "of the social context, only roles and pace are used";

/// Says where the map has no place of a name, so that another of its kind is taken.
fn other_places(location: &Location, reading: &mut Reading) {
    let mut problems = Vec::new();
    for fact in &reading.facts {
        let FactKind::Place(class) = fact.kind else { continue };
        let unknown = spot::named_in(location, &fact.quote, class).filter(|meant| meant.nodes.is_empty());
        problems.extend(unknown.filter(|_| place::has(location, class)).map(|meant| {
            let instead = place::an(class);
            let message = format!("`{}`: this map has no place of that name; {instead} is taken instead", meant.name);
            Fault::new(FaultCode::PRead, "rough_scenario", message).about([meant.name])
        }));
    }
    reading.problems.append(&mut problems);
}

fn leftovers(request: &Request, location: &Location, story: &mut Story, task: &Task, reading: &mut Reading) {
    named_way::rest(task, request, location, reading);
    errand(task, location, reading);
    ends((story, task), request, location, reading);
    other_places(location, reading);
    reading.problems.append(&mut story.problems);
    reading.notes.append(&mut story.notes);
    for (i, human) in reading.humans.iter().enumerate() {
        if human.summary.is_empty() && request.rough_scenario.is_some() {
            reading.notes.push(format!("nothing is said of what human_{} does; they walk their path", i + 1));
        }
    }
    if request.rough_scenario.is_none() && request.form.is_empty() {
        reading.notes.push("no rough scenario: a pattern that fits the map is drawn by the seed".to_owned());
    }
    if !request.social_context.trim().is_empty() {
        reading.notes.push(CONTEXT_NOTE.to_owned());
    }
    reading.problems.dedup();
}
