//! What will happen, in order of time; what is due at the same time happens in the order in which it was planned.

use std::collections::BTreeMap;

use socrates_model::job::Stage;
use socrates_orchestrator::Answer;

use crate::worker::Message;

/// Something that will happen. A worker's life is named with it, so that nothing happens to a successor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Happening {
    /// A message reaches the orchestrator.
    Arrives {
        /// Worker.
        from: usize,
        /// Its life.
        life: u32,
        /// Number of its question.
        ask: u64,
        /// What it says.
        message: Message,
    },
    /// An answer reaches a worker.
    Answered {
        /// Worker.
        to: usize,
        /// Its life.
        life: u32,
        /// Number of its question.
        ask: u64,
        /// What it is told.
        answer: Box<Answer>,
    },
    /// Workers of a stage are told that there is work.
    Hinted(Stage),
    /// A question without an answer is sent again.
    Again {
        /// Worker.
        of: usize,
        /// Its life.
        life: u32,
        /// Number of its question.
        ask: u64,
    },
    /// An idle worker asks by itself, unless it has asked since.
    Polls {
        /// Worker.
        of: usize,
        /// Its life.
        life: u32,
        /// Questions it had sent by then.
        asked: u64,
    },
    /// A worker has done the work with this fence.
    Done {
        /// Worker.
        of: usize,
        /// Its life.
        life: u32,
        /// Fence of the attempt.
        fence: u64,
    },
    /// A worker dies over the work with this fence.
    Dies {
        /// Worker.
        of: usize,
        /// Its life.
        life: u32,
        /// Fence of the attempt.
        fence: u64,
    },
    /// A worker beats.
    Beats {
        /// Worker.
        of: usize,
        /// Its life.
        life: u32,
    },
    /// A worker starts.
    Starts(usize),
    /// The loss of a dead worker's token is seen.
    Gone(String),
    /// A timer of the orchestrator is due.
    Ticks,
    /// A dead orchestrator has a successor.
    Rises,
}

/// All of it.
#[derive(Debug, Default)]
pub(crate) struct Heap {
    planned: BTreeMap<(u64, u64), Happening>,
    count: u64,
}

impl Heap {
    /// Plans something for a time.
    pub(crate) fn plan(&mut self, at: u64, what: Happening) {
        self.count += 1;
        self.planned.insert((at, self.count), what);
    }

    /// What happens next, and when.
    pub(crate) fn next(&mut self) -> Option<(u64, Happening)> {
        self.planned.pop_first().map(|((at, _), what)| (at, what))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_due_together_happens_as_it_was_planned() {
        let mut heap = Heap::default();
        for (at, worker) in [(5, 0), (3, 1), (5, 2), (3, 3)] {
            heap.plan(at, Happening::Starts(worker));
        }
        let order: Vec<_> = std::iter::from_fn(|| heap.next()).collect();
        assert_eq!(order, [(3, 1), (3, 3), (5, 0), (5, 2)].map(|(at, worker)| (at, Happening::Starts(worker))));
    }
}
