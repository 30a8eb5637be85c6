//! Updates of a costmap: a window that goes with the robot among people, by sets of layers, CPU time of each.
//!
//! `cargo bench --workspace --bench costmap`

#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

mod common;

use common::machine::{cpu_s, told};
use common::median;
use socrates_model::{Cell, Grid, HumanId, Point, Pose, SeenPerson, Vector};
use socrates_planners::costmap::{
    CostmapParams, GroupsParams, InflationParams, LayerParams, LayeredCostmap, Nav2CanParams, ObstacleParams, Scan,
    Sensed, StaticParams, UpoSocialParams,
};

const ROUNDS: usize = 9;
/// Updates of a round: 10 s at 30 Hz.
const UPDATES: u32 = 300;
const PEOPLE: u32 = 10;
const RANGE_M: f64 = 12.0;

/// People in a ring round the middle of the floor.
fn people() -> Vec<SeenPerson> {
    let one = |number: u32| {
        let angle = f64::from(number) * std::f64::consts::TAU / f64::from(PEOPLE);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        SeenPerson {
            id: HumanId::new(number + 1),
            at: Point::new(15.0 + 2.5 * cos, 15.0 + 2.5 * sin),
            velocity: Vector::new(-sin, cos),
            yaw: angle,
            radius_m: 0.28,
            gesture: None,
        }
    };
    (0..PEOPLE).map(one).collect()
}

/// What the lidar says among them.
fn scan(from: Pose, people: &[SeenPerson]) -> Scan {
    let range = |beam: u32| {
        let angle = from.yaw + f64::from(beam).to_radians();
        let ahead = Vector::new(libm::cos(angle), libm::sin(angle));
        let hit = |person: &SeenPerson| {
            let to = person.at - from.point();
            let (along, aside) = (to.dot(&ahead), to.perp(&ahead));
            let inside = person.radius_m * person.radius_m - aside * aside;
            (inside >= 0.0 && along > 0.0).then(|| along - inside.sqrt())
        };
        people.iter().filter_map(hit).fold(RANGE_M, f64::min)
    };
    Scan { from, ranges_m: (0..360).map(range).collect(), range_max_m: RANGE_M }
}

/// CPU time of an update while the robot goes straight on at 0.5 m/s, s.
fn update(layers: Vec<LayerParams>, rolling_window: bool, grid: &Grid) -> f64 {
    let people = people();
    let params = CostmapParams {
        width_m: 15.0,
        height_m: 15.0,
        resolution_m: 0.05,
        rolling_window,
        layers,
        ..CostmapParams::default()
    };
    let mut layered = LayeredCostmap::new(&params, grid, 0.22);
    let scans: Vec<Scan> =
        (0..UPDATES).map(|step| scan(Pose::new(12.5 + f64::from(step) / 60.0, 15.0, 0.0), &people)).collect();
    let mut round = || {
        let before = cpu_s();
        for (step, scan) in scans.iter().enumerate() {
            let now_s = step as f64 / 30.0;
            let (scan, people) = (Some(scan), people.as_slice());
            let pose = scan.map_or(Pose::new(0.0, 0.0, 0.0), |scan| scan.from);
            layered.update(&Sensed { now_s, pose, radius_m: 0.22, footprint: &[], scan, people });
        }
        (cpu_s() - before) / f64::from(UPDATES)
    };
    median((0..ROUNDS).map(|_| round()).collect())
}

fn main() {
    println!("{}", told("updates of a costmap among people, one thread"));
    println!("{PEOPLE} people, cells of 0.05 m; process CPU time, median of {ROUNDS} rounds of {UPDATES} updates");
    let side = 600;
    let (cells, origin) = (vec![Cell::Free; side * side], Pose::new(0.0, 0.0, 0.0));
    let grid = Grid { width: side, height: side, resolution_m: 0.05, origin, cells };
    let inflation = InflationParams { inflation_radius: 0.5, cost_scaling_factor: 3.0, inflate_unknown: false };
    let obstacle = || LayerParams::Obstacle(ObstacleParams::default());
    let lidar = || vec![obstacle(), LayerParams::Inflation(inflation)];
    let with = |more: Vec<LayerParams>| [lidar(), more].concat();
    let walls = vec![LayerParams::Static(StaticParams::default()), obstacle(), LayerParams::Inflation(inflation)];
    let cases = [
        ("window 15 x 15 m: lidar, inflation", lidar(), true),
        ("the same and upo_social", with(vec![LayerParams::UpoSocial(UpoSocialParams::example())]), true),
        ("the same and Nav2CAN's", with(vec![LayerParams::Nav2Can(Nav2CanParams::default())]), true),
        ("the same and groups", with(vec![LayerParams::Groups(GroupsParams::default())]), true),
        ("floor 30 x 30 m: walls, lidar, inflation", walls, false),
    ];
    println!("{:<42} {:>12}", "layers", "us an update");
    for (name, layers, rolling) in cases {
        println!("{name:<42} {:>12.0}", update(layers, rolling, &grid) * 1e6);
    }
}
