//! The layers about people against their formulas, cell by cell.

use std::f64::consts::{FRAC_PI_2, PI};

use socrates_model::geometry::wrap_angle;
use socrates_model::{HumanId, Point, Pose, SeenPerson};

use super::fixture::{Chance, floor, person, sensed};
use super::groups::{Ellipse, GroupLayer};
use super::*;

fn people(chance: &mut Chance) -> Vec<SeenPerson> {
    let mut at = |size: f64| size * chance.share();
    let one = |id| {
        let (place, way) = ((at(6.0), at(4.0)), (at(2.4) - 1.2, at(2.4) - 1.2));
        person(id, place, if id == 1 { (0.0, 0.0) } else { way }, at(2.0 * PI) - PI)
    };
    (1..4).map(one).collect()
}

/// Compares a layer alone with a formula of the offset of a cell's center from a person, over random people; the largest counts.
fn compare(layer: &LayerParams, formula: &dyn Fn(&SeenPerson, f64, f64) -> f64) {
    let mut chance = Chance::new(11);
    let mut dear = 0;
    for round in 0..40 {
        let people = people(&mut chance);
        let params = CostmapParams { layers: vec![layer.clone()], ..CostmapParams::default() };
        let mut layered = LayeredCostmap::new(&params, &floor(60, 40), 0.22);
        layered.update(&sensed(Pose::new(3.0, 2.0, 0.0), None, &people));
        for row in 0..40 {
            for column in 0..60 {
                let cell = layered.map().center(column, row);
                let values = people.iter().map(|person| formula(person, cell.x - person.at.x, cell.y - person.at.y));
                let value = values.fold(0.0, f64::max);
                let cost = f64::from(layered.map().cost(column, row));
                // Where the formula is a whole number but for rounding, both neighbors are right.
                let near = [value - 1e-6, value + 1e-6].map(f64::trunc);
                assert!(near.contains(&cost), "round {round}, cell {column}, {row}: {cost} instead of {value}");
                dear += usize::from(cost > 0.0);
            }
        }
    }
    assert!(dear > 1000, "{dear} cells cost something");
}

/// A Gaussian whose axis has this angle, in the words of Lu's layers.
fn gaussian(dx: f64, dy: f64, axis: f64, along: f64, across: f64) -> f64 {
    let (distance, angle) = (dx.hypot(dy), dy.atan2(dx) - axis);
    let (x, y) = (angle.cos() * distance, angle.sin() * distance);
    (-(x * x / (2.0 * along) + y * y / (2.0 * across))).exp()
}

fn theta(person: &SeenPerson) -> f64 {
    person.velocity.y.atan2(person.velocity.x)
}

/// Whether a direction is within a quarter of a circle of an axis.
fn ahead(dx: f64, dy: f64, axis: f64) -> bool {
    wrap_angle(dy.atan2(dx) - axis).abs() < FRAC_PI_2
}

#[test]
fn the_proxemic_layer_is_long_in_front_and_round_behind() {
    compare(&LayerParams::Proxemic(ProxemicParams::default()), &|person, dx, dy| {
        let front = ahead(dx, dy, theta(person));
        let along = if front { 0.25 * (1.0 + 5.0 * person.velocity.norm()) } else { 0.25 };
        let value = 77.0 * gaussian(dx, dy, theta(person), along, 0.25);
        if value < 10.0 { 0.0 } else { value }
    });
}

#[test]
fn the_passing_layer_is_dear_to_the_right_alone() {
    let params = ProxemicParams { passing: true, ..ProxemicParams::default() };
    compare(&LayerParams::Proxemic(params), &|person, dx, dy| {
        let axis = theta(person) + if person.velocity.norm() > 0.0 { PI } else { 0.0 } + 1.51;
        // Somebody who stands has no side in the source; ours is that of a walk along x.
        let axis = if person.velocity.norm() > 0.0 { axis } else { axis + PI };
        let value = 77.0 * gaussian(dx, dy, axis, 0.25 * (1.0 + 5.0 * person.velocity.norm()), 0.25);
        if !ahead(dx, dy, axis) || value < 10.0 { 0.0 } else { value }
    });
    let right = params.cost(&person(1, (0.0, 0.0), (1.0, 0.0), 0.0), &socrates_model::Vector::new(0.0, -0.5));
    let left = params.cost(&person(1, (0.0, 0.0), (1.0, 0.0), 0.0), &socrates_model::Vector::new(0.0, 0.5));
    assert!(right > Some(50) && left.is_none(), "{right:?}, {left:?}");
}

#[test]
fn the_social_layer_takes_the_largest_of_front_rear_and_right() {
    let params = UpoSocialParams::example();
    compare(&LayerParams::UpoSocial(params), &|person, dx, dy| {
        let (axis, speed) = (theta(person), person.velocity.norm());
        let value = if speed < 0.1 {
            gaussian(dx, dy, 0.0, 0.25, 0.25)
        } else {
            let front = ahead(dx, dy, axis);
            let own = if front { (0.4 * (1.0 + 5.0 * speed), 0.25) } else { (0.25, 0.25) };
            let right =
                if ahead(dx, dy, axis - FRAC_PI_2) { gaussian(dx, dy, axis - FRAC_PI_2, 0.3, 0.2) } else { 0.0 };
            gaussian(dx, dy, axis, own.0, own.1).max(right)
        };
        if 252.0 * value < 10.0 { 0.0 } else { 252.0 * value }
    });
}

#[test]
fn zones_end_where_the_gaussian_has_its_values_to_the_side() {
    compare(&LayerParams::Nav2Can(Nav2CanParams::default()), &|person, dx, dy| {
        let t = person.yaw;
        let front = ahead(dx, dy, t);
        let (s2, ss2) = (if front { 4.0 } else { 1.0 }, 16.0 / 9.0);
        let a = t.cos().powi(2) / (2.0 * s2) + t.sin().powi(2) / (2.0 * ss2);
        let b = (2.0 * t).sin() / (4.0 * s2) - (2.0 * t).sin() / (4.0 * ss2);
        let c = t.sin().powi(2) / (2.0 * s2) + t.cos().powi(2) / (2.0 * ss2);
        let g = (-(a * dx * dx + 2.0 * b * dx * dy + c * dy * dy)).exp();
        let at = |side: f64| (-side * side / (2.0 * ss2)).exp();
        if g > at(0.5) {
            252.0
        } else if g > at(1.0) {
            (252.0 * at(1.0)).floor()
        } else if g > at(1.5) {
            252.0 * g
        } else {
            0.0
        }
    });
    let params = Nav2CanParams::default();
    let facing = person(1, (0.0, 0.0), (0.0, 0.0), 0.0);
    let zone = |x: f64, y: f64| params.cost(&facing, &socrates_model::Vector::new(x, y));
    let bands = [
        ((0.0, 0.49), 252),
        ((0.0, 0.51), 190),
        ((0.0, 0.99), 190),
        ((0.74, 0.0), 252),
        ((0.76, 0.0), 190),
        ((1.49, 0.0), 190),
        ((2.26, 0.0), 0),
        ((-0.37, 0.0), 252),
        ((-0.38, 0.0), 190),
        ((-1.13, 0.0), 0),
        ((0.0, 1.51), 0),
    ];
    for ((x, y), cost) in bands {
        assert_eq!(zone(x, y), cost, "at {x}, {y}");
    }
    assert!((134..190).contains(&zone(0.0, 1.2)));
}

#[test]
fn unknown_cells_stay_unknown_beside_people() {
    let social = LayerParams::UpoSocial(UpoSocialParams::default());
    let params = CostmapParams { layers: vec![social], track_unknown_space: true, ..CostmapParams::default() };
    let mut layered = LayeredCostmap::new(&params, &floor(60, 40), 0.22);
    layered.update(&sensed(Pose::new(3.0, 2.0, 0.0), None, &[person(1, (3.0, 2.0), (0.0, 0.0), 0.0)]));
    assert!(layered.map().costs().iter().all(|cost| *cost == UNKNOWN));
}

#[test]
fn somebody_no_longer_seen_is_kept_for_a_while() {
    let params =
        CostmapParams { layers: vec![LayerParams::Proxemic(ProxemicParams::default())], ..CostmapParams::default() };
    let mut layered = LayeredCostmap::new(&params, &floor(60, 40), 0.22);
    let seen = [person(1, (3.0, 2.0), (0.0, 0.0), 0.0)];
    layered.update(&sensed(Pose::new(1.0, 2.0, 0.0), None, &seen));
    let mut at = |now_s: f64| {
        layered.update(&Sensed { now_s, ..sensed(Pose::new(1.0, 2.0, 0.0), None, &[]) });
        layered.map().cost_at(&Point::new(3.0, 2.0)) > 0
    };
    assert!(at(0.7));
    assert!(!at(0.8));
}

fn ids(groups: &[(u32, u32)]) -> GroupSource {
    GroupSource::Given(groups.iter().map(|(id, group)| (HumanId::new(*id), *group)).collect())
}

fn found(source: GroupSource, people: &[SeenPerson]) -> Vec<Ellipse> {
    let mut layer = GroupLayer::new(&GroupsParams { source, ..GroupsParams::default() });
    let map = Costmap::new(100, 100, 0.1, Point::new(-5.0, -5.0), 0);
    layer.look(&map, &sensed(Pose::new(0.0, 0.0, 0.0), None, people), &mut { Bounds::EMPTY });
    layer.ellipses().copied().collect()
}

#[test]
fn a_group_of_three_fills_the_box_of_its_members_and_a_pair_a_narrow_ellipse() {
    let three = [
        person(1, (1.0, 1.0), (0.0, 0.0), 0.0),
        person(2, (2.0, 1.5), (0.0, 0.0), 0.0),
        person(3, (1.0, 2.0), (0.0, 0.0), 0.0),
    ];
    let layers =
        vec![LayerParams::Groups(GroupsParams { source: ids(&[(1, 4), (2, 4), (3, 4)]), ..Default::default() })];
    let params = CostmapParams { layers, ..CostmapParams::default() };
    let mut layered = LayeredCostmap::new(&params, &floor(60, 40), 0.22);
    layered.update(&sensed(Pose::new(4.0, 2.0, 0.0), None, &three));
    for row in 0..40 {
        for column in 0..60 {
            let cell = layered.map().center(column, row);
            let inside = ((cell.x - 1.5) / 0.75).powi(2) + ((cell.y - 1.5) / 0.75).powi(2) <= 1.0;
            assert_eq!(layered.map().cost(column, row), if inside { INSCRIBED } else { FREE });
        }
    }
    let pair = found(ids(&[(1, 4), (2, 4)]), &three);
    assert_eq!(pair.len(), 1);
    assert!(
        (pair[0].half_m.0 - (1.25_f64.sqrt() / 2.0 + 0.25)).abs() < 1e-12 && (pair[0].half_m.1 - 0.4).abs() < 1e-12
    );
    assert!((pair[0].center - Point::new(1.5, 1.25)).norm() < 1e-12);
    assert!(found(ids(&[(1, 4), (2, 5)]), &three).is_empty(), "nobody is a group alone");
}

#[test]
fn people_who_look_at_one_another_are_a_group_and_others_are_not() {
    let rules = || GroupSource::FFormation(FFormationParams::default());
    let faces =
        |first: f64, second: f64| [person(1, (0.0, 0.0), (0.0, 0.0), first), person(2, (1.4, 0.0), (0.0, 0.0), second)];
    assert_eq!(found(rules(), &faces(0.0, PI)).len(), 1);
    assert!(found(rules(), &faces(PI, 0.0)).is_empty(), "back to back");
    assert!(found(rules(), &faces(FRAC_PI_2, -FRAC_PI_2)).is_empty());
    // Four round a middle, and somebody who only passes.
    let circle = |n: u32| {
        let angle = f64::from(n) * FRAC_PI_2;
        person(n + 1, (0.7 * angle.cos(), 0.7 * angle.sin()), (0.0, 0.0), angle + PI)
    };
    let mut all: Vec<SeenPerson> = (0..4).map(circle).collect();
    all.push(person(9, (0.0, -2.0), (1.2, 0.0), 0.0));
    let circles = found(rules(), &all);
    assert_eq!(circles.len(), 1);
    assert!(circles[0].center.coords.norm() < 1e-9 && (circles[0].half_m.0 - 0.95).abs() < 1e-9);
    // Somebody who stands between two parts them.
    let mut three = faces(0.0, PI).to_vec();
    three.push(person(3, (0.45, 0.0), (0.0, 0.0), FRAC_PI_2));
    assert!(found(rules(), &three).is_empty());
}

#[test]
fn people_who_walk_side_by_side_are_a_group() {
    let rules = || GroupSource::FFormation(FFormationParams::default());
    let pair =
        |other: (f64, f64), apart: f64| [person(1, (0.0, 0.0), (1.0, 0.0), 0.0), person(2, (0.2, apart), other, 0.0)];
    assert_eq!(found(rules(), &pair((1.1, 0.1), 0.8)).len(), 1);
    assert!(found(rules(), &pair((1.1, 0.1), 1.6)).is_empty(), "too far apart");
    assert!(found(rules(), &pair((0.6, 0.0), 0.8)).is_empty(), "too slow");
    assert!(found(rules(), &pair((0.8, 0.6), 0.8)).is_empty(), "another way");
    assert!(found(rules(), &pair((0.0, 0.0), 0.8)).is_empty(), "one stands");
}

#[test]
fn a_group_that_walks_leaves_no_trail_and_one_out_of_sight_stays_for_a_while() {
    let mut layer = GroupLayer::new(&GroupsParams { source: ids(&[(1, 4), (2, 4)]), ..GroupsParams::default() });
    let map = Costmap::new(100, 100, 0.1, Point::new(-5.0, -5.0), 0);
    let mut look = |now_s: f64, people: &[SeenPerson]| {
        let sensed = Sensed { now_s, ..sensed(Pose::new(0.0, 0.0, 0.0), None, people) };
        layer.look(&map, &sensed, &mut { Bounds::EMPTY });
        layer.ellipses().count()
    };
    let at = |x: f64| [person(1, (x, 0.0), (1.0, 0.0), 0.0), person(2, (x, 0.8), (1.0, 0.0), 0.0)];
    assert_eq!((look(0.0, &at(0.0)), look(0.5, &at(0.5)), look(1.0, &[]), look(2.5, &[])), (1, 1, 1, 1));
    assert_eq!(look(2.6, &[]), 0);
}
