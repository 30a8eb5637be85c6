//! A request beside its texts: what it states exactly, and where the grammar disagrees with an author that reads the texts itself.

use socrates_model::reading::ReadBy;
use socrates_model::statement::{Background, Became, Statement, TextKey};
use socrates_model::{Fact, FactKind, Fault, FaultCode, GroupId, HumanId, Location, Reading, Request};

use crate::understand::{shortened, understood};

/// What a request states in its form, under `[expect]` and under `[robot]`, and nothing of its texts: what binds an author that reads the
/// texts itself.
#[must_use]
pub fn stated(request: &Request, location: &Location) -> Reading {
    let bare = Request {
        rough_scenario: None,
        task: String::new(),
        social_context: String::new(),
        waive: Vec::new(),
        ..request.clone()
    };
    let mut reading = understood(&bare, location, false).reading;
    reading.by = ReadBy::Author;
    reading.task = shortened(&request.task);
    // They tell what a missing text is taken for.
    reading.notes.clear();
    if request.form.is_empty() {
        expected(request, &mut reading);
    }
    reading
}

/// Numbers and groups of `[expect]`, which need no text to be about.
fn expected(request: &Request, reading: &mut Reading) {
    let mut put = |quote: String, kind: FactKind| {
        if !reading.facts.iter().any(|fact| fact.kind == kind) {
            let id = format!("f{}", reading.facts.len() + 1);
            reading.facts.push(Fact { id, quote, kind });
        }
    };
    if let Some(count) = request.expect.humans {
        put(format!("expect.humans = {count}"), FactKind::Humans(count));
    }
    for (place, numbers) in request.expect.groups.iter().enumerate() {
        let group = GroupId(u32::try_from(place + 1).unwrap_or(u32::MAX));
        let members = numbers.iter().map(|number| HumanId::new(*number)).collect();
        put(format!("expect.groups = {numbers:?}"), FactKind::Group { group, members });
    }
}

/// Marks what an author calls background and the grammar reads as something that is done: a person has to say which is right. Where the
/// grammar does not know the language, the reading says that nothing was held against it.
pub fn dispute(request: &Request, location: &Location, reading: &mut Reading) {
    let text = Request { form: socrates_model::form::Form::default(), ..request.clone() };
    let known = understood(&text, location, true).reading;
    if known.problems.iter().any(|problem| problem.code == FaultCode::PLang) {
        reading.by = ReadBy::AuthorAlone;
        return;
    }
    let background = |statement: &Statement| matches!(statement.became, Became::Background(_));
    // What the robot is sent to, and the map lacks, is no mere errand.
    for statement in reading.statements.iter_mut().filter(|statement| background(statement)) {
        let found = lacking(&known.problems, statement);
        statement.became = disputed(statement.became.clone(), found);
    }
    // So is what is said to be stated already, of which only groups and numbers can be.
    let bare = |statement: &Statement| matches!(&statement.became, Became::Read { facts, .. } if facts.is_empty());
    let doubtful =
        |statement: &Statement| statement.at == TextKey::RoughScenario && (background(statement) || bare(statement));
    // To account for every clause takes far longer than to read them.
    if !reading.statements.iter().any(doubtful) {
        return;
    }
    let grammar = crate::read(&text, location);
    for statement in reading.statements.iter_mut().filter(|statement| doubtful(statement)) {
        let found = acts(&grammar, statement, bare(statement));
        statement.became = disputed(statement.became.clone(), found);
    }
}

/// Background, or what is said to be stated, in which something was found.
fn disputed(became: Became, found: Vec<String>) -> Became {
    match became {
        Became::Background(reason) if !found.is_empty() => Became::Disputed { reason, found },
        Became::Read { facts, .. } if facts.is_empty() && !found.is_empty() => {
            Became::Disputed { reason: Background::Setting, found }
        }
        Became::Background(_)
        | Became::Read { .. }
        | Became::NotPlayed { .. }
        | Became::Disputed { .. }
        | Became::NotRead { .. } => became,
    }
}

/// What a statement of the task speaks of and no run on the map shows, and why.
fn lacking(problems: &[Fault], statement: &Statement) -> Vec<String> {
    let own = |problem: &&Fault| {
        statement.at == TextKey::Task
            && problem.at.is_key(TextKey::Task.name())
            && problem.at.span.is_some_and(|span| span.overlaps(statement.span))
    };
    problems.iter().filter(own).map(|problem| problem.message.to_string()).collect()
}

/// What the grammar reads in the words of a statement of somebody's doing, as lines of a form; `beyond` who stands or goes how, which comes with
/// a group that is stated.
fn acts(grammar: &Reading, statement: &Statement, beyond: bool) -> Vec<String> {
    let stands = |fact: &&Fact| !fact.quote.is_empty() && statement.quote.contains(&fact.quote);
    let counts = |kind: &FactKind| is_act(kind) && !(beyond && matches!(kind, FactKind::Relates { .. }));
    if !grammar.facts.iter().filter(stands).any(|fact| counts(&fact.kind)) {
        return Vec::new();
    }
    let own = grammar.statements.iter().filter(|other| other.meets(statement.at, statement.span));
    own.map(|other| &other.became)
        .filter_map(|became| if let Became::Read { lines, .. } = became { Some(lines.clone()) } else { None })
        .flatten()
        .collect()
}

/// Whether a fact is something that somebody does.
const fn is_act(kind: &FactKind) -> bool {
    match kind {
        FactKind::Reacts { .. }
        | FactKind::Relates { .. }
        | FactKind::MeetsTimes { .. }
        | FactKind::Before { .. }
        | FactKind::Gestures { .. }
        | FactKind::GesturesTo { .. }
        | FactKind::Goal { .. }
        | FactKind::MeetsAt { .. }
        | FactKind::RobotSays(_)
        | FactKind::RobotDoes(_) => true,
        FactKind::Humans(_)
        | FactKind::Group { .. }
        | FactKind::Side { .. }
        | FactKind::Facing { .. }
        | FactKind::Pace { .. }
        | FactKind::Place(_)
        | FactKind::RobotTask(_)
        | FactKind::RobotStart(_)
        | FactKind::RobotGoal(_)
        | FactKind::RobotAt { .. }
        | FactKind::Asked { .. }
        | FactKind::Pattern(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(rough: &str) -> Request {
        let request = serde_json::json!({"location": "office", "social_context": "A busy day", "task": "Drive to the exit",
            "rough_scenario": rough});
        serde_json::from_value(request).unwrap()
    }

    fn office() -> Location {
        socrates_maps::shipped::load("office").unwrap()
    }

    /// Every sentence called background.
    fn called_background(request: &Request) -> Reading {
        let statement = |sentence: socrates_prompts::Sentence| Statement {
            at: sentence.at,
            span: sentence.span,
            quote: sentence.quote,
            became: Became::Background(Background::Setting),
            waived: false,
        };
        let statements = socrates_prompts::sentences(request).into_iter().map(statement).collect();
        Reading { statements, ..stated(request, &office()) }
    }

    #[test]
    fn nothing_of_the_texts_is_stated() {
        let mut asked = request("Two nurses come towards the robot at a doorway and wave.");
        let reading = stated(&asked, &office());
        assert_eq!((&reading.facts[..], &reading.problems[..], &reading.notes[..]), (&[][..], &[][..], &[][..]));
        assert_eq!((reading.by, reading.task.as_str()), (ReadBy::Author, "Drive to the exit"));
        asked.expect.humans = Some(3);
        asked.expect.groups = vec![vec![1, 3]];
        let kinds: Vec<FactKind> = stated(&asked, &office()).facts.into_iter().map(|fact| fact.kind).collect();
        let group = FactKind::Group { group: GroupId(1), members: vec![HumanId::new(1), HumanId::new(3)] };
        assert_eq!(kinds, [FactKind::Humans(3), group]);
    }

    #[test]
    fn what_a_form_states_binds() {
        let text = "location = \"office\"\nsocial_context = \"\"\ntask = \"Drive\"\n[[human]]\nrelation = \"frontal\"\nplace = \"corridor\"\n";
        let request = Request::of_toml(text, None).unwrap();
        let facts = stated(&request, &office()).facts;
        assert!(facts.iter().any(|fact| fact.kind == FactKind::Humans(1)), "{facts:?}");
        assert!(facts.iter().any(|fact| matches!(fact.kind, FactKind::Relates { .. })), "{facts:?}");
    }

    #[test]
    fn background_in_which_somebody_acts_is_disputed_and_other_background_is_not() {
        let asked = request("It is a quiet morning. A visitor comes towards the robot and stops.");
        let mut reading = called_background(&asked);
        dispute(&asked, &office(), &mut reading);
        let fates: Vec<&str> = reading.statements.iter().map(Statement::fate).collect();
        assert_eq!(fates, ["background", "disputed", "background", "background"], "{:?}", reading.statements);
        assert_eq!(reading.by, ReadBy::Author);
        assert_eq!(reading.missing(), ["A visitor comes towards the robot and stops."]);
    }

    #[test]
    fn what_is_said_to_be_stated_is_disputed_where_somebody_acts() {
        let asked = request("Two people stand together in a group. When they see the robot, one of them runs away.");
        let mut reading = called_background(&asked);
        for statement in &mut reading.statements {
            statement.became = Became::Read { lines: Vec::new(), facts: Vec::new() };
        }
        dispute(&asked, &office(), &mut reading);
        assert_eq!(reading.missing(), ["When they see the robot, one of them runs away."]);
    }

    #[test]
    fn an_errand_to_a_place_that_the_map_lacks_is_disputed() {
        for (task, missing) in [("Bring paper to the printer room", 1), ("Bring paper to the kitchen", 0)] {
            let asked = Request { task: task.to_owned(), ..request("A visitor comes towards the robot.") };
            let mut reading = called_background(&asked);
            reading.statements.retain(|statement| statement.at == TextKey::Task);
            dispute(&asked, &office(), &mut reading);
            assert_eq!(reading.missing().len(), missing, "{task}: {:?}", reading.statements);
        }
    }

    #[test]
    fn a_language_that_the_grammar_does_not_know_is_not_held_against_it() {
        let asked = request("Eine Besucherin kommt dem Roboter entgegen und bleibt dann stehen.");
        let mut reading = called_background(&asked);
        dispute(&asked, &office(), &mut reading);
        assert_eq!(reading.by, ReadBy::AuthorAlone);
        assert!(reading.missing().is_empty());
    }
}
