//! The page on which people look at films once and say how good a run was, which way the robot goes, or which of two is better; no
//! verdict, no planner and no true goal in sight.

use serde_json::{Value, json};
use socrates_model::{Digest, Location, Paths, Point, Recording};

use crate::play::{self, Places};
use crate::template::{self, template};

const TEMPLATE: &str = template!("web/observe.html");
const SCRIPT: &str = concat!(include_str!("web/raters.js"), include_str!("web/observe.js"));

/// The kinds of questions to whoever looks at films.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LookKind {
    /// A slider after a film.
    Rate,
    /// The same once more.
    Again,
    /// A slider during a film.
    Belief,
    /// Two films in step.
    Pair,
}

impl LookKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Rate, Self::Again, Self::Belief, Self::Pair];

    /// Its word in tables and on the page.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Rate => "rate",
            Self::Again => "again",
            Self::Belief => "belief",
            Self::Pair => "pair",
        }
    }
}

/// What is asked of whoever looks at films, by the numbers of the films.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// A slider after the film; `all` where every rater is to rate this film.
    Rate {
        /// Film.
        film: usize,
        /// Whether every rater gets it.
        all: bool,
    },
    /// The same film once more.
    Again {
        /// Film.
        film: usize,
    },
    /// A slider during the film: to which of two places the robot goes.
    Belief {
        /// Film, which has two goals.
        film: usize,
    },
    /// Two films in step: which is better.
    Pair {
        /// On the left.
        left: usize,
        /// On the right.
        right: usize,
    },
}

impl Look {
    /// Its kind.
    #[must_use]
    pub const fn kind(self) -> LookKind {
        match self {
            Self::Rate { .. } => LookKind::Rate,
            Self::Again { .. } => LookKind::Again,
            Self::Belief { .. } => LookKind::Belief,
            Self::Pair { .. } => LookKind::Pair,
        }
    }

    fn told(self, id: &str) -> Value {
        let (films, all) = match self {
            Self::Rate { film, all } => (vec![film], all),
            Self::Again { film } | Self::Belief { film } => (vec![film], true),
            Self::Pair { left, right } => (vec![left, right], true),
        };
        json!({ "id": id, "kind": self.kind().word(), "films": films, "all": all })
    }
}

/// A film of the page.
#[derive(Debug, Clone, Copy)]
pub struct Observed<'a> {
    /// Where it happens.
    pub location: &'a Location,
    /// The ways of the scenario: the camera shows them.
    pub paths: &'a Paths,
    /// All runs that are filmed alike.
    pub all: &'a [&'a Recording],
    /// The run.
    pub recording: &'a Recording,
    /// What is said of the place and the situation before the film.
    pub context: &'a str,
    /// The places A and B of a belief; one of them is the robot's goal.
    pub goals: Option<[Point; 2]>,
}

/// The page while it is being filled.
#[derive(Debug, Clone, Default)]
pub struct ObservePage {
    places: Places,
    films: Vec<Value>,
}

impl ObservePage {
    /// Adds a film; films are numbered from 0.
    pub fn add(&mut self, film: &Observed<'_>) {
        let index = self.places.number(film.location);
        let frame = play::frame(film.location);
        let mut way = film.location.graph.polyline(&film.paths.robot);
        way.extend(film.goals.into_iter().flatten());
        let mut played = play::run(film.location, &[], film.recording, play::rate(film.all));
        let at = |point: Point| {
            let (x, y) = frame.px(film.location, &point);
            [play::tenth(x), play::tenth(y)]
        };
        if let Some(members) = played.as_object_mut() {
            members.insert("name".to_owned(), "film".into());
            members.insert("place".to_owned(), index.into());
            members.insert("focus".to_owned(), json!(play::focus(film.location, &way, film.all)));
            members.insert("context".to_owned(), film.context.into());
            members.insert("goals".to_owned(), json!(film.goals.map(|goals| goals.map(at))));
        }
        self.films.push(played);
    }

    /// The page. `each` is how many of the films that not everybody rates a rater gets. What has been answered is kept by the browser
    /// under a key that belongs to these very films and questions.
    #[must_use]
    pub fn html(&self, title: &str, tasks: &[(String, Look)], each: usize) -> String {
        let mut places = self.places.told();
        // The name of a folder may tell what lies in it.
        places.iter_mut().filter_map(Value::as_object_mut).for_each(|place| drop(place.remove("name")));
        let tasks: Vec<Value> = tasks.iter().map(|(id, look)| look.told(id)).collect();
        let key = Digest::of(json!([self.films, tasks, each]).to_string().as_bytes()).short();
        let data = json!({ "films": self.films, "tasks": tasks, "places": places, "each": each, "key": key });
        template::page(TEMPLATE, SCRIPT, title, self.places.floors(), &data, vec![("scripts", String::new())])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, papers, walk};

    fn page(text: &str) -> String {
        let (_, _, _, paths) = papers(text);
        let (location, run) = (hall(text), walk(2));
        let mut page = ObservePage::default();
        let goals = Some([Point::new(1.0, 1.0), Point::new(4.0, 1.0)]);
        let film = Observed { location: &location, paths: &paths, all: &[&run], recording: &run, context: text, goals };
        page.add(&film);
        page.add(&Observed { goals: None, ..film });
        let tasks = [Look::Rate { film: 0, all: true }, Look::Belief { film: 0 }, Look::Pair { left: 1, right: 0 }];
        let tasks: Vec<_> = tasks.into_iter().enumerate().map(|(index, look)| (format!("t{index}"), look)).collect();
        page.html(text, &tasks, 3)
    }

    #[test]
    fn films_are_numbers_and_nothing_tells_run_planner_or_goal() {
        let html = page("a hall");
        let (_, body) = html.split_once("</style>").unwrap();
        for hidden in ["reference", "test.", "native", "\"verdict\"", "\"planner\""] {
            assert!(!body.contains(hidden), "{hidden}");
        }
        let (_, rest) = html.split_once("id=\"data\">").unwrap();
        let data: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
        assert_eq!(data["tasks"][2], json!({ "id": "t2", "kind": "pair", "films": [1, 0], "all": true }));
        assert_eq!(
            (data["films"][0]["goals"].as_array().unwrap().len(), data["films"][1]["goals"].is_null()),
            (2, true)
        );
        assert!(data["places"][0]["name"].is_null());
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        let html = page(EVIL);
        assert!(!html.contains("<script>alert") && !html.contains("<!--") && !html.contains("<img"));
        assert_eq!(html.matches("</script>").count(), 2);
    }
}
