//! Counts of the corpus files, when a corpus is at hand.
use resurf::diagnostic::Diagnostics;
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model::to_model};

#[test]
fn dump() {
    let dir = std::env::var("RESURF_CORPUS").unwrap();
    let mut files: Vec<_> = ["step", "step/s1-c5-214", "patho"]
        .iter()
        .flat_map(|d| std::fs::read_dir(format!("{dir}/{d}")).unwrap())
        .map(|e| e.unwrap().path())
        .filter(|p| p.is_file())
        .collect();
    files.sort();
    for f in files {
        let ext = f.extension().unwrap().to_str().unwrap().to_lowercase();
        if !["step", "stp", "p21", "stpz"].contains(&ext.as_str()) {
            continue;
        }
        let bytes = std::fs::read(&f).unwrap();
        let n = bytes.len();
        let mut d = Diagnostics::default();
        let t = std::time::Instant::now();
        let s = ExchangeStructure::parse(Source::new(bytes).unwrap(), &mut d);
        let t1 = t.elapsed();
        let m = to_model(&s, &mut d);
        let t2 = t.elapsed();
        let mut kinds = std::collections::BTreeMap::new();
        for (f, _) in m.brep.faces.iter() {
            let k = m.brep.surface_of(f);
            *kinds.entry(k.read().map_or("unread", |s| s.kind())).or_insert(0) += 1;
        }
        let solids = m.brep.bodies.iter().filter(|(_, b)| b.kind == resurf::brep::BodyKind::Solid).count();
        println!(
            "{}|solids {} shells {} faces {} edges {} free {} prod {} occ {}|{:?}|{:?}|{:?}|{:.0} {:.0} MB/s|{:?}",
            f.file_name().unwrap().to_str().unwrap(),
            solids,
            m.brep.shells.len(),
            m.brep.faces.len(),
            m.brep.edges.len(),
            m.free_curves.len(),
            m.products.len(),
            m.occurrences.len(),
            kinds,
            m.contexts
                .iter()
                .map(|c| format!("{} {} {:?}", c.length.name, c.angle.name, c.uncertainty.map(|u| u.0)))
                .collect::<Vec<_>>(),
            d.counts(),
            n as f64 / 1e6 / t1.as_secs_f64(),
            n as f64 / 1e6 / t2.as_secs_f64(),
            d.kept()
                .iter()
                .filter(|x| true)
                .take(2)
                .map(|x| format!("{} {}", x.entity.clone().unwrap_or_default(), x.message))
                .collect::<Vec<_>>()
        );
    }
}
