//! Motions that only steps of a form have. Each succeeds in the tick it is done in.

use socrates_model::act::Destination;
use socrates_model::{Action, NodeId};

use crate::nodes::human_says::human;
use crate::nodes::motion::REGULAR_NAV;
use crate::sheet::{Library, NodeSheet, PortKind, PortSheet, Role};

/// `WatchHuman`.
pub(super) const WATCH_HUMAN: NodeSheet = NodeSheet {
    tag: "WatchHuman",
    library: Library::Native,
    ports: &[PortSheet::OWN, PortSheet::must("target_id", PortKind::Human, "who is looked at")],
    about: "stops and turns to another human",
    role: Role::Moves(|ports| Some(Action::LookAt(human(ports, 1)?))),
    ..REGULAR_NAV
};

/// `TurnBack`.
pub(super) const TURN_BACK: NodeSheet = NodeSheet {
    tag: "TurnBack",
    library: Library::Native,
    about: "turns and walks back along their path to where it began",
    role: Role::Moves(|_| Some(Action::TurnBack)),
    ..REGULAR_NAV
};

/// `GoToPlace`.
pub(super) const GO_TO: NodeSheet = NodeSheet {
    tag: "GoToPlace",
    library: Library::Native,
    ports: &[
        PortSheet::OWN,
        PortSheet::STEP,
        PortSheet::must("place", PortKind::Text, "the place in words"),
        PortSheet::must("nodes", PortKind::Text, "its nodes, separated by commas"),
    ],
    about: "leaves their path, goes to the nearest of some nodes, and stays there",
    role: Role::Moves(|ports| {
        let nodes = ports.text(3)?;
        let nodes: Vec<NodeId> = nodes.split(',').filter_map(|id| NodeId::new(id).ok()).collect();
        Some(Action::GoTo(Destination { place: ports.text(2)?.into_owned(), nodes }))
    }),
    ..REGULAR_NAV
};

/// `ChangePace`.
pub(super) const CHANGE_PACE: NodeSheet = NodeSheet {
    tag: "ChangePace",
    library: Library::Native,
    ports: &[PortSheet::OWN, PortSheet::STEP, PortSheet::must("speed", PortKind::Speed, "speed from then on")],
    about: "walks on along their path, from then on at this speed",
    role: Role::Moves(|ports| Some(Action::ChangePace(ports.real(2)?))),
    ..REGULAR_NAV
};

/// `TurnAway`.
pub(super) const TURN_AWAY: NodeSheet = NodeSheet {
    tag: "TurnAway",
    library: Library::Native,
    about: "stops and turns their back to the robot",
    role: Role::Moves(|_| Some(Action::TurnAway)),
    ..REGULAR_NAV
};

/// `ComeBack`.
pub(super) const COME_BACK: NodeSheet = NodeSheet {
    tag: "ComeBack",
    library: Library::Native,
    about: "goes back to where they began, and stays there",
    role: Role::Moves(|_| Some(Action::ComeBack)),
    ..REGULAR_NAV
};

/// `MakeRoom`.
pub(super) const MAKE_ROOM: NodeSheet = NodeSheet {
    tag: "MakeRoom",
    library: Library::Native,
    about: "steps out of the robot's way, and goes back to where they stood once it has passed",
    role: Role::Moves(|_| Some(Action::MakeRoom)),
    ..REGULAR_NAV
};

/// `ComeClose`.
pub(super) const COME_CLOSE: NodeSheet = NodeSheet {
    tag: "ComeClose",
    library: Library::Native,
    ports: &[PortSheet::OWN, PortSheet::STEP, PortSheet::must("distance", PortKind::Meters, "how near they come")],
    about: "goes up to the robot as near as a distance, and keeps so near while it goes away",
    role: Role::Moves(|ports| Some(Action::ApproachTo(ports.real(2)?))),
    ..REGULAR_NAV
};
