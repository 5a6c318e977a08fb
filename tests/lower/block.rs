//! A solid block as STEP text, with one styled face on a layer.

use std::fmt::Write;

/// What is said about the block beside its shape.
#[derive(Clone, Copy)]
pub struct Block {
    /// Edges along x, y and z, from the origin.
    pub size: [f64; 3],
    /// Whether angles are written in degrees.
    pub degrees: bool,
    /// Whether a dimension is about the top face.
    pub dimension: bool,
}

/// Name of the top face.
pub const TOP: &str = "TOP";

struct Records {
    text: String,
    next: usize,
}

impl Records {
    fn add(&mut self, body: &str) -> usize {
        self.next += 1;
        writeln!(self.text, "#{}={body};", self.next).expect("text");
        self.next
    }

    fn point(&mut self, keyword: &str, p: [f64; 3]) -> usize {
        self.add(&format!("{keyword}('',({:?},{:?},{:?}))", p[0], p[1], p[2]))
    }
}

/// What makes a representation the shape of a product.
fn product(out: &mut Records, shape: usize) {
    let application = out.add("APPLICATION_CONTEXT('mechanical design')");
    let context = out.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
    let product = out.add(&format!("PRODUCT('block','block','',(#{context}))"));
    let version = out.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
    let stage = out.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
    let definition = out.add(&format!("PRODUCT_DEFINITION('','',#{version},#{stage})"));
    let of = out.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
    out.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{of},#{shape})"));
}

impl Block {
    /// The text of the file.
    pub fn step(&self) -> String {
        let mut out = Records { text: String::new(), next: 0 };
        let shell = self.shell(&mut out);
        let solid = out.add(&format!("MANIFOLD_SOLID_BREP('block',#{shell})"));
        let length = out.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
        let radian = out.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
        let angle = if self.degrees {
            let dimensions = out.add("DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.)");
            let measure = out.add(&format!(
                "PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE({:?}),#{radian})",
                std::f64::consts::PI / 180.0
            ));
            out.add(&format!(
                "(CONVERSION_BASED_UNIT('DEGREE',#{measure})NAMED_UNIT(#{dimensions})PLANE_ANGLE_UNIT())"
            ))
        } else {
            radian
        };
        let uncertainty =
            out.add(&format!("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),#{length},'accuracy','')"));
        let context = out.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))\
             GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle}))REPRESENTATION_CONTEXT('',''))"
        ));
        let shape = out.add(&format!("ADVANCED_BREP_SHAPE_REPRESENTATION('',(#{solid}),#{context})"));
        product(&mut out, shape);
        let top = shell - 1;
        let colour = out.add("COLOUR_RGB('',0.2,0.4,0.6)");
        let fill = out.add(&format!("FILL_AREA_STYLE_COLOUR('',#{colour})"));
        let area = out.add(&format!("FILL_AREA_STYLE('',(#{fill}))"));
        let style = out.add(&format!("SURFACE_STYLE_FILL_AREA(#{area})"));
        let side = out.add(&format!("SURFACE_SIDE_STYLE('',(#{style}))"));
        let usage = out.add(&format!("SURFACE_STYLE_USAGE(.BOTH.,#{side})"));
        let assigned = out.add(&format!("PRESENTATION_STYLE_ASSIGNMENT((#{usage}))"));
        let styled = out.add(&format!("STYLED_ITEM('color',(#{assigned}),#{top})"));
        out.add(&format!(
            "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#{styled}),#{context})"
        ));
        out.add(&format!("PRESENTATION_LAYER_ASSIGNMENT('12','',(#{top}))"));
        if self.dimension {
            out.add(&format!("GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#{solid},#{solid},#{top})"));
        }
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n\
             FILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n\
             {}ENDSEC;\nEND-ISO-10303-21;\n",
            out.text
        )
    }

    /// Six faces; the last record before the shell is the top face.
    fn shell(&self, out: &mut Records) -> usize {
        let corner = |bits: usize| [0, 1, 2].map(|k| if bits >> k & 1 == 1 { self.size[k] } else { 0.0 });
        let vertices: Vec<usize> = (0..8)
            .map(|bits| {
                let point = out.point("CARTESIAN_POINT", corner(bits));
                out.add(&format!("VERTEX_POINT('',#{point})"))
            })
            .collect();
        let mut edges = std::collections::BTreeMap::new();
        for (start, axis) in (0..8).flat_map(|bits| (0..3).map(move |k| (bits, k))) {
            if start >> axis & 1 == 1 {
                continue;
            }
            let point = out.point("CARTESIAN_POINT", corner(start));
            let along = out.point("DIRECTION", [0, 1, 2].map(|k| f64::from(u8::from(k == axis))));
            let vector = out.add(&format!("VECTOR('',#{along},1.)"));
            let line = out.add(&format!("LINE('',#{point},#{vector})"));
            let end = start | 1 << axis;
            let (a, b) = (vertices[start], vertices[end]);
            edges.insert((start, end), out.add(&format!("EDGE_CURVE('',#{a},#{b},#{line},.T.)")));
        }
        let mut faces = Vec::new();
        for (axis, high) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
            faces.push(self.face(out, &edges, axis, high));
        }
        let list: Vec<String> = faces.iter().map(|face| format!("#{face}")).collect();
        out.add(&format!("CLOSED_SHELL('',({}))", list.join(",")))
    }

    fn face(
        &self,
        out: &mut Records,
        edges: &std::collections::BTreeMap<(usize, usize), usize>,
        axis: usize,
        high: bool,
    ) -> usize {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let base = if high { 1 << axis } else { 0 };
        // Counter-clockwise about the axis, which is outward on the high side.
        let mut ring = [base, base | 1 << a, base | 1 << a | 1 << b, base | 1 << b];
        if !high {
            ring.reverse();
        }
        let mut uses = Vec::new();
        for k in 0..4 {
            let (from, to) = (ring[k], ring[(k + 1) % 4]);
            let edge = edges[&(from.min(to), from.max(to))];
            let sense = if from < to { ".T." } else { ".F." };
            uses.push(format!("#{}", out.add(&format!("ORIENTED_EDGE('',*,*,#{edge},{sense})"))));
        }
        let path = out.add(&format!("EDGE_LOOP('',({}))", uses.join(",")));
        let bound = out.add(&format!("FACE_OUTER_BOUND('',#{path},.T.)"));
        let unit = |k: usize| [0, 1, 2].map(|i| f64::from(u8::from(i == k)));
        let mut origin = [0.0; 3];
        origin[axis] = if high { self.size[axis] } else { 0.0 };
        let at = out.point("CARTESIAN_POINT", origin);
        let normal = out.point("DIRECTION", unit(axis).map(|x| if high { x } else { -x }));
        let x = out.point("DIRECTION", unit(if high { a } else { b }));
        let frame = out.add(&format!("AXIS2_PLACEMENT_3D('',#{at},#{normal},#{x})"));
        let plane = out.add(&format!("PLANE('',#{frame})"));
        let name = if axis == 2 && high { TOP } else { "" };
        out.add(&format!("ADVANCED_FACE('{name}',(#{bound}),#{plane},.T.)"))
    }
}
