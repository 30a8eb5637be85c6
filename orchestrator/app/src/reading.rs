//! How a request is read, in lines.

use crate::output::Printer;
use crate::prepare::Prepared;

/// Prints how a request is read.
pub(crate) fn print_reading(talk: &Printer, prepared: &Prepared) {
    talk.line(&format!("reading    {}", socrates_offline::summary(&prepared.reading)));
    talk.line(&format!(
        "planners   {}",
        prepared.request.robot.planners.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    ));
    for problem in &prepared.reading.problems {
        talk.line(&format!("problem    {problem}"));
    }
    if !prepared.reading.ignored.is_empty() {
        let words: Vec<String> = prepared.reading.ignored.iter().map(|word| format!("\"{word}\"")).collect();
        talk.line(&format!("ignored    {}", words.join(" ")));
    }
    for note in &prepared.reading.notes {
        talk.line(&format!("note       {note}"));
    }
}
