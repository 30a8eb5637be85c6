//! `map.yaml` as the ROS map server knows it.

use socrates_model::{Cell, Fault, FaultCode, Grid, Pose, Where};
use yaml_serde::Value;

use crate::check::{CELL_M, ORIGIN_MAX};
use crate::image::Picture;
use crate::read::{MAP, stays_inside};

/// Largest map that is read, pixels (6 000 by 6 000): its distance field takes 0.6 GB. More is a mistake or an attack.
pub(crate) const MAX_PIXELS: usize = 36_000_000;
/// Keys of the map server.
const KEYS: [&str; 7] = ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"];
/// Keys that other tools add; named as a warning and not used.
const FOREIGN_KEYS: [&str; 1] = ["type"];

/// How pixel values become cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Trinary,
    Scale,
    Raw,
}

/// What the file says.
#[derive(Debug, Clone)]
pub(crate) struct MapFile {
    pub(crate) image: String,
    /// File and line that names the image.
    pub(crate) image_at: Where,
    resolution_m: f64,
    origin: Pose,
    negate: bool,
    occupied: f64,
    free: f64,
    mode: Mode,
}

impl MapFile {
    /// The grid of a picture.
    ///
    /// `trinary`: darkness above `occupied_thresh` is a wall, below `free_thresh` free, between unknown.
    /// `scale`: the same, and what lies between counts as a wall (nobody walks on half a wall); a pixel
    /// that is not opaque is unknown. `raw`: values 0 to 100 are percent occupied, others unknown.
    pub(crate) fn grid(&self, picture: &Picture) -> Grid {
        let cell = |(value, opaque): &(f64, bool)| {
            let percent = value * 255.0;
            let darkness = match self.mode {
                Mode::Raw if percent > 100.5 => return Cell::Unknown,
                Mode::Raw => percent / 100.0,
                Mode::Trinary | Mode::Scale => {
                    if self.negate {
                        *value
                    } else {
                        1.0 - value
                    }
                }
            };
            match self.mode {
                Mode::Scale if !opaque => Cell::Unknown,
                Mode::Trinary | Mode::Scale | Mode::Raw if darkness > self.occupied => Cell::Occupied,
                Mode::Trinary | Mode::Scale | Mode::Raw if darkness < self.free => Cell::Free,
                Mode::Trinary => Cell::Unknown,
                Mode::Scale | Mode::Raw => Cell::Occupied,
            }
        };
        Grid {
            width: picture.width,
            height: picture.height,
            resolution_m: self.resolution_m,
            origin: self.origin,
            cells: picture.pixels.iter().map(cell).collect(),
        }
    }
}

/// Only the image's name, as far as it can be read.
pub(crate) fn image_name(bytes: &[u8]) -> Option<String> {
    let value: Value = yaml_serde::from_slice(bytes).ok()?;
    value.get("image")?.as_str().map(str::to_owned)
}

/// Reads the file; adds every problem to `faults` and notes to `warnings`.
pub(crate) fn read(bytes: &[u8], faults: &mut Vec<Fault>, warnings: &mut Vec<String>) -> Option<MapFile> {
    let before = faults.len();
    let text = String::from_utf8_lossy(bytes);
    let value: Value = match yaml_serde::from_str(&text) {
        Ok(value) => value,
        Err(why) => {
            let at = Where::file(MAP);
            let at = why.location().map_or_else(|| at.clone(), |place| at.clone().line(place.line()));
            faults.push(Fault::new(FaultCode::MRead, at, format!("is no YAML: {why}")));
            return None;
        }
    };
    let Some(entries) = value.as_mapping() else {
        faults.push(Fault::new(
            FaultCode::MRead,
            Where::file(MAP),
            "holds no keys; a ROS map file has `image`, `resolution`, `origin` …",
        ));
        return None;
    };
    let at = |key: &str| {
        let file = Where::file(MAP);
        match line_of(&text, key) {
            Some(line) => file.line(line),
            None => file,
        }
    };
    for key in entries.keys() {
        let Some(name) = key.as_str() else {
            faults.push(Fault::new(FaultCode::MKey, Where::file(MAP), format!("the key {key:?} is no word")));
            continue;
        };
        if FOREIGN_KEYS.contains(&name) {
            warnings.push(format!("{}: the key `{name}` of another tool is not used", at(name)));
        } else if !KEYS.contains(&name) {
            let message = format!("unknown key `{name}`; allowed: {}", KEYS.join(", "));
            faults.push(Fault::new(FaultCode::MKey, at(name), message));
        }
    }
    let mut reader = Reader { value: &value, at: &at, faults };
    let image = reader.image();
    let resolution_m = reader.number("resolution", None, "0.001 to 10 m per pixel", |m| CELL_M.contains(&m));
    let origin = reader.origin();
    let negate = reader.negate();
    let share = |v: f64| (0.0..=1.0).contains(&v);
    let occupied = reader.number("occupied_thresh", Some(0.65), "0 to 1", share);
    let free = reader.number("free_thresh", Some(0.196), "0 to 1", share);
    let mode = reader.mode();
    if let (Some(occupied), Some(free)) = (occupied, free)
        && free >= occupied
    {
        let message =
            format!("`free_thresh` {free} is not below `occupied_thresh` {occupied}; usual are 0.196 and 0.65");
        faults.push(Fault::new(FaultCode::MValue, at("free_thresh"), message));
    }
    let file = MapFile {
        image_at: at("image"),
        image: image?,
        resolution_m: resolution_m?,
        origin: origin?,
        negate: negate?,
        occupied: occupied?,
        free: free?,
        mode: mode?,
    };
    // An unknown key alone leaves the map readable, so that the other files are checked too.
    let unreadable = faults.iter().skip(before).any(|fault| fault.code != FaultCode::MKey);
    (!unreadable).then_some(file)
}

/// Line of a top-level key, from 1.
fn line_of(text: &str, key: &str) -> Option<usize> {
    let starts = |line: &str| {
        let bare = line.trim_start().trim_start_matches(['"', '\'']);
        bare.strip_prefix(key).is_some_and(|rest| rest.trim_start_matches(['"', '\'']).trim_start().starts_with(':'))
    };
    text.lines().position(starts).map(|line| line + 1)
}

struct Reader<'a, At: Fn(&str) -> Where> {
    value: &'a Value,
    at: &'a At,
    faults: &'a mut Vec<Fault>,
}

impl<At: Fn(&str) -> Where> Reader<'_, At> {
    fn wrong(&mut self, key: &str, found: &str, allowed: &str) {
        let message = format!("`{key}` is {found}; allowed: {allowed}");
        self.faults.push(Fault::new(FaultCode::MValue, (self.at)(key), message));
    }

    fn missing(&mut self, key: &str, allowed: &str) {
        self.faults.push(Fault::new(
            FaultCode::MKey,
            Where::file(MAP),
            format!("the key `{key}` is missing; {allowed}"),
        ));
    }

    fn image(&mut self) -> Option<String> {
        let Some(value) = self.value.get("image") else {
            self.missing("image", "it names the picture beside the file, such as `map.png`");
            return None;
        };
        match value.as_str() {
            Some(name) if stays_inside(name) => Some(name.to_owned()),
            Some(_) | None => {
                self.wrong("image", &shown(value), "the name of a PGM or PNG file in the folder itself");
                None
            }
        }
    }

    fn number(&mut self, key: &str, default: Option<f64>, allowed: &str, fits: impl Fn(f64) -> bool) -> Option<f64> {
        match self.value.get(key) {
            None if default.is_some() => default,
            None => {
                self.missing(key, &format!("allowed: {allowed}"));
                None
            }
            Some(value) => match value.as_f64() {
                Some(number) if fits(number) => Some(number),
                Some(_) | None => {
                    self.wrong(key, &shown(value), allowed);
                    None
                }
            },
        }
    }

    fn origin(&mut self) -> Option<Pose> {
        let allowed = "[x, y, yaw] of the lower left corner, m and rad, from -10000000 to 10000000";
        let Some(value) = self.value.get("origin") else {
            self.missing("origin", allowed);
            return None;
        };
        let numbers: Option<Vec<f64>> = value
            .as_sequence()
            .map(|parts| parts.iter().filter_map(Value::as_f64).filter(|n| n.abs() <= ORIGIN_MAX).collect());
        match numbers.as_deref() {
            Some([x, y, yaw]) if value.as_sequence().is_some_and(|parts| parts.len() == 3) => {
                Some(Pose::new(*x, *y, *yaw))
            }
            Some(_) | None => {
                self.wrong("origin", &shown(value), allowed);
                None
            }
        }
    }

    fn negate(&mut self) -> Option<bool> {
        let Some(value) = self.value.get("negate") else { return Some(false) };
        match (value.as_bool(), value.as_i64()) {
            (Some(negate), _) => Some(negate),
            (None, Some(number @ (0 | 1))) => Some(number == 1),
            (None, _) => {
                self.wrong("negate", &shown(value), "0 or 1");
                None
            }
        }
    }

    fn mode(&mut self) -> Option<Mode> {
        match self.value.get("mode").map(|value| (value.as_str(), value)) {
            None | Some((Some("trinary"), _)) => Some(Mode::Trinary),
            Some((Some("scale"), _)) => Some(Mode::Scale),
            Some((Some("raw"), _)) => Some(Mode::Raw),
            Some((_, value)) => {
                self.wrong("mode", &shown(value), "trinary, scale, raw");
                None
            }
        }
    }
}

/// A value as the file has it, short.
fn shown(value: &Value) -> String {
    let text = yaml_serde::to_string(value).unwrap_or_default();
    let flat: String = text.trim().replace('\n', " ").chars().take(60).collect();
    format!("`{flat}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(text: &str) -> Vec<String> {
        let (mut faults, mut warnings) = (Vec::new(), Vec::new());
        read(text.as_bytes(), &mut faults, &mut warnings);
        faults.iter().map(ToString::to_string).chain(warnings).collect()
    }

    fn grid(text: &str, values: &[(u8, bool)]) -> Vec<Cell> {
        let map = read(text.as_bytes(), &mut vec![], &mut vec![]).unwrap();
        let pixels = values.iter().map(|(v, opaque)| (f64::from(*v) / 255.0, *opaque)).collect();
        map.grid(&Picture { width: values.len(), height: 1, pixels }).cells
    }

    const GOOD: &str = "image: map.pgm\nresolution: 0.05\norigin: [-1, 2.5, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

    #[test]
    fn every_wrong_key_and_value_is_named_with_its_line_at_once() {
        let bad = "image: ../map.pgm\nresolution: -1\norigin: [0, 0]\nnegate: 3\noccupied_thresh: 0.1\nfree_thresh: 0.2\nmode: sepia\nresolutoin: 3\ntype: indoor\n";
        let faults = faults(bad).join("\n");
        for part in [
            "map.yaml:1",
            "map.yaml:2",
            "map.yaml:3",
            "map.yaml:4",
            "map.yaml:6",
            "map.yaml:7",
            "map.yaml:8",
            "map.yaml:9",
        ] {
            assert!(faults.contains(part), "{part} not in\n{faults}");
        }
        assert!(faults.contains("`resolutoin`") && faults.contains("`sepia`") && faults.contains("`-1`"), "{faults}");
    }

    #[test]
    fn missing_keys_and_broken_yaml_are_faults() {
        assert_eq!(faults("negate: 0").len(), 3);
        assert!(faults("image: [").first().unwrap().starts_with("M-READ"));
        assert!(faults("").first().unwrap().starts_with("M-READ"));
    }

    #[test]
    fn the_three_modes_read_pixels_as_the_map_server_does() {
        use Cell::{Free, Occupied, Unknown};
        let pixels = [(254, true), (205, true), (0, true), (120, true), (254, false)];
        assert_eq!(grid(GOOD, &pixels), [Free, Unknown, Occupied, Unknown, Free]);
        assert_eq!(grid(&format!("{GOOD}mode: scale"), &pixels), [Free, Occupied, Occupied, Occupied, Unknown]);
        assert_eq!(
            grid(&format!("{GOOD}mode: raw"), &[(0, true), (100, true), (255, true)]),
            [Free, Occupied, Unknown]
        );
        assert_eq!(grid(&GOOD.replace("negate: 0", "negate: 1"), &[(254, true), (0, true)]), [Occupied, Free]);
    }
}
