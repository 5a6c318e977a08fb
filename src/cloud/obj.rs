//! Wavefront OBJ: the vertices, lines that begin with `v`; all else is passed over. OBJ has no labels.

use super::CloudError;
use super::point_cloud::{Collected, Missing, PointCloud, check_count};
use super::words::{Lines, number, shown, words};

const FORMAT: &str = "OBJ";

/// Reads the vertices.
///
/// # Errors
/// [`CloudError`].
pub fn read(bytes: &[u8]) -> Result<PointCloud, CloudError> {
    let mut cloud = Collected::default();
    for (at, line) in Lines::new(bytes) {
        let mut words = words(line);
        if words.next() != Some(b"v") {
            continue;
        }
        let values: Vec<f64> = words.take(3).map_while(number).collect();
        let place = || format!("line {at}");
        let [x, y, z] = values[..] else {
            let reason = format!("`{}` lacks numbers", shown(line));
            return Err(CloudError::Row { format: FORMAT, place: place(), reason });
        };
        cloud.push(FORMAT, place, ([x, y, z], None), Missing::Refuse)?;
    }
    check_count(FORMAT, cloud.points.len() as u64)?;
    cloud.finish()
}
