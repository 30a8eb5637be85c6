//! How an encounter is told: the story of a run, its time line and its film use the same words.

use std::collections::BTreeSet;

use crate::{Action, AgentId, Event, EventKind, HumanId, NodeId, Recording, ordinal};

/// Who has come no farther than this has kept its place, m.
const PLACE_M: f64 = 0.5;
/// From so far apart nobody has come to anybody, m; who runs from the robot is gone from nearer already.
const APART_M: f64 = 3.2;
const GONE_M: f64 = 1.5;

impl Recording {
    /// An encounter in words, without its time. `None` for other events, and where there is nothing to tell: whoever
    /// follows the robot at that moment does not meet it.
    #[must_use]
    pub fn encounter_words(&self, event: &Event) -> Option<String> {
        let EventKind::Encounter { human, node, gap_s, nth } = &event.kind else { return None };
        let leaf = self.last_leaf(*human, event);
        if Action::FollowRobot.is_leaf(leaf) {
            return None;
        }
        let most_m = if Action::RunAway.is_leaf(leaf) { GONE_M } else { APART_M };
        let which = if self.meets_again(*human) { format!(" for the {} time", ordinal(*nth)) } else { String::new() };
        if let Some(apart_m) = self.apart_m(*human, event).filter(|apart_m| *apart_m > most_m) {
            return Some(off(*human, node, &which, apart_m));
        }
        // Whoever stands there is met at no time of its own.
        if gap_s.abs() < 1e-9 || self.kept_place(*human, event) {
            return Some(format!("the robot comes to {human}{which} at {node}"));
        }
        // To a millisecond first, as the report has it: else two roundings would tell two figures.
        let gap_s = ((gap_s * 1e3).round() / 1e3).abs();
        Some(format!("{human} and the robot meet{which} at {node}, gap {gap_s:.1} s"))
    }

    fn tick_of(&self, event: &Event) -> usize {
        usize::try_from(event.time.tick()).unwrap_or(usize::MAX).min(self.ticks().saturating_sub(1))
    }

    /// Whether somebody has several encounters.
    fn meets_again(&self, who: HumanId) -> bool {
        let of = |kind: &EventKind| {
            if let EventKind::Encounter { human, nth, .. } = kind { (*human == who).then_some(*nth) } else { None }
        };
        self.events.iter().filter_map(|event| of(&event.kind)).collect::<BTreeSet<u32>>().len() > 1
    }

    /// Letters of the last leaf that somebody began by then; empty where it began none.
    fn last_leaf(&self, who: HumanId, until: &Event) -> &str {
        let of = |event: &'_ Event| matches!(&event.kind, EventKind::Leaf { human, .. } if *human == who);
        let begun = self.events.iter().take_while(|event| event.time <= until.time);
        let last = begun.filter(|event| of(event)).last();
        if let Some(EventKind::Leaf { leaf, .. }) = last.map(|event| &event.kind) { leaf } else { "" }
    }

    /// Whether somebody has kept its place since the run began.
    fn kept_place(&self, human: HumanId, until: &Event) -> bool {
        let ticks = self.tick_of(until).saturating_add(1);
        let mut track = self.track(AgentId::Human(human)).take(ticks).map(crate::AgentState::point);
        track.next().is_some_and(|first| track.all(|at| (at - first).norm() <= PLACE_M))
    }

    /// Distance from somebody to the robot at an event, m; `None` where one of them has no place.
    fn apart_m(&self, human: HumanId, at: &Event) -> Option<f64> {
        let tick = self.tick(self.tick_of(at));
        let of = |agent: AgentId| tick.iter().find(|state| state.agent_id() == agent).map(crate::AgentState::point);
        of(AgentId::Robot).zip(of(AgentId::Human(human))).map(|(robot, human)| (robot - human).norm())
    }
}

fn off(human: HumanId, node: &NodeId, which: &str, apart_m: f64) -> String {
    format!("the robot comes to {node}{which} with {human} {apart_m:.1} m off")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::AgentInfo;
    use crate::{AgentState, FORMAT, RecordingHeader, RunId, SimTime};

    const H1: HumanId = HumanId::new(1);

    /// The robot at the origin; the human goes from one place to another within 2 s.
    fn run(from: (f64, f64), to: (f64, f64)) -> Recording {
        let info = |agent| AgentInfo { agent, radius_m: 0.3, speed_mps: 1.0, role: String::new() };
        let state = |tick: u64, agent: AgentId, (x, y): (f64, f64)| AgentState {
            tick,
            agent: agent.number(),
            flags: AgentState::flags(agent, None, 0),
            x,
            y,
            yaw: 0.0,
            vx: 0.0,
            vy: 0.0,
            omega: 0.0,
        };
        let frames = (0..=200_u32).flat_map(|tick| {
            let share = f64::from(tick) / 200.0;
            let at = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            let tick = u64::from(tick);
            [state(tick, AgentId::Robot, (0.0, 0.0)), state(tick, AgentId::Human(H1), at)]
        });
        Recording {
            header: RecordingHeader {
                format: FORMAT,
                run: RunId::new("test").unwrap(),
                planner: "reference".parse().unwrap(),
                seed: 1,
                profile: "native".into(),
                step_s: 0.01,
                agents: vec![info(AgentId::Robot), info(AgentId::Human(H1))],
                leaves: vec![String::new()],
            },
            frames: frames.collect(),
            events: vec![],
        }
    }

    fn told(mut run: Recording, gap_s: f64, leaf: Option<&str>) -> Option<String> {
        let at = |nanos: u64, kind: EventKind| Event { time: SimTime::from_nanos(nanos), kind };
        if let Some(leaf) = leaf {
            run.events.push(at(500_000_000, EventKind::Leaf { human: H1, leaf: leaf.to_owned() }));
        }
        let met = EventKind::Encounter { human: H1, node: NodeId::new("p4").unwrap(), gap_s, nth: 1 };
        run.events.push(at(2_000_000_000, met.clone()));
        run.encounter_words(&at(2_000_000_000, met))
    }

    #[test]
    fn who_stands_is_come_to_and_who_walks_meets_with_a_gap() {
        let words = told(run((1.0, 1.0), (1.0, 1.2)), 0.7, None).unwrap();
        assert_eq!(words, "the robot comes to human_1 at p4");
        let words = told(run((6.0, 0.0), (1.0, 0.0)), -0.04, None).unwrap();
        assert_eq!(words, "human_1 and the robot meet at p4, gap 0.0 s");
        // The engine times nobody who stands by plan, though it may have stepped aside.
        assert_eq!(told(run((1.0, 0.0), (1.0, 1.6)), 0.0, None).unwrap(), "the robot comes to human_1 at p4");
    }

    #[test]
    fn nobody_comes_to_who_has_run_off_and_who_follows_meets_nobody() {
        let fled = told(run((0.5, 0.0), (2.9, 0.0)), 0.0, Some("RunAwayFromRobot")).unwrap();
        assert_eq!(fled, "the robot comes to p4 with human_1 2.9 m off");
        assert!(told(run((6.0, 0.0), (2.9, 0.0)), 0.5, Some("RegularNav")).unwrap().contains("meet at p4"));
        assert_eq!(
            told(run((0.5, 0.0), (4.9, 0.0)), 0.0, None).unwrap(),
            "the robot comes to p4 with human_1 4.9 m off"
        );
        assert_eq!(told(run((-3.0, 0.0), (-1.2, 0.0)), 1.9, Some("FollowRobot")), None);
        assert!(told(run((-3.0, 0.0), (-1.2, 0.0)), 1.9, Some("FollowHuman")).is_some());
    }
}
