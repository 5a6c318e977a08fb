//! Point clouds as scanners give them: readers, neighbours, local shape, segmentation.
//!
//! A cloud is points and perhaps a label for each. Its unit is the caller's knowledge: few formats state one. Knows no
//! part and no file system.

pub mod e57;
pub mod error;
pub mod local_shape;
mod lzf;
pub mod neighbours;
pub mod obj;
pub mod pcd;
pub mod placement;
pub mod ply;
pub mod point_cloud;
pub mod segment;
mod table;
mod words;
pub mod xyz;

pub use error::CloudError;
pub use local_shape::{LocalShape, local_shape};
pub use neighbours::Neighbours;
pub use point_cloud::{LabelColumn, PointCloud};
pub use segment::{Role, Segmentation, segmented};
