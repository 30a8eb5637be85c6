//! From the document to flat arrays: subtrees unfold, names of entries become slots.

use std::collections::BTreeMap;
use std::sync::Arc;

use socrates_model::{Fault, FaultCode};

use crate::blackboard::{Input, Value, read_flag};
use crate::parse::{Document, GUARDS, Meaning, key_in_braces};
use crate::script::Script;
use crate::sheet::{Kind, Library, PortKind, Role};
use crate::tree::{Format, Guards, Node, Step, Tree};
use crate::xml::{Element, short_text};

/// Most nodes of an unfolded tree.
pub(crate) const MAX_NODES: usize = 4096;
/// Deepest nesting of subtrees.
const MAX_SUBTREES: usize = 16;
/// Deepest node of an unfolded tree.
const MAX_UNFOLDED_DEPTH: usize = 256;

/// How a subtree sees names that are not handed over one by one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sight {
    /// Its own.
    Own,
    /// Those of the tree above.
    Above,
}

/// The blackboard of one unfolded tree.
struct Scope {
    known: BTreeMap<String, usize>,
    above: Option<usize>,
    sight: Sight,
}

struct Builder<'a> {
    document: &'a Document,
    nodes: Vec<Node>,
    depths: Vec<usize>,
    board: Vec<Option<Value>>,
    scopes: Vec<Scope>,
    leaves: u16,
    faults: Vec<Fault>,
}

/// Unfolds a document that was read without faults.
pub(crate) fn build(document: Document) -> Result<Tree, Vec<Fault>> {
    let mut builder = Builder {
        document: &document,
        nodes: Vec::new(),
        depths: Vec::new(),
        board: Vec::new(),
        scopes: vec![Scope { known: BTreeMap::new(), above: None, sight: Sight::Own }],
        leaves: 0,
        faults: Vec::new(),
    };
    if let Some(root) = document.tree(&document.main) {
        builder.unfold(root, 0, None, &mut vec![document.main.clone()]);
    }
    let Builder { nodes, board, mut scopes, faults, .. } = builder;
    if !faults.is_empty() {
        return Err(faults);
    }
    let keys = scopes.drain(..).next().map(|scope| scope.known).unwrap_or_default();
    let Flat { steps, kids, inputs, n_words } = flat(&nodes, &document);
    Ok(Tree {
        nodes: nodes.into(),
        steps: steps.into(),
        kids: kids.into(),
        inputs: inputs.into(),
        n_words,
        board: board.into(),
        keys: Arc::new(keys),
        format: document.format,
        document: Arc::new(document),
    })
}

/// What a tick needs of the nodes, side by side.
struct Flat {
    steps: Vec<Step>,
    kids: Vec<u32>,
    inputs: Vec<Input>,
    n_words: usize,
}

fn flat(nodes: &[Node], document: &Document) -> Flat {
    let is_asked = document.meaning == Meaning::World;
    let mut flat = Flat { steps: Vec::with_capacity(nodes.len()), kids: Vec::new(), inputs: Vec::new(), n_words: 0 };
    let small = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    for (place, node) in nodes.iter().enumerate() {
        let word = twin(nodes, place).and_then(|twin| flat.steps.get(twin)).map(|step| step.word);
        flat.steps.push(Step {
            sheet: node.sheet,
            tick: node.sheet.tick,
            halt: node.sheet.halt,
            first_kid: small(flat.kids.len()),
            n_kids: small(node.children.len()),
            first_input: small(flat.inputs.len()),
            n_inputs: small(node.inputs.len()),
            word: word.unwrap_or_else(|| small(flat.n_words)),
            leaf: node.leaf,
            asks_world: is_asked
                && node.leaf > 0
                && node.sheet.library != Library::BuiltIn
                && node.sheet.role.is_cataloged(),
            is_guarded: node.guards.is_some(),
            is_decorator: node.sheet.kind == Kind::Decorator,
        });
        flat.kids.extend(node.children.iter().map(|child| small(*child)));
        flat.inputs.extend(node.inputs.iter().cloned());
        flat.n_words += if word.is_some() { 0 } else { words(node, document.format) };
    }
    flat
}

/// For a `Latch` an earlier one over the same conditions: they remember together. Of two rules that wait for one thing the
/// second is not asked while the first runs, and what came and went meanwhile came for both.
fn twin(nodes: &[Node], latch: usize) -> Option<usize> {
    let is_latch = |node: &&Node| node.sheet.tag == "Latch";
    let conditions = nodes.get(latch).filter(is_latch)?.children.first()?;
    (0..latch).find(|other| {
        let other = nodes.get(*other).filter(is_latch).and_then(|node| node.children.first());
        other.is_some_and(|other| same(nodes, *other, *conditions))
    })
}

/// Whether two nodes and all below them are the same, whatever they are called.
fn same(nodes: &[Node], a: usize, b: usize) -> bool {
    let (Some(one), Some(other)) = (nodes.get(a), nodes.get(b)) else { return false };
    let plain = |node: &Node| node.guards.is_none() && node.script.is_none();
    let below = || one.children.iter().zip(&other.children).all(|(a, b)| same(nodes, *a, *b));
    let alike = one.tag == other.tag && one.inputs == other.inputs && one.children.len() == other.children.len();
    alike && plain(one) && plain(other) && below()
}

/// Words of memory a node needs beside its cell. Version 3 never leaves a child out, so that its sequences count
/// nothing.
fn words(node: &Node, format: Format) -> usize {
    match node.sheet.tag {
        "Sequence" | "Fallback" | "SequenceWithMemory" => usize::from(format == Format::V4),
        "AsyncSequence" | "AsyncFallback" | "Precondition" => 1,
        "Repeat"
        | "RetryUntilSuccessful"
        | "RunOnce"
        | "Latch"
        | "EndStep"
        | "DoesRobotPass"
        | "TimeExpiredCondition" => 1,
        "StopAndWaitTimerAction" => 1,
        "Parallel" | "TimeDelay" | "Delay" | "Timeout" | "Sleep" => 2,
        _ => 0,
    }
}

impl Builder<'_> {
    /// The slot of a name as one scope sees it.
    fn slot(&mut self, scope: usize, key: &str) -> usize {
        let v4 = self.document.format == Format::V4;
        if v4 && let Some(key) = key.strip_prefix('@') {
            // `{@key}` names an entry of the main tree from everywhere.
            return self.slot(0, key);
        }
        let Some(here) = self.scopes.get(scope) else { return usize::MAX };
        if let Some(slot) = here.known.get(key) {
            return *slot;
        }
        let slot = match (here.sight, here.above) {
            // Names that begin with `_` stay private in version 4.
            (Sight::Above, Some(above)) if !(v4 && key.starts_with('_')) => self.slot(above, key),
            (Sight::Own | Sight::Above, _) => self.new_slot(None),
        };
        if let Some(here) = self.scopes.get_mut(scope) {
            here.known.insert(key.to_owned(), slot);
        }
        slot
    }

    fn new_slot(&mut self, value: Option<Value>) -> usize {
        self.board.push(value);
        self.board.len() - 1
    }

    fn unfold(&mut self, it: &Element, scope: usize, parent: Option<usize>, open: &mut Vec<String>) -> Option<usize> {
        if self.nodes.len() >= MAX_NODES {
            if self.faults.is_empty() {
                let message = format!("the subtrees unfold to more than {MAX_NODES} nodes");
                self.faults.push(Fault::new(FaultCode::BMain, it.at(), message));
            }
            return None;
        }
        let depth = parent.and_then(|parent| self.depths.get(parent)).map_or(0, |above| above + 1);
        if depth > MAX_UNFOLDED_DEPTH {
            if self.faults.is_empty() {
                let message = format!("the subtrees unfold deeper than {MAX_UNFOLDED_DEPTH} nodes");
                self.faults.push(Fault::new(FaultCode::BMain, it.at(), message));
            }
            return None;
        }
        let sheet = self.document.sheet(it)?;
        let is_subtree = matches!(it.tag.as_str(), "SubTree" | "SubTreePlus");
        // A subtree is called by its tree; version 4 lets a name go before that.
        let named = match (is_subtree, self.document.format) {
            (true, Format::V3) => it.attr("ID"),
            (true, Format::V4) => it.attr("name").or_else(|| it.attr("ID")),
            (false, _) => it.attr("name"),
        };
        let name = named.map_or_else(|| it.tag.clone(), str::to_owned);
        let inputs = if is_subtree || matches!(sheet.role, Role::Foreign) {
            Vec::new()
        } else {
            sheet.ports.iter().map(|port| self.input(it, port, scope)).collect()
        };
        let code = sheet.ports.iter().find(|port| port.kind == PortKind::Code).and_then(|port| it.attr(port.name));
        let script = code.and_then(|code| self.script(code, scope));
        let guards = self.guards(it, scope);
        let is_leaf = matches!(sheet.kind, Kind::Condition | Kind::Action);
        let leaf = if is_leaf {
            self.leaves += 1;
            self.leaves
        } else {
            0
        };
        let index = self.nodes.len();
        self.depths.push(depth);
        self.nodes.push(Node {
            sheet,
            tag: it.tag.clone(),
            name,
            inputs,
            children: Vec::new(),
            parent,
            leaf,
            guards,
            script,
            attrs: it.attrs.iter().filter(|(name, _)| name != "name").cloned().collect(),
            site: it.site.clone(),
        });
        let children = if is_subtree {
            self.subtree(it, scope, index, open).into_iter().collect()
        } else {
            it.children.iter().filter_map(|child| self.unfold(child, scope, Some(index), open)).collect()
        };
        if let Some(node) = self.nodes.get_mut(index) {
            node.children = children;
        }
        Some(index)
    }

    /// The root of the tree that a subtree node names, in a scope of its own.
    fn subtree(&mut self, it: &Element, scope: usize, index: usize, open: &mut Vec<String>) -> Option<usize> {
        let id = it.attr("ID")?.to_owned();
        if open.contains(&id) || open.len() >= MAX_SUBTREES {
            let message = format!(
                "the tree `{}` contains itself, by way of {}",
                short_text(&id),
                open.iter().map(|id| format!("`{}`", short_text(id))).collect::<Vec<_>>().join(" → ")
            );
            self.faults.push(Fault::new(FaultCode::BMain, it.at(), message));
            return None;
        }
        let document = self.document;
        let root = document.tree(&id)?;
        let inner = self.scope_of(it, scope);
        open.push(id);
        let child = self.unfold(root, inner, Some(index), open);
        open.pop();
        child
    }

    fn scope_of(&mut self, it: &Element, outer: usize) -> usize {
        let v3 = self.document.format == Format::V3;
        let plain_names = v3 && it.tag == "SubTree";
        let shares = match (self.document.format, it.tag.as_str()) {
            (Format::V3, "SubTree") => "__shared_blackboard",
            (Format::V3, _) => "__autoremap",
            (Format::V4, _) => "_autoremap",
        };
        let mut known = BTreeMap::new();
        let mut sight = Sight::Own;
        for (name, value) in &it.attrs {
            if name == shares {
                if read_flag(value) == Some(true) {
                    sight = Sight::Above;
                }
                continue;
            }
            if matches!(name.as_str(), "ID" | "name") || (!plain_names && name.starts_with('_')) {
                continue;
            }
            let slot = if plain_names {
                self.slot(outer, value)
            } else if let Some(key) = key_in_braces(value) {
                self.slot(outer, if key == "=" { name } else { key })
            } else {
                self.new_slot(Some(Value::of_text(value)))
            };
            known.insert(name.to_owned(), slot);
        }
        self.scopes.push(Scope { known, above: Some(outer), sight });
        self.scopes.len() - 1
    }

    fn input(&mut self, it: &Element, port: &crate::sheet::PortSheet, scope: usize) -> Input {
        let name = match self.document.format {
            Format::V3 => port.name,
            Format::V4 => port.v4_name.unwrap_or(port.name),
        };
        let text = it.attr(name).or(port.default).unwrap_or("");
        match (port.kind, key_in_braces(text)) {
            (PortKind::Key | PortKind::Output, Some(key)) => Input::Slot(self.slot(scope, key)),
            (PortKind::Output, None) if text.is_empty() => Input::fixed(""),
            (PortKind::Key | PortKind::Output, None) => Input::Slot(self.slot(scope, text)),
            (PortKind::Code, _) | (_, None) => Input::fixed(text),
            (_, Some(key)) => Input::Slot(self.slot(scope, key)),
        }
    }

    fn script(&mut self, code: &str, scope: usize) -> Option<Script> {
        Script::read(code, &mut |key| self.slot(scope, key)).ok()
    }

    fn guards(&mut self, it: &Element, scope: usize) -> Option<Box<Guards>> {
        if self.document.format == Format::V3 || !it.attrs.iter().any(|(name, _)| GUARDS.contains(&name.as_str())) {
            return None;
        }
        let mut read = |name: &str| it.attr(name).and_then(|code| self.script(code, scope));
        Some(Box::new(Guards {
            failure_if: read("_failureIf"),
            success_if: read("_successIf"),
            skip_if: read("_skipIf"),
            hold_while: read("_while"),
            on_success: read("_onSuccess"),
            on_failure: read("_onFailure"),
            on_halted: read("_onHalted"),
            post: read("_post"),
        }))
    }
}
