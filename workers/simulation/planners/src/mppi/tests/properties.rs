//! What holds whatever the noise is.

use super::*;
use crate::mppi::noise::Axes;
use crate::mppi::rows::Rows;

/// Changes the noise of a controller.
fn with_noise(mut mppi: Mppi, change: impl Fn(&mut Axes)) -> Mppi {
    change(&mut mppi.noise);
    mppi
}

fn each(rows: &mut Rows, change: impl Fn(&mut [f32])) {
    rows.iter_mut().for_each(change);
}

#[test]
fn weights_sum_to_one_and_are_the_larger_the_cheaper_a_trajectory() {
    let mut world = World::empty().with_disc(6.0, 5.1, 0.2);
    let mut mppi = Mppi::new(&bringup(400), 11).unwrap();
    for _ in 0..50 {
        world.step(&mut mppi);
        let sum: f64 = mppi.weights.iter().map(|weight| f64::from(*weight)).sum();
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        assert!(mppi.weights[400..].iter().all(|weight| weight.abs() < f32::MIN_POSITIVE), "padding has no weight");
        let mut both: Vec<(f32, f32)> = mppi.verdict.costs.iter().copied().zip(mppi.weights.iter().copied()).collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(both.windows(2).all(|pair| pair[0].1 >= pair[1].1));
    }
}

#[test]
fn weights_are_the_softmax_of_the_costs() {
    let world = World::empty().with_disc(6.0, 5.1, 0.2);
    let mut mppi = Mppi::new(&bringup(400), 11).unwrap();
    world.command(&mut mppi).unwrap();
    let costs: Vec<f64> = mppi.verdict.costs[..400].iter().map(|cost| f64::from(*cost)).collect();
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let parts: Vec<f64> = costs.iter().map(|cost| libm::exp((least - cost) / 0.3)).collect();
    let sum: f64 = parts.iter().sum();
    for (weight, part) in mppi.weights.iter().zip(&parts) {
        assert!((f64::from(*weight) - part / sum).abs() < 2e-6 * (part / sum) + 1e-9);
    }
}

#[test]
fn the_order_of_the_batch_does_not_matter() {
    let run = |change: &dyn Fn(&mut Axes)| {
        let mut world = World::empty().with_disc(6.0, 5.1, 0.2);
        let mut mppi = with_noise(Mppi::new(&bringup(400), 11).unwrap(), change);
        world.step(&mut mppi)
    };
    let plain = run(&|_| ());
    let turned = run(&|noise| {
        each(&mut noise.vx, |row| row[..400].rotate_left(123));
        each(&mut noise.wz, |row| row[..400].rotate_left(123));
    });
    let torn = run(&|noise| each(&mut noise.vx, |row| row[..400].rotate_left(123)));
    assert!((plain.vx - turned.vx).abs() < 1e-6 && (plain.omega - turned.omega).abs() < 1e-6, "{plain:?} {turned:?}");
    assert!((plain.omega - torn.omega).abs() > 1e-4, "other pairs of noise are another batch");
}

#[test]
fn a_mirrored_scene_gives_the_mirrored_command() {
    let run = |side: f64| {
        // On the middle of a row of cells, so that the mirrored map has the same cells.
        let lifted = |pose: &Pose| Pose { y: 5.025, ..*pose };
        let mut world = World::empty().with_disc(5.6, 5.025 + side * 0.1, 0.2);
        world.plan = world.plan.iter().map(lifted).collect();
        world.pose.y = 5.025;
        let mut mppi = Mppi::new(&bringup(400), 11).unwrap();
        if side < 0.0 {
            mppi = with_noise(mppi, |noise| each(&mut noise.wz, |row| row.iter_mut().for_each(|wz| *wz = -*wz)));
        }
        (0..40).map(|_| world.step(&mut mppi)).collect::<Vec<Twist>>()
    };
    let (left, right) = (run(1.0), run(-1.0));
    for (number, (left, right)) in left.iter().zip(&right).enumerate() {
        assert!(
            (left.vx - right.vx).abs() < 1e-3 && (left.omega + right.omega).abs() < 1e-3,
            "{number}: {left:?} {right:?}"
        );
    }
    assert!(left.iter().any(|command| command.omega.abs() > 0.05), "there is something to mirror");
}

#[test]
fn a_constant_cost_changes_nothing() {
    // Every cell of the floor costs 40: the same for every trajectory.
    let run = |offset: u8| {
        let mut world = World::empty();
        world.costmap.costs_mut().fill(offset);
        let mut mppi = Mppi::new(&bringup(400), 11).unwrap();
        (0..20).map(|_| world.step(&mut mppi)).collect::<Vec<Twist>>()
    };
    for (free, costly) in run(0).iter().zip(&run(40)) {
        assert!((free.vx - costly.vx).abs() < 1e-4 && (free.omega - costly.omega).abs() < 1e-4, "{free:?} {costly:?}");
    }
}

#[test]
fn where_the_map_lies_does_not_matter() {
    let run = |far: f64| {
        let mut world = World::empty().with_disc(6.0, 5.1, 0.2);
        let mut costmap = Costmap::new(200, 200, 0.05, Point::new(far, -far), FREE);
        costmap.costs_mut().copy_from_slice(world.costmap.costs());
        world.costmap = costmap;
        let moved = |pose: &Pose| Pose::new(pose.x + far, pose.y - far, pose.yaw);
        world.plan = world.plan.iter().map(moved).collect();
        world.pose = moved(&world.pose);
        let mut mppi = Mppi::new(&bringup(400), 11).unwrap();
        (0..20).map(|_| world.step(&mut mppi)).collect::<Vec<Twist>>()
    };
    for (near, far) in run(0.0).iter().zip(&run(4096.0)) {
        assert!((near.vx - far.vx).abs() < 5e-3 && (near.omega - far.omega).abs() < 5e-3, "{near:?} {far:?}");
    }
}
