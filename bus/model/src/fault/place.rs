//! Where a fault is.

use std::fmt;
use std::ops::Range;

use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{self, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::text::Label;
use crate::ids::{AgentId, GroupId, HumanId, NodeId};
use crate::job::{JobKey, Stage};

/// A stretch of the text of a request, in characters from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Span {
    /// First character.
    pub from: u32,
    /// The character behind the last one.
    pub to: u32,
}

impl Span {
    /// Bytes of a text as a span; none where they cut a character.
    #[must_use]
    pub fn of(text: &str, bytes: &Range<usize>) -> Option<Self> {
        let chars = |end: usize| u32::try_from(text.get(..end)?.chars().count()).ok();
        Some(Self { from: chars(bytes.start)?, to: chars(bytes.end)? })
    }

    /// The bytes of a text that it spans; none where the text is shorter.
    #[must_use]
    pub fn bytes(self, text: &str) -> Option<Range<usize>> {
        let ends = || text.char_indices().map(|(at, _)| at).chain([text.len()]);
        let at = |place: u32| ends().nth(usize::try_from(place).ok()?);
        Some(at(self.from)?..at(self.to)?)
    }

    /// Whether the two have a character in common.
    #[must_use]
    pub const fn overlaps(self, other: Self) -> bool {
        self.from < other.to && other.from < self.to
    }
}

/// Where a fault is: as much of it as is known. Printed by one [`fmt::Display`], for people and authors:
///
/// ```
/// use socrates_model::fault::Where;
/// use socrates_model::{AgentId, HumanId};
/// let human = AgentId::Human(HumanId::new(1));
/// assert_eq!(Where::agent(AgentId::Robot).step(3).to_string(), "robot step 3");
/// assert_eq!(Where::agents([AgentId::Robot, human]).to_string(), "robot, human_1");
/// assert_eq!(Where::file("map.yaml").line(4).to_string(), "map.yaml:4");
/// assert_eq!(Where::agent(human).line(4).column(7).at_key("RegularNav").to_string(), "human_1 4:7 RegularNav");
/// assert_eq!(Where::file("scene_graph.json").node("n1".parse()?).to_string(), "scene_graph.json node `n1`");
/// # Ok::<(), socrates_model::ids::BadId>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(default)]
pub struct Where {
    /// Whose path, tree or part it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agent: Option<AgentId>,
    /// The other agents that it is about.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<AgentId>,
    /// Step of a path, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<u32>,
    /// File.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<Label>,
    /// Line of the file or of the agent's tree, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// Column of the line, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<u32>,
    /// Key, path in a JSON answer, element of a tree or part of an artifact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<Label>,
    /// Node of the scene graph.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<NodeId>,
    /// Stretch of the request's text that the key holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub span: Option<Span>,
}

impl Where {
    /// At an agent.
    pub fn agent(agent: impl Into<AgentId>) -> Self {
        Self { agent: Some(agent.into()), ..Self::default() }
    }

    /// Between agents.
    pub fn agents(agents: impl IntoIterator<Item = AgentId>) -> Self {
        let mut agents = agents.into_iter();
        Self { agent: agents.next(), others: agents.collect(), ..Self::default() }
    }

    /// At a part of the robot's.
    pub fn robot(part: impl fmt::Display) -> Self {
        Self::agent(AgentId::Robot).at_key(part)
    }

    /// At a rule of a human, from 1.
    pub fn rule(human: HumanId, number: usize) -> Self {
        Self::agent(human).at_key(format_args!("rule {number}"))
    }

    /// At a clause of a proposal.
    pub fn clause(id: &str) -> Self {
        Self::key(format_args!("clause {id}"))
    }

    /// In a file.
    pub fn file(name: impl fmt::Display) -> Self {
        Self { file: Some(Label::new(name)), ..Self::default() }
    }

    /// At a key, a path in a JSON answer, or a part of an artifact.
    pub fn key(name: impl fmt::Display) -> Self {
        Self::default().at_key(name)
    }

    /// Whether it is this key, wherever in its value.
    #[must_use]
    pub fn is_key(&self, name: &str) -> bool {
        Self { span: None, ..self.clone() } == Self::key(name)
    }

    /// The same, at this step of a path, from 1.
    #[must_use]
    pub fn step(self, step: usize) -> Self {
        Self { step: Some(small(step)), ..self }
    }

    /// The same, at this line, from 1.
    #[must_use]
    pub fn line(self, line: usize) -> Self {
        Self { line: Some(small(line)), ..self }
    }

    /// The same, at this column, from 1.
    #[must_use]
    pub fn column(self, column: usize) -> Self {
        Self { column: Some(small(column)), ..self }
    }

    /// The same, at this key.
    #[must_use]
    pub fn at_key(self, name: impl fmt::Display) -> Self {
        Self { key: Some(Label::new(name)), ..self }
    }

    /// The same, at this node.
    #[must_use]
    pub fn node(self, node: NodeId) -> Self {
        Self { node: Some(node), ..self }
    }

    /// The same, at this stretch of the request's text.
    #[must_use]
    pub fn span(self, span: Span) -> Self {
        Self { span: Some(span), ..self }
    }

    /// The same of this agent, where it names none.
    #[must_use]
    pub fn of(mut self, agent: impl Into<AgentId>) -> Self {
        self.agent.get_or_insert_with(|| agent.into());
        self
    }

    /// The same in this file, where it names none.
    #[must_use]
    pub fn within(mut self, file: impl fmt::Display) -> Self {
        self.file.get_or_insert_with(|| Label::new(file));
        self
    }

    /// The same in what was made from this file.
    #[must_use]
    pub fn made_from(mut self, file: impl fmt::Display) -> Self {
        self.file = Some(match self.file {
            Some(made) => Label::new(format_args!("{file} -> {made}")),
            None => Label::new(format_args!("{file} ->")),
        });
        self
    }

    /// Whether it is about this agent.
    #[must_use]
    pub fn names(&self, agent: AgentId) -> bool {
        self.agent == Some(agent) || self.others.contains(&agent)
    }

    /// The human it is about, where it is about one.
    #[must_use]
    pub const fn human(&self) -> Option<HumanId> {
        match self.agent {
            Some(AgentId::Human(id)) => Some(id),
            Some(AgentId::Robot) | None => None,
        }
    }

    /// Whether nothing is known of it.
    #[must_use]
    pub fn is_nowhere(&self) -> bool {
        *self == Self::default()
    }

    /// The same with at most so many characters of each name.
    #[must_use]
    pub fn shortened(mut self, characters: usize) -> Self {
        self.file = self.file.map(|file| file.shortened(characters));
        self.key = self.key.map(|key| key.shortened(characters));
        self
    }
}

fn small(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

impl fmt::Display for Where {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts: Vec<String> = Vec::new();
        let agents: Vec<String> = self.agent.iter().chain(&self.others).map(AgentId::to_string).collect();
        if !agents.is_empty() {
            parts.push(agents.join(", "));
        }
        parts.extend(self.step.map(|step| format!("step {step}")));
        let position = match (self.line, self.column) {
            (Some(line), Some(column)) => Some(format!("{line}:{column}")),
            (Some(line), None) => Some(line.to_string()),
            (None, _) => None,
        };
        match (&self.file, position) {
            (Some(file), Some(position)) => parts.push(format!("{file}:{position}")),
            (Some(file), None) => parts.push(file.to_string()),
            (None, position) => parts.extend(position),
        }
        parts.extend(self.key.as_ref().map(Label::to_string));
        parts.extend(self.node.as_ref().map(|node| format!("node `{node}`")));
        f.pad(&parts.join(" "))
    }
}

impl From<AgentId> for Where {
    fn from(agent: AgentId) -> Self {
        Self::agent(agent)
    }
}

impl From<HumanId> for Where {
    fn from(human: HumanId) -> Self {
        Self::agent(human)
    }
}

impl From<GroupId> for Where {
    fn from(group: GroupId) -> Self {
        Self::key(group)
    }
}

impl From<Stage> for Where {
    fn from(stage: Stage) -> Self {
        Self::key(stage)
    }
}

impl From<&JobKey> for Where {
    fn from(job: &JobKey) -> Self {
        Self::key(job)
    }
}

impl From<&Self> for Where {
    fn from(at: &Self) -> Self {
        at.clone()
    }
}

/// A key that stands in the program's text; any other is made by [`Where::key`].
impl From<&'static str> for Where {
    fn from(key: &'static str) -> Self {
        Self::key(key)
    }
}

/// The fields as they are written.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
#[derive(Default)]
struct Fields {
    agent: Option<AgentId>,
    others: Vec<AgentId>,
    step: Option<u32>,
    file: Option<Label>,
    line: Option<u32>,
    column: Option<u32>,
    key: Option<Label>,
    node: Option<NodeId>,
    span: Option<Span>,
}

impl From<Fields> for Where {
    fn from(fields: Fields) -> Self {
        let Fields { agent, others, step, file, line, column, key, node, span } = fields;
        Self { agent, others, step, file, line, column, key, node, span }
    }
}

impl<'de> Deserialize<'de> for Where {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WhereVisitor)
    }
}

/// Reads the object of this version, or the text of the versions before it.
struct WhereVisitor;

impl<'de> Visitor<'de> for WhereVisitor {
    type Value = Where;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a place: an object with agent, step, file, line, column, key, node or span")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Where, E> {
        Ok(if text.is_empty() { Where::default() } else { Where::key(text) })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Where, A::Error> {
        Fields::deserialize(MapAccessDeserializer::new(map)).map(Where::from)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Where, A::Error> {
        Fields::deserialize(SeqAccessDeserializer::new(seq)).map(Where::from)
    }
}
