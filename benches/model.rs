//! Throughput of reading STEP from bytes to the model.
//!
//! Runs over a synthetic part of about 10 MB, or over the file that `RESURF_BENCH_FILE` names.
//!
//! * `index`: [`ExchangeStructure::parse`], which finds every section, record and name;
//! * `to_model`: from the exchange structure to bodies, faces, edges and geometry;
//! * `bytes_to_model`: both.
#![expect(missing_docs, reason = "criterion's macros make public items without documentation")]

use std::fmt::Write as _;
use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use resurf::diagnostic::Diagnostics;
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model};

/// Control points along each side of a synthetic patch.
const SIDE: usize = 12;

/// One shell of square bicubic patches, each with four straight edges of its own.
fn synthetic(megabytes: usize) -> Vec<u8> {
    let mut text = String::from(
        "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n\
         #1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
         #2=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
         #3=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#2))REPRESENTATION_CONTEXT('',''));\n",
    );
    let mut name = 10;
    let mut faces = Vec::new();
    while text.len() < megabytes << 20 {
        faces.push(format!("#{}", patch(&mut text, &mut name, faces.len())));
    }
    let _ = writeln!(text, "#4=OPEN_SHELL('',({}));", faces.join(","));
    text.push_str(
        "#5=SHELL_BASED_SURFACE_MODEL('',(#4));\n\
         #6=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#5),#3);\n\
         ENDSEC;\nEND-ISO-10303-21;\n",
    );
    text.into_bytes()
}

/// Writes the records of one face; gives its name.
fn patch(text: &mut String, next: &mut usize, index: usize) -> usize {
    let mut add = |body: &str| {
        let name = *next;
        *next += 1;
        let _ = writeln!(text, "#{name}={body};");
        name
    };
    let (step, offset) = (0.123_456_789, 20.0 * index as f64);
    let mut rows = Vec::new();
    let mut corners = [0; 4];
    for i in 0..SIDE {
        let mut row = Vec::new();
        for j in 0..SIDE {
            let (x, y) = (offset + i as f64 * step, j as f64 * step);
            let point = add(&format!("CARTESIAN_POINT('',({x:.14},{y:.14},{:.15}))", (x + y).sin()));
            row.push(format!("#{point}"));
            let corner = [(0, 0), (SIDE - 1, 0), (SIDE - 1, SIDE - 1), (0, SIDE - 1)];
            if let Some(at) = corner.iter().position(|corner| *corner == (i, j)) {
                corners[at] = point;
            }
        }
        rows.push(format!("({})", row.join(",")));
    }
    let knots = (0..=SIDE - 3).map(|knot| format!("{knot}.")).collect::<Vec<_>>().join(",");
    let multiplicities = format!("4,{}4", "1,".repeat(SIDE - 4));
    let surface = add(&format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({}),.UNSPECIFIED.,.F.,.F.,.F.,({multiplicities}),\
         ({multiplicities}),({knots}),({knots}),.UNSPECIFIED.)",
        rows.join(",")
    ));
    let vertices = corners.map(|point| (point, add(&format!("VERTEX_POINT('',#{point})"))));
    let direction = add("DIRECTION('',(1.,0.,0.))");
    let vector = add(&format!("VECTOR('',#{direction},1.)"));
    let uses: Vec<String> = (0..4)
        .map(|at| {
            let ((point, start), (_, end)) = (vertices[at], vertices[(at + 1) % 4]);
            let line = add(&format!("LINE('',#{point},#{vector})"));
            let edge = add(&format!("EDGE_CURVE('',#{start},#{end},#{line},.T.)"));
            format!("#{}", add(&format!("ORIENTED_EDGE('',*,*,#{edge},.T.)")))
        })
        .collect();
    let path = add(&format!("EDGE_LOOP('',({}))", uses.join(",")));
    let bound = add(&format!("FACE_OUTER_BOUND('',#{path},.T.)"));
    add(&format!("ADVANCED_FACE('',(#{bound}),#{surface},.T.)"))
}

fn bytes() -> Vec<u8> {
    std::env::var_os("RESURF_BENCH_FILE")
        .and_then(|path| std::fs::read(path).ok())
        .unwrap_or_else(|| synthetic(10))
}

fn model(criterion: &mut Criterion) {
    let source = Source::new(bytes()).expect("the file is smaller than 4 GiB");
    let parse = |source| ExchangeStructure::parse(source, &mut Diagnostics::default());
    let structure = parse(source.clone());
    let faces = to_model(&structure, &mut Diagnostics::default()).brep.faces.len();
    assert!(faces > 0, "a file without faces measures nothing");
    let mut group = criterion.benchmark_group("model");
    group.sample_size(10).throughput(Throughput::Bytes(source.bytes().len() as u64));
    group.bench_function("index", |b| {
        b.iter_batched(|| source.clone(), parse, BatchSize::PerIteration);
    });
    group.bench_function("to_model", |b| {
        b.iter(|| to_model(black_box(&structure), &mut Diagnostics::default()));
    });
    group.bench_function("bytes_to_model", |b| {
        b.iter_batched(
            || source.clone(),
            |source| {
                let structure = parse(source);
                let model = to_model(&structure, &mut Diagnostics::default());
                (structure, model)
            },
            BatchSize::PerIteration,
        );
    });
    group.finish();
}

criterion_group!(benches, model);
criterion_main!(benches);
