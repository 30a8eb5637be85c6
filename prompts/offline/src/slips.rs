//! Slips of the pen, and words that people write together.

use crate::lexicon::lexicon;

/// Words that people write together.
pub(crate) const JOINED: &[(&str, &[&str])] = &[
    ("infront", &["in", "front"]),
    ("eachother", &["each", "other"]),
    ("dont", &["do", "not"]),
    ("doesnt", &["does", "not"]),
    ("didnt", &["did", "not"]),
    ("wont", &["will", "not"]),
    ("isnt", &["is", "not"]),
    ("arent", &["are", "not"]),
    ("shouldnt", &["should", "not"]),
    ("cant", &["can", "not"]),
    ("teh", &["the"]),
    ("dosnt", &["does", "not"]),
    ("dosent", &["does", "not"]),
    ("doesnot", &["does", "not"]),
    ("didn", &["did", "not"]),
    ("frist", &["first"]),
    ("fisrt", &["first"]),
    ("secound", &["second"]),
    ("asside", &["aside"]),
    ("infornt", &["in", "front"]),
    ("hte", &["the"]),
    ("adn", &["and"]),
    ("wating", &["waiting"]),
    ("secons", &["seconds"]),
    ("secods", &["seconds"]),
    ("employes", &["employees"]),
    ("coleagues", &["colleagues"]),
    ("coleague", &["colleague"]),
    ("begining", &["beginning"]),
    ("exuse", &["excuse"]),
    ("excuze", &["excuse"]),
    ("docter", &["doctor"]),
    ("docters", &["doctors"]),
    ("visiter", &["visitor"]),
    ("visiters", &["visitors"]),
    ("smae", &["same"]),
    ("thier", &["their"]),
    ("wiht", &["with"]),
    ("whcih", &["which"]),
    ("nobody's", &["nobody", "is"]),
];

/// Words that join clauses, of which slips are common too: `untill`, `befor`.
const JOINTS: &[&str] = &["until", "before", "while", "because", "unless", "except", "without", "whenever"];

/// The word that was meant by a slip of the pen: the only one of the tables that is one letter away.
///
/// Short words and words that start otherwise are left alone: a slip is guessed, never a meaning.
pub(crate) fn mended(text: &str) -> Option<&'static str> {
    let lex = lexicon();
    let letters = text.chars().count();
    if letters == 5 && text != "robot" && strsim::osa_distance("robot", text) == 1 && text.starts_with('r') {
        return Some("robot");
    }
    if letters < 4
        || lex.telling.contains(text)
        || lex.known.contains(text)
        || lex.known.contains(&lex.stem(text))
        || lex.adjectives.contains(text)
        || lex.stop.contains(text)
        || lex.things.contains(text)
    {
        return None;
    }
    if let Some(meant) = swapped(text) {
        return Some(meant);
    }
    if letters < 5 {
        return None;
    }
    let joins = JOINTS.iter().find(|word| {
        // `white` is no `while`: a letter is doubled or left out.
        letters != word.chars().count()
            && text.starts_with(word.chars().next().unwrap_or(' '))
            && strsim::osa_distance(word, text) == 1
    });
    if let Some(word) = joins {
        return Some(word);
    }
    // `manage` and `smoke` are what a manager and a smoker do.
    let doer = |word: &str| {
        text.ends_with('e') && word.strip_suffix('r') == Some(text)
            // `reported` is what a reporter did.
            || text.strip_suffix('d').is_some_and(|cut| word.strip_suffix('r') == Some(cut))
    };
    let near = |word: &&String| {
        (word.chars().count() >= 6 || letters == 5 && lex.roles.contains_key(word.as_str()) && word.len() == 5)
            && word.chars().next() == text.chars().next()
            && strsim::osa_distance(word, text) == 1
            && !doer(word)
    };
    let found: Vec<&'static String> = lex.telling.iter().filter(near).collect();
    if let [only] = found.as_slice() { Some(only) } else { None }
}

/// English words that are others with two letters swapped.
const NO_SLIPS: &[&str] = &[
    "form", "forms", "dose", "nerve", "angel", "sacred", "casual", "board", "clam", "blot", "bets", "lien", "dairy",
    "loin", "snag", "brat", "pros", "gaol", "tires", "tiers",
];

/// The only word of the tables that has the same letters, two neighbors swapped: `whne`, `corsses`. Of words as short as
/// names are, only those that every text has: `Lena` is no `lean`.
fn swapped(text: &str) -> Option<&'static str> {
    if NO_SLIPS.contains(&text) || !text.bytes().all(|b| b.is_ascii_lowercase()) {
        return None;
    }
    let lex = lexicon();
    let mut found: Option<&'static str> = None;
    for at in 1..text.len() {
        let mut letters = text.as_bytes().to_vec();
        letters.swap(at - 1, at);
        let Ok(other) = String::from_utf8(letters) else { continue };
        let Some(meant) = lex
            .stop
            .get(&other)
            .or_else(|| {
                lex.telling
                    .get(&other)
                    .or_else(|| lex.forms.get_key_value(&other).map(|(form, _)| form))
                    .filter(|_| text.len() > 4)
            })
            .filter(|_| other != text)
        else {
            continue;
        };
        if found.is_some_and(|known| known != meant) {
            return None;
        }
        found = Some(meant);
    }
    found
}
