//! Time to collision at constant velocity.

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::scene::EVEN_SECS;
use crate::metrics::{Begin, Family, Measure, Measured, or_why};
use crate::series::Series;
use crate::tracks::Sample;

/// Below this time to collision somebody is exposed, s (1.5 to 3 s are in use).
pub(crate) const EXPOSED_SECS: f64 = 3.0;
/// Longer times count as this one, so that curves have a number, s.
const FAR_SECS: f64 = 100.0;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "ttc",
    thresholds: &[("exposed_secs", EXPOSED_SECS), ("far_secs", FAR_SECS)],
    measure: Measure::Online(Begin(|_| Box::new(Times::default()))),
};

/// Time to collision of two discs at constant velocity, s; `None` when they never touch. With
/// `p = x_h - x_r`, `w = v_h - v_r`, `R` the sum of radii, `a = w.w`, `b = p.w`, `c = p.p - R²`:
/// `(-b - √(b² - a c)) / a`.
pub(crate) fn time_to_collision(r: &Sample, h: &Sample, radii_m: f64) -> Option<f64> {
    let (p, w) = (h.at - r.at, h.velocity - r.velocity);
    let c = p.norm_squared() - radii_m * radii_m;
    if c < 0.0 {
        return Some(0.0);
    }
    let (a, b) = (w.norm_squared(), p.dot(&w));
    let root = b * b - a * c;
    (b < 0.0 && root >= 0.0 && a > 1e-12).then(|| (-b - root.sqrt()) / a)
}

/// The shortest time to collision with anybody, as it goes on.
#[derive(Clone, Default)]
struct Times {
    /// The whole curve: a quantile needs all of it.
    curve: Vec<(f64, f64)>,
    exposed: f64,
    integrated: f64,
}

impl Running for Times {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        if !now.robot.is_some_and(|robot| robot.there) {
            return;
        }
        let least = now.ttc_s.iter().copied().flatten().fold(FAR_SECS, f64::min);
        // A curve that jumps from far to near between two samples must not be cut in a straight line: the
        // exposed time is that of pieces with both ends near, and half of those with one.
        if let Some((t0, before)) = self.curve.last().filter(|(t0, _)| now.t - t0 < 1.5 * EVEN_SECS) {
            let near = |v: f64| if v < EXPOSED_SECS { 1.0 } else { 0.0 };
            let short = |v: f64| (EXPOSED_SECS - v).max(0.0);
            self.exposed += (now.t - t0) * (near(*before) + near(least)) / 2.0;
            self.integrated += (now.t - t0) * (short(*before) + short(least)) / 2.0;
        }
        self.curve.push((now.t, least));
    }

    fn values(&self, _end: &End<'_>) -> Vec<Measured> {
        let curve: Series = self.curve.iter().copied().collect();
        let why = "never on a collision course";
        let smallest = curve.least().map(|(_, time)| time).filter(|time| *time < FAR_SECS);
        let on_course = curve.time_below(FAR_SECS - 1e-6);
        let fifth = (curve.length_s() > 0.0 && smallest.is_some())
            .then(|| curve.time_quantile(0.05 * on_course / curve.length_s()))
            .flatten()
            .filter(|time| *time < FAR_SECS);
        vec![or_why(smallest, why), or_why(fifth, why), Ok(self.exposed), Ok(self.integrated)]
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::{Walk, recording};
    use crate::metrics::tests::{at_both_rates, value};

    #[test]
    fn two_discs_head_on_have_the_time_of_their_gap() {
        // 10 m apart, closing at 2 m/s, radii 0.53 m together: 4.735 s at the start, 1.735 s after 3 s.
        let walks = || vec![Walk::robot(0., 0., 1., 0.), Walk::human(1, 10., 0., -1., 0.)];
        at_both_rates(&walks, 3.0, "ttc_min", 1.735, 1e-6);
        at_both_rates(&walks, 3.0, "time_exposed_ttc", 3.0 - 1.735, 0.06);
        at_both_rates(&walks, 3.0, "time_integrated_ttc", (3.0_f64 - 1.735).powi(2) / 2.0, 0.02);
    }

    #[test]
    fn a_tangent_outside_the_radii_is_no_collision_course() {
        let run = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 10., 0.54, -1., 0.)], 10.0, 0.1);
        assert_eq!(value(&run, "ttc_min"), None);
        assert_eq!(value(&run, "time_exposed_ttc"), Some(0.0));
        let graze = recording(&[Walk::robot(0., 0., 1., 0.), Walk::human(1, 10., 0.52, -1., 0.)], 4.0, 0.1);
        assert!(value(&graze, "ttc_min").is_some());
    }
}
