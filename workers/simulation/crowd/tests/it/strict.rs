//! Whole runs, bit for bit, against recorded runs of the reference library where they are at hand, and to a millionth of a meter
//! against scenes of our own that `tests/data/oracle.py` worked out by itself.

#![expect(clippy::print_stdout, reason = "how much was checked is told")]

use std::fs;
use std::path::{Path, PathBuf};

use crate::trace::{Scene, forces_table, trajectory};
use socrates_crowd::cross::{DT_S, WALL_RANGE_M, cross};
use socrates_crowd::strict::{Crowd, Model};
use socrates_tests::skip::shared;

#[track_caller]
fn folder() -> Option<PathBuf> {
    shared("sfm_reference")
}

/// Every file of the folder whose name ends so, in the order of names.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.to_str().is_some_and(|name| name.ends_with(ending)));
    files.sort();
    files
}

/// The first cell in which two tables differ in meaning, or in which their numbers differ in bits.
fn first_difference(found: &str, wanted: &str) -> Option<String> {
    let (mut found_lines, mut wanted_lines) = (found.lines(), wanted.lines());
    for line in 1.. {
        let (found, wanted) = match (found_lines.next(), wanted_lines.next()) {
            (None, None) => return None,
            (found, wanted) => (found.unwrap_or("nothing"), wanted.unwrap_or("nothing")),
        };
        if found != wanted {
            return Some(format!("line {line}\n found  {found}\n wanted {wanted}"));
        }
    }
    None
}

#[test]
fn every_recorded_scene_is_replayed_in_every_bit() {
    let Some(folder) = folder() else { return };
    let mut checked = 0;
    for file in files(&folder, ".json") {
        let scene = Scene::read(&fs::read_to_string(&file).unwrap()).unwrap();
        for (ending, found) in [("traj.csv", trajectory(&scene)), ("forces.csv", forces_table(&scene))] {
            let table = file.with_extension(ending);
            let wanted = fs::read_to_string(&table).unwrap();
            assert_eq!(first_difference(&found, &wanted), None, "{}", table.display());
            assert_eq!(found.len(), wanted.len(), "{}", table.display());
            checked += 1;
        }
    }
    println!("{checked} tables checked");
    assert!(checked > 0);
}

/// Largest difference of a whole run from numbers that another program worked out, in m, m/s, rad and m/s²: the last bits of its
/// sines and exponentials may differ, and four seconds let them grow.
const GROWN: f64 = 1e-6;

#[test]
fn our_scenes_run_as_they_were_worked_out_apart() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data"));
    let scenes = files(folder, ".json");
    assert!(scenes.len() >= 4, "{scenes:?}");
    for file in scenes {
        let scene = Scene::read(&fs::read_to_string(&file).unwrap()).unwrap();
        let wanted = fs::read_to_string(file.with_extension("traj.csv")).unwrap();
        let found = trajectory(&scene);
        assert_eq!(found.lines().count(), wanted.lines().count(), "{}", file.display());
        for (line, (found, wanted)) in found.lines().zip(wanted.lines()).enumerate().skip(1) {
            let (found, wanted) = (crossing_row(found), crossing_row(wanted));
            let near = found.iter().zip(&wanted).all(|(found, wanted)| (found - wanted).abs() <= GROWN);
            assert!(near && found.len() == wanted.len(), "{} line {line}: {found:?} {wanted:?}", file.display());
        }
    }
}

/// The numbers of one row.
fn crossing_row(line: &str) -> Vec<f64> {
    line.split(',').map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn the_recorded_crossing_crowds_are_replayed_in_every_bit() {
    let Some(folder) = folder() else { return };
    let mut checked = 0;
    for file in files(&folder, ".hunav.csv") {
        let name = file.file_name().unwrap().to_str().unwrap();
        let Some(size) = name.strip_prefix("cross_").and_then(|rest| rest.strip_suffix(".hunav.csv")) else { continue };
        let n: u32 = size.parse().unwrap();
        let cross = cross(n);
        let mut crowd = Crowd::new(&cross.walkers, &cross.walls, WALL_RANGE_M, &Model::Hunav.params());
        let (mut step, text) = (0, fs::read_to_string(&file).unwrap());
        let rows: Vec<Vec<f64>> = text.lines().skip(1).map(crossing_row).collect();
        for recorded in rows.chunks(n as usize) {
            while f64::from(step) < recorded[0][0] {
                crowd.step(DT_S);
                step += 1;
            }
            let forces = crowd.forces(&crowd.wall_points());
            for ((walker, person), (force, row)) in
                cross.walkers.iter().zip(crowd.people()).zip(forces.iter().zip(recorded))
            {
                let (route, total) = (&walker.route, force.total());
                // The first goal of a fresh crowd, and the start: in this order in every row.
                let (first, start) = (route.goal().unwrap().at, walker.person.position);
                let found = [
                    f64::from(step),
                    f64::from(person.id),
                    person.position.x,
                    person.position.y,
                    person.velocity.x,
                    person.velocity.y,
                    person.yaw,
                    person.speed_mps,
                    first.x,
                    first.y,
                    start.x,
                    start.y,
                    total.x,
                    total.y,
                ];
                for (place, (found, wanted)) in found.iter().zip(row).enumerate() {
                    let what = format!("{name} step {step} person {} column {place}", person.id);
                    assert_eq!(found.to_bits(), wanted.to_bits(), "{what}: {found} {wanted}");
                }
                checked += 1;
            }
        }
    }
    println!("{checked} rows checked");
    assert!(checked > 0);
}

#[test]
fn the_crossing_crowds_have_the_published_check_sums() {
    // People, step, sum of x, sum of y.
    let published = [
        (10, 0, 35.982_207_360_123, 26.260_295_408_917),
        (10, 1, 35.991_681_996_862, 26.299_072_320_710),
        (10, 10, 36.078_223_496_121, 26.650_699_896_321),
        (10, 200, 37.785_812_264_379, 34.140_502_531_707),
        (50, 0, 344.318_618_347_097, 277.491_789_940_408),
        (50, 10, 344.483_525_755_943, 278.527_052_614_564),
        (50, 200, 347.421_476_534_249, 297.999_067_915_043),
        (100, 0, 997.937_022_033_501, 998.378_695_017_868),
        (100, 10, 999.011_864_132_872, 998.745_993_895_757),
        (100, 200, 1_018.282_780_855_782, 1_005.223_214_870_722),
        (1000, 0, 31_430.613_192_952_91, 30_892.170_140_530_845),
        (1000, 10, 31_431.269_804_549_578, 30_893.589_291_110_213),
    ];
    for n in [10, 50, 100, 1000_u32] {
        let cross = cross(n);
        let mut crowd = Crowd::new(&cross.walkers, &cross.walls, WALL_RANGE_M, &Model::Hunav.params());
        let mut step = 0;
        for (_, at, x, y) in published.iter().filter(|row| row.0 == n) {
            while step < *at {
                crowd.step(DT_S);
                step += 1;
            }
            let positions = || crowd.people().iter().map(|person| person.position);
            let (sum_x, sum_y): (f64, f64) = (positions().map(|at| at.x).sum(), positions().map(|at| at.y).sum());
            // Twelve decimals are published; the order of their sum is not.
            let close = 1e-12 * f64::from(n).max(100.0);
            assert!((sum_x - x).abs() < close && (sum_y - y).abs() < close, "CROSS-{n} step {step}: {sum_x} {sum_y}");
        }
    }
}
