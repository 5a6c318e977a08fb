//! What loses its last user becomes a null entity, and what only it used after it.

use super::Lowering;

impl Lowering<'_> {
    pub(super) fn remove_orphans(&mut self) {
        let mut left = self.draft.left();
        while let Some(number) = left.pop() {
            if !self.draft.is_removed(number) && self.draft.is_orphan(number) {
                left.extend(self.draft.remove(number));
            }
        }
    }
}
