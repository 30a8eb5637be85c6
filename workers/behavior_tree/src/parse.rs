//! From XML to a checked document: main tree, tags, ports, ranges, numbers of children. Every fault at once.

use socrates_model::{Fault, FaultCode, Gesture};

use crate::blackboard::read_flag;
use crate::nodes::{self, FOREIGN_ACTION, FOREIGN_CONDITION};
use crate::script::Script;
use crate::sheet::{Kind, Library, NodeSheet, PortKind, PortSheet};
use crate::tree::Format;
use crate::xml::{self, Element};

/// Path of the include that is always there.
pub const REGULAR_NAV_PATH: &str = "BTRegularNav.xml";

/// The tree that walks a human along its path, as an include of that path.
pub const REGULAR_NAV: &str = r#"<root main_tree_to_execute="RegularNavTree">
  <BehaviorTree ID="RegularNavTree">
    <Fallback name="RegularNavFallback">
      <Sequence name="RegularNavigation">
        <Inverter>
          <IsGoalReached agent_id="{id}"/>
        </Inverter>
        <RegularNav agent_id="{id}" time_step="{dt}"/>
      </Sequence>
      <UpdateGoal agent_id="{id}"/>
    </Fallback>
  </BehaviorTree>
</root>
"#;

/// Attributes of version 4 that any node may have.
pub(crate) const GUARDS: [&str; 8] =
    ["_failureIf", "_successIf", "_skipIf", "_while", "_onSuccess", "_onFailure", "_onHalted", "_post"];

/// Most included files of a document.
const MAX_INCLUDES: usize = 16;

/// Finds an included file by the path as written.
pub type Includes<'a> = &'a dyn Fn(&str) -> Option<String>;

/// Who ticks the leaves of a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Meaning {
    /// This crate, through the senses and deeds of [`World`](crate::World). A leaf whose meaning is not plain there
    /// is refused by name.
    #[default]
    Native,
    /// The world, through [`World::leaf`](crate::World::leaf); every leaf of the library is taken.
    World,
}

/// How a document is read.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Finds included files by the path as written; `BTRegularNav.xml` is found without it.
    pub includes: Option<Includes<'a>>,
    /// Whose nodes are taken, with their ports, defaults and ranges. Default: [`Library::Native`], the SocRATES fork
    /// and our own.
    pub library: Library,
    /// Who ticks the leaves. Default: [`Meaning::Native`].
    pub meaning: Meaning,
    /// Leaves of other libraries by tag, ticked through [`World::foreign`](crate::World::foreign).
    pub foreign: &'a [(&'a str, Kind)],
    /// Whether leaves that the document declares in its `TreeNodesModel` are taken as foreign too.
    pub declared: bool,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self { includes: None, library: Library::Native, meaning: Meaning::Native, foreign: &[], declared: false }
    }
}

/// One tree of a document.
#[derive(Debug, Clone)]
pub(crate) struct TreeDef {
    pub(crate) id: String,
    pub(crate) root: Element,
}

/// A document without faults.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    pub(crate) format: Format,
    pub(crate) main: String,
    pub(crate) includes: Vec<String>,
    pub(crate) trees: Vec<TreeDef>,
    library: Library,
    foreign: Vec<(String, Kind)>,
}

/// The key of `{key}`.
pub(crate) fn key_in_braces(text: &str) -> Option<&str> {
    text.trim().strip_prefix('{')?.strip_suffix('}')
}

impl Document {
    /// The tree of an id.
    pub(crate) fn tree(&self, id: &str) -> Option<&Element> {
        self.trees.iter().find(|tree| tree.id == id).map(|tree| &tree.root)
    }

    /// The sheet of an element.
    pub(crate) fn sheet(&self, it: &Element) -> Option<&'static NodeSheet> {
        nodes::sheet_in(&it.tag, self.library).or_else(|| {
            let (_, kind) = self.foreign.iter().find(|(tag, _)| *tag == it.tag)?;
            Some(if *kind == Kind::Condition { &FOREIGN_CONDITION } else { &FOREIGN_ACTION })
        })
    }

    /// Reads and checks a document with its includes.
    pub(crate) fn read(text: &str, options: &Options<'_>) -> Result<Self, Vec<Fault>> {
        let root = xml::read("", text).map_err(|fault| vec![fault])?;
        let format = match root.attr("BTCPP_format") {
            Some(version) if version.trim().starts_with('4') => Format::V4,
            Some(_) | None => Format::V3,
        };
        let foreign = options.foreign.iter().map(|(tag, kind)| ((*tag).to_owned(), *kind)).collect();
        let document = Self {
            format,
            main: String::new(),
            includes: Vec::new(),
            trees: Vec::new(),
            library: options.library,
            foreign,
        };
        let mut reading = Reading { document, options, faults: Vec::new(), seen: Vec::new() };
        reading.file(&root);
        reading.main(&root);
        let trees = std::mem::take(&mut reading.document.trees);
        let ids: Vec<&str> = trees.iter().map(|tree| tree.id.as_str()).collect();
        for tree in &trees {
            reading.element(&tree.root, &ids);
        }
        let Reading { mut document, faults, .. } = reading;
        document.trees = trees;
        if faults.is_empty() { Ok(document) } else { Err(faults) }
    }
}

struct Reading<'a> {
    document: Document,
    options: &'a Options<'a>,
    faults: Vec<Fault>,
    seen: Vec<String>,
}

impl Reading<'_> {
    fn fault(&mut self, code: FaultCode, it: &Element, message: impl Into<String>) {
        self.faults.push(Fault::new(code, it.at(), message));
    }

    /// Includes and trees of one file.
    fn file(&mut self, root: &Element) {
        if root.tag != "root" {
            self.fault(FaultCode::BXml, root, format!("the outermost element is `{}`; allowed: root", root.tag));
        }
        for it in &root.children {
            match it.tag.as_str() {
                "include" => self.include(it),
                "BehaviorTree" => self.tree(it),
                "TreeNodesModel" => self.declarations(it),
                tag => {
                    let message =
                        format!("`{tag}` stands outside a tree; allowed: include, BehaviorTree, TreeNodesModel");
                    self.fault(FaultCode::BXml, it, message);
                }
            }
        }
    }

    fn declarations(&mut self, it: &Element) {
        if !self.options.declared {
            return;
        }
        for declared in &it.children {
            let kind = match declared.tag.as_str() {
                "Condition" => Kind::Condition,
                "Action" => Kind::Action,
                _ => continue,
            };
            if let Some(id) = declared.attr("ID") {
                self.document.foreign.push((id.to_owned(), kind));
            }
        }
    }

    fn include(&mut self, it: &Element) {
        let Some(path) = it.attr("path") else {
            return self.fault(FaultCode::BXml, it, "an include without `path`");
        };
        if it.site.file.is_empty() {
            self.document.includes.push(path.to_owned());
        }
        if self.seen.iter().any(|seen| seen == path) {
            return;
        }
        if self.seen.len() >= MAX_INCLUDES {
            return self.fault(FaultCode::BXml, it, format!("more than {MAX_INCLUDES} included files"));
        }
        self.seen.push(path.to_owned());
        let given = self.options.includes.and_then(|find| find(path));
        let built_in = || path.ends_with(REGULAR_NAV_PATH).then(|| REGULAR_NAV.to_owned());
        let Some(text) = given.or_else(built_in) else {
            let message = format!("the included file `{path}` is not there; allowed: {REGULAR_NAV_PATH}");
            return self.fault(FaultCode::BXml, it, message);
        };
        match xml::read(path, &text) {
            Ok(root) => self.file(&root),
            Err(fault) => self.faults.push(fault),
        }
    }

    fn tree(&mut self, it: &Element) {
        let id = match it.attr("ID") {
            Some(id) if !id.is_empty() => id.to_owned(),
            Some(_) | None => format!("tree_{}", self.document.trees.len() + 1),
        };
        if self.document.trees.iter().any(|tree| tree.id == id) {
            return self.fault(FaultCode::BMain, it, format!("a second tree has the ID `{id}`; allowed: each ID once"));
        }
        match it.children.as_slice() {
            [root] => self.document.trees.push(TreeDef { id, root: root.clone().short() }),
            children => {
                let message = format!("the tree `{id}` has `{}` children; allowed: exactly 1", children.len());
                self.fault(FaultCode::BArity, it, message);
            }
        }
    }

    fn main(&mut self, root: &Element) {
        let ids: Vec<String> = self.document.trees.iter().map(|tree| tree.id.clone()).collect();
        let own: Vec<&TreeDef> = self.document.trees.iter().filter(|tree| tree.root.site.file.is_empty()).collect();
        let listed = if ids.is_empty() { "none".to_owned() } else { ids.join(", ") };
        self.document.main = match (root.attr("main_tree_to_execute"), own.as_slice()) {
            (Some(main), _) if ids.iter().any(|id| id == main) => main.to_owned(),
            (Some(main), _) => {
                let message = format!("main_tree_to_execute names `{main}`; trees here: {listed}");
                return self.fault(FaultCode::BMain, root, message);
            }
            (None, [only]) => only.id.clone(),
            (None, _) => {
                let message = format!("main_tree_to_execute is missing; trees here: {listed}");
                return self.fault(FaultCode::BMain, root, message);
            }
        };
    }

    /// One element of a tree and everything below it.
    fn element(&mut self, it: &Element, ids: &[&str]) {
        match self.document.sheet(it) {
            None => self.unknown(it),
            Some(sheet) if self.options.meaning == Meaning::Native && !sheet.is_native() => {
                let native: Vec<&str> = nodes::known_to(self.options.library)
                    .iter()
                    .filter(|other| other.library == sheet.library && other.is_native())
                    .map(|other| other.tag)
                    .collect();
                let message = format!(
                    "`{}` of {} has no native meaning and runs in its own profile only; allowed in a native run: {}",
                    it.tag,
                    sheet.library.name(),
                    native.join(", ")
                );
                self.fault(FaultCode::BNode, it, message);
            }
            Some(sheet) if sheet.only_in().is_some_and(|format| format != self.document.format) => {
                let instead = if sheet.tag == "SubTreePlus" {
                    "SubTree, which hands over {entries} there"
                } else {
                    "only with BTCPP_format=\"4\""
                };
                let message = format!("{} has no node `{}`; allowed: {instead}", self.document.format.name(), it.tag);
                self.fault(FaultCode::BNode, it, message);
            }
            Some(sheet) => {
                let n = it.children.len();
                let arity = sheet.arity_in(self.document.format);
                if n < arity.least || n > arity.most {
                    let message = format!("`{}` has `{n}` children; allowed: {}", it.tag, arity.allowed());
                    self.fault(FaultCode::BArity, it, message);
                }
                if matches!(it.tag.as_str(), "SubTree" | "SubTreePlus") {
                    self.subtree(it, ids);
                } else if !matches!(sheet.role, crate::sheet::Role::Foreign) {
                    self.ports(it, sheet);
                }
            }
        }
        for child in &it.children {
            self.element(child, ids);
        }
    }

    fn tags(&self) -> String {
        let tags: Vec<&str> = nodes::known_to(self.options.library).iter().map(|sheet| sheet.tag).collect();
        tags.join(", ")
    }

    fn unknown(&mut self, it: &Element) {
        let nearest = nodes::known_to(self.options.library)
            .into_iter()
            .map(|sheet| (strsim::levenshtein(&sheet.tag.to_lowercase(), &it.tag.to_lowercase()), sheet.tag))
            .min()
            .filter(|(distance, _)| *distance <= 6)
            .map_or_else(String::new, |(_, tag)| format!("; nearest: {tag}"));
        let others: Vec<&str> = Library::ALL
            .into_iter()
            .filter(|library| nodes::is_known_to(&it.tag, *library))
            .map(Library::name)
            .collect();
        let elsewhere =
            if others.is_empty() { String::new() } else { format!("; it is a node of {}", others.join(", ")) };
        let message = format!(
            "there is no node `{}` in {}{elsewhere}{nearest}; allowed: {}",
            it.tag,
            self.options.library.name(),
            self.tags()
        );
        self.fault(FaultCode::BNode, it, message);
    }

    fn subtree(&mut self, it: &Element, ids: &[&str]) {
        match it.attr("ID") {
            None => self.fault(FaultCode::BPort, it, "a SubTree needs the attribute ID, the name of a tree"),
            Some(id) if !ids.contains(&id) => {
                let hint = if id == "RegularNavTree" {
                    format!("; add <include path='{REGULAR_NAV_PATH}'/>")
                } else {
                    String::new()
                };
                let message = format!("ID=`{id}` names no tree{hint}; trees here: {}", ids.join(", "));
                self.fault(FaultCode::BPort, it, message);
            }
            Some(_) => {}
        }
        for (name, value) in &it.attrs {
            if GUARDS.contains(&name.as_str()) {
                self.guard(it, name, value);
            } else if value.contains("??") {
                self.fault(FaultCode::BPort, it, format!("{name}=`{value}` was left open; write the value"));
            }
        }
    }

    fn guard(&mut self, it: &Element, name: &str, value: &str) {
        if self.document.format == Format::V3 {
            let message = format!("the attribute `{name}` belongs to version 4; allowed: only with BTCPP_format=\"4\"");
            return self.fault(FaultCode::BPort, it, message);
        }
        if let Err(error) = Script::read(value, &mut |_| 0) {
            self.fault(FaultCode::BPort, it, format!("{name}=`{value}`: {error}"));
        }
    }

    fn ports(&mut self, it: &Element, sheet: &'static NodeSheet) {
        let format = self.document.format;
        let name_of = |port: &PortSheet| match format {
            Format::V3 => port.name,
            Format::V4 => port.v4_name.unwrap_or(port.name),
        };
        let expected: Vec<&str> = sheet.ports.iter().map(name_of).collect();
        let listed = if expected.is_empty() { "none".to_owned() } else { expected.join(", ") };
        for (name, value) in &it.attrs {
            if GUARDS.contains(&name.as_str()) {
                self.guard(it, name, value);
            } else if !matches!(name.as_str(), "name" | "_uid" | "_description") && !expected.contains(&name.as_str()) {
                let message = format!("`{}` has no attribute `{name}`; allowed: {listed}", it.tag);
                self.fault(FaultCode::BPort, it, message);
            }
        }
        for port in sheet.ports {
            let name = name_of(port);
            match it.attr(name) {
                None if port.default.is_none() => {
                    let message = format!("`{}` lacks `{name}`: {}; expected: {listed}", it.tag, port.kind.allowed());
                    self.fault(FaultCode::BPort, it, message);
                }
                None => {}
                Some(value) => {
                    if let Some((code, what)) = wrong(port.kind, value) {
                        let message = format!("{name}=`{value}` {what}; allowed: {}", port.kind.allowed());
                        self.fault(code, it, message);
                    }
                }
            }
        }
    }
}

/// What is wrong with the value of a port.
fn wrong(kind: PortKind, value: &str) -> Option<(FaultCode, &'static str)> {
    let port = |what| Some((FaultCode::BPort, what));
    let range = |what| Some((FaultCode::BRange, what));
    if value.contains("??") {
        return port("was left open");
    }
    if let Some(key) = key_in_braces(value) {
        return match (kind == PortKind::Own, kind == PortKind::Code) {
            (true, _) if key == "id" => None,
            (true, _) => port("is not this human"),
            (false, true) => port("is not a script"),
            (false, false) if key.is_empty() => port("names no entry"),
            (false, false) => None,
        };
    }
    let number: Option<f64> = value.trim().parse().ok().filter(|number: &f64| number.is_finite());
    match (kind, number) {
        (PortKind::Own, _) => port("is not this human"),
        (PortKind::Text | PortKind::Output, _) => None,
        (PortKind::Agents, _) => {
            let all_ids = value.split(',').all(|id| id.trim().parse::<u32>().is_ok());
            if all_ids { None } else { port("is not a list of ids") }
        }
        (PortKind::Key, _) if value.trim().is_empty() || value.contains(['{', '}']) => port("names no entry"),
        (PortKind::Key, _) => None,
        (PortKind::Code, _) => match Script::read(value, &mut |_| 0) {
            Ok(_) => None,
            Err(_) => port("is not a script"),
        },
        (PortKind::Flag, _) => {
            if read_flag(value).is_some() {
                None
            } else {
                port("is neither true nor false")
            }
        }
        (PortKind::Gesture, None) if value.parse::<Gesture>().is_ok() => {
            Some((FaultCode::BCode, "is a name where a code must stand"))
        }
        (_, None) => port("is not a number"),
        (PortKind::Number, Some(_)) => None,
        (PortKind::Agent, Some(_)) => whole(value, |number| number >= 0),
        (PortKind::Distance | PortKind::Span | PortKind::Speed, Some(number)) => {
            if number >= 0.0 {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Angle, Some(angle)) => {
            if (0.0..=std::f64::consts::TAU).contains(&angle) {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Share, Some(share)) => {
            if (0.0..=1.0).contains(&share) {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Meters, Some(m)) => {
            if (0.3..=15.0).contains(&m) {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Step, Some(s)) => {
            if s > 0.0 && s <= 1.0 {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Seconds, Some(s)) => {
            if s > 0.0 && s <= 3600.0 {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Gesture, Some(_)) => {
            whole(value, |code| u8::try_from(code).is_ok_and(|code| Gesture::from_code(code).is_some()))
        }
        (PortKind::Human, Some(_)) => whole(value, |number| number >= 1),
        (PortKind::Count(least), Some(_)) => whole(value, |number| number >= least),
    }
}

/// What is wrong with a whole number.
fn whole(value: &str, fits: impl Fn(i64) -> bool) -> Option<(FaultCode, &'static str)> {
    match value.trim().parse::<i64>() {
        Ok(number) if fits(number) => None,
        Ok(_) => Some((FaultCode::BRange, "is out of range")),
        Err(_) => Some((FaultCode::BPort, "is not a whole number")),
    }
}
