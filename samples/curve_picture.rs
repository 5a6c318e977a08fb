//! Draws free curves as SVG, one cell for each target: `cargo run --example make-curve-picture -- OUT.svg COLUMNS
//! BEFORE.step AFTER.step …`.
//!
//! `docs/detail-transfer.svg` is the nine transfers of `samples/curves`.

use std::fmt::Write as _;
use std::process::ExitCode;

use resurf::diagnostic::Diagnostics;
use resurf::document::Document;

/// Points along a curve.
const POINTS: u32 = 600;
/// Size of a cell and its margin, in pixels.
const CELL: [f64; 3] = [300.0, 220.0, 20.0];

/// The free curves of a file seen from above and a little from the front.
fn curves(path: &str) -> Result<Vec<Vec<[f64; 2]>>, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
    let mut diagnostics = Diagnostics::default();
    let document =
        Document::open(bytes, "step", &mut diagnostics).map_err(|error| format!("{path}: {error}"))?;
    let model = document.model(&mut diagnostics);
    let read = model.free_curves.iter().filter_map(|&curve| model.brep.curves[curve].read());
    let line = |curve: &resurf::geometry::Curve| {
        let (start, end) = curve.domain();
        let at = |i: u32| curve.point_at(start + (end - start) * f64::from(i) / f64::from(POINTS));
        (0..=POINTS)
            .map(|i| {
                let p = at(i);
                [p.x + 0.3 * p.z, -p.y - 0.4 * p.z]
            })
            .collect()
    };
    Ok(read.map(line).collect())
}

fn draw(arguments: &[String]) -> Result<(), String> {
    let [out, columns, files @ ..] = arguments else {
        return Err("expected OUT.svg COLUMNS FILES".to_owned());
    };
    let columns: usize = columns.parse().map_err(|_| format!("{columns} is no number of columns"))?;
    let [width, height, margin] = CELL;
    let mut body = String::new();
    for (at, pair) in files.chunks(2).enumerate() {
        let drawn = pair.iter().map(|path| curves(path)).collect::<Result<Vec<_>, _>>()?;
        let all = || drawn.iter().flatten().flatten();
        let least = |k: usize| all().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let extent = |k: usize| all().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max) - least(k);
        let scale = ((width - 2.0 * margin) / extent(0)).min((height - 2.0 * margin) / extent(1));
        let corner = [(at % columns) as f64 * width + margin, (at / columns) as f64 * height + margin];
        for (lines, style) in drawn.iter().zip(["#999\" stroke-dasharray=\"5 4", "#c22"]) {
            for line in lines {
                let place = |p: &[f64; 2], k: usize| corner[k] + (p[k] - least(k)) * scale;
                let points: Vec<String> =
                    line.iter().map(|p| format!("{:.1},{:.1}", place(p, 0), place(p, 1))).collect();
                let _ = writeln!(
                    body,
                    "<polyline fill=\"none\" stroke=\"{style}\" points=\"{}\"/>",
                    points.join(" ")
                );
            }
        }
    }
    let rows = files.len().div_ceil(2).div_ceil(columns.max(1));
    let (w, h) = (columns as f64 * width, rows as f64 * height);
    let head =
        format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" stroke-width=\"1.5\">");
    let white = format!("<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>");
    std::fs::write(out, format!("{head}\n{white}\n{body}</svg>\n")).map_err(|error| format!("{out}: {error}"))
}

#[expect(clippy::print_stderr, reason = "a program of its own")]
fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match draw(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
