//! A scenario in small, and how it is judged. The mutants in `tests/dev` take this file in by its path, so it names what it needs
//! from the module round it.

use socrates_model::{
    Clause, ClauseRole, FORMAT, GroupId, GroupProposal, HumanId, HumanProposal, Location, Paths, PlaceClass, Predicate,
    Proposal, Reading, Recording, Relation, Report, Verdict, proposal::RobotProposal,
};

use super::fixture::{Walk, floor, recording};
use super::{Evidence, score};

pub(crate) fn must(id: &str, predicate: Predicate) -> Clause {
    Clause { id: id.into(), text: id.into(), role: ClauseRole::Setup, must: true, source: String::new(), predicate }
}

pub(crate) fn proposal(humans: u32, clauses: Vec<Clause>) -> Proposal {
    Proposal {
        format: FORMAT,
        title: "test".into(),
        description: "test".into(),
        pattern: "free".into(),
        place: PlaceClass::Corridor,
        humans: (1..=humans)
            .map(|n| HumanProposal {
                id: HumanId::new(n),
                role: "person".into(),
                behavior: "walks".into(),
                relation: Relation::Frontal,
                side: None,
                facing: None,
                rules: vec![],
                group: None,
                speed_mps: None,
                start: None,
                goal: None,
            })
            .collect(),
        groups: vec![],
        robot: RobotProposal {
            task: "go".into(),
            start: None,
            goal: None,
            script: vec![],
            expected_behavior: "goes".into(),
        },
        expected_events: clauses,
        not_understood: vec![],
        notes: vec![],
        author: "test".into(),
    }
}

pub(crate) fn group_of(mut plan: Proposal, members: &[u32]) -> Proposal {
    let members: Vec<HumanId> = members.iter().copied().map(HumanId::new).collect();
    for human in &mut plan.humans {
        if members.contains(&human.id) {
            human.group = Some(GroupId(1));
        }
    }
    plan.groups.push(GroupProposal { id: GroupId(1), members, standing: true });
    plan
}

pub(crate) fn corridor() -> Location {
    floor(
        &[(-20., 1.5, 20., 2.0), (-20., -2.0, 20., -1.5)],
        &[("a", "CORRIDOR", -8., 0.), ("m", "CORRIDOR", 0., 0.), ("b", "CORRIDOR", 8., 0.)],
        &[("a", "m"), ("m", "b")],
    )
}

pub(crate) struct Case {
    pub(crate) place: Location,
    pub(crate) plan: Proposal,
    pub(crate) ways: Paths,
    pub(crate) reading: Option<Reading>,
}

impl Case {
    pub(crate) fn evidence<'a>(&'a self, run: &'a Recording) -> Evidence<'a> {
        Evidence {
            location: Some(&self.place),
            proposal: Some(&self.plan),
            paths: Some(&self.ways),
            reading: self.reading.as_ref(),
            ..Evidence::of(run)
        }
    }

    pub(crate) fn judge(&self, run: &Recording) -> Report {
        let report = score(&self.evidence(run));
        // Every report survives its file.
        let text = serde_json::to_string(&report).unwrap();
        assert_eq!(serde_json::from_str::<Report>(&text).unwrap(), report);
        report
    }

    pub(crate) fn verdict(&self, walks: &[Walk], seconds: f64) -> Verdict {
        self.judge(&recording(walks, seconds, 0.01)).verdict
    }
}
