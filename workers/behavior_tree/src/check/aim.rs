//! Cases that lead to a node: what must hold so that a tick comes there, and what makes it succeed or fail.
//!
//! A tree of many conditions has too many cases to tick them all, and cases drawn at random rarely come to the last
//! branches. So one case is worked out for each node and each outcome of it, by what its parents ask of the nodes
//! before it. A parent whose rule is not known here asks nothing; its cases are left to the sample.

use crate::check::atoms::{Atom, excludes_atom, forces};
use crate::sheet::Role;
use crate::tree::{Node, Tree};

/// For every node the case in which a tick comes to it, and those in which it succeeds and fails; what no case needs
/// is false.
pub(super) fn aimed(tree: &Tree, atoms: &[Atom]) -> Vec<Vec<bool>> {
    let mut found = Vec::new();
    for node in 0..tree.nodes.len() {
        for outcome in [None, Some(true), Some(false)] {
            let start = Partial { tree, atoms, truth: vec![None; atoms.len()] };
            let inside = match outcome {
                Some(outcome) => start.ends(node, outcome),
                None => Some(start),
            };
            if let Some(case) = inside.and_then(|case| case.come_to(node)) {
                found.push(case.truth.iter().map(|holds| holds.unwrap_or(false)).collect());
            }
        }
    }
    found
}

/// Truths that are settled so far; `None` where nothing has been asked of an atom.
#[derive(Clone)]
struct Partial<'a> {
    tree: &'a Tree,
    atoms: &'a [Atom],
    truth: Vec<Option<bool>>,
}

impl<'a> Partial<'a> {
    fn node(&self, node: usize) -> Option<&'a Node> {
        self.tree.nodes.get(node)
    }

    /// Settles one atom and what follows from it; `None` where that contradicts what is settled.
    fn settle(mut self, atom: &Atom, holds: bool) -> Option<Self> {
        let Some(place) = self.atoms.iter().position(|other| other == atom) else { return Some(self) };
        match self.truth.get_mut(place)? {
            Some(before) => return (*before == holds).then_some(self),
            slot @ None => *slot = Some(holds),
        }
        let atoms = self.atoms;
        atoms.iter().filter(|other| *other != atom).try_fold(self, |case, other| {
            if holds && forces(atom, other) {
                case.settle(other, true)
            } else if (holds && excludes_atom(atom, other)) || (!holds && forces(other, atom)) {
                case.settle(other, false)
            } else {
                Some(case)
            }
        })
    }

    /// What must hold so that a tick of the whole tree comes to a node.
    fn come_to(self, node: usize) -> Option<Self> {
        let Some(parent) = self.node(node)?.parent else { return Some(self) };
        let above = self.node(parent)?;
        let before = above.children.iter().copied().take_while(|child| *child != node);
        let case = match passes_on(above) {
            Some(Gate::All) => before.into_iter().try_fold(self, |case, child| case.ends(child, true)),
            Some(Gate::Any) => before.into_iter().try_fold(self, |case, child| case.ends(child, false)),
            Some(Gate::Once) => self.settle(&Atom::Memory(parent), false),
            Some(Gate::Same | Gate::Opposite | Gate::Always(_)) | None => Some(self),
        }?;
        case.come_to(parent)
    }

    /// What makes a node end so.
    fn ends(self, node: usize, succeeds: bool) -> Option<Self> {
        let it = self.node(node)?;
        let children = it.children.as_slice();
        let child = children.first().copied();
        match (passes_on(it), child) {
            (Some(Gate::All), _) => self.all_or_one(children, true, succeeds),
            (Some(Gate::Any), _) => self.all_or_one(children, false, succeeds),
            (Some(Gate::Opposite), Some(child)) => self.ends(child, !succeeds),
            (Some(Gate::Same), Some(child)) => self.ends(child, succeeds),
            (Some(Gate::Always(always)), _) => (always == succeeds).then_some(self),
            (Some(Gate::Once), Some(child)) => {
                let remembered = Atom::Memory(node);
                if succeeds {
                    self.settle(&remembered, true)
                } else {
                    self.settle(&remembered, false)?.ends(child, false)
                }
            }
            (Some(Gate::Opposite | Gate::Same | Gate::Once), None) => None,
            (None, _) => self.leaf(node, it, succeeds),
        }
    }

    /// A leaf, or a parent of which nothing is known.
    fn leaf(self, node: usize, it: &Node, succeeds: bool) -> Option<Self> {
        match it.sheet.role {
            Role::Asks(means) => match Atom::asked(it, means(&self.tree.ports(it))) {
                Some((atom, holds)) => self.settle(&atom, holds == succeeds),
                None => Some(self),
            },
            Role::Timer => match self.tree.ports(it).real(0) {
                Some(secs) => self.settle(&Atom::Timer(node, secs), succeeds),
                None => Some(self),
            },
            Role::World | Role::Foreign => {
                let answer = Atom::Answer(it.leaf);
                self.settle(&answer, succeeds)
            }
            Role::Flow | Role::Moves(_) | Role::Says | Role::Quiet => Some(self),
        }
    }

    /// The whole row ends as `all`, or its first child that can end otherwise does.
    fn all_or_one(self, children: &[usize], all: bool, succeeds: bool) -> Option<Self> {
        if all == succeeds {
            return children.iter().try_fold(self, |case, child| case.ends(*child, all));
        }
        let mut before = self;
        for child in children {
            if let Some(ended) = before.clone().ends(*child, !all) {
                return Some(ended);
            }
            before = before.ends(*child, all)?;
        }
        None
    }
}

/// How a parent's end hangs on those of its children.
enum Gate {
    /// It succeeds where all do, in order.
    All,
    /// It succeeds where one does, in order.
    Any,
    /// It ends as its child does.
    Same,
    /// It ends as its child does not.
    Opposite,
    /// It always ends so.
    Always(bool),
    /// It ends as its child does until that has succeeded once.
    Once,
}

fn passes_on(node: &Node) -> Option<Gate> {
    Some(match node.sheet.tag {
        "Sequence" | "ReactiveSequence" | "SequenceWithMemory" | "AsyncSequence" => Gate::All,
        "Fallback" | "ReactiveFallback" | "AsyncFallback" => Gate::Any,
        "Inverter" => Gate::Opposite,
        "ForceSuccess" => Gate::Always(true),
        "ForceFailure" => Gate::Always(false),
        "Latch" | "EndStep" | "RunOnce" => Gate::Once,
        "SubTree" | "SubTreePlus" => Gate::Same,
        _ => return None,
    })
}
