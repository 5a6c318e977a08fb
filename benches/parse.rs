//! Throughput of reading STEP against `memchr` over the same bytes.
//!
//! Runs over a synthetic file of about 20 MB, or over the file that `RESURF_BENCH_FILE` names.
//!
//! * `memchr`: a search for a byte that the file does not contain: the limit of the memory;
//! * `index`: [`ExchangeStructure::parse`], which finds every section, record and name;
//! * `parameters`: every parameter of every record read to its kind and place;
//! * `values`: the same, and every number and string decoded.
#![expect(missing_docs, reason = "criterion's macros make public items without documentation")]

use std::fmt::Write as _;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use resurf::diagnostic::Diagnostics;
use resurf::source::Source;
use resurf::step::{ExchangeStructure, Parameter, ParameterKind, Parameters};

/// Points, poles and faces in the proportions of a freeform part.
fn synthetic(megabytes: usize) -> Vec<u8> {
    let mut text =
        String::from("ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n");
    let mut name = 1;
    while text.len() < megabytes << 20 {
        let first = name;
        for point in 0..64 {
            let (x, y) = (f64::from(point) * 1.234_567, f64::from(name % 977) * 0.031_25);
            let _ = writeln!(text, "#{name}=CARTESIAN_POINT('',({x:.12},{y:.9},-1.5E-3));");
            name += 1;
        }
        let row = |r: i32| (0..8).map(|c| format!("#{}", first + 8 * r + c)).collect::<Vec<_>>().join(",");
        let rows = (0..8).map(|r| format!("({})", row(r))).collect::<Vec<_>>().join(",");
        let _ = writeln!(
            text,
            "#{name}=B_SPLINE_SURFACE_WITH_KNOTS('NONE',3,3,({rows}),\n.UNSPECIFIED.,.F.,.F.,.F.,(4,1,1,1,1,4),\
             (4,1,1,1,1,4),(0.,1.,2.,3.,4.,5.),(0.,1.,2.,3.,4.,5.),.UNSPECIFIED.);"
        );
        let _ = writeln!(text, "#{}=ADVANCED_FACE('',(#{first}),#{name},.T.);", name + 1);
        name += 2;
    }
    (text + "ENDSEC;\nEND-ISO-10303-21;\n").into_bytes()
}

fn bytes() -> Vec<u8> {
    std::env::var_os("RESURF_BENCH_FILE")
        .and_then(|path| std::fs::read(path).ok())
        .unwrap_or_else(|| synthetic(20))
}

/// Visits every parameter of every record.
fn for_each_parameter(structure: &ExchangeStructure, mut visit: impl FnMut(&Parameter<'_>)) {
    let mut open: Vec<Parameters<'_>> = Vec::new();
    for instance in structure.instances() {
        for record in instance.records() {
            open.push(record.parameters());
            while let Some(cursor) = open.last_mut() {
                let Some(parameter) = cursor.next() else {
                    open.pop();
                    continue;
                };
                visit(&parameter);
                open.extend(parameter.members());
            }
        }
    }
}

fn parse(criterion: &mut Criterion) {
    let source = Source::new(bytes()).expect("the file is smaller than 4 GiB");
    let structure = ExchangeStructure::parse(source.clone(), &mut Diagnostics::default());
    let mut group = criterion.benchmark_group("parse");
    group.sample_size(10).throughput(Throughput::Bytes(source.bytes().len() as u64));
    group.bench_function("memchr", |b| b.iter(|| memchr::memchr(0xfe, black_box(source.bytes()))));
    group.bench_function("index", |b| {
        let clone = || source.clone();
        b.iter_batched(
            clone,
            |source| ExchangeStructure::parse(source, &mut Diagnostics::default()),
            criterion::BatchSize::PerIteration,
        );
    });
    group.bench_function("parameters", |b| {
        b.iter(|| {
            let mut count = 0_usize;
            for_each_parameter(&structure, |_| count += 1);
            count
        });
    });
    group.bench_function("values", |b| {
        b.iter(|| {
            let mut sum = 0.0;
            for_each_parameter(&structure, |parameter| match parameter.kind() {
                ParameterKind::Real | ParameterKind::Integer => sum += parameter.as_f64().unwrap_or_default(),
                ParameterKind::String => sum += parameter.as_str().map_or(0.0, |text| text.len() as f64),
                _ => {}
            });
            sum
        });
    });
    group.finish();
}

criterion_group!(benches, parse);
criterion_main!(benches);
