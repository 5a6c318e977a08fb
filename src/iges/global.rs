//! The global section: how the file is written, in which units, how exactly, by whom and when.
//!
//! All 26 parameters of IGES 5.3 section 2.2.4.3, decoded once; older versions have fewer. A value that is not what it
//! must be counts as left out, and is reported. What units mean is the model's knowledge.

use super::code::Code;
use super::parameter::{Delimiters, Parameter, ParameterKind, Parameters};
use super::section::SectionKind;
use crate::diagnostic::Sink;

/// Places of the parameters, counted from 1 as in the standard.
pub mod place {
    /// Version of the preprocessor.
    pub const PREPROCESSOR_VERSION: usize = 6;
    /// When the file was written.
    pub const WRITTEN: usize = 18;
}

/// What the global section says. A text is empty, and a number `None`, where the file leaves it out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Global {
    /// 1 and 2.
    pub delimiters: Delimiters,
    /// 3: name of the product by the sender.
    pub sender_product: String,
    /// 4: name of the file.
    pub file_name: String,
    /// 5: system that the file comes from.
    pub native_system: String,
    /// 6: version of the preprocessor.
    pub preprocessor_version: String,
    /// 7: bits of an integer.
    pub integer_bits: Option<i64>,
    /// 8 and 9: greatest power of ten and significant digits of a single-precision number.
    pub single_precision: [Option<i64>; 2],
    /// 10 and 11: the same of a double-precision number.
    pub double_precision: [Option<i64>; 2],
    /// 12: name of the product by the receiver.
    pub receiver_product: String,
    /// 13: how many units of the model one unit of the thing is; one by default.
    pub scale: Option<f64>,
    /// 14: flag of the unit of length, from 1.
    pub unit_flag: Option<i64>,
    /// 15: name of the unit of length.
    pub unit_name: String,
    /// 16: count of line weights.
    pub line_weights: Option<i64>,
    /// 17: width of the heaviest line.
    pub line_width: Option<f64>,
    /// 18: when the file was written, `20261126.093000` or with two digits of the year.
    pub written: String,
    /// 19: distance below which points are not told apart.
    pub resolution: Option<f64>,
    /// 20: a bound on all coordinates; zero and `None` say nothing.
    pub greatest_coordinate: Option<f64>,
    /// 21: who wrote it.
    pub author: String,
    /// 22: where.
    pub organisation: String,
    /// 23: version of IGES, 11 for 5.3.
    pub version: Option<i64>,
    /// 24: drafting standard.
    pub drafting_standard: Option<i64>,
    /// 25: when the model last changed.
    pub changed: String,
    /// 26: application protocol.
    pub protocol: String,
}

impl Global {
    /// Decodes the parameters. What is wrong goes to the sink.
    pub(super) fn decode(parameters: Parameters<'_>, delimiters: Delimiters, sink: &mut dyn Sink) -> Self {
        let mut global = Self { delimiters, ..Self::default() };
        // A file that goes on after the last of 5.3 is of a later draft: nothing is missed.
        for (at, parameter) in parameters.take(26).enumerate().skip(2) {
            if !parameter.is_default() && !global.set(at + 1, &parameter) {
                let found = String::from_utf8_lossy(&parameter.text()).into_owned();
                let message = format!("parameter {} of the global section is `{found}`", at + 1);
                sink.report(Code::BadGlobal.note(parameter.span(), message));
            }
        }
        global
    }

    /// Sets a parameter; whether it is of the kind that it must be.
    fn set(&mut self, place: usize, parameter: &Parameter<'_>) -> bool {
        let text = match place {
            3 => &mut self.sender_product,
            4 => &mut self.file_name,
            5 => &mut self.native_system,
            6 => &mut self.preprocessor_version,
            12 => &mut self.receiver_product,
            15 => &mut self.unit_name,
            18 => &mut self.written,
            21 => &mut self.author,
            22 => &mut self.organisation,
            25 => &mut self.changed,
            26 => &mut self.protocol,
            _ => return self.set_number(place, parameter),
        };
        match parameter.as_str() {
            Some(found) => found.trim().clone_into(text),
            // Some writers leave the count of an empty text to itself.
            None => return parameter.kind() == ParameterKind::Integer && parameter.as_i64() == Some(0),
        }
        true
    }

    fn set_number(&mut self, place: usize, parameter: &Parameter<'_>) -> bool {
        let integer = match place {
            7 => &mut self.integer_bits,
            8 | 9 => &mut self.single_precision[place - 8],
            10 | 11 => &mut self.double_precision[place - 10],
            14 => &mut self.unit_flag,
            16 => &mut self.line_weights,
            23 => &mut self.version,
            24 => &mut self.drafting_standard,
            _ => return self.set_real(place, parameter),
        };
        *integer = parameter.as_i64();
        integer.is_some()
    }

    fn set_real(&mut self, place: usize, parameter: &Parameter<'_>) -> bool {
        let real = match place {
            13 => &mut self.scale,
            17 => &mut self.line_width,
            19 => &mut self.resolution,
            20 => &mut self.greatest_coordinate,
            _ => return true,
        };
        *real = parameter.as_f64();
        real.is_some()
    }

    /// The version of the standard in words, as parameter 23 has it: `IGES 5.3`.
    #[must_use]
    pub fn version_name(&self) -> &'static str {
        match self.version.unwrap_or(3) {
            ..=1 => "IGES 1.0",
            2 => "ANSI Y14.26M-1981",
            3 => "IGES 2.0",
            4 => "IGES 3.0",
            5 => "ASME/ANSI Y14.26M-1987",
            6 => "IGES 4.0",
            7 => "ASME Y14.26M-1989",
            8 => "IGES 5.0",
            9 => "IGES 5.1",
            10 => "IGES 5.2",
            _ => "IGES 5.3",
        }
    }
}

/// Reports a section that the file lacks.
pub(super) fn missing(kind: SectionKind, at: crate::source::Span, sink: &mut dyn Sink) {
    let message = format!("the {} section is missing", kind.as_str());
    sink.report(Code::MissingSection.note(at, message));
}

#[cfg(test)]
mod tests {
    use super::super::parameter::{Columns, Text};
    use super::*;

    fn decoded(text: &str) -> (Global, Vec<crate::diagnostic::Diagnostic>) {
        let lines: Vec<String> =
            text.as_bytes().chunks(72).map(|line| format!("{:72}", String::from_utf8_lossy(line))).collect();
        let bytes = lines.concat();
        let starts: Vec<u32> = (0..lines.len()).map(|at| 72 * at as u32).collect();
        let (columns, delimiters) = (Columns::First(72), Delimiters::default());
        let text = Text { bytes: bytes.as_bytes(), lines: &starts, columns, delimiters };
        let delimiters = super::super::parameter::delimiters(text).expect("two delimiters");
        let mut sink = Vec::new();
        (Global::decode(Parameters::new(Text { delimiters, ..text }), delimiters, &mut sink), sink)
    }

    #[test]
    fn all_parameters_have_their_place() {
        let (global, sink) = decoded(
            "1H,,1H;,4Hpart,8Hpart.igs,6Hsystem,3H0.1,32,38,6,308,15,5Hother,0.5,3,2HCM,8,0.25,\
             15H20261126.093000,1.E-6,1.D3,3Hwho,5Hwhere,11,7,13H261126.093000,4HAP99;",
        );
        assert_eq!(sink, []);
        assert_eq!((global.sender_product.as_str(), global.protocol.as_str()), ("part", "AP99"));
        assert_eq!(
            (global.single_precision, global.double_precision),
            ([Some(38), Some(6)], [Some(308), Some(15)])
        );
        assert_eq!((global.scale, global.unit_flag, global.unit_name.as_str()), (Some(0.5), Some(3), "CM"));
        assert_eq!((global.resolution, global.greatest_coordinate), (Some(1e-6), Some(1000.0)));
        assert_eq!((global.version_name(), global.drafting_standard), ("IGES 5.3", Some(7)));
        assert_eq!((global.written.as_str(), global.changed.as_str()), ("20261126.093000", "261126.093000"));
    }

    #[test]
    fn what_is_left_out_is_nothing_and_what_is_wrong_is_reported() {
        let (global, sink) = decoded(",,,,,,16,x,7;");
        assert_eq!((global.integer_bits, global.single_precision), (Some(16), [None, Some(7)]));
        assert_eq!(global.sender_product, "");
        assert_eq!(sink.len(), 1);
        assert_eq!(sink[0].code, "iges.bad-global");
        assert_eq!(global.version_name(), "IGES 2.0");
    }
}
