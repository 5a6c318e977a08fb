// Body of the fuzz target `other_format`, also run over the seeds by the ordinary tests: whatever a file is read as is
// written in the other format, or refused, and what is written is read again without an error.

pub fn other_format(bytes: &[u8]) {
    use resurf::diagnostic::{Diagnostics, Severity};
    use resurf::document::{Conversion, Document, Format, Schema, Solids, Stamp, converted};

    let mut sink = Diagnostics::default();
    let Ok(document) = Document::open(bytes.to_vec(), "", &mut sink) else { return };
    let model = document.model(&mut sink);
    let stamp = Stamp { time: "2026-01-01T00:00:00".to_owned(), preprocessor: "fuzz".to_owned() };
    let conversions = match document.format() {
        Format::Iges => [Conversion::Step(Schema::Ap214), Conversion::Step(Schema::Ap242)],
        _ => [Conversion::Iges(Solids::Brep), Conversion::Iges(Solids::Trimmed)],
    };
    for conversion in conversions {
        let Ok(made) = converted(&model, conversion, "made", &stamp, &mut sink) else { continue };
        let mut errors = Diagnostics::default();
        let again = Document::open(made, "", &mut errors).expect("a file of a known format");
        assert_eq!(again.format() == Format::Iges, document.format() != Format::Iges);
        let damaged = errors.kept().iter().find(|fact| fact.severity == Severity::Error);
        assert_eq!(damaged, None);
    }
}
