//! Clouds as PLY files: binary, little end first, coordinates in single precision as scanners write them, one byte of label.

use super::Cloud;

/// The file of a cloud.
pub fn write(cloud: &Cloud) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\ncomment from formulas, a sample of resurf; millimetres\n\
         comment label: 0 primary, 1 objective, 2 blend\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar label\nend_header\n",
        cloud.points.len()
    )
    .into_bytes();
    for (point, label) in cloud.points.iter().zip(&cloud.labels) {
        for c in point {
            bytes.extend((*c as f32).to_le_bytes());
        }
        bytes.push(*label);
    }
    bytes
}
