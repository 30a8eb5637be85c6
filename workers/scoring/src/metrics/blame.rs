//! Whose motion makes a collision likely.

use crate::metrics::collisions::closing_share;
use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::ttc::EXPOSED_SECS;
use crate::metrics::{Begin, Family, Measure, Measured, or_why};
use crate::running::{MeanWhileBelow, Pen};
use crate::tracks::Sample;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "blame",
    thresholds: &[("exposed_secs", EXPOSED_SECS)],
    measure: Measure::Online(Begin(|humans| Box::new(Blame::new(humans)))),
};

/// Time on a collision course with one human, and the robot's share in it.
#[derive(Clone)]
struct Course {
    times: Pen,
    share: MeanWhileBelow,
}

#[derive(Clone)]
struct Blame(Vec<Course>);

impl Blame {
    fn new(humans: usize) -> Self {
        Self(vec![Course { times: Pen::default(), share: MeanWhileBelow::level(EXPOSED_SECS) }; humans])
    }
}

impl Running for Blame {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        let Some(robot) = now.robot else { return };
        for (index, ((course, human), ttc_s)) in self.0.iter_mut().zip(now.humans).zip(now.ttc_s).enumerate() {
            let far = 2.0 * EXPOSED_SECS;
            let both = robot.there && human.there;
            let piece = course.times.to(now.t, both.then(|| ttc_s.unwrap_or(far).min(far)));
            // Shares matter only where the time is short.
            if let (Some((t0, s0, t1, s1)), Some((r, others))) = (piece, now.before)
                && s0.min(s1) < EXPOSED_SECS
                && let Some(h) = others.get(index)
            {
                let share = |r: &Sample, h: &Sample| closing_share(r, h).unwrap_or(0.0);
                course.share.add(Some((t0, share(r, h), t1, share(robot, human))), piece);
            }
        }
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        let (mut area, mut seconds) = (0.0, 0.0);
        for course in &self.0 {
            if let Some(mean) = course.share.mean() {
                area += mean * course.share.seconds();
                seconds += course.share.seconds();
            }
        }
        let why = "the two are never on a collision course within 3 s";
        vec![or_why((seconds > 0.0).then(|| area / seconds), why)]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::value;

    #[test]
    fn two_who_come_alike_share_the_blame_and_a_standing_robot_has_none() {
        let alike = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 8., 0., -1., 0.)], 3.5, 0.05);
        assert!((value(&alike, "blame").unwrap() - 0.5).abs() < 1e-6);
        let hit = recording(&[Walk::robot(0., 0., 0., 0.), Walk::human(1, 4., 0., -1., 0.)], 3.0, 0.05);
        assert!(value(&hit, "blame").unwrap().abs() < 1e-6);
    }
}
