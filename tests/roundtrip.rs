//! What every file must survive: tokens tile it, the empty patch is the identity, damage does not panic.

mod support;

use std::collections::BTreeMap;

use resurf::diagnostic::{Diagnostics, Severity};
use resurf::exchange::Patch;
use resurf::source::Source;
use resurf::step::syntax::{TokenKind, Tokens};
use resurf::step::{ExchangeStructure, ParameterKind, Parameters};

/// Snippets that stand for the corpus where there is none: (name, text, instances, codes).
const SNIPPETS: &[(&str, &[u8], usize, &[&str])] = &[
    ("plain", b"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('X'));\nENDSEC;\nDATA;\n#1=A('',(1.,2.));\n#2=B(#1,$,*);\nENDSEC;\nEND-ISO-10303-21;\n", 2, &[]),
    ("crlf, no last line end", b"ISO-10303-21;\r\nHEADER;\r\nENDSEC;\r\nDATA;\r\n#1 = A ( .T. ) ;\r\nENDSEC;\r\nEND-ISO-10303-21;", 1, &[]),
    ("mark, tabs, nul", b"\xef\xbb\xbfISO-10303-21;\tHEADER;ENDSEC;\tDATA;#1=A(\"0FF\");ENDSEC;END-ISO-10303-21;\0\0\0", 1, &[]),
    ("raw bytes", b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=A('\xb5\xe7\xbb\xfa');#2=!MINE('\xc3\xa9');ENDSEC;END-ISO-10303-21;", 2, &[]),
    ("comments", b"/*a*/ISO-10303-21;/*'*/HEADER;ENDSEC;DATA;/*#9=A();*/#1/*=*/=/*;*/A/*(*/(/*)*/'/*',/*'*/2)/**/;ENDSEC;END-ISO-10303-21;", 1, &[]),
    ("two sections", b"ISO-10303-21;HEADER;ENDSEC;DATA('a',('S'));#1=A(#2);ENDSEC;DATA('b',('S'));#2=A(#1);ENDSEC;END-ISO-10303-21;", 2, &[]),
    ("edition 3", b"ISO-10303-21;HEADER;ENDSEC;ANCHOR;<a;b>=#1{x:'y'};ENDSEC;REFERENCE;#7=<o.stp#p>;ENDSEC;DATA;#1=A(#7,@3,<u>);ENDSEC;END-ISO-10303-21;SIGNATURE;MIIB+/==ENDSEC;", 1, &[]),
    ("scope", b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=&SCOPE #2=A(#3);#3=B(); ENDSCOPE /#2/ C(#2);#4=D();ENDSEC;END-ISO-10303-21;", 4, &["step.scope-structure"]),
    ("junk before", b"?ISO-10303-21;HEADER;ENDSEC;DATA;#1=A();ENDSEC;END-ISO-10303-21;", 1, &["step.leading-junk"]),
    ("no end", b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=A();ENDSEC;", 1, &["step.missing-end"]),
    ("no endsec", b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=A();END-ISO-10303-21;", 1, &["step.missing-endsec"]),
    ("cut", b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=A();\n#2=B((1.,2", 1, &["step.truncated"]),
    ("cut in a string", b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=A();\n#2=B('x", 1, &["step.truncated"]),
    ("twice", b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=A();#1=B();ENDSEC;END-ISO-10303-21;", 2, &["step.duplicate-instance"]),
    ("lower case", b"iso-10303-21;header;endsec;data;#1=a(.t.);endsec;end-iso-10303-21;", 1, &["step.lower-case-keyword"]),
    ("40 digits", b"ISO-10303-21;HEADER;ENDSEC;DATA;#1234567890123456789012345678901234567890=A();#2=B();ENDSEC;END-ISO-10303-21;", 1, &["step.instance-name-too-large"]),
    ("open string", b"ISO-10303-21;HEADER;ENDSEC;DATA;\n#1=A('x);\n#2=B('',1);\n#3=C('y');\nENDSEC;END-ISO-10303-21;", 3, &["step.damaged-record"]),
    ("no semicolon", b"ISO-10303-21;HEADER;ENDSEC;DATA;\n#1=A('=')\n#2=B()\nENDSEC;END-ISO-10303-21;", 2, &["step.missing-semicolon"]),
    ("rubbish between", b"ISO-10303-21;HEADER;ENDSEC;DATA;\n#1=A();\n%%% ; ENDS\n#2=B();\nENDSEC;END-ISO-10303-21;", 2, &["step.unexpected-text"]),
    ("gzip", b"\x1f\x8b\x08\x00", 0, &["step.compressed"]),
    ("nothing", b"", 0, &["step.not-exchange-structure"]),
];

fn parse(bytes: &[u8]) -> (ExchangeStructure, Diagnostics) {
    let mut sink = Diagnostics::default();
    let structure = ExchangeStructure::parse(Source::new(bytes.to_vec()).expect("small"), &mut sink);
    (structure, sink)
}

/// Reads every parameter of every record to the last level, with an explicit stack. Returns how many.
fn walk(structure: &ExchangeStructure) -> usize {
    let mut count = 0;
    let headers = structure.header();
    let bodies = structure.instances().flat_map(|instance| instance.records());
    for record in headers.chain(bodies) {
        let mut open: Vec<Parameters<'_>> = vec![record.parameters()];
        while let Some(cursor) = open.last_mut() {
            let Some(parameter) = cursor.next() else {
                open.pop();
                continue;
            };
            count += 1;
            assert!(parameter.span().end as usize <= structure.source().bytes().len());
            let _ = (parameter.as_f64(), parameter.as_i64(), parameter.as_str(), parameter.as_logical());
            // Deeper levels are read by the test of deep nesting; here they would take quadratic time.
            if let Some(members) = parameter.members().filter(|_| open.len() < 64) {
                open.push(members);
            }
        }
    }
    count
}

fn assert_tiles(bytes: &[u8]) {
    let mut at = 0;
    for (_, span) in Tokens::new(bytes) {
        assert_eq!(span.start, at);
        assert!(span.end > span.start);
        at = span.end;
    }
    assert_eq!(at as usize, bytes.len());
}

/// The laws that hold for any bytes.
fn assert_laws(bytes: &[u8]) -> (ExchangeStructure, Diagnostics) {
    assert_tiles(bytes);
    let (structure, sink) = parse(bytes);
    assert_eq!(structure.source().bytes(), bytes);
    let empty = Patch::new(bytes.len(), Vec::new()).expect("no edits cannot overlap");
    assert!(empty.apply(bytes) == bytes, "the empty patch is not the identity");
    walk(&structure);
    let mut previous = 0;
    for instance in structure.instances() {
        assert!(instance.span().start >= previous, "records out of order");
        previous = instance.span().start;
        assert!(instance.text().starts_with(b"#"));
        assert!(structure.instance(instance.name()).is_some());
    }
    (structure, sink)
}

#[test]
fn snippets_are_read_as_the_standard_says() {
    for (name, bytes, instances, codes) in SNIPPETS {
        let (structure, sink) = assert_laws(bytes);
        assert_eq!(structure.instances().len(), *instances, "{name}");
        let found: Vec<_> = sink.counts().keys().copied().collect();
        assert_eq!(&found, codes, "{name}: {:?}", sink.kept());
    }
}

#[test]
fn every_corpus_file_keeps_the_laws() {
    for path in support::corpus_files(support::STEP) {
        let bytes = std::fs::read(&path).expect("readable");
        assert_laws(&bytes);
    }
}

/// Counts records by keyword without the reader: line by line state machine over quotes and comments that
/// knows only that a record begins with `#digits=` behind a semicolon or scope word.
fn naive_keyword_counts(bytes: &[u8]) -> BTreeMap<Vec<u8>, usize> {
    let mut clean = Vec::with_capacity(bytes.len());
    let (mut quoted, mut at) = (false, 0);
    while at < bytes.len() {
        match bytes[at] {
            b'\'' => quoted = !quoted,
            b'/' if !quoted && bytes.get(at + 1) == Some(&b'*') => {
                let close =
                    bytes[at + 2..].windows(2).position(|pair| pair == b"*/").expect("closed comment");
                at += close + 3;
            }
            byte if !quoted && byte > b' ' => clean.push(byte),
            _ => {}
        }
        at += 1;
    }
    let mut counts = BTreeMap::new();
    for statement in clean.split(|&byte| byte == b';') {
        let Some(equals) = statement.iter().position(|&byte| byte == b'=') else { continue };
        let (left, right) = (&statement[..equals], &statement[equals + 1..]);
        let numbered = left.first() == Some(&b'#') && left[1..].iter().all(u8::is_ascii_digit);
        if !numbered || right.first() == Some(&b'<') {
            continue;
        }
        let open = right.iter().position(|&byte| byte == b'(').expect("records have parentheses");
        *counts.entry(right[..open].to_ascii_uppercase()).or_insert(0) += 1;
    }
    counts
}

#[test]
fn keyword_counts_agree_with_a_naive_count() {
    for path in support::corpus_files(support::STEP) {
        let bytes = std::fs::read(&path).expect("readable");
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        // The naive count knows nothing of containers, of scopes, and of files that stop in a record.
        if matches!(name, "gz.stpZ" | "zip.stpZ" | "scope.stp" | "truncated.stp") {
            continue;
        }
        let (structure, _) = parse(&bytes);
        let mut counts = BTreeMap::new();
        for instance in structure.instances() {
            let keyword = instance.keyword().unwrap_or_default();
            let written = match keyword.is_empty() {
                true => Vec::new(),
                false => {
                    let start = instance.records().next().expect("a keyword has its record").keyword_span();
                    bytes[start.range()].to_ascii_uppercase()
                }
            };
            *counts.entry(written).or_insert(0) += 1;
        }
        assert_eq!(counts, naive_keyword_counts(&bytes), "{name}");
    }
}

#[test]
fn variants_end_as_their_manifest_says() {
    let Some(corpus) = support::corpus() else { return };
    let manifest =
        std::fs::read_to_string(corpus.join("patho/MANIFEST.tsv")).expect("the corpus has a manifest");
    // What this layer has to say about the variants; all others must be read without a word.
    let spoken: BTreeMap<&str, &[&str]> = BTreeMap::from([
        ("gz.stpZ", &["step.compressed"] as &[&str]),
        ("zip.stpZ", &["step.compressed"] as &[&str]),
        ("leading_junk.stp", &["step.leading-junk"] as &[&str]),
        ("no_end.stp", &["step.missing-end"] as &[&str]),
        ("truncated.stp", &["step.truncated", "step.unresolved-reference"] as &[&str]),
        ("duplicate_id.stp", &["step.duplicate-instance"] as &[&str]),
        ("scope.stp", &["step.scope-structure"] as &[&str]),
        ("lower_keywords.stp", &["step.lower-case-keyword"] as &[&str]),
        ("dangling_ref.stp", &["step.unresolved-reference"] as &[&str]),
    ]);
    for name in manifest.lines().skip(1).filter_map(|line| line.split('\t').next()) {
        if !name.starts_with("iges") {
            let bytes = std::fs::read(corpus.join("patho").join(name)).expect("the manifest's files exist");
            let (structure, mut sink) = parse(&bytes);
            structure.unresolved_references(&mut sink);
            let found: Vec<_> = sink.counts().keys().copied().collect();
            let expected: Vec<_> = spoken.get(name).copied().unwrap_or_default().to_vec();
            assert_eq!(found, expected, "{name}: {:?}", sink.kept().first());
        }
    }
}

/// A file with everything in it, some kilobytes.
fn rich() -> Vec<u8> {
    let mut text =
        String::from("ISO-10303-21;\nHEADER;\nFILE_NAME('a','b',('c'),('d'),'e','f','g');\nENDSEC;\nDATA;\n");
    for n in 1..200 {
        text += &format!("#{n}=CARTESIAN_POINT('it''s; #{n}=',({n}.5,-1.E-3,.5)); /* #{n}=X('; */\n");
        text += &format!("#{}=(A(#{n})B('\\X2\\03C0\\X0\\',(($,*),()),.T.)C(\"0F\",D(1)));\r\n", n + 1000);
    }
    (text + "ENDSEC;\nEND-ISO-10303-21;\n").into_bytes()
}

#[test]
fn truncation_anywhere_is_said_and_never_panics() {
    let bytes = rich();
    let body = bytes.len() - b"ENDSEC;\nEND-ISO-10303-21;\n".len();
    for length in (40..body).step_by(97) {
        let (_, sink) = assert_laws(&bytes[..length]);
        assert_eq!(sink.worst(), Some(Severity::Error), "cut at {length}");
    }
    if let Some(corpus) = support::corpus() {
        let bytes = std::fs::read(corpus.join("step/ubend2.stp")).expect("readable");
        for length in (0..bytes.len()).step_by(1000) {
            assert_laws(&bytes[..length]);
        }
    }
}

#[test]
fn flipped_bytes_never_panic_and_cost_few_records() {
    let bytes = rich();
    let whole = parse(&bytes).0.instances().len();
    // A linear congruential generator (Knuth, MMIX) is random enough and the same everywhere.
    let mut state = 20_u64;
    for _ in 0..300 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let at = (state >> 33) as usize % bytes.len();
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (state >> 20 & 7);
        let (structure, _) = assert_laws(&damaged);
        let in_data = (150..bytes.len() - 50).contains(&at);
        let opens_comment =
            damaged[at] == b'*' || damaged[at] == b'/' || bytes[at] == b'*' || bytes[at] == b'/';
        if in_data && !opens_comment {
            let read = structure.instances().len();
            assert!(read + 4 >= whole, "byte {at}: {read} of {whole} records read");
        }
    }
}

#[test]
fn nesting_of_any_depth_is_read() {
    let depth = 100_000;
    for (open, close) in [("(", ")"), ("A(", ")")] {
        let nested = format!("{}{}", open.repeat(depth), close.repeat(depth));
        let text = format!(
            "ISO-10303-21;HEADER;ENDSEC;DATA;#1=X({nested},7);#2=Y({});ENDSEC;END-ISO-10303-21;",
            open.repeat(depth)
        );
        let (structure, _) = assert_laws(text.as_bytes());
        assert_eq!(structure.instances().len(), 2);
        let record = structure.instances().next().and_then(|i| i.records().next()).expect("a record");
        assert_eq!(record.parameters().nth(1).and_then(|p| p.as_i64()), Some(7));
        let second = structure.instances().nth(1).and_then(|i| i.records().next()).expect("a record");
        assert!(
            second.parameters().next().is_some_and(|parameter| parameter.kind() == ParameterKind::Malformed)
        );
    }
}

#[test]
fn tokens_have_the_kinds_of_the_standard() {
    let check = |text: &str, expected: &[TokenKind]| {
        let kinds: Vec<_> = Tokens::new(text.as_bytes()).map(|(kind, _)| kind).collect();
        assert_eq!(kinds, expected, "{text}");
    };
    for real in ["1.", "-1.5", "+0.E0", "1.0E+0", "1.e-7", ".5", "1E5"] {
        check(real, &[TokenKind::Real]);
    }
    check("-12", &[TokenKind::Integer]);
    check(".T.", &[TokenKind::Enumeration]);
    check("'it''s'", &[TokenKind::String]);
    check("\"1AF\"", &[TokenKind::Binary]);
    check("#12", &[TokenKind::InstanceName]);
    check("@12", &[TokenKind::ValueName]);
    check("!MY_ENTITY", &[TokenKind::Keyword]);
    check("\\N\\ /* x */", &[TokenKind::Whitespace, TokenKind::Comment]);
    check("$*", &[TokenKind::Omitted, TokenKind::Derived]);
    check("-.", &[TokenKind::Junk, TokenKind::Junk]);
}
