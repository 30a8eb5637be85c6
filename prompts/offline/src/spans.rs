//! Where in the request the words of a problem stand.

use socrates_model::fault::Span;
use socrates_model::statement::TextKey;
use socrates_model::{Fault, Request};

/// Says of every problem of a text of the request where its first quote stands there, if it stands there as it is.
pub(crate) fn mark(request: &Request, problems: &mut [Fault]) {
    for problem in problems {
        let key = TextKey::ALL.into_iter().find(|key| problem.at.is_key(key.name()));
        let text = key.map(|key| key.text_of(request));
        let quoted = text.zip(problem.quotes.first().filter(|quote| !quote.is_empty()));
        let span = quoted.and_then(|(text, quote)| {
            let from = text.find(quote.as_str())?;
            Span::of(text, &(from..from + quote.len()))
        });
        problem.at.span = span.or(problem.at.span);
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::FaultCode;

    use super::*;

    #[test]
    fn a_problem_says_where_its_words_stand() {
        let rough = "In the café a nurse comes towards the robot. Then she sings a song.";
        let request = serde_json::json!({
            "location": "office", "social_context": "", "task": "Drive to the exit", "rough_scenario": rough,
        });
        let request: Request = serde_json::from_value(request).unwrap();
        let mut problems = vec![Fault::new(FaultCode::PRead, "rough_scenario", "not played").about(["sings"])];
        mark(&request, &mut problems);
        let span = problems[0].at.span.unwrap();
        let words: String = rough.chars().skip(span.from as usize).take((span.to - span.from) as usize).collect();
        assert_eq!(words, "sings");
    }
}
