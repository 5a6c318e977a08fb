//! What a patch may touch: the values that it was asked for, and numbers that follow from them.

use proptest::prelude::*;
use resurf::exchange::Patch;
use resurf::iges::edit::Changes;
use resurf::iges::write::{NewEntity, RecordWriter};
use resurf::iges::{DirectoryEntry, EntryNumber, ExchangeStructure, Field};

use crate::structure::{PLAIN, joined, parse};
use crate::support;

fn patched(structure: &ExchangeStructure, changes: &Changes) -> Vec<u8> {
    let bytes = structure.source().bytes();
    let edits = changes.edits(structure).expect("a small file");
    Patch::new(bytes.len(), edits).expect("edits are disjoint").apply(bytes)
}

/// All parameters of all entities as they stand in the file.
fn texts(structure: &ExchangeStructure) -> Vec<Vec<Vec<u8>>> {
    let of =
        |instance: resurf::iges::Instance<'_>| instance.record().map(|p| p.text().into_owned()).collect();
    structure.instances().map(of).collect()
}

/// The first 64 columns of the cards of each entity.
fn columns(structure: &ExchangeStructure) -> Vec<Vec<Vec<u8>>> {
    let bytes = structure.source().bytes();
    let data = |card: &u32| bytes[*card as usize..*card as usize + 64].to_vec();
    structure.instances().map(|instance| instance.cards().iter().map(data).collect()).collect()
}

fn lines(bytes: &[u8]) -> Vec<String> {
    String::from_utf8_lossy(bytes).lines().map(str::to_owned).collect()
}

#[test]
fn a_value_that_fits_changes_its_own_columns() {
    let (structure, _) = parse(&joined(PLAIN, "\r\n"));
    let line = structure.instance(EntryNumber(3)).expect("a line");
    let mut changes = Changes::default();
    changes.replace(line, &line.record().nth(4).expect("a coordinate"), vec![b"1.25".to_vec()]);
    let expected: Vec<String> =
        PLAIN.iter().map(|text| text.replace("110,0.,0.,0.,1.,2.,   ", "110,0.,0.,0.,1.25,2.,")).collect();
    let expected: Vec<&str> = expected.iter().map(String::as_str).collect();
    // Eighteen columns of the value's card are its own; the line stays 80 columns long.
    let out = patched(&structure, &changes);
    assert_eq!(lines(&out).len(), expected.len());
    assert!(lines(&out)[11].starts_with("110,0.,0.,0.,1.25,2.,"));
    let differing: Vec<usize> =
        lines(&out).iter().zip(PLAIN).enumerate().filter(|(_, (a, b))| a != *b).map(|(at, _)| at).collect();
    assert_eq!(differing, [11]);
    assert_eq!(out.len(), structure.source().bytes().len());
}

#[test]
fn a_record_that_grows_moves_numbers_and_nothing_else() {
    let (structure, _) = parse(&joined(PLAIN, "\n"));
    let line = structure.instance(EntryNumber(3)).expect("a line");
    let mut changes = Changes::default();
    for at in 1..6 {
        let value = format!("0.12345678901234{at}").into_bytes();
        changes.replace(line, &line.record().nth(at).expect("a coordinate"), vec![value]);
    }
    let expected = [
        "     110       2       0       0       3       0       0       000000000D      3",
        "     110       0       3       3       0                    EDGE       7D      4",
        "     406       5       0       0       0       0       0       000010300D      5",
        "     406       0       0       2      15                                D      6",
        "116,1.,2.,3.,0;                                                        1P      1",
        "110,0.123456789012341,0.123456789012342,0.123456789012343,             3P      2",
        "0.123456789012344,0.123456789012345,                                   3P      3",
        "3.,0,1,5;remark                                                        3P      4",
        "406,1,70Habcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyzabc       5P      5",
        "defghijklmn;,;,;                                                       5P      6",
        "S      1G      3D      6P      6                                        T      1",
    ];
    assert_eq!(lines(&patched(&structure, &changes))[6..], expected);
}

#[test]
fn entities_come_behind_the_last_and_records_shrink() {
    let (structure, _) = parse(&joined(PLAIN, "\n"));
    let mut changes = Changes::default();
    let mut point = RecordWriter::of_type(116);
    point.reals([7.0, 8.0, 9.0]).pointer(None);
    let entry = DirectoryEntry { entity_type: 116, level: 4, ..Default::default() };
    let number = changes.add(&structure, NewEntity { entry, parameters: point.finish() }).expect("room");
    assert_eq!(number, EntryNumber(7));
    let line = structure.instance(EntryNumber(3)).expect("a line");
    changes.rewrite(line, RecordWriter::of_type(0).finish());
    changes.set_field(line, Field::EntityType, 0);
    let expected = [
        "     116       1       0       0       0       0       0       000000000D      1",
        "     116       0       0       1       0                                D      2",
        "       0       2       0       0       3       0       0       000000000D      3",
        "       0       0       3       1       0                    EDGE       7D      4",
        "     406       3       0       0       0       0       0       000010300D      5",
        "     406       0       0       2      15                                D      6",
        "     116       5       0       0       4       0       0       000000000D      7",
        "     116       0       0       1       0                               0D      8",
        "116,1.,2.,3.,0;                                                        1P      1",
        "0;remark                                                               3P      2",
        "406,1,70Habcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyzabc       5P      3",
        "defghijklmn;,;,;                                                       5P      4",
        "116,7.,8.,9.,0;                                                        7P      5",
        "S      1G      3D      8P      5                                        T      1",
    ];
    let out = patched(&structure, &changes);
    assert_eq!(lines(&out)[4..], expected);
    assert_eq!(parse(&out).1.kept(), []);
}

#[test]
fn the_stamp_keeps_the_digits_of_the_year() {
    let stamped = |file: &[u8]| {
        let (structure, _) = parse(file);
        let mut changes = Changes::default();
        changes.stamp(&structure, "2027-02-03T04:05:06", "resurf 9.9.9");
        parse(&patched(&structure, &changes))
    };
    let (long, sink) = stamped(&joined(PLAIN, "\n"));
    assert_eq!(sink.kept(), []);
    assert_eq!(long.global().written, "20270203.040506");
    assert_eq!(
        (long.global().preprocessor_version.as_str(), long.global().changed.as_str()),
        ("resurf 9.9.9", "20260101.000000")
    );
    let short: Vec<String> = PLAIN
        .iter()
        .map(|line| {
            if line.contains("1.,15H2026") {
                format!("{:72}{}", line[..72].replacen("15H20", "13H", 1).trim_end(), &line[72..])
            } else {
                (*line).to_owned()
            }
        })
        .collect();
    let (short, _) = stamped(&joined(&short.iter().map(String::as_str).collect::<Vec<_>>(), "\n"));
    assert_eq!(short.global().written, "270203.040506");
}

#[test]
fn the_compressed_form_keeps_what_others_inherit() {
    let text = format!(
        "{:72}C      1\n{:72}S      1\n{:72}G      1\n{}{:72}T      1\n",
        "",
        "",
        "1H,,1H;,4Hpart;",
        "D1@1_116@3_0@4_0@5_7@6_0@7_0@8_0@9_00000000@12_0@13_3@14_1@15_0@18_A@19_1;\n116,1.,2.,3.,0;\n\
         D3;\n116,4.,5.,6.;\n",
        "S      1G      1D      4P      2",
    );
    let (structure, _) = parse(text.as_bytes());
    let mut changes = Changes::default();
    let first = structure.instance(EntryNumber(1)).expect("there");
    changes.set_field(first, Field::Level, 9);
    changes.replace(first, &first.record().nth(1).expect("x"), vec![vec![b'1'; 80]]);
    let number = changes
        .add(
            &structure,
            NewEntity {
                entry: *first.entry(),
                parameters: RecordWriter::of_type(116).reals([0.5; 3]).finish(),
            },
        )
        .expect("room");
    let (after, sink) = parse(&patched(&structure, &changes));
    assert_eq!(sink.kept(), []);
    let levels: Vec<_> =
        after.instances().map(|i| (i.number(), i.entry().level, i.entry().parameter_cards)).collect();
    assert_eq!(levels, [(EntryNumber(1), 9, 2), (EntryNumber(3), 7, 1), (number, 7, 1)]);
    assert_eq!(after.instance_at(2).expect("new").record().count(), 4);
}

/// A file of entities with given texts as parameters.
fn made(records: &[Vec<String>]) -> Vec<u8> {
    let entities: Vec<NewEntity> = records
        .iter()
        .map(|texts| {
            let mut record = RecordWriter::of_type(5001);
            for text in texts {
                record.verbatim(text.as_bytes());
            }
            NewEntity {
                entry: DirectoryEntry { entity_type: 5001, ..Default::default() },
                parameters: record.finish(),
            }
        })
        .collect();
    let global = resurf::iges::Global { written: "20260101.000000".into(), ..Default::default() };
    resurf::iges::write::file(&["law"], &global, &entities)
}

fn parameter() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => "-?[0-9]{1,3}\\.[0-9]{0,14}",
        2 => "[0-9]{1,4}",
        1 => Just(String::new()),
        1 => "[a-z,;]{1,90}".prop_map(|text| format!("{}H{text}", text.len())),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn only_what_was_asked_for_changes(
        records in prop::collection::vec(prop::collection::vec(parameter(), 1..40), 1..12),
        wanted in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), parameter()), 1..12),
    ) {
        let bytes = made(&records);
        let (before, sink) = parse(&bytes);
        prop_assert_eq!(sink.kept(), &[]);
        let mut expected = texts(&before);
        let mut changes = Changes::default();
        let mut touched = std::collections::BTreeSet::new();
        for (record, place, text) in &wanted {
            let at = record.index(records.len());
            let place = 1 + place.index(records[at].len());
            let instance = before.instance_at(at as u32).expect("there");
            let old = instance.record().nth(place).expect("there");
            changes.replace(instance, &old, vec![text.clone().into_bytes()]);
            expected[at][place] = text.clone().into_bytes();
            touched.insert(at);
        }
        let out = patched(&before, &changes);
        let (after, sink) = parse(&out);
        prop_assert_eq!(sink.kept(), &[]);
        prop_assert_eq!(texts(&after), expected);
        let (old, new) = (columns(&before), columns(&after));
        for at in (0..records.len()).filter(|at| !touched.contains(at)) {
            prop_assert_eq!(&old[at], &new[at]);
        }
    }
}

#[test]
fn records_of_the_corpus_grow_and_nothing_else_changes() {
    for path in support::corpus_files(support::IGES) {
        let bytes = std::fs::read(&path).expect("readable");
        let (before, sink) = parse(&bytes);
        if sink.worst() == Some(resurf::diagnostic::Severity::Error)
            || before.form() != resurf::iges::Form::Fixed
        {
            continue;
        }
        let mut expected = texts(&before);
        let mut changes = Changes::default();
        for instance in before.instances().step_by(7) {
            for (at, parameter) in
                instance.record().enumerate().skip(1).step_by(5).filter(|(_, p)| p.as_f64().is_some())
            {
                let value = b"-0.12345678901234567".to_vec();
                changes.replace(instance, &parameter, vec![value.clone()]);
                expected[instance.position() as usize][at] = value;
            }
        }
        let (after, after_sink) = parse(&patched(&before, &changes));
        let name = path.display();
        assert!(texts(&after) == expected, "{name}: other values");
        let (old, new) = (columns(&before), columns(&after));
        for at in (0..old.len()).filter(|at| at % 7 != 0) {
            assert!(old[at] == new[at], "{name}: columns of entity {at}");
        }
        let repaired = ["iges.terminate-counts", "iges.parameter-count", "iges.long-card"];
        for (code, count) in after_sink.counts() {
            let was = sink.counts().get(code).copied().unwrap_or(0);
            assert!(*count <= was || repaired.contains(code), "{name}: {code} {was} before, {count} after");
        }
    }
}
