//! Where in the request the words of a problem stand.

use socrates_model::fault::{Span, Where};
use socrates_model::{Fault, Request};

/// Says of every problem of a text of the request where its first quote stands there, if it stands there as it is.
pub(crate) fn mark(request: &Request, problems: &mut [Fault]) {
    let texts = [
        ("rough_scenario", request.rough_scenario.as_deref().unwrap_or_default()),
        ("task", request.task.as_str()),
        ("social_context", request.social_context.as_str()),
    ];
    for problem in problems {
        let text = texts.iter().find(|(key, _)| problem.at == Where::key(key));
        let span = text.zip(problem.quotes.first()).and_then(|((_, text), quote)| span(text, quote));
        problem.at.span = span.or(problem.at.span);
    }
}

fn span(text: &str, quote: &str) -> Option<Span> {
    let before = text.get(..text.find(quote).filter(|_| !quote.is_empty())?)?.chars().count();
    let (from, to) = (u32::try_from(before).ok()?, u32::try_from(before + quote.chars().count()).ok()?);
    Some(Span { from, to })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_says_where_its_words_stand() {
        let rough = "In the café a nurse comes towards the robot. Then she sings a song.";
        let request = serde_json::json!({
            "location": "office", "social_context": "", "task": "Drive to the exit", "rough_scenario": rough,
        });
        let request: Request = serde_json::from_value(request).unwrap();
        let location = socrates_maps::shipped::load("office").unwrap();
        let reading = crate::read(&request, &location);
        let spans = reading.problems.iter().filter(|fault| fault.quotes.first().is_some_and(|quote| quote == "sings"));
        let spans: Vec<Span> = spans.filter_map(|fault| fault.at.span).collect();
        let [span] = spans[..] else { panic!("{:?}", reading.problems) };
        let words: String = rough.chars().skip(span.from as usize).take((span.to - span.from) as usize).collect();
        assert_eq!(words, "sings");
    }
}
