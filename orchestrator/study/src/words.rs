//! The study in words: its preregistration before answers are read, and the methods paragraph of a paper.

use crate::analyze::{Declared, Results};
use crate::design::{Design, Dimension, williams};
use crate::exclude;
use crate::kit::setup::{EYE_M, FIELD_DEGREES, Source, View};
use crate::rating::Origin;

/// What stands before the digest in a preregistration.
const DIGEST: &str = "Digest of the study file (BLAKE3): ";

fn many(count: usize, one: &str, more: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {more}") }
}

/// Number of people who answered, such as `1 person` or `42 simulated people`.
#[must_use]
pub fn people(count: usize, origin: Origin) -> String {
    if origin.is_simulated() {
        many(count, "simulated person", "simulated people")
    } else {
        many(count, "person", "people")
    }
}

/// First paragraph of a text about simulated answers; empty where people gave them.
#[must_use]
pub fn mark(origin: Origin) -> String {
    if origin.is_simulated() { format!("{}\n\n", Origin::MARK) } else { String::new() }
}

/// The text to register: everything that the study file declares, in the order of common templates (data collected yet, hypotheses,
/// variables, conditions, tests, exclusions, sample size). It is made from the study alone.
#[must_use]
pub fn preregistration(design: &Design) -> String {
    let mut out = format!("# Preregistration: {}\n\n{DIGEST}{}\n\n", design.title, design.digest);
    out.push_str("## Have any data been collected?\n\nThis text was made from the study file alone. State here whether data exist.\n\n");
    out.push_str("## Hypotheses\n\n");
    for one in &design.hypotheses {
        let place =
            one.scenario.as_ref().map_or_else(|| "all scenarios".to_owned(), |scenario| format!("scenario {scenario}"));
        out.push_str(&format!("- {} (`{}`, {place})\n", one.text, one.dimension));
    }
    if design.hypotheses.is_empty() {
        out.push_str("None. Every analysis of this study is exploratory.\n");
    }
    out.push_str("\n## Dependent variables\n\n");
    for dimension in design.dimensions() {
        out.push_str(&format!("- {}\n", measure(dimension)));
    }
    out.push_str(&format!("\n## Conditions\n\n{}\n", conditions(design)));
    out.push_str(&format!("\n## Tests\n\n{}\n", tests(design)));
    out.push_str("\nWhat no hypothesis above names is reported as exploratory.\n\n## Exclusions\n\n");
    for (rule, words) in exclude::declared(design) {
        out.push_str(&format!("- `{rule}`: people who {words}\n"));
    }
    out.push_str("\nResults without exclusions are reported beside. Missing ratings stay missing.\n");
    out.push_str(&format!("\n## Sample size\n\n{}\n", sample(design)));
    out
}

/// The digest that a preregistration was made from.
#[must_use]
pub fn registered_digest(text: &str) -> Option<&str> {
    text.lines().find_map(|line| line.strip_prefix(DIGEST)).map(str::trim)
}

fn measure(dimension: Dimension<'_>) -> String {
    let (of, scale) = (dimension.instrument, dimension.scale);
    let items = many(scale.items.len(), "item", "items");
    let reversed = scale.items.iter().filter(|item| item.reversed).count();
    let reversed = if reversed > 0 { format!(", {reversed} reversed") } else { String::new() };
    let kind = if scale.is_single() { " (single item: no reliability is claimed)" } else { "" };
    let valid = if of.validated { "" } else { "; not validated" };
    format!(
        "`{}`: {items}{reversed}, {} to {} points, mean of the answers{kind}; {}{valid}",
        dimension.id(),
        of.points.0,
        of.points.1,
        of.source
    )
}

fn conditions(design: &Design) -> String {
    let within =
        if design.all_scenarios { "Each person sees all scenarios." } else { "Each person sees one scenario." };
    format!(
        "{}: {}; within persons. {}: {}. {within} {}; orders of planners: {} by Williams.",
        many(design.planners.len(), "planner", "planners"),
        design.planners.join(", "),
        many(design.scenarios.len(), "scenario", "scenarios"),
        design.scenarios.join(", "),
        many(design.films.len(), "film", "films"),
        williams(design.planners.len()).len()
    )
}

fn tests(design: &Design) -> String {
    let mut out = format!(
        "For each scenario and scale, planners were compared within persons by Friedman's test (corrected for ties, with Kendall's W) and by a cumulative logit mixed model of the scores with a random intercept per person (intercepts integrated out numerically, to nine digits; odds ratios against {}). Pairs of planners were compared by Wilcoxon's signed-rank test with Pratt's treatment of zeros, p adjusted by Holm over all pairs and scales of a scenario, declared and exploratory ones apart; p by Conover and by Nemenyi stand beside; shifts are Hodges-Lehmann estimates. Means carry 95 % BCa bootstrap intervals ({} resamples of persons, seed {}). Reliability is Cronbach's alpha with Feldt's interval, omega of one factor, and the intraclass correlation of films over persons. The probability of a false alarm is {}.",
        design.planners.first().map_or("the first", String::as_str),
        design.resamples,
        design.seed,
        design.alpha
    );
    if let Some(margin) = design.margin {
        out.push_str(&format!(" Equivalence within {margin} points was tested by two one-sided t tests."));
    }
    out
}

fn sample(design: &Design) -> String {
    format!(
        "{} people per scenario, a multiple of {} orders.",
        design.participants,
        williams(design.planners.len()).len()
    )
}

/// How the study came to be declared, in a sentence.
#[must_use]
pub const fn standing(declared: Declared) -> &'static str {
    match declared {
        Declared::Before => {
            "The study file is the one that was preregistered: tests that a hypothesis names are confirmatory, all others exploratory."
        }
        Declared::Changed => "The study file differs from the preregistered one: all tests are exploratory.",
        Declared::Never => "No preregistration was given: all tests are exploratory.",
    }
}

/// How films were made and what each view cannot show; nothing where the study does not say where its films come from.
fn films(design: &Design) -> String {
    if design.sources.is_empty() {
        return String::new();
    }
    let (above, person): (Vec<&Source>, Vec<&Source>) =
        design.sources.iter().partition(|source| source.view == View::Above);
    let names = |of: &[&Source]| of.iter().map(|source| source.name.as_str()).collect::<Vec<_>>().join(", ");
    let mut out = String::from(
        "Films. Each film shows one simulated run, drawn from its recording at the speed at which it happened, without names, clock or captions. Films of a scenario show the same people with the same seeds, from the same place, begin at the same moment of the run and have the same length; where a run ends earlier, its last picture is held. They carried opaque names. ",
    );
    if !above.is_empty() {
        out.push_str(&format!(
            "Films of {} show the scene from above, with a camera that stands still: robot and people are a square and discs with arrows. Nobody in the scene sees it so: distances and speeds are easier to judge, a robot that comes near is less alarming, and height, sound and looks are absent; ratings of such films need not hold for people beside the robot. ",
            names(&above)
        ));
    }
    for source in person {
        out.push_str(&format!(
            "Films of {} show what {} sees: {} degrees wide, from a height of {} m, in the direction in which that person is turned. Robot, people and walls are simple shapes sized by distance. Who is beside or behind that person is not seen until they come into the field of view; looks, turns of the head, sound and the robot's real body are absent, and it is the view of one of the people. ",
            source.name, source.view, FIELD_DEGREES, EYE_M
        ));
    }
    out.truncate(out.trim_end().len());
    out.push_str("\n\n");
    out
}

/// The methods paragraph.
#[must_use]
pub fn methods(results: &Results, design: &Design) -> String {
    let kept = results.people - results.excluded.len();
    let mut out = mark(results.origin);
    out.push_str(&format!("{}\n\nParticipants. {} answered", design.title, people(results.people, results.origin)));
    if results.excluded.is_empty() {
        out.push_str("; nobody was excluded. ");
    } else {
        let rules: Vec<String> = exclude::declared(design)
            .into_iter()
            .filter_map(|(rule, words)| {
                let count = results.excluded.values().filter(|broken| broken.contains(&rule)).count();
                (count > 0).then(|| format!("{count} {words}"))
            })
            .collect();
        out.push_str(&format!(
            "; {} were excluded by rules that the study declares ({}; a person may break several), which leaves {kept}. ",
            results.excluded.len(),
            rules.join("; ")
        ));
    }
    let (given, missing) = results.ratings;
    out.push_str(&format!(
        "They gave {given} ratings; {missing} are missing and take part in no figure. Planned were {}\n\n",
        sample(design)
    ));
    out.push_str(&format!("Design. {}\n\n{}Measures. ", conditions(design), films(design)));
    out.push_str(&design.dimensions().into_iter().map(measure).collect::<Vec<_>>().join(". "));
    out.push_str(&format!(".\n\nAnalysis. {} {}\n\n", tests(design), standing(results.declared)));
    out.push_str("Limits. Inference is to the films that were shown; where a planner has one film in a scenario, film and planner cannot be told apart. What is rated from a film need not be what people feel beside the robot.\n");
    out
}
