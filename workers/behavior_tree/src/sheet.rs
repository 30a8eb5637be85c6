//! Node sheets: everything that is known about a kind of node, in one place.

use socrates_model::{Action, Gesture, Trigger};

use crate::blackboard::Ports;
use crate::status::Status;
use crate::tick::Ticker;
use crate::tree::Format;

/// Where a kind of node comes from, and so who else can load it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Library {
    /// Part of BehaviorTree.CPP.
    BuiltIn,
    /// The node library of HuNavSim 1.0.
    HunavSim1_0,
    /// The node library of HuNavSim 1.1: the nodes of 1.0, with the parameters of the reactions as ports.
    HunavSim1_1,
    /// The node library of HuNavSim 2.0, written for BehaviorTree.CPP 4.
    HunavSim2,
    /// The node library of the SocRATES fork of HuNavSim.
    SocratesFork,
    /// Added here; other simulators do not know it.
    Native,
}

impl Library {
    /// Every library, in order of appearance.
    pub const ALL: [Self; 6] =
        [Self::BuiltIn, Self::HunavSim1_0, Self::HunavSim1_1, Self::HunavSim2, Self::SocratesFork, Self::Native];

    /// Name in messages, files and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::BuiltIn => "built-in",
            Self::HunavSim1_0 => "hunav-1.0",
            Self::HunavSim1_1 => "hunav-1.1",
            Self::HunavSim2 => "hunav-2.0",
            Self::SocratesFork => "socrates-fork",
            Self::Native => "native",
        }
    }

    /// The library of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|library| library.name() == name)
    }
}

/// What a node does with its children.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Chooses among children.
    Control,
    /// Changes the outcome of one child.
    Decorator,
    /// Asks; never changes anything.
    Condition,
    /// Does something.
    Action,
}

impl Kind {
    /// Name in messages and prompts.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Control => "control",
            Self::Decorator => "decorator",
            Self::Condition => "condition",
            Self::Action => "action",
        }
    }
}

/// What may stand in a port. Every kind also takes `{key}`, a blackboard entry, unless it says otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PortKind {
    /// The human itself: exactly `{id}`.
    Own,
    /// Length of a tick: `{dt}`, or seconds above 0.
    Step,
    /// A distance, 0.3 to 15 m.
    Meters,
    /// A time span, above 0 and at most 3600 s.
    Seconds,
    /// A gesture code, 0 to 5.
    Gesture,
    /// The number of another human: 1 for `human_1`.
    Human,
    /// true or false.
    Flag,
    /// A whole number of at least this.
    Count(i64),
    /// A factor or speed, any finite number.
    Number,
    /// Any text.
    Text,
    /// The name of a blackboard entry, without braces.
    Key,
    /// A script (v4).
    Code,
    /// An agent: `{id}` or its id, a whole number of at least 0.
    Agent,
    /// Ids of agents, separated by commas.
    Agents,
    /// A distance of at least 0 m.
    Distance,
    /// A time span of at least 0 s.
    Span,
    /// A speed of at least 0 m/s.
    Speed,
    /// An angle from 0 to 2π rad.
    Angle,
    /// A probability from 0 to 1.
    Share,
    /// The entry a result is written to, as `{entry}`.
    Output,
}

impl PortKind {
    /// What is allowed, in words.
    #[must_use]
    pub fn allowed(self) -> String {
        match self {
            Self::Own => "exactly {id}".to_owned(),
            Self::Step => "{dt}, or seconds above 0".to_owned(),
            Self::Meters => "a distance from 0.3 to 15 m".to_owned(),
            Self::Seconds => "seconds above 0 and at most 3600".to_owned(),
            Self::Gesture => format!("a gesture code: {}", Gesture::table()),
            Self::Human => "the number of another human, 1 for human_1".to_owned(),
            Self::Flag => "true or false".to_owned(),
            Self::Count(least) => format!("a whole number of at least {least}"),
            Self::Number => "a number".to_owned(),
            Self::Text => "any text".to_owned(),
            Self::Key => "the name of a blackboard entry without braces".to_owned(),
            Self::Code => "a script such as x := 1".to_owned(),
            Self::Agent => "{id}, or the id of an agent, a whole number of at least 0".to_owned(),
            Self::Agents => "ids of agents separated by commas, such as 2,3".to_owned(),
            Self::Distance => "a distance of at least 0 m".to_owned(),
            Self::Span => "seconds, at least 0".to_owned(),
            Self::Speed => "a speed of at least 0 m/s".to_owned(),
            Self::Angle => "an angle from 0 to 6.283 rad".to_owned(),
            Self::Share => "a probability from 0 to 1".to_owned(),
            Self::Output => "the entry a result is written to, as {entry}".to_owned(),
        }
    }
}

/// One port of a kind of node.
#[derive(Debug, Clone, Copy)]
pub struct PortSheet {
    /// Attribute name (v3).
    pub name: &'static str,
    /// Attribute name in v4 where it differs.
    pub v4_name: Option<&'static str>,
    /// What may stand in it.
    pub kind: PortKind,
    /// Value where the attribute is missing; without one the attribute must be there.
    pub default: Option<&'static str>,
    /// What it means.
    pub about: &'static str,
}

impl PortSheet {
    /// A port that must be given.
    pub(crate) const fn must(name: &'static str, kind: PortKind, about: &'static str) -> Self {
        Self { name, v4_name: None, kind, default: None, about }
    }

    /// A port with a default.
    pub(crate) const fn may(name: &'static str, kind: PortKind, default: &'static str, about: &'static str) -> Self {
        Self { name, v4_name: None, kind, default: Some(default), about }
    }

    /// The same port under another name in v4.
    pub(crate) const fn in_v4(self, name: &'static str) -> Self {
        Self { v4_name: Some(name), ..self }
    }

    /// Whether a document of either version may write this name for it.
    pub(crate) fn is_called(&self, name: &str) -> bool {
        self.name == name || self.v4_name == Some(name)
    }

    /// `agent_id`, as nearly every leaf has it.
    pub(crate) const OWN: Self = Self::must("agent_id", PortKind::Own, "this human");
    /// `agent_id` in the libraries of HuNavSim: any agent by its number.
    pub(crate) const AGENT: Self = Self::must("agent_id", PortKind::Agent, "whose leaf it is");
    /// `time_step`, as every motion has it.
    pub(crate) const STEP: Self = Self::must("time_step", PortKind::Step, "length of a tick");
    /// `distance`, as the conditions on the robot have it.
    pub(crate) const DISTANCE: Self = Self::must("distance", PortKind::Meters, "largest distance to the robot");
}

/// How many children a node takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Arity {
    /// At least.
    pub least: usize,
    /// At most.
    pub most: usize,
}

impl Arity {
    pub(crate) const NONE: Self = Self { least: 0, most: 0 };
    pub(crate) const ONE: Self = Self { least: 1, most: 1 };
    pub(crate) const SOME: Self = Self { least: 1, most: usize::MAX };

    /// In words: `exactly 1`, `at least 1`, `2 to 3`, `none`.
    #[must_use]
    pub fn allowed(self) -> String {
        match (self.least, self.most) {
            (0, 0) => "none".to_owned(),
            (least, usize::MAX) => format!("at least {least}"),
            (least, most) if least == most => format!("exactly {least}"),
            (least, most) => format!("{least} to {most}"),
        }
    }
}

/// What the checks need to know about a leaf.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Role {
    /// Routes the tick.
    Flow,
    /// Asks about the world.
    Asks(fn(&Ports<'_>) -> Option<Trigger>),
    /// Counts time while it is ticked.
    Timer,
    /// Moves the human (or keeps it still on purpose).
    Moves(fn(&Ports<'_>) -> Option<Action>),
    /// Makes a gesture.
    Says,
    /// Changes the goal or the blackboard.
    Quiet,
    /// A leaf of the catalog that only [`World::leaf`](crate::World::leaf) can tick.
    World,
    /// Not in the catalog.
    Foreign,
}

impl Role {
    /// Whether the catalog knows the node.
    pub(crate) const fn is_cataloged(self) -> bool {
        !matches!(self, Self::Foreign)
    }

    /// Whether only the world knows what the leaf does.
    pub(crate) const fn is_opaque(self) -> bool {
        matches!(self, Self::World | Self::Foreign)
    }
}

/// Ticks a node; the node is already chosen and its status is set by the caller.
pub(crate) type TickFn = fn(&mut Ticker<'_>, usize) -> Status;
/// Stops a running node.
pub(crate) type HaltFn = fn(&mut Ticker<'_>, usize);

/// A kind of node.
#[derive(Debug, Clone, Copy)]
pub struct NodeSheet {
    /// Tag.
    pub tag: &'static str,
    /// Tag in v3 where it differs.
    pub v3_tag: Option<&'static str>,
    /// Control, decorator, condition or action.
    pub kind: Kind,
    /// Where it comes from.
    pub library: Library,
    /// Number of children.
    pub arity: Arity,
    /// Ports in order.
    pub ports: &'static [PortSheet],
    /// What it does, one sentence.
    pub about: &'static str,
    pub(crate) role: Role,
    pub(crate) tick: TickFn,
    pub(crate) halt: HaltFn,
}

impl NodeSheet {
    /// Whether a document may write this tag for it.
    #[must_use]
    pub fn is_called(&self, tag: &str) -> bool {
        self.tag == tag || self.v3_tag == Some(tag)
    }

    /// Number of children in a format: `WhileDoElse` of version 3 demands all three.
    #[must_use]
    pub fn arity_in(&self, format: Format) -> Arity {
        match (self.tag, format) {
            ("WhileDoElse", Format::V3) => Arity { least: 3, ..self.arity },
            _ => self.arity,
        }
    }

    /// The only format that has this kind of node; `None` where both have it.
    #[must_use]
    pub fn only_in(&self) -> Option<Format> {
        match self.tag {
            "RunOnce" | "Script" | "ScriptCondition" | "Precondition" | "UnsetBlackboard" | "Sleep"
            | "AsyncSequence" | "AsyncFallback" | "TimeDelay" => Some(Format::V4),
            "SubTreePlus" => Some(Format::V3),
            _ => None,
        }
    }

    /// Whether this crate ticks it without the help of [`World::leaf`](crate::World::leaf).
    #[must_use]
    pub const fn is_native(&self) -> bool {
        !matches!(self.role, Role::World)
    }

    /// The sheet as one line of a prompt: `FollowHuman agent_id="{id}" target_id=…: …`.
    #[must_use]
    pub fn line(&self) -> String {
        let only = self.only_in().map_or_else(String::new, |format| format!(", {} only", format.name()));
        let mut text = format!("{} ({}{only})", self.tag, self.kind.name());
        for port in self.ports {
            text.push_str(&format!(" {}=[{}]", port.name, port.kind.allowed()));
            if let Some(default) = port.default {
                text.push_str(&format!(" (default {default})"));
            }
        }
        text.push_str(": ");
        text.push_str(self.about);
        text
    }
}
