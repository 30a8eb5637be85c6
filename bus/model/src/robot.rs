//! Robot bodies: what a data file says of one, and the checked value.
//!
//! ```text
//! robots/<name>.toml ─┐
//!                     ├─► RobotModel (checked: every limit is one that the engine can play)
//! [robot.model] table ┘
//! ```

use std::fmt;
use std::str::FromStr;
use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::ids::BadId;

/// How a base moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Kinematics {
    /// Forward and backward, and turning on the spot: two driven wheels, or skid steering.
    #[default]
    Differential,
    /// In every direction, whatever way it faces.
    Omnidirectional,
}

/// Longest name of a robot, characters.
const NAME_CHARS: usize = 32;

/// Name of a robot body: 1 to 32 of a-z, 0-9, `_` and `-`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct RobotName {
    length: u8,
    bytes: [u8; NAME_CHARS],
}

impl RobotName {
    /// As text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        self.bytes.get(..usize::from(self.length)).and_then(|bytes| str::from_utf8(bytes).ok()).unwrap_or_default()
    }
}

impl fmt::Debug for RobotName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

impl fmt::Display for RobotName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl PartialEq<&str> for RobotName {
    fn eq(&self, other: &&str) -> bool {
        self.as_str() == *other
    }
}

impl FromStr for RobotName {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let fits = |byte: &u8| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'_' | b'-');
        let bad =
            || BadId { what: "robot name", found: text.chars().take(80).collect(), allowed: "1 to 32 of a-z 0-9 _ -" };
        let mut bytes = [0; NAME_CHARS];
        let place =
            bytes.get_mut(..text.len()).filter(|place| !place.is_empty() && text.bytes().all(|byte| fits(&byte)));
        place.ok_or_else(bad)?.copy_from_slice(text.as_bytes());
        Ok(Self { length: u8::try_from(text.len()).unwrap_or_default(), bytes })
    }
}

/// A robot body: a disc with the motion limits of its base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotModel {
    /// Name as in `robot.model` of a request.
    pub name: RobotName,
    /// How the base moves.
    pub kinematics: Kinematics,
    /// Radius of the disc that covers the body, m.
    pub radius_m: f64,
    /// Largest forward speed, m/s.
    pub v_max_mps: f64,
    /// Largest backward speed as a negative number, m/s; 0 where it cannot go backward.
    pub v_min_mps: f64,
    /// Largest speed to either side, m/s; 0 unless the base is omnidirectional.
    pub vy_max_mps: f64,
    /// Largest change of speed, m/s²; it brakes twice as hard.
    pub a_max_mps2: f64,
    /// Largest turning rate, rad/s.
    pub omega_max_radps: f64,
    /// Largest change of turning rate, rad/s².
    pub alpha_max_radps2: f64,
    /// Nearer than this its lidar sees nothing, m.
    pub lidar_min_m: f64,
    /// Range of its lidar, m.
    pub lidar_range_m: f64,
}

/// What a data file, or the table `[robot.model]` of a request, says of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotFile {
    /// Its name, 1 to 32 of a-z, 0-9, `_`, `-`.
    pub name: String,
    /// One line about it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub about: String,
    /// `differential` (the default) or `omnidirectional`.
    #[serde(default)]
    pub kinematics: Kinematics,
    /// Radius of the disc that covers the body, 0.05 to 1 m.
    pub radius_m: f64,
    /// Largest forward speed, 0.05 to 3 m/s.
    pub v_max_mps: f64,
    /// Largest backward speed, -3 to 0 m/s. Default: a quarter of the forward speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub v_min_mps: Option<f64>,
    /// Largest speed to either side, 0 to 3 m/s. Default: 0, of an omnidirectional base the forward speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vy_max_mps: Option<f64>,
    /// Largest change of speed, 0.05 to 10 m/s². Default 1.
    #[serde(default = "one")]
    pub a_max_mps2: f64,
    /// Largest turning rate, 0.05 to 10 rad/s.
    pub omega_max_radps: f64,
    /// Largest change of turning rate, 0.1 to 50 rad/s². Default 4.
    #[serde(default = "four")]
    pub alpha_max_radps2: f64,
    /// Nearer than this its lidar sees nothing, 0 to 1 m. Default 0.
    #[serde(default)]
    pub lidar_min_m: f64,
    /// Range of its lidar, 0.5 to 100 m. Default 12.
    #[serde(default = "twelve")]
    pub lidar_range_m: f64,
}

const fn one() -> f64 {
    1.0
}

const fn four() -> f64 {
    4.0
}

const fn twelve() -> f64 {
    12.0
}

/// Everything that is wrong with a robot's data.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", problems.join("; "))]
pub struct BadRobot {
    /// One line each: key, value, what is allowed.
    pub problems: Vec<String>,
}

impl RobotFile {
    /// The checked body.
    ///
    /// # Errors
    /// [`BadRobot`] with every value that is out of its range.
    pub fn checked(&self) -> Result<RobotModel, BadRobot> {
        let mut problems = Vec::new();
        let side = match self.kinematics {
            Kinematics::Differential => 0.0,
            Kinematics::Omnidirectional => self.v_max_mps,
        };
        let body = RobotModel {
            name: self.name.parse().unwrap_or_else(|bad: BadId| {
                problems.push(bad.to_string());
                RobotName { length: 0, bytes: [0; NAME_CHARS] }
            }),
            kinematics: self.kinematics,
            radius_m: self.radius_m,
            v_max_mps: self.v_max_mps,
            v_min_mps: self.v_min_mps.unwrap_or(-0.25 * self.v_max_mps),
            vy_max_mps: self.vy_max_mps.unwrap_or(side),
            a_max_mps2: self.a_max_mps2,
            omega_max_radps: self.omega_max_radps,
            alpha_max_radps2: self.alpha_max_radps2,
            lidar_min_m: self.lidar_min_m,
            lidar_range_m: self.lidar_range_m,
        };
        let ranges = [
            ("radius_m", body.radius_m, 0.05, 1.0),
            ("v_max_mps", body.v_max_mps, 0.05, 3.0),
            ("v_min_mps", body.v_min_mps, -3.0, 0.0),
            ("vy_max_mps", body.vy_max_mps, 0.0, 3.0),
            ("a_max_mps2", body.a_max_mps2, 0.05, 10.0),
            ("omega_max_radps", body.omega_max_radps, 0.05, 10.0),
            ("alpha_max_radps2", body.alpha_max_radps2, 0.1, 50.0),
            ("lidar_min_m", body.lidar_min_m, 0.0, 1.0),
            ("lidar_range_m", body.lidar_range_m, 0.5, 100.0),
        ];
        for (key, value, least, most) in ranges {
            if !(least..=most).contains(&value) {
                problems.push(format!("`{key}` is {value}; allowed: {least} to {most}"));
            }
        }
        if body.kinematics == Kinematics::Differential && body.vy_max_mps > 0.0 {
            let found = body.vy_max_mps;
            problems.push(format!(
                "`vy_max_mps` is {found} of a differential base; allowed: 0, or kinematics = \"omnidirectional\""
            ));
        }
        if problems.is_empty() { Ok(body) } else { Err(BadRobot { problems }) }
    }
}

impl From<&RobotModel> for RobotFile {
    fn from(body: &RobotModel) -> Self {
        Self {
            name: body.name.as_str().to_owned(),
            about: String::new(),
            kinematics: body.kinematics,
            radius_m: body.radius_m,
            v_max_mps: body.v_max_mps,
            v_min_mps: Some(body.v_min_mps),
            vy_max_mps: Some(body.vy_max_mps),
            a_max_mps2: body.a_max_mps2,
            omega_max_radps: body.omega_max_radps,
            alpha_max_radps2: body.alpha_max_radps2,
            lidar_min_m: body.lidar_min_m,
            lidar_range_m: body.lidar_range_m,
        }
    }
}

/// The data files, the default robot first.
const FILES: [&str; 7] = [
    include_str!("../robots/linorobot2.toml"),
    include_str!("../robots/turtlebot3_burger.toml"),
    include_str!("../robots/turtlebot3_waffle.toml"),
    include_str!("../robots/turtlebot4.toml"),
    include_str!("../robots/jackal.toml"),
    include_str!("../robots/tiago.toml"),
    include_str!("../robots/omni.toml"),
];

/// The bodies of [`FILES`]; a test holds that every file gives one.
static SHIPPED: LazyLock<Vec<(RobotFile, RobotModel)>> = LazyLock::new(|| {
    let read = |text: &&str| {
        let file: RobotFile = toml::from_str(text).ok()?;
        let body = file.checked().ok()?;
        Some((file, body))
    };
    FILES.iter().filter_map(read).collect()
});

impl RobotModel {
    /// The names, for messages.
    pub const ALLOWED: &'static str = "linorobot2, turtlebot3_burger, turtlebot3_waffle, turtlebot4, jackal, tiago, omni, or a table [robot.model] with a body of your own";

    /// Every body that is shipped with the line about it, the default first.
    pub fn shipped() -> impl Iterator<Item = (&'static str, &'static Self)> {
        SHIPPED.iter().map(|(file, body)| (file.about.as_str(), body))
    }

    /// Whether the base goes to the side as well.
    #[must_use]
    pub fn is_omnidirectional(&self) -> bool {
        self.kinematics == Kinematics::Omnidirectional
    }
}

impl FromStr for RobotModel {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        Self::shipped().map(|(_about, body)| *body).find(|body| body.name == text).ok_or_else(|| BadId {
            what: "robot model",
            found: text.chars().take(80).collect(),
            allowed: Self::ALLOWED,
        })
    }
}

impl<'de> Deserialize<'de> for RobotModel {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        use serde::de::Error as _;
        let value = serde_json::Value::deserialize(from)?;
        if let Some(name) = value.as_str() {
            return name.parse().map_err(D::Error::custom);
        }
        RobotFile::deserialize(value).map_err(D::Error::custom)?.checked().map_err(D::Error::custom)
    }
}

impl Serialize for RobotModel {
    /// A shipped body by its name, any other as its table.
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        if self.name.as_str().parse() == Ok(*self) {
            to.serialize_str(self.name.as_str())
        } else {
            RobotFile::from(self).serialize(to)
        }
    }
}

impl JsonSchema for RobotModel {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "RobotModel".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let names: Vec<&str> = Self::shipped().map(|(_about, body)| body.name.as_str()).collect();
        let body = generator.subschema_for::<RobotFile>();
        schemars::json_schema!({ "anyOf": [{ "type": "string", "enum": names }, body] })
    }
}

impl Default for RobotModel {
    fn default() -> Self {
        SHIPPED.first().map_or(FALLBACK, |(_file, body)| *body)
    }
}

/// What [`RobotModel::default`] would be without its data file; a test holds that they are the same.
const FALLBACK: RobotModel = RobotModel {
    name: RobotName { length: 10, bytes: *b"linorobot2\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0" },
    kinematics: Kinematics::Differential,
    radius_m: 0.25,
    v_max_mps: 0.8,
    v_min_mps: -0.2,
    vy_max_mps: 0.0,
    a_max_mps2: 1.0,
    omega_max_radps: 1.5,
    alpha_max_radps2: 4.0,
    lidar_min_m: 0.0,
    lidar_range_m: 12.0,
};

impl fmt::Display for RobotModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_data_file_is_a_robot_and_is_named_in_messages() {
        assert_eq!(SHIPPED.len(), FILES.len());
        for (file, body) in SHIPPED.iter() {
            assert!(RobotModel::ALLOWED.contains(body.name.as_str()), "{}", body.name);
            assert!(!file.about.is_empty(), "{}", body.name);
            assert_eq!(body.name.as_str().parse::<RobotModel>().unwrap(), *body);
        }
        assert_eq!(RobotModel::default(), FALLBACK);
        assert_eq!(RobotModel::default(), "linorobot2".parse().unwrap());
    }

    #[test]
    fn a_shipped_robot_is_written_as_its_name_and_ones_own_as_its_table() {
        let jackal: RobotModel = "jackal".parse().unwrap();
        assert_eq!(serde_json::to_value(jackal).unwrap(), "jackal");
        let own = RobotModel { radius_m: 0.4, ..jackal };
        let written = serde_json::to_value(own).unwrap();
        assert_eq!(written["radius_m"], 0.4);
        assert_eq!(serde_json::from_value::<RobotModel>(written).unwrap(), own);
    }

    #[test]
    fn everything_that_is_wrong_with_a_robot_is_said_at_once() {
        let text =
            r#"{ "name": "Big One", "radius_m": -0.2, "v_max_mps": 0.5, "omega_max_radps": 1e9, "vy_max_mps": 0.3 }"#;
        let said = serde_json::from_str::<RobotModel>(text).unwrap_err().to_string();
        for part in [
            "`Big One` is not a robot name",
            "`radius_m` is -0.2; allowed: 0.05 to 1",
            "`omega_max_radps` is 1000000000; allowed: 0.05 to 10",
            "`vy_max_mps` is 0.3 of a differential base",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
        let unknown = r#"{ "name": "a", "radius_m": 0.2, "v_max_mps": 0.5, "omega_max_radps": 1, "wheels": 4 }"#;
        assert!(
            serde_json::from_str::<RobotModel>(unknown).unwrap_err().to_string().contains("unknown field `wheels`")
        );
        assert!(
            "hal"
                .parse::<RobotModel>()
                .unwrap_err()
                .to_string()
                .contains("`hal` is not a robot model; allowed: linorobot2")
        );
    }

    #[test]
    fn a_robot_whose_limits_are_left_out_gets_those_that_are_stated() {
        let text = r#"{ "name": "a", "radius_m": 0.2, "v_max_mps": 0.8, "omega_max_radps": 1 }"#;
        let body: RobotModel = serde_json::from_str(text).unwrap();
        assert_eq!((body.v_min_mps, body.vy_max_mps, body.a_max_mps2, body.alpha_max_radps2), (-0.2, 0.0, 1.0, 4.0));
        let omni = text.replace(r#""name": "a""#, r#""name": "a", "kinematics": "omnidirectional""#);
        assert!((serde_json::from_str::<RobotModel>(&omni).unwrap().vy_max_mps - 0.8).abs() < 1e-9);
    }
}
