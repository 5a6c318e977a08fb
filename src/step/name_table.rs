//! Instance name to record position, compactly.
//!
//! A dense table where names are dense, sorted columns where they are not: real files number some hundred
//! records with names of ten digits. The first record of a name wins.

/// Names up to this multiple of the number of records go into the dense table, at 4 bytes per name.
const DENSE_FACTOR: u64 = 8;
/// Allowance for the first records of a file that does not begin at 1.
const DENSE_START: u64 = 4096;
const EMPTY: u32 = u32::MAX;

/// Instance name to position in the list of records.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum NameTable {
    Dense(Vec<u32>),
    Sorted { names: Vec<u64>, positions: Vec<u32> },
}

impl NameTable {
    /// Position of the record of a name.
    pub(super) fn position(&self, name: u64) -> Option<u32> {
        match self {
            Self::Dense(table) => {
                let position = *table.get(usize::try_from(name).ok()?)?;
                (position != EMPTY).then_some(position)
            }
            Self::Sorted { names, positions } => {
                names.binary_search(&name).ok().and_then(|at| positions.get(at).copied())
            }
        }
    }

    /// The greatest name that has a record.
    pub(super) fn greatest(&self) -> Option<u64> {
        match self {
            Self::Dense(table) => {
                table.iter().rposition(|&position| position != EMPTY).map(|name| name as u64)
            }
            Self::Sorted { names, .. } => names.last().copied(),
        }
    }

    /// Sorted table of `(name, position)` pairs; calls `duplicate(name, position)` for every name that came before.
    pub(super) fn sorted(mut pairs: Vec<(u64, u32)>, mut duplicate: impl FnMut(u64, u32)) -> Self {
        pairs.sort_unstable();
        let mut names = Vec::with_capacity(pairs.len());
        let mut positions = Vec::with_capacity(pairs.len());
        for (name, position) in pairs {
            if names.last() == Some(&name) {
                duplicate(name, position);
            } else {
                names.push(name);
                positions.push(position);
            }
        }
        Self::Sorted { names, positions }
    }
}

/// Fills a dense table while records come in; gives up when the names are sparse.
#[derive(Debug, Default)]
pub(super) struct DenseBuilder {
    table: Vec<u32>,
    sparse: bool,
}

/// What became of a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Insertion {
    /// First record of that name, or not decidable yet.
    Fresh,
    /// There is a record of that name.
    Duplicate,
}

impl DenseBuilder {
    /// Takes the name of the record at `position`. Positions come in ascending order.
    pub(super) fn insert(&mut self, name: u64, position: u32) -> Insertion {
        if self.sparse {
            return Insertion::Fresh;
        }
        if name >= DENSE_FACTOR * u64::from(position) + DENSE_START {
            self.sparse = true;
            return Insertion::Fresh;
        }
        // The test above bounds the name by a small multiple of a 32-bit count.
        let slot = usize::try_from(name).expect("a dense name is small");
        if slot == self.table.len() {
            self.table.push(position);
            return Insertion::Fresh;
        }
        if slot > self.table.len() {
            self.table.resize(slot + 1, EMPTY);
        }
        if self.table[slot] != EMPTY {
            return Insertion::Duplicate;
        }
        self.table[slot] = position;
        Insertion::Fresh
    }

    /// The dense table, or `None` when the names turned out to be sparse: then duplicates were not all
    /// reported, and [`NameTable::sorted`] is to be used.
    pub(super) fn finish(self) -> Option<NameTable> {
        (!self.sparse).then_some(NameTable::Dense(self.table))
    }
}
