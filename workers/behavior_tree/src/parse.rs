//! From XML to a checked document: main tree, tags, ports, ranges, numbers of children. Every fault at once.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::{Fault, FaultCode};

use crate::blackboard::read_flag;
use crate::hints::{listed, nearest, resolved};
use crate::nodes::{self, FOREIGN_ACTION, FOREIGN_CONDITION};
use crate::script::Script;
use crate::sheet::{Kind, Library, NodeSheet, PortKind, PortSheet};
use crate::tree::Format;
use crate::values::wrong;
use crate::xml::{self, Element, short_text};

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

/// Most faults that are told of a document.
const MAX_FAULTS: usize = 200;
/// Most included files of a document.
const MAX_INCLUDES: usize = 16;

/// Finds an included file by the path as written.
pub type Includes<'a> = &'a dyn Fn(&str) -> Option<String>;

/// Who ticks the leaves of a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Meaning {
    /// This crate, through the senses and deeds of [`World`](crate::World); its `leaf` is never asked. A leaf whose
    /// meaning is not plain there is refused by name.
    #[default]
    Native,
    /// The world, through [`World::leaf`](crate::World::leaf); every leaf of the library is taken.
    World,
}

/// How a document is read.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Name of the document in faults, such as its path; empty for none.
    pub file: &'a str,
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
        Self {
            file: "",
            includes: None,
            library: Library::Native,
            meaning: Meaning::Native,
            foreign: &[],
            declared: false,
        }
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
    pub(crate) meaning: Meaning,
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
        let format = match root.attr("BTCPP_format").map(str::trim) {
            Some(version) if version.starts_with('4') => Format::V4,
            Some(_) | None => Format::V3,
        };
        let foreign = options.foreign.iter().map(|(tag, kind)| ((*tag).to_owned(), *kind)).collect();
        let document = Self {
            format,
            main: String::new(),
            includes: Vec::new(),
            trees: Vec::new(),
            library: options.library,
            meaning: options.meaning,
            foreign,
        };
        let mut reading = Reading {
            document,
            options,
            faults: Vec::new(),
            seen: Vec::new(),
            open: Vec::new(),
            models: BTreeMap::new(),
            ids: BTreeSet::new(),
        };
        reading.root(&root);
        reading.file(&root);
        reading.main(&root);
        let mut trees = std::mem::take(&mut reading.document.trees);
        if format == Format::V4 {
            trees.iter_mut().for_each(|tree| reading.hand_defaults(&mut tree.root));
        }
        for tree in &trees {
            reading.element(&tree.root);
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
    /// Files that were included.
    seen: Vec<String>,
    /// Files that are being read, the outermost first.
    open: Vec<String>,
    /// Ports that a `TreeNodesModel` declares for a tree, with their defaults.
    models: BTreeMap<String, Vec<(String, Option<String>)>>,
    /// Ids of the trees found so far.
    ids: BTreeSet<String>,
}

impl Reading<'_> {
    fn fault(&mut self, code: FaultCode, it: &Element, message: impl Into<String>) {
        if self.faults.len() == MAX_FAULTS {
            let message = format!("there are more faults; only the first {MAX_FAULTS} are told");
            self.faults.push(Fault::new(code, it.at(), message));
        }
        if self.faults.len() > MAX_FAULTS {
            return;
        }
        self.faults.push(Fault::new(code, it.at(), message));
    }

    /// Attributes of the outermost element. Those of editors are passed over, but not a slip in ours.
    fn root(&mut self, root: &Element) {
        const OURS: [&str; 2] = ["main_tree_to_execute", "BTCPP_format"];
        if let Some(version) = root.attr("BTCPP_format")
            && !["3", "4"].iter().any(|known| version.trim().split('.').next() == Some(known))
        {
            let message = format!("BTCPP_format=`{}`; allowed: 3, 4, or no such attribute for 3", short_text(version));
            self.fault(FaultCode::BXml, root, message);
        }
        for (name, _) in root.attrs.iter().filter(|(name, _)| !OURS.contains(&name.as_str())) {
            let like = nearest(name, OURS);
            if !like.is_empty() {
                let message =
                    format!("`root` has no attribute `{}`{like}; allowed: {}", short_text(name), OURS.join(", "));
                self.fault(FaultCode::BXml, root, message);
            }
        }
    }

    /// Includes and trees of one file.
    fn file(&mut self, root: &Element) {
        if root.tag != "root" {
            self.fault(
                FaultCode::BXml,
                root,
                format!("the outermost element is `{}`; allowed: root", short_text(&root.tag)),
            );
        }
        for it in &root.children {
            match it.tag.as_str() {
                "include" => self.include(it),
                "BehaviorTree" => self.tree(it),
                "TreeNodesModel" => self.declarations(it),
                tag => {
                    let tag = short_text(tag);
                    let message =
                        format!("`{tag}` stands outside a tree; allowed: include, BehaviorTree, TreeNodesModel");
                    self.fault(FaultCode::BXml, it, message);
                }
            }
        }
    }

    fn declarations(&mut self, it: &Element) {
        for declared in &it.children {
            let Some(id) = declared.attr("ID") else { continue };
            match declared.tag.as_str() {
                "Condition" if self.options.declared => self.document.foreign.push((id.to_owned(), Kind::Condition)),
                "Action" if self.options.declared => self.document.foreign.push((id.to_owned(), Kind::Action)),
                "SubTree" => {
                    let ports = declared.children.iter().filter(|port| port.tag.ends_with("_port"));
                    let of = |port: &Element| {
                        let default = port.attr("default").filter(|default| !default.is_empty());
                        Some((port.attr("name")?.to_owned(), default.map(str::to_owned)))
                    };
                    self.models.insert(id.to_owned(), ports.filter_map(of).collect());
                }
                _ => {}
            }
        }
    }

    /// Writes the defaults that a model declares for the ports of a subtree into the elements that leave them out, as
    /// version 4 does; a port without one must be given.
    fn hand_defaults(&mut self, it: &mut Element) {
        let ports = if it.tag == "SubTree" { it.attr("ID").and_then(|id| self.models.get(id)).cloned() } else { None };
        let is_autoremapped = it.attr("_autoremap").and_then(read_flag) == Some(true);
        for (name, default) in ports.into_iter().flatten() {
            if is_autoremapped || it.attr(&name).is_some() {
                continue;
            }
            match default {
                Some(default) => it.attrs.push((name, default)),
                None => {
                    let message = format!(
                        "the model of this subtree declares the port `{}` without a default; allowed: {}=\"{{entry}}\", a constant, or _autoremap=\"true\"",
                        short_text(&name),
                        short_text(&name)
                    );
                    self.fault(FaultCode::BPort, it, message);
                }
            }
        }
        for child in &mut it.children {
            self.hand_defaults(child);
        }
    }

    fn include(&mut self, it: &Element) {
        let Some(path) = it.attr("path") else {
            return self.fault(FaultCode::BXml, it, "an include without `path`");
        };
        if it.site.file.is_empty() {
            self.document.includes.push(path.to_owned());
        }
        let path = resolved(&it.site.file, path);
        if self.open.contains(&path) {
            let way = listed(self.open.iter().map(String::as_str));
            let message = format!("the file `{}` includes itself, by way of {way}", short_text(&path));
            return self.fault(FaultCode::BXml, it, message);
        }
        if self.seen.contains(&path) {
            return;
        }
        if self.seen.len() >= MAX_INCLUDES {
            return self.fault(FaultCode::BXml, it, format!("more than {MAX_INCLUDES} included files"));
        }
        self.seen.push(path.clone());
        let given = self.options.includes.and_then(|find| find(&path));
        let built_in = || path.ends_with(REGULAR_NAV_PATH).then(|| REGULAR_NAV.to_owned());
        let Some(text) = given.or_else(built_in) else {
            let known = if self.options.includes.is_some() {
                format!("a path from the folder of the file that names it, or {REGULAR_NAV_PATH}")
            } else {
                REGULAR_NAV_PATH.to_owned()
            };
            let message = format!("the included file `{}` is not there; allowed: {known}", short_text(&path));
            return self.fault(FaultCode::BXml, it, message);
        };
        match xml::read(&path, &text) {
            Ok(root) => {
                let version = root.attr("BTCPP_format").map(str::trim);
                if version.is_some_and(|version| version.starts_with('4')) != (self.document.format == Format::V4)
                    && version.is_some()
                {
                    let message = format!(
                        "the included file is of another version than the document, which is {}",
                        self.document.format.name()
                    );
                    self.fault(FaultCode::BXml, &root, message);
                }
                self.open.push(path);
                self.file(&root);
                self.open.pop();
            }
            Err(fault) => self.faults.push(fault),
        }
    }

    fn tree(&mut self, it: &Element) {
        let id = match it.attr("ID") {
            Some(id) if !id.is_empty() => id.to_owned(),
            Some(_) | None => format!("tree_{}", self.document.trees.len() + 1),
        };
        if !self.ids.insert(id.clone()) {
            let message = format!("a second tree has the ID `{}`; allowed: each ID once", short_text(&id));
            return self.fault(FaultCode::BMain, it, message);
        }
        match it.children.as_slice() {
            [root] => self.document.trees.push(TreeDef { id, root: root.clone().short() }),
            children => {
                let message =
                    format!("the tree `{}` has `{}` children; allowed: exactly 1", short_text(&id), children.len());
                self.fault(FaultCode::BArity, it, message);
            }
        }
    }

    fn main(&mut self, root: &Element) {
        let own: Vec<&TreeDef> = self.document.trees.iter().filter(|tree| tree.root.site.file.is_empty()).collect();
        let main = match (root.attr("main_tree_to_execute"), own.as_slice()) {
            (Some(main), _) if self.ids.contains(main) => main.to_owned(),
            (None, [only]) => only.id.clone(),
            (named, _) => {
                let ids = || self.ids.iter().map(String::as_str);
                let message = match named {
                    Some(main) => format!(
                        "main_tree_to_execute names `{}`{}; trees here: {}",
                        short_text(main),
                        nearest(main, ids()),
                        listed(ids())
                    ),
                    None => format!("main_tree_to_execute is missing; trees here: {}", listed(ids())),
                };
                return self.fault(FaultCode::BMain, root, message);
            }
        };
        self.document.main = main;
    }

    /// One element of a tree and everything below it.
    fn element(&mut self, it: &Element) {
        if self.faults.len() > MAX_FAULTS {
            return;
        }
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
                    self.subtree(it);
                } else if !matches!(sheet.role, crate::sheet::Role::Foreign) {
                    self.ports(it, sheet);
                }
            }
        }
        for child in &it.children {
            self.element(child);
        }
    }

    fn tags(&self) -> String {
        let tags: Vec<&str> = nodes::known_to(self.options.library).iter().map(|sheet| sheet.tag).collect();
        tags.join(", ")
    }

    fn unknown(&mut self, it: &Element) {
        let nearest = nearest(&it.tag, nodes::known_to(self.options.library).iter().map(|sheet| sheet.tag));
        let others: Vec<&str> = Library::ALL
            .into_iter()
            .filter(|library| nodes::is_known_to(&it.tag, *library))
            .map(Library::name)
            .collect();
        let elsewhere =
            if others.is_empty() { String::new() } else { format!("; it is a node of {}", others.join(", ")) };
        let message = format!(
            "there is no node `{}` in {}{elsewhere}{nearest}; allowed: {}",
            short_text(&it.tag),
            self.options.library.name(),
            self.tags()
        );
        self.fault(FaultCode::BNode, it, message);
    }

    fn subtree(&mut self, it: &Element) {
        match it.attr("ID") {
            None => self.fault(FaultCode::BPort, it, "a SubTree needs the attribute ID, the name of a tree"),
            Some(id) if !self.ids.contains(id) => {
                let hint = if id == "RegularNavTree" {
                    format!("; add <include path='{REGULAR_NAV_PATH}'/>")
                } else {
                    String::new()
                };
                let ids = || self.ids.iter().map(String::as_str);
                let like = nearest(id, ids());
                let message =
                    format!("ID=`{}` names no tree{like}{hint}; trees here: {}", short_text(id), listed(ids()));
                self.fault(FaultCode::BPort, it, message);
            }
            Some(_) => {}
        }
        for (name, value) in &it.attrs {
            if GUARDS.contains(&name.as_str()) {
                self.guard(it, name, value);
            } else if value.contains("??") {
                self.fault(
                    FaultCode::BPort,
                    it,
                    format!("{}=`{}` was left open; write the value", short_text(name), short_text(value)),
                );
            }
        }
    }

    fn guard(&mut self, it: &Element, name: &str, value: &str) {
        if self.document.format == Format::V3 {
            let message = format!("the attribute `{name}` belongs to version 4; allowed: only with BTCPP_format=\"4\"");
            return self.fault(FaultCode::BPort, it, message);
        }
        if let Err(error) = Script::read(value, &mut |_| 0) {
            self.fault(FaultCode::BPort, it, format!("{name}=`{}`: {error}", short_text(value)));
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
                let like = nearest(name, expected.iter().copied());
                let message = format!("`{}` has no attribute `{}`{like}; allowed: {listed}", it.tag, short_text(name));
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
                // The fork counts people from 0.
                Some("0")
                    if port.kind == PortKind::Human
                        && self.options.library == Library::SocratesFork
                        && self.options.meaning == Meaning::World => {}
                Some(value) => {
                    if let Some((code, what)) = wrong(port.kind, value) {
                        let message =
                            format!("{name}=`{}` {what}; allowed: {}", short_text(value), port.kind.allowed());
                        self.fault(code, it, message);
                    }
                }
            }
        }
    }
}
