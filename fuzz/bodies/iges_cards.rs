// Body of the fuzz target `iges_cards`, also run over the seeds by the ordinary tests: whatever the bytes, tokens tile
// them, reading does not panic, every view stays inside the file, and no parameter card belongs to two entities.

pub fn iges_cards(bytes: &[u8]) {
    use resurf::diagnostic::Diagnostics;
    use resurf::iges::{ExchangeStructure, syntax::tokens};

    let Ok(source) = resurf::source::Source::new(bytes.to_vec()) else { return };
    let mut sink = Diagnostics::default();
    let structure = ExchangeStructure::parse(source, &mut sink);
    let mut at = 0;
    for token in tokens(&structure) {
        assert!(token.span.start == at && token.span.end > at, "gap or empty token at {at}: {token:?}");
        at = token.span.end;
    }
    assert_eq!(at as usize, bytes.len(), "the tokens do not reach the end");

    structure.damaged_records(&mut sink);
    let mut owned = std::collections::BTreeSet::new();
    for instance in structure.instances() {
        assert!(structure.position(instance.number()) == Some(instance.position()), "{}", instance.number());
        for card in instance.cards() {
            assert!(owned.insert(*card), "{} shares a card", instance.number());
        }
        for parameter in instance.record() {
            for span in parameter.pieces() {
                assert!(span.end as usize <= bytes.len(), "a parameter outside the file");
            }
            let _ = (parameter.kind(), parameter.as_f64(), parameter.as_i64(), parameter.as_str());
        }
    }
    for diagnostic in sink.kept() {
        assert!(diagnostic.span.is_none_or(|span| span.end as usize <= bytes.len()), "{diagnostic:?}");
    }
}
