//! The search: all candidates in order, and which of them is the answer.

use socrates_model::{Paths, PlaceClass, Proposal, Relation, seeds};

use crate::candidates::{Scene, anywhere, candidates};
use crate::everybody::{Solution, written};
use crate::graph::Net;
use crate::robot_way::Wish;
use crate::{Miss, Problem, Solved, edit, miss, second_meeting};

/// Answers within this much of the best are as good, and the draw picks among them.
const ALIKE: f64 = 2.5;
/// A person who wants other paths is given one of so many.
const OTHERS: usize = 6;

/// The paths of a problem.
///
/// # Errors
/// What does not fit, where on the map and by how much, where the map has no paths for it.
pub fn solve(problem: &Problem<'_>) -> Result<Solved, Miss> {
    let net = Net::of(problem);
    found(problem, &net).map(|paths| Solved { paths }).ok_or_else(|| miss::of(problem, &net))
}

/// The paths, if there are any.
pub(crate) fn found(problem: &Problem<'_>, net: &Net<'_>) -> Option<Paths> {
    let scene = Scene { net, proposal: problem.proposal, layout: problem.layout };
    let told = &problem.told;
    let wish = Wish { via: problem.via, roomy: told.stuck, ..wish(problem.proposal, told.shorts) };
    let mut solutions = candidates(&scene, &wish);
    if solutions.is_empty() {
        // Better another place than no answer; the checks and the person see what became of it.
        solutions = anywhere(&scene, &wish, false);
    }
    if solutions.is_empty() {
        solutions = anywhere(&scene, &wish, true);
    }
    solutions.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| a.route.nodes.cmp(&b.route.nodes)));
    let best = by_place(&solutions);
    let mut paths = written(net, chosen(problem, net, best)?, problem);
    for (human, times) in &told.person_shorts {
        for _ in 0..(*times).min(4) {
            edit::lengthened(net, &mut paths, *human);
        }
    }
    Some(paths)
}

/// The best solution of each meeting node, in order.
fn by_place(solutions: &[Solution]) -> Vec<&Solution> {
    let mut seen: Vec<usize> = Vec::new();
    let mut best: Vec<&Solution> = Vec::new();
    for solution in solutions {
        let node = solution.route.nodes.get(solution.route.meet).copied().unwrap_or(usize::MAX);
        if !seen.contains(&node) {
            seen.push(node);
            best.push(solution);
        }
    }
    best
}

fn chosen<'a>(problem: &Problem<'_>, net: &Net<'_>, mut best: Vec<&'a Solution>) -> Option<&'a Solution> {
    let told = &problem.told;
    if told.another {
        // A person wants others, not the same once more; where there are no others, the same are better than none.
        let others = |solution: &&Solution| {
            told.former.as_ref().is_none_or(|former| net.named(&solution.route.nodes) != former.robot)
        };
        let different: Vec<&Solution> = best.iter().copied().filter(others).collect();
        // The robot still has to get where its task says: the best answer knows where that is.
        let goal = best.first().and_then(|top| top.route.nodes.last());
        let there: Vec<&Solution> =
            different.iter().copied().filter(|other| other.route.nodes.last() == goal).collect();
        best = [there, different, best].into_iter().find(|some| !some.is_empty())?;
    }
    let top = best.first()?.score;
    let alike = best.iter().filter(|solution| solution.score >= top - ALIKE).count();
    let first = match told.moves {
        0 if told.another => seeds::below(problem.draw, best.len().min(OTHERS)),
        0 => seeds::below(problem.draw, alike.clamp(1, 3)),
        // What is wrong with the place moves on to the next meeting node, and so does a simulation in which they did not meet.
        moves => moves,
    };
    best.get(first % best.len()).copied()
}

fn wish(proposal: &Proposal, shorts: u32) -> Wish {
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
        least_m: if twice { second_meeting::LEAST_M } else { 6.5 } + 2.0 * longer,
        aim_m: if twice {
            second_meeting::AIM_M
        } else if along {
            20.0
        } else {
            16.0
        } + 4.0 * longer,
    }
}
