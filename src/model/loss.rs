//! What a model has and a file that is made of it has not, by stable code.

use super::{Appearance, Model, Origin};
use crate::diagnostic::{Diagnostic, Severity, Sink};

/// What stays behind when a file of another format is made. Texts never change once released.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Loss {
    /// Dimensions, tolerances, datums, notes, validation properties, tessellations.
    Annotation,
    /// How much shows through a face or body.
    Transparency,
    /// That a face or body is hidden.
    Hidden,
    /// A layer that the format has no name for.
    Layer,
    /// Colours that hold in one use of a product.
    UseColour,
    /// A shape in another file.
    External,
    /// A solid whose shell is open is written as surfaces.
    OpenSolid,
    /// The identifier of a product, where it differs from its name.
    Identifier,
    /// Which side of a face is the outer one.
    Side,
}

impl Loss {
    /// The stable text of the code.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Annotation => "loss.annotation",
            Self::Transparency => "loss.transparency",
            Self::Hidden => "loss.hidden",
            Self::Layer => "loss.layer",
            Self::UseColour => "loss.use-colour",
            Self::External => "loss.external",
            Self::OpenSolid => "loss.open-solid",
            Self::Identifier => "loss.identifier",
            Self::Side => "loss.side",
        }
    }

    /// Reports the loss of an element.
    pub fn report(self, origin: Origin, what: &str, sink: &mut dyn Sink) {
        sink.report(Diagnostic {
            code: self.text(),
            severity: Severity::Warning,
            entity: Some(origin.to_string()),
            span: None,
            message: format!("not written: {what}"),
        });
    }

    /// Reports every annotation: neither writer has a place for them.
    pub fn of_annotations(model: &Model, sink: &mut dyn Sink) {
        for annotation in &model.annotations {
            Self::Annotation.report(annotation.origin, annotation.kind.as_str(), sink);
        }
    }

    /// Reports a look through which something shows.
    pub fn of_transparency(look: &Appearance, origin: Origin, sink: &mut dyn Sink) {
        if look.transparency.is_some_and(|transparency| transparency > 0.0) {
            Self::Transparency.report(origin, "its transparency", sink);
        }
    }

    /// Reports what of a look is more than a colour.
    pub fn of_look(look: &Appearance, origin: Origin, sink: &mut dyn Sink) {
        Self::of_transparency(look, origin, sink);
        if look.hidden {
            Self::Hidden.report(origin, "that it is hidden", sink);
        }
    }
}
