//! Fresh names for new records, above every name that the file has.

/// No name is left above the highest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the file uses the highest name that 64 bits hold, so no new record can be named")]
pub struct NamesExhausted;

/// Hands out ascending numbers above a file's highest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NameAllocator {
    next: Option<u64>,
}

impl NameAllocator {
    /// Begins above `highest`, or at 1 for a file without names.
    #[must_use]
    pub fn above(highest: Option<u64>) -> Self {
        Self { next: highest.map_or(Some(1), |highest| highest.checked_add(1)) }
    }

    /// The next name.
    ///
    /// # Errors
    /// [`NamesExhausted`] behind the highest number of 64 bits.
    pub fn allocate(&mut self) -> Result<u64, NamesExhausted> {
        let name = self.next.ok_or(NamesExhausted)?;
        self.next = name.checked_add(1);
        Ok(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_ascend_from_above_the_highest_to_the_end() {
        assert_eq!(NameAllocator::above(None).allocate(), Ok(1));
        let mut names = NameAllocator::above(Some(u64::MAX - 2));
        assert_eq!(names.allocate(), Ok(u64::MAX - 1));
        assert_eq!(names.allocate(), Ok(u64::MAX));
        assert_eq!(names.allocate(), Err(NamesExhausted));
        assert_eq!(NameAllocator::above(Some(u64::MAX)).allocate(), Err(NamesExhausted));
    }
}
