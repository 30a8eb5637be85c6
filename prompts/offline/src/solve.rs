//! The paths question as a problem of geometry: what task, text and card ask for, without their words.

use socrates_model::{Paths, Proposal};
use socrates_prompts::Question;
use socrates_solver::{Layout, Miss, Problem, Told};

use crate::card::card;
use crate::draw::Draw;
use crate::name::NAME;
use crate::{form, spot, task};

/// Answers a paths question.
///
/// # Errors
/// What the map lacks for the paths, and by how much.
pub fn solve(question: &Question, proposal: &Proposal) -> Result<Paths, Miss> {
    socrates_solver::solve(&problem(question, proposal)).map(|solved| solved.paths)
}

/// What is to be solved.
pub(crate) fn problem<'a>(question: &'a Question, proposal: &'a Proposal) -> Problem<'a> {
    let task = task::read(&question.request.task, &question.location);
    let former = question.refused.as_deref().and_then(|text| serde_json::from_str::<Paths>(text).ok());
    let told = Told::of(&question.feedback, former, proposal);
    let (request, location) = (&question.request, &question.location);
    let stated = |place| form::robot_end(place, location);
    let goals = spot::ends(question, &task.goals, proposal.robot.goal, true);
    let mut starts = spot::ends(question, &task.starts, proposal.robot.start, false);
    // A story in which both ends are one place names where the way ends: only a task says from where to where.
    let from_to = [&task.starts, &task.goals].iter().all(|ends| !task::nodes(ends).is_empty());
    if starts == goals && !from_to {
        starts.clear();
    }
    let goals = stated(request.robot.goal.as_ref()).unwrap_or(goals);
    let starts = stated(request.robot.start.as_ref()).unwrap_or(starts);
    let via = request.robot.via.as_ref().and_then(|place| form::bound(place, location)).map(|bound| bound.class);
    let purpose = if told.another { "other paths" } else { "paths" };
    Problem {
        proposal,
        location: &question.location,
        starts,
        goals,
        radius_m: question.request.robot.model.radius_m,
        via: via.or_else(|| task.via.map(|(class, _)| class)),
        rooms: if request.form.is_empty() { spot::rooms(question) } else { form::rooms(request, location) },
        ends: form::ends(request, location),
        layout: layout(&proposal.pattern),
        told,
        draw: Draw::new(question.seed, purpose).bits(),
        breadth: question.request.run.breadth,
        author: NAME.into(),
    }
}

/// What the card of a pattern wants of the place and of the robot's way; nothing where the pattern is no card.
#[must_use]
pub fn layout(pattern: &str) -> Layout {
    card(pattern).map_or_else(Layout::default, |card| Layout {
        ends: card.ends,
        start: card.start,
        arms: card.arms,
        width_m: card.width_m,
    })
}
