// Body of the fuzz target `iges_global`, also run over the seeds by the ordinary tests: any bytes as the text of a global
// section are read in its limits, and a section that is read without complaint reads back from what is written of it.

pub fn iges_global(bytes: &[u8]) {
    use resurf::diagnostic::Diagnostics;
    use resurf::iges::{ExchangeStructure, write};
    use resurf::source::Source;

    let mut file = format!("{:72}S      1\n", "").into_bytes();
    for (at, line) in bytes.chunks(72).take(200).enumerate() {
        let mut data: Vec<u8> = line.iter().map(|byte| if matches!(byte, b'\n' | b'\r') { b' ' } else { *byte }).collect();
        data.resize(72, b' ');
        file.extend(write::card(&data, 'G', at + 1));
        file.push(b'\n');
    }
    let mut sink = Diagnostics::default();
    let structure = ExchangeStructure::parse(Source::new(file).expect("small"), &mut sink);
    let known = ["iges.missing-section", "iges.missing-terminate", "iges.truncated"];
    if sink.counts().keys().any(|code| !known.contains(code)) {
        return;
    }
    let written = write::file(&[""], structure.global(), &[]);
    let again = ExchangeStructure::parse(Source::new(written).expect("small"), &mut Diagnostics::default());
    assert_eq!(again.global(), structure.global());
}
