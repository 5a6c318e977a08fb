//! Odd and broken files of the corpus: each ends as the corpus's own table says.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Fixture, support};

/// How one file must end.
struct Expected {
    /// Its file.
    name: &'static str,
    /// The word of the corpus's table.
    word: &'static str,
    /// Exit code of `inspect` and of `check`.
    read: u8,
    /// Exit code of `convert` to the same format.
    convert: u8,
    /// What standard error must say; empty when it must say nothing.
    says: &'static str,
}

/// A row without a message.
const fn silent(name: &'static str) -> Expected {
    Expected { name, word: "read", read: 0, convert: 0, says: "" }
}

/// A row of a file that is read with a remark.
const fn remark(name: &'static str, word: &'static str, says: &'static str) -> Expected {
    Expected { name, word, read: 0, convert: 0, says }
}

/// A row of a file of which a part is not understood: a copy is whole, everything else is not.
const fn partly(name: &'static str, word: &'static str, says: &'static str) -> Expected {
    Expected { name, word, read: 1, convert: 0, says }
}

/// A row of a file that is not read.
const fn refused(name: &'static str, word: &'static str, says: &'static str) -> Expected {
    Expected { name, word, read: 3, convert: 3, says }
}

const TABLE: [Expected; 43] = [
    silent("gz.stpZ"),
    silent("zip.stpZ"),
    silent("cr_only.stp"),
    silent("crlf_mixed.stp"),
    silent("one_line.stp"),
    silent("token_per_line.stp"),
    silent("bom.stp"),
    remark("leading_junk.stp", "diagnose", "warning[step.leading-junk]"),
    silent("trailing_nul.stp"),
    remark("no_end.stp", "read+warn", "warning[step.missing-end]"),
    refused("truncated.stp", "refuse", "error[step.truncated]"),
    silent("comments_everywhere.stp"),
    silent("reversed_order.stp"),
    silent("huge_ids.stp"),
    silent("zero_padded_ids.stp"),
    partly("duplicate_id.stp", "diagnose", "error[step.duplicate-instance]: #6 "),
    silent("two_data_sections.stp"),
    silent("ed3_anchor_reference.stp"),
    silent("user_defined_entity.stp"),
    remark("scope.stp", "read+warn", "warning[step.scope-structure]"),
    silent("reals_odd.stp"),
    remark("reals_lower_e.stp", "read+warn", "warning[step.lower-case-exponent]"),
    remark("ints_for_reals.stp", "read+warn", "warning[step.integer-for-real]"),
    remark("lower_keywords.stp", "diagnose", "warning[step.lower-case-keyword]"),
    silent("strings_encoded.stp"),
    remark("strings_latin1.stp", "read+warn", "warning[step.raw-string]"),
    remark("strings_gbk.stp", "read+warn", "warning[step.raw-string]"),
    silent("strings_utf8.stp"),
    silent("inch_lowercase.stp"),
    refused("cartesian_nan.stp", "refuse", "#12 has the coordinate 1.E400"),
    partly("bad_mults.stp", "refuse-face", "error[step.bad-geometry]: #56"),
    partly("dangling_ref.stp", "diagnose", "error[step.unresolved-reference]: #17: refers to #888888"),
    partly("self_ref.stp", "diagnose", "error[step.bad-topology]: #18"),
    // The composites of the part that these were made of do not run head to tail, which is told of each of them.
    remark("iges_crlf.igs", "read", TURNED),
    remark("iges_cr.igs", "read", TURNED),
    remark("iges_no_newlines.igs", "read", TURNED),
    remark("iges_trailing_blanks_stripped.igs", "read", TURNED),
    remark("iges_81cols.igs", "read+warn", "warning[iges.long-card]"),
    remark("iges_delims_slash_hash.igs", "read", TURNED),
    remark("iges_d_exponent.igs", "read", TURNED),
    remark("iges_no_terminate.igs", "read+warn", "warning[iges.missing-terminate]"),
    remark("iges_bad_T.igs", "read+warn", "warning[iges.terminate-counts]"),
    // Its fields are numbered as if the standard counted one fewer.
    partly("iges_compressed.igs", "read or refuse with a clear message", "error[iges.bad-compression]"),
];

const TURNED: &str = "warning[iges.turned-piece]";

fn ends(said: &str, code: u8) -> bool {
    said.starts_with(&format!("exit code: {code}\n"))
}

fn stderr(said: &str) -> &str {
    said.split_once("--- stderr\n").map_or("", |(_, rest)| rest)
}

#[test]
fn every_odd_file_ends_as_its_table_says() {
    let Some(corpus) = support::corpus() else { return };
    let folder = corpus.join("patho");
    let manifest = std::fs::read_to_string(folder.join("MANIFEST.tsv")).expect("the corpus has its table");
    let words: BTreeMap<&str, &str> = manifest
        .lines()
        .skip(1)
        .filter_map(|line| Some((line.split('\t').next()?, line.split('\t').nth(2)?)))
        .collect();
    let table: BTreeMap<&str, &str> = TABLE.iter().map(|row| (row.name, row.word)).collect();
    assert_eq!(table, words, "the table here and that of the corpus");
    let origins: BTreeMap<&str, &str> =
        manifest.lines().skip(1).filter_map(|line| line.split_once('\t')).collect();
    for row in &TABLE {
        let read = |path: &Path| std::fs::read(path).expect("a file of the table");
        let bytes = read(&folder.join(row.name));
        // A compressed file is passed on as what was inside.
        let origin = origins[row.name].split('\t').next().expect("a column");
        let plain = if row.name.ends_with(".stpZ") { read(&corpus.join(origin)) } else { bytes.clone() };
        holds(row, &bytes, &plain);
    }
}

/// Holds the commands to a row; `plain` is what a copy must be.
fn holds(row: &Expected, bytes: &[u8], plain: &[u8]) {
    let extension = if row.name.ends_with(".igs") { "igs" } else { "stp" };
    let job = format!(
        "version = 1\ninputs = [\"in/*\"]\noutput = \"out/{{stem}}.{extension}\"\n\
         [[operation]]\nkind = \"constrained_scale\"\nfactors = [2, 2, 2]\n"
    );
    let same = format!("same.{extension}");
    let input = format!("in/{}", row.name);
    let fixture = Fixture::new().file(&input, bytes).file("job.toml", job);
    for command in ["inspect", "check"] {
        let said = fixture.run(&[command, &input]);
        assert!(ends(&said, row.read), "{command} {}: {said}", row.name);
        let told = stderr(&said);
        assert!(told.contains(row.says) && told.is_empty() == row.says.is_empty(), "{command}: {said}");
    }
    let said = fixture.run(&["convert", &input, "-o", &same]);
    assert!(ends(&said, row.convert), "convert {}: {said}", row.name);
    let copy = std::fs::read(fixture.path(&same)).ok();
    assert_eq!(copy.as_deref(), (row.convert == 0).then_some(plain), "{}", row.name);
    if row.read != 0 {
        let said = fixture.run(&["run", "job.toml"]);
        assert!(ends(&said, 3), "run {}: {said}", row.name);
        assert!(!fixture.path("out").exists(), "{}: a refused part leaves nothing", row.name);
    }
}
