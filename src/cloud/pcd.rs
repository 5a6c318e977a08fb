//! PCD, the format of the Point Cloud Library, version 0.7: text, binary, and compressed by LZF field by field.
//!
//! Points of an organised cloud that were not measured are NaN: they are left out and counted. The viewpoint, which says
//! where the scanner stood, is not applied, as other readers do not.

use super::point_cloud::{Collected, LabelColumn, Missing, PointCloud, check_count};
use super::table::{Columns, Endian, Scalar};
use super::words::{Lines, number, shown, words};
use super::{CloudError, lzf};

const FORMAT: &str = "PCD";

/// Whether bytes begin as PCD does: comments, then a version.
#[must_use]
pub fn is_pcd(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(4096)];
    let first =
        Lines::new(start).map(|(_, line)| line.trim_ascii()).find(|l| !l.is_empty() && !l.starts_with(b"#"));
    first.is_some_and(|line| words(line).next() == Some(b"VERSION"))
}

/// Reads the points.
///
/// # Errors
/// [`CloudError`].
pub fn read(bytes: &[u8], label: Option<&LabelColumn>) -> Result<PointCloud, CloudError> {
    let header = Header::read(bytes)?;
    let columns = header.columns(label)?;
    match header.data {
        Data::Text => text(&header, columns),
        Data::Binary => rows(&header, columns, header.body),
        Data::Compressed => compressed(&header, columns),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Data {
    Text,
    Binary,
    Compressed,
}

#[derive(Debug, Clone)]
struct Field {
    name: String,
    kind: Scalar,
    count: usize,
    /// Bytes before it in a record.
    offset: usize,
    /// Numbers before it in a line.
    place: usize,
}

struct Header<'a> {
    fields: Vec<Field>,
    points: u64,
    data: Data,
    body: &'a [u8],
    lines: usize,
}

fn fault(line: usize, reason: impl Into<String>) -> CloudError {
    CloudError::Header { format: FORMAT, line, reason: reason.into() }
}

/// What the header's lines say, as words.
#[derive(Default)]
struct Said<'a> {
    fields: Vec<&'a [u8]>,
    sizes: Vec<&'a [u8]>,
    kinds: Vec<&'a [u8]>,
    counts: Vec<&'a [u8]>,
    width: Option<u64>,
    height: Option<u64>,
    points: Option<u64>,
}

impl<'a> Header<'a> {
    fn read(bytes: &'a [u8]) -> Result<Self, CloudError> {
        let mut lines = Lines::new(bytes);
        let mut said = Said::default();
        while let Some((at, line)) = lines.next() {
            let line = line.trim_ascii();
            if line.is_empty() || line.starts_with(b"#") {
                continue;
            }
            let mut all = words(line);
            let key = all.next().unwrap_or_default();
            let values: Vec<&[u8]> = all.collect();
            let count =
                || whole(&values).ok_or_else(|| fault(at, format!("`{}` gives no count", shown(line))));
            match key {
                b"VERSION" | b"VIEWPOINT" => {}
                b"FIELDS" => said.fields = values,
                b"SIZE" => said.sizes = values,
                b"TYPE" => said.kinds = values,
                b"COUNT" => said.counts = values,
                b"WIDTH" => said.width = Some(count()?),
                b"HEIGHT" => said.height = Some(count()?),
                b"POINTS" => said.points = Some(count()?),
                b"DATA" => {
                    let data = match values[..] {
                        [b"ascii"] => Data::Text,
                        [b"binary"] => Data::Binary,
                        [b"binary_compressed"] => Data::Compressed,
                        _ => return Err(fault(at, format!("`{}` is not known", shown(line)))),
                    };
                    let (fields, points) = (said.fields(at)?, said.points(at)?);
                    return Ok(Self { fields, points, data, body: lines.rest(), lines: at });
                }
                _ => return Err(fault(at, format!("`{}` is not understood", shown(line)))),
            }
        }
        Err(fault(lines.number(), "no line `DATA`"))
    }

    /// Columns as indices of fields.
    fn columns(&self, label: Option<&LabelColumn>) -> Result<Columns, CloudError> {
        let names: Vec<String> = self.fields.iter().map(|f| f.name.clone()).collect();
        Columns::of(FORMAT, self.lines, &names, label)
    }

    /// Bytes of a record.
    fn record(&self) -> usize {
        self.fields.last().map_or(0, |f| f.offset + f.kind.size() * f.count)
    }

    /// Numbers of a line.
    fn numbers(&self) -> usize {
        self.fields.last().map_or(0, |f| f.place + f.count)
    }

    fn truncated(&self, found: u64) -> CloudError {
        CloudError::Truncated { format: FORMAT, expected: self.points, found }
    }
}

fn whole(values: &[&[u8]]) -> Option<u64> {
    let [word] = values else { return None };
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Most numbers of a field; histograms of features have hundreds.
const LONGEST_FIELD: u64 = 1 << 20;

impl Said<'_> {
    fn fields(&self, line: usize) -> Result<Vec<Field>, CloudError> {
        let n = self.fields.len();
        let fits = self.sizes.len() == n && self.kinds.len() == n && [0, n].contains(&self.counts.len());
        if n == 0 || !fits {
            return Err(fault(line, "FIELDS, SIZE, TYPE and COUNT differ in length or are missing"));
        }
        let (mut offset, mut place) = (0, 0);
        let mut fields = Vec::with_capacity(n);
        for k in 0..n {
            let count = self.counts.get(k).map_or(Some(1), |word| whole(&[*word]));
            let count = count.filter(|c| *c <= LONGEST_FIELD);
            let count =
                count.ok_or_else(|| fault(line, format!("COUNT of field {} is no count", k + 1)))? as usize;
            let kind = kind(self.kinds[k], self.sizes[k]).ok_or_else(|| {
                let (kind, size) = (shown(self.kinds[k]), shown(self.sizes[k]));
                fault(line, format!("a field of type {kind} and size {size} is not known"))
            })?;
            fields.push(Field { name: shown(self.fields[k]), kind, count, offset, place });
            offset += count * kind.size();
            place += count;
        }
        Ok(fields)
    }

    fn points(&self, line: usize) -> Result<u64, CloudError> {
        let grid = self.width.zip(self.height).map(|(w, h)| w.saturating_mul(h));
        let points = match (self.points, grid) {
            (Some(points), Some(grid)) if points != grid => {
                return Err(fault(line, format!("POINTS is {points} and WIDTH times HEIGHT {grid}")));
            }
            (points, grid) => {
                points.or(grid).ok_or_else(|| fault(line, "neither POINTS nor WIDTH and HEIGHT"))?
            }
        };
        check_count(FORMAT, points)?;
        Ok(points)
    }
}

fn kind(kind: &[u8], size: &[u8]) -> Option<Scalar> {
    Some(match (kind, size) {
        (b"I", b"1") => Scalar::I8,
        (b"U", b"1") => Scalar::U8,
        (b"I", b"2") => Scalar::I16,
        (b"U", b"2") => Scalar::U16,
        (b"I", b"4") => Scalar::I32,
        (b"U", b"4") => Scalar::U32,
        (b"I", b"8") => Scalar::I64,
        (b"U", b"8") => Scalar::U64,
        (b"F", b"4") => Scalar::F32,
        (b"F", b"8") => Scalar::F64,
        _ => return None,
    })
}

fn text(header: &Header, columns: Columns) -> Result<PointCloud, CloudError> {
    let room = header.points.min(header.body.len() as u64 / 6) as usize;
    let mut cloud = Collected::with_room(room, columns.label);
    let mut lines = Lines::new(header.body).filter(|(_, line)| !line.trim_ascii().is_empty());
    let mut values = Vec::with_capacity(header.numbers().min(header.body.len()));
    for found in 0..header.points {
        let (at, line) = lines.next().ok_or_else(|| header.truncated(found))?;
        values.clear();
        values.extend(words(line).map_while(number));
        let place = || format!("line {}", header.lines + at);
        if values.len() < header.numbers() {
            let reason = format!("`{}` lacks numbers", shown(line));
            return Err(CloudError::Row { format: FORMAT, place: place(), reason });
        }
        let value = |k: usize| values[header.fields[k].place];
        let wanted = (columns.coordinates.map(value), columns.label.map(value));
        cloud.push(FORMAT, place, wanted, Missing::Skip)?;
    }
    cloud.finish()
}

/// Records one after the other.
fn rows(header: &Header, columns: Columns, body: &[u8]) -> Result<PointCloud, CloudError> {
    let size = header.record();
    if size == 0 {
        return Err(fault(header.lines, "a record without bytes"));
    }
    let whole = (body.len() / size) as u64;
    if whole < header.points {
        return Err(header.truncated(whole));
    }
    let mut cloud = Collected::with_room(header.points as usize, columns.label);
    for (k, record) in body.chunks_exact(size).take(header.points as usize).enumerate() {
        let value = |k: usize| {
            let field = &header.fields[k];
            field.kind.read(&record[field.offset..], Endian::Little)
        };
        let wanted = (columns.coordinates.map(value), columns.label.map(value));
        cloud.push(FORMAT, || format!("point {}", k + 1), wanted, Missing::Skip)?;
    }
    cloud.finish()
}

/// All values of the first field, then all of the next.
fn compressed(header: &Header, columns: Columns) -> Result<PointCloud, CloudError> {
    let bad = |reason: &str| CloudError::Row {
        format: FORMAT,
        place: "compressed data".into(),
        reason: reason.into(),
    };
    let length = |at: usize| {
        let bytes = header.body.get(at..at + 4)?;
        Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize)
    };
    let (Some(packed), Some(plain)) = (length(0), length(4)) else { return Err(header.truncated(0)) };
    let points = header.points as usize;
    if header.record().checked_mul(points) != Some(plain) {
        return Err(bad("its length is not that of the points"));
    }
    let data = header.body.get(8..8 + packed).ok_or_else(|| header.truncated(0))?;
    let data = lzf::unpacked(data, plain).ok_or_else(|| bad("it is damaged"))?;
    let mut cloud = Collected::with_room(points, columns.label);
    for k in 0..points {
        let value = |f: usize| {
            let field = &header.fields[f];
            let at = field.offset * points + k * field.kind.size() * field.count;
            field.kind.read(&data[at..], Endian::Little)
        };
        let wanted = (columns.coordinates.map(value), columns.label.map(value));
        cloud.push(FORMAT, || format!("point {}", k + 1), wanted, Missing::Skip)?;
    }
    cloud.finish()
}
