//! Models of people: `[people]`, by number, by name, or by the name that a form gives them.

use std::collections::BTreeMap;

use super::read::Door;
use super::tree::{Kind, Node};
use super::{Expect, MAX_HUMANS};
use crate::form::Form;
use crate::ids::HumanId;
use crate::person_model::PersonModel;

/// How a line is written, for messages.
const LINE: &str = "human_1 = \"external:mine\"";

impl Door<'_> {
    /// The people whom drivers outside move. Whether a person is there is known here where a form or `expect.humans` counts them.
    pub(super) fn people(&mut self, node: &Node, form: &Form, expect: &Expect) -> BTreeMap<HumanId, PersonModel> {
        let mut found = BTreeMap::new();
        let Kind::Table(entries) = &node.kind else {
            self.bad("people", node.at, format!("is {}", node.kind.name()), format!("a table: {{ {LINE} }}"));
            return found;
        };
        let most = if form.humans.is_empty() { expect.humans.unwrap_or(MAX_HUMANS) } else { form.headcount() };
        for (key, at, value) in entries {
            let shown: String = key.chars().take(80).collect();
            let path = format!("people.{shown}");
            let whose = whose(key, form, most);
            if whose.is_empty() {
                let hint = match (key == "robot", most) {
                    (true, _) => "the robot is driven by `robot.planners`; here stand people".to_owned(),
                    (false, 1) => format!("human_1, such as {LINE}"),
                    (false, _) => format!("human_1 to human_{most}, such as {LINE}"),
                };
                self.bad(&path, *at, format!("`{shown}` is nobody"), hint);
            }
            let Some(model) = self.typed::<PersonModel>(&path, value, &format!("for example {LINE}")) else { continue };
            for id in whose {
                if found.insert(id, model.clone()).is_some() {
                    self.bad(&path, *at, format!("names {id} again"), "each person has one model: remove a line");
                }
            }
        }
        found
    }
}

/// The people whom a key means: `2`, `human_2`, or a name of the form.
fn whose(key: &str, form: &Form, most: u32) -> Vec<HumanId> {
    let named = form.named(key);
    if !named.is_empty() {
        return named;
    }
    let number = key.parse::<u32>().ok().or_else(|| Some(key.parse::<HumanId>().ok()?.number()));
    number.filter(|number| (1..=most).contains(number)).map(HumanId::new).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use crate::{HumanId, Request};

    const PLAIN: &str = "location = \"office\"\nsocial_context = \"An office\"\ntask = \"Deliver mail\"\n";

    fn told(more: &str) -> Vec<String> {
        let read = Request::of_toml(&format!("{PLAIN}{more}"), None);
        read.err().unwrap_or_default().iter().map(|bad| bad.told("my.toml")).collect()
    }

    fn drivers(more: &str) -> Vec<(u32, String)> {
        let request = Request::of_toml(&format!("{PLAIN}{more}"), None).unwrap_or_else(|bad| panic!("{bad:#?}"));
        assert_eq!(Request::of_toml(&toml::to_string(&request).unwrap(), None).unwrap(), request);
        assert_eq!(serde_json::from_value::<Request>(serde_json::to_value(&request).unwrap()).unwrap(), request);
        request.people.into_iter().map(|(id, model)| (id.number(), model.driver().to_owned())).collect()
    }

    #[test]
    fn a_person_is_named_by_number_by_name_or_by_the_name_of_the_form() {
        let two = [(1, "other".to_owned()), (2, "mine".to_owned())];
        assert_eq!(drivers("[people]\n2 = \"external:mine\"\nhuman_1 = \"external:other\"\n"), two);
        let form = "[[human]]\nid = \"nurse\"\nrelation = \"crossing\"\n\
                    [[human]]\nid = \"visitor\"\ncount = 2\nrelation = \"frontal\"\n";
        let one = |who: &str| drivers(&format!("{form}[people]\n{who} = \"external:mine\"\n"));
        assert_eq!(one("nurse"), [(1, "mine".to_owned())]);
        assert_eq!(one("visitor_2"), [(3, "mine".to_owned())]);
        // One driver may drive several.
        assert_eq!(one("visitor"), [(2, "mine".to_owned()), (3, "mine".to_owned())]);
        assert_eq!(drivers(""), []);
        let request = Request::of_toml(PLAIN, None).unwrap();
        assert_eq!(serde_json::to_value(&request).unwrap().get("people"), None, "what nobody states is not written");
        assert!(!request.people.contains_key(&HumanId::new(1)));
    }

    #[test]
    fn what_nobody_can_be_driven_by_is_told_with_place_value_and_hint() {
        for (more, said) in [
            (
                "[expect]\nhumans = 2\n[people]\n3 = \"external:mine\"\n",
                "my.toml:7:1 `people.3`: `3` is nobody (human_1 to human_2, such as human_1 = \"external:mine\")",
            ),
            ("[people]\n0 = \"external:mine\"\n", "`people.0`: `0` is nobody (human_1 to human_40"),
            ("[people]\nnurse = \"external:mine\"\n", "`people.nurse`: `nurse` is nobody"),
            ("[people]\nrobot = \"external:mine\"\n", "the robot is driven by `robot.planners`"),
            (
                "[people]\n1 = \"orca\"\n",
                "my.toml:5:5 `people.1`: `orca` is not a model of a person; allowed: `external:` and the name of a driver",
            ),
            ("[people]\n1 = \"external:a b\"\n", "`external:a b` is not a model of a person"),
            ("[people]\n1 = 3\n", "`people.1`: invalid type: integer `3`"),
            (
                "[people]\n1 = \"external:a\"\nhuman_1 = \"external:b\"\n",
                "my.toml:6:1 `people.human_1`: names human_1 again (each person has one model: remove a line)",
            ),
            ("people = \"external:mine\"\n", "`people`: is a text (a table: { human_1 = \"external:mine\" })"),
        ] {
            let told = told(more);
            assert!(told.len() == 1 && told[0].contains(said), "{said}: {told:#?}");
        }
    }
}
