// Body of the fuzz target `p21_edit_locality`, also run over the seeds by the ordinary tests: removing some records
// and adding one changes nothing else, and every record that stays reads as before.

pub fn p21_edit_locality(bytes: &[u8]) {
    use resurf::diagnostic::Diagnostics;
    use resurf::exchange::{NameAllocator, Patch};
    use resurf::source::{LineEnding, Source};
    use resurf::step::{ExchangeStructure, InstanceName, edit, write::RecordWriter};

    // The first byte chooses what goes; the rest is the file.
    let Some((choice, file)) = bytes.split_first() else { return };
    let Ok(source) = Source::new(file.to_vec()) else { return };
    let mut sink = Diagnostics::default();
    let structure = ExchangeStructure::parse(source, &mut sink);
    // Where the reader had to guess, a patch may move what it guesses; callers refuse such files.
    if sink.worst().is_some() {
        return;
    }
    let goes = |position: u32| position % 8 == u32::from(choice % 8);
    let removed = edit::remove(&structure, (0..structure.len()).filter(|&position| goes(position)));
    let mut names = NameAllocator::above(structure.greatest_name().map(|name| name.0));
    let Ok(fresh) = names.allocate() else { return };
    let mut record = RecordWriter::instance(InstanceName(fresh), LineEnding::of(file));
    record.open("CARTESIAN_POINT").string("").reals([1.0, 2.0, 3.0]).close();
    let Some(added) = edit::append(&structure, vec![record.finish()]) else { return };

    let edits = removed.into_iter().chain(added).collect();
    let patch = Patch::new(file.len(), edits).expect("records do not overlap");
    let patched = ExchangeStructure::parse(Source::new(patch.apply(file)).expect("small"), &mut sink);
    assert!(sink.worst().is_none(), "the patched file reads worse: {:?}", sink.kept().first());

    let stay = structure.instances().filter(|instance| !goes(instance.position()));
    let before: Vec<&[u8]> = stay.map(|instance| instance.text()).collect();
    let after: Vec<&[u8]> = patched.instances().map(|instance| instance.text()).collect();
    assert_eq!(after.len(), before.len() + 1, "one record was added");
    assert!(before == after[..before.len()], "a record that stays has changed");
    assert_eq!(patched.greatest_name(), Some(InstanceName(fresh)));
}
