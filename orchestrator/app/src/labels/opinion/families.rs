//! Families of language models: a model likes what models of its own family write, so that it is no second opinion on that.

use socrates_model::{AuthorSpec, Signature};

/// Beginnings of the names of models by family, in small letters. A model that is not listed is of the family of its name up to the first
/// character that is no letter.
const FAMILIES: &[(&str, &[&str])] = &[
    ("gpt", &["gpt", "chatgpt", "o1", "o3", "o4", "codex"]),
    ("claude", &["claude"]),
    ("gemini", &["gemini", "gemma", "paligemma", "palm"]),
    ("llama", &["llama", "llava", "codellama", "meta-llama"]),
    ("qwen", &["qwen", "qwq", "qvq"]),
    ("mistral", &["mistral", "mixtral", "ministral", "magistral", "pixtral", "codestral", "devstral"]),
    ("deepseek", &["deepseek", "janus"]),
    ("phi", &["phi"]),
    ("grok", &["grok"]),
    ("glm", &["glm", "chatglm", "cogvlm"]),
    ("internvl", &["internvl", "internlm"]),
];
/// Authors that are no model: a person at the console, the solver, the compiler of rules, what was pinned.
const NO_MODELS: [&str; 4] = ["console:", "solver/", "compiled/", "pinned"];

/// The family of a model by its name, such as `openai:gpt-4o` or `vllm:org/Qwen2.5-VL-7B`; nothing for rules, persons and recordings.
pub(super) fn family(name: &str) -> Option<String> {
    let rules = Signature::from(name).is_rules() || NO_MODELS.iter().any(|no_model| name.starts_with(no_model));
    // A setting that asks no server, whatever stands around it.
    let nobody = name.parse::<AuthorSpec>().is_ok_and(|author| author.server().is_none());
    if rules || nobody {
        return None;
    }
    // Recordings ask somebody else.
    let asked = AuthorSpec::server_in(name).unwrap_or(name);
    let model = asked.split_once(':').map_or(asked, |(_, model)| model);
    let model = model.rsplit('/').next().unwrap_or(model).to_lowercase();
    let listed = FAMILIES.iter().find(|(_, names)| names.iter().any(|begins| model.starts_with(begins)));
    let own = || model.chars().take_while(char::is_ascii_alphabetic).collect::<String>();
    let found = listed.map_or_else(own, |(family, _)| (*family).to_owned());
    Some(if found.is_empty() { model } else { found })
}

/// The author among these who is of the family of a judge.
pub(super) fn kin<'a>(judge: &str, authors: &'a [String]) -> Option<(&'a str, String)> {
    let own = family(judge)?;
    let author = authors.iter().find(|author| family(author).as_deref() == Some(own.as_str()))?;
    Some((author, own))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_family_is_known_by_the_name_of_the_model_wherever_it_is_served() {
        for (name, wanted) in [
            ("openai:gpt-4o-2024-08-06", Some("gpt")),
            ("responses:o3-mini", Some("gpt")),
            ("vllm:Qwen/Qwen2.5-VL-7B-Instruct", Some("qwen")),
            ("ollama:qwen2.5vl:7b", Some("qwen")),
            ("anthropic:claude-opus-4", Some("claude")),
            ("ollama:gemma3:12b", Some("gemini")),
            ("vllm:org/molmo-7b", Some("molmo")),
            ("offline/1", None),
            ("console:ann", None),
            ("solver/1", None),
            ("pinned", None),
            ("cassette:tape", None),
            ("record:my/tape=openai:gpt-4o", Some("gpt")),
            ("replay:a=offline", None),
        ] {
            assert_eq!(family(name).as_deref(), wanted, "{name}");
        }
    }

    #[test]
    fn a_judge_of_the_authors_family_is_found() {
        let authors = ["offline/1".to_owned(), "openai:gpt-4o".to_owned()];
        assert_eq!(kin("responses:o3", &authors), Some(("openai:gpt-4o", "gpt".to_owned())));
        assert_eq!(kin("anthropic:claude-opus-4", &authors), None);
        assert_eq!(kin("openai:gpt-4o", &["offline/1".to_owned()]), None);
    }
}
