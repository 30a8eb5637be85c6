//! Which variants of a request are made: different ones, spread over what the request leaves open.
//!
//! ```text
//! seeds one after the other ─► proposal and paths, in this process ─► likeness ─► different ones ─► the farthest from all before
//! ```
//!
//! Only rules can be asked beforehand: they answer in milliseconds and always the same. What a language model will write is not
//! known; its variants are made by seeds one after the other, and repeats are named afterwards.

use socrates_model::likeness::Likeness;
use socrates_model::{AuthorSpec, Role};

use crate::exit::Diagnostic;
use crate::output::Printer;
use crate::prepare::Prepared;
use crate::{cores, in_process};

/// Draws of a round: after each it is asked whether there may be more different ones.
const ROUND: usize = 64;
/// Draws of a request, at most: so many, and so many for each variant that is wanted.
const DRAWS: usize = 1024;
const DRAWS_EACH: usize = 4;
/// Different ones that are kept for each that is wanted, so that there is something to choose from.
const CHOICE: usize = 2;
/// The search ends when so much of what is estimated to exist was found.
const FOUND: f64 = 0.95;
/// Variants that are chosen as far from each other as they can be; what comes after them is taken in the order of the draws.
const SPREAD: usize = 512;

/// The variants of a request.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    /// Base seeds of the scenarios, in the order in which they are made.
    pub(crate) seeds: Vec<u64>,
    /// What is known of how many there are; nothing where the author cannot be asked beforehand.
    pub(crate) known: Option<Known>,
}

/// How many different variants a request has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Known {
    /// Different ones that were found.
    pub(crate) different: usize,
    /// Draws that found them.
    pub(crate) draws: usize,
    /// Whether hardly any are left to be found.
    pub(crate) whole: bool,
    /// How many there are in all, as far as those that came once and twice tell: those that were found, or more.
    pub(crate) estimated: usize,
}

impl Plan {
    /// The seeds one after the other.
    fn in_turn(seed: u64, count: u32) -> Self {
        Self { seeds: (0..u64::from(count)).map(|index| seed.wrapping_add(index)).collect(), known: None }
    }

    /// What is said of it before anything is made.
    fn told(&self, name: &str, wanted: u32) -> String {
        let Some(known) = self.known else {
            return format!(
                "variants   {name}: {wanted} by seeds; which of them repeat another is known when they are made"
            );
        };
        let Known { different, draws, whole, estimated } = known;
        let there = if whole {
            format!("{different} different ones")
        } else {
            format!("about {estimated} different ones, {different} of them found")
        };
        format!("variants   {name}: {there} in {draws} draws · {} of {wanted} are made", self.seeds.len())
    }
}

/// The variants of each request, said beforehand where there are several; `repeats` where every seed is taken in turn.
///
/// # Errors
/// The runtime of a thread cannot be started.
pub(crate) fn plans<'a>(
    talk: &Printer,
    prepared: impl Iterator<Item = &'a Prepared>,
    seed: u64,
    repeats: bool,
) -> Result<Vec<Plan>, Diagnostic> {
    let mut plans = Vec::new();
    for one in prepared {
        let wanted = one.request.run.variants;
        let plan = if wanted > 1 && !repeats { plan(one, seed)? } else { Plan::in_turn(seed, wanted) };
        if wanted > 1 && !repeats {
            talk.line(&plan.told(&one.name, wanted));
        }
        plans.push(plan);
    }
    Ok(plans)
}

/// Whether the author of a request is rules that are asked as they always are.
fn is_foreseen(prepared: &Prepared) -> bool {
    let pinned = [Role::Proposal, Role::Paths].iter().any(|role| prepared.pins.contains_key(role));
    let plain = prepared.injected.is_empty() && prepared.style.is_empty();
    prepared.author == AuthorSpec::Offline && plain && !pinned && !prepared.looked_at
}

/// The variants of a request that wants several.
fn plan(prepared: &Prepared, seed: u64) -> Result<Plan, Diagnostic> {
    let wanted = prepared.request.run.variants;
    if !is_foreseen(prepared) {
        return Ok(Plan::in_turn(seed, wanted));
    }
    let count = usize::try_from(wanted).unwrap_or(usize::MAX);
    let draw = |number: usize| drawn(prepared, seed.wrapping_add(u64::try_from(number).unwrap_or(0)));
    let (found, known) = different(count, &draw);
    // A request of which nothing can be drawn is made once, so that its faults are seen.
    let seeds = if found.is_empty() {
        vec![seed]
    } else {
        spread(&found, count).into_iter().map(|number| seed.wrapping_add(number)).collect()
    };
    Ok(Plan { seeds, known: Some(known) })
}

/// What the scenario of a seed will be; nothing where the author cannot write it.
fn drawn(prepared: &Prepared, seed: u64) -> Option<Likeness> {
    let runtime = tokio::runtime::Builder::new_current_thread().build().ok()?;
    let written = in_process::foresee(&prepared.request, &prepared.reading, &prepared.location, seed);
    let (proposal, paths) = runtime.block_on(written).ok()?;
    Some(Likeness::of(&proposal, &paths, &prepared.location))
}

/// A different one: the number of its draw, what it is like, and how often it came.
#[derive(Debug, Clone)]
struct Different {
    draw: usize,
    likeness: Likeness,
    hits: usize,
}

/// Draws until hardly anything new can come, or until there is enough to choose from.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a few thousand draws, counted from 0"
)]
fn different(wanted: usize, draw: &(dyn Fn(usize) -> Option<Likeness> + Sync)) -> (Vec<Different>, Known) {
    let most = DRAWS.saturating_add(wanted.saturating_mul(DRAWS_EACH));
    let mut found: Vec<Different> = Vec::new();
    let mut draws = 0;
    loop {
        let round = cores::each(ROUND, |number| draw(draws + number), &mut |_| ());
        for (number, likeness) in round.into_iter().enumerate() {
            let Some(likeness) = likeness else { continue };
            match found.iter_mut().find(|one| one.likeness.repeats(&likeness)) {
                Some(one) => one.hits += 1,
                None => found.push(Different { draw: draws + number, likeness, hits: 1 }),
            }
        }
        draws += ROUND;
        let estimated = estimated(&found);
        let whole = found.len() as f64 >= FOUND * estimated;
        let enough = found.len() >= wanted.saturating_mul(CHOICE).max(ROUND);
        if whole || enough || draws >= most {
            let estimated = (estimated as usize).max(found.len());
            return (found.clone(), Known { different: found.len(), draws, whole, estimated });
        }
    }
}

/// How many there are: those seen once and twice tell how many were never seen (Chao 1984, `S = d + f1 (f1 - 1) / 2 (f2 + 1)`).
#[expect(clippy::cast_precision_loss, reason = "a few thousand draws")]
fn estimated(found: &[Different]) -> f64 {
    let seen = |times: usize| found.iter().filter(|one| one.hits == times).count() as f64;
    let (once, twice, all) = (seen(1), seen(2), found.len() as f64);
    all + once * (once - 1.0).max(0.0) / (2.0 * (twice + 1.0))
}

/// Draws of so many of them: the first, then each time the one that is farthest from all before it.
fn spread(found: &[Different], wanted: usize) -> Vec<u64> {
    let mut near: Vec<f64> = vec![f64::INFINITY; found.len()];
    let mut chosen: Vec<usize> = Vec::new();
    let mut next = (!found.is_empty()).then_some(0);
    while let Some(at) = next.filter(|_| chosen.len() < wanted.min(SPREAD)) {
        chosen.push(at);
        let Some(one) = found.get(at) else { break };
        for (away, other) in near.iter_mut().zip(found) {
            *away = away.min(one.likeness.distance(&other.likeness));
        }
        let open = near.iter().enumerate().filter(|(number, _)| !chosen.contains(number));
        // Of those that are as far the earliest draw.
        next = open.max_by(|(a, x), (b, y)| x.total_cmp(y).then_with(|| b.cmp(a))).map(|(number, _)| number);
    }
    let rest: Vec<usize> = (0..found.len()).filter(|number| !chosen.contains(number)).collect();
    let left = wanted.saturating_sub(chosen.len());
    chosen.extend(rest.into_iter().take(left));
    chosen.iter().filter_map(|at| found.get(*at)).map(|one| u64::try_from(one.draw).unwrap_or(0)).collect()
}

#[cfg(test)]
mod tests;
