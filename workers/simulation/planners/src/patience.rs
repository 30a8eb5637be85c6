//! When the robot stops dodging somebody who does not let it pass: it stands, faces whoever that is, and waits for an answer.

use socrates_model::{Observation, Point, Vector};

/// Somebody nearer than this, m, and ahead by more than this, m, can be in its way.
const NEAR_M: f64 = 1.6;
const AHEAD_M: f64 = 0.3;
/// Who is farther beside it than this, m, is not in its way, while it dodges and while it stands.
const DODGES_ASIDE_M: f64 = 1.3;
const STANDS_ASIDE_M: f64 = 0.45;
/// Who moves so far while it stands, m, has answered: it tries again.
const MOVES_M: f64 = 0.3;
/// Less of its way than this, m, in so long a time, s, before somebody is no way past them.
const PROGRESS_M: f64 = 0.5;
const TRIES_S: f64 = 3.0;
/// It stands so long before it tries again, s: time to ask, and to be let through.
const STANDS_S: f64 = 8.0;
/// Who stood in its way comes to rest within so long a time, s.
const SETTLES_S: f64 = 1.0;
/// Where standing was of no use it tries for so long, s, before it stands again.
const AGAIN_S: f64 = 12.0;

/// How the robot gets on, and since when it does not.
#[derive(Debug)]
pub(crate) struct Patience {
    mark_m: f64,
    since_s: f64,
    until_s: f64,
    asked_s: f64,
    blocker: Point,
    tries_s: f64,
}

impl Default for Patience {
    fn default() -> Self {
        Self { mark_m: 0.0, since_s: 0.0, until_s: 0.0, asked_s: 0.0, blocker: Point::origin(), tries_s: TRIES_S }
    }
}

impl Patience {
    /// Whom to face instead of going on, for a robot that has come so far along its way, which leads `ahead`.
    pub(crate) fn faces(&mut self, seen: &Observation<'_>, s: f64, ahead: &Vector) -> Option<Point> {
        let (at, now) = (seen.pose.point(), seen.time.secs());
        let near = seen.people.iter().map(|person| (person.at - at, person.at));
        // Whoever has gone aside while it stood is in its way no longer.
        let aside_m = if now < self.until_s { STANDS_ASIDE_M } else { DODGES_ASIDE_M };
        let near =
            near.filter(|(to, _)| to.norm() < NEAR_M && to.dot(ahead) > AHEAD_M && to.perp(ahead).abs() < aside_m);
        // What else it waited for meanwhile does not count.
        if now - self.asked_s > 0.5 {
            (self.mark_m, self.since_s) = (s, now);
        }
        self.asked_s = now;
        let Some((_, blocker)) = near.min_by(|a, b| a.0.norm().total_cmp(&b.0.norm())) else {
            (self.mark_m, self.since_s, self.until_s, self.tries_s) = (s, now, 0.0, TRIES_S);
            return None;
        };
        if s > self.mark_m + PROGRESS_M {
            (self.mark_m, self.since_s, self.tries_s) = (s, now, TRIES_S);
        }
        if now < self.until_s {
            (self.mark_m, self.since_s) = (s, now);
            if self.until_s - now > STANDS_S - SETTLES_S {
                self.blocker = blocker;
            } else if (blocker - self.blocker).norm() > MOVES_M {
                self.until_s = now;
            }
        } else if now - self.since_s > self.tries_s {
            (self.until_s, self.tries_s) = (now + STANDS_S, AGAIN_S);
        }
        (now < self.until_s).then_some(blocker)
    }
}
