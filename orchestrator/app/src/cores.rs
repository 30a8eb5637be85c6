//! The same work over and over, shared out among a thread per core; what comes back stands in order, whoever did it.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Results that wait to be taken, at most.
const WAITING: usize = 64;

/// Does `one` for each number below `count`, and hands back what came of it in the order of the numbers. `at` is told which
/// number is done, as soon as it is.
pub(crate) fn each<T: Send>(count: usize, one: impl Fn(usize) -> T + Sync, at: &mut dyn FnMut(usize)) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let mut done: Vec<(usize, T)> = Vec::with_capacity(count);
    std::thread::scope(|scope| {
        let (hand_in, handed_in) = mpsc::sync_channel(WAITING);
        for _ in 0..cores.min(count) {
            let (hand_in, one, next) = (hand_in.clone(), &one, &next);
            scope.spawn(move || {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    // Nobody listens any more where the receiver is gone.
                    if number >= count || hand_in.send((number, one(number))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(hand_in);
        for (number, made) in handed_in {
            at(number);
            done.push((number, made));
        }
    });
    done.sort_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, made)| made).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_back_stands_in_order_and_everything_is_done_once() {
        let mut told = Vec::new();
        let squares = each(200, |number| number * number, &mut |number| told.push(number));
        assert_eq!(squares, (0..200).map(|number| number * number).collect::<Vec<_>>());
        told.sort_unstable();
        assert_eq!(told, (0..200).collect::<Vec<_>>());
        assert_eq!(each(0, |number| number, &mut |_| ()), Vec::<usize>::new());
    }
}
