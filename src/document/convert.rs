//! A file of one format made of the model of another.

use super::Stamp;
use crate::diagnostic::Sink;
use crate::model::Model;
use crate::{iges, step};
pub use iges::from_model::Solids;
pub use step::from_model::Schema;

/// What is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conversion {
    /// A STEP file.
    Step(Schema),
    /// An IGES file.
    Iges(Solids),
}

/// Why no file is made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ConvertError {
    /// By the writer of STEP.
    #[error(transparent)]
    Step(#[from] step::from_model::FromModelError),
    /// By the writer of IGES.
    #[error(transparent)]
    Iges(#[from] iges::from_model::FromModelError),
}

/// The bytes of a file that says what a model is; `name` is the file's own. Losses go to the sink.
///
/// # Errors
/// [`ConvertError`] naming the element that cannot be written.
pub fn converted(
    model: &Model,
    conversion: Conversion,
    name: &str,
    stamp: &Stamp,
    sink: &mut dyn Sink,
) -> Result<Vec<u8>, ConvertError> {
    let Stamp { time, preprocessor } = stamp.clone();
    let name = name.to_owned();
    Ok(match conversion {
        Conversion::Step(schema) => {
            let header = step::from_model::Header { name, time, preprocessor, schema };
            step::from_model::from_model(model, &header, sink)?
        }
        Conversion::Iges(solids) => {
            let header = iges::from_model::Header { name, time, preprocessor, solids };
            iges::from_model::from_model(model, &header, sink)?
        }
    })
}
