//! The form's part of the door: `[[human]]`, `[[group]]`, `[[order]]` and the robot's steps.

use std::collections::BTreeMap;

use super::read::{Door, Section};
use super::steps::never_ends;
use super::tree::{Kind, Node};
use super::words::Words;
use super::{Expect, GROUP_SIZES, MAX_HUMANS};
use crate::form::{
    Deed, FacingWord, Form, FormGroup, FormHuman, FormOrder, Formation, Pace, PlaceWord, RobotDeed, RobotMoment,
    RobotStep, Step, When,
};
use crate::place::PlaceClass;
use crate::proposal::{Relation, Side};
use crate::rule::ROBOT_MOMENTS;

const HUMAN_KEYS: [&str; 13] =
    ["id", "count", "role", "relation", "side", "facing", "place", "start", "goal", "pace", "group", "does", "reacts"];
const RELATIONS: &str = "frontal, behind, ahead, crossing, static, leaving, staying, abreast, aside";
const PLACE: &str = "a place class or a place of this map: \"corridor\", \"packing area\"";
fn moments() -> Words {
    let all = ROBOT_MOMENTS.iter().map(|row| (row.word, row.toml())).collect();
    Words { what: "moment", all, more: "" }
}

fn deeds() -> Words {
    Words::of_table("deed of the robot", RobotDeed::WORDS)
}
/// People of one `[[human]]`.
const MOST_ALIKE: u32 = 30;
/// Characters of a name, a role or a place.
const MOST_CHARS: usize = 60;

/// A name in the form, where it stands, and what it is for.
pub(super) struct Naming<'n> {
    pub(super) who: String,
    pub(super) key: &'static str,
    pub(super) node: Option<&'n Node>,
    /// Whether `robot` is somebody here, and whether several may be meant.
    pub(super) robot: bool,
    pub(super) several: bool,
}

/// The names of a form that have to be somebody's.
pub(super) struct Names<'n>(Vec<Naming<'n>>);

impl<'n> Names<'n> {
    pub(super) fn push(&mut self, naming: Naming<'n>) {
        self.0.push(naming);
    }
}

impl Door<'_> {
    /// The form of a request with the names that it uses.
    pub(super) fn form<'n>(&mut self, top: &Section<'n>) -> (Form, Names<'n>) {
        let mut names = Names(Vec::new());
        let humans = self.tables(top, "human").into_iter().filter_map(|node| self.human(node, &mut names)).collect();
        let groups = self.tables(top, "group").into_iter().filter_map(|node| self.group(node)).collect();
        let orders = self.tables(top, "order").into_iter().filter_map(|node| self.order(node, &mut names)).collect();
        let form = Form { humans, groups, orders };
        self.alike(&form, top);
        self.faced(&form, top);
        self.waits(&form, top);
        (form, names)
    }

    /// The tables of a list: `[[human]]`.
    fn tables<'n>(&mut self, top: &Section<'n>, key: &'static str) -> Vec<&'n Node> {
        let Some(node) = top.get(key) else { return Vec::new() };
        if let Kind::List(nodes) = &node.kind {
            return nodes.iter().collect();
        }
        self.bad(key, node.at, format!("is {}", node.kind.name()), format!("a table for each: [[{key}]]"));
        Vec::new()
    }

    fn human<'n>(&mut self, node: &'n Node, names: &mut Names<'n>) -> Option<FormHuman> {
        let section = self.section(node, "human.", &HUMAN_KEYS);
        let at = |name: &str| section.get(name).and_then(|node| node.at);
        let id = self.word(&section, "id").filter(|id| {
            let plain = id.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
            let free = !matches!(id.as_str(), "robot" | "all") && !id.starts_with("human_");
            if !(plain && free) {
                let hint = "letters, digits, `_` and `-`; not `robot`, `all` or `human_…`";
                self.bad("human.id", at("id"), format!("`{id}` is no name of a person"), hint);
            }
            plain && free
        });
        let count = self.maybe::<u32>(&section, "count", "1 to 30").unwrap_or(1);
        if count == 0 || count > MOST_ALIKE {
            self.bad("human.count", at("count"), format!("{count} people"), format!("1 to {MOST_ALIKE}"));
        }
        if section.get("relation").is_none() {
            self.bad("human.relation", node.at, "is missing", RELATIONS);
        }
        let relation = self.maybe::<Relation>(&section, "relation", RELATIONS);
        let side = self.maybe::<Side>(&section, "side", "left, right");
        if let (Some(side), Some(Relation::Staying)) = (side, relation) {
            let found = format!("`{}` of somebody who stays inside", side.name());
            self.bad(
                "human.side",
                at("side"),
                found,
                "leave it out: whoever stays inside is on no side of the robot's way",
            );
        }
        let facing = section.get("facing").and_then(|_| self.word(&section, "facing")).map(FacingWord::from);
        if let (Some(facing), Some(relation)) = (&facing, relation) {
            let stands = relation.stands();
            if !stands || section.get("group").is_some() {
                let found = if stands {
                    format!("`{facing}` of somebody in a group")
                } else {
                    format!("`{facing}` of somebody who is `{}`", relation.name())
                };
                self.bad("human.facing", at("facing"), found, "who is static or staying, alone, can face something");
            }
        }
        let (does, reacts) = (
            self.steps(&section, ("does", "human.does."), names),
            self.steps(&section, ("reacts", "human.reacts."), names),
        );
        let follows = |step: &Step| matches!(step.act, Some(Deed::FollowRobot | Deed::FollowHuman(_)));
        if let Some(side) = side
            && does.iter().chain(&reacts).any(follows)
        {
            let found = format!("`{}` of somebody who follows", side.name());
            self.bad("human.side", at("side"), found, "leave it out: whoever follows walks behind, on no side");
        }
        let pace = self.maybe::<Pace>(&section, "pace", Pace::ALLOWED);
        if let Some(Pace::Mps(mps)) = pace.filter(|pace| pace.mps().is_some_and(|mps| !(0.2..=1.8).contains(&mps))) {
            self.bad("human.pace", at("pace"), format!("{mps} m/s is out of range"), Pace::ALLOWED);
        }
        Some(FormHuman {
            role: self.word(&section, "role"),
            place: self.place(&section, "place"),
            start: self.place(&section, "start"),
            goal: self.place(&section, "goal"),
            group: self.word(&section, "group"),
            does,
            reacts,
            id,
            count,
            pace,
            side,
            facing,
            relation: relation?,
        })
    }

    /// A short text that is not empty.
    fn word(&mut self, section: &Section<'_>, name: &'static str) -> Option<String> {
        let text: String = self.maybe(section, name, "a word in quotation marks")?;
        let length = text.chars().count();
        if text.trim().is_empty() || length > MOST_CHARS || text.chars().any(char::is_control) {
            let at = section.get(name).and_then(|node| node.at);
            let found = if text.trim().is_empty() { "is empty".to_owned() } else { format!("has {length} characters") };
            self.bad(
                section.key(name),
                at,
                found,
                format!("a word or a few, up to {MOST_CHARS} characters on one line"),
            );
            return None;
        }
        Some(text.trim().to_owned())
    }

    pub(super) fn place(&mut self, section: &Section<'_>, name: &'static str) -> Option<PlaceWord> {
        section.get(name)?;
        match self.maybe::<String>(section, name, PLACE) {
            Some(_) => self.word(section, name).map(PlaceWord::from),
            None => None,
        }
    }

    /// Places: one, or a list.
    pub(super) fn places(&mut self, section: &Section<'_>, name: &'static str) -> Vec<PlaceWord> {
        let Some(node) = section.get(name) else { return Vec::new() };
        let nodes: Vec<&Node> = if let Kind::List(nodes) = &node.kind { nodes.iter().collect() } else { vec![node] };
        let key = section.key(name);
        let mut found = Vec::new();
        for node in nodes {
            let Some(text) = self.typed::<String>(&key, node, PLACE) else { continue };
            let text = text.trim();
            if text.is_empty() || text.chars().count() > MOST_CHARS || text.chars().any(char::is_control) {
                self.bad(key.clone(), node.at, format!("`{}` is no name of a place", text.escape_debug()), PLACE);
            } else {
                found.push(PlaceWord::from(text.to_owned()));
            }
        }
        found
    }

    pub(super) fn number(&mut self, key: &str, node: &Node, number: Option<(f64, [f64; 2], &'static str)>) {
        if let Some((value, [least, most], unit)) = number
            && !(least..=most).contains(&value)
        {
            self.bad(key, node.at, format!("{value} {unit} is out of range"), format!("{least} to {most} ({unit})"));
        }
    }

    fn group(&mut self, node: &Node) -> Option<FormGroup> {
        let section = self.section(node, "group.", &["id", "formation"]);
        if section.get("id").is_none() && matches!(node.kind, Kind::Table(_)) {
            self.bad("group.id", node.at, "is missing", "the name that people have in `group`");
        }
        let formations = "circle, queue, side_by_side";
        let id = self.word(&section, "id");
        let formation = self.maybe::<Formation>(&section, "formation", formations);
        Some(FormGroup { id: id?, formation })
    }

    fn order<'n>(&mut self, node: &'n Node, names: &mut Names<'n>) -> Option<FormOrder> {
        let section = self.section(node, "order.", &["first", "then", "at"]);
        let mut end = |name: &'static str| {
            if section.get(name).is_none() && matches!(node.kind, Kind::Table(_)) {
                self.bad(section.key(name), node.at, "is missing", "the name of a person, or \"robot\"");
            }
            let word = self.word(&section, name)?;
            let key = if name == "first" { "order.first" } else { "order.then" };
            names.0.push(Naming { who: word.clone(), key, node: section.get(name), robot: true, several: true });
            Some(word)
        };
        let (first, then) = (end("first"), end("then"));
        let doors = "\"doorway\", \"room\" or \"elevator\", or leave it out for where they meet the robot";
        let at = self.maybe::<PlaceClass>(&section, "at", doors);
        if let Some(class) =
            at.filter(|class| !matches!(class, PlaceClass::Doorway | PlaceClass::Room | PlaceClass::Elevator))
        {
            let node = section.get("at").and_then(|node| node.at);
            self.bad("order.at", node, format!("`{}` has no door", class.name()), doors);
        }
        Some(FormOrder { first: first?, then: then?, at })
    }

    /// The robot's steps: `does = [{ when = { human_near = 3.0 }, say = "EXCUSE_ME" }]`.
    pub(super) fn robot_steps<'n>(
        &mut self,
        section: &Section<'n>,
        form: &Form,
        names: &mut Names<'n>,
    ) -> Vec<RobotStep> {
        let Some(node) = section.get("does") else { return Vec::new() };
        let Kind::List(nodes) = &node.kind else {
            self.bad("robot.does", node.at, format!("is {}", node.kind.name()), "a list: [{ say = \"FOLLOW_ME\" }]");
            return Vec::new();
        };
        let keys: Vec<&str> = ["when"].into_iter().chain(RobotDeed::KEYS).collect();
        let mut steps = Vec::new();
        for node in nodes {
            let section = self.section(node, "robot.does.", &keys);
            if !matches!(node.kind, Kind::Table(_)) {
                continue;
            }
            let before = steps.len();
            let when = section.get("when").and_then(|node| self.robot_moment("robot.does.when", node, (form, before)));
            let deeds: Vec<(&str, &Node)> =
                RobotDeed::KEYS.iter().filter_map(|key| section.get(key).map(|node| (*key, node))).collect();
            let [(key, value)] = deeds[..] else {
                let found = if deeds.is_empty() { "does nothing" } else { "does several things at once" };
                self.bad("robot.does", node.at, found, RobotDeed::ALLOWED);
                continue;
            };
            let Some(act) = self.robot_deed(key, value, (form, before)) else { continue };
            self.number(&format!("robot.does.{key}"), value, act.number());
            let named = [
                (act.names(), "robot.does", Some(value)),
                (when.as_ref().and_then(RobotMoment::names), "robot.does.when", section.get("when")),
            ];
            for (name, key, node) in named {
                names.0.extend(name.map(|name| Naming { who: name.clone(), key, node, robot: false, several: false }));
            }
            steps.push(RobotStep { when, act });
        }
        steps
    }

    /// A moment for which a line of the robot's part waits, behind so many lines.
    fn robot_moment(&mut self, key: &str, node: &Node, (form, before): (&Form, usize)) -> Option<RobotMoment> {
        let moment = self.word_of::<RobotMoment>(key, node, &moments())?;
        self.number(key, node, moment.number());
        if let RobotMoment::AfterLine(number) = moment
            && !usize::try_from(number).is_ok_and(|number| (1..=before).contains(&number))
        {
            self.bad(key, node.at, format!("line {number} does not stand before it"), "the number of a line before it");
        }
        let awaits = if let RobotMoment::Did(name, step) = &moment {
            Some(When::Did(name.clone(), *step))
        } else if let RobotMoment::Done(name) = &moment {
            Some(When::Done(name.clone()))
        } else {
            None
        };
        if let Some((found, hint)) = awaits.and_then(|awaits| never_ends(form, &awaits)) {
            self.bad(key, node.at, found, hint);
        }
        Some(moment)
    }

    /// What a line of the robot's part does.
    fn robot_deed(&mut self, key: &str, value: &Node, before: (&Form, usize)) -> Option<RobotDeed> {
        if key == "hold_until" {
            // A moment of its own, with its own words.
            return self.robot_moment("robot.does.hold_until", value, before).map(RobotDeed::HoldUntil);
        }
        let entry = (key.to_owned(), value.at, value.clone());
        let node = Node { at: value.at, kind: Kind::Table(vec![entry]) };
        self.word_of(&format!("robot.does.{key}"), &node, &deeds())
    }

    /// What is wrong with names: two people or groups of one name, groups that are too small, too many people.
    fn alike(&mut self, form: &Form, top: &Section<'_>) {
        let at = |key: &str, index: usize| match top.get(key).map(|node| &node.kind) {
            Some(Kind::List(nodes)) => nodes.get(index).and_then(|node| node.at),
            _ => None,
        };
        let total = form.humans.iter().fold(0_u32, |sum, human| sum.saturating_add(human.count));
        if total > MAX_HUMANS {
            let node = top.get("human").and_then(|node| node.at);
            self.bad("human.count", node, format!("{total} people altogether"), format!("at most {MAX_HUMANS}"));
        }
        let mut seen: Vec<&str> = Vec::new();
        for (index, human) in form.humans.iter().enumerate() {
            let Some(id) = human.id.as_deref() else { continue };
            if seen.contains(&id) {
                self.bad(
                    "human.id",
                    at("human", index),
                    format!("`{id}` is somebody already"),
                    "a name of its own, or `count`",
                );
            }
            seen.push(id);
        }
        let sizes: BTreeMap<&str, usize> = form.humans.iter().fold(BTreeMap::new(), |mut sizes, human| {
            if let Some(name) = human.group.as_deref() {
                let size: &mut usize = sizes.entry(name).or_default();
                *size = size.saturating_add(usize::try_from(human.count).unwrap_or(usize::MAX));
            }
            sizes
        });
        for (index, human) in form.humans.iter().enumerate() {
            let size = human.group.as_deref().and_then(|name| sizes.get(name).map(|size| (name, *size)));
            if let Some((name, size)) = size.filter(|(_, size)| !GROUP_SIZES.contains(size)) {
                let hint = format!("{} to {} people name a group", GROUP_SIZES.start(), GROUP_SIZES.end());
                self.bad("human.group", at("human", index), format!("`{name}` has {size} people"), hint);
            }
        }
        for (index, group) in form.groups.iter().enumerate() {
            if !sizes.contains_key(group.id.as_str()) {
                let groups: Vec<&str> = sizes.keys().copied().collect();
                let hint = if groups.is_empty() { "no human names a group".to_owned() } else { groups.join(", ") };
                self.bad("group.id", at("group", index), format!("nobody is in `{}`", group.id), hint);
            }
            if form.groups.iter().take(index).any(|other| other.id == group.id) {
                self.bad(
                    "group.id",
                    at("group", index),
                    format!("`{}` is stated already", group.id),
                    "one [[group]] for each",
                );
            }
        }
        self.circle(form, top);
    }

    /// Orders that contradict each other: somebody is before themselves, at once or round about.
    fn circle(&mut self, form: &Form, top: &Section<'_>) {
        let mut after: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (index, order) in form.orders.iter().enumerate() {
            let mut reached = vec![order.then.as_str()];
            let mut next = 0;
            while let Some(name) = reached.get(next).copied() {
                next += 1;
                for then in after.get(name).into_iter().flatten() {
                    if !reached.contains(then) {
                        reached.push(then);
                    }
                }
            }
            if reached.contains(&order.first.as_str()) {
                let at = match top.get("order").map(|node| &node.kind) {
                    Some(Kind::List(nodes)) => nodes.get(index).and_then(|node| node.at),
                    _ => None,
                };
                let found = format!("`{}` before `{}` closes a circle", order.first, order.then);
                self.bad("order", at, found, "remove one of the orders");
            }
            after.entry(&order.first).or_default().push(&order.then);
        }
    }

    /// Finds people who face several others, or themselves.
    fn faced(&mut self, form: &Form, top: &Section<'_>) {
        for (index, human) in form.humans.iter().enumerate() {
            let Some(FacingWord::Name(name)) = &human.facing else { continue };
            let at = match top.get("human").map(|node| &node.kind) {
                Some(Kind::List(nodes)) => nodes.get(index).and_then(|node| node.at),
                _ => None,
            };
            let found = form.named(name).len();
            if human.id.as_ref() == Some(name) {
                self.bad("human.facing", at, format!("`{name}` faces themselves"), "somebody else, or a place");
            } else if found > 1 {
                let hint = format!("one of them: {name}_1");
                self.bad("human.facing", at, format!("`{name}` is {found} people"), hint);
            }
        }
    }

    /// Names that nobody has, or that several have where one is meant.
    pub(super) fn names(&mut self, form: &Form, names: &Names<'_>) {
        let known: Vec<String> = form
            .people()
            .iter()
            .map(|person| {
                person.human.id.clone().filter(|_| person.human.count == 1).unwrap_or_else(|| person.id.to_string())
            })
            .collect();
        for naming in &names.0 {
            if naming.robot && naming.who == "robot" {
                continue;
            }
            let found = form.named(&naming.who).len();
            let at = naming.node.and_then(|node| node.at);
            if found == 0 {
                let hint = if known.is_empty() { "no [[human]] is stated".to_owned() } else { known.join(", ") };
                self.bad(naming.key, at, format!("`{}` is nobody", naming.who), hint);
            } else if found > 1 && !naming.several {
                let hint = format!("one of them: {}_1", naming.who);
                self.bad(naming.key, at, format!("`{}` is {found} people", naming.who), hint);
            }
        }
    }

    /// The form against what else is fixed: `[expect]` and pinned files.
    pub(super) fn against(&mut self, form: &Form, expect: &Expect, top: &Section<'_>) {
        if form.humans.is_empty() {
            return;
        }
        let at = |key: &str| top.get(key).and_then(|node| node.at);
        for pinned in ["proposal", "paths", "behaviors"] {
            if at(pinned).is_some() || top.get(pinned).is_some() {
                self.bad(
                    pinned,
                    at(pinned),
                    "stands beside [[human]]",
                    "a pinned file says who is there already; keep one of the two",
                );
            }
        }
        let count = form.headcount();
        if let Some(humans) = expect.humans.filter(|humans| *humans != count) {
            let found = format!("{humans} humans, but [[human]] states {count}");
            self.bad("expect.humans", at("expect"), found, "leave it out, or correct one of the two");
        }
        if !expect.groups.is_empty() {
            self.bad("expect.groups", at("expect"), "stands beside [[human]]", "name groups by `group` in [[human]]");
        }
        let places: Vec<&PlaceWord> = form.humans.iter().filter_map(|human| human.place.as_ref()).collect();
        if let Some(class) = expect.place
            && !places.is_empty()
            && places.iter().all(|place| !matches!(place, PlaceWord::Class(own) if *own == class))
            && places.iter().all(|place| matches!(place, PlaceWord::Class(_)))
        {
            let found = format!(
                "`{}`, but [[human]] says {}",
                class.name(),
                places.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
            );
            self.bad("expect.place", at("expect"), found, "leave it out, or correct one of the two");
        }
    }
}
