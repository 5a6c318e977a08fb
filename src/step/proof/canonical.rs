//! Digests of records: of their canonical text, in which every reference is the digest of what it refers to.

use std::collections::HashMap;

use super::super::exchange_structure::{ExchangeStructure, Instance, InstanceName};
use super::super::parameter::{Parameter, ParameterKind, Parameters};
use super::{MAX_DEPTH, ProofError, bits, curve_in_space};
use crate::digest::{Digest, sha256};

/// Digests of the records of one file, each computed once.
pub struct Digests<'a> {
    structure: &'a ExchangeStructure,
    known: HashMap<InstanceName, Digest>,
}

impl<'a> Digests<'a> {
    /// Of the records of a file.
    #[must_use]
    pub fn new(structure: &'a ExchangeStructure) -> Self {
        Self { structure, known: HashMap::new() }
    }

    /// The digest of a record with all that it refers to.
    ///
    /// # Errors
    /// [`ProofError`], but [`ProofError::Different`].
    pub fn of(&mut self, name: InstanceName) -> Result<Digest, ProofError> {
        self.below(name, 0)
    }

    fn below(&mut self, name: InstanceName, depth: usize) -> Result<Digest, ProofError> {
        if let Some(&digest) = self.known.get(&name) {
            return Ok(digest);
        }
        if depth > MAX_DEPTH {
            return Err(ProofError::Endless(name));
        }
        let instance = self.structure.instance(name).ok_or(ProofError::Undefined(name))?;
        let digest = match curve_in_space(&instance) {
            Some(curve) => self.below(curve, depth + 1)?,
            None => sha256(&self.text(&instance, depth)?),
        };
        self.known.insert(name, digest);
        Ok(digest)
    }

    fn text(&mut self, instance: &Instance<'_>, depth: usize) -> Result<Vec<u8>, ProofError> {
        let mut text = Vec::new();
        for record in instance.records() {
            text.extend(record.keyword().to_ascii_uppercase());
            self.list(record.parameters(), instance.name(), depth, &mut text)?;
        }
        if text.is_empty() { Err(ProofError::Malformed(instance.name())) } else { Ok(text) }
    }

    fn list(
        &mut self,
        members: Parameters<'_>,
        of: InstanceName,
        depth: usize,
        text: &mut Vec<u8>,
    ) -> Result<(), ProofError> {
        text.push(b'(');
        for (place, member) in members.enumerate() {
            if place > 0 {
                text.push(b',');
            }
            self.parameter(&member, of, depth, text)?;
        }
        text.push(b')');
        Ok(())
    }

    fn parameter(
        &mut self,
        parameter: &Parameter<'_>,
        of: InstanceName,
        depth: usize,
        text: &mut Vec<u8>,
    ) -> Result<(), ProofError> {
        // Lists within lists cost stack too.
        if depth > MAX_DEPTH {
            return Err(ProofError::Endless(of));
        }
        match parameter.kind() {
            ParameterKind::Reference => {
                let target = parameter.as_reference().ok_or(ProofError::Malformed(of))?;
                let digest = self.below(target, depth + 1)?;
                text.extend(format!("#{digest}").into_bytes());
            }
            ParameterKind::Real | ParameterKind::Integer => {
                let bits = bits(parameter).ok_or(ProofError::Malformed(of))?;
                text.extend(format!("{bits:016x}").into_bytes());
            }
            ParameterKind::List | ParameterKind::Typed => {
                text.extend(parameter.keyword().unwrap_or_default().to_ascii_uppercase());
                let members = parameter.members().ok_or(ProofError::Malformed(of))?;
                self.list(members, of, depth + 1, text)?;
            }
            ParameterKind::Enumeration => text.extend(parameter.text().to_ascii_uppercase()),
            ParameterKind::String
            | ParameterKind::Binary
            | ParameterKind::Omitted
            | ParameterKind::Derived => {
                text.extend_from_slice(parameter.text());
            }
            ParameterKind::External | ParameterKind::Malformed => return Err(ProofError::Malformed(of)),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn digest(data: &str) -> Result<String, ProofError> {
        let text = format!("ISO-10303-21;HEADER;ENDSEC;DATA;{data}ENDSEC;END-ISO-10303-21;");
        let source = Source::new(text.into_bytes()).expect("small");
        let structure = ExchangeStructure::parse(source, &mut Vec::new());
        Digests::new(&structure).of(InstanceName(1)).map(|digest| digest.to_string())
    }

    #[test]
    fn the_canonical_text_is_what_the_document_says() {
        let found = digest("#1=CARTESIAN_POINT('p',(1.,-0.,2.5E0));").expect("a digest");
        let text = "CARTESIAN_POINT('p',(3ff0000000000000,0000000000000000,4004000000000000))";
        assert_eq!(found, sha256(text.as_bytes()).to_string());
        let vertex = digest("#1=vertex_point('',#7);#7=CARTESIAN_POINT('p',(1.0,0.,25.E-1));");
        let text = format!("VERTEX_POINT('',#{found})");
        assert_eq!(vertex, Ok(sha256(text.as_bytes()).to_string()));
    }

    #[test]
    fn names_of_records_layout_and_spelling_do_not_count_and_everything_else_does() {
        let of = |data: &str| digest(data).expect("a digest");
        let first = of("#1=A('x',(1.,.T.),#2,$,*);#2=B(LENGTH_MEASURE(3.));");
        assert_eq!(first, of("#1 = A( 'x', /* two */ (1.0,.t.) ,\n#99 ,$,*);#99=b(length_measure(3.00));"));
        for other in
            ["'y',(1.,.T.),#2,$,*", "'x',(1.,.F.),#2,$,*", "'x',((1.),.T.),#2,$,*", "'x',(1.,.T.),#2,*,*"]
        {
            assert_ne!(first, of(&format!("#1=A({other});#2=B(LENGTH_MEASURE(3.));")), "{other}");
        }
        assert_ne!(first, of("#1=A('x',(1.,.T.),#2,$,*);#2=B(LENGTH_MEASURE(3.0000000000000004));"));
    }

    #[test]
    fn a_curve_on_surfaces_counts_as_its_curve_in_space() {
        let curve = "#3=LINE('',#4,#5);#4=CARTESIAN_POINT('',(0.,0.,0.));#5=VECTOR('',#6,1.);#6=DIRECTION('',(1.,0.,0.));";
        let on = |body: &str| digest(&format!("#1=EDGE_CURVE('',#2);#2={body};#9=PCURVE('');{curve}"));
        let plain = digest(&format!("#1=EDGE_CURVE('',#3);{curve}"));
        assert_eq!(on("SURFACE_CURVE('s',#3,(#9),.CURVE_3D.)"), plain);
        let complex = "(BOUNDED_CURVE()CURVE()SURFACE_CURVE(#3,(#9),.CURVE_3D.)REPRESENTATION_ITEM(''))";
        assert_eq!(on(complex), plain);
        assert!(plain.is_ok());
    }

    #[test]
    fn what_has_no_end_or_no_target_has_no_digest() {
        assert_eq!(digest("#1=A(#2);#2=B(#1);").map(|_| ()), Err(ProofError::Endless(InstanceName(2))));
        assert_eq!(digest("#1=A(#2);"), Err(ProofError::Undefined(InstanceName(2))));
    }
}
