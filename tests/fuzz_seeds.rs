//! The bodies of the fuzz targets over their seeds and mutations of these, so that they run everywhere.

use std::path::Path;

mod bodies {
    include!("../fuzz/bodies/p21_tile.rs");
    include!("../fuzz/bodies/p21_edit_locality.rs");
    include!("../fuzz/bodies/iges_cards.rs");
    include!("../fuzz/bodies/iges_global.rs");
    include!("../fuzz/bodies/iges_parameters.rs");
    include!("../fuzz/bodies/other_format.rs");

    /// A name and a body that must not panic.
    pub type Target = (&'static str, fn(&[u8]));

    /// All targets.
    pub const ALL: [Target; 6] = [
        ("p21_tile", p21_tile),
        ("p21_edit_locality", p21_edit_locality),
        ("iges_cards", iges_cards),
        ("iges_global", iges_global),
        ("iges_parameters", iges_parameters),
        ("other_format", other_format),
    ];
}

/// Mutations of each seed.
const ROUNDS: usize = 1_000;

fn seeds() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("the seeds are there").flatten().map(|e| e.path()).collect();
    paths.sort();
    assert!(paths.len() >= 8, "seeds are missing");
    paths.iter().map(|path| std::fs::read(path).expect("readable")).collect()
}

/// A linear congruential generator (Knuth, MMIX): random enough here, and the same everywhere.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound.max(1)
    }
}

/// Replaces, removes, doubles or moves a few bytes.
fn mutate(seed: &[u8], random: &mut Random) -> Vec<u8> {
    const LURES: &[u8] = b"'();,#=/*$.&! \n\r0E\"\\HDP@_19-";
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        let end = (at + random.below(20)).min(bytes.len());
        match random.below(4) {
            0 if at < bytes.len() => bytes[at] = LURES[random.below(LURES.len())],
            1 => drop(bytes.drain(at..end)),
            2 => {
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            _ => bytes.insert(at, LURES[random.below(LURES.len())]),
        }
    }
    bytes
}

#[test]
fn fuzz_bodies_hold_on_seeds_and_their_mutations() {
    let mut random = Random(7);
    for seed in seeds() {
        bodies::ALL.iter().for_each(|(_, body)| body(&seed));
        for _ in 0..ROUNDS {
            let bytes = mutate(&seed, &mut random);
            bodies::ALL.iter().for_each(|(_, body)| body(&bytes));
        }
    }
}

#[test]
fn a_clean_seed_is_really_edited() {
    // `p21_edit_locality` passes over files that it cannot judge; this one it must judge.
    let seed =
        std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/plain.stp")).expect("readable");
    let source = resurf::source::Source::new(seed[1..].to_vec()).expect("small");
    let mut sink: Vec<resurf::diagnostic::Diagnostic> = Vec::new();
    let structure = resurf::step::ExchangeStructure::parse(source, &mut sink);
    assert_eq!((structure.len(), sink), (6, Vec::new()));
}
