//! Tables of numbers as text: XYZ, ASC, CSV, PTS. One point a line, its first three numbers the coordinates unless a line
//! of names says otherwise.
//!
//! Separators are blanks, tabs, commas and semicolons; between semicolons a comma is a decimal comma. Lines that begin
//! with `#` or `//` are comments; the last one before the points may hold the names, as may the first line. A line with one
//! whole number before the points is a count.

use super::CloudError;
use super::point_cloud::{Collected, LabelColumn, Missing, PointCloud, check_count};
use super::table::{Columns, label};
use super::words::{Lines, number, shown};

const FORMAT: &str = "XYZ";

/// Reads the points.
///
/// # Errors
/// [`CloudError`]. A point that is not finite is an error: tables have no points that were not measured.
pub fn read(bytes: &[u8], wanted: Option<&LabelColumn>) -> Result<PointCloud, CloudError> {
    let mut names: Option<(usize, Vec<String>)> = None;
    let mut columns = None;
    let mut cloud = Collected::default();
    let mut values = Vec::new();
    for (at, line) in Lines::new(bytes) {
        let line = line.trim_ascii();
        if line.is_empty() {
            continue;
        }
        if let Some(comment) = line.strip_prefix(b"#").or_else(|| line.strip_prefix(b"//")) {
            names = names_of(comment).map(|names| (at, names)).or(names);
            continue;
        }
        let comma = decimal_comma(line);
        values.clear();
        values.extend(cells(line, comma).map_while(|cell| cell_number(cell, comma)));
        if columns.is_none() {
            if values.is_empty() {
                let found = names_of(line).filter(|_| cloud.points.is_empty());
                names = Some((at, found.ok_or_else(|| row(at, line, "is no point"))?));
                continue;
            }
            let alone = cells(line, comma).count() == 1;
            if alone && values[0] >= 0.0 && values[0].fract() == 0.0 {
                continue;
            }
            columns = Some(columns_of(names.as_ref(), values.len(), wanted)?);
            let with_label = columns.and_then(|c: Columns| c.label);
            cloud = Collected::with_room(bytes.len() / line.len().max(6), with_label);
        }
        let Some(columns) = columns else { continue };
        if values.len() <= columns.last() {
            return Err(row(at, line, "lacks numbers"));
        }
        let point = columns.coordinates.map(|k| values[k]);
        let label = columns.label.map(|k| values[k]);
        cloud.push(FORMAT, || format!("line {at}"), (point, label), Missing::Refuse)?;
    }
    check_count(FORMAT, cloud.points.len() as u64)?;
    cloud.points.shrink_to_fit();
    cloud.finish()
}

fn row(at: usize, line: &[u8], what: &str) -> CloudError {
    CloudError::Row {
        format: FORMAT,
        place: format!("line {at}"),
        reason: format!("`{}` {what}", shown(line)),
    }
}

/// Whether a comma in the line belongs to a number.
fn decimal_comma(line: &[u8]) -> bool {
    line.contains(&b';') && line.contains(&b',')
}

fn cells(line: &[u8], decimal_comma: bool) -> impl Iterator<Item = &[u8]> {
    let separates = move |b: &u8| b.is_ascii_whitespace() || *b == b';' || (*b == b',' && !decimal_comma);
    line.split(separates).filter(|cell| !cell.is_empty())
}

fn cell_number(cell: &[u8], decimal_comma: bool) -> Option<f64> {
    if decimal_comma && cell.contains(&b',') {
        let dotted: Vec<u8> = cell.iter().map(|b| if *b == b',' { b'.' } else { *b }).collect();
        return number(&dotted);
    }
    number(cell)
}

/// Names of columns, when they hold those of the coordinates.
fn names_of(line: &[u8]) -> Option<Vec<String>> {
    let plain = |cell: &[u8]| shown(cell).trim_matches(['"', '\'', '(', ')', '[', ']']).to_ascii_lowercase();
    let names: Vec<String> = cells(line, false).map(plain).collect();
    ["x", "y", "z"].iter().all(|c| names.iter().any(|n| n == c)).then_some(names)
}

fn columns_of(
    names: Option<&(usize, Vec<String>)>,
    count: usize,
    wanted: Option<&LabelColumn>,
) -> Result<Columns, CloudError> {
    if let Some((line, names)) = names {
        return Columns::of(FORMAT, *line, names, wanted);
    }
    let numbers: Vec<String> = (1..=count).map(|k| k.to_string()).collect();
    let label = wanted.map(|wanted| label(FORMAT, &numbers, wanted)).transpose()?;
    Ok(Columns { coordinates: [0, 1, 2], label })
}
