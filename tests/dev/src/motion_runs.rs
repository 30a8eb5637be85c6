//! How everybody moves in the scenarios of the catalog and the shipped requests: where they start and end, how the robot keeps
//! its way, and that whoever has come to rest stays at rest.

use socrates_app::cards;
use socrates_app::config::Config;
use socrates_app::in_process::{Played, play};
use socrates_model::{
    Action, AgentId, AgentState, EventKind, HumanProposal, Location, Point, Polyline, Recording, Request,
};
use socrates_offline::catalog;

use crate::mutations::shipped;

/// Least gap between two at the start, and between anybody at the end and a robot at its goal, surface to surface, m.
const APART_M: f64 = 0.05;
/// Longest way of the robot as a share of the planned one where nobody bars its way on purpose.
const LONGEST: f64 = 1.15;
/// Somebody slower than this is at rest, m/s; from then on nobody goes farther than this, m, or turns to and fro.
const AT_REST_MPS: f64 = 0.03;
const STAYS_M: f64 = 0.12;
/// Faster than this somebody turns, rad/s.
const TURNS_RADPS: f64 = 0.2;
/// Who is nearer than this to where it is at the end has come there, m: a person, and the robot, which may wait short of its goal.
const THERE_M: f64 = 0.5;
const ROBOT_THERE_M: f64 = 0.15;

/// What a run shows.
#[derive(Debug, Default)]
struct Shown {
    about: String,
    realised: bool,
    /// Everything that is wrong, in words.
    wrong: Vec<String>,
    /// Driven way by planned way, where the robot arrives.
    share: Option<f64>,
    /// Whether somebody bars the robot's way, or comes up to it, on purpose.
    barred: bool,
}

fn track(recording: &Recording, place: usize) -> Vec<AgentState> {
    (0..recording.ticks()).map(|tick| recording.tick(tick)[place]).collect()
}

fn walked_m(states: &[AgentState]) -> f64 {
    states.windows(2).map(|pair| (pair[1].point() - pair[0].point()).norm()).sum()
}

/// Changes of the sense of turning.
fn turns_to_and_fro(states: &[AgentState]) -> usize {
    let turning: Vec<f64> = states.iter().map(|state| state.omega).filter(|omega| omega.abs() > TURNS_RADPS).collect();
    turning.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count()
}

/// What anybody does after it has come to rest where it is at the end.
fn after_rest(states: &[AgentState]) -> (f64, usize) {
    let end = states[states.len() - 1].point();
    let there_m = if states[0].agent_id() == AgentId::Robot { ROBOT_THERE_M } else { THERE_M };
    let there = states.iter().rposition(|state| (state.point() - end).norm() > there_m).map_or(0, |last| last + 1);
    let rest =
        states[there..].iter().position(|state| state.speed() < AT_REST_MPS).map_or(states.len(), |at| there + at);
    let after = &states[rest..];
    (walked_m(after), turns_to_and_fro(after))
}

fn shown(about: String, location: &Location, played: &Played) -> Shown {
    let recording = &played.recording;
    let way = |agent: AgentId| Polyline::new(&location.graph.polyline(played.paths.of(agent).unwrap_or(&[])));
    let robot_way = way(AgentId::Robot);
    let goal = robot_way.end().unwrap_or_else(Point::origin);
    let (first, last) = (recording.tick(0), recording.tick(recording.ticks() - 1));
    let radius = |place: usize| recording.header.agents[place].radius_m;
    let mut found = Shown { about, ..Shown::default() };
    found.realised = played.report.verdict.to_string().starts_with("realised");
    let on_purpose = |act: &Action| matches!(act, Action::Block | Action::Approach);
    found.barred = played.proposal.humans.iter().any(|human| human.rules.iter().any(|rule| on_purpose(&rule.act)));
    for (place, state) in first.iter().enumerate() {
        for (other, beside) in first.iter().enumerate().skip(place + 1) {
            let gap_m = (state.point() - beside.point()).norm() - radius(place) - radius(other);
            if gap_m < APART_M {
                let pair = format!("{} and {}", state.agent_id(), beside.agent_id());
                found.wrong.push(format!("{pair} start {gap_m:.2} m apart"));
            }
        }
        let states = track(recording, place);
        let (walked_m, flips) = after_rest(&states);
        if walked_m > STAYS_M || flips > 1 {
            found.wrong.push(format!("{} goes {walked_m:.2} m after coming to rest, {flips} flips", state.agent_id()));
        }
        let gap_m = (last[place].point() - goal).norm() - radius(place) - radius(0);
        // Who runs away ends where fear leads, not at the end of a path.
        let flees = |human: &HumanProposal| {
            AgentId::Human(human.id) == state.agent_id() && human.rules.iter().any(|rule| rule.act == Action::RunAway)
        };
        let excused = state.agent_id() == AgentId::Robot || played.proposal.humans.iter().any(flees);
        if !excused && gap_m < APART_M {
            found.wrong.push(format!("{} ends {gap_m:.2} m from the robot's goal", state.agent_id()));
        }
        if state.agent_id() == AgentId::Robot
            && recording.events.iter().any(|event| event.kind == EventKind::RobotArrived)
        {
            let share = self::walked_m(&states) / robot_way.length_m().max(0.1);
            found.share = Some(share);
            if share > LONGEST && !found.barred {
                found.wrong.push(format!("the robot drives {share:.2} times its way"));
            }
        }
    }
    found
}

/// Every card with this number of seeds on the locations that it fits in turn, and every shipped request with half as many.
fn asked(seeds: u64) -> Vec<(String, Request, Location, u64)> {
    let mut found = Vec::new();
    for card in catalog() {
        for (seed, place) in (1..=seeds).zip(cards::places(card).unwrap().into_iter().cycle()) {
            let about = format!("{} in {} with seed {seed}", card.id, place.name);
            found.push((about, cards::request(card, &place.name).unwrap(), place, seed));
        }
    }
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    for prepared in shipped(&config).unwrap() {
        for seed in 1..=seeds / 2 {
            let about = format!("{} with seed {seed}", prepared.name);
            found.push((about, prepared.request.clone(), prepared.location.clone(), seed));
        }
    }
    found
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn everybody_starts_and_ends_apart_stays_at_rest_and_the_robot_keeps_its_way() {
    look_at(asked(1)).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "sweep: 6 seeds of each card, 3 of each shipped request, none with anything wrong"]
async fn everybody_starts_and_ends_apart_over_six_seeds() {
    look_at(asked(6)).await;
}

#[expect(clippy::print_stdout, reason = "a sweep prints its figures")]
async fn look_at(asked: Vec<(String, Request, Location, u64)>) {
    let mut waiting = tokio::task::JoinSet::new();
    for (about, request, location, seed) in asked {
        waiting.spawn(async move {
            let played = play(&request, &location, seed).await.map_err(|faults| format!("{about}: {faults:?}"))?;
            Ok::<Shown, String>(shown(about, &location, &played))
        });
    }
    let (mut all, mut wrong) = (Vec::new(), Vec::new());
    while let Some(done) = waiting.join_next().await {
        match done.unwrap() {
            Ok(run) => {
                wrong.extend(run.wrong.iter().map(|what| format!("{}: {what}", run.about)));
                all.push(run);
            }
            Err(why) => wrong.push(why),
        }
    }
    wrong.sort();
    let realised = all.iter().filter(|run| run.realised).count();
    let mut shares: Vec<f64> = all.iter().filter_map(|run| run.share).collect();
    shares.sort_by(f64::total_cmp);
    println!("{realised} of {} realised at the first try; {}", all.len(), wrong.join("\n"));
    println!("way by planned way: median {:?}, longest {:?}", shares.get(shares.len() / 2), shares.last());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
