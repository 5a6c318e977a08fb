//! Patches: edits change their own bytes and no others, whatever their order.

use proptest::prelude::*;
use resurf::exchange::{Edit, Patch, PatchError};
use resurf::source::Span;

/// Disjoint edits of a text of 60 bytes, in any order, and the text that they must give, made piece by piece.
fn edits() -> impl Strategy<Value = (Vec<u8>, Vec<Edit>, Vec<u8>)> {
    let piece = (0_u32..5, 0_u32..4, prop::collection::vec(any::<u8>(), 0..6));
    (prop::collection::vec(piece, 0..8), any::<u64>()).prop_map(|(pieces, seed)| {
        let (mut file, mut edits, mut expected) = (Vec::new(), Vec::new(), Vec::new());
        for (index, (keep, drop, text)) in (0_u8..).zip(pieces) {
            let kept = vec![index; keep as usize + 1];
            file.extend_from_slice(&kept);
            expected.extend_from_slice(&kept);
            let start = u32::try_from(file.len()).expect("small");
            file.extend(std::iter::repeat_n(0xff, drop as usize));
            expected.extend_from_slice(&text);
            edits.push(Edit::replace(Span::new(start, start + drop), text));
        }
        if !edits.is_empty() {
            let turn = seed as usize % edits.len();
            edits.rotate_left(turn);
        }
        (file, edits, expected)
    })
}

proptest! {
    #[test]
    fn edits_change_their_own_bytes_only((file, edits, expected) in edits()) {
        let patch = Patch::new(file.len(), edits).expect("the edits are disjoint");
        prop_assert_eq!(patch.apply(&file), expected);
        let gone: usize = patch.edits().iter().map(|edit| edit.span.len()).sum();
        prop_assert_eq!(patch.counts().bytes_untouched, file.len() - gone);
    }

    #[test]
    fn overlap_is_refused(start in 0_u32..50, length in 1_u32..10, inside in 0_u32..10) {
        prop_assume!(inside < length);
        let first = Span::new(start, start + length);
        let second = Span::new(start + inside, start + length + 1);
        let patch = Patch::new(100, vec![Edit::remove(second), Edit::replace(first, "x")]);
        prop_assert_eq!(patch, Err(PatchError::Overlap { first, second }));
    }

    #[test]
    fn edits_behind_the_file_are_refused(length in 0_usize..50, beyond in 1_u32..9) {
        let end = u32::try_from(length).expect("small") + beyond;
        let result = Patch::new(length, vec![Edit::insert(end, "x")]);
        prop_assert_eq!(result, Err(PatchError::OutOfBounds { span: Span::new(end, end), length }));
    }
}
