//! The survey as Qualtrics imports it: a QSF file, and the codebook of the columns that it will export.
//!
//! The format is not documented. The frame is that of files which are known to import: nine kinds of elements, a trash block, questions
//! numbered `QIDn`. Orders need no branches: one randomizer over groups, each with its number as embedded data.

use serde_json::{Value, json};

use super::asks::{Block, Check, blocks, checks};
use super::legend;
use super::media::{GATE, Media, video};
use super::orders::{Order, orders};
use super::page::{escape, paragraphs};
use super::setup::agreed;
use crate::design::Design;
use crate::problem::Problem;

/// Longest description of a question, characters.
const DESCRIPTION: usize = 100;
/// Shows the way on once a film has ended, and says how much of it was played.
fn gated(film: &str) -> String {
    format!(
        "Qualtrics.SurveyEngine.addOnload(function(){{var page=this;page.hideNextButton();{GATE}\
         gate(document.getElementById('film-{film}'),function(seconds){{Qualtrics.SurveyEngine.setEmbeddedData('{film}_watched',seconds);page.showNextButton();}});}});"
    )
}

/// A QSF file and its codebook.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Qsf {
    /// The survey.
    pub survey: String,
    /// What its columns are, by ImportId: `column,role,film,item`.
    pub codebook: String,
}

/// The survey while it is being written.
struct Writer<'d> {
    id: String,
    design: &'d Design,
    questions: Vec<Value>,
    blocks: Vec<Value>,
    codebook: Vec<String>,
}

impl Writer<'_> {
    /// Adds a question and gives its number.
    fn question(&mut self, tag: &str, text: &str, about: &str, mut more: Value) -> String {
        let number = format!("QID{}", self.questions.len() + 1);
        let about: String = about.chars().take(DESCRIPTION).collect();
        let common = json!({ "QuestionText": text, "DataExportTag": tag, "QuestionID": number, "QuestionDescription": about,
            "Configuration": { "QuestionDescriptionOption": "UseText" }, "Language": [], "DefaultChoices": false,
            "DataVisibility": { "Private": false, "Hidden": false }, "NextChoiceId": 100, "NextAnswerId": 100,
            "Validation": { "Settings": { "ForceResponse": "OFF", "ForceResponseType": "ON", "Type": "None" } } });
        if let (Some(more), Value::Object(common)) = (more.as_object_mut(), common) {
            for (key, value) in common {
                more.entry(key).or_insert(value);
            }
        }
        self.questions.push(json!({ "SurveyID": self.id, "Element": "SQ", "PrimaryAttribute": number,
            "SecondaryAttribute": about, "TertiaryAttribute": null, "Payload": more }));
        number
    }

    /// Adds a block of questions, `None` for a page break, and gives its id.
    fn block(&mut self, name: &str, kind: &str, parts: &[Option<String>]) -> String {
        let id = format!("BL_{:0>15}", self.blocks.len() + 1);
        let part = |part: &Option<String>| match part {
            Some(question) => json!({ "Type": "Question", "QuestionID": question }),
            None => json!({ "Type": "Page Break" }),
        };
        let parts: Vec<Value> = parts.iter().map(part).collect();
        self.blocks.push(json!({ "Type": kind, "Description": name, "ID": id, "BlockElements": parts }));
        id
    }

    fn film(&mut self, film: &str, media: &Media) -> String {
        let design = self.design;
        let scenario = design.film(film).map_or("", |film| film.scenario.as_str());
        let context = design.sources.iter().find(|source| source.name == scenario).map_or("", |source| &source.context);
        let text = format!(
            "<p>{}</p><p>Please watch the film to its end. The questions come after it.</p>{}",
            escape(context),
            video(&media.of(film), film)
        );
        let shown = self.question(
            &format!("{film}_film"),
            &text,
            "film",
            json!({ "QuestionType": "DB", "Selector": "TB", "QuestionJS": gated(film) }),
        );
        let timer = self.question(
            &format!("{film}_time"),
            "Timing",
            "time",
            json!({ "QuestionType": "Timing", "Selector": "PageTimer",
                "Choices": { "1": { "Display": "First Click" }, "2": { "Display": "Last Click" }, "3": { "Display": "Page Submit" }, "4": { "Display": "Click Count" } } }),
        );
        self.codebook.push(format!("{timer}_PAGE_SUBMIT,time,{film},"));
        let mut parts = vec![Some(shown), None, Some(timer)];
        for block in blocks(design) {
            parts.push(Some(self.items(film, block)));
        }
        self.block(film, "Standard", &parts)
    }

    fn items(&mut self, film: &str, block: Block<'_>) -> String {
        let tag = format!("{film}_{}", block.of.id.replace('-', ""));
        let items: Vec<_> = block.items().collect();
        let number = |at: usize| (at + 1).to_string();
        let rows: serde_json::Map<String, Value> =
            items.iter().enumerate().map(|(at, item)| (number(at), json!({ "Display": escape(&item.text) }))).collect();
        let tags: serde_json::Map<String, Value> =
            items.iter().enumerate().map(|(at, item)| (number(at), json!(format!("{film}_{}", item.code)))).collect();
        let order: Vec<String> = (0..items.len()).map(number).collect();
        let stem = escape(&block.of.stem);
        let question = if block.is_slider() {
            let (low, high) = block.of.points;
            let labels: Vec<&String> = block.of.anchors.iter().map(|(_, words)| words).collect();
            let labels: serde_json::Map<String, Value> =
                labels.iter().enumerate().map(|(at, words)| (number(at), json!({ "Display": words }))).collect();
            self.question(
                &tag,
                &stem,
                &block.of.title,
                json!({ "QuestionType": "Slider", "Selector": "HSLIDER", "Choices": rows, "ChoiceOrder": order, "ChoiceDataExportTags": tags,
                    "Labels": labels, "Answers": { "1": { "Display": "1" } },
                    "Configuration": { "QuestionDescriptionOption": "UseText", "CSSliderMin": low, "CSSliderMax": high, "GridLines": 10,
                        "NumDecimals": "0", "ShowValue": false, "CustomStart": false, "SnapToGrid": false, "NotApplicable": false, "MobileFirst": true } }),
            )
        } else {
            let points = block.points();
            let answers: serde_json::Map<String, Value> = points
                .iter()
                .enumerate()
                .map(|(at, point)| (number(at), json!({ "Display": escape(&block.words(*point)) })))
                .collect();
            let recodes: serde_json::Map<String, Value> =
                points.iter().enumerate().map(|(at, point)| (number(at), json!(point.to_string()))).collect();
            let columns: Vec<String> = (0..points.len()).map(number).collect();
            self.question(
                &tag,
                &stem,
                &block.of.title,
                json!({ "QuestionType": "Matrix", "Selector": "Likert", "SubSelector": "SingleAnswer", "Choices": rows, "ChoiceOrder": order,
                    "ChoiceDataExportTags": tags, "Answers": answers, "AnswerOrder": columns, "RecodeValues": recodes,
                    "Validation": { "Settings": { "ForceResponse": "RequestResponse", "ForceResponseType": "RequestResponse", "Type": "None" } },
                    "Randomization": { "Advanced": null, "TotalRandSubset": "", "Type": "None" } }),
            )
        };
        for (at, item) in items.iter().enumerate() {
            self.codebook.push(format!("{question}_{},item,{film},{}", at + 1, item.code));
        }
        question
    }

    fn check(&mut self, check: &Check) -> String {
        let of = blocks(self.design).into_iter().find(|block| block.of.id == check.instrument);
        let points = of.map(|block| block.points()).unwrap_or_default();
        let number = |at: usize| (at + 1).to_string();
        let words = |point: f64| of.map(|block| block.words(point)).unwrap_or_default();
        let choices: serde_json::Map<String, Value> = points
            .iter()
            .enumerate()
            .map(|(at, point)| (number(at), json!({ "Display": escape(&words(*point)) })))
            .collect();
        let recodes: serde_json::Map<String, Value> =
            points.iter().enumerate().map(|(at, point)| (number(at), json!(point.to_string()))).collect();
        let order: Vec<String> = (0..points.len()).map(number).collect();
        let question = self.question(
            &check.name,
            &escape(&check.text),
            &check.text,
            json!({ "QuestionType": "MC", "Selector": "SAHR", "SubSelector": "TX", "Choices": choices, "ChoiceOrder": order, "RecodeValues": recodes }),
        );
        self.codebook.push(format!("{question},check,,{}", check.name));
        self.block(&check.name, "Standard", &[Some(question)])
    }
}

/// The survey and its codebook.
///
/// # Errors
/// An attention check that cannot be answered, a text of consent that does not say how long it takes.
pub fn qsf(design: &Design, media: &Media) -> Result<Qsf, Problem> {
    let all = orders(design);
    let most = all.iter().map(|order| order.films.len()).max().unwrap_or(0);
    let checks = checks(design, most)?;
    let id = format!("SV_{}", design.digest.get(..15).unwrap_or_default());
    let mut writer = Writer { id: id.clone(), design, questions: Vec::new(), blocks: Vec::new(), codebook: Vec::new() };
    let consent = paragraphs(&agreed(design)?.paragraphs);
    let agrees = writer.question(
        "consent",
        &format!("{consent}<p>If you do not agree, please close this page.</p>"),
        "consent",
        json!({ "QuestionType": "MC", "Selector": "SAVR", "SubSelector": "TX", "Choices": { "1": { "Display": "I agree and take part" } }, "ChoiceOrder": ["1"],
            "Validation": { "Settings": { "ForceResponse": "ON", "ForceResponseType": "ON", "Type": "None" } } }),
    );
    writer.codebook.push(format!("{agrees},ignored,,"));
    let seen = paragraphs(&legend::paragraphs(design));
    let seen = writer.question("seen", &seen, "what films show", json!({ "QuestionType": "DB", "Selector": "TB" }));
    let first = writer.block("consent", "Default", &[Some(agrees), None, Some(seen)]);
    let mut films: Vec<(String, String)> = Vec::new();
    for film in &design.films {
        let block = writer.film(&film.id, media);
        films.push((film.id.clone(), block));
    }
    films.sort();
    let checks: Vec<(Check, String)> = checks.into_iter().map(|check| (check.clone(), writer.check(&check))).collect();
    writer.block("Trash / Unused Questions", "Trash", &[]);
    let flow = flow(design, &first, &all, &films, &checks);
    let entry = entry(design, &id);
    let count = writer.questions.len().to_string();
    let element = |kind: &str, first: &str, second: Value, third: Value, payload: Value| json!({ "SurveyID": id, "Element": kind, "PrimaryAttribute": first, "SecondaryAttribute": second, "TertiaryAttribute": third, "Payload": payload });
    let options = json!({ "BackButton": "false", "SaveAndContinue": "true", "SurveyProtection": "PublicSurvey", "BallotBoxStuffingPrevention": "false",
        "NoIndex": "Yes", "SecureResponseFiles": "true", "SurveyExpiration": "None", "SurveyTermination": "DefaultMessage", "Header": "", "Footer": "",
        "ProgressBarDisplay": "Text", "PartialData": "+1 week", "PreviousButton": "", "NextButton": "", "SkinType": "MQ",
        "Skin": { "brandingId": null, "templateId": "*base", "overrides": null }, "NewScoring": 1, "SurveyTitle": design.title,
        "AnonymizeResponse": "Yes" });
    let mut elements = vec![
        element("FL", "Survey Flow", Value::Null, Value::Null, flow),
        element("SO", "Survey Options", Value::Null, Value::Null, options),
        element(
            "SCO",
            "Scoring",
            Value::Null,
            Value::Null,
            json!({ "ScoringCategories": [], "ScoringCategoryGroups": [], "ScoringSummaryCategory": null, "ScoringSummaryAfterQuestions": 0, "ScoringSummaryAfterSurvey": 0, "DefaultScoringCategory": null, "AutoScoringCategory": null }),
        ),
        element(
            "PROJ",
            "CORE",
            Value::Null,
            json!("1.1.0"),
            json!({ "ProjectCategory": "CORE", "SchemaVersion": "1.1.0" }),
        ),
        element(
            "STAT",
            "Survey Statistics",
            Value::Null,
            Value::Null,
            json!({ "MobileCompatible": true, "ID": "Survey Statistics" }),
        ),
        element("QC", "Survey Question Count", json!(count), Value::Null, Value::Null),
        element(
            "RS",
            &format!("RS_{}", design.digest.get(..15).unwrap_or_default()),
            json!("Default Response Set"),
            Value::Null,
            Value::Null,
        ),
        element("BL", "Survey Blocks", Value::Null, Value::Null, Value::Array(writer.blocks)),
    ];
    elements.extend(writer.questions);
    let survey = json!({ "SurveyEntry": entry, "SurveyElements": elements });
    let survey = serde_json::to_string_pretty(&survey).unwrap_or_default();
    let head = "column,role,film,item".to_owned();
    let codebook = std::iter::once(head).chain(writer.codebook).map(|line| line + "\n").collect();
    Ok(Qsf { survey, codebook })
}

fn entry(design: &Design, id: &str) -> Value {
    let set = format!("RS_{}", design.digest.get(..15).unwrap_or_default());
    json!({ "SurveyID": id, "SurveyName": design.title, "SurveyDescription": null, "SurveyOwnerID": "UR_000000000000000",
        "SurveyBrandID": "socrates", "DivisionID": null, "SurveyLanguage": "EN", "SurveyActiveResponseSet": set, "SurveyStatus": "Inactive",
        "SurveyStartDate": "0000-00-00 00:00:00", "SurveyExpirationDate": "0000-00-00 00:00:00", "SurveyCreationDate": "2024-01-01 00:00:00",
        "CreatorID": "UR_000000000000000", "LastModified": "2024-01-01 00:00:00", "LastAccessed": "0000-00-00 00:00:00",
        "LastActivated": "0000-00-00 00:00:00", "Deleted": null })
}

/// The participant, consent, one of the orders, and the way back.
fn flow(design: &Design, first: &str, all: &[Order], films: &[(String, String)], checks: &[(Check, String)]) -> Value {
    let mut count = 1;
    let mut next = || {
        count += 1;
        format!("FL_{count}")
    };
    let field = |name: &str, value: Option<String>| {
        let kind = if value.is_some() { "Custom" } else { "Recipient" };
        let mut field = json!({ "Description": name, "Type": kind, "Field": name, "VariableType": "String", "DataVisibility": [], "AnalyzeText": false });
        if let (Some(members), Some(value)) = (field.as_object_mut(), value) {
            members.insert("Value".to_owned(), json!(value));
        }
        field
    };
    let block = |id: &str, flow: String| json!({ "Type": "Standard", "ID": id, "FlowID": flow, "Autofill": [] });
    let mut known: Vec<Value> =
        ["PROLIFIC_PID", "STUDY_ID", "SESSION_ID"].iter().map(|name| field(name, None)).collect();
    known.extend(films.iter().map(|(film, _)| field(&format!("{film}_watched"), None)));
    let mut whole =
        vec![json!({ "Type": "EmbeddedData", "FlowID": next(), "EmbeddedData": known }), block(first, next())];
    let mut groups = Vec::new();
    for order in all {
        let (group, data) = (next(), next());
        let mut fields = vec![field("order", Some(order.name.clone()))];
        for (place, film) in order.films.iter().enumerate() {
            fields.push(field(&format!("{film}_position"), Some((place + 1).to_string())));
        }
        let mut parts = vec![json!({ "Type": "EmbeddedData", "FlowID": data, "EmbeddedData": fields })];
        for (place, film) in order.films.iter().enumerate() {
            if let Some((_, id)) = films.iter().find(|(known, _)| known == film) {
                parts.push(block(id, next()));
            }
            let due = checks.iter().filter(|(check, _)| check.position == place + 1);
            parts.extend(due.map(|(_, id)| block(id, next())).collect::<Vec<_>>());
        }
        groups.push(
            json!({ "Type": "Group", "FlowID": group, "Description": format!("order {}", order.name), "Flow": parts }),
        );
    }
    whole.push(
        json!({ "Type": "BlockRandomizer", "FlowID": next(), "SubSet": 1, "EvenPresentation": true, "Flow": groups }),
    );
    if let Some(url) = &design.survey.completion_url {
        whole.push(json!({ "Type": "EndSurvey", "FlowID": next(), "EndingType": "Advanced",
            "Options": { "Advanced": "true", "SurveyTermination": "Redirect", "EOSRedirectURL": url } }));
    }
    json!({ "Type": "Root", "FlowID": "FL_1", "Flow": whole, "Properties": { "Count": count } })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::kit::tests::design;
    use crate::read::Codebook;

    #[test]
    fn the_survey_has_the_frame_that_imports_and_names_no_planner() {
        let design = design();
        let found = qsf(&design, &Media::parse("https://films.example.org/a").unwrap()).unwrap();
        for hidden in ["mppi", "nav2can"] {
            assert!(!found.survey.contains(hidden) && !found.codebook.contains(hidden));
        }
        let survey: Value = serde_json::from_str(&found.survey).unwrap();
        let elements = survey["SurveyElements"].as_array().unwrap();
        let kinds: Vec<&str> = elements.iter().map(|element| element["Element"].as_str().unwrap()).collect();
        assert_eq!(&kinds[..8], ["FL", "SO", "SCO", "PROJ", "STAT", "QC", "RS", "BL"]);
        let questions: Vec<&Value> = elements.iter().filter(|element| element["Element"] == "SQ").collect();
        // Consent, what shapes mean, of each of three films the film, its time and three instruments, two checks.
        assert_eq!(questions.len(), 2 + 3 * 5 + 2);
        assert_eq!(elements[5]["SecondaryAttribute"], json!(questions.len().to_string()));
        let numbers: BTreeSet<&str> = questions.iter().map(|one| one["PrimaryAttribute"].as_str().unwrap()).collect();
        assert_eq!(numbers.len(), questions.len());
        let tags: BTreeSet<&str> =
            questions.iter().map(|one| one["Payload"]["DataExportTag"].as_str().unwrap()).collect();
        assert_eq!(tags.len(), questions.len(), "no tag twice");
        assert!(
            questions.iter().all(|one| one["Payload"]["QuestionDescription"].as_str().unwrap().chars().count() <= 100)
        );
        let blocks = elements[7]["Payload"].as_array().unwrap();
        assert!(
            blocks.iter().any(|block| block["Type"] == "Trash")
                && blocks.iter().any(|block| block["Type"] == "Default")
        );
        // Every block of the flow is there, and every order is a group of one even randomizer.
        let ids: BTreeSet<&str> = blocks.iter().map(|block| block["ID"].as_str().unwrap()).collect();
        let flow = &elements[0]["Payload"];
        let randomizer = &flow["Flow"][2];
        assert_eq!((&randomizer["SubSet"], &randomizer["EvenPresentation"]), (&json!(1), &json!(true)));
        let groups = randomizer["Flow"].as_array().unwrap();
        assert_eq!(groups.len(), 6);
        let mut seen = BTreeSet::new();
        for part in groups.iter().flat_map(|group| group["Flow"].as_array().unwrap()) {
            assert!(seen.insert(part["FlowID"].as_str().unwrap().to_owned()));
            assert!(part["Type"] == "EmbeddedData" || ids.contains(part["ID"].as_str().unwrap()));
        }
        assert!(found.survey.contains("https://films.example.org/a/k7f.mp4"));
        Codebook::read(&found.codebook, "codebook").unwrap();
    }
}
