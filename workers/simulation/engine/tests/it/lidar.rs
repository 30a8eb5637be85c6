//! Our scan against rapier's casts, beam by beam.

use crate::common::scene::{Oracle, Random, Scene, cross};
use socrates_engine::{BEAMS, Disc, scan_shapes};
use socrates_model::{Point, Pose, Vector};

const RANGE_M: f64 = 12.0;
/// rapier works in f32: a few micrometers at 12 m, more where a beam meets a wall at a slant.
const TOLERANCE_M: f64 = 2e-4;
/// Beams with more room than this for rounding say nothing.
const GRAZING_M: f64 = 0.01;

fn random_scene(random: &mut Random) -> Scene {
    let discs = (0..(random.between(0.0, 40.0) as u32))
        .map(|_| Disc {
            center: Point::new(random.between(-12.0, 12.0), random.between(-12.0, 12.0)),
            radius_m: random.between(0.05, 1.2),
        })
        .collect();
    let segments = (0..(random.between(0.0, 12.0) as u32))
        .map(|_| {
            let from = Point::new(random.between(-14.0, 14.0), random.between(-14.0, 14.0));
            (from, from + Vector::new(random.between(-9.0, 9.0), random.between(-9.0, 9.0)))
        })
        .collect();
    Scene { discs, segments }
}

/// How far rapier may be off on a beam: its squares of distances carry 1e-6, and near the border of a disc or the
/// end of a segment a small step aside is a large step along the beam.
fn rounding_m(scene: &Scene, from: &Pose, beam: usize) -> f64 {
    let angle = from.yaw + (beam as f64).to_radians();
    let heading = Vector::new(angle.cos(), angle.sin());
    let mut most = TOLERANCE_M;
    for disc in &scene.discs {
        let way = disc.center - from.point();
        let aside = heading.perp(&way).abs();
        let error = 1e-6 * (1.0 + way.norm_squared());
        let inside = disc.radius_m * disc.radius_m - aside * aside;
        if inside > -error && heading.dot(&way) > 0.0 {
            most = most.max(error / (2.0 * inside.max(1e-12).sqrt()));
        }
    }
    for (a, b) in &scene.segments {
        let along = (b - a) / (b - a).norm().max(1e-12);
        let ends = [a, b].iter().any(|end| {
            let way = *end - from.point();
            heading.perp(&way).abs() < 2e-5 && heading.dot(&way) > 0.0
        });
        let slant = heading.perp(&along).abs().max(1e-6);
        most = most.max(if ends { 1.0 } else { 1e-4 / slant });
    }
    most
}

/// The largest difference of beams that graze nothing, and how many do.
fn compare(scene: &Scene, from: &Pose) -> (f64, usize) {
    let ours = scan_shapes(from, &scene.discs, &scene.segments, RANGE_M).unwrap();
    let theirs = Oracle::new(scene).scan(from, RANGE_M);
    let mut worst: f64 = 0.0;
    let mut grazing = 0;
    for (beam, (a, b)) in ours.iter().zip(&theirs).enumerate() {
        let difference = (a - b).abs();
        let rounding = rounding_m(scene, from, beam);
        if rounding > GRAZING_M {
            grazing += 1;
        } else {
            assert!(difference <= rounding, "beam {beam} from {from:?}: {a}, rapier {b}, in {scene:?}");
            worst = worst.max(difference);
        }
    }
    (worst, grazing)
}

#[test]
fn random_scenes_are_scanned_as_rapier_casts_them() {
    let mut random = Random::new(11);
    let (mut worst, mut grazing): (f64, usize) = (0.0, 0);
    for _ in 0..400 {
        let scene = random_scene(&mut random);
        let from = Pose::new(random.between(-5.0, 5.0), random.between(-5.0, 5.0), random.between(-3.2, 3.2));
        let (off, slanted) = compare(&scene, &from);
        worst = worst.max(off);
        grazing += slanted;
    }
    assert!(worst < GRAZING_M && grazing < 400 * BEAMS / 20, "{worst} m, {grazing} grazing beams");
}

#[test]
fn crossings_are_scanned_as_rapier_casts_them() {
    for n in [10, 50, 1000] {
        let (scene, side) = cross(n);
        for spot in 0..20_u32 {
            let share = f64::from(spot) / 20.0;
            let from = Pose::new(side * (0.05 + 0.9 * share), side * (0.3 + 0.4 * share), 6.0 * share);
            compare(&scene, &from);
        }
    }
}

#[test]
fn inside_a_disc_every_beam_reads_zero() {
    let mut random = Random::new(5);
    for _ in 0..50 {
        let mut scene = random_scene(&mut random);
        let from = Pose::new(1.0, 2.0, random.between(-3.0, 3.0));
        let center = from.point() + Vector::new(random.between(-0.3, 0.3), random.between(-0.3, 0.3));
        scene.discs.push(Disc { center, radius_m: 0.5 });
        let ours = scan_shapes(&from, &scene.discs, &scene.segments, RANGE_M).unwrap();
        assert!(ours.iter().all(|range| *range == 0.0));
        assert!(Oracle::new(&scene).scan(&from, RANGE_M).iter().all(|range| *range == 0.0));
    }
}

#[test]
fn beams_that_graze_and_segments_without_length_give_no_nonsense() {
    // Tangent to beam 0, exactly and a hair to both sides.
    for (off, hits) in [(0.5, true), (0.5 - 1e-9, true), (0.5 + 1e-9, false)] {
        let disc = Disc { center: Point::new(4.0, off), radius_m: 0.5 };
        let ranges = scan_shapes(&Pose::new(0.0, 0.0, 0.0), &[disc], &[], RANGE_M).unwrap();
        assert_eq!(ranges[0] < RANGE_M, hits, "{off}: {}", ranges[0]);
        assert!(!hits || (ranges[0] - 4.0).abs() < 1e-3);
    }
    let post = (Point::new(3.0, 0.0), Point::new(3.0, 0.0));
    let flat = (Point::new(3.0, 0.0), Point::new(5.0, 0.0));
    let here = Pose::new(0.0, 0.0, 0.0);
    let ranges = scan_shapes(&here, &[], &[post], RANGE_M).unwrap();
    assert!(ranges.iter().all(|range| *range == RANGE_M));
    let ranges = scan_shapes(&here, &[], &[flat], RANGE_M).unwrap();
    assert!((ranges[0] - 3.0).abs() < 1e-12 && ranges[1..].iter().all(|range| *range == RANGE_M));
    // On the segment itself.
    let ranges = scan_shapes(&Pose::new(4.0, 0.0, 0.3), &[], &[flat], RANGE_M).unwrap();
    assert!(ranges.iter().all(|range| range.abs() < 1e-9));
    // A disc as small as a point, and one that touches the scanner.
    let point = Disc { center: Point::new(2.0, 0.0), radius_m: 0.0 };
    let touching = Disc { center: Point::new(-0.5, 0.0), radius_m: 0.5 };
    let ranges = scan_shapes(&here, &[point, touching], &[], RANGE_M).unwrap();
    assert!(ranges[0] == RANGE_M && ranges[180] == 0.0 && ranges[100].is_finite());
}

#[test]
fn the_same_scene_gives_the_same_bytes_in_any_order_of_shapes() {
    let mut random = Random::new(77);
    for _ in 0..50 {
        let mut scene = random_scene(&mut random);
        let from = Pose::new(0.3, -0.2, random.between(-3.0, 3.0));
        let first = scan_shapes(&from, &scene.discs, &scene.segments, RANGE_M).unwrap();
        scene.discs.reverse();
        scene.segments.reverse();
        let second = scan_shapes(&from, &scene.discs, &scene.segments, RANGE_M).unwrap();
        assert!(first.iter().zip(&second).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}
