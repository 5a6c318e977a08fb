//! Work in an order, by so many hands at a time.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::mpsc::{Sender, channel};

/// Does all items in their order, at most `hands` at a time. `work` is given an item and where to say what it does;
/// `hear` gets what is said, in this thread. Nothing new begins once `ended` holds.
pub fn each<I: Send, S: Send>(
    items: impl IntoIterator<Item = I>,
    hands: usize,
    ended: &(dyn Fn() -> bool + Sync),
    work: &(dyn Fn(I, &Sender<S>) + Sync),
    hear: &mut dyn FnMut(S),
) {
    let items: Mutex<VecDeque<I>> = Mutex::new(items.into_iter().collect());
    let (tell, said) = channel();
    std::thread::scope(|scope| {
        for _ in 0..hands.max(1) {
            let (items, tell) = (&items, tell.clone());
            scope.spawn(move || {
                while !ended() {
                    let next = items.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
                    let Some(item) = next else { break };
                    work(item, &tell);
                }
            });
        }
        drop(tell);
        said.into_iter().for_each(hear);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_done_once_whatever_the_number_of_hands() {
        for hands in [0, 1, 2, 7] {
            let mut heard = Vec::new();
            let work = |item: u32, tell: &Sender<u32>| tell.send(item * item).expect("somebody hears");
            each(0..20, hands, &|| false, &work, &mut |square| heard.push(square));
            heard.sort_unstable();
            assert_eq!(heard, (0..20).map(|n| n * n).collect::<Vec<_>>());
        }
    }

    #[test]
    fn nothing_begins_after_the_end() {
        let mut heard = 0;
        each(
            0..20,
            2,
            &|| true,
            &|item, tell: &Sender<i32>| tell.send(item).expect("somebody hears"),
            &mut |_| heard += 1,
        );
        assert_eq!(heard, 0);
    }
}
