//! How far something is that takes time: a bar on a terminal, a line from time to time in a log file, and the same words in both.
//!
//! ```text
//! at(done) ─► told(done, total, elapsed) ─┬─► bar      standard error is a terminal
//!                                         └─► a line   it is none, and the last line is long enough ago
//! ```

use std::time::{Duration, Instant};

use crate::output::{Bar, Printer};

/// When the next line of a log file is due. Time is handed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pulse {
    every: Duration,
    last: Duration,
}

impl Pulse {
    /// A line after each pause; none at all where the pause is zero.
    pub(crate) const fn new(every: Duration) -> Self {
        Self { every, last: Duration::ZERO }
    }

    /// Whether a line is due at this time after the beginning; the next one is due a pause later.
    pub(crate) fn due(&mut self, elapsed: Duration) -> bool {
        if self.every.is_zero() || elapsed.saturating_sub(self.last) < self.every {
            return false;
        }
        self.last = elapsed;
        true
    }
}

/// How fast something goes on, and how long it takes yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Speed {
    /// Things done in a second.
    pub(crate) per_s: f64,
    /// Time left, s; none where nothing was done yet.
    pub(crate) left_s: Option<f64>,
}

impl Speed {
    /// Of `done` of `total`, of which `before` were done when the time began.
    #[expect(clippy::cast_precision_loss, reason = "counts of things are far below 2^52")]
    pub(crate) fn of(done: u64, total: u64, before: u64, elapsed: Duration) -> Self {
        let (made, seconds) = (done.saturating_sub(before) as f64, elapsed.as_secs_f64());
        let per_s = if seconds > 0.0 { made / seconds } else { 0.0 };
        let open = total.saturating_sub(done) as f64;
        Self { per_s, left_s: (per_s > 0.0).then(|| open / per_s) }
    }

    /// The same speed with this number of things still open.
    #[expect(clippy::cast_precision_loss, reason = "counts of things are far below 2^52")]
    pub(crate) fn for_open(self, open: u64) -> Self {
        Self { left_s: (self.per_s > 0.0).then(|| open as f64 / self.per_s), ..self }
    }

    /// `2.0 a second`, `3.1 a minute`, `12.0 an hour`.
    pub(crate) fn rate(&self) -> String {
        let (value, unit) = match self.per_s {
            fast if fast >= 1.0 => (fast, "a second"),
            slow if slow >= 1.0 / 60.0 => (slow * 60.0, "a minute"),
            rare => (rare * 3600.0, "an hour"),
        };
        format!("{value:.1} {unit}")
    }
}

/// `18 s`, `2 min 5 s`, `1 h 20 min`.
pub(crate) fn span(seconds: f64) -> String {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float casts into its nearest whole number"
    )]
    let whole = seconds.ceil() as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, min, s) => format!("{min} min {s} s"),
        (h, min, _) => format!("{h} h {min} min"),
    }
}

/// What stands behind the counts: a remark, the rate, the time left.
fn behind(remark: &str, speed: Speed) -> String {
    let left = speed.left_s.map(|left| format!("{} left", span(left)));
    let rate = speed.left_s.map(|_| speed.rate());
    let parts = [Some(remark.to_owned()).filter(|remark| !remark.is_empty()), rate, left];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" · ")
}

/// Something that takes time and can be counted. What is shown of it goes when it does.
#[derive(Debug)]
pub(crate) struct Progress {
    talk: Printer,
    what: &'static str,
    total: u64,
    before: Option<u64>,
    started: Instant,
    pulse: Pulse,
}

impl Progress {
    /// Of `total` things; the work is said in one word such as `making`.
    pub(crate) fn new(talk: Printer, what: &'static str, total: usize) -> Self {
        let total = u64::try_from(total).unwrap_or(u64::MAX);
        let pulse = Pulse::new(if talk.draws() { Duration::ZERO } else { talk.pause });
        Self { talk, what, total, before: None, started: Instant::now(), pulse }
    }

    /// Shows that this many are done. The first count is what was done before.
    pub(crate) fn at(&mut self, done: usize, remark: &str) {
        let done = u64::try_from(done).unwrap_or(u64::MAX);
        let before = *self.before.get_or_insert(done);
        let elapsed = self.started.elapsed();
        let behind = behind(remark, Speed::of(done, self.total, before, elapsed));
        if self.talk.draws() {
            self.talk.bar(Bar { what: self.what, done, total: self.total, remark: &behind });
        } else if self.pulse.due(elapsed) {
            let mark = if behind.is_empty() { "" } else { " · " };
            self.talk.warn(&format!("{:<10} {done} of {}{mark}{behind}", self.what, self.total));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.talk.end_bar();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn s(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    #[test]
    fn a_log_gets_a_line_a_pause_and_none_where_the_pause_is_zero() {
        let mut pulse = Pulse::new(s(10));
        let due: Vec<u64> = (0..=35).filter(|at| pulse.due(s(*at))).collect();
        assert_eq!(due, [10, 20, 30]);
        // What was late is said once.
        assert!(pulse.due(s(95)) && !pulse.due(s(96)));
        let mut off = Pulse::new(Duration::ZERO);
        assert!(!off.due(s(1_000)));
    }

    #[test]
    fn what_was_done_before_counts_for_no_speed() {
        let speed = Speed::of(24, 60, 4, s(10));
        assert_eq!((speed.rate().as_str(), speed.left_s.map(span).as_deref()), ("2.0 a second", Some("18 s")));
        assert_eq!(behind("1 failed", speed), "1 failed · 2.0 a second · 18 s left");
        // Nothing made yet: no rate, and no time left that anybody could know.
        assert_eq!(behind("", Speed::of(4, 60, 4, s(10))), "");
        assert_eq!(Speed::of(4, 60, 0, Duration::ZERO).left_s, None);
    }

    #[test]
    fn rates_and_spans_are_said_in_the_unit_that_fits() {
        assert_eq!(Speed::of(3, 9, 0, s(60)).rate(), "3.0 a minute");
        assert_eq!(Speed::of(1, 9, 0, s(600)).rate(), "6.0 an hour");
        assert_eq!((span(125.0), span(4_800.0), span(0.2)), ("2 min 5 s".into(), "1 h 20 min".into(), "1 s".into()));
    }
}
