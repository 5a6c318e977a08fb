//! E57 (ASTM E2807), through the crate of that name: the points of all scans of a file in the file's coordinates, metres.
//!
//! Points that the scanner marked as not measured are left out and counted. Labels are not read.

use super::CloudError;
use super::point_cloud::{Collected, Missing, PointCloud, check_count};
use e57::{CartesianCoordinate, E57Reader, PointCloud as Scan, RecordDataType};
use std::io::Cursor;

const FORMAT: &str = "E57";

/// Whether bytes begin as E57 does.
#[must_use]
pub fn is_e57(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ASTM-E57")
}

/// Reads the points of all scans.
///
/// # Errors
/// [`CloudError`].
pub fn read(bytes: &[u8]) -> Result<PointCloud, CloudError> {
    let fault = |reason: e57::Error| CloudError::Row {
        format: FORMAT,
        place: "structure".to_owned(),
        reason: reason.to_string(),
    };
    let mut reader = E57Reader::new(Cursor::new(bytes)).map_err(fault)?;
    let mut cloud = Collected::default();
    for scan in reader.pointclouds() {
        check_count_fits(bytes, scan.records.saturating_add(cloud.points.len() as u64))?;
        check_fields(&scan)?;
        let points = reader.pointcloud_simple(&scan).map_err(fault)?;
        for (k, point) in points.enumerate() {
            let values = match point.map_err(fault)?.cartesian {
                CartesianCoordinate::Valid { x, y, z } => [x, y, z],
                CartesianCoordinate::Direction { .. } | CartesianCoordinate::Invalid => [f64::NAN; 3],
            };
            cloud.push(FORMAT, || format!("point {}", k + 1), (values, None), Missing::Skip)?;
        }
    }
    cloud.finish()
}

/// A field may take no bit at all, so that a count has no bound but this: one bit for each point.
fn check_count_fits(bytes: &[u8], count: u64) -> Result<(), CloudError> {
    check_count(FORMAT, count)?;
    let limit = 8 * bytes.len() as u64;
    if count > limit {
        let why = format!("a file of {} bytes can hold", bytes.len());
        return Err(CloudError::TooMany { format: FORMAT, count, limit, why });
    }
    Ok(())
}

/// A scan all of whose fields take no bit would be unpacked without end.
fn check_fields(scan: &Scan) -> Result<(), CloudError> {
    let empty = |kind: &RecordDataType| match kind {
        RecordDataType::Single { .. } | RecordDataType::Double { .. } => false,
        RecordDataType::ScaledInteger { min, max, .. } | RecordDataType::Integer { min, max } => min == max,
    };
    if scan.records > 0 && scan.prototype.iter().all(|field| empty(&field.data_type)) {
        let reason = "no field of its points takes a bit".to_owned();
        return Err(CloudError::Row { format: FORMAT, place: "structure".to_owned(), reason });
    }
    Ok(())
}
