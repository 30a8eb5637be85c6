//! Keeping to the plan all along.
//!
//! Active where at least the threshold is left of the plan, the farthest point F that any trajectory gets to is at least `offset`
//! points on, and no more than a share of the points before it (and no more than two) is blocked. A trajectory is sampled every so
//! many steps from the second sample on. Each sample belongs to the point of the plan whose arc length is nearest to the length
//! traveled so far; where that point is free, the distance to it counts, with the difference of headings as a third coordinate if
//! asked for. Term: the mean over the samples that count.

use pulp::Simd;

use super::{Critic, Price};
use crate::mppi::elementary::wrapped;
use crate::mppi::lanes::{LANES, Lanes, groups, groups_mut};
use crate::mppi::params::MppiParams;
use crate::mppi::rollout::Rollout;
use crate::mppi::rows::padded;
use crate::mppi::scene::{Plan, Scene, Verdict};

/// Blocked points that never matter.
const FEW_BLOCKED: usize = 2;
/// Parts that the plan is cut into, to find the point of an arc length at once: about 2 mm each.
const PARTS: u16 = 1024;

/// Parameters of `PathAlignCritic`.
#[derive(Debug, Clone, PartialEq)]
pub struct PathAlignParams {
    /// Whether it judges. Default true.
    pub enabled: bool,
    /// Power of the cost, at least 1. Default 1.
    pub cost_power: u32,
    /// Weight, per m. Default 10.
    pub cost_weight: f64,
    /// It judges where at least so much of the plan is left, m. Default 0.5.
    pub threshold_to_consider: f64,
    /// Points of the plan that a trajectory has to get to. Default 20.
    pub offset_from_furthest: usize,
    /// Every so many-th step is looked at, at least 1. Default 4.
    pub trajectory_point_step: usize,
    /// Share of points before the farthest one that may be blocked, 0 to 1. Default 0.07.
    pub max_path_occupancy_ratio: f64,
    /// Whether headings count. Default false.
    pub use_path_orientations: bool,
}

impl Default for PathAlignParams {
    fn default() -> Self {
        Self {
            enabled: true,
            cost_power: 1,
            cost_weight: 10.0,
            threshold_to_consider: 0.5,
            offset_from_furthest: 20,
            trajectory_point_step: 4,
            max_path_occupancy_ratio: 0.07,
            use_path_orientations: false,
        }
    }
}

#[derive(Debug)]
struct PathAlign {
    price: Price,
    threshold_m: f32,
    offset: usize,
    stride: usize,
    max_blocked: f32,
    headings: bool,
    table: Table,
    traveled: Vec<f32>,
    sums: Vec<f32>,
    counts: Vec<f32>,
}

pub(super) fn make(params: &MppiParams) -> Option<Box<dyn Critic>> {
    let own = &params.path_align_critic;
    own.enabled.then(|| {
        let row = || vec![0.0; padded(params.batch_size)];
        Box::new(PathAlign {
            price: Price::new(own.cost_weight, own.cost_power),
            threshold_m: own.threshold_to_consider as f32,
            offset: own.offset_from_furthest,
            stride: own.trajectory_point_step.max(1),
            max_blocked: own.max_path_occupancy_ratio as f32,
            headings: own.use_path_orientations,
            table: Table::default(),
            traveled: row(),
            sums: row(),
            counts: row(),
        }) as Box<dyn Critic>
    })
}

impl Critic for PathAlign {
    fn score(&mut self, scene: &Scene<'_>, rollout: &Rollout, verdict: &mut Verdict) {
        if scene.left_m < self.threshold_m {
            return;
        }
        let count = verdict.furthest(scene, rollout);
        if count == 0 || count < self.offset {
            return;
        }
        let valid = verdict.valid(scene);
        let blocked = valid.iter().take(count).filter(|valid| !**valid).count();
        if blocked > FEW_BLOCKED && blocked as f32 / count as f32 > self.max_blocked {
            return;
        }
        self.table.set(scene.plan, valid, count);
        for row in [&mut self.traveled, &mut self.sums, &mut self.counts] {
            row.fill(0.0);
        }
        scene.arch.dispatch(Pass { critic: self, rollout, costs: &mut verdict.costs });
    }
}

/// A point of the plan: where it is, its heading, and 1 where it is free, else 0.
type PathPoint = [f32; 4];

/// Finds the point of the plan that is nearest by arc length.
#[derive(Debug, Clone, Default)]
struct Table {
    points: Vec<PathPoint>,
    /// Arc length from which on each point is nearest, m.
    from_m: Vec<f32>,
    /// The point at the beginning of each part of the plan.
    parts: Vec<u16>,
    parts_per_m: f32,
}

impl Table {
    /// Takes over the first points of a plan.
    fn set(&mut self, plan: &Plan, valid: &[bool], count: usize) {
        let count = count.min(usize::from(u16::MAX));
        self.points.clear();
        let poses = plan.x.iter().zip(&plan.y).zip(&plan.yaw).zip(valid).take(count);
        self.points.extend(poses.map(|(((x, y), yaw), valid)| [*x, *y, *yaw, f32::from(u8::from(*valid))]));
        self.from_m.clear();
        self.from_m.push(f32::NEG_INFINITY);
        let steps = plan.s.iter().zip(plan.s.iter().skip(1)).take(self.points.len().saturating_sub(1));
        // Halfway between two points, which is the second's.
        self.from_m.extend(steps.map(|(before, after)| before + (after - before) * 0.5));
        let length = self.from_m.last().copied().unwrap_or_default().max(f32::MIN_POSITIVE);
        self.parts_per_m = f32::from(PARTS) / length;
        self.parts.clear();
        let mut point = 0_u16;
        for part in 0..=PARTS {
            // A little before the part begins, so that rounding never skips a point.
            let begin = (f32::from(part) - 0.01) / self.parts_per_m;
            while self.from_m.get(usize::from(point) + 1).is_some_and(|from| *from <= begin) {
                point += 1;
            }
            self.parts.push(point);
        }
    }

    /// The point that is nearest to an arc length of at least 0.
    #[inline(always)]
    fn nearest(&self, s: f32) -> PathPoint {
        let part = ((s * self.parts_per_m) as usize).min(usize::from(PARTS));
        let mut point = self.parts.get(part).copied().map(usize::from).unwrap_or_default();
        while self.from_m.get(point + 1).is_some_and(|from| *from <= s) {
            point += 1;
        }
        self.points.get(point).copied().unwrap_or_default()
    }
}

struct Pass<'a> {
    critic: &'a mut PathAlign,
    rollout: &'a Rollout,
    costs: &'a mut [f32],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (stride, headings) = (self.critic.stride, self.critic.headings);
        let PathAlign { table, traveled, sums, counts, .. } = &mut *self.critic;
        let steps = self.rollout.steps();
        for step in (stride..steps).step_by(stride) {
            let Rollout { x, y, yaw, .. } = self.rollout;
            let now = x.row(step).as_chunks().0.iter().zip(y.row(step).as_chunks().0).zip(yaw.row(step).as_chunks().0);
            let before = x.row(step - stride).as_chunks().0.iter().zip(y.row(step - stride).as_chunks().0);
            let sums = sums.as_chunks_mut().0.iter_mut().zip(counts.as_chunks_mut().0);
            let rows = traveled.as_chunks_mut().0.iter_mut().zip(sums);
            for ((traveled, (sum, count)), (now, before)) in rows.zip(now.zip(before)) {
                travel(simd, traveled, now.0, before);
                let mut points = [[0.0; LANES]; 4];
                let [px, py, pyaw, free] = &mut points;
                let lanes = px.iter_mut().zip(py).zip(pyaw.iter_mut().zip(free));
                for (((x, y), (yaw, free)), s) in lanes.zip(traveled.iter()) {
                    [*x, *y, *yaw, *free] = table.nearest(*s);
                }
                add(simd, &points, now, headings, (sum, count));
            }
        }
        let terms =
            groups_mut::<S>(self.costs).zip(groups(simd, &self.critic.sums).zip(groups(simd, &self.critic.counts)));
        for (cost, (sum, count)) in terms {
            // Without any sample the sum is 0 as well.
            let term = sum / count.max(count.like(1.0));
            *cost = (Lanes::new(simd, *cost) + self.critic.price.of(term)).raw;
        }
    }
}

type Chunk = [f32; LANES];

/// Lengths traveled up to these positions.
#[inline(always)]
fn travel<S: Simd>(simd: S, traveled: &mut Chunk, (x, y): (&Chunk, &Chunk), (x0, y0): (&Chunk, &Chunk)) {
    let now = groups(simd, x).zip(groups(simd, y));
    let before = groups(simd, x0).zip(groups(simd, y0));
    for (traveled, ((x, y), (x0, y0))) in groups_mut::<S>(traveled).zip(now.zip(before)) {
        let (dx, dy) = (x - x0, y - y0);
        *traveled = (Lanes::new(simd, *traveled) + (dx * dx + dy * dy).sqrt()).raw;
    }
}

/// Adds the distances to the points of the plan.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    [px, py, pyaw, free]: &[Chunk; 4],
    ((x, y), yaw): ((&Chunk, &Chunk), &Chunk),
    headings: bool,
    (sums, counts): (&mut Chunk, &mut Chunk),
) {
    let points = groups(simd, px).zip(groups(simd, py)).zip(groups(simd, pyaw)).zip(groups(simd, free));
    let poses = groups(simd, x).zip(groups(simd, y)).zip(groups(simd, yaw));
    let sums = groups_mut::<S>(sums).zip(groups_mut::<S>(counts));
    for ((sum, count), ((((px, py), pyaw), free), ((x, y), yaw))) in sums.zip(points.zip(poses)) {
        let (dx, dy) = (px - x, py - y);
        let mut square = dx * dx + dy * dy;
        if headings {
            let turned = wrapped(pyaw - yaw);
            square = square + turned * turned;
        }
        *sum = (Lanes::new(simd, *sum) + free * square.sqrt()).raw;
        *count = (Lanes::new(simd, *count) + free).raw;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_finds_the_point_that_is_nearest_by_arc_length() {
        let mut plan = Plan::default();
        let mut x = 0.0;
        for number in 0..60_u8 {
            plan.push(x, 0.0, 0.0);
            // Points on one spot, close together and far apart.
            x += [0.0, 0.025, 0.025, 0.3, 0.001][usize::from(number) % 5];
        }
        let valid = vec![true; 59];
        let mut table = Table::default();
        table.set(&plan, &valid, 50);
        for step in 0..5000_u16 {
            let s = f32::from(step) * 0.001;
            let found = table.nearest(s)[0];
            let wanted = plan.s[..50].iter().fold(f32::MAX, |least, at| least.min((at - s).abs()));
            assert!(((found - s).abs() - wanted).abs() < 1e-6, "{s}: {found}");
        }
    }
}
