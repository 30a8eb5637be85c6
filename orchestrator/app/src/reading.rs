//! How a request is read, in lines.

use socrates_stream::csv::one_line;

use crate::output::Printer;
use crate::prepare::Prepared;

/// Prints how a request is read.
pub(crate) fn print_reading(talk: &Printer, prepared: &Prepared) {
    talk.line(&format!("reading    {}", socrates_offline::summary(&prepared.reading)));
    talk.line(&format!(
        "planners   {}",
        prepared.request.robot.planners.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    ));
    for (id, model) in &prepared.request.people {
        talk.line(&format!("driven     {id} by {model}, not by the simulation"));
    }
    for statement in &prepared.reading.statements {
        talk.line(&format!("{:<11}\"{}\" → {}", statement.fate(), one_line(&statement.quote), statement.told()));
    }
    for problem in &prepared.reading.problems {
        talk.line(&format!("problem    {problem}"));
    }
    for note in prepared.reading.notes.iter().chain(&prepared.notes) {
        talk.line(&format!("note       {note}"));
    }
}
