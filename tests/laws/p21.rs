//! ISO 10303-21: any bytes are read without a panic, and what is written reads back.

use proptest::prelude::*;
use resurf::diagnostic::Diagnostics;
use resurf::number::{format_real, parse_real};
use resurf::source::{LineEnding, Source};
use resurf::step::syntax::Tokens;
use resurf::step::write::RecordWriter;
use resurf::step::{ExchangeStructure, InstanceName, string};

/// Fragments that lead a reader astray more often than random bytes do.
const FRAGMENTS: &[&str] = &[
    "ISO-10303-21;",
    "HEADER;",
    "ENDSEC;",
    "DATA;",
    "DATA('x');",
    "ANCHOR;",
    "REFERENCE;",
    "SIGNATURE;",
    "END-ISO-10303-21;",
    "#1=",
    "#2 = ",
    "A(",
    "(",
    ")",
    ",",
    ";",
    "'",
    "''",
    "\n",
    "/*",
    "*/",
    "/",
    "$",
    "*",
    ".T.",
    ".",
    "1.E5",
    "-",
    "#3",
    "\"0F\"",
    "<a>",
    "&SCOPE",
    "ENDSCOPE",
    "!X",
    "@1",
    "#99999999999999999999999",
    "\\X2\\",
    "\\",
];

fn soup() -> impl Strategy<Value = Vec<u8>> {
    let fragment = prop_oneof![
        8 => prop::sample::select(FRAGMENTS).prop_map(|text| text.as_bytes().to_vec()),
        1 => prop::collection::vec(any::<u8>(), 0..4),
    ];
    prop::collection::vec(fragment, 0..60).prop_map(|parts| parts.concat())
}

fn parse(bytes: Vec<u8>) -> ExchangeStructure {
    ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut Diagnostics::default())
}

#[test]
fn a_data_section_without_records_leaves_the_record_before_it_alone() {
    let bytes = b"ISO-10303-21;#1=ENDSEC;A(ENDSEC;A(ISO-10303-21;DATA;";
    let structure = parse(bytes.to_vec());
    assert!(structure.sections().iter().all(|section| section.span.end as usize <= bytes.len()));
}

proptest! {
    #[test]
    fn any_bytes_tile_and_read(bytes in soup()) {
        let mut at = 0;
        for (_, span) in Tokens::new(&bytes) {
            prop_assert_eq!(span.start, at);
            prop_assert!(span.end > span.start);
            at = span.end;
        }
        prop_assert_eq!(at as usize, bytes.len());
        let structure = parse(bytes.to_vec());
        structure.unresolved_references(&mut Diagnostics::default());
        for record in structure.header().chain(structure.instances().flat_map(|instance| instance.records())) {
            let inside = record.parameters_span();
            let mut last = inside.start;
            for parameter in record.parameters() {
                let span = parameter.span();
                prop_assert!(last <= span.start && span.end <= inside.end);
                last = span.end;
                let _ = (parameter.as_str(), parameter.as_f64(), parameter.untyped());
            }
        }
    }

    #[test]
    fn reals_read_back_to_the_same_bits(bits in any::<u64>()) {
        let value = f64::from_bits(bits);
        if value.is_finite() {
            let text = format_real(value);
            prop_assert!(text.contains('.') && !text.contains('e') && !text.contains('+'), "{}", text);
            prop_assert_eq!(parse_real(text.as_bytes()).map(f64::to_bits), Some(bits));
        }
    }

    #[test]
    fn strings_read_back(text in "\\PC*|[\\x00-\\x7f]*|['\\\\é€😀]*") {
        let token = string::encode(&text);
        prop_assert!(token.bytes().all(|byte| (b' '..=b'~').contains(&byte)));
        let decoded = string::decode(token.as_bytes());
        prop_assert_eq!(&*decoded.text, text.as_str());
        prop_assert!(!decoded.lossy);
    }

    #[test]
    fn any_string_token_decodes(bytes in prop::collection::vec(any::<u8>(), 0..40)) {
        let _ = string::decode(&bytes);
    }

    #[test]
    fn written_records_read_back(values in prop::collection::vec(any::<f64>(), 0..40), name in 1_u64..u64::MAX, text in ".*") {
        let values: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
        let mut writer = RecordWriter::instance(InstanceName(name), LineEnding::CrLf);
        writer.open("X").string(&text).reals(values.iter().copied()).reference(InstanceName(name)).omitted().close();
        let record = writer.finish();
        let file = format!("ISO-10303-21;HEADER;ENDSEC;DATA;\r\n{record}\r\nENDSEC;END-ISO-10303-21;");
        let structure = parse(file.into_bytes());
        let record = structure.instance(InstanceName(name)).and_then(|i| i.record(b"x")).expect("one record");
        let parameters: Vec<_> = record.parameters().collect();
        prop_assert_eq!(parameters.len(), 4);
        let read = parameters[0].as_str().expect("a string");
        prop_assert_eq!(&*read, text.as_str());
        let read: Vec<_> = parameters[1].as_list().expect("a list").filter_map(|p| p.as_f64()).map(f64::to_bits).collect();
        prop_assert_eq!(read, values.iter().map(|value| value.to_bits()).collect::<Vec<_>>());
        prop_assert_eq!(parameters[2].as_reference(), Some(InstanceName(name)));
        prop_assert!(parameters[3].is_omitted());
    }
}
