use super::*;

/// The graph of `z = height(x)` over the square [-1, 1]², with its exact normals.
fn sheet(count: u32, height: impl Fn(f64) -> (f64, f64)) -> Mesh {
    let mut mesh = Mesh::default();
    let at = |k: u32| 2.0 * f64::from(k) / f64::from(count) - 1.0;
    for j in 0..=count {
        mesh.vertices.extend((0..=count).map(|i| Point3::new(at(i), at(j), height(at(i)).0)));
    }
    for j in 0..count {
        for i in 0..count {
            let k = j * (count + 1) + i;
            mesh.triangles.extend([[k, k + 1, k + count + 2], [k, k + count + 2, k + count + 1]]);
        }
    }
    let normal = |k: u32| Vector3::new(-height(mesh.vertices[k as usize].x).1, 0.0, 1.0).normalize();
    mesh.normals = mesh.triangles.iter().map(|corners| corners.map(normal)).collect();
    mesh
}

fn from_above(width: u32, bands: f64) -> PictureOptions {
    PictureOptions { width, bands, eye: Vector3::z(), ..PictureOptions::default() }
}

fn pixels(png: &[u8]) -> tiny_skia::Pixmap {
    tiny_skia::Pixmap::decode_png(png).expect("a PNG")
}

/// Changes between dark and light along the middle row.
fn changes(pixmap: &tiny_skia::Pixmap, from: u32, to: u32) -> usize {
    let row = pixmap.height() / 2;
    let dark = |x| pixmap.pixel(x, row).is_some_and(|p| p.green() < 128);
    (from..to).filter(|&x| dark(x) != dark(x + 1)).count()
}

#[test]
fn a_flat_sheet_shows_evenly_spaced_bands() {
    let flat = sheet(4, |_| (0.0, 0.0));
    let picture =
        pixels(&highlight_lines(&[View { mesh: &flat }], &from_above(400, 10.0)).expect("a picture"));
    // Ten pairs of bands across the sheet from column 9 to 391, a dark band's middle in the centre: nine whole
    // dark bands with two changes each, and one change to the half band at each end.
    assert_eq!(changes(&picture, 13, 387), 20);
}

#[test]
fn a_dome_under_high_lights_shows_the_slope() {
    // z = -a x²/2, so the prolonged normal meets the plane at x + (height - z) a x: with lights a diagonal
    // of d above the top, lines stand 1 + a d times closer near the middle.
    let a = 0.5;
    let dome = sheet(64, |x| (-0.5 * a * x * x, -a * x));
    let picture =
        pixels(&highlight_lines(&[View { mesh: &dome }], &from_above(600, 8.0)).expect("a picture"));
    let d = dome.extents().expect("vertices").diagonal();
    let reach = |x: f64| (x + (d + 0.5 * a * x * x) * a * x) / (2.0 / 8.0);
    // Dark bands in the visible part: those whose middle k has |k| <= reach, with half a band's width.
    let edges = (0..100).filter(|&k| f64::from(k) - 0.23 < reach(0.97)).count()
        + (0..100).filter(|&k| f64::from(k) + 0.23 < reach(0.97)).count();
    let (left, right) = (300 - 283, 300 + 277);
    let found = changes(&picture, left + 3, right - 3);
    assert!(found.abs_diff(2 * edges - 2) <= 4, "{found} changes, {edges} expected a side");
}

#[test]
fn views_share_one_scale_and_the_background_is_white() {
    let [small, mut large] = [sheet(2, |_| (0.0, 0.0)), sheet(2, |_| (0.0, 0.0))];
    large.vertices.iter_mut().for_each(|p| *p *= 2.0);
    let views = [View { mesh: &small }, View { mesh: &large }];
    let picture = pixels(&highlight_lines(&views, &from_above(640, 8.0)).expect("a picture"));
    let covered = |x: u32| {
        (0..picture.height()).filter(|&y| picture.pixel(x, y).is_some_and(|p| p.green() < 250)).count()
    };
    let columns: Vec<usize> = (0..picture.width()).map(covered).collect();
    assert_eq!((columns[0], columns[639]), (0, 0));
    let tallest = |range: std::ops::Range<usize>| columns[range].iter().copied().max().unwrap_or(0);
    let ratio = tallest(300..640) as f64 / tallest(0..200) as f64;
    assert!((ratio - 2.0).abs() < 0.1, "{ratio}");
}

#[test]
fn nothing_and_nonsense_are_refused() {
    assert_eq!(highlight_lines(&[], &PictureOptions::default()), Err(PictureError::Empty));
    let empty = Mesh::default();
    assert_eq!(
        highlight_lines(&[View { mesh: &empty }], &PictureOptions::default()),
        Err(PictureError::Empty)
    );
    let mut broken = sheet(2, |_| (0.0, 0.0));
    broken.vertices[0].x = f64::NAN;
    let error = highlight_lines(&[View { mesh: &broken }], &PictureOptions::default());
    assert_eq!(error, Err(PictureError::UnsoundMesh { view: 0 }));
    let flat = sheet(2, |_| (0.0, 0.0));
    let options = PictureOptions { eye: Vector3::y(), ..PictureOptions::default() };
    assert!(matches!(
        highlight_lines(&[View { mesh: &flat }], &options),
        Err(PictureError::Directions { .. })
    ));
    let options = from_above(100_000, 8.0);
    assert!(matches!(highlight_lines(&[View { mesh: &flat }], &options), Err(PictureError::Size { .. })));
}

#[test]
fn the_same_views_give_the_same_bytes() {
    let dome = sheet(16, |x| (-0.2 * x * x, -0.4 * x));
    let draw = || highlight_lines(&[View { mesh: &dome }], &from_above(200, 8.0));
    assert_eq!(draw(), draw());
}

#[test]
fn a_field_is_blue_below_zero_red_above_and_grey_between() {
    let flat = sheet(40, |_| (0.0, 0.0));
    let values: Vec<f64> = flat.vertices.iter().map(|p| 2.0 * p.x).collect();
    let picture = field(&[FieldView { mesh: &flat, values: &values, full: 1.0 }], &from_above(300, 10.0))
        .expect("a picture");
    let pixmap = pixels(&picture);
    let row = pixmap.height() / 2;
    let colour = |x: u32| pixmap.pixel(x, row).map(|p| (p.red(), p.blue())).expect("inside");
    let (left, middle, right) = (colour(40), colour(150), colour(260));
    assert!(left.1 > left.0 + 60 && right.0 > right.1 + 60, "{left:?} {right:?}");
    assert!(middle.0.abs_diff(middle.1) < 12, "{middle:?}");
}

#[test]
fn a_field_wants_a_value_for_each_vertex() {
    let flat = sheet(2, |_| (0.0, 0.0));
    let few = field(&[FieldView { mesh: &flat, values: &[0.0], full: 1.0 }], &from_above(300, 10.0));
    assert_eq!(few, Err(PictureError::UnsoundMesh { view: 0 }));
}
