// Body of the fuzz target `iges_parameters`, also run over the seeds by the ordinary tests: any bytes as the parameters of
// any entity are read in bounded time and memory, and the fields of its view lie within them. The first two bytes
// choose the type and the form.

pub fn iges_parameters(bytes: &[u8]) {
    use resurf::diagnostic::Diagnostics;
    use resurf::iges::{EntityView, ExchangeStructure, schema, write};
    use resurf::source::Source;

    let [kind, form, text @ ..] = bytes else { return };
    let table = schema::table();
    let row = &table[usize::from(*kind) % table.len()];
    let form = row.forms.first().map_or(i32::from(*form), |(from, to)| from + i32::from(*form) % (to - from + 1));
    let lines: Vec<Vec<u8>> = text
        .chunks(64)
        .take(200)
        .map(|line| line.iter().map(|byte| if matches!(byte, b'\n' | b'\r') { b' ' } else { *byte }).collect())
        .collect();
    let mut file = Vec::new();
    let mut card = |data: &[u8], letter, number| {
        file.extend(write::card(data, letter, number));
        file.push(b'\n');
    };
    card(b"", 'S', 1);
    card(b"1H,,1H;;", 'G', 1);
    let entry = resurf::iges::DirectoryEntry {
        entity_type: row.entity_type,
        form,
        parameter_data: 1,
        parameter_cards: i32::try_from(lines.len()).expect("few"),
        ..Default::default()
    };
    for (at, data) in write::directory_cards(&entry).iter().enumerate() {
        card(data.as_bytes(), 'D', at + 1);
    }
    for (at, line) in lines.iter().enumerate() {
        card(&write::parameter_data(line, resurf::iges::EntryNumber(1)), 'P', at + 1);
    }
    card(format!("S      1G      1D      2P{:7}", lines.len()).as_bytes(), 'T', 1);
    let mut sink = Diagnostics::default();
    let structure = ExchangeStructure::parse(Source::new(file).expect("small"), &mut sink);
    let Some(view) = structure.instance_at(0).and_then(EntityView::of) else { return };
    let count = view.instance().record().count();
    assert!(view.pointers().len() <= count, "more pointers than parameters");
    let _ = view.trailing();
    for field in &view.row().fields {
        let _ = (view.fields().reals(field.name), view.fields().integer(field.name), view.fields().text(field.name));
        if let Ok(members) = view.fields().group(field.name) {
            assert!(members.len() <= count, "more members than parameters");
        }
    }
}
