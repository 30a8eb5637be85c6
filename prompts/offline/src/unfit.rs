//! Which cards fit a map: by its place classes, its widths, what lies behind its doors and how many ways meet, never by trying.

use std::fmt;

use serde::Serialize;
use socrates_model::{Location, PlaceClass, Relation, RobotModel};
use socrates_solver::measure;

use crate::card::{Card, Role};
use crate::place;

/// Places inside one room that somebody who enters and somebody who leaves need.
const SHARED: usize = 2;

/// Radius of a person, m, as the simulation has it.
const PERSON_M: f64 = 0.28;
/// Free floor between the robot, whoever is beside it and the walls, m.
const GAP_M: f64 = 0.2;
/// Gaps where people pass the robot side by side: at either wall, and between them and the robot.
const GAPS: f64 = 3.0;
/// A largest width from here on is none, m.
const OPEN_M: f64 = 50.0;

/// Why a map cannot hold a card, with the number that says by how much.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum Unfit {
    /// The map has none of the places where the card happens.
    Place {
        /// Any of these would do.
        wanted: Vec<PlaceClass>,
    },
    /// The map lacks a place that the card needs besides.
    Needs {
        /// The place.
        class: PlaceClass,
    },
    /// The map has no place inside a room or an elevator.
    Inside {
        /// The room or the elevator.
        class: PlaceClass,
    },
    /// No room has places enough for somebody who enters and somebody who leaves.
    Shared {
        /// Places inside one room, needed.
        needed: usize,
        /// The most that a room of the map has.
        most: usize,
    },
    /// Nowhere is the floor wide enough for the robot and those beside it.
    Narrow {
        /// People side by side, besides the robot.
        abreast: u32,
        /// Free width that they need with the robot, m.
        needed_m: f64,
        /// Places where it would be wide enough for the card.
        places: Vec<PlaceClass>,
        /// Free width at the widest of them, m.
        widest_m: f64,
    },
    /// No place has the free width of which the card tells.
    Width {
        /// Least and largest free width, m.
        wanted_m: [f64; 2],
        /// Places of which one should be so wide.
        places: Vec<PlaceClass>,
        /// The free width of the map that is nearest to it, m.
        nearest_m: f64,
    },
    /// Every way of the robot is too short for what happens on it.
    Short {
        /// Length of the robot's way that the card needs, m.
        needed_m: f64,
        /// Free width that it needs all along, m; 0 where any will do.
        width_m: f64,
        /// Length of the longest, m.
        longest_m: f64,
    },
    /// Nowhere meet ways enough.
    Arms {
        /// Ways that must meet in a node.
        needed: usize,
        /// The most that meet in a node of the map.
        most: usize,
    },
}

impl Unfit {
    /// Whether the map lacks a place that the card needs; else it has the place, which is too small, too narrow or not as wide.
    #[must_use]
    pub const fn lacks_place(&self) -> bool {
        matches!(self, Self::Place { .. } | Self::Needs { .. } | Self::Inside { .. })
    }
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Place { wanted } => write!(f, "needs {}, the map has none", any_of(wanted)),
            Self::Needs { class } => write!(f, "needs {}, the map has none", place::an(*class)),
            Self::Inside { class } => write!(f, "needs a place inside {}, the map has none", place::an(*class)),
            Self::Shared { needed, most } => {
                write!(f, "needs a room with {needed} places in it, the largest has {most}")
            }
            Self::Narrow { abreast, needed_m, places, widest_m } => {
                let who = if *abreast == 1 { String::new() } else { format!(" of {abreast} and the robot") };
                let widest = place::either(places);
                write!(f, "passing side by side{who} needs {needed_m:.1} m, the widest {widest} has {widest_m:.1} m")
            }
            Self::Width { wanted_m: [least, most], places, nearest_m } => {
                let place = any_of(places);
                let to = if *most < OPEN_M { format!("to {most:.1} m") } else { "m or more".to_owned() };
                write!(f, "needs {place} of {least:.1} {to}, the nearest has {nearest_m:.1} m")
            }
            Self::Short { needed_m, width_m, longest_m } => {
                let wide = if *width_m > 0.0 { format!(" and {width_m:.1} m wide") } else { String::new() };
                write!(f, "needs a way of {needed_m:.0} m{wide}, the longest outside of rooms has {longest_m:.1} m")
            }
            Self::Arms { needed, most } => {
                write!(f, "needs a junction of at least {needed} ways, the largest has {most}")
            }
        }
    }
}

/// `a corridor, an open area or an exit`.
fn any_of(classes: &[PlaceClass]) -> String {
    let mut words: Vec<String> = classes.iter().map(|class| place::an(*class)).collect();
    let last = words.pop().unwrap_or_default();
    if words.is_empty() { last } else { format!("{} or {last}", words.join(", ")) }
}

impl Card {
    /// Whether the map has what the card needs; [`Card::fit`] says what it lacks.
    #[must_use]
    pub fn fits(&self, location: &Location) -> bool {
        self.fit(location).is_ok()
    }

    /// Whether the map has what the card needs: its place classes, a place inside, ways that meet.
    ///
    /// # Errors
    /// What the map lacks first, with its number.
    pub fn fit(&self, location: &Location) -> Result<(), Unfit> {
        let there = |class: &PlaceClass| place::has(location, *class);
        if let Some(class) = self.needs.iter().find(|class| !there(class)) {
            return Err(Unfit::Needs { class: *class });
        }
        let indoors = self.roles.iter().find_map(|role| role.start).or(self.start);
        if self.inside && place::inside(location, indoors).is_empty() {
            let car = indoors == Some(PlaceClass::Elevator);
            return Err(Unfit::Inside { class: if car { PlaceClass::Elevator } else { PlaceClass::Room } });
        }
        self.shares(location)?;
        if let Some(needed) = self.arms {
            let most = place::most_arms(location, self.start);
            if most < needed {
                return Err(Unfit::Arms { needed, most });
            }
        }
        if !self.places.iter().any(|class| *class == PlaceClass::Plain || there(class)) {
            return Err(Unfit::Place { wanted: self.places.clone() });
        }
        let (needed_m, radius_m) = (self.way_m, RobotModel::default().radius_m);
        // A companion keeps beside the robot all the way.
        let beside = self.roles.iter().any(|role| role.relation == Relation::Abreast);
        let width_m = self.width_m.filter(|_| beside).map_or(0.0, |[least, _]| least);
        let longest_m = measure::longest_way_m(location, radius_m, width_m, needed_m);
        if longest_m < needed_m {
            return Err(Unfit::Short { needed_m, width_m, longest_m });
        }
        self.has_width(location)
    }

    /// Whether the map has a place of the class, as wide as the card tells where it does.
    pub(crate) fn is_at(&self, location: &Location, class: PlaceClass) -> bool {
        let wide = |[least, most]: [f64; 2]| {
            measure::widths_m(location, class).into_iter().any(|width_m| (least..=most).contains(&width_m))
        };
        place::has(location, class) && self.width_m.is_none_or(wide)
    }

    /// Where the card tells of a free width, one place must have it; where people pass the robot, one place must let them.
    fn has_width(&self, location: &Location) -> Result<(), Unfit> {
        if let Some([least, most]) = self.width_m {
            if self.places.iter().any(|class| self.is_at(location, *class)) {
                return Ok(());
            }
            let off = |width: &f64| (least - width).max(width - most).max(0.0);
            let nearest = self.widths_m(location).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0.0);
            return Err(Unfit::Width { wanted_m: [least, most], places: self.places.clone(), nearest_m: nearest });
        }
        let abreast = self.roles.iter().map(|role| self.beside(role)).max().unwrap_or(0);
        // Through a doorway or an aisle they go one after the other: that is what such a card is about.
        if abreast == 0 || self.places.iter().any(|class| is_tight(*class) && place::has(location, *class)) {
            return Ok(());
        }
        let needed_m = 2.0 * RobotModel::default().radius_m + f64::from(abreast) * 2.0 * PERSON_M + GAPS * GAP_M;
        let widest_m = self.widths_m(location).fold(0.0, f64::max);
        // A wall that ends within a cell is drawn at one side of it.
        if widest_m + location.grid.resolution_m < needed_m {
            return Err(Unfit::Narrow { abreast, needed_m, places: self.places.clone(), widest_m });
        }
        Ok(())
    }

    /// Free widths of the floor at the places of the card, m.
    fn widths_m<'a>(&'a self, location: &'a Location) -> impl Iterator<Item = f64> + 'a {
        self.places.iter().flat_map(|class| measure::widths_m(location, *class))
    }

    /// How many people of a role are beside the robot at a time, at least: those who come towards it, who keep beside it, or who
    /// overtake or are overtaken as a clause of the card demands. A group goes side by side.
    fn beside(&self, role: &Role) -> u32 {
        let overtakes = self.clauses.iter().any(|clause| clause.must && clause.predicate.get("overtakes").is_some());
        let passes = match role.relation {
            Relation::Frontal | Relation::Abreast => true,
            Relation::Behind | Relation::Ahead => overtakes,
            Relation::Crossing | Relation::Static | Relation::Leaving | Relation::Staying | Relation::Aside => false,
        };
        match (passes, role.group && !role.line) {
            (false, _) => 0,
            (true, false) => 1,
            (true, true) => role.count[0],
        }
    }

    /// Into a room that somebody leaves there must be room for both.
    fn shares(&self, location: &Location) -> Result<(), Unfit> {
        if self.goal != Some(PlaceClass::Room) || !self.inside {
            return Ok(());
        }
        let most = place::most_places(location);
        if most < SHARED { Err(Unfit::Shared { needed: SHARED, most }) } else { Ok(()) }
    }
}

/// Whether people go through it one after the other.
const fn is_tight(class: PlaceClass) -> bool {
    matches!(class, PlaceClass::Doorway | PlaceClass::NarrowPassage | PlaceClass::Elevator)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::card::{card, catalog};
    use crate::tests::map;

    /// The cards that happen on a shipped map, as the published table has them.
    const TABLE: &str = include_str!("../../catalog/RATES.md");

    #[test]
    fn every_card_still_fits_each_map_of_the_published_table() {
        let mut pairs = 0;
        for card in catalog() {
            let row = TABLE.lines().find(|line| line.contains(&format!("| {} |", card.id))).unwrap();
            let locations = row.split('|').nth(3).unwrap();
            for name in locations.split(',').map(str::trim) {
                assert_eq!(card.fit(&map(name)), Ok(()), "{} on {name}", card.id);
                pairs += 1;
            }
        }
        assert!(pairs > 100, "{pairs}");
    }

    #[test]
    fn what_a_map_lacks_is_said_with_its_number() {
        let why = |id: &str, name: &str| card(id).unwrap().fit(&map(name)).unwrap_err().to_string();
        assert_eq!(why("exiting_elevator", "office"), "needs an elevator, the map has none");
        assert_eq!(why("narrow_hallway", "hospital"), "needs a narrow passage, the map has none");
        for name in socrates_maps::shipped::names() {
            for why in catalog().iter().filter_map(|card| card.fit(&map(name)).err()).map(|why| why.to_string()) {
                let counted = why.contains(|letter: char| letter.is_ascii_digit());
                assert!(counted || why.ends_with("the map has none"), "{name}: {why}");
            }
        }
    }

    /// The plan of one corridor of this width, m.
    fn plan(width_m: f64) -> String {
        format!(
            "description = \"A corridor.\"\nsize_m = [30.0, 6.0]\nresolution_m = 0.05\n\
             floors = [[0.5, 1.0, 29.5, {}]]\n\
             nodes = [{}]\nedges = [{{ type = \"CORRIDOR\", along = [\"a\", \"b\", \"c\", \"d\"] }}]\n",
            1.0 + width_m,
            [("a", 1.5), ("b", 10.0), ("c", 20.0), ("d", 28.5)]
                .map(|(id, x)| format!("{{ id = \"{id}\", type = \"CORRIDOR\", at = [{x}, {}] }}", 1.0 + width_m / 2.0))
                .join(", ")
        )
    }

    fn drawn(plan: &str) -> Location {
        socrates_maps::parse(&socrates_maps::generate(plan).unwrap(), "own").unwrap()
    }

    fn corridor(width_m: f64) -> Location {
        drawn(&plan(width_m))
    }

    #[test]
    fn two_who_pass_each_other_need_the_width_of_both_and_one_who_crosses_does_not() {
        let frontal = card("frontal_approach").unwrap();
        assert_eq!(frontal.fit(&corridor(2.0)), Ok(()));
        let why = frontal.fit(&corridor(1.3)).unwrap_err();
        assert!(matches!(why, Unfit::Narrow { abreast: 1, widest_m, .. } if (1.1..1.5).contains(&widest_m)), "{why:?}");
        assert!(
            why.to_string()
                .starts_with("passing side by side needs 1.7 m, the widest corridor, open area or passage has 1."),
            "{why}"
        );
        assert_eq!(card("follower").unwrap().fit(&corridor(1.3)), Ok(()), "a follower stays behind");
        let team = card("emergency_team").unwrap().fit(&corridor(1.6)).unwrap_err();
        assert!(
            team.to_string().starts_with("needs a corridor or a passage of 2.2 m or more, the nearest has 1."),
            "{team}"
        );
    }

    #[test]
    fn what_takes_a_long_way_needs_one_and_a_companion_needs_it_wide() {
        let short = plan(3.0).replace("29.5", "11.5").replace("[10, ", "[4.5, ").replace("[20, ", "[7.5, ");
        let short = drawn(&short.replace("[28.5, ", "[10.5, "));
        let why = card("down_path").unwrap().fit(&short).unwrap_err();
        assert_eq!(why.to_string(), "needs a way of 10 m, the longest outside of rooms has 9.0 m");
        let companion = card("accompanying").unwrap();
        assert_eq!(companion.fit(&corridor(2.4)), Ok(()));
        let why = companion.fit(&corridor(1.6)).unwrap_err().to_string();
        assert!(why.starts_with("needs a way of 10 m and 2.0 m wide, the longest outside of rooms has 0.0 m"), "{why}");
    }

    #[test]
    fn a_junction_is_asked_for_by_the_number_of_its_ways() {
        let traffic = card("perpendicular_traffic").unwrap();
        let bare = traffic.fit(&corridor(3.0)).unwrap_err();
        assert_eq!(bare.to_string(), "needs an intersection, the map has none");
        // A node that is called one, and at which only the two halves of the corridor meet.
        let named = plan(3.0).replacen("id = \"b\", type = \"CORRIDOR\"", "id = \"b\", type = \"INTERSECTION\"", 1);
        let why = traffic.fit(&drawn(&named)).unwrap_err();
        assert_eq!(why.to_string(), "needs a junction of at least 4 ways, the largest has 2");
    }
}
