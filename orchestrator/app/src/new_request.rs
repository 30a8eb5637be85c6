//! `new`: a commented request that its location can play.
//!
//! ```text
//! scene graph ─► places by name ─► pairs, the far ones first ─► read as any request ─► without a problem ─► plays ─► file
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::json;
use socrates_model::{Location, NodeId, PlaceClass, Request, Verdict};

use crate::exit::Diagnostic;
use crate::in_process;
use crate::output::Printer;
use crate::prepare::load_location;

/// The commented file, with places in braces for what belongs to the location.
const TEMPLATE: &str = include_str!("request.toml");
const CONTEXT: &str = "A weekday morning; people walk to their work";
/// What happens, the first that the location has the places for.
const STORIES: [&str; 3] = [
    "Two people are in the corridor. One person walks towards the robot and stops to look at it\n\
     when the robot is within 3 m. The other follows the robot.",
    "One person walks towards the robot and stops to look at it when the robot is within 3 m.\n\
     Another person follows the robot.",
    "A person walks towards the robot.",
];
/// So many pairs of places are read, the most promising ones.
const PAIRS: usize = 40;
/// So many requests that read well are tried out, the rest is not.
const TRIED: usize = 6;
/// A robot that goes less far meets nobody on the way, m.
const NEAR_M: f64 = 8.0;
/// Longer than this a template's trip need not be, m.
const FAR_M: f64 = 30.0;
/// Seed of a plain `run`.
const SEED: u64 = 1;

/// Writes a commented request.
pub async fn new(talk: &Printer, file: &Path, location: &str) -> Result<(), Diagnostic> {
    if file.exists() {
        return Err(Diagnostic::input(
            format!("`{}` exists already", file.display()),
            "choose another name; nothing was written",
        ));
    }
    let folder = file.parent().unwrap_or_else(|| Path::new("."));
    let (map, _) = load_location(location, folder)?;
    let text = template(location, &map).await;
    std::fs::write(file, text)
        .map_err(|why| Diagnostic::input(format!("cannot write `{}`: {why}", file.display()), "check the folder"))?;
    talk.line(&format!("wrote      {}", file.display()));
    talk.line(&format!("next       socrates read {}", crate::files::shell(file)));
    talk.result(&json!({ "request": file.display().to_string() }));
    Ok(())
}

/// What of a request depends on the location.
#[derive(Debug, Clone, PartialEq)]
struct Wording {
    task: String,
    story: &'static str,
}

/// The request for a location: one that is read without a problem and, where there is such a one, realised.
async fn template(name: &str, location: &Location) -> String {
    let places = places(location);
    let mut clean: Vec<Wording> = Vec::new();
    let mut least: Option<(usize, Wording)> = None;
    'search: for story in STORIES {
        for (start, goal) in trips(location, &places).into_iter().take(PAIRS) {
            let wording = Wording { task: format!("Deliver a parcel from the {start} to the {goal}"), story };
            let Some(request) = request(name, &wording) else { continue };
            let complaints = complaints(&request, location);
            if complaints == 0 {
                clean.push(wording);
            } else if least.as_ref().is_none_or(|(fewest, _)| complaints < *fewest) {
                least = Some((complaints, wording));
            }
            if clean.len() == TRIED {
                break 'search;
            }
        }
    }
    let mut chosen = clean.first().cloned().or_else(|| least.map(|(_, wording)| wording));
    for wording in clean {
        let Some(request) = request(name, &wording) else { continue };
        let played = in_process::play(&request, location, SEED).await;
        if played.is_ok_and(|played| played.report.verdict == Verdict::Realised) {
            chosen = Some(wording);
            break;
        }
    }
    // A map of one place, or without a name for any, has a task without a place.
    let chosen = chosen.unwrap_or_else(|| Wording {
        task: "Deliver a parcel".to_owned(),
        story: STORIES.last().copied().unwrap_or_default(),
    });
    let named: Vec<&str> = places.keys().map(String::as_str).collect();
    fill(name, &chosen, &named.join(", "))
}

/// The request as it will be read from the file.
fn request(name: &str, wording: &Wording) -> Option<Request> {
    Request::of_toml(&fill(name, wording, ""), None).ok()
}

/// How much the reading of a request has to say against it; what is said of every request does not count.
fn complaints(request: &Request, location: &Location) -> usize {
    let reading = socrates_offline::read(request, location);
    let notes = reading.notes.iter().filter(|note| *note != socrates_offline::CONTEXT_NOTE).count();
    reading.missing().len() + notes
}

/// The file.
fn fill(name: &str, wording: &Wording, places: &str) -> String {
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let values = [
        ("{location}", format!("{:<25}", quoted(name))),
        ("{context}", quoted(CONTEXT)),
        ("{task}", quoted(&wording.task)),
        ("{places}", places.to_owned()),
        ("{rough}", wording.story.to_owned()),
    ];
    values.into_iter().fold(TEMPLATE.to_owned(), |text, (place, value)| text.replacen(place, &value, 1))
}

/// Nodes by the name that people give their kind of place: `kitchen`, `reception area`, `exit`.
fn places(location: &Location) -> BTreeMap<String, Vec<NodeId>> {
    let mut found: BTreeMap<String, Vec<NodeId>> = BTreeMap::new();
    for node in location.graph.nodes() {
        let words: String =
            node.kind.to_lowercase().chars().map(|c| if c == '_' || c.is_whitespace() { ' ' } else { c }).collect();
        let words = words.split_whitespace().filter(|word| word.parse::<u32>().is_err()).collect::<Vec<_>>().join(" ");
        if !words.is_empty() {
            found.entry(words).or_default().push(node.id.clone());
        }
    }
    found
}

/// Names of a start and a goal, those first between which a robot meets people: rooms, open areas and ways out, far apart.
fn trips(location: &Location, places: &BTreeMap<String, Vec<NodeId>>) -> Vec<(String, String)> {
    let rank = |nodes: &[NodeId]| {
        let kind = nodes.first().and_then(|id| location.graph.node(id)).map(|node| PlaceClass::of_type(&node.kind));
        match kind {
            Some(PlaceClass::Room | PlaceClass::OpenArea) => 0_u8,
            Some(PlaceClass::Exit | PlaceClass::ElevatorLobby) => 1,
            Some(PlaceClass::Corridor | PlaceClass::Intersection | PlaceClass::Doorway) => 2,
            Some(_) | None => 3,
        }
    };
    let apart = |from: &[NodeId], to: &[NodeId]| {
        let node = |id: &NodeId| location.graph.node(id).map(|node| node.at);
        let all = from.iter().filter_map(node).flat_map(|a| to.iter().filter_map(node).map(move |b| (b - a).norm()));
        all.fold(f64::MAX, f64::min)
    };
    let mut found: Vec<((u8, bool, u64), String, String)> = Vec::new();
    let names: BTreeSet<&String> = places.keys().collect();
    for start in &names {
        for goal in names.iter().filter(|goal| *goal != start) {
            let (Some(from), Some(to)) = (places.get(*start), places.get(*goal)) else { continue };
            let meters = apart(from, to);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "millimeters on a map")]
            let spare = ((FAR_M - meters).abs().min(1e9) * 1e3) as u64;
            found.push(((rank(from) + rank(to), meters < NEAR_M, spare), (*start).clone(), (*goal).clone()));
        }
    }
    found.sort();
    found.into_iter().map(|(_, start, goal)| (start, goal)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::prepare::prepare_text;
    use crate::run_options::RunOptions;

    /// What a template says of a location, read back as a user's request.
    async fn of(name: &str, location: &Location) -> (String, usize) {
        let text = template(name, location).await;
        let request: Request = toml::from_str(&text).unwrap_or_else(|why| panic!("{why}\n{text}"));
        (request.task.clone(), complaints(&request, location))
    }

    #[tokio::test]
    async fn the_template_of_every_shipped_location_is_read_without_a_complaint_and_realised() {
        let config = Config::load(None, std::iter::empty(), &[]).unwrap();
        for name in socrates_maps::shipped::names() {
            let location = socrates_maps::shipped::load(name).unwrap();
            let (task, complaints) = of(name, &location).await;
            assert_eq!(complaints, 0, "{name}: {task}");
            let text = template(name, &location).await;
            let options = RunOptions::plain(SEED);
            let prepared = prepare_text("my", &text, "my.toml", Path::new("."), Some(&options), &config).unwrap();
            assert_eq!(prepared.reading.notes, [socrates_offline::CONTEXT_NOTE], "{name}");
            let played = in_process::play(&prepared.request, &prepared.location, SEED).await.unwrap();
            assert_eq!(played.report.verdict, Verdict::Realised, "{name}: {}", played.report.verdict_text);
        }
    }

    #[tokio::test]
    async fn a_map_of_ones_own_has_a_template_of_its_own_names() {
        let mut location = socrates_maps::shipped::load("office").unwrap();
        let other = |kind: &str| match kind {
            "KITCHEN" => "LABORATORY_1".to_owned(),
            "MEETING ROOM" => "STORE ROOM".to_owned(),
            kind if PlaceClass::of_type(kind) == PlaceClass::Corridor => kind.to_owned(),
            _ => "INTERSECTION".to_owned(),
        };
        location.graph =
            location.graph.edited(|nodes, _| nodes.iter_mut().for_each(|node| node.kind = other(&node.kind)));
        let (task, complaints) = of("my \"lab\"", &location).await;
        assert_eq!(complaints, 0, "{task}");
        assert!(task.contains("laboratory") || task.contains("store room"), "{task}");
        let text = template("my \"lab\"", &location).await;
        assert!(text.contains("# places of this map: corridor"), "{text}");
    }

    #[tokio::test]
    async fn a_map_without_names_has_a_template_too() {
        let mut location = socrates_maps::shipped::load("office").unwrap();
        location.graph = location.graph.edited(|nodes, _| nodes.iter_mut().for_each(|node| node.kind.clear()));
        let text = template("bare", &location).await;
        assert!(toml::from_str::<Request>(&text).is_ok(), "{text}");
    }
}
