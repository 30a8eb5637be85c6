//! Buildings in words: `a hospital with two wards, a lobby with two elevators` to a brief.
//!
//! A small grammar over rows of words: a count before a room, a size behind it, `next to` before its neighbor. Words that no row
//! has are handed back, so that no wish is lost without a trace.

use socrates_model::building::same;
use socrates_model::{BuildingBrief, BuildingKind, CorridorForm, RoomBrief};

/// What a word or a few words mean.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Means {
    Kind(BuildingKind),
    Room(&'static str),
    Form(CorridorForm),
    Number(f64),
    Elevators,
    Corridor,
    Door,
    Beside,
    Open,
    Only,
    Meters,
    SquareMeters,
    /// Says nothing of its own.
    Filler,
}

use CorridorForm::{Bend, Comb, Cross, Ring, Spine, Tee, TwoRings, Wings};
use Means::{Beside, Corridor, Door, Elevators, Filler, Form, Kind, Meters, Number, Only, Open, Room, SquareMeters};

/// Words with their meaning, singular; a row of more words wins over one of fewer.
const ROWS: &[(&str, Means)] = &[
    ("hospital", Kind(BuildingKind::Hospital)),
    ("clinic", Kind(BuildingKind::Hospital)),
    ("office building", Kind(BuildingKind::Office)),
    ("office floor", Kind(BuildingKind::Office)),
    ("home", Kind(BuildingKind::Home)),
    ("house", Kind(BuildingKind::Home)),
    ("apartment", Kind(BuildingKind::Home)),
    ("flat", Kind(BuildingKind::Home)),
    ("ward", Room("ward")),
    ("patient room", Room("ward")),
    ("exam room", Room("exam room")),
    ("examination room", Room("exam room")),
    ("treatment room", Room("treatment room")),
    ("operating room", Room("operating room")),
    ("nurse station", Room("nurse station")),
    ("waiting area", Room("waiting area")),
    ("waiting room", Room("waiting room")),
    ("cafeteria", Room("cafeteria")),
    ("pharmacy", Room("pharmacy")),
    ("laboratory", Room("laboratory")),
    ("lab", Room("laboratory")),
    ("staff room", Room("staff room")),
    ("storage room", Room("storage room")),
    ("storage", Room("storage room")),
    ("restroom", Room("restroom")),
    ("toilet", Room("restroom")),
    ("office", Room("office")),
    ("office room", Room("office")),
    ("meeting room", Room("meeting room")),
    ("conference room", Room("meeting room")),
    ("open-plan area", Room("open-plan area")),
    ("copy room", Room("copy room")),
    ("server room", Room("server room")),
    ("reception", Room("reception")),
    ("lounge", Room("lounge")),
    ("kitchen", Room("kitchen")),
    ("bedroom", Room("bedroom")),
    ("bathroom", Room("bathroom")),
    ("living room", Room("living room")),
    ("dining room", Room("dining room")),
    ("study", Room("study")),
    ("room", Room("room")),
    ("elevator", Elevators),
    ("lift", Elevators),
    // The lobby comes with its elevators.
    ("lobby with", Filler),
    ("elevator lobby with", Filler),
    ("straight corridor", Form(Spine)),
    ("one corridor", Form(Spine)),
    ("single corridor", Form(Spine)),
    ("l-shaped", Form(Bend)),
    ("corner corridor", Form(Bend)),
    ("t-shaped", Form(Tee)),
    ("crossing corridor", Form(Cross)),
    ("cross-shaped", Form(Cross)),
    ("two wing", Form(Wings)),
    ("wing", Form(Wings)),
    ("side corridor", Form(Comb)),
    ("ring", Form(Ring)),
    ("loop", Form(Ring)),
    ("ring corridor", Form(Ring)),
    ("loop corridor", Form(Ring)),
    ("two ring", Form(TwoRings)),
    ("two loop", Form(TwoRings)),
    ("corridor", Corridor),
    ("hallway", Corridor),
    ("door", Door),
    ("doorway", Door),
    ("next to", Beside),
    ("beside", Beside),
    ("adjacent to", Beside),
    ("open", Open),
    ("only", Only),
    ("nothing else", Only),
    ("no other room", Only),
    ("m", Meters),
    ("meter", Meters),
    ("m²", SquareMeters),
    ("m2", SquareMeters),
    ("square meter", SquareMeters),
    ("one", Number(1.0)),
    ("two", Number(2.0)),
    ("three", Number(3.0)),
    ("four", Number(4.0)),
    ("five", Number(5.0)),
    ("six", Number(6.0)),
    ("seven", Number(7.0)),
    ("eight", Number(8.0)),
    ("nine", Number(9.0)),
    ("ten", Number(10.0)),
    ("twelve", Number(12.0)),
];

/// Words that say nothing of a building.
const FILLERS: &[&str] = &[
    "a", "an", "the", "with", "and", "of", "has", "have", "there", "is", "are", "its", "each", "to", "in", "on",
    "that", "which", "building", "floor", "wide", "width", "shaped", "its", "it", "along", "at", "please", "build",
    "by",
];

/// Words are at most so many in a row of the table.
const LONGEST: usize = 3;
/// How much the floor of a room may differ from a size that is told, as factors.
const ABOUT: (f64, f64) = (0.8, 1.25);

/// What was read of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct BuildingRead {
    /// The brief; none where the text names no kind of building.
    pub brief: Option<BuildingBrief>,
    /// Words that nothing was read from.
    pub unread: Vec<String>,
}

/// The thing that a size behind it belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Last {
    Nothing,
    Corridor,
    Door,
    Room(usize),
}

struct Reading {
    kind: Option<BuildingKind>,
    brief: BuildingBrief,
    numbers: Vec<f64>,
    /// A width that was told before its thing.
    width_m: Option<f64>,
    last: Last,
    beside: bool,
    open: bool,
}

/// Reads a building in words.
#[must_use]
pub fn building(text: &str) -> BuildingRead {
    let words = words(text);
    let rooms = Vec::new();
    let brief = BuildingBrief {
        kind: BuildingKind::Office,
        form: None,
        corridor_m: None,
        door_m: None,
        elevators: 0,
        only: false,
        rooms,
    };
    let mut reading = Reading {
        kind: None,
        brief,
        numbers: Vec::new(),
        width_m: None,
        last: Last::Nothing,
        beside: false,
        open: false,
    };
    let mut unread = Vec::new();
    let mut at = 0;
    while let Some(word) = words.get(at) {
        let found = (1..=LONGEST).rev().find_map(|count| {
            let phrase = singular(words.get(at..at + count)?);
            let row = ROWS.iter().find(|(known, _)| *known == phrase)?;
            Some((count, row.1))
        });
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        match (found, number) {
            (Some((count, means)), _) => {
                reading.take(means);
                at += count;
                continue;
            }
            (None, Some(number)) => reading.take(Number(number)),
            (None, None) if FILLERS.contains(&word.as_str()) => {}
            (None, None) => unread.push(word.clone()),
        }
        at += 1;
    }
    let brief = reading.kind.map(|kind| BuildingBrief { kind, ..reading.brief });
    BuildingRead { brief, unread }
}

/// Words in lower case; `2.5m` is two.
fn words(text: &str) -> Vec<String> {
    let mut out = Vec::new();
    for word in text.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | ':' | '(' | ')' | '"')) {
        let word = word.trim_matches(|c: char| matches!(c, '.' | '!' | '?')).to_lowercase();
        let digits = word.find(|c: char| !(c.is_ascii_digit() || c == '.')).filter(|cut| *cut > 0);
        match digits.and_then(|cut| word.split_at_checked(cut)) {
            Some((number, unit)) if number.parse::<f64>().is_ok() => {
                out.extend([number.to_owned(), unit.to_owned()]);
            }
            _ if word.is_empty() => {}
            _ => out.push(word),
        }
    }
    out
}

/// Words as the table spells them: the last one singular.
fn singular(words: &[String]) -> String {
    let phrase = words.join(" ");
    let known = |text: &str| ROWS.iter().any(|(known, _)| *known == text);
    if known(&phrase) {
        return phrase;
    }
    let ies = phrase.strip_suffix("ies").map(|stem| format!("{stem}y"));
    let plain = phrase.strip_suffix('s').map(str::to_owned);
    ies.into_iter().chain(plain).find(|text| known(text)).unwrap_or(phrase)
}

impl Reading {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a small range")]
    fn count(&mut self) -> u32 {
        let told = self.numbers.pop().unwrap_or(1.0);
        self.numbers.clear();
        told.clamp(0.0, 1000.0).round() as u32
    }

    fn take(&mut self, means: Means) {
        match means {
            Means::Number(number) => self.numbers.push(number),
            Means::Filler => self.numbers.clear(),
            Means::Kind(kind) if self.kind.is_none() => self.kind = Some(kind),
            Means::Kind(_) => {}
            // `an office with six offices`
            Means::Room("office") if self.kind.is_none() => self.kind = Some(BuildingKind::Office),
            Means::Room(kind) => self.room(kind),
            Means::Form(form) => {
                self.brief.form = Some(form);
                self.corridor();
            }
            Means::Elevators => self.brief.elevators = self.count(),
            Means::Corridor => self.corridor(),
            Means::Door => {
                self.brief.door_m = self.width_m.take().or(self.brief.door_m);
                self.last = Last::Door;
                self.numbers.clear();
            }
            Means::Beside => self.beside = true,
            Means::Open => self.open = true,
            Means::Only => self.brief.only = true,
            Means::Meters => self.meters(),
            Means::SquareMeters => self.square_meters(),
        }
    }

    fn corridor(&mut self) {
        self.brief.corridor_m = self.width_m.take().or(self.brief.corridor_m);
        self.last = Last::Corridor;
        self.numbers.clear();
    }

    fn meters(&mut self) {
        let Some(told) = self.numbers.pop() else { return };
        self.numbers.clear();
        match self.last {
            Last::Corridor if self.brief.corridor_m.is_none() => self.brief.corridor_m = Some(told),
            Last::Door if self.brief.door_m.is_none() => self.brief.door_m = Some(told),
            Last::Nothing | Last::Corridor | Last::Door | Last::Room(_) => self.width_m = Some(told),
        }
    }

    fn square_meters(&mut self) {
        let numbers = std::mem::take(&mut self.numbers);
        let area = match numbers.as_slice() {
            [.., least, most] if most >= least => [*least, *most],
            [.., about] => [about * ABOUT.0, about * ABOUT.1],
            [] => return,
        };
        if let Last::Room(place) = self.last
            && let Some(room) = self.brief.rooms.get_mut(place)
        {
            room.area_m2 = Some(area);
        }
    }

    fn room(&mut self, kind: &'static str) {
        let known = self.brief.rooms.iter().position(|room| same(&room.kind, kind));
        if std::mem::take(&mut self.beside) {
            if let Last::Room(place) = self.last
                && let Some(room) = self.brief.rooms.get_mut(place)
            {
                room.beside = Some(kind.to_owned());
            }
            self.numbers.clear();
            if known.is_none() {
                self.add(kind, 1);
            }
            return;
        }
        let count = self.count();
        match known.and_then(|place| Some((place, self.brief.rooms.get_mut(place)?))) {
            // A neighbor that is named again with its count.
            Some((place, room)) => {
                room.count = room.count.max(count);
                self.last = Last::Room(place);
            }
            None => self.add(kind, count),
        }
    }

    fn add(&mut self, kind: &str, count: u32) {
        self.last = Last::Room(self.brief.rooms.len());
        let open = std::mem::take(&mut self.open).then_some(true);
        let (kind, name) = (kind.to_owned(), Some(kind.to_owned()));
        self.brief.rooms.push(RoomBrief { kind, count, name, area_m2: None, beside: None, open, door_m: None });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> BuildingBrief {
        let read = building(text);
        assert_eq!(read.unread, Vec::<String>::new(), "{text}");
        read.brief.unwrap()
    }

    fn rooms(brief: &BuildingBrief) -> Vec<(&str, u32)> {
        brief.rooms.iter().map(|room| (room.kind.as_str(), room.count)).collect()
    }

    #[test]
    fn a_list_of_words_is_a_brief() {
        let hospital = read("a hospital with two wards, a lobby with two elevators");
        assert_eq!((hospital.kind, hospital.elevators), (BuildingKind::Hospital, 2));
        assert_eq!(rooms(&hospital), [("ward", 2)]);
        let office =
            read("an office with 6 offices, two meeting rooms next to the kitchen and a ring corridor 2 m wide");
        assert_eq!((office.kind, office.form, office.corridor_m), (BuildingKind::Office, Some(Ring), Some(2.0)));
        assert_eq!(rooms(&office), [("office", 6), ("meeting room", 2), ("kitchen", 1)]);
        assert_eq!(office.rooms[1].beside.as_deref(), Some("kitchen"));
        let clinic = read(
            "Clinic: three exam rooms of 20 to 25 m², 2.6m wide corridors, 1.2 m doors, 4 laboratories of 30 m2 only",
        );
        assert_eq!((clinic.corridor_m, clinic.door_m, clinic.only), (Some(2.6), Some(1.2), true));
        assert_eq!(clinic.rooms[0].area_m2, Some([20.0, 25.0]));
        assert_eq!((clinic.rooms[1].kind.as_str(), clinic.rooms[1].area_m2), ("laboratory", Some([24.0, 37.5])));
        let home = read("a house with an open kitchen and two bedrooms");
        assert_eq!((home.kind, home.rooms[0].open, home.rooms[1].count), (BuildingKind::Home, Some(true), 2));
    }

    #[test]
    fn words_that_nothing_was_read_from_are_handed_back() {
        let strange = building("a castle with two wards and a moat");
        assert_eq!(strange.brief, None);
        assert_eq!(strange.unread, ["castle", "moat"]);
    }

    #[test]
    fn every_row_is_spelled_as_words_are_read() {
        for (text, _) in ROWS {
            let words = words(text);
            assert!(!words.is_empty() && words.len() <= LONGEST && words.join(" ") == *text, "{text}");
        }
    }
}
