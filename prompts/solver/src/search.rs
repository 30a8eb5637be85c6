//! The search: all candidates in order, which of them are different answers, and which is the answer.

use std::collections::BTreeSet;

use socrates_model::{PlaceClass, Proposal, Relation, seeds};

use crate::breadth::Limits;
use crate::candidates::{Scene, candidates};
use crate::cost::FARTHEST;
use crate::everybody::{Solution, written};
use crate::graph::Net;
use crate::people::Way;
use crate::robot_way::{LEAST_M, Wish, missing_m, times_shortest};
use crate::{Miss, Problem, Solved, edit, miss, named_way, second_meeting, through_door};

/// Two solutions differ when the place of the meeting, or an end of the robot's way, lies so far elsewhere, m.
const ELSEWHERE_M: f64 = 3.0;
/// Additional length of the way for each person who meets the robot elsewhere, of three at most, m.
const ELSEWHERE_AIM_M: f64 = 6.0;
/// Different solutions that are put in order, at most.
const ALTERNATIVES: usize = 64;
/// A person who wants other paths is given one of so many.
const OTHERS: usize = 6;
/// Meeting nodes that are tried where the way leads past a place by name, and ends of each branch of them.
const PAST_NODES: usize = 40;
const PAST_ENDS: usize = 20;
/// Solutions whose way is held against the grid, at most, before the graph is believed.
const CHECKED: usize = 24;

/// The paths of a problem.
///
/// # Errors
/// What does not fit, where on the map and by how much, where the map has no paths for it.
pub fn solve(problem: &Problem<'_>) -> Result<Solved, Miss> {
    // Where the map has no ways as the doors ask for them, those without are better than none.
    let led = through_door::led(problem);
    led.and_then(|led| solve_as(&led.problem(problem)).ok()).map_or_else(|| solve_as(problem), Ok)
}

fn solve_as(problem: &Problem<'_>) -> Result<Solved, Miss> {
    let net = Net::of(problem);
    if let Some(miss) = miss::beforehand(problem, &net) {
        return Err(miss);
    }
    let solutions = solutions(problem, &net);
    let alternatives = alternatives(problem, &net, &solutions);
    let Some(chosen) = chosen(problem, &net, &solutions, &alternatives) else { return Err(miss::of(problem, &net)) };
    let told = |solution: &Solution| {
        let mut paths = written(&net, solution, problem);
        for (human, times) in &problem.told.person_shorts {
            for _ in 0..(*times).min(4) {
                edit::lengthened(&net, &mut paths, *human);
            }
        }
        paths
    };
    Ok(Solved { paths: told(chosen), alternatives: alternatives.into_iter().take(ALTERNATIVES).map(told).collect() })
}

/// Every solution, the best first.
pub(crate) fn solutions(problem: &Problem<'_>, net: &Net<'_>) -> Vec<Solution> {
    let mut limits = Limits::of(problem.breadth);
    // Few ways lead past a place by name: more are tried.
    if !net.past.is_empty() {
        (limits.nodes, limits.ends) = (limits.nodes.max(PAST_NODES), limits.ends.max(PAST_ENDS));
    }
    let scene = Scene { net, proposal: problem.proposal, layout: problem.layout, crowded: false, limits };
    let told = &problem.told;
    let wish = Wish { via: problem.via, roomy: told.stuck, ..wish(problem.proposal, told.shorts, limits.ends) };
    let mut solutions = candidates(&scene, &wish);
    if solutions.is_empty() {
        solutions = candidates(&Scene { crowded: true, ..scene }, &wish);
    }
    if named_way::is_asked(problem.proposal) {
        solutions.retain(|solution| named_way::keeps(net, problem.proposal, &solution.route.nodes));
    }
    solutions.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| a.route.nodes.cmp(&b.route.nodes)));
    solutions
}

/// Where the meeting, the start and the goal of the robot lie.
fn corners(solution: &Solution) -> [usize; 3] {
    let nodes = &solution.route.nodes;
    let at = |node: Option<&usize>| node.copied().unwrap_or(usize::MAX);
    [at(nodes.get(solution.route.meet)), at(nodes.first()), at(nodes.last())]
}

/// What tells a solution from others: where it plays, and in a wide search from where each comes to the meeting.
fn key(solution: &Solution, limits: &Limits) -> ([usize; 3], Vec<Option<usize>>) {
    let sides = solution.ways.values().map(Way::entry).take(if limits.wide { usize::MAX } else { 0 });
    (corners(solution), sides.collect())
}

/// Whether the robot's way is far longer than the shortest on the graph.
fn is_detour(problem: &Problem<'_>, net: &Net<'_>, solution: &Solution) -> bool {
    times_shortest(net, &solution.route.nodes, problem.via) > FARTHEST
}

/// Whether the robot's way is a detour neither on the graph nor on the floor. Where the task's own ends leave only detours (the best
/// of all is one) the floor has nothing to say.
fn is_natural(problem: &Problem<'_>, net: &Net<'_>, best: &Solution, solution: &Solution) -> bool {
    is_detour(problem, net, best)
        || !is_detour(problem, net, solution) && net.is_short_on_grid(&solution.route.nodes, problem.radius_m)
}

/// Somebody who comes towards the robot is seen to where neither turns so near to the meeting, m, by more than this cosine.
const FACING_M: f64 = 2.5;
const FACING: f64 = 0.7;

/// How many turns of the robot's way lie so near to the meeting, beside it, that who comes towards the robot comes round a corner.
fn turns_near(problem: &Problem<'_>, net: &Net<'_>, solution: &Solution) -> usize {
    let towards = problem.proposal.humans.iter().any(|human| human.relation == Relation::Frontal);
    if !towards || problem.proposal.place == PlaceClass::BlindCorner {
        return 0;
    }
    let (nodes, meet) = (&solution.route.nodes, solution.route.meet);
    let near = |at: usize| net.length_m(nodes.get(at.min(meet)..=at.max(meet)).unwrap_or_default()) < FACING_M;
    let turns = nodes.windows(3).enumerate().filter(|(before, three)| {
        let turn = matches!(three, [a, b, c] if net.straight(*a, *b, *c) < FACING);
        turn && before + 1 != meet && near(before + 1)
    });
    turns.count()
}

/// How far elsewhere the one of two solutions plays, m.
fn apart_m(net: &Net<'_>, one: &Solution, other: &Solution) -> f64 {
    let pairs = corners(one).into_iter().zip(corners(other));
    pairs.map(|(a, b)| (net.at(a) - net.at(b)).norm()).fold(0.0, f64::max)
}

/// Different solutions that are as good as the best: the best first, then each time the one that is farthest from all before it; in
/// a wide search all of them as they come.
fn alternatives<'a>(problem: &Problem<'_>, net: &Net<'_>, solutions: &'a [Solution]) -> Vec<&'a Solution> {
    let limits = Limits::of(problem.breadth);
    let best = solutions.first();
    let natural = |solution: &Solution| best.is_some_and(|best| is_natural(problem, net, best, solution));
    // The graph may lead a long way round where the floor is open; where all do, the best is as good as any.
    let Some(first) = solutions.iter().take(CHECKED).find(|solution| natural(solution)).or_else(|| solutions.first())
    else {
        return Vec::new();
    };
    // Another place is no reason to set off right before it, or to end right behind it, where the best does not.
    // Two meetings with one person are timed one by the other: the best is taken.
    let alike = if first.again.is_empty() { limits.alike } else { 0.0 };
    let as_good = |solution: &&Solution| {
        solution.score >= first.score - alike
            && solution.strain <= first.strain + limits.strained
            && missing_m(net, &solution.route) <= missing_m(net, &first.route) + limits.short_m + 1e-9
            && (!limits.wide || turns_near(problem, net, solution) <= turns_near(problem, net, first))
    };
    let mut pool: Vec<(&Solution, f64)> = Vec::new();
    let mut known = BTreeSet::from([key(first, &limits)]);
    for solution in solutions.iter().filter(as_good).take(limits.pool) {
        if known.insert(key(solution, &limits)) {
            pool.push((solution, apart_m(net, first, solution)));
        }
    }
    let mut found = vec![first];
    if limits.wide {
        // Which of them is no detour on the floor is asked of the one that is drawn.
        found.extend(pool.into_iter().map(|(solution, _)| solution));
        return found;
    }
    while found.len() < ALTERNATIVES {
        let far = pool.iter().enumerate().filter(|(_, (_, m))| *m > ELSEWHERE_M);
        let Some((at, _)) = far.max_by(|(i, a), (j, b)| a.1.total_cmp(&b.1).then(j.cmp(i))) else { break };
        let (next, _) = pool.remove(at);
        if !natural(next) {
            continue;
        }
        for (other, m) in &mut pool {
            *m = m.min(apart_m(net, next, other));
        }
        found.push(next);
    }
    found
}

/// The best solution of each meeting node, in order.
fn by_place(solutions: &[Solution]) -> Vec<&Solution> {
    let mut seen: Vec<usize> = Vec::new();
    let mut best: Vec<&Solution> = Vec::new();
    for solution in solutions {
        let [node, ..] = corners(solution);
        if !seen.contains(&node) {
            seen.push(node);
            best.push(solution);
        }
    }
    best
}

/// The answer: one of those that are as good, by the draw; another than those that were refused.
fn chosen<'a>(
    problem: &Problem<'_>,
    net: &Net<'_>,
    solutions: &'a [Solution],
    alternatives: &[&'a Solution],
) -> Option<&'a Solution> {
    let told = &problem.told;
    let wide = Limits::of(problem.breadth).wide;
    let best = solutions.first()?;
    let at = seeds::below(problem.draw, alternatives.len());
    let mut drawn = alternatives.iter().cycle().skip(at).take(alternatives.len());
    let natural = drawn.find(|solution| !wide || is_natural(problem, net, best, solution));
    let first = natural.or_else(|| alternatives.first()).copied()?;
    if told.another {
        // A person wants others, not the same once more; where there are no others, the same are better than none.
        let others = |solution: &&Solution| {
            told.former.as_ref().is_none_or(|former| net.named(&solution.route.nodes) != former.robot)
        };
        let best = by_place(solutions);
        let different: Vec<&Solution> = best.iter().copied().filter(others).collect();
        // The robot still has to get where its task says: the best answer knows where that is.
        let goal = best.first().and_then(|top| top.route.nodes.last());
        let there: Vec<&Solution> =
            different.iter().copied().filter(|other| other.route.nodes.last() == goal).collect();
        let best = [there, different, best].into_iter().find(|some| !some.is_empty())?;
        let at = if told.moves > 0 { told.moves } else { seeds::below(problem.draw, best.len().min(OTHERS)) };
        return best.get(at % best.len()).copied();
    }
    let Some(passed) = told.moves.checked_sub(1) else { return Some(first) };
    // Faults of the place moves on to the next meeting node, and so does a simulation in which they did not meet.
    let [node, ..] = corners(first);
    // Of many that are as good the draw takes one again.
    let mut others: Vec<&Solution> = if wide { alternatives.to_vec() } else { by_place(solutions) };
    let passed = if wide { passed.saturating_add(at) } else { passed };
    others.retain(|solution| corners(solution).first() != Some(&node));
    if others.is_empty() { Some(first) } else { others.get(passed % others.len()).copied() }
}

fn wish(proposal: &Proposal, shorts: u32, ends: usize) -> Wish {
    let has = |relation: Relation| proposal.humans.iter().any(|human| human.relation == relation);
    let straight = if proposal.place == PlaceClass::BlindCorner {
        -1.0
    } else if has(Relation::Frontal)
        || has(Relation::Crossing)
        || has(Relation::Ahead)
        || proposal.groups.iter().any(|group| group.standing)
    {
        1.0
    } else {
        0.3
    };
    let longer = f64::from(shorts.min(4));
    let elsewhere = proposal.humans.iter().filter(|human| proposal.own_place(human.id).is_some()).count().min(3);
    let twice = !second_meeting::asked(proposal).is_empty();
    // Followers and overtakers need a longer way to show what they do.
    let along = has(Relation::Behind) || has(Relation::Ahead) || has(Relation::Abreast);
    Wish {
        start: proposal.robot.start,
        goal: proposal.robot.goal,
        place: proposal.place,
        via: None,
        roomy: false,
        indoors: proposal.place == PlaceClass::Room,
        straight,
        least_m: if twice { second_meeting::LEAST_M } else { LEAST_M } + 2.0 * longer,
        aim_m: if twice {
            second_meeting::AIM_M
        } else if along {
            20.0
        } else {
            16.0
        } + 4.0 * longer
            + ELSEWHERE_AIM_M * elsewhere as f64,
        ends,
    }
}
