//! What can be so or not, and which of these truths the world allows together.

use socrates_model::Trigger;
use socrates_model::seeds::SplitMix64;

use crate::check::aim::aimed;
use crate::sheet::Role;
use crate::tree::{Node, Tree};

/// Most conditions for which every case is ticked.
pub(super) const MAX_EXACT: usize = 12;
/// Cases of the sample beyond that.
const SAMPLE: u64 = 4096;

/// One thing that can be so or not.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Atom {
    /// A condition, in words of the model. `RobotStopped` is asked as `RobotMoving`.
    World(Trigger),
    /// This human is at the present goal of its path; so it is at the end of it.
    GoalHere,
    /// A timer has run out: place of its node and its seconds.
    Timer(usize, f64),
    /// A latch holds, a `RunOnce` has run: place of its node.
    Memory(usize),
    /// A leaf that only its world can tick succeeds: number of the leaf.
    Answer(u16),
}

impl Atom {
    /// What a condition asks, and whether it succeeds where that holds; nothing where its ports name nothing.
    pub(super) fn asked(node: &Node, means: Option<Trigger>) -> Option<(Self, bool)> {
        if node.sheet.tag == "IsGoalReached" {
            return Some((Self::GoalHere, true));
        }
        means.map(|trigger| {
            if trigger == Trigger::RobotStopped {
                (Self::World(Trigger::RobotMoving), false)
            } else {
                (Self::World(trigger), true)
            }
        })
    }

    /// Whether it is about the tree's own past.
    pub(super) const fn is_memory(&self) -> bool {
        matches!(self, Self::Timer(..) | Self::Memory(_))
    }

    /// In words.
    pub(super) fn phrase(&self, tree: &Tree, holds: bool) -> String {
        match (self, holds) {
            (Self::GoalHere, _) => format!("{} at a goal of their path", if holds { "while" } else { "while not" }),
            (Self::World(trigger), true) => trigger.phrase(),
            (Self::World(trigger), false) => format!("not {}", trigger.phrase()),
            (Self::Timer(_, secs), true) => format!("after the timer of {secs} s"),
            (Self::Timer(_, secs), false) => format!("before the timer of {secs} s has run out"),
            (Self::Answer(leaf), _) => {
                let name = tree.leaf_names().get(usize::from(*leaf).wrapping_sub(1)).copied().unwrap_or("");
                format!("when `{name}` {}", if holds { "succeeds" } else { "fails" })
            }
            (Self::Memory(node), _) => {
                let name = tree.nodes.get(*node).map_or("", |node| node.name.as_str());
                format!("{} `{name}` is set", if holds { "once" } else { "before" })
            }
        }
    }
}

/// What a tree asks, in pre-order, each once.
pub(super) fn atoms(tree: &Tree) -> Vec<Atom> {
    let mut atoms: Vec<Atom> = Vec::new();
    for (index, node) in tree.nodes.iter().enumerate() {
        let ports = tree.ports(node);
        let atom = match node.sheet.role {
            Role::Asks(means) => Atom::asked(node, means(&ports)).map(|(atom, _)| atom),
            Role::Timer => ports.real(0).map(|secs| Atom::Timer(index, secs)),
            Role::Flow if matches!(node.sheet.tag, "Latch" | "RunOnce" | "EndStep") => Some(Atom::Memory(index)),
            Role::World | Role::Foreign => Some(Atom::Answer(node.leaf)),
            Role::Flow | Role::Moves(_) | Role::Says | Role::Quiet => None,
        };
        if let Some(atom) = atom
            && !atoms.contains(&atom)
        {
            atoms.push(atom);
        }
    }
    atoms
}

/// Whether the first truth forces the second.
fn implies(a: &Trigger, b: &Trigger) -> bool {
    use Trigger::{AfterSecs, Did, RobotBlocking, RobotNear, RobotVisible, StoppedFor};
    match (a, b) {
        (RobotVisible(near), RobotVisible(far) | RobotNear(far))
        | (RobotNear(near), RobotNear(far))
        | (RobotBlocking(near), RobotBlocking(far) | RobotVisible(far) | RobotNear(far)) => near <= far,
        (AfterSecs(late), AfterSecs(early)) | (StoppedFor(late), StoppedFor(early)) => late >= early,
        (Did(who, later), Did(whom, step)) => who == whom && later >= step,
        _ => false,
    }
}

/// Whether both cannot be true at once.
fn excludes(a: &Trigger, b: &Trigger) -> bool {
    match (a, b) {
        (Trigger::RobotSays(one), Trigger::RobotSays(other)) => one != other,
        (Trigger::HumanSays(who, one), Trigger::HumanSays(whom, other)) => who == whom && one != other,
        // Standing is asked as moving.
        (Trigger::StoppedFor(_), Trigger::RobotMoving) | (Trigger::RobotMoving, Trigger::StoppedFor(_)) => true,
        _ => false,
    }
}

/// Whether the world allows these truths.
fn is_possible(atoms: &[Atom], truth: &[bool]) -> bool {
    let world = || {
        atoms.iter().zip(truth).filter_map(|(atom, holds)| match atom {
            Atom::World(trigger) => Some((trigger, *holds)),
            Atom::Timer(..) | Atom::Memory(_) | Atom::GoalHere | Atom::Answer(_) => None,
        })
    };
    world()
        .filter(|(_, holds)| *holds)
        .all(|(a, _)| world().all(|(b, holds)| if holds { a == b || !excludes(a, b) } else { !implies(a, b) }))
}

/// The cases to tick: all that are possible, or a fixed sample of them.
pub(super) fn truths(tree: &Tree, atoms: &[Atom]) -> Vec<Vec<bool>> {
    let n = atoms.len();
    if n <= MAX_EXACT {
        return (0..1_u64 << n).map(|bits| unpack(bits, n)).filter(|truth| is_possible(atoms, truth)).collect();
    }
    let mut sample = aimed(tree, atoms);
    sample.push(vec![false; n]);
    // A fixed sequence, so that the same tree gets the same cases.
    let mut random = SplitMix64::new(0x5eed);
    for _ in 0..SAMPLE {
        let truth = (0..n).map(|_| random.next_u64().is_multiple_of(3)).collect();
        sample.push(truth);
    }
    let mut closed: Vec<Vec<bool>> =
        sample.into_iter().map(|truth| close(atoms, truth)).filter(|truth| is_possible(atoms, truth)).collect();
    closed.sort_unstable();
    closed.dedup();
    closed
}

fn unpack(bits: u64, n: usize) -> Vec<bool> {
    (0..n).map(|place| bits >> place & 1 == 1).collect()
}

/// Adds what the truths force.
fn close(atoms: &[Atom], mut truth: Vec<bool>) -> Vec<bool> {
    let forced: Vec<bool> = atoms
        .iter()
        .zip(&truth)
        .map(|(atom, holds)| {
            *holds || atoms.iter().zip(&truth).any(|(other, other_holds)| *other_holds && forces(other, atom))
        })
        .collect();
    truth.clone_from(&forced);
    truth
}

/// Whether the first atom's truth forces the second's.
pub(super) fn forces(a: &Atom, b: &Atom) -> bool {
    match (a, b) {
        (Atom::World(Trigger::GoalReached), Atom::GoalHere) => true,
        (Atom::World(a), Atom::World(b)) => implies(a, b),
        _ => false,
    }
}

/// Whether both atoms cannot hold at once.
pub(super) fn excludes_atom(a: &Atom, b: &Atom) -> bool {
    matches!((a, b), (Atom::World(a), Atom::World(b)) if excludes(a, b))
}
