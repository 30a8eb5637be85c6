//! The shortest way over a costmap: plans from corner to corner of square floors with posts, CPU time of each.
//!
//! `cargo bench --workspace --bench navfn -- [SIZE]...` takes the sides to run, in cells (200 400 1000 2000); without one, all.

#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

mod common;

use std::hint::black_box;

use common::machine::{cpu_s, told};
use common::median;
use socrates_model::{Cell, Grid, Pose};
use socrates_planners::costmap::{
    Costmap, CostmapParams, InflationParams, LayerParams, LayeredCostmap, Sensed, StaticParams,
};
use socrates_planners::navfn::{NavFn, NavFnParams};

const SIZES: [usize; 4] = [200, 400, 1000, 2000];
const ROUNDS: usize = 9;
/// At least this much CPU time per round, s: well above the clock tick of the system.
const SLICE_S: f64 = 0.1;
const CELL_M: f64 = 0.05;
/// Posts of 0.1 m for each square meter of floor.
const POSTS_PER_M2: f64 = 0.2;
/// Room at the corners, m.
const CORNER_M: f64 = 1.0;

/// A floor with posts, inflated to 0.8 m.
fn posts(cells: usize) -> Costmap {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut below = |end: usize| {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32) as usize % end
    };
    let mut grid = Grid {
        width: cells,
        height: cells,
        resolution_m: CELL_M,
        origin: Pose::new(0.0, 0.0, 0.0),
        cells: vec![Cell::Free; cells * cells],
    };
    let side_m = cells as f64 * CELL_M;
    for _ in 0..(side_m * side_m * POSTS_PER_M2) as usize {
        let (column, row) = (below(cells - 1), below(cells - 1));
        let corner = (CORNER_M / CELL_M) as usize;
        if (column < 2 * corner && row < 2 * corner) || (column > cells - 2 * corner && row > cells - 2 * corner) {
            continue;
        }
        // Rows of the picture come from the top; a square of posts does not mind.
        for place in [0, 1, cells, cells + 1] {
            if let Some(cell) = grid.cells.get_mut((cells - 2 - row) * cells + column + place) {
                *cell = Cell::Occupied;
            }
        }
    }
    let inflation = InflationParams { inflation_radius: 0.8, cost_scaling_factor: 3.0, inflate_unknown: false };
    let layers = vec![LayerParams::Static(StaticParams::default()), LayerParams::Inflation(inflation)];
    let params = CostmapParams { layers, ..CostmapParams::default() };
    let mut layered = LayeredCostmap::new(&params, &grid, 0.22);
    let pose = Pose::new(0.0, 0.0, 0.0);
    layered.update(&Sensed { now_s: 0.0, pose, radius_m: 0.22, footprint: &[], scan: None, people: &[] });
    layered.map().clone()
}

/// CPU time of a plan, s, and the length of its path, m.
fn plan(map: &Costmap, use_astar: bool) -> (f64, f64) {
    let mut navfn = NavFn::new(&NavFnParams { use_astar, ..NavFnParams::default() });
    let far_m = map.width() as f64 * CELL_M - CORNER_M;
    let (start, goal) = (Pose::new(CORNER_M, CORNER_M, 0.0), Pose::new(far_m, far_m, 0.0));
    let mut path = Vec::new();
    let mut round = || {
        let before = cpu_s();
        let mut plans = 0_u32;
        loop {
            assert!(black_box(navfn.plan_into(map, &start, &goal, &mut path)).is_ok(), "a way leads through the posts");
            plans += 1;
            let spent = cpu_s() - before;
            if spent > SLICE_S {
                return spent / f64::from(plans);
            }
        }
    };
    let seconds = median((0..ROUNDS).map(|_| round()).collect());
    let ways = path.iter().zip(path.iter().skip(1));
    (seconds, ways.map(|(from, to)| (to.point() - from.point()).norm()).sum())
}

fn main() {
    let wanted: Vec<usize> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    println!("{}", told("NavFn from corner to corner among posts, one thread"));
    println!(
        "n x n cells of {CELL_M} m, {POSTS_PER_M2} posts a m2, inflation to 0.8 m; process CPU time, median of {ROUNDS} rounds"
    );
    println!("{:>6} {:>14} {:>12} {:>12} {:>14} {:>12}", "n", "Dijkstra ms", "ns a cell", "A* ms", "way m", "A* way m");
    for n in SIZES.into_iter().filter(|n| wanted.is_empty() || wanted.contains(n)) {
        let map = posts(n);
        let ((dijkstra_s, way_m), (astar_s, astar_m)) = (plan(&map, false), plan(&map, true));
        println!(
            "{n:>6} {:>14.2} {:>12.1} {:>12.2} {way_m:>14.2} {astar_m:>12.2}",
            dijkstra_s * 1e3,
            dijkstra_s * 1e9 / (n * n) as f64,
            astar_s * 1e3
        );
    }
}
