// Body of the fuzz target `p21_tile`, also run over the seeds by the ordinary tests: whatever the bytes, tokens
// tile them, reading does not panic, and every view stays inside the file.

pub fn p21_tile(bytes: &[u8]) {
    use resurf::diagnostic::Diagnostics;
    use resurf::step::{ExchangeStructure, syntax::Tokens};

    let mut at = 0;
    for (_, span) in Tokens::new(bytes) {
        assert!(span.start == at && span.end > span.start, "gap or empty token at {at}");
        at = span.end;
    }
    assert_eq!(at as usize, bytes.len(), "the tokens do not reach the end");

    let Ok(source) = resurf::source::Source::new(bytes.to_vec()) else { return };
    let mut sink = Diagnostics::default();
    let structure = ExchangeStructure::parse(source, &mut sink);
    structure.unresolved_references(&mut sink);
    for instance in structure.instances() {
        assert!(structure.instance(instance.name()).is_some(), "{} is not found again", instance.name());
        for record in instance.records() {
            let inside = record.parameters_span();
            for parameter in record.parameters() {
                let span = parameter.span();
                assert!(
                    inside.start <= span.start && span.end <= inside.end,
                    "a parameter outside its record"
                );
                let _ = (parameter.as_f64(), parameter.as_str(), parameter.untyped());
            }
        }
    }
    for diagnostic in sink.kept() {
        assert!(diagnostic.span.is_none_or(|span| span.end as usize <= bytes.len()), "{diagnostic:?}");
    }
}
