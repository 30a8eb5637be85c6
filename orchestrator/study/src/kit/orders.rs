//! Which films a person sees, and in which order: balanced, so that neither a place in the order nor a neighbor favors a planner.

use crate::design::{Design, williams};
use crate::rating::Film;

/// Most films that a person rates where nothing else is said: more tire.
pub const MOST_FILMS: usize = 6;

/// One of the orders that people are given, each to as many.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Order {
    /// Its name in tables: a number from 1.
    pub name: String,
    /// Films, the first first.
    pub films: Vec<String>,
}

/// All orders of a study. Within a scenario planners stand in the rows of a Williams design; a person sees one seed of it, the same for all
/// planners. Where people see several scenarios, these stand in the rows of a Williams design as well, and where all of them are more films
/// than a person is to see, every choice of so many scenarios is made equally often (a balanced incomplete block design).
///
/// Orders of different scenarios alternate, so that the first people are spread over all of them.
#[must_use]
pub fn orders(design: &Design) -> Vec<Order> {
    let planners = williams(design.planners.len());
    let scenarios: Vec<&str> = design.scenarios.iter().map(String::as_str).collect();
    let size = scenarios_each(design);
    let blocks = choices(&scenarios, size);
    let rows = williams(size);
    let mut found = Vec::new();
    for (at, sequence) in planners.iter().enumerate() {
        for seed in 0..seeds(design) {
            for block in &blocks {
                // The order of scenarios goes round with that of planners.
                let Some(row) = rows.get((at + seed) % rows.len().max(1)) else { continue };
                let parts = row.iter().filter_map(|place| block.get(*place));
                let films = parts.flat_map(|scenario| of(design, scenario, sequence, seed)).collect();
                found.push(Order { name: (found.len() + 1).to_string(), films });
            }
        }
    }
    found
}

/// Scenarios that each person sees.
fn scenarios_each(design: &Design) -> usize {
    let most = design.films_per_person.unwrap_or(MOST_FILMS);
    let fit = (most / design.planners.len().max(1)).clamp(1, design.scenarios.len().max(1));
    if design.all_scenarios { fit } else { 1 }
}

/// Films that each person sees, where every planner has one in every scenario.
#[must_use]
pub fn films_each(design: &Design) -> usize {
    scenarios_each(design) * design.planners.len()
}

/// Seeds of which every planner has a film, at most over all scenarios.
fn seeds(design: &Design) -> usize {
    let count = |scenario: &String, planner: &String| films(design, scenario, planner).count();
    let pairs =
        design.scenarios.iter().flat_map(|scenario| design.planners.iter().map(move |planner| (scenario, planner)));
    pairs.map(|(scenario, planner)| count(scenario, planner)).max().unwrap_or(1).max(1)
}

fn films<'d>(design: &'d Design, scenario: &str, planner: &str) -> impl Iterator<Item = &'d Film> {
    let (scenario, planner) = (scenario.to_owned(), planner.to_owned());
    design.films.iter().filter(move |film| film.scenario == scenario && film.planner == planner)
}

/// The films of a scenario in an order of planners, of the seed that stands at a place.
fn of(design: &Design, scenario: &str, sequence: &[usize], seed: usize) -> Vec<String> {
    let film = |planner: &String| {
        let mut all: Vec<&Film> = films(design, scenario, planner).collect();
        all.sort_by_key(|film| film.seed);
        all.get(seed % all.len().max(1)).map(|film| film.id.clone())
    };
    sequence.iter().filter_map(|at| design.planners.get(*at)).filter_map(film).collect()
}

/// All choices of so many, each in the order in which they were given.
fn choices<'s>(from: &[&'s str], size: usize) -> Vec<Vec<&'s str>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    let mut found = Vec::new();
    for (at, first) in from.iter().enumerate() {
        for mut rest in choices(from.get(at + 1..).unwrap_or_default(), size - 1) {
            rest.insert(0, first);
            found.push(rest);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn design(scenarios: usize, seeds: usize, more: &str) -> Design {
        let mut text = format!(
            "title = \"x\"\nplanners = [\"aa\", \"bb\", \"cc\"]\nparticipants = 36\ninstruments = [\"psi\"]\n{more}\n"
        );
        for scenario in 0..scenarios {
            for planner in ["aa", "bb", "cc"] {
                for seed in 0..seeds {
                    let id = format!("f{scenario}{}{seed}", planner.len() + usize::from(planner.as_bytes()[0]));
                    text.push_str(&format!(
                        "[[film]]\nid = \"{id}\"\nscenario = \"s{scenario}\"\nplanner = \"{planner}\"\nseed = {seed}\n"
                    ));
                }
            }
        }
        Design::parse(&text, "study.toml").unwrap()
    }

    fn counts<K: Ord>(keys: impl Iterator<Item = K>) -> Vec<usize> {
        let mut found: BTreeMap<K, usize> = BTreeMap::new();
        keys.for_each(|key| *found.entry(key).or_default() += 1);
        let mut counts: Vec<usize> = found.into_values().collect();
        counts.dedup();
        counts
    }

    #[test]
    fn everybody_sees_each_planner_once_and_every_place_is_taken_equally_often() {
        let design = design(2, 1, "");
        let all = orders(&design);
        assert_eq!(all.len(), 12);
        let planner = |film: &String| design.film(film).unwrap().planner.clone();
        assert!(all.iter().all(|order| counts(order.films.iter().map(planner)) == [1]));
        let places = all.iter().flat_map(|order| order.films.iter().enumerate());
        assert_eq!(counts(places.map(|(place, film)| (place, film.clone()))), [2]);
        assert_ne!(design.film(&all[0].films[0]).unwrap().scenario, design.film(&all[1].films[0]).unwrap().scenario);
    }

    #[test]
    fn a_person_sees_one_seed_the_same_for_all_planners() {
        let design = design(1, 3, "");
        let all = orders(&design);
        assert_eq!(all.len(), 18);
        for order in &all {
            assert_eq!(order.films.len(), 3);
            assert_eq!(counts(order.films.iter().map(|film| design.film(film).unwrap().seed)), [3]);
        }
        assert_eq!(counts(all.iter().flat_map(|order| order.films.clone())), [6]);
    }

    #[test]
    fn of_many_scenarios_each_pair_is_seen_equally_often() {
        let design = design(4, 1, "all_scenarios = true");
        let all = orders(&design);
        assert_eq!((all.len(), all[0].films.len()), (36, 6), "six pairs of scenarios by six orders of planners");
        assert_eq!(counts(all.iter().flat_map(|order| order.films.clone())), [18]);
        let pair = |order: &Order| {
            let mut of: Vec<String> =
                order.films.iter().map(|film| design.film(film).unwrap().scenario.clone()).collect();
            of.sort();
            of.dedup();
            of
        };
        assert_eq!(counts(all.iter().map(pair)), [6]);
        let first = |order: &Order| design.film(&order.films[0]).unwrap().scenario.clone();
        assert_eq!(counts(all.iter().map(|order| (pair(order), first(order)))), [3]);
        let whole = orders(&self::design(2, 1, "all_scenarios = true\nfilms_per_person = 6"));
        assert!(whole.iter().all(|order| order.films.len() == 6));
    }
}
