//! Past and future over sampled signals, with quantitative semantics (Donzé and Maler, Robust
//! Satisfaction of Temporal Logic over Real-Valued Signals, FORMATS 2010).
//!
//! A [`Signal`] says at each sample how far a condition holds: positive it does, negative it does not. The connectives
//! take smallest and largest values, windows are closed intervals of seconds, and each operator is one pass over the
//! samples by a monotone queue (Lemire 2006), however long its window is.
//!
//! - A window without a sample makes [`Signal::eventually`] and [`Signal::until`] fail (negative infinity) and
//!   [`Signal::always`] hold (infinity); a window that reaches beyond the end is cut there.
//! - NaN is *not known*. It is contagious: whatever looks at an unknown sample is unknown, and unknown neither holds
//!   nor fails.

use std::collections::VecDeque;

/// Slack for times that come from sums of steps, s.
pub(crate) const TIME_SLACK: f64 = 1e-9;

/// How far a condition holds, sample by sample. Times rise.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Signal {
    times_s: Vec<f64>,
    values: Vec<f64>,
}

/// A closed interval of seconds relative to now, `0 <= from_s <= to_s`; `to_s` may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Within {
    /// Nearest moment, s.
    pub from_s: f64,
    /// Farthest moment, s.
    pub to_s: f64,
}

impl Within {
    /// From now to the end, or back to the start.
    pub const EVER: Self = Self { from_s: 0.0, to_s: f64::INFINITY };

    /// Up to so many seconds from now.
    #[must_use]
    pub const fn secs(to_s: f64) -> Self {
        Self { from_s: 0.0, to_s }
    }
}

impl FromIterator<(f64, f64)> for Signal {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(samples: I) -> Self {
        let (times_s, values) = samples.into_iter().unzip();
        Self { times_s, values }
    }
}

/// The smaller; unknown when either is.
fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }
}

/// The larger; unknown when either is.
fn greatest(a: f64, b: f64) -> f64 {
    -least(-a, -b)
}

impl Signal {
    /// The samples, `(time s, value)`.
    pub fn samples(&self) -> impl DoubleEndedIterator<Item = (f64, f64)> + '_ {
        self.times_s.iter().copied().zip(self.values.iter().copied())
    }

    /// The value at the first sample: whether a formula holds of the whole run.
    #[must_use]
    pub fn now(&self) -> Option<f64> {
        self.values.first().copied()
    }

    /// Whether the condition holds at the first sample; `None` when that is not known.
    #[must_use]
    pub fn holds(&self) -> Option<bool> {
        self.now().filter(|value| !value.is_nan()).map(|value| value >= 0.0)
    }

    /// The first time at which it holds, s.
    #[must_use]
    pub fn first_s(&self) -> Option<f64> {
        self.samples().find(|(_, value)| *value >= 0.0).map(|(t, _)| t)
    }

    /// Maximal stretches of samples at which it holds: first and last time, s. Unknown ends a stretch.
    #[must_use]
    pub fn stretches(&self) -> Vec<(f64, f64)> {
        let mut found: Vec<(f64, f64)> = Vec::new();
        let mut open: Option<(f64, f64)> = None;
        for (t, value) in self.samples() {
            if value >= 0.0 {
                open = Some((open.map_or(t, |(from, _)| from), t));
            } else {
                found.extend(open.take());
            }
        }
        found.extend(open);
        found
    }

    /// What does not hold.
    #[must_use]
    pub fn not(&self) -> Self {
        Self { times_s: self.times_s.clone(), values: self.values.iter().map(|value| -value).collect() }
    }

    /// Both hold. The signals share their times; the shorter one ends the result.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        self.joined(other, least)
    }

    /// At least one holds.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        self.joined(other, greatest)
    }

    fn joined(&self, other: &Self, join: impl Fn(f64, f64) -> f64) -> Self {
        self.samples().zip(other.samples()).map(|((t, a), (_, b))| (t, join(a, b))).collect()
    }

    /// It holds at some time in the window ahead.
    #[must_use]
    pub fn eventually(&self, within: Within) -> Self {
        self.not().always(within).not()
    }

    /// It holds at every time in the window ahead.
    #[must_use]
    pub fn always(&self, within: Within) -> Self {
        let n = self.values.len();
        let mut found = Vec::with_capacity(n);
        // Indexes of candidates for the minimum, values rising from front to back; unknown ones apart.
        let mut queue: VecDeque<(usize, f64)> = VecDeque::new();
        let mut unknown: VecDeque<usize> = VecDeque::new();
        let (mut low, mut high) = (0, 0);
        for now in &self.times_s {
            while high < n && self.times_s.get(high).is_some_and(|t| *t <= now + within.to_s + TIME_SLACK) {
                let value = self.values.get(high).copied().unwrap_or(f64::NAN);
                if value.is_nan() {
                    unknown.push_back(high);
                } else {
                    while queue.back().is_some_and(|(_, old)| *old >= value) {
                        queue.pop_back();
                    }
                    queue.push_back((high, value));
                }
                high += 1;
            }
            while low < n && self.times_s.get(low).is_some_and(|t| *t < now + within.from_s - TIME_SLACK) {
                low += 1;
            }
            while queue.front().is_some_and(|(index, _)| *index < low) {
                queue.pop_front();
            }
            while unknown.front().is_some_and(|index| *index < low) {
                unknown.pop_front();
            }
            found.push(if unknown.is_empty() {
                queue.front().map_or(f64::INFINITY, |(_, value)| *value)
            } else {
                f64::NAN
            });
        }
        Self { times_s: self.times_s.clone(), values: found }
    }

    /// It holds at every moment from now until `goal` holds, which comes to pass in the window ahead.
    #[must_use]
    pub fn until(&self, goal: &Self, within: Within) -> Self {
        let n = self.values.len().min(goal.values.len());
        let times: Vec<f64> = self.times_s.iter().copied().take(n).collect();
        // Without a window, backward in one pass.
        let mut open = vec![f64::NAN; n];
        let mut next = f64::NEG_INFINITY;
        for ((slot, kept), reached) in open.iter_mut().zip(&self.values).zip(&goal.values).rev() {
            next = greatest(*reached, least(*kept, next));
            *slot = next;
        }
        let open = Self { times_s: times.clone(), values: open };
        if within.from_s <= 0.0 && within.to_s.is_infinite() {
            return open;
        }
        // With one: the goal comes in the window, it holds up to the window, and from there until the goal
        // (Donzé, Ferrère and Maler 2013).
        let comes = goal.eventually(within);
        let mut found = Vec::with_capacity(n);
        let mut before: VecDeque<(usize, f64)> = VecDeque::new();
        let mut unknown: VecDeque<usize> = VecDeque::new();
        let mut high = 0;
        for (k, now) in times.iter().enumerate() {
            while high < n && times.get(high).is_some_and(|t| *t < now + within.from_s - TIME_SLACK) {
                let value = self.values.get(high).copied().unwrap_or(f64::NAN);
                if value.is_nan() {
                    unknown.push_back(high);
                } else {
                    while before.back().is_some_and(|(_, old)| *old >= value) {
                        before.pop_back();
                    }
                    before.push_back((high, value));
                }
                high += 1;
            }
            while before.front().is_some_and(|(index, _)| *index < k) {
                before.pop_front();
            }
            while unknown.front().is_some_and(|index| *index < k) {
                unknown.pop_front();
            }
            let kept =
                if unknown.is_empty() { before.front().map_or(f64::INFINITY, |(_, value)| *value) } else { f64::NAN };
            let from = open.values.get(high.max(k)).copied().unwrap_or(f64::NEG_INFINITY);
            let comes = comes.values.get(k).copied().unwrap_or(f64::NEG_INFINITY);
            found.push(least(least(comes, kept), from));
        }
        Self { times_s: times, values: found }
    }

    /// It held at some time in the window behind.
    #[must_use]
    pub fn once(&self, within: Within) -> Self {
        self.reversed().eventually(within).reversed()
    }

    /// It held at every time in the window behind.
    #[must_use]
    pub fn historically(&self, within: Within) -> Self {
        self.reversed().always(within).reversed()
    }

    /// It has held at every moment since `start` held, which was in the window behind.
    #[must_use]
    pub fn since(&self, start: &Self, within: Within) -> Self {
        self.reversed().until(&start.reversed(), within).reversed()
    }

    /// Time backward, so that the past is a future.
    fn reversed(&self) -> Self {
        self.samples().rev().map(|(t, value)| (-t, value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Draw;

    impl Draw {
        /// Uneven times, values on a coarse grid so that equal ones occur, and some unknown.
        fn signal(&mut self, n: usize, unknown: f64) -> Vec<(f64, f64)> {
            let mut t = self.next() * 3.0;
            (0..n)
                .map(|_| {
                    t += 0.05 + 0.1 * (self.next() * 5.0).floor();
                    let value = if self.next() < unknown { f64::NAN } else { (self.next() * 9.0).floor() - 4.0 };
                    (t, value)
                })
                .collect()
        }

        fn window(&mut self) -> Within {
            let from_s = if self.next() < 0.3 { 0.0 } else { (self.next() * 20.0).floor() * 0.1 };
            let to_s = if self.next() < 0.2 { f64::INFINITY } else { from_s + (self.next() * 30.0).floor() * 0.1 };
            Within { from_s, to_s }
        }
    }

    fn inside(now: f64, t: f64, within: Within) -> bool {
        t >= now + within.from_s - TIME_SLACK && t <= now + within.to_s + TIME_SLACK
    }

    fn fold(values: impl Iterator<Item = f64>, start: f64, join: fn(f64, f64) -> f64) -> f64 {
        values.fold(start, join)
    }

    /// Straight from the definition.
    fn naive_always(signal: &[(f64, f64)], within: Within) -> Vec<f64> {
        let window = |now: f64| signal.iter().filter(move |(t, _)| inside(now, *t, within)).map(|(_, v)| *v);
        signal.iter().map(|(now, _)| fold(window(*now), f64::INFINITY, least)).collect()
    }

    fn naive_until(held: &[(f64, f64)], goal: &[(f64, f64)], within: Within) -> Vec<f64> {
        let one = |k: usize| {
            let ends = (k..held.len()).filter(|j| inside(held[k].0, held[*j].0, within));
            let each = ends.map(|j| {
                let kept = fold(held[k..j].iter().map(|(_, v)| *v), f64::INFINITY, least);
                least(goal[j].1, kept)
            });
            fold(each, f64::NEG_INFINITY, greatest)
        };
        (0..held.len()).map(one).collect()
    }

    fn same(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len()
            && a.iter()
                .zip(b)
                .all(|(a, b)| a.partial_cmp(b).is_some_and(std::cmp::Ordering::is_eq) || a.is_nan() && b.is_nan())
    }

    fn backward(signal: &[(f64, f64)]) -> Vec<(f64, f64)> {
        signal.iter().rev().map(|(t, v)| (-t, *v)).collect()
    }

    #[test]
    fn every_operator_is_what_its_definition_says() {
        let mut draw = Draw(7);
        for round in 0..400 {
            let n = 1 + (draw.next() * 40.0) as usize;
            let raw = draw.signal(n, if round % 4 == 0 { 0.05 } else { 0.0 });
            let goal: Vec<(f64, f64)> = raw.iter().zip(draw.signal(n, 0.0)).map(|((t, _), (_, v))| (*t, v)).collect();
            let within = draw.window();
            let (signal, aim): (Signal, Signal) = (raw.iter().copied().collect(), goal.iter().copied().collect());
            let always = naive_always(&raw, within);
            assert!(same(&signal.always(within).values, &always), "always {within:?} of {raw:?}");
            let negated: Vec<(f64, f64)> = raw.iter().map(|(t, v)| (*t, -v)).collect();
            let eventually: Vec<f64> = naive_always(&negated, within).iter().map(|v| -v).collect();
            assert!(same(&signal.eventually(within).values, &eventually), "eventually {within:?} of {raw:?}");
            let historically: Vec<f64> = naive_always(&backward(&raw), within).into_iter().rev().collect();
            assert!(same(&signal.historically(within).values, &historically), "historically {within:?}");
            if raw.iter().any(|(_, v)| v.is_nan()) {
                // The windows of the two forms differ in what they look at: unknown may reach farther.
                continue;
            }
            let until = naive_until(&raw, &goal, within);
            assert!(same(&signal.until(&aim, within).values, &until), "until {within:?} of {raw:?} and {goal:?}");
            let since: Vec<f64> = naive_until(&backward(&raw), &backward(&goal), within).into_iter().rev().collect();
            assert!(same(&signal.since(&aim, within).values, &since), "since {within:?}");
        }
    }

    #[test]
    fn unknown_is_neither_and_it_is_contagious() {
        let signal: Signal = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.0)].into_iter().collect();
        assert_eq!(signal.always(Within::EVER).holds(), None);
        assert_eq!(signal.eventually(Within::secs(0.5)).holds(), Some(true));
        assert_eq!(signal.and(&signal.not()).holds(), Some(false));
        let late: Signal = [(0.0, f64::NAN), (1.0, 1.0)].into_iter().collect();
        assert_eq!(late.holds(), None);
        assert_eq!(late.first_s(), Some(1.0));
        assert_eq!(Signal::default().holds(), None);
    }

    #[test]
    fn a_window_beyond_the_end_is_cut_and_an_empty_one_decides() {
        let signal: Signal = [(0.0, 2.0), (1.0, -1.0)].into_iter().collect();
        let far = Within { from_s: 5.0, to_s: 6.0 };
        assert_eq!(signal.always(far).now(), Some(f64::INFINITY));
        assert_eq!(signal.eventually(far).now(), Some(f64::NEG_INFINITY));
        assert_eq!(signal.always(Within::secs(9.0)).now(), Some(-1.0));
    }

    #[test]
    fn a_run_is_judged_in_one_pass_however_long_the_window() {
        // Half a million samples with windows of minutes: the naive form would take 10^11 steps.
        let signal: Signal = (0..500_000).map(|k| (f64::from(k) * 0.01, f64::from(k % 977) - 900.0)).collect();
        let wide = Within { from_s: 1.0, to_s: 120.0 };
        assert_eq!(signal.always(wide).now(), Some(-900.0));
        // It rises through 0 after 900 samples: not so, until so.
        assert_eq!(signal.not().until(&signal, Within::EVER).now(), Some(0.0));
    }
}
