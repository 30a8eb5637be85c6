//! Social forces on everybody, with an error bound.

use nalgebra::{Point2, Vector2};

use super::cells::{Cells, Extent};
use super::density::Density;
use super::pairs::{Body, Pairs};
use super::prune::{Me, Prune, Test, WIDTH};
use super::rough::{self, Rough};
use super::settings::{BadSettings, Instructions, check_error};
use crate::params::Params;
use crate::person::Person;
use crate::vector::norm;

/// Rows and columns of cells per reach: few enough that a span is worth its look-up.
const ROWS_PER_REACH: f64 = 4.0;
const COLUMNS_PER_REACH: f64 = 48.0;

/// From this size on a crowd is counted before its threshold is chosen.
const LARGE: usize = 500;
/// Distances for which others are counted, as shares of the reach; the last holds everybody.
const COUNTED_REACHES: [f64; 8] = [0.3, 0.45, 0.6, 0.75, 0.9, 1.05, 1.3, f64::INFINITY];

/// Works out the social forces of a crowd, each within an error bound of the sum over all others.
///
/// Keeps its memory between calls and takes more only for a crowd that is larger, wider or denser than
/// any before. The result depends on the people alone, not on earlier calls or on the processor.
#[derive(Debug, Clone)]
pub struct Social {
    params: Params,
    error_mps2: f64,
    arch: pulp::Arch,
    bodies: Vec<Body>,
    density: Density,
    cells: Cells,
    order: Vec<u32>,
    sorted: Sorted,
    pairs: Pairs,
    /// Where the bound leaves room for f32.
    rough: Option<Rough>,
    /// Those who are kept with one person.
    kept: Vec<u32>,
    sums: Vec<Vector2<f64>>,
    forces: Vec<Vector2<f64>>,
}

/// The crowd sorted by cell: in full, and once more in f32 for the test of pairs, with [`WIDTH`] unused
/// places at the end so that the last full read stays inside.
#[derive(Debug, Clone, Default)]
struct Sorted {
    bodies: Vec<Body>,
    x: Vec<f32>,
    y: Vec<f32>,
    vx: Vec<f32>,
    vy: Vec<f32>,
}

impl Sorted {
    #[expect(clippy::cast_possible_truncation, reason = "the test of pairs is made in f32 on purpose")]
    fn fill(&mut self, bodies: &[Body], order: &[u32], middle: (f64, f64)) {
        self.bodies.clear();
        self.bodies.extend(order.iter().filter_map(|place| bodies.get(*place as usize)));
        let fill = |row: &mut Vec<f32>, value: &dyn Fn(&Body) -> f64| {
            row.clear();
            row.extend(self.bodies.iter().map(|body| value(body) as f32));
            row.resize(self.bodies.len() + WIDTH, 0.0);
        };
        fill(&mut self.x, &|body| body.x - middle.0);
        fill(&mut self.y, &|body| body.y - middle.1);
        fill(&mut self.vx, &|body| body.vx);
        fill(&mut self.vy, &|body| body.vy);
    }
}

impl Social {
    /// Social forces within `error_mps2` of the sum over all pairs; 0 keeps every pair.
    ///
    /// # Errors
    /// [`BadSettings`] if the constants cannot be meant or the bound is negative or not finite.
    pub fn new(params: &Params, error_mps2: f64) -> Result<Self, BadSettings> {
        params.check()?;
        check_error(error_mps2)?;
        Ok(Self {
            params: params.clone(),
            error_mps2,
            arch: Instructions::Detected.arch(),
            bodies: Vec::new(),
            density: Density::default(),
            cells: Cells::default(),
            order: Vec::new(),
            sorted: Sorted::default(),
            pairs: Pairs::new(params),
            rough: (error_mps2 >= rough::FROM_MPS2).then(|| Rough::new(params)),
            kept: Vec::new(),
            sums: Vec::new(),
            forces: Vec::new(),
        })
    }

    /// The same with a choice of instructions. Gives the same bytes; for tests and benches.
    #[must_use]
    pub fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.arch = instructions.arch();
        self
    }

    /// Social force on everybody, m/s², in the order given.
    ///
    /// Somebody whose position or velocity is not finite feels nobody and is felt by nobody. For two
    /// people on one spot, or whose interaction points straight at each other, [`crate::forces()`]
    /// decides.
    pub fn forces(&mut self, people: &[Person]) -> &[Vector2<f64>] {
        self.load(people.iter().map(|person| (person.position, person.velocity)));
        self.run()
    }

    /// Takes positions and velocities.
    pub(super) fn load(&mut self, people: impl Iterator<Item = (Point2<f64>, Vector2<f64>)>) {
        self.bodies.clear();
        self.bodies.extend(people.map(|(position, velocity)| Body {
            x: position.x,
            y: position.y,
            vx: velocity.x,
            vy: velocity.y,
        }));
    }

    /// The threshold for the people loaded: of a large crowd, from how dense it is.
    fn prune(&mut self, extent: &Extent, fastest_mps: f64) -> Prune {
        // What rounding may take is not there for what is left out.
        let error_mps2 = self.error_mps2 * if self.rough.is_some() { 1.0 - rough::SHARE } else { 1.0 };
        let prune = Prune::new(&self.params, self.bodies.len(), error_mps2);
        let most_range_m = self.params.gamma_m * (1.0 + 2.0 * self.params.lambda * fastest_mps);
        let reach_m = prune.threshold() * most_range_m;
        if self.bodies.len() < LARGE || reach_m >= extent.size_m() {
            return prune;
        }
        self.density.count(self.bodies.iter().filter(|body| body.is_finite()), extent, most_range_m);
        let within = COUNTED_REACHES.map(|share| self.density.within(share * reach_m));
        prune.with_density(&self.params, error_mps2, &within, most_range_m)
    }

    /// Works out the forces on the people loaded.
    pub(super) fn run(&mut self) -> &[Vector2<f64>] {
        self.forces.clear();
        self.forces.resize(self.bodies.len(), Vector2::zeros());
        let felt = || self.bodies.iter().filter(|body| body.is_finite());
        let Some(extent) = Extent::of(felt()) else { return &self.forces };
        let fastest = felt().fold(0.0_f64, |fastest, body| fastest.max(norm(&Vector2::new(body.vx, body.vy))));
        let prune = self.prune(&extent, fastest);
        let reach_m = prune.circle(fastest, fastest).radius_m;
        let (width_m, height_m) = (reach_m / COLUMNS_PER_REACH, reach_m / ROWS_PER_REACH);
        self.cells.sort(&self.bodies, &extent, width_m, height_m, &mut self.order);
        self.sorted.fill(&self.bodies, &self.order, extent.middle());
        self.sums.clear();
        self.sums.resize(self.order.len(), Vector2::zeros());
        // Room for everybody, so that none has to be made while pairs are tested.
        self.kept.resize(self.order.len() + 2 * WIDTH, 0);
        let sweep = Sweep {
            sorted: &self.sorted,
            cells: &self.cells,
            prune: &prune,
            test: prune.test(extent.size_m()),
            fastest_mps: fastest,
        };
        let (pairs, rough) = (&mut self.pairs, self.rough.as_mut());
        self.arch.dispatch(Pass { sweep, pairs, rough, kept: &mut self.kept, sums: &mut self.sums });
        for (place, sum) in self.order.iter().zip(&self.sums) {
            if let Some(force) = self.forces.get_mut(*place as usize) {
                *force = *sum;
            }
        }
        &self.forces
    }
}

/// One pass over all pairs that may matter, each pair once.
struct Sweep<'a> {
    sorted: &'a Sorted,
    cells: &'a Cells,
    prune: &'a Prune,
    test: Test,
    fastest_mps: f64,
}

/// A sweep together with what it writes: compiled once per set of instructions.
struct Pass<'a> {
    sweep: Sweep<'a>,
    pairs: &'a mut Pairs,
    rough: Option<&'a mut Rough>,
    kept: &'a mut [u32],
    sums: &'a mut [Vector2<f64>],
}

impl pulp::WithSimd for Pass<'_> {
    type Output = ();

    // The token is not used: the code is plain arithmetic, which the compiler turns into the vectors of
    // the set of instructions that this is compiled for. Everything called here must be inlined.
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.sweep.run(self.pairs, self.rough, self.kept, self.sums);
    }
}

impl Sweep<'_> {
    /// Everybody with those who come later in the sorted crowd: to the right in the own row, and all in
    /// reach in the rows above.
    #[inline(always)]
    fn run(&self, pairs: &mut Pairs, mut rough: Option<&mut Rough>, kept: &mut [u32], sums: &mut [Vector2<f64>]) {
        for (place, me) in self.sorted.bodies.iter().enumerate() {
            let speed = norm(&Vector2::new(me.vx, me.vy));
            let circle = self.prune.circle(speed, self.fastest_mps);
            let ahead = if speed > 0.0 { circle.ahead_m / speed } else { 0.0 };
            let (x, y, radius) = (me.x + me.vx * ahead, me.y + me.vy * ahead, circle.radius_m);
            let own_row = self.cells.row(me.y);
            let mut count = 0;
            for row in own_row..self.cells.rows() {
                let off = self.cells.off_row(row, y);
                if off < -radius {
                    break;
                }
                if off > radius {
                    continue;
                }
                let half = (radius * radius - off * off).sqrt();
                let (from, to) = self.cells.span(row, x - half, x + half);
                let from = if row == own_row { from.max(place + 1) } else { from };
                count = self.span(place, (from, to), kept, count);
            }
            let others = kept.get(..count).unwrap_or_default();
            if let Some(rough) = &mut rough {
                rough.extend(place, others, &self.sorted.bodies, pairs, sums);
                continue;
            }
            for other in others {
                if let Some(body) = self.sorted.bodies.get(*other as usize) {
                    #[expect(clippy::cast_possible_truncation, reason = "places are u32 in the order as well")]
                    pairs.push(place as u32, me, *other, body, sums);
                }
            }
        }
        if let Some(rough) = rough {
            rough.flush(&self.sorted.bodies, pairs, sums);
        }
        pairs.flush(sums);
    }

    /// Adds to the first `count` of `kept` those from `from` to `to` whose pair with the person at `place` must be kept;
    /// gives the new count.
    ///
    /// Without branches on the outcome: they would be guessed wrong, and a wrong guess waits for the whole
    /// test. Every place is written, and only the kept ones are counted.
    #[inline(always)]
    fn span(&self, place: usize, (from, to): (usize, usize), kept: &mut [u32], mut count: usize) -> usize {
        let all = (&self.sorted.x, &self.sorted.y, &self.sorted.vx, &self.sorted.vy);
        let at = |row: &[f32]| row.get(place).copied().unwrap_or(f32::NAN);
        let me = Me { x: at(all.0), y: at(all.1), vx: at(all.2), vy: at(all.3) };
        let mut start = from;
        while start < to {
            let (Some(x), Some(y), Some(vx), Some(vy)) =
                (lanes(all.0, start), lanes(all.1, start), lanes(all.2, start), lanes(all.3, start))
            else {
                break;
            };
            let keeps = self.test.keeps(&me, x, y, vx, vy);
            if let Some(room) = kept.get_mut(count..).and_then(<[u32]>::first_chunk_mut::<WIDTH>) {
                count += sift(room, start, &keeps, to - start);
            }
            start += WIDTH;
        }
        count
    }
}

/// Writes the places, counted from `start`, that are kept among the first `len`; gives their number.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "places are u32 in the order as well")]
fn sift(room: &mut [u32; WIDTH], start: usize, keeps: &[u8; WIDTH], len: usize) -> usize {
    let mut count = 0;
    for (lane, keep) in keeps.iter().enumerate() {
        // The count is never beyond the lane; the remainder tells the compiler that it fits.
        if let Some(slot) = room.get_mut(count % WIDTH) {
            *slot = (start + lane) as u32;
        }
        count += usize::from(*keep) & usize::from(lane < len);
    }
    count
}

/// The full group of lanes that begins at `start`.
#[inline(always)]
fn lanes(row: &[f32], start: usize) -> Option<&[f32; WIDTH]> {
    row.get(start..).and_then(|rest| rest.first_chunk())
}
