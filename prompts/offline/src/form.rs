//! From the form to the story: what a request states exactly takes the place of what would be read from its text.
//!
//! ```text
//! [[human]] [[group]] [[order]] ─► Story (people, place, order), as if it had been read ─► reading, proposal, paths
//! ```
//!
//! Places by name are bound here, to nodes: no word of a form is read as language.

use std::collections::BTreeMap;

use socrates_model::form::{Deed, FacingWord, Form, FormHuman, Formation, PlaceWord, RobotDeed, Step};
use socrates_model::proposal::Facing;
use socrates_model::{
    Action, FactKind, Fault, FaultCode, HumanId, Location, NodeId, PlaceClass, Reading, Relation, Request, Rule, Side,
    Trigger,
};

use crate::manner::{AHEAD_MPS, OVERTAKES_MPS, overtakes};
use crate::story::{Before, Group, Person, ReadRule, Story, is_closed, stands};
use crate::{named, place, spot};

/// What those do who stand one behind the other.
const QUEUES: &str = "queues";

/// Where a place of a form is on a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Bound {
    pub(crate) class: PlaceClass,
    /// The nodes of a place by name; none where any place of the class is meant.
    pub(crate) nodes: Vec<NodeId>,
}

impl Bound {
    /// Its nodes: those of the place by name, or all of its class.
    pub(crate) fn all_nodes(self, location: &Location) -> Vec<NodeId> {
        if self.nodes.is_empty() { socrates_maps::place::nodes_of(location, self.class) } else { self.nodes }
    }
}

/// Binds a place of a form; nothing where the map has none of that name or class.
pub(crate) fn bound(place: &PlaceWord, location: &Location) -> Option<Bound> {
    match place {
        PlaceWord::Class(class) => place::has(location, *class).then(|| Bound { class: *class, nodes: Vec::new() }),
        PlaceWord::Name(name) => {
            // `ward 9` of a map with two wards is no place of it.
            let found = named::find(location, name).filter(|found| found.exact);
            let found = found.or_else(|| named::called(location, name))?;
            Some(Bound { class: found.class, nodes: found.nodes })
        }
    }
}

/// What somebody faces: a place is that of its first node. Nothing where nobody, and no place of this map, is called so.
fn faced(said: &FacingWord, form: &Form, location: &Location) -> Option<Facing> {
    match said {
        FacingWord::Robot => Some(Facing::Robot),
        FacingWord::Away => Some(Facing::Away),
        FacingWord::To(Side::Left) => Some(Facing::Left),
        FacingWord::To(Side::Right) => Some(Facing::Right),
        FacingWord::Name(name) => form.one(name).map(Facing::Human).or_else(|| {
            let place = PlaceWord::from(name.clone());
            bound(&place, location)?.nodes.into_iter().next().map(Facing::Node)
        }),
    }
}

/// What is said of a place that the map does not have.
fn no_place(key: &'static str, place: &PlaceWord, location: &Location) -> Fault {
    let message = format!("`{place}` is no place of this map, which has: {}", place::listed(location));
    Fault::new(FaultCode::PPlace, key, message).about([place.to_string()])
}

/// The story of a form.
pub(crate) fn story(request: &Request, location: &Location) -> Story {
    let mut story = Story::default();
    let form = &request.form;
    let people = form.people();
    let called = |human: &FormHuman, id: HumanId| human.id.clone().unwrap_or_else(|| id.to_string());
    for person in &people {
        let human = person.human;
        let name = called(human, person.id);
        let line = |key: &str, value: &str| format!("human {name}: {key} = {value}");
        let start = in_place(human, location);
        let mut read = Person {
            role: human.role.clone().unwrap_or_default().to_lowercase(),
            relation: Some((human.relation, line("relation", &format!("\"{}\"", human.relation.name())))),
            side: human.side.map(|side| (side, line("side", &format!("\"{}\"", side.name())))),
            facing: human
                .facing
                .as_ref()
                .and_then(|said| Some((faced(said, form, location)?, line("facing", &format!("\"{said}\""))))),
            group: person.group,
            speed_mps: human.pace.and_then(socrates_model::form::Pace::mps),
            start,
            goal: human.goal.as_ref().and_then(|goal| bound(goal, location)).map(|goal| goal.class),
            doings: vec![stands(human.relation, start)],
            ..Person::default()
        };
        let steps = human.reacts.iter().map(|step| (step, "reacts", true));
        let does = human.does.iter().enumerate().map(|(place, step)| (step, "does", place == 0));
        for (rule, (step, key, first)) in person.rules.iter().zip(steps.chain(does)) {
            let rule = &bound_to(rule, step, location);
            if let Action::GoTo(to) = &rule.act
                && to.nodes.is_empty()
                && let Some(Deed::GoTo(place)) = &step.act
            {
                story.problems.push(no_place("human.does.act", place, location));
            }
            let timed = rule.when != [Trigger::Always];
            let deed = step.act.as_ref().unwrap_or(&Deed::StandStill);
            let said = step.say.map_or_else(String::new, |say| format!(", say {say}"));
            let phrase = if step.act.is_none() { String::new() } else { rule.act.phrase() };
            read.doings.push(match rule.gesture {
                Some(gesture) if phrase.is_empty() => format!("gestures {gesture}"),
                Some(gesture) => format!("{phrase} and gestures {gesture}"),
                None => phrase,
            });
            read.rules.push(ReadRule {
                rule: rule.clone(),
                quote: line(key, &format!("{}{said}", word(deed))),
                stated: timed && first,
                exact: true,
                lasts: rule.for_s.is_some(),
                then: !first,
            });
        }
        story.people.push(read);
    }
    paces(request, &mut story);
    groups(request, &mut story);
    orders(request, &mut story);
    places(request, location, &mut story);
    robot(request, location, &mut story);
    let count = form.headcount();
    story.count_quote = Some(format!("[[human]]: {count}"));
    story
}

/// The rule with the nodes of the place that it names.
fn bound_to(rule: &Rule, step: &Step, location: &Location) -> Rule {
    let mut rule = rule.clone();
    if let (Action::GoTo(to), Some(Deed::GoTo(place))) = (&mut rule.act, &step.act)
        && let Some(found) = bound(place, location)
    {
        let all = location.graph.nodes().iter().map(|node| &node.id);
        let class = || all.filter(|id| location.graph.node_is(id, found.class)).cloned().collect();
        to.nodes = if found.nodes.is_empty() { class() } else { found.nodes };
    }
    rule
}

/// The act as the form writes it.
fn word(deed: &Deed) -> String {
    bare(deed)
}

/// A key and its value as the form writes them.
fn bare(stated: &impl serde::Serialize) -> String {
    let text = serde_json::to_string(stated).unwrap_or_default();
    text.replace(['{', '}'], "").replace(':', " = ")
}

/// The class of the room or car that somebody is in at first: as `start` says, or `place` of whoever leaves it or stays in it.
fn in_place(human: &FormHuman, location: &Location) -> Option<PlaceClass> {
    let indoors = matches!(human.relation, Relation::Leaving | Relation::Staying);
    let start = human.start.as_ref().and_then(|start| bound(start, location)).map(|start| start.class);
    let place = || {
        human
            .place
            .as_ref()
            .and_then(|place| bound(place, location))
            .map(|place| place.class)
            .filter(|class| is_closed(*class))
    };
    start.or_else(|| if indoors { place() } else { None })
}

/// Paces at which somebody cannot stand to the robot's way as stated.
fn paces(request: &Request, story: &mut Story) {
    for person in request.form.people() {
        let Some(mps) = person.human.pace.and_then(socrates_model::form::Pace::mps) else { continue };
        let relation = person.human.relation;
        let why = if overtakes(relation, &person.rules) && mps < OVERTAKES_MPS {
            format!("somebody behind who does not follow it overtakes the robot, at {OVERTAKES_MPS} m/s or faster")
        } else if relation == Relation::Ahead && mps > AHEAD_MPS {
            format!("the robot catches up with somebody ahead at {AHEAD_MPS} m/s or slower")
        } else {
            continue;
        };
        let message = format!("{} has a pace of {mps} m/s; {why}", person.id);
        story.problems.push(Fault::new(FaultCode::PLimit, "human.pace", message).about([format!("pace = {mps}")]));
    }
}

fn groups(request: &Request, story: &mut Story) {
    for (number, name) in (1..).zip(request.form.group_names()) {
        let id = socrates_model::GroupId(number);
        let of_group = |person: &Person| person.group == Some(id);
        let members: Vec<usize> =
            (0..story.people.len()).filter(|who| story.people.get(*who).is_some_and(of_group)).collect();
        let queue =
            request.form.groups.iter().any(|group| group.id == name && group.formation == Some(Formation::Queue));
        for person in story.people.iter_mut().filter(|person| queue && of_group(person)) {
            person.doings = vec![QUEUES.to_owned()];
        }
        story.groups.push(Group { id, members, queue, quote: format!("group = \"{name}\"") });
    }
}

fn orders(request: &Request, story: &mut Story) {
    for stated in &request.form.orders {
        let quote = format!("order: first = \"{}\", then = \"{}\"", stated.first, stated.then);
        let at_door = stated.at.is_some();
        for first in request.form.agents(&stated.first) {
            for then in request.form.agents(&stated.then) {
                story.order.push(Before { first, then, at_door, quote: quote.clone() });
            }
        }
    }
}

/// Where the people meet the robot: the first place that is stated; another one is a fact of its own. A place that this map lacks is a fault.
fn places(request: &Request, location: &Location, story: &mut Story) {
    let mut stated: Option<&PlaceWord> = None;
    for person in request.form.people() {
        let human = person.human;
        if let Some(FacingWord::Name(name)) = &human.facing
            && faced(&FacingWord::Name(name.clone()), &request.form, location).is_none()
        {
            let names = location.graph.nodes().len();
            let message = format!(
                "`{name}` is nobody of the form and no place by name among the {names} nodes of this map; face robot, away, left, right, \
                 the id of somebody, or a room or area in the map's own words"
            );
            let fault = Fault::new(FaultCode::PPlace, "human.facing", message).about([name.clone()]);
            if !story.problems.contains(&fault) {
                story.problems.push(fault);
            }
        }
        let said = [("human.place", &human.place), ("human.start", &human.start), ("human.goal", &human.goal)];
        for (key, place) in said {
            let Some(place) = place else { continue };
            if bound(place, location).is_none() {
                let fault = no_place(key, place, location);
                if !story.problems.contains(&fault) {
                    story.problems.push(fault);
                }
            } else if key == "human.place" {
                stated.get_or_insert(place);
            }
        }
    }
    let first = stated.and_then(|place| bound(place, location).map(|bound| (bound.class, place.to_string())));
    story.place = first.map(|(class, name)| (class, format!("place = \"{name}\"")));
}

fn robot(request: &Request, location: &Location, story: &mut Story) {
    let mut end = |key: &'static str, place: &Option<PlaceWord>| {
        let place = place.as_ref()?;
        let Some(bound) = bound(place, location) else {
            story.problems.push(no_place(key, place, location));
            return None;
        };
        Some((bound.class, format!("{key} = \"{place}\"")))
    };
    let (start, goal) = (end("robot.start", &request.robot.start), end("robot.goal", &request.robot.goal));
    end("robot.via", &request.robot.via);
    for place in &request.robot.avoid {
        end("robot.avoid", &Some(place.clone()));
    }
    let inside = waits_inside(request, location);
    let goal = goal.or_else(|| behind_the_door(request, location, inside.clone()));
    // A person who waits inside is met there, unless a place is stated.
    if story.place.is_none() {
        story.place = goal.clone().filter(|goal| inside.as_ref() == Some(goal));
    }
    (story.robot_leaves, story.robot_enters) = (start, goal);
    let script = request.form.script(&request.robot.does);
    for line in script {
        if let socrates_model::rule::RobotDo::Say(gesture) = line.act {
            story.robot_says.push((gesture, format!("robot.does: say = \"{gesture}\"")));
        }
    }
}

/// What a form states besides who is there and what they do: paces and goals of people, and the lines of the robot's script.
pub(crate) fn facts(request: &Request, location: &Location) -> Vec<(String, FactKind)> {
    let mut found = Vec::new();
    for person in request.form.people() {
        let (human, id) = (person.human, person.id);
        let name = human.id.clone().unwrap_or_else(|| id.to_string());
        let pace = human.pace.filter(|_| walks(human.relation, &person.rules));
        if let Some(mps) = pace.and_then(socrates_model::form::Pace::mps) {
            found.push((format!("human {name}: pace = {mps} m/s"), FactKind::Pace { human: id, mps }));
        }
        if let Some((place, kind)) = meets_at(&request.form, human, id, location) {
            found.push((format!("human {name}: place = \"{place}\""), kind));
        }
        let goal = human.goal.as_ref().and_then(|goal| Some((goal, bound(goal, location)?)));
        if let Some((goal, place)) = goal {
            let kind = FactKind::Goal { human: id, name: goal.to_string(), nodes: place.all_nodes(location) };
            found.push((format!("human {name}: goal = \"{goal}\""), kind));
        }
    }
    let lines = request.robot.does.iter().zip(request.form.script(&request.robot.does));
    found.extend(lines.map(|(step, rule)| (format!("robot.does: {}", bare(&step.act)), FactKind::RobotDoes(rule))));
    found
}

/// The place of a person's meeting, where it is another than the first that is stated. A person who comes out of a room is met before its door.
fn meets_at<'h>(
    form: &Form,
    human: &'h FormHuman,
    id: HumanId,
    location: &Location,
) -> Option<(&'h PlaceWord, FactKind)> {
    let first = form.humans.iter().find_map(|human| human.place.as_ref())?;
    let place = human.place.as_ref().filter(|place| *place != first)?;
    let own = bound(place, location)?;
    let class = own.class;
    let mut nodes = own.all_nodes(location);
    if matches!(human.relation, Relation::Leaving | Relation::Staying) && is_closed(class) {
        nodes.extend(spot::before_doors(location, &nodes));
    }
    Some((place, FactKind::MeetsAt { human: id, name: place.to_string(), class, nodes }))
}

/// Whether somebody walks their own way at some time, and not only after somebody else.
fn walks(relation: Relation, rules: &[Rule]) -> bool {
    let follows = |rule: &Rule| {
        rule.when == [Trigger::Always] && matches!(rule.act, Action::FollowRobot | Action::FollowHuman(_))
    };
    !relation.stands() && !rules.iter().any(follows)
}

/// Where the robot goes, unless stated, of which somebody gets through a door before or after it, or waits inside.
fn behind_the_door(
    request: &Request,
    location: &Location,
    inside: Option<(PlaceClass, String)>,
) -> Option<(PlaceClass, String)> {
    let task = crate::task::read(&request.task, location);
    if task.goal.is_some() || !task.goals.is_empty() {
        return None;
    }
    let robot = |name: &str| name == "robot";
    let order = request.form.orders.iter().find(|order| robot(&order.first) || robot(&order.then));
    // A doorway is that of a room.
    let behind = |at: PlaceClass| if at == PlaceClass::Elevator { at } else { PlaceClass::Room };
    let door = order.and_then(|order| order.at).map(|at| (behind(at), "order: at".to_owned()));
    door.or(inside).filter(|(class, _)| place::has(location, *class))
}

/// The room or car in which somebody waits; nothing where another place is stated for the meeting.
fn waits_inside(request: &Request, location: &Location) -> Option<(PlaceClass, String)> {
    let stays = request.form.humans.iter().find(|human| human.relation == Relation::Staying)?;
    let class = |place: &PlaceWord| bound(place, location).map(|bound| bound.class);
    let inside = stays.start.as_ref().or(stays.place.as_ref()).map_or(Some(PlaceClass::Room), class)?;
    let met = request.form.humans.iter().filter_map(|human| human.place.as_ref()).find_map(class);
    let holds = is_closed(inside) && met.is_none_or(|met| met == inside);
    holds.then(|| (inside, "relation = \"staying\"".to_owned()))
}

/// The nodes of the place where people meet the robot, where it is stated by name; the class has to be the scenario's.
pub(crate) fn met_at(request: &Request, location: &Location, class: PlaceClass) -> Option<Vec<NodeId>> {
    let places = request.form.humans.iter().filter_map(|human| human.place.as_ref());
    let bound = places.filter_map(|place| bound(place, location)).find(|bound| bound.class == class)?;
    Some(bound.nodes)
}

/// The nodes where the robot's way begins or ends, where the form states it.
pub(crate) fn robot_end(place: Option<&PlaceWord>, location: &Location) -> Option<Vec<NodeId>> {
    let bound = bound(place?, location)?;
    // Any room or car of a class is as good as another, as the story has it.
    let nodes = if is_closed(bound.class) { bound.nodes } else { bound.all_nodes(location) };
    Some(nodes).filter(|nodes| !nodes.is_empty())
}

/// The rooms that people come out of, or stay in, by name.
pub(crate) fn rooms(request: &Request, location: &Location) -> BTreeMap<HumanId, Vec<NodeId>> {
    let room = |human: &FormHuman| {
        let place = human.start.as_ref().or(human.place.as_ref())?;
        bound(place, location).map(|bound| bound.nodes).filter(|nodes| !nodes.is_empty())
    };
    let indoors = |human: &FormHuman| matches!(human.relation, Relation::Leaving | Relation::Staying);
    let people = request.form.people();
    people
        .iter()
        .filter(|person| indoors(person.human))
        .filter_map(|person| Some((person.id, room(person.human)?)))
        .collect()
}

/// The places by name where people's ways end.
pub(crate) fn ends(request: &Request, location: &Location) -> BTreeMap<HumanId, Vec<NodeId>> {
    let people = request.form.people();
    let end = |human: &FormHuman| {
        let nodes = bound(human.goal.as_ref()?, location)?.all_nodes(location);
        (!human.relation.stands()).then_some(nodes)
    };
    people.iter().filter_map(|person| Some((person.id, end(person.human)?))).collect()
}

/// What the text says otherwise than the form, in one note: the form is played.
pub(crate) fn differs(stated: &Reading, text: &Reading) -> Option<String> {
    let relations = |reading: &Reading| {
        let mut all: Vec<Relation> = reading.humans.iter().filter_map(|human| human.relation).collect();
        all.sort_unstable();
        all
    };
    let acts = |reading: &Reading| {
        let mut all: Vec<String> =
            reading.humans.iter().flat_map(|human| human.rules.iter().map(|rule| Action::phrase(&rule.act))).collect();
        all.sort_unstable();
        all
    };
    let mut found: Vec<String> = Vec::new();
    if stated.humans.len() != text.humans.len() {
        found.push(format!("{} humans in the text, {} in the form", text.humans.len(), stated.humans.len()));
    } else if relations(stated) != relations(text) {
        found.push("how people stand to the robot's way".to_owned());
    }
    if let Some((said, class)) = text.place.zip(stated.place).filter(|(said, class)| said != class) {
        found.push(format!("{} in the text, {} in the form", place::an(said), place::an(class)));
    }
    if acts(stated) != acts(text) {
        found.push("what people do".to_owned());
    }
    (!text.humans.is_empty() && !found.is_empty())
        .then(|| format!("the text differs from the form ({}); the form is played", found.join("; ")))
}

/// The card of the robot's own part, where the form states one.
pub(crate) fn robot_part(request: &Request) -> Option<&'static str> {
    request.robot.does.iter().find_map(|step| match step.act {
        RobotDeed::Follow(_) => Some("robot_following"),
        RobotDeed::LeadM(_) => Some("leading"),
        RobotDeed::Overtake(_) => Some("robot_overtaking"),
        RobotDeed::Beside(_)
        | RobotDeed::Say(_)
        | RobotDeed::HoldS(_)
        | RobotDeed::HoldUntil(_)
        | RobotDeed::WaitForLeavers(_) => None,
    })
}

#[cfg(test)]
mod tests {
    use socrates_model::{FaultCode, Request};

    use crate::tests::map;

    fn problems(more: &str) -> Vec<(FaultCode, String)> {
        let text = format!("location = \"hospital\"\ntask = \"Drive to the exit\"\n{more}");
        let request = Request::of_toml(&text, None).unwrap();
        let reading = crate::read(&request, &map("hospital"));
        reading.problems.iter().map(|fault| (fault.code, fault.message.to_string())).collect()
    }

    #[test]
    fn what_a_form_states_is_played_as_it_stands_or_refused() {
        assert_eq!(problems("[[human]]\nrelation = \"static\"\nplace = \"ward 2\"\n"), []);
        for (more, code, words) in [
            ("relation = \"static\"\nplace = \"ward 9\"", FaultCode::PPlace, "`ward 9` is no place of this map"),
            ("relation = \"static\"\nplace = \"moon\"", FaultCode::PPlace, "`moon` is no place of this map"),
            ("relation = \"behind\"\npace = \"slow\"", FaultCode::PLimit, "overtakes the robot, at 1.2 m/s or faster"),
            ("relation = \"ahead\"\npace = 1.0", FaultCode::PLimit, "catches up with somebody ahead at 0.75 m/s"),
        ] {
            let found = problems(&format!("[[human]]\n{more}\n"));
            assert!(found.iter().any(|(own, text)| *own == code && text.contains(words)), "{words}: {found:?}");
        }
    }
}
