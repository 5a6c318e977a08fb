//! Operations: from a model and parameters to a change set.
//!
//! Pure: no operation knows a file format or touches a file. An operation that cannot do its job returns an
//! [`OperationError`] and no change set.

pub mod constrained_scale;
pub mod deform;
pub mod detail_transfer;
pub mod error;
pub mod feature_paste;
pub mod feature_reconstruction;
pub mod force_density;
pub mod net;
pub mod simplify;

pub use error::{Obstacle, OperationError};
