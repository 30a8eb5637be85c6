//! Near misses.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, count};
use crate::running::Stretches;
use crate::series::Span;

/// Nearer than this is a near miss, m (the default of Robot SF).
const NEAR_M: f64 = 0.5;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "near_misses",
    thresholds: &[("near_m", NEAR_M)],
    measure: Measure::Online(Begin(|humans| Box::new(Near::new(humans)))),
};

/// Stretches near one human, and those in contact.
#[derive(Clone)]
struct Misses {
    near: Stretches,
    touching: Stretches,
}

impl Misses {
    fn count(&self) -> usize {
        let touched = |span: &&Span| {
            self.touching.spans().iter().any(|touch| touch.from_s <= span.to_s && touch.to_s >= span.from_s)
        };
        self.near.spans().iter().filter(|span| !touched(span)).count()
    }
}

#[derive(Clone)]
struct Near(Vec<Misses>);

impl Near {
    fn new(humans: usize) -> Self {
        let none = Misses { near: Stretches::below(NEAR_M, 0.05, 0.5), touching: Stretches::below(0.0, 0.0, 0.0) };
        Self(vec![none; humans])
    }
}

impl Running for Near {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        for (misses, pieces) in self.0.iter_mut().zip(now.pieces) {
            for piece in pieces {
                misses.near.add(*piece);
                misses.touching.add(*piece);
            }
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        vec![Ok(count(self.0.iter().map(Misses::count).sum()))]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Walk;
    use crate::metrics::tests::at_both_rates;

    #[test]
    fn a_close_pass_is_one_near_miss_and_a_contact_is_none() {
        let close = || vec![Walk::robot(-4., 0., 0.8, 0.), Walk::human(1, 0., 0.8, 0., 0.)];
        at_both_rates(&close, 10.0, "near_misses", 1.0, 0.0);
        let through = || vec![Walk::robot(-4., 0., 0.8, 0.), Walk::human(1, 0., 0.1, 0., 0.)];
        at_both_rates(&through, 10.0, "near_misses", 0.0, 0.0);
    }
}
