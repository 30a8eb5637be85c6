//! A small question for the tests of this crate.

use socrates_model::job::Stage;
use socrates_model::{
    Action, Cell, Clause, ClauseRole, FORMAT, GraphEdge, GraphNode, Grid, HumanId, HumanProposal, Location, NodeId,
    PlaceClass, Point, Pose, Predicate, Proposal, Reading, Relation, Request, RobotProposal, Rule, SceneGraph, Trigger,
};

use crate::question::Question;

/// A junction of three corridors.
pub(crate) fn tee_map() -> Location {
    let id = |text: &str| NodeId::new(text).unwrap();
    let node =
        |text: &str, kind: &str, x: f64, y: f64| GraphNode { id: id(text), kind: kind.into(), at: Point::new(x, y) };
    let way = |to: &str| GraphEdge { from: id("c"), to: id(to), kind: "CORRIDOR".into(), via: Vec::new() };
    Location {
        format: FORMAT,
        name: "tee".into(),
        description: "Three corridors".into(),
        grid: Grid {
            width: 20,
            height: 20,
            resolution_m: 0.5,
            origin: Pose::new(-5.0, -5.0, 0.0),
            cells: vec![Cell::Free; 400],
        },
        graph: SceneGraph::new(
            vec![
                node("c", "INTERSECTION", 0., 0.),
                node("w", "CORRIDOR", -4., 0.),
                node("e", "CORRIDOR", 4., 0.),
                node("n", "CORRIDOR", 0., 3.),
            ],
            vec![way("w"), way("e"), way("n")],
        ),
        doors: Vec::new(),
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

pub(crate) fn proposal() -> Proposal {
    let human = |number: u32, act: Action| HumanProposal {
        id: HumanId::new(number),
        role: "visitor".into(),
        behavior: "comes along and reacts to the robot".into(),
        relation: Relation::Crossing,
        side: None,
        facing: None,
        rules: vec![Rule { when: vec![Trigger::RobotNear(3.0)], act, ..Rule::default() }],
        group: None,
        speed_mps: Some(1.1),
        start: None,
        goal: None,
    };
    Proposal {
        format: FORMAT,
        title: "Two visitors".into(),
        description: "Two visitors cross the robot's way.".into(),
        pattern: "free".into(),
        place: PlaceClass::Intersection,
        humans: vec![human(1, Action::RunAway), human(2, Action::GiveWay)],
        groups: Vec::new(),
        robot: RobotProposal {
            task: "deliver".into(),
            start: None,
            goal: None,
            script: Vec::new(),
            expected_behavior: "slows down".into(),
        },
        expected_events: vec![Clause {
            id: "c1".into(),
            text: "two".into(),
            role: ClauseRole::Setup,
            must: true,
            source: String::new(),
            predicate: Predicate::Humans { count: 2 },
        }],
        not_understood: Vec::new(),
        notes: Vec::new(),
        author: "test".into(),
    }
}

/// A question of the stage, on the small map.
pub(crate) fn question(stage: Stage) -> Question {
    let request: Request = serde_json::from_value(
        serde_json::json!({"location": "tee", "social_context": "A hall", "task": "Deliver mail"}),
    )
    .unwrap();
    Question {
        stage,
        proposal: (stage != Stage::Proposal).then(proposal),
        ..Question::first(request, Reading::default(), tee_map(), 1)
    }
}
