//! Readers of clouds: forms of one cloud that must agree, files of the corpus against figures of other programs, and
//! damage, which must be told in bounded time and memory.

use crate::support;
use proptest::prelude::*;
use resurf::cloud::{CloudError, LabelColumn, PointCloud};
use resurf::document::cloud::{CloudFileError, read};
use resurf::math::Point3;
use std::fmt::Write;

/// Files of the corpus: count of points, least and greatest coordinates.
const CORPUS: [(&str, usize, [f64; 3], [f64; 3]); 7] = [
    ("ubend2.ply", 8055, [-4.0, -0.39968, -5.99986], [55.9968, 41.4972, 4.0]),
    ("ANC101.ply", 12608, [0.0, 0.0, 0.0], [0.42625, 0.2015, 0.190545]),
    ("featuretype.ply", 5096, [-2.5, -1.25, 0.0], [2.5, 1.25, 1.375]),
    ("sampled-surf_03.xyz", 30595, [517.517, -22.209, -42.3687], [614.063, 1.90952, 31.8824]),
    (
        "wavy_mesh_with_hole.ply",
        757,
        [0.0, 0.0, -3.738_570_928_573_608_4],
        [10.5, 10.5, 0.312_626_123_428_344_7],
    ),
    (
        "region_growing_tutorial.pcd",
        108_104,
        [-3_838.340_087_890_625, 4_065.570_068_359_375, 12_775.759_765_625],
        [1_366.670_043_945_312_5, 11_727.049_804_687_5, 14_681.129_882_812_5],
    ),
    ("bunnyInt32.e57", 30571, [-0.094689, 0.040011, -0.061873], [0.061009, 0.187321, 0.058799]),
];

/// Points whose coordinates single precision holds exactly, with labels.
fn points() -> Vec<([f64; 3], u8)> {
    (0..57)
        .map(|k| {
            let t = f64::from(k);
            ([0.5 * t - 7.0, 0.25 * t * t, 100.0 - 1.125 * t], (k % 3) as u8)
        })
        .collect()
}

fn is_expected(cloud: &PointCloud, labelled: bool) {
    let expected = points();
    assert_eq!(cloud.points().len(), expected.len());
    for (found, (point, _)) in cloud.points().iter().zip(&expected) {
        assert_eq!(*found, Point3::from(*point));
    }
    let labels = expected.iter().map(|(_, l)| i64::from(*l)).collect::<Vec<_>>();
    assert_eq!(cloud.labels(), labelled.then_some(&labels[..]));
}

fn label(name: &str) -> LabelColumn {
    LabelColumn::Named(name.to_owned())
}

/// A PLY file with elements before and after the vertices, and properties that nobody asked for.
fn ply(encoding: &str, coordinate: &str) -> Vec<u8> {
    let count = points().len();
    let mut out = format!(
        "ply\r\nformat {encoding} 1.0\r\ncomment caf\u{e9}\r\nelement camera 1\nproperty list uchar short view\nproperty int8 id\n\
         element vertex {count}\nproperty {coordinate} x\nproperty uchar scalar_Label\nproperty {coordinate} y\n\
         property {coordinate} z\nproperty list uchar int faces\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    let big = encoding == "binary_big_endian";
    let number = |kind: &str, value: f64| -> Vec<u8> {
        macro_rules! bytes {
            ($t:ty) => {
                if big { (value as $t).to_be_bytes().to_vec() } else { (value as $t).to_le_bytes().to_vec() }
            };
        }
        match kind {
            "float" => bytes!(f32),
            "double" => bytes!(f64),
            "short" => bytes!(i16),
            "int" => bytes!(i32),
            _ => bytes!(u8),
        }
    };
    if encoding == "ascii" {
        out.extend(b"2 7 8 1\n");
        for (k, ([x, y, z], l)) in points().into_iter().enumerate() {
            let faces = if k % 2 == 0 { "1 9" } else { "0" };
            out.extend(format!("{x} {l} {y:e} {z} {faces}\n").bytes());
        }
        out.extend(b"3 0 1 2\n");
        return out;
    }
    out.extend(
        [number("uchar", 2.0), number("short", 7.0), number("short", 8.0), number("uchar", 1.0)].concat(),
    );
    for (k, ([x, y, z], l)) in points().into_iter().enumerate() {
        let faces = if k % 2 == 0 { [number("uchar", 1.0), number("int", 9.0)].concat() } else { vec![0] };
        let c = |v| number(coordinate, v);
        out.extend([c(x), vec![l], c(y), c(z), faces].concat());
    }
    out.extend([number("uchar", 3.0), number("int", 0.0), number("int", 1.0), number("int", 2.0)].concat());
    out
}

#[test]
fn ply_in_all_its_forms_is_one_cloud() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for coordinate in ["float", "double"] {
            let bytes = ply(encoding, coordinate);
            is_expected(&read(&bytes, "ply", None).unwrap().cloud, false);
            is_expected(&read(&bytes, "", Some(&label("label"))).unwrap().cloud, true);
        }
    }
}

/// A PCD file; compressed data are literal runs, which is legal LZF.
fn pcd(data: &str) -> Vec<u8> {
    let all = points();
    let mut out = format!(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y label z extra\nSIZE 4 8 1 4 2\nTYPE F F U F I\nCOUNT 1 1 1 1 3\n\
         WIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {data}\n",
        all.len(),
        all.len()
    )
    .into_bytes();
    let fields = |&([x, y, z], l): &([f64; 3], u8)| {
        let extra = [1_i16, -2, 3].map(i16::to_le_bytes).concat();
        [
            (x as f32).to_le_bytes().to_vec(),
            y.to_le_bytes().to_vec(),
            vec![l],
            (z as f32).to_le_bytes().to_vec(),
            extra,
        ]
    };
    match data {
        "ascii" => {
            for ([x, y, z], l) in all {
                out.extend(format!("{x} {y} {l} {z} 1 -2 3\n").bytes());
            }
        }
        "binary" => all.iter().for_each(|p| out.extend(fields(p).concat())),
        _ => {
            let plain: Vec<u8> =
                (0..5).flat_map(|f| all.iter().flat_map(move |p| fields(p)[f].clone())).collect();
            let packed: Vec<u8> =
                plain.chunks(32).flat_map(|run| [&[run.len() as u8 - 1], run].concat()).collect();
            out.extend((packed.len() as u32).to_le_bytes());
            out.extend((plain.len() as u32).to_le_bytes());
            out.extend(packed);
        }
    }
    out
}

#[test]
fn pcd_in_all_its_forms_is_one_cloud() {
    for data in ["ascii", "binary", "binary_compressed"] {
        is_expected(&read(&pcd(data), "pcd", None).unwrap().cloud, false);
        is_expected(&read(&pcd(data), "", Some(&label("LABEL"))).unwrap().cloud, true);
    }
}

#[test]
fn tables_of_every_dialect_are_one_cloud() {
    let table = |head: &str, row: &dyn Fn([f64; 3], u8) -> String| {
        points().into_iter().fold(head.to_owned(), |mut text, (p, l)| {
            let _ = writeln!(text, "{}", row(p, l));
            text
        })
    };
    let comma = |v: f64| v.to_string().replace('.', ",");
    let texts = [
        table("", &|[x, y, z], l| format!("{x} {y} {z} {l}")),
        table("\u{feff}# made by hand\n\n", &|[x, y, z], l| format!("  {x}\t{y}\t{z}\t{l}\r")),
        table("57\n", &|[x, y, z], l| format!("{x},{y},{z},{l}")),
        table("", &|[x, y, z], l| format!("{};{};{};{l}", comma(x), comma(y), comma(z))),
    ];
    for text in &texts {
        is_expected(&read(text.as_bytes(), "XYZ", None).unwrap().cloud, false);
        let fourth = LabelColumn::Numbered(4);
        is_expected(&read(text.as_bytes(), "asc", Some(&fourth)).unwrap().cloud, true);
    }
    let named = [
        table("//X Y Scalar_Class Z\n", &|[x, y, z], l| format!("{x} {y} {l} {z}")),
        table("\"x\",\"y\",\"class\",\"z\"\n", &|[x, y, z], l| format!("{x},{y},{l},{z}")),
    ];
    for text in &named {
        is_expected(&read(text.as_bytes(), "csv", None).unwrap().cloud, false);
        is_expected(&read(text.as_bytes(), "csv", Some(&label("class"))).unwrap().cloud, true);
    }
}

#[test]
fn vertices_of_meshes_are_clouds() {
    let mut obj = "# box\nmtllib a.mtl\no thing\n".to_owned();
    for ([x, y, z], _) in points() {
        let _ = writeln!(obj, "v {x} {y} {z} 1.0\nvn 0 0 1");
    }
    obj += "f 1 2 3\n";
    is_expected(&read(obj.as_bytes(), "obj", None).unwrap().cloud, false);
    let mut stl = "solid cloud\n".to_owned();
    for three in points().chunks_exact(3) {
        stl += "facet normal 0 0 1\nouter loop\n";
        for ([x, y, z], _) in three {
            let _ = writeln!(stl, "vertex {x} {y} {z}");
        }
        stl += "endloop\nendfacet\n";
    }
    is_expected(&read(stl.as_bytes(), "stl", None).unwrap().cloud, false);
    for (bytes, extension) in [(obj.as_bytes(), "obj"), (stl.as_bytes(), "stl")] {
        assert!(matches!(
            read(bytes, extension, Some(&label("label"))),
            Err(CloudFileError::NoLabels { .. })
        ));
    }
}

/// Counts and boxes by a reader in another language, of the E57 from its own header.
#[test]
fn files_of_the_corpus_have_the_points_that_others_find() {
    let Some(corpus) = support::corpus() else { return };
    for (name, count, low, high) in CORPUS {
        let path = corpus.join("cloud").join(name);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap();
        let file = read(&std::fs::read(&path).unwrap(), extension, None).unwrap();
        let bounds = file.cloud.bounds();
        assert_eq!(file.cloud.points().len(), count, "{name}");
        for k in 0..3 {
            let slack = 1e-12 * bounds.diagonal();
            assert!((bounds.min[k] - low[k]).abs() <= slack, "{name}: {}", bounds.min);
            assert!((bounds.max[k] - high[k]).abs() <= slack, "{name}: {}", bounds.max);
        }
        assert_eq!(file.metres.is_some(), extension == "e57");
    }
}

fn error(bytes: &[u8], extension: &str) -> CloudError {
    match read(bytes, extension, None) {
        Err(CloudFileError::Cloud(error)) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn damage_is_named_with_its_place() {
    let text = |name: &str, text: &str| error(text.as_bytes(), name).to_string();
    assert_eq!(text("xyz", "1 2 3\n4 5\n"), "XYZ, line 2: `4 5` lacks numbers");
    assert_eq!(text("xyz", "1 2 3\n4 nan 6\n"), "XYZ, line 2: a coordinate is not a finite number");
    assert_eq!(text("csv", "a,b,c\n1,2,3\n"), "XYZ, line 1: `a,b,c` is no point");
    assert_eq!(text("xyz", "# nothing\n"), "the cloud is empty");
    assert_eq!(text("obj", "f 1 2 3\n"), "the cloud is empty");
    assert_eq!(text("obj", "v 1 2\n"), "OBJ, line 1: `v 1 2` lacks numbers");
    let head = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    assert_eq!(
        text("ply", &format!("{head}1 2 3\n")),
        "PLY: the header promises 2 points, and the file ends after 1"
    );
    assert_eq!(text("ply", &format!("{head}1 2 3\n1 x 3\n")), "PLY, line 9: `1 x 3` lacks numbers");
    assert_eq!(
        text("ply", &format!("{head}1 2 3\n1 inf 3\n")),
        "PLY, line 9: a coordinate is not a finite number"
    );
    assert_eq!(
        text("ply", "ply\nformat ascii 1.0\nelement face 1\nend_header\n"),
        "PLY header, line 4: no element `vertex`"
    );
    assert_eq!(text("ply", "ply\nformat best 1.0\n"), "PLY header, line 2: format `best` is not known");
    assert_eq!(text("ply", "ply\nformat ascii 1.0\n"), "PLY header, line 2: no line `end_header`");
    assert_eq!(text("ply", "solid x\n"), "PLY header, line 1: the first line is not `ply`");
    assert_eq!(
        text("pcd", "VERSION 0.7\nFIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
        "PCD header, line 6: FIELDS, SIZE, TYPE and COUNT differ in length or are missing"
    );
    let missing = read(&ply("ascii", "float"), "ply", Some(&label("kind"))).unwrap_err().to_string();
    assert_eq!(missing, "PLY: no column `kind` for labels; there are x, scalar_Label, y, z, faces");
    assert!(matches!(read(b"1 2 3", "doc", None), Err(CloudFileError::Unknown { .. })));
    let halves = read(b"1 2 3 0.5\n", "xyz", Some(&LabelColumn::Numbered(4))).unwrap_err().to_string();
    assert_eq!(halves, "XYZ, line 1: the label 0.5 is not a whole number");
}

/// Points that were not measured are NaN in PCD: they are counted, not refused and not kept.
#[test]
fn missing_points_of_an_organised_cloud_are_counted() {
    let text = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 2\nPOINTS 4\nDATA ascii\n\
                1 2 3\nnan nan nan\n4 5 6\nnan nan nan\n";
    let cloud = read(text.as_bytes(), "pcd", None).unwrap().cloud;
    assert_eq!((cloud.points().len(), cloud.missing()), (2, 2));
}

/// Headers that promise the moon must fail at once: a test that asked for the memory would not come back.
#[test]
fn absurd_counts_take_no_memory() {
    for count in ["4000000000", "18446744073709551615"] {
        let ply = |format: &str| {
            format!(
                "ply\nformat {format} 1.0\nelement vertex {count}\nproperty double x\nproperty double y\nproperty double z\n\
                 end_header\n1 2 3\n"
            )
        };
        for format in ["ascii", "binary_little_endian"] {
            let found = error(ply(format).as_bytes(), "ply");
            assert!(matches!(found, CloudError::Truncated { .. } | CloudError::TooMany { .. }), "{found}");
        }
        for data in ["ascii", "binary", "binary_compressed"] {
            let text = format!(
                "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS {count}\nDATA {data}\n0123456789abcdef"
            );
            let found = read(text.as_bytes(), "pcd", None);
            assert!(found.is_err(), "{data}");
        }
    }
    let wide = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 99999999999\nPOINTS 2\nDATA binary\n12345678";
    assert!(matches!(error(wide.as_bytes(), "pcd"), CloudError::Header { line: 7, .. }));
}

/// The files to be damaged, with their extensions.
fn whole_files() -> Vec<(Vec<u8>, &'static str)> {
    let mut files = vec![
        (ply("ascii", "float"), "ply"),
        (ply("binary_little_endian", "double"), "ply"),
        (ply("binary_big_endian", "float"), "ply"),
        (pcd("ascii"), "pcd"),
        (pcd("binary"), "pcd"),
        (pcd("binary_compressed"), "pcd"),
    ];
    // Two pages of the format: what is cut off behind them is the rest of the header's promise.
    if let Some(corpus) = support::corpus() {
        let e57 = std::fs::read(corpus.join("cloud/bunnyInt32.e57")).unwrap();
        files.push((e57, "e57"));
    }
    files
}

#[test]
fn a_file_cut_short_is_refused_wherever_it_is_cut() {
    for (bytes, extension) in whole_files() {
        let steps = (bytes.len() / 400).max(1);
        // What comes behind the vertices in PLY is not read.
        let end = if extension == "ply" { bytes.len() - 14 } else { bytes.len() };
        for length in (0..end).step_by(steps) {
            let found = read(&bytes[..length], extension, None);
            // A text that ends within its last number is a text with another number.
            let last =
                bytes.len() - length < 12 && (bytes.starts_with(b"# .PCD") || bytes.starts_with(b"ply"));
            assert!(found.is_err() || last, "{extension} cut at {length} of {}", bytes.len());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Any damage gives points or an error, never a panic, and never more points than there were bytes.
    #[test]
    fn damaged_bytes_never_panic(file in 0_usize..7, places in prop::collection::vec((0.0..1.0_f64, any::<u8>()), 1..6)) {
        let files = whole_files();
        let (mut bytes, extension) = files[file % files.len()].clone();
        for (place, value) in places {
            // Half of the damage goes into the header.
            let reach = if value % 2 == 0 { bytes.len().min(600) } else { bytes.len() };
            let at = (place * reach as f64) as usize;
            bytes[at] = value;
        }
        if let Ok(file) = read(&bytes, extension, None) {
            prop_assert!(file.cloud.points().len() <= bytes.len());
            prop_assert!(file.cloud.points().iter().all(|p| p.iter().all(|c| c.is_finite())));
        }
    }
}
