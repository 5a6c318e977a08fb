//! Records of an ISO 10303-21 file, and the entities that every sample needs.

use std::fmt::Write;

use super::panel::UNCERTAINTY;
use super::spline::{Curve, Point, Surface};

/// Decimals of every number in a sample: a thousandth of the uncertainty.
pub const DECIMALS: i32 = 9;

/// A number rounded to [`DECIMALS`] decimals.
pub fn rounded(value: f64) -> f64 {
    let scale = 10.0_f64.powi(DECIMALS);
    (value * scale).round() / scale
}

/// The application protocol that a file says it follows.
#[derive(Clone, Copy)]
pub enum Schema {
    Ap214,
    Ap242,
}

/// An instance name, written `#12`.
#[derive(Clone, Copy)]
pub struct Name(usize);

impl std::fmt::Display for Name {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// The records of one file, with the contexts that all of them share.
pub struct Records {
    schema: Schema,
    title: &'static str,
    text: String,
    count: usize,
    contexts: Contexts,
}

#[derive(Clone, Copy)]
struct Contexts {
    application: Name,
    space: Name,
    parameters: Name,
}

/// A product with its one version and definition.
#[derive(Clone, Copy)]
pub struct Product {
    pub definition: Name,
    pub shape: Name,
}

/// Width at which a record goes on in the next line.
const LINE: usize = 78;

impl Records {
    pub fn new(title: &'static str, schema: Schema) -> Self {
        let none = Name(0);
        let contexts = Contexts { application: none, space: none, parameters: none };
        let mut records = Self { schema, title, text: String::new(), count: 0, contexts };
        records.contexts.application = records.application();
        records.contexts.space = records.space();
        records.contexts.parameters = records.add(
            "( GEOMETRIC_REPRESENTATION_CONTEXT(2) PARAMETRIC_REPRESENTATION_CONTEXT() \
             REPRESENTATION_CONTEXT('2D SPACE','') )",
        );
        records
    }

    /// Appends a record and gives its name.
    pub fn add(&mut self, record: impl AsRef<str>) -> Name {
        self.count += 1;
        let name = Name(self.count);
        let mut line = format!("{name}=");
        for piece in record.as_ref().split_inclusive(',') {
            if line.len() + piece.len() > LINE {
                self.text.push_str(line.trim_end());
                self.text.push('\n');
                line.clear();
            }
            line.push_str(piece);
        }
        let _ = writeln!(self.text, "{line};");
        name
    }

    fn application(&mut self) -> Name {
        let (purpose, status, name, year) = match self.schema {
            Schema::Ap214 => (
                "core data for automotive mechanical design processes",
                "international standard",
                "automotive_design",
                2000,
            ),
            Schema::Ap242 => (
                "managed model based 3d engineering",
                "international standard",
                "ap242_managed_model_based_3d_engineering",
                2014,
            ),
        };
        let context = self.add(format!("APPLICATION_CONTEXT('{purpose}')"));
        self.add(format!("APPLICATION_PROTOCOL_DEFINITION('{status}','{name}',{year},{context})"));
        context
    }

    fn space(&mut self) -> Name {
        let length = self.add("( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )");
        let angle = self.add("( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )");
        let solid_angle = self.add("( NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT() )");
        let uncertainty = self.add(format!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),{length},'distance_accuracy_value','')",
            real(UNCERTAINTY)
        ));
        self.add(format!(
            "( GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty})) \
             GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle})) \
             REPRESENTATION_CONTEXT('3D SPACE','') )"
        ))
    }

    pub fn product(&mut self, name: &str) -> Product {
        let application = self.contexts.application;
        let discipline = self.add(format!("PRODUCT_CONTEXT('',{application},'mechanical')"));
        let product = self.add(format!("PRODUCT('{name}','{name}','',({discipline}))"));
        self.add(format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))"));
        let version = self.add(format!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
        let stage = self.add(format!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"));
        let definition = self.add(format!("PRODUCT_DEFINITION('design','',{version},{stage})"));
        let shape = self.add(format!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
        Product { definition, shape }
    }

    /// Ties a representation of the kind `kind` with the given items to a product.
    pub fn representation(&mut self, product: Product, kind: &str, items: &[Name]) -> Name {
        let space = self.contexts.space;
        let representation = self.add(format!("{kind}('',{},{space})", list(items)));
        self.add(format!("SHAPE_DEFINITION_REPRESENTATION({},{representation})", product.shape));
        representation
    }

    /// Colours an item; all styled items of a file go to one presentation.
    pub fn styled(&mut self, item: Name, colour: [f64; 3]) -> Name {
        let [r, g, b] = colour.map(real);
        let colour = self.add(format!("COLOUR_RGB('',{r},{g},{b})"));
        let fill = self.add(format!("FILL_AREA_STYLE_COLOUR('',{colour})"));
        let area = self.add(format!("FILL_AREA_STYLE('',({fill}))"));
        let area = self.add(format!("SURFACE_STYLE_FILL_AREA({area})"));
        let side = self.add(format!("SURFACE_SIDE_STYLE('',({area}))"));
        let usage = self.add(format!("SURFACE_STYLE_USAGE(.BOTH.,{side})"));
        let style = self.add(format!("PRESENTATION_STYLE_ASSIGNMENT(({usage}))"));
        self.add(format!("STYLED_ITEM('colour',({style}),{item})"))
    }

    pub fn presentation(&mut self, styled: &[Name]) {
        let space = self.contexts.space;
        self.add(format!(
            "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',{},{space})",
            list(styled)
        ));
    }

    pub fn layer(&mut self, name: &str, items: &[Name]) {
        self.add(format!("PRESENTATION_LAYER_ASSIGNMENT('{name}','',{})", list(items)));
    }

    pub fn point(&mut self, point: Point) -> Name {
        let [x, y, z] = point.map(real);
        self.add(format!("CARTESIAN_POINT('',({x},{y},{z}))"))
    }

    pub fn vertex(&mut self, point: Point) -> Name {
        let point = self.point(point);
        self.add(format!("VERTEX_POINT('',{point})"))
    }

    pub fn direction(&mut self, direction: Point) -> Name {
        let [x, y, z] = direction.map(real);
        self.add(format!("DIRECTION('',({x},{y},{z}))"))
    }

    /// A placement with its third and first axis.
    pub fn placement(&mut self, origin: Point, z: Point, x: Point) -> Name {
        let origin = self.point(origin);
        let (z, x) = (self.direction(z), self.direction(x));
        self.add(format!("AXIS2_PLACEMENT_3D('',{origin},{z},{x})"))
    }

    /// A line with a direction of unit length.
    pub fn line(&mut self, origin: Point, direction: Point) -> Name {
        let origin = self.point(origin);
        let vector = self.vector(direction);
        self.add(format!("LINE('',{origin},{vector})"))
    }

    pub fn vector(&mut self, direction: Point) -> Name {
        let direction = self.direction(direction);
        self.add(format!("VECTOR('',{direction},1.)"))
    }

    pub fn curve(&mut self, name: &str, curve: &Curve) -> Name {
        let points: Vec<Name> = curve.points.iter().map(|p| self.point(*p)).collect();
        let closed = if curve.points.first() == curve.points.last() { ".T." } else { ".F." };
        let (multiplicities, knots) = distinct(&curve.knots);
        self.add(format!(
            "B_SPLINE_CURVE_WITH_KNOTS('{name}',{},{},.UNSPECIFIED.,{closed},.F.,{multiplicities},{knots},.UNSPECIFIED.)",
            curve.degree,
            list(&points),
        ))
    }

    pub fn surface(&mut self, name: &str, surface: &Surface) -> Name {
        self.any_surface(name, surface, ".F.")
    }

    /// A surface that closes along `v`.
    pub fn closed_surface(&mut self, name: &str, surface: &Surface) -> Name {
        self.any_surface(name, surface, ".T.")
    }

    fn any_surface(&mut self, name: &str, surface: &Surface, v_closed: &str) -> Name {
        let points: Vec<Name> = surface.net.iter().map(|p| self.point(*p)).collect();
        let rows: Vec<String> = points.chunks(surface.columns()).map(list).collect();
        let (multiplicities_u, knots_u) = distinct(&surface.knots[0]);
        let (multiplicities_v, knots_v) = distinct(&surface.knots[1]);
        self.add(format!(
            "B_SPLINE_SURFACE_WITH_KNOTS('{name}',{},{},({}),.UNSPECIFIED.,.F.,{v_closed},.F.,\
             {multiplicities_u},{multiplicities_v},{knots_u},{knots_v},.UNSPECIFIED.)",
            surface.degrees[0],
            surface.degrees[1],
            rows.join(",")
        ))
    }

    /// A line in the parameters of a surface, as a pcurve; `direction` has unit length.
    pub fn line_pcurve(&mut self, surface: Name, origin: [f64; 2], direction: [f64; 2]) -> Name {
        let origin = self.add(format!("CARTESIAN_POINT('',({},{}))", exact(origin[0]), exact(origin[1])));
        let direction = self.direction_2d(direction);
        let vector = self.add(format!("VECTOR('',{direction},1.)"));
        let line = self.add(format!("LINE('',{origin},{vector})"));
        self.pcurve(surface, line)
    }

    /// An ellipse in the parameters of a surface, as a pcurve.
    pub fn ellipse_pcurve(&mut self, surface: Name, ellipse: &super::spline::Ellipse) -> Name {
        let center = self.point_2d(ellipse.center);
        let axis = self.direction_2d(ellipse.axis().map(rounded_direction));
        let placement = self.add(format!("AXIS2_PLACEMENT_2D('',{center},{axis})"));
        let [a, b] = ellipse.semi_axes.map(real);
        let ellipse = self.add(format!("ELLIPSE('',{placement},{a},{b})"));
        self.pcurve(surface, ellipse)
    }

    fn pcurve(&mut self, surface: Name, curve: Name) -> Name {
        let parameters = self.contexts.parameters;
        let definition = self.add(format!("DEFINITIONAL_REPRESENTATION('',({curve}),{parameters})"));
        self.add(format!("PCURVE('',{surface},{definition})"))
    }

    fn point_2d(&mut self, [u, v]: [f64; 2]) -> Name {
        self.add(format!("CARTESIAN_POINT('',({},{}))", real(u), real(v)))
    }

    fn direction_2d(&mut self, [u, v]: [f64; 2]) -> Name {
        self.add(format!("DIRECTION('',({},{}))", exact(u), exact(v)))
    }

    /// An edge along a curve of space with its curves in the parameters of the surfaces beside it;
    /// `kind` is `SURFACE_CURVE` or `SEAM_CURVE`.
    pub fn edge(&mut self, ends: [Name; 2], curve: Name, kind: &str, pcurves: &[Name]) -> Name {
        let curve = self.add(format!("{kind}('',{curve},{},.CURVE_3D.)", list(pcurves)));
        self.plain_edge(ends, curve)
    }

    pub fn plain_edge(&mut self, [start, end]: [Name; 2], curve: Name) -> Name {
        self.add(format!("EDGE_CURVE('',{start},{end},{curve},.T.)"))
    }

    /// A loop of edges, each with whether it is used forwards.
    pub fn edge_loop(&mut self, edges: &[(Name, bool)]) -> Name {
        let uses: Vec<Name> = edges
            .iter()
            .map(|&(edge, forward)| self.add(format!("ORIENTED_EDGE('',*,*,{edge},{})", logical(forward))))
            .collect();
        self.add(format!("EDGE_LOOP('',{})", list(&uses)))
    }

    /// A face whose first loop is the outer one.
    pub fn face(&mut self, name: &str, surface: Name, same_sense: bool, loops: &[Name]) -> Name {
        let bounds: Vec<Name> = loops
            .iter()
            .enumerate()
            .map(|(i, edges)| {
                let kind = if i == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
                self.add(format!("{kind}('',{edges},.T.)"))
            })
            .collect();
        self.add(format!("ADVANCED_FACE('{name}',{},{surface},{})", list(&bounds), logical(same_sense)))
    }

    /// The whole file.
    pub fn finish(self) -> String {
        let schema = match self.schema {
            Schema::Ap214 => "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
            Schema::Ap242 => "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
        };
        format!(
            "ISO-10303-21;\nHEADER;\n\
             FILE_DESCRIPTION(('{} from formulas, a sample of resurf'),'2;1');\n\
             FILE_NAME('{}','2026-01-01T00:00:00',(''),(''),'make-samples','resurf samples','');\n\
             FILE_SCHEMA(('{schema}'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
            self.title, self.title, self.text
        )
    }
}

/// A real with [`DECIMALS`] decimals at most.
fn real(value: f64) -> String {
    exact(rounded(value))
}

/// A real with all its digits.
fn exact(value: f64) -> String {
    let text = format!("{}", value + 0.0);
    if text.contains('.') { text } else { text + "." }
}

/// Directions carry more decimals than lengths: an error in them is multiplied by the radius.
fn rounded_direction(value: f64) -> f64 {
    (value * 1e14).round() / 1e14
}

pub fn list(names: &[Name]) -> String {
    let names: Vec<String> = names.iter().map(Name::to_string).collect();
    format!("({})", names.join(","))
}

fn logical(value: bool) -> &'static str {
    if value { ".T." } else { ".F." }
}

/// Multiplicities and distinct knots, as lists.
fn distinct(knots: &[f64]) -> (String, String) {
    let mut pairs: Vec<(f64, usize)> = Vec::new();
    for &knot in knots {
        match pairs.last_mut() {
            Some((last, count)) if *last >= knot => *count += 1,
            _ => pairs.push((knot, 1)),
        }
    }
    let multiplicities: Vec<String> = pairs.iter().map(|p| p.1.to_string()).collect();
    let knots: Vec<String> = pairs.iter().map(|p| exact(p.0)).collect();
    (format!("({})", multiplicities.join(",")), format!("({})", knots.join(",")))
}
