//! What people read before the first film, whichever program shows it: what films are about and what their shapes mean.

use super::page::views;
use crate::design::Design;

/// What is true of all films; how many there are stands before it.
pub const FILMS: &str = "You answer questions after each film. The robots look the same but may act differently, and a scene can come more than \
once. A film can end before the robot has reached its goal.";

/// A kind of shape, by which our own page finds its picture, the views whose films show it, and its meaning.
const SHAPES: [(&str, &[&str], &str); 5] = [
    ("robot", &["above"], "From above, the robot is the blue square; the white arrow shows where it looks."),
    (
        "person",
        &["above"],
        "From above, each person is a circle of another color; the white arrow shows where they look.",
    ),
    ("place", &["above"], "Dark: walls and furniture. Gray: floor that nobody gets to. Brown: doors."),
    (
        "front",
        &["person"],
        "Some films show what a person there sees: the robot is blue, and the white side is its front.",
    ),
    ("bubble", &["above", "person"], "Words in a bubble: a gesture or words of the person or robot below it."),
];

/// The shapes of a study's films with what they mean.
#[must_use]
pub fn shapes(design: &Design) -> Vec<(&'static str, &'static str)> {
    let views = views(design);
    let shown = SHAPES.iter().filter(|(_, of, _)| of.iter().any(|view| views.contains(view)));
    shown.map(|(kind, _, words)| (*kind, *words)).collect()
}

/// The paragraphs for a program that shows text alone: films, shapes, and the instructions of the study.
#[must_use]
pub fn paragraphs(design: &Design) -> Vec<String> {
    let films = format!("You will watch short films of robots that move among people. {FILMS}");
    let shapes = shapes(design).into_iter().map(|(_, words)| words.to_owned());
    let own = design.survey.instructions.split("\n\n").map(|part| part.trim().replace('\n', " "));
    std::iter::once(films).chain(shapes).chain(own.filter(|part| !part.is_empty())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::media::Media;
    use crate::kit::tests::design;
    use crate::kit::{advanced, jspsych, limesurvey, page, qsf};

    #[test]
    fn every_program_says_what_shapes_mean() {
        let mut design = design();
        design.survey.instructions = "Please take your time.\n\nSit down.".to_owned();
        let media = Media::parse("https://films.example.org").unwrap();
        let texts = [
            page::page(&design).unwrap(),
            jspsych::jspsych(&design).unwrap(),
            qsf::qsf(&design, &media).unwrap().survey,
            advanced::advanced(&design, &media).unwrap(),
            limesurvey::limesurvey(&design, &media).unwrap(),
        ];
        assert_eq!(shapes(&design).len(), 4, "nothing of films in first person, which the study has not");
        for text in &texts {
            for (_, words) in shapes(&design) {
                assert!(text.contains(words), "{words}");
            }
            assert!(text.contains(FILMS) && text.contains("Please take your time.") && text.contains("Sit down."));
            assert!(!text.contains("first person") && !text.contains("its front"));
        }
        design.sources[0].view = "human_2".to_owned().try_into().unwrap();
        let kinds: Vec<&str> = shapes(&design).into_iter().map(|(kind, _)| kind).collect();
        assert_eq!(kinds, ["front", "bubble"]);
    }
}
