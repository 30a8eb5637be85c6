//! A question with a known good answer, and an author that says what it is told.

use async_trait::async_trait;
use socrates_model::job::Stage;
use socrates_model::{
    Action, Cell, Clause, ClauseRole, FORMAT, GraphEdge, GraphNode, Grid, HumanId, HumanProposal, Location, NodeId,
    PlaceClass, Point, Pose, Predicate, Proposal, Reading, Relation, RobotProposal, Rule, SceneGraph, Trigger,
};
use socrates_prompts::Question;

use crate::author::{Answer, AskError, Author};

/// Says the same to every question.
#[derive(Debug, Clone)]
pub(crate) struct Scripted {
    pub(crate) says: Result<String, AskError>,
    pub(crate) cut: bool,
}

impl Scripted {
    pub(crate) fn says(text: &str) -> Self {
        Self { says: Ok(text.to_owned()), cut: false }
    }

    pub(crate) fn fails(error: AskError) -> Self {
        Self { says: Err(error), cut: false }
    }
}

#[async_trait]
impl Author for Scripted {
    async fn ask(&self, _question: &Question) -> Result<Answer, AskError> {
        let text = self.says.clone()?;
        Ok(Answer { text, model: "scripted".into(), cut: self.cut, ..Answer::default() })
    }

    fn name(&self) -> String {
        "scripted".into()
    }
}

fn node(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

fn plus_map() -> Location {
    let at = |id: &str, x: f64, y: f64| GraphNode { id: node(id), kind: "CORRIDOR".into(), at: Point::new(x, y) };
    let way = |a: &str, b: &str| GraphEdge { from: node(a), to: node(b), kind: "PASSAGEWAY".into(), via: Vec::new() };
    let arms = [("w", -3.0, 0.0), ("e", 3.0, 0.0), ("n", 0.0, 3.0), ("s", 0.0, -3.0)];
    let (mut nodes, mut edges) = (vec![at("c", 0.0, 0.0)], Vec::new());
    for (name, x, y) in arms {
        let (near, far) = (format!("{name}_1"), format!("{name}_2"));
        nodes.extend([at(&near, x, y), at(&far, 2.0 * x, 2.0 * y)]);
        edges.extend([way("c", &near), way(&near, &far)]);
    }
    Location {
        format: FORMAT,
        name: "plus".into(),
        description: "Four corridors".into(),
        grid: Grid {
            width: 40,
            height: 40,
            resolution_m: 0.5,
            origin: Pose::new(-10.0, -10.0, 0.0),
            cells: vec![Cell::Free; 1600],
        },
        graph: SceneGraph::new(nodes, edges),
        doors: Vec::new(),
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

pub(crate) fn proposal() -> Proposal {
    let human = |number: u32, act: Action| HumanProposal {
        id: HumanId::new(number),
        role: "visitor".into(),
        behavior: "crosses the corridor".into(),
        relation: Relation::Crossing,
        side: None,
        facing: None,
        rules: vec![Rule { when: vec![Trigger::RobotNear(3.0)], act, ..Rule::default() }],
        group: None,
        speed_mps: None,
        start: None,
        goal: None,
    };
    let clause = |id: &str, source: &str, predicate: Predicate| Clause {
        id: id.into(),
        text: id.into(),
        role: ClauseRole::Setup,
        must: true,
        source: source.into(),
        predicate,
    };
    Proposal {
        format: FORMAT,
        title: "Two visitors".into(),
        description: "Two visitors cross the robot's way at an intersection.".into(),
        pattern: "free".into(),
        place: PlaceClass::Intersection,
        humans: vec![human(1, Action::RunAway), human(2, Action::GiveWay)],
        groups: Vec::new(),
        robot: RobotProposal {
            task: "deliver".into(),
            start: None,
            goal: None,
            script: Vec::new(),
            expected_behavior: "It slows down.".into(),
        },
        expected_events: vec![
            clause("c1", "", Predicate::Humans { count: 2 }),
            clause("c2", "f1", Predicate::RunsAway { human: HumanId::new(1), by_m: 1.0 }),
            clause("c3", "f2", Predicate::GivesWay { human: HumanId::new(2) }),
        ],
        not_understood: Vec::new(),
        notes: Vec::new(),
        author: socrates_model::Signature::default(),
    }
}

fn reading() -> Reading {
    use socrates_model::{Fact, FactKind};
    let fact = |id: &str, kind: FactKind| Fact { id: id.into(), quote: "words".into(), kind };
    let rule = |index: usize| proposal().humans[index].rules[0].clone();
    Reading {
        format: FORMAT,
        facts: vec![
            fact("f1", FactKind::Reacts { human: HumanId::new(1), rule: rule(0) }),
            fact("f2", FactKind::Reacts { human: HumanId::new(2), rule: rule(1) }),
            fact("f3", FactKind::Humans(2)),
        ],
        ..Reading::default()
    }
}

pub(crate) fn question(stage: Stage) -> Question {
    let request = serde_json::from_value(
        serde_json::json!({"location": "plus", "social_context": "A hall", "task": "Deliver mail"}),
    )
    .unwrap();
    Question {
        stage,
        proposal: (stage != Stage::Proposal).then(proposal),
        ..Question::first(request, reading(), plus_map(), 11)
    }
}

/// A right answer to the proposal question.
pub(crate) fn good_proposal() -> String {
    serde_json::to_string(&proposal()).unwrap()
}

/// A right answer to the paths question.
pub(crate) fn good_paths() -> String {
    r#"{"encounters": [{"human": "human_1", "node": "c"}, {"human": "human_2", "node": "c"}],
        "humans": {"human_1": ["n_2", "n_1", "c", "s_1"], "human_2": ["s_2", "s_1", "c", "n_1"]},
        "robot": ["w_2", "w_1", "c", "e_1", "e_2"]}"#
        .to_owned()
}

/// A right answer to the behaviors question.
pub(crate) fn good_behaviors() -> String {
    let rules = |index: usize| serde_json::to_value(&proposal().humans[index].rules).unwrap();
    serde_json::json!({"humans": {
        "human_1": {"description": "runs away", "rules": rules(0)},
        "human_2": {"description": "gives way", "rules": rules(1)},
    }})
    .to_string()
}
