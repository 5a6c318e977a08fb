//! LZF, the compression inside PCD files (Lehmann's format): literal runs, and copies of what came before.

/// Most bytes that a byte of input can become: a copy of 264 bytes takes three.
const MOST: usize = 88;

/// Bytes of a known length; `None` when the input is damaged or would give another length.
pub(super) fn unpacked(input: &[u8], length: usize) -> Option<Vec<u8>> {
    if length > input.len().saturating_mul(MOST) {
        return None;
    }
    let mut out: Vec<u8> = Vec::with_capacity(length);
    let mut at = 0;
    while at < input.len() {
        let control = usize::from(input[at]);
        at += 1;
        if control < 32 {
            out.extend_from_slice(input.get(at..=at + control)?);
            at += control + 1;
        } else {
            let mut count = control >> 5;
            if count == 7 {
                count += usize::from(*input.get(at)?);
                at += 1;
            }
            let back = ((control & 31) << 8) + usize::from(*input.get(at)?) + 1;
            at += 1;
            let from = out.len().checked_sub(back)?;
            // The copy may overlap what it writes.
            for k in from..from + count + 2 {
                out.push(out[k]);
            }
        }
        if out.len() > length {
            return None;
        }
    }
    (out.len() == length).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::unpacked;

    #[test]
    fn literals_and_overlapping_copies_are_unpacked() {
        // "abc", then seven bytes from three back, which overlap, then "x".
        let packed = [2, b'a', b'b', b'c', 5 << 5, 2, 0, b'x'];
        assert_eq!(unpacked(&packed, 11).as_deref(), Some(&b"abcabcabcax"[..]));
        // A long copy: one byte again and again.
        let packed = [0, b'z', 7 << 5, 200, 0];
        assert_eq!(unpacked(&packed, 1 + 209), Some(vec![b'z'; 210]));
    }

    #[test]
    fn damage_is_refused() {
        assert_eq!(unpacked(&[3, b'a'], 4), None);
        assert_eq!(unpacked(&[0, b'a', 1 << 5, 5], 4), None);
        assert_eq!(unpacked(&[0, b'a', 7 << 5], 4), None);
        assert_eq!(unpacked(&[0, b'a'], 2), None);
        assert_eq!(unpacked(&[1, b'a', b'b'], 1), None);
        assert_eq!(unpacked(&[0, b'a'], usize::MAX), None);
    }
}
