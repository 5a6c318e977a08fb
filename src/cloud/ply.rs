//! PLY, text and both binary forms: the element `vertex`; all other elements are passed over.
//!
//! The count in the header is not believed: room is made for what the file can hold.

use super::CloudError;
use super::point_cloud::{Collected, LabelColumn, Missing, PointCloud, check_count};
use super::table::{Columns, Endian, Scalar};
use super::words::{Lines, number, shown, words};

const FORMAT: &str = "PLY";

/// Whether bytes begin as PLY does.
#[must_use]
pub fn is_ply(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

/// Reads the vertices.
///
/// # Errors
/// [`CloudError`]. A vertex that is not finite is an error: PLY has no points that were not measured.
pub fn read(bytes: &[u8], label: Option<&LabelColumn>) -> Result<PointCloud, CloudError> {
    let header = Header::read(bytes)?;
    match header.encoding {
        Encoding::Text => text(&header, label),
        Encoding::Binary(endian) => binary(&header, endian, label),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Text,
    Binary(Endian),
}

#[derive(Debug)]
struct Property {
    name: String,
    kind: Scalar,
    /// Type of the count, for a list.
    list: Option<Scalar>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
    line: usize,
}

struct Header<'a> {
    encoding: Encoding,
    elements: Vec<Element>,
    body: &'a [u8],
    lines: usize,
}

fn fault(line: usize, reason: impl Into<String>) -> CloudError {
    CloudError::Header { format: FORMAT, line, reason: reason.into() }
}

fn scalar(word: &[u8]) -> Option<Scalar> {
    Some(match word {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"int64" | b"long" => Scalar::I64,
        b"uint64" | b"ulong" => Scalar::U64,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        _ => return None,
    })
}

/// Lines of a header that are read before its end must have come.
const LONGEST_HEADER: usize = 10_000;

impl<'a> Header<'a> {
    fn read(bytes: &'a [u8]) -> Result<Self, CloudError> {
        let mut lines = Lines::new(bytes);
        if lines.next().is_none_or(|(_, line)| line != b"ply") {
            return Err(fault(1, "the first line is not `ply`"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        while let Some((at, line)) = lines.next().filter(|(at, _)| *at <= LONGEST_HEADER) {
            let words: Vec<&[u8]> = words(line).collect();
            match words[..] {
                [b"end_header"] => {
                    let encoding = encoding.ok_or_else(|| fault(at, "no line `format`"))?;
                    return Ok(Self { encoding, elements, body: lines.rest(), lines: lines.number() });
                }
                [] | [b"comment" | b"obj_info", ..] => {}
                [b"format", form, _] => encoding = Some(encoding_of(at, form)?),
                [b"element", name, count] => elements.push(element(at, name, count)?),
                [b"property", ref words @ ..] => {
                    let element =
                        elements.last_mut().ok_or_else(|| fault(at, "a property before any element"))?;
                    element.properties.push(property(at, words)?);
                }
                _ => return Err(fault(at, format!("`{}` is not understood", shown(line)))),
            }
        }
        Err(fault(lines.number(), "no line `end_header`"))
    }

    /// The vertices, and the elements before them.
    fn vertices(&self) -> Result<(&[Element], &Element), CloudError> {
        let at = self.elements.iter().position(|e| e.name == "vertex");
        let at = at.ok_or_else(|| fault(self.lines, "no element `vertex`"))?;
        check_count(FORMAT, self.elements[at].count)?;
        Ok((&self.elements[..at], &self.elements[at]))
    }
}

fn encoding_of(line: usize, word: &[u8]) -> Result<Encoding, CloudError> {
    match word {
        b"ascii" => Ok(Encoding::Text),
        b"binary_little_endian" => Ok(Encoding::Binary(Endian::Little)),
        b"binary_big_endian" => Ok(Encoding::Binary(Endian::Big)),
        other => Err(fault(line, format!("format `{}` is not known", shown(other)))),
    }
}

fn element(line: usize, name: &[u8], count: &[u8]) -> Result<Element, CloudError> {
    let bad = || fault(line, format!("`{}` is no count", shown(count)));
    let count = std::str::from_utf8(count).ok().and_then(|t| t.parse().ok()).ok_or_else(bad)?;
    Ok(Element { name: shown(name), count, properties: Vec::new(), line })
}

fn property(line: usize, words: &[&[u8]]) -> Result<Property, CloudError> {
    let kind =
        |word: &[u8]| scalar(word).ok_or_else(|| fault(line, format!("type `{}` is not known", shown(word))));
    match *words {
        [b"list", count, of, name] => {
            Ok(Property { name: shown(name), kind: kind(of)?, list: Some(kind(count)?) })
        }
        [of, name] => Ok(Property { name: shown(name), kind: kind(of)?, list: None }),
        _ => Err(fault(line, "a property needs a type and a name")),
    }
}

/// Columns by property; a list before one of them would move it.
fn columns(element: &Element, label: Option<&LabelColumn>) -> Result<Columns, CloudError> {
    let names: Vec<String> = element.properties.iter().map(|p| p.name.clone()).collect();
    let columns = Columns::of(FORMAT, element.line, &names, label)?;
    match element.properties[..=columns.last()].iter().find(|p| p.list.is_some()) {
        Some(list) => Err(fault(
            element.line,
            format!("the list `{}` stands before a column that is wanted", list.name),
        )),
        None => Ok(columns),
    }
}

fn text(header: &Header, label: Option<&LabelColumn>) -> Result<PointCloud, CloudError> {
    let (before, vertices) = header.vertices()?;
    let columns = columns(vertices, label)?;
    let mut lines = Lines::new(header.body).filter(|(_, line)| !line.trim_ascii().is_empty());
    let skipped = before.iter().fold(0_u64, |sum, e| sum.saturating_add(e.count));
    for _ in 0..skipped {
        if lines.next().is_none() {
            break;
        }
    }
    // A coordinate takes two bytes at least.
    let room = vertices.count.min(header.body.len() as u64 / 6) as usize;
    let mut cloud = Collected::with_room(room, columns.label);
    let mut values = Vec::new();
    for found in 0..vertices.count {
        let truncated = CloudError::Truncated { format: FORMAT, expected: vertices.count, found };
        let (at, line) = lines.next().ok_or(truncated)?;
        let place = || format!("line {}", header.lines + at);
        values.clear();
        values.extend(words(line).take(columns.last() + 1).map_while(number));
        let [x, y, z] = columns.coordinates.map(|k| values.get(k).copied());
        let (Some(x), Some(y), Some(z), true) = (x, y, z, values.len() > columns.last()) else {
            let reason = format!("`{}` lacks numbers", shown(line));
            return Err(CloudError::Row { format: FORMAT, place: place(), reason });
        };
        let label = columns.label.map(|k| values[k]);
        cloud.push(FORMAT, place, ([x, y, z], label), Missing::Refuse)?;
    }
    cloud.finish()
}

fn binary(header: &Header, endian: Endian, label: Option<&LabelColumn>) -> Result<PointCloud, CloudError> {
    let (before, vertices) = header.vertices()?;
    let columns = columns(vertices, label)?;
    let truncated = |found| CloudError::Truncated { format: FORMAT, expected: vertices.count, found };
    let mut body = header.body;
    for element in before {
        for _ in 0..element.count {
            body = record(&element.properties, body, endian).ok_or_else(|| truncated(0))?;
            if element.properties.is_empty() {
                break;
            }
        }
    }
    let offsets: Vec<usize> = vertices.properties[..=columns.last()]
        .iter()
        .scan(0, |at, p| {
            let here = *at;
            *at += p.kind.size();
            Some(here)
        })
        .collect();
    let value = |k: usize, record: &[u8]| vertices.properties[k].kind.read(&record[offsets[k]..], endian);
    let least: usize = vertices.properties.iter().map(|p| p.list.unwrap_or(p.kind).size()).sum();
    let room = vertices.count.min((body.len() / least) as u64) as usize;
    let mut cloud = Collected::with_room(room, columns.label);
    for found in 0..vertices.count {
        let behind = record(&vertices.properties, body, endian).ok_or_else(|| truncated(found))?;
        let point = columns.coordinates.map(|k| value(k, body));
        let label = columns.label.map(|k| value(k, body));
        cloud.push(FORMAT, || format!("point {}", found + 1), (point, label), Missing::Refuse)?;
        body = behind;
    }
    cloud.finish()
}

/// What is left behind one record; `None` when the record is not whole.
fn record<'a>(properties: &[Property], mut bytes: &'a [u8], endian: Endian) -> Option<&'a [u8]> {
    for property in properties {
        let size = match property.list {
            None => property.kind.size(),
            Some(counter) => {
                if bytes.len() < counter.size() {
                    return None;
                }
                let count = counter.read(bytes, endian);
                bytes = &bytes[counter.size()..];
                if !(0.0..=bytes.len() as f64).contains(&count) {
                    return None;
                }
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "at most a length"
                )]
                let count = count as usize;
                count.checked_mul(property.kind.size())?
            }
        };
        bytes = bytes.get(size..)?;
    }
    Some(bytes)
}
