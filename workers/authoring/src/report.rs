//! An author's answer in the words of the worker kit.

use socrates_author::{Exchange, JobAnswer, JobRefusal, Written};
use socrates_kit::{Done, Failure, Output, media};
use socrates_model::Role;
use socrates_model::wire::{Rate, Rates};

/// A good answer: the artifact and the exchange it came from.
pub(crate) fn done(answer: JobAnswer) -> Result<Done, Failure> {
    let artifact = match &answer.written {
        Written::Proposal(proposal) => Output::json(Role::Proposal, proposal)?,
        Written::Paths(paths) => Output::json(Role::Paths, paths)?,
        Written::Behaviors(behaviors) => Output::json(Role::Behaviors, behaviors)?,
    };
    let exchange = Output::json(Role::Exchange, &answer.exchange)?;
    let mut outputs = vec![artifact, exchange];
    if let Some(reading) = &answer.reading {
        outputs.push(Output::json(Role::Reading, reading)?);
    }
    let mut done = Done::with(outputs).remark(answer.remark);
    done.tokens = answer.exchange.tokens;
    done.rates = rates(&answer.exchange);
    Ok(done)
}

/// A refused answer: every reason, the refused text and the exchange.
pub(crate) fn failure(refusal: JobRefusal) -> Failure {
    let mut failure = Failure::new(refusal.class, refusal.faults).retry_after(refusal.retry_after_ms);
    if let Some(text) = refusal.text {
        failure = failure.with(Output::text(Role::Refused, media::TEXT, text));
    }
    if let Some(exchange) = refusal.exchange {
        failure = failure.tokens(exchange.tokens);
        failure.rates = rates(&exchange).map(Box::new);
        // An exchange that cannot be written is no reason to lose the reasons.
        if let Ok(output) = Output::json(Role::Exchange, &exchange) {
            failure = failure.with(output);
        }
    }
    failure
}

/// What the server said of its rates, in the words of the bus.
fn rates(exchange: &Exchange) -> Option<Rates> {
    let limits = exchange.how.limits?;
    let rate = |of: socrates_author::Rate| Rate { limit: of.limit, left: of.left, whole_in_ms: of.whole_in_ms };
    Some(Rates { requests: limits.requests.map(rate), tokens: limits.tokens.map(rate) })
}
