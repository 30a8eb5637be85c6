//! The gap along the way between one who leads and one who follows.

use socrates_model::Point;

use crate::tracks::{Sample, Track};

/// Spacing of the remembered trail, m.
const TRAIL_STEP_M: f64 = 0.1;
/// Length of the trail behind the leader that is searched, m.
const TRAIL_REACH_M: f64 = 9.0;

/// Somebody who comes along goes at least at a third of the other's pace.
const COMES_ALONG: f64 = 3.0;

/// Where the follower is on the leader's trail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    /// Time, s.
    pub t: f64,
    /// Gap along the trail, m; 0 for one who is beside or ahead of the leader.
    pub gap_m: f64,
    /// Distance from the trail, m.
    pub off_m: f64,
    /// Straight distance of the two, m.
    pub distance_m: f64,
    /// Way that the two have gone together so far, m: see [`Together`].
    pub together_m: f64,
}

/// The way that two go together: of each step the shorter of the two, where one may go at a third of the other's pace for a while.
/// It stands still while one of them does.
#[derive(Debug, Default)]
pub(super) struct Together {
    before: Option<(Point, Point)>,
    way_m: f64,
}

impl Together {
    /// The way up to here, m: of `lead`, as far as `other` comes along.
    pub(super) fn to(&mut self, lead: Point, other: Point) -> f64 {
        if let Some((a, b)) = self.before.replace((lead, other)) {
            self.way_m += (lead - a).norm().min(COMES_ALONG * (other - b).norm());
        }
        self.way_m
    }
}

/// Gaps at every sample. The trail is what the leader has walked so far, and straight back from its start.
#[must_use]
pub(super) fn gaps(leader: &Track, follower: &Track) -> Vec<Gap> {
    let Some(first) = leader.present().next() else { return Vec::new() };
    let back = leader.present().find(|sample| sample.speed() > 0.2).unwrap_or(first).course();
    let mut trail: Vec<(f64, Point)> = Vec::new();
    let steps = (TRAIL_REACH_M / TRAIL_STEP_M) as u32;
    for k in (1..=steps).rev() {
        let s = -f64::from(k) * TRAIL_STEP_M;
        trail.push((s, first.at + back * s));
    }
    trail.push((0.0, first.at));
    let keep = steps as usize + 2;
    let mut found = Vec::with_capacity(leader.samples.len());
    let mut together = Together::default();
    for (lead, behind) in leader.beside(follower) {
        let (s_last, p_last) = trail.last().copied().unwrap_or((0.0, first.at));
        let step = (lead.at - p_last).norm();
        let arc_m = s_last + step;
        if step >= TRAIL_STEP_M {
            trail.push((arc_m, lead.at));
        }
        let recent = trail.get(trail.len().saturating_sub(keep)..).unwrap_or(&trail);
        let (mut off_m, mut at_s) = ((behind.at - lead.at).norm(), arc_m);
        for (s, point) in recent {
            let off = (behind.at - point).norm();
            if off < off_m {
                (off_m, at_s) = (off, *s);
            }
        }
        found.push(Gap {
            t: lead.t,
            gap_m: arc_m - at_s,
            off_m,
            distance_m: (behind.at - lead.at).norm(),
            together_m: together.to(lead.at, behind.at),
        });
    }
    found
}

/// Way traveled up to each sample, m.
#[must_use]
pub(super) fn arcs(samples: &[Sample]) -> Vec<f64> {
    let mut arc = 0.0;
    let mut before: Option<Point> = None;
    samples
        .iter()
        .map(|sample| {
            arc += before.map_or(0.0, |point| (sample.at - point).norm());
            before = Some(sample.at);
            arc
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{Walk, recording};
    use crate::tracks::Tracks;
    use socrates_model::AgentId;

    #[test]
    fn the_gap_goes_round_the_corner() {
        // The robot walks 5 m along x, then up y; the follower is 2 s behind on the same way at 1 m/s.
        let leader = Walk::through(AgentId::Robot, &[(0., 0., 0.), (5., 5., 0.), (15., 5., 10.)]);
        let follower = Walk::human_through(1, &[(0., -2., 0.), (7., 5., 0.), (17., 5., 10.)]);
        let tracks = Tracks::read(&recording(&[leader, follower], 10.0, 0.05)).unwrap();
        let gaps = gaps(tracks.robot.as_ref().unwrap(), &tracks.humans[0]);
        for gap in &gaps {
            assert!((gap.gap_m - 2.0).abs() < 0.12 && gap.off_m < 0.1, "{gap:?}");
        }
        assert!(gaps.iter().any(|gap| gap.distance_m < 1.6), "the straight line cuts the corner");
    }
}
