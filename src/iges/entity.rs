//! The entity types that the program knows by name, as one small number each.
//!
//! Which parameters they have stands in the [schema](super::schema); what they mean is `to_model`'s knowledge. Any other
//! type is an ordinary entity without a view.

macro_rules! entities {
    ($($variant:ident = $number:literal),* $(,)?) => {
        /// An entity type of the schema table that the program speaks of.
        #[allow(missing_docs, reason = "the name of each variant is the entity's own")]
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Entity {
            $($variant = $number,)*
        }

        impl Entity {
            /// Every entity, by type number.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The entity of a type number.
            #[must_use]
            pub fn from_type(number: i32) -> Option<Self> {
                match number {
                    $($number => Some(Self::$variant),)*
                    _ => None,
                }
            }
        }
    };
}

entities! {
    Null = 0,
    CircularArc = 100,
    CompositeCurve = 102,
    ConicArc = 104,
    CopiousData = 106,
    Plane = 108,
    Line = 110,
    ParametricSplineCurve = 112,
    ParametricSplineSurface = 114,
    Point = 116,
    RuledSurface = 118,
    SurfaceOfRevolution = 120,
    TabulatedCylinder = 122,
    Direction = 123,
    TransformationMatrix = 124,
    RationalBSplineCurve = 126,
    RationalBSplineSurface = 128,
    OffsetCurve = 130,
    OffsetSurface = 140,
    Boundary = 141,
    CurveOnSurface = 142,
    BoundedSurface = 143,
    TrimmedSurface = 144,
    ManifoldSolid = 186,
    PlaneSurface = 190,
    CylindricalSurface = 192,
    ConicalSurface = 194,
    SphericalSurface = 196,
    ToroidalSurface = 198,
    SubfigureDefinition = 308,
    ColourDefinition = 314,
    Associativity = 402,
    Property = 406,
    SubfigureInstance = 408,
    VertexList = 502,
    EdgeList = 504,
    Loop = 508,
    Face = 510,
    Shell = 514,
}

impl Entity {
    /// The type number.
    #[must_use]
    pub fn number(self) -> i32 {
        self as i32
    }

    /// Whether it is a curve.
    #[must_use]
    pub fn is_curve(self) -> bool {
        matches!(
            self,
            Self::CircularArc
                | Self::CompositeCurve
                | Self::ConicArc
                | Self::CopiousData
                | Self::Line
                | Self::ParametricSplineCurve
                | Self::RationalBSplineCurve
                | Self::OffsetCurve
        )
    }

    /// Whether it is a surface that may carry a face.
    #[must_use]
    pub fn is_surface(self) -> bool {
        matches!(
            self,
            Self::Plane
                | Self::ParametricSplineSurface
                | Self::RuledSurface
                | Self::SurfaceOfRevolution
                | Self::TabulatedCylinder
                | Self::RationalBSplineSurface
                | Self::OffsetSurface
                | Self::PlaneSurface
                | Self::CylindricalSurface
                | Self::ConicalSurface
                | Self::SphericalSurface
                | Self::ToroidalSurface
        )
    }
}
