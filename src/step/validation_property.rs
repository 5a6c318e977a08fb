//! Geometric validation properties: what the sender of a part measured, for the receiver to compare.
//!
//! Finds them; computes and compares nothing.

use super::exchange_structure::{ExchangeStructure, InstanceName};
use super::{Entity, EntityView};

/// Name of the property by the recommended practice for geometric and assembly validation properties.
const NAME: &str = "geometric validation property";

/// The `PROPERTY_DEFINITION`s that hold geometric validation properties, in file order.
#[must_use]
pub fn validation_properties(structure: &ExchangeStructure) -> Vec<InstanceName> {
    let definitions = structure.instances().filter_map(EntityView::of);
    let stated = definitions.filter(|view| {
        view.entity() == Entity::PropertyDefinition && view.text("name").eq_ignore_ascii_case(NAME)
    });
    stated.map(|view| view.name()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    #[test]
    fn only_geometric_validation_properties_are_found() {
        let text = "ISO-10303-21;HEADER;ENDSEC;DATA;\
            #1=PROPERTY_DEFINITION('geometric validation property','volume',#9);\
            #2=PROPERTY_DEFINITION('material','',#9);#9=A();ENDSEC;END-ISO-10303-21;";
        let source = Source::new(text.as_bytes().to_vec()).expect("small");
        let structure = ExchangeStructure::parse(source, &mut Vec::new());
        assert_eq!(validation_properties(&structure), [InstanceName(1)]);
    }
}
