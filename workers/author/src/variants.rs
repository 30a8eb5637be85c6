//! Several proposals in one answer, and the choice among them.
//!
//! ```text
//! {"variants": [proposal, …]} ──► read ──► each with its faults ──► best ──► the one that goes on
//! ```
//!
//! The best is the one with the fewest hard faults, then the fewest warnings, then the earlier one; never what a model thinks of
//! its own work. A person may take another: [`read`] gives all of them.

use serde_json::{Value, json};
use socrates_model::fault::hard;
use socrates_model::job::Stage;
use socrates_model::seeds::derive_seed;
use socrates_model::{Fault, Proposal};
use socrates_prompts::{Question, json as text_json};

use crate::attempt::{Written, checked, read as read_one};
use crate::author::{Answer, AskError, Author};

/// Member of an answer that holds several proposals.
pub(crate) const MEMBER: &str = "variants";

/// One of several proposals.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// The proposal; nothing where it could not be read.
    pub proposal: Option<Proposal>,
    /// Its own text.
    pub text: String,
    /// What is wrong with it; warnings too.
    pub faults: Vec<Fault>,
}

/// Every proposal of an answer with its faults, in the order of the answer; one where the answer is a proposal itself.
///
/// # Errors
/// Why the answer as a whole cannot be read: it is no JSON, or an empty list.
pub fn read(text: &str, question: &Question) -> Result<Vec<Variant>, Vec<Fault>> {
    let answer = text_json::object(text)?;
    let texts: Vec<String> = match answer.get(MEMBER).and_then(Value::as_array) {
        Some(variants) => variants.iter().map(Value::to_string).collect(),
        None => vec![text.to_owned()],
    };
    if texts.is_empty() {
        let message = "expected a list of proposals, found an empty one";
        return Err(vec![Fault::new(socrates_model::FaultCode::ESchema, "$.variants", message)]);
    }
    Ok(texts.into_iter().map(|text| variant(text, question)).collect())
}

fn variant(text: String, question: &Question) -> Variant {
    match read_one(&text, question) {
        Ok((written, account)) => {
            let (_reading, faults) = checked(&written, account.as_ref(), question);
            let Written::Proposal(proposal) = written else { return Variant { proposal: None, text, faults } };
            Variant { proposal: Some(proposal), text, faults }
        }
        Err(faults) => Variant { proposal: None, text, faults },
    }
}

/// The place of the best: fewest hard faults, then fewest warnings, then the earlier one. 0 where there is none.
#[must_use]
pub fn best(variants: &[Variant]) -> usize {
    let weight = |variant: &Variant| {
        let hard = hard(&variant.faults).len();
        // A proposal that cannot be read has more than one fault: nothing of it could be checked.
        (variant.proposal.is_none(), hard, variant.faults.len() - hard)
    };
    let places = variants.iter().enumerate().min_by_key(|(place, variant)| (weight(variant), *place));
    places.map_or(0, |(place, _)| place)
}

/// Asks an author once for every variant, with a seed of its own, and puts the answers into one. The first has the question's
/// own seed.
pub(crate) struct BySeed {
    pub(crate) inner: Box<dyn Author>,
    pub(crate) count: u32,
}

#[async_trait::async_trait]
impl Author for BySeed {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let mut first = self.inner.ask(question).await?;
        // An author that is shown a refused answer mends that one.
        if question.stage != Stage::Proposal || question.refused.is_some() {
            return Ok(first);
        }
        let mut variants = vec![read_value(&first.text)];
        for number in 1..self.count {
            let seed = derive_seed(question.seed, &["variant", &number.to_string()]);
            let answer = self.inner.ask(&Question { seed, ..question.clone() }).await?;
            first.tokens.0 += answer.tokens.0;
            first.tokens.1 += answer.tokens.1;
            variants.push(read_value(&answer.text));
        }
        let mut members = serde_json::Map::new();
        members.insert(MEMBER.to_owned(), json!(variants));
        first.text = Value::Object(members).to_string();
        Ok(first)
    }

    fn name(&self) -> String {
        self.inner.name()
    }
}

/// The answer as a value; what is no JSON stays a text and is refused as such.
fn read_value(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|_no_json| json!(text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attempt::attempt;
    use crate::author::Says;
    use crate::testing::{good_proposal, proposal, question};

    fn of(proposals: &[Value]) -> String {
        json!({ "variants": proposals }).to_string()
    }

    /// A proposal with this title; with a hard fault where it is bad, with a warning where it is so so.
    fn titled(title: &str, bad: usize, soft: bool) -> Value {
        let mut wrong = proposal();
        wrong.title = title.to_owned();
        for human in wrong.humans.iter_mut().take(bad) {
            human.behavior.push_str(" It picks up a box.");
        }
        if soft {
            wrong.description.push_str(" They meet at n_1.");
        }
        serde_json::to_value(wrong).unwrap()
    }

    #[tokio::test]
    async fn the_best_by_its_faults_goes_on_and_all_are_kept() {
        let text = of(&[titled("a", 1, false), titled("b", 0, true), titled("c", 0, false), titled("d", 0, false)]);
        let asked = question(Stage::Proposal);
        let counts: Vec<usize> = read(&text, &asked).unwrap().iter().map(|variant| variant.faults.len()).collect();
        assert_eq!(counts, [1, 1, 0, 0]);
        let made = attempt(&Says(text.clone()), &asked).await.unwrap();
        let Written::Proposal(chosen) = &made.written else { panic!() };
        assert_eq!((chosen.title.as_str(), made.exchange.chosen), ("c", Some(2)), "the earlier of two without faults");
        assert_eq!(made.exchange.answer, text);
        assert_eq!(made.exchange.variants.iter().map(Vec::len).collect::<Vec<_>>(), counts);
        // A person may take another of them.
        assert_eq!(read(&text, &asked).unwrap()[3].proposal.as_ref().unwrap().title, "d");
    }

    #[tokio::test]
    async fn where_all_are_wrong_the_least_wrong_is_to_be_mended() {
        let text = of(&[json!("no"), titled("a", 2, false), titled("b", 1, false)]);
        let refused = attempt(&Says(text), &question(Stage::Proposal)).await.unwrap_err();
        assert_eq!(refused.faults.len(), 1);
        let shown: Value = serde_json::from_str(refused.text.as_deref().unwrap()).unwrap();
        assert_eq!(shown["title"], "b", "only what is to be mended is shown again");
        assert_eq!(refused.exchange.chosen, Some(2));
    }

    #[tokio::test]
    async fn a_list_without_proposals_and_a_single_proposal_are_read_as_such() {
        let refused = attempt(&Says(of(&[])), &question(Stage::Proposal)).await.unwrap_err();
        assert!(refused.faults[0].message.to_string().contains("empty"), "{refused}");
        let made = attempt(&Says(good_proposal()), &question(Stage::Proposal)).await.unwrap();
        assert!(made.exchange.chosen.is_none() && made.exchange.variants.is_empty());
    }

    #[tokio::test]
    async fn rules_are_asked_with_a_seed_for_each() {
        /// Says its seed.
        struct Seed;
        #[async_trait::async_trait]
        impl Author for Seed {
            async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
                Ok(Answer { text: json!({"title": question.seed}).to_string(), ..Answer::default() })
            }
            fn name(&self) -> String {
                "seed".into()
            }
        }
        let several = BySeed { inner: Box::new(Seed), count: 3 };
        let asked = question(Stage::Proposal);
        let text = several.ask(&asked).await.unwrap().text;
        let value: Value = serde_json::from_str(&text).unwrap();
        let mut seeds: Vec<u64> =
            value[MEMBER].as_array().unwrap().iter().map(|one| one["title"].as_u64().unwrap()).collect();
        assert_eq!(seeds[0], asked.seed);
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 3);
        assert_eq!(several.ask(&asked).await.unwrap().text, text);
        let mending = Question { refused: Some("{}".into()), ..asked };
        assert!(!several.ask(&mending).await.unwrap().text.contains(MEMBER));
    }
}
