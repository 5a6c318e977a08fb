//! Each entity form from a snippet; expected values are the snippet's own numbers or closed forms.

mod forms;

use std::f64::consts::PI;

use super::*;
use crate::brep::BodyKind;
use crate::diagnostic::Diagnostic;
use crate::geometry::{Carried, Curve, Curve2d, Surface};
use crate::math::{Point3, Vector3};
use crate::model::{Inventory, Origin};
use crate::source::Source;

pub(super) fn read(data: &str) -> (Model, Vec<Diagnostic>) {
    let text = format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n"
    );
    let mut sink = Vec::new();
    let file = ExchangeStructure::parse(Source::new(text.into_bytes()).expect("small"), &mut sink);
    let model = to_model(&file, &mut sink);
    (model, sink)
}

/// Context `#900`: millimetres, degrees, uncertainty 0.001.
pub(super) const DEGREES: &str = "
#900=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#905))
GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#902))REPRESENTATION_CONTEXT('',''));
#901=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#902=(CONVERSION_BASED_UNIT('DEGREES',#903)NAMED_UNIT(#906)PLANE_ANGLE_UNIT());
#903=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.0174532925199433),#904);
#904=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#905=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-3),#901,'distance_accuracy_value','');
#906=DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.);";

/// A surface model with one face on `#100`, bounded by one edge on `#200` from (1, 0, 0) back to itself.
pub(super) const FACE: &str = "
#1=SHAPE_REPRESENTATION('',(#2),#900);
#2=SHELL_BASED_SURFACE_MODEL('skin',(#3));
#3=OPEN_SHELL('',(#4));
#4=ADVANCED_FACE('top',(#5),#100,.F.);
#5=FACE_OUTER_BOUND('',#6,.T.);
#6=EDGE_LOOP('',(#7));
#7=ORIENTED_EDGE('',*,*,#8,.F.);
#8=EDGE_CURVE('',#9,#9,#200,.T.);
#9=VERTEX_POINT('',#10);
#10=CARTESIAN_POINT('',(1.,0.,0.));
#11=AXIS2_PLACEMENT_3D('',#12,#13,#14);
#12=CARTESIAN_POINT('',(0.,0.,0.));
#13=DIRECTION('',(0.,0.,2.));
#14=DIRECTION('',(1.,0.,0.));";

pub(super) const CIRCLE: &str = "#200=CIRCLE('',#11,1.);";
pub(super) const PLANE: &str = "#100=PLANE('',#11);";

/// The face's surface for a record `#100`, and every diagnostic.
fn surface(records: &str) -> (Carried<Surface>, Vec<Diagnostic>) {
    let (model, sink) = read(&[FACE, CIRCLE, DEGREES, records].concat());
    assert_eq!(model.brep.faces.len(), 1, "{sink:?}");
    let face = model.brep.faces.ids().next().expect("one face");
    (model.brep.surface_of(face).clone(), sink)
}

/// The edge's curve for a record `#200`, and every diagnostic.
fn curve(records: &str) -> (Carried<Curve>, Vec<Diagnostic>) {
    let (model, sink) = read(&[FACE, PLANE, DEGREES, records].concat());
    assert_eq!(model.brep.edges.len(), 1, "{sink:?}");
    let edge = model.brep.edges.ids().next().expect("one edge");
    (model.brep.curve_of(edge).clone(), sink)
}

fn check_surface(records: &str, check: impl FnOnce(&Surface)) {
    let (found, sink) = surface(records);
    assert_eq!(sink, []);
    check(found.read().expect("read"));
}

fn refused(found: &Carried<impl std::fmt::Debug>) -> &str {
    match found {
        Carried::Unread { reason, .. } => reason,
        Carried::Read(geometry) => panic!("read: {geometry:?}"),
    }
}

#[test]
fn topology_names_senses_and_origins() {
    let (model, sink) = read(&[FACE, CIRCLE, PLANE, DEGREES].concat());
    assert_eq!(sink, []);
    let brep = &model.brep;
    let face = brep.faces.ids().next().expect("one face");
    let coedge = brep.coedges_of(face).next().expect("one coedge");
    assert_eq!(brep.bodies.iter().map(|(_, b)| b.kind).collect::<Vec<_>>(), [BodyKind::Surface]);
    assert!(!brep.faces[face].same_sense && !brep.coedges[coedge].forward);
    let bound = &brep.loops[brep.faces[face].loops[0]];
    assert!(bound.outer && bound.forward && bound.vertex.is_none());
    assert_eq!(model.faces[face].name, "top");
    assert_eq!(model.bodies[model.body_of(face)].own.name, "skin");
    assert_eq!(model.origins.faces[face], Origin::Instance(4));
    assert_eq!(model.origins.coedges[coedge], Origin::Instance(7));
    assert_eq!(model.origins.edges[brep.coedges[coedge].edge], Origin::Instance(8));
    assert_eq!(model.schema, ["AUTOMOTIVE_DESIGN"]);
    let context = model.context_of(face);
    assert_eq!((context.length.metres, context.angle.name.as_str()), (1e-3, "deg"));
    assert_eq!(context.uncertainty.map(|t| t.0), Some(1e-3));
    let inventory = Inventory::of(&model);
    assert_eq!((inventory.faces, inventory.edges, inventory.vertices), (1, 1, 1));
    assert_eq!(inventory.surfaces.get("plane"), Some(&1));
    assert_eq!(inventory.vertex_extents, Some([Point3::new(1.0, 0.0, 0.0); 2]));
}

#[test]
fn line_ends_of_any_kind_and_keywords_of_any_case_give_the_same_model() {
    let plain = [FACE, CIRCLE, PLANE, DEGREES].concat();
    let (expected, _) = read(&plain);
    for text in [plain.replace('\n', "\r\n"), plain.replace('\n', "\r"), plain.replace("PLANE(", "Plane(")] {
        let (model, _) = read(&text);
        assert_eq!(Inventory::of(&model), Inventory::of(&expected));
    }
}

#[test]
fn elementary_surfaces() {
    check_surface("#100=CYLINDRICAL_SURFACE('',#11,2.5);", |s| {
        assert!(
            matches!(s, Surface::Cylinder { radius, frame } if *radius == 2.5 && frame.z == Vector3::z())
        );
    });
    check_surface("#100=CONICAL_SURFACE('',#11,2.,30.);", |s| {
        let Surface::Cone { radius, semi_angle, .. } = s else { panic!("{s:?}") };
        assert_eq!(*radius, 2.0);
        assert!((semi_angle - PI / 6.0).abs() < 1e-14);
    });
    check_surface("#100=SPHERICAL_SURFACE('',#11,3);", |s| {
        assert!(matches!(s, Surface::Sphere { radius, .. } if *radius == 3.0));
    });
    for record in ["TOROIDAL_SURFACE('',#11,5.,1.)", "DEGENERATE_TOROIDAL_SURFACE('',#11,5.,1.,.T.)"] {
        check_surface(&format!("#100={record};"), |s| {
            let Surface::Torus { major_radius, minor_radius, .. } = s else { panic!("{s:?}") };
            assert_eq!((*major_radius, *minor_radius), (5.0, 1.0));
        });
    }
}

#[test]
fn swept_surfaces() {
    let line = "#101=LINE('',#12,#102);#102=VECTOR('',#14,4.);";
    check_surface(
        &format!("#100=SURFACE_OF_LINEAR_EXTRUSION('',#101,#103);{line}#103=VECTOR('',#13,3.);"),
        |s| {
            let Surface::LinearExtrusion { curve, direction } = s else { panic!("{s:?}") };
            assert_eq!(*direction, Vector3::new(0.0, 0.0, 3.0));
            assert_eq!(
                **curve,
                Curve::Line { origin: Point3::origin(), direction: Vector3::new(4.0, 0.0, 0.0) }
            );
        },
    );
    check_surface(
        &format!("#100=SURFACE_OF_REVOLUTION('',#101,#103);{line}#103=AXIS1_PLACEMENT('',#10,#13);"),
        |s| {
            let Surface::Revolution { frame, .. } = s else { panic!("{s:?}") };
            assert_eq!((frame.origin, frame.z), (Point3::new(1.0, 0.0, 0.0), Vector3::z()));
        },
    );
}

const NET: &str = "#111=CARTESIAN_POINT('',(0.,0.,0.));#112=CARTESIAN_POINT('',(0.,2.,0.));
#121=CARTESIAN_POINT('',(4.,0.,0.));#122=CARTESIAN_POINT('',(4.,2.,8.));";

#[test]
fn b_spline_surfaces_in_every_form() {
    let net = "1,1,((#111,#112),(#121,#122)),.UNSPECIFIED.,.F.,.F.,.U.";
    let forms = [
        format!("#100=B_SPLINE_SURFACE_WITH_KNOTS('',{net},(2,2),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.);"),
        format!("#100=QUASI_UNIFORM_SURFACE('',{net});"),
        format!("#100=BEZIER_SURFACE('',{net});"),
        format!("#100=UNIFORM_SURFACE('',{net});"),
        format!(
            "#100=(BOUNDED_SURFACE()B_SPLINE_SURFACE({net})B_SPLINE_SURFACE_WITH_KNOTS((2,2),(2,2),(0.,1.),(0.,1.),\
             .UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(((1.,1.),(1.,2.)))\
             REPRESENTATION_ITEM('')SURFACE());"
        ),
    ];
    for form in forms {
        check_surface(&(form.clone() + NET), |s| {
            let Surface::Nurbs(s) = s else { panic!("{s:?}") };
            // Bilinear: the centre is the mean of the corners, weighted where weights are.
            let weight = if form.contains("RATIONAL") { 2.0 } else { 1.0 };
            let sum = 3.0 + weight;
            let (u, v) = (mid(s.knots_u().domain()), mid(s.knots_v().domain()));
            let expected =
                Point3::new((4.0 + 4.0 * weight) / sum, (2.0 + 2.0 * weight) / sum, 8.0 * weight / sum);
            assert!((s.point(u, v) - expected).norm() < 1e-14, "{form}");
            assert!(s.knots_u().is_clamped() && s.knots_v().is_clamped());
        });
    }
}

fn mid((a, b): (f64, f64)) -> f64 {
    0.5 * (a + b)
}

#[test]
fn curves_in_every_form() {
    let (found, sink) = curve("#200=ELLIPSE('',#11,3.,2.);");
    assert_eq!(sink, []);
    assert!(matches!(found.read(), Some(Curve::Ellipse { semi_axis_1: 3.0, semi_axis_2: 2.0, .. })));
    let poles = "2,(#111,#112,#122),.UNSPECIFIED.,.F.,.F.";
    let weights = "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE((1.,3.,1.))REPRESENTATION_ITEM('')";
    let forms = [
        (format!("#200=B_SPLINE_CURVE_WITH_KNOTS('',{poles},(3,3),(0.,1.),.UNSPECIFIED.);"), 1.0),
        (format!("#200=QUASI_UNIFORM_CURVE('',{poles});"), 1.0),
        (format!("#200=BEZIER_CURVE('',{poles});"), 1.0),
        (format!("#200=(BEZIER_CURVE()BOUNDED_CURVE()B_SPLINE_CURVE({poles})CURVE(){weights});"), 3.0),
        (
            format!(
                "#200=(BOUNDED_CURVE()B_SPLINE_CURVE({poles})B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.),\
                 .UNSPECIFIED.)CURVE(){weights});"
            ),
            3.0,
        ),
    ];
    for (form, weight) in forms {
        let (found, sink) = curve(&(form.clone() + NET));
        assert_eq!(sink, [], "{form}");
        let Some(Curve::Nurbs(c)) = found.read() else { panic!("{found:?}") };
        // Bernstein polynomials at one half are 1/4, 1/2, 1/4.
        let sum = 0.5 + 0.5 * weight;
        let expected = Point3::new(1.0, weight + 0.5, 2.0) / sum;
        assert!((c.point_at(0.5) - expected).norm() < 1e-14, "{form}");
    }
}

#[test]
fn a_uniform_quadratic_begins_half_way_between_its_first_points() {
    let (found, sink) =
        curve(&["#200=UNIFORM_CURVE('',2,(#111,#112,#122),.UNSPECIFIED.,.F.,.F.);", NET].concat());
    assert_eq!(sink, []);
    let Some(Curve::Nurbs(c)) = found.read() else { panic!("{found:?}") };
    assert_eq!(c.knots().domain(), (0.0, 1.0));
    assert!((c.point_at(0.0) - Point3::new(0.0, 1.0, 0.0)).norm() < 1e-14);
}

#[test]
fn trimmed_curves_of_the_same_sense_stand_for_their_basis() {
    let trimmed = |sense: &str| {
        format!(
            "#200=TRIMMED_CURVE('',#201,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(90.)),{sense},.PARAMETER.);\
             #201=CIRCLE('',#11,1.);"
        )
    };
    assert!(matches!(curve(&trimmed(".T.")).0.read(), Some(Curve::Circle { .. })));
    // Backwards from 0° to 90° is three quarters of the turn.
    let backward = curve(&trimmed(".F.")).0;
    let (start, end) = backward.read().expect("kept as it is").domain();
    assert!((end - start - 1.5 * PI).abs() < 1e-12);
}

#[test]
fn pcurves_are_in_radians_and_a_seam_has_one_for_each_use() {
    let (model, sink) = read(&[
        FACE.replace("EDGE_LOOP('',(#7))", "EDGE_LOOP('',(#7,#77))").as_str(),
        "#77=ORIENTED_EDGE('',*,*,#8,.T.);#100=CYLINDRICAL_SURFACE('',#11,1.);",
        "#200=SEAM_CURVE('',#201,(#210,#220),.CURVE_3D.);#201=LINE('',#10,#202);#202=VECTOR('',#13,1.);",
        "#210=PCURVE('',#100,#211);#211=DEFINITIONAL_REPRESENTATION('',(#212),#230);#212=LINE('',#213,#231);",
        "#213=CARTESIAN_POINT('',(0.,7.));",
        "#220=PCURVE('',#100,#221);#221=DEFINITIONAL_REPRESENTATION('',(#222),#230);#222=LINE('',#223,#231);",
        "#223=CARTESIAN_POINT('',(360.,7.));#231=VECTOR('',#232,1.);#232=DIRECTION('',(0.,1.));",
        "#230=(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()REPRESENTATION_CONTEXT('',''));",
        DEGREES,
    ]
    .concat());
    assert_eq!(sink, []);
    let starts: Vec<(bool, [f64; 2])> = model
        .brep
        .coedges
        .iter()
        .map(|(_, coedge)| match &coedge.pcurve {
            Some(Curve2d::Line { origin, .. }) => (coedge.forward, [origin.x, origin.y]),
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(!starts[0].0 && (starts[0].1[0] - 2.0 * PI).abs() < 1e-13 && starts[0].1[1] == 7.0);
    assert_eq!(starts[1], (true, [0.0, 7.0]));
}

#[test]
fn bad_data_are_carried_with_the_exact_reason() {
    let curve_of = |knots: &str| {
        let text = format!(
            "#200=B_SPLINE_CURVE_WITH_KNOTS('',2,(#111,#112,#122),.UNSPECIFIED.,.F.,.F.,{knots},.U.);"
        );
        let (found, sink) = curve(&(text + NET));
        assert_eq!(sink.len(), 1);
        (sink[0].code, refused(&found).to_owned(), sink[0].message.clone())
    };
    let (code, reason, message) = curve_of("(3,2),(0.,1.)");
    assert_eq!(code, "step.bad-geometry");
    assert_eq!(reason, "6 knots expected for degree 2 and 3 control points, found 5");
    assert_eq!(message, format!("B_SPLINE_CURVE_WITH_KNOTS: {reason}"));
    assert!(curve_of("(3,3),(1.,0.)").1.contains("knot 3 is 0"));
    assert!(curve_of("(3,3),(0.,1.E400)").1.contains("not a finite number"));
    assert!(curve_of("(3,9223372036854775807),(0.,1.)").1.contains("6 knots expected"));
    assert_eq!(
        refused(&surface("#100=CYLINDRICAL_SURFACE('',#11,-1.);").0),
        "radius is -1, expected a positive number"
    );
    assert_eq!(
        refused(&surface("#100=SPHERICAL_SURFACE('',#11,$);").0),
        "radius is `$`, expected a finite number"
    );
    assert_eq!(
        refused(&surface("#100=OFFSET_SURFACE('',#11,1.,.F.);").0),
        "basis_surface #11 AXIS2_PLACEMENT_3D: #11 is AXIS2_PLACEMENT_3D, expected SURFACE"
    );
    assert_eq!(refused(&surface("#100=!MINE(1);").0), "not read yet");
    let (found, sink) = surface("");
    assert_eq!(refused(&found), "#100 is not in the file");
    assert_eq!((sink[0].code, sink[0].entity.as_deref()), ("step.dangling-reference", Some("#4")));
}

#[test]
fn weights_and_nets_must_fit() {
    let rational = |weights: &str| {
        let net = "1,1,((#111,#112),(#121,#122)),.UNSPECIFIED.,.F.,.F.,.U.";
        let text = format!(
            "#100=(BEZIER_SURFACE()BOUNDED_SURFACE()B_SPLINE_SURFACE({net})RATIONAL_B_SPLINE_SURFACE({weights}));"
        );
        refused(&surface(&(text + NET)).0).to_owned()
    };
    assert_eq!(rational("((1.,1.),(1.))"), "4 weights expected, found 3");
    assert_eq!(rational("((1.,1.),(1.,0.))"), "weight 3 is 0, expected a positive number");
    assert_eq!(rational(""), "weights_data is missing, expected a list");
    let ragged = "#100=BEZIER_SURFACE('',1,1,((#111,#112),(#121)),.UNSPECIFIED.,.F.,.F.,.U.);";
    let (found, _) = surface(&(ragged.to_owned() + NET));
    assert_eq!(refused(&found), "row 1 of the net has 1 members, expected 2");
}

#[test]
fn cycles_end() {
    let swap = |from: &str, to: &str| read(&[FACE, CIRCLE, PLANE, DEGREES].concat().replace(from, to));
    for (from, to) in [
        ("#7=ORIENTED_EDGE('',*,*,#8,.F.)", "#7=ORIENTED_EDGE('',*,*,#7,.F.)"),
        ("#200=CIRCLE('',#11,1.)", "#200=SURFACE_CURVE('',#200,(),.CURVE_3D.)"),
        ("#8=EDGE_CURVE('',#9,#9,#200,.T.)", "#8=SUBEDGE('',#9,#9,#8)"),
    ] {
        let (model, sink) = swap(from, to);
        assert!(sink.iter().any(|d| d.code == "step.cycle"), "{to}: {sink:?}");
        // The face keeps its place, but nobody may take it for one without a bound.
        let face = model.brep.faces.ids().next().expect("kept");
        assert!(refused(model.brep.surface_of(face)).starts_with("bound #5 cannot be built"));
    }
    for (from, to) in [
        ("#4=ADVANCED_FACE('top',(#5),#100,.F.)", "#4=ORIENTED_FACE('',*,#4,.T.)"),
        ("#3=OPEN_SHELL('',(#4))", "#3=ORIENTED_OPEN_SHELL('',*,#3,.T.)"),
    ] {
        let (model, sink) = swap(from, to);
        assert!(sink.iter().any(|d| d.code == "step.cycle"), "{to}: {sink:?}");
        assert_eq!(model.brep.faces.len(), 0);
    }
    let (model, sink) = swap("PLANE_ANGLE_MEASURE(0.0174532925199433),#904", "PLANE_ANGLE_MEASURE(2.),#902");
    assert!(sink.iter().any(|d| d.code == "step.unknown-unit"));
    assert_eq!(model.contexts[0].angle.name, "rad");
}

#[test]
fn units_by_conversion_and_prefix() {
    let with = |units: &str| {
        let context = format!(
            "#900=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#901))\
             REPRESENTATION_CONTEXT('',''));{units}"
        );
        let (model, sink) = read(&[FACE, CIRCLE, PLANE, &context].concat());
        let length = model.contexts[0].length.clone();
        (length.name, length.metres, sink.iter().map(|d| d.code).collect::<Vec<_>>())
    };
    let no_angle = vec!["step.missing-unit"];
    let inch = "#901=(CONVERSION_BASED_UNIT('inch',#902)LENGTH_UNIT()NAMED_UNIT(#907));
        #902=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#903);
        #903=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));";
    let (name, metres, codes) = with(inch);
    assert_eq!((name.as_str(), codes), ("inch", no_angle.clone()));
    assert!((metres - 0.0254).abs() < 1e-17);
    let centimetre = "#901=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));";
    assert_eq!(with(centimetre), ("cm".to_owned(), 1e-2, no_angle));
    let missing = vec!["step.missing-unit"; 2];
    assert_eq!(
        with("#901=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());"),
        ("mm".to_owned(), 1e-3, missing)
    );
}

#[test]
fn colours_layers_and_products_reach_the_face() {
    let (model, sink) = read(
        &[
            FACE,
            CIRCLE,
            PLANE,
            DEGREES,
            "#300=STYLED_ITEM('',(#301),#2);#301=PRESENTATION_STYLE_ASSIGNMENT((#302));",
            "#302=SURFACE_STYLE_USAGE(.BOTH.,#303);#303=SURFACE_SIDE_STYLE('',(#304));",
            "#304=SURFACE_STYLE_FILL_AREA(#305);#305=FILL_AREA_STYLE('',(#306));",
            "#306=FILL_AREA_STYLE_COLOUR('',#307);#307=COLOUR_RGB('',0.25,0.5,1.);",
            "#310=OVER_RIDING_STYLED_ITEM('',(#311),#4,#300);#311=PRESENTATION_STYLE_ASSIGNMENT((#312));",
            "#312=SURFACE_STYLE_USAGE(.BOTH.,#313);#313=SURFACE_SIDE_STYLE('',(#314));",
            "#314=SURFACE_STYLE_FILL_AREA(#315);#315=FILL_AREA_STYLE('',(#316));",
            "#316=FILL_AREA_STYLE_COLOUR('',#317);#317=DRAUGHTING_PRE_DEFINED_COLOUR('red');",
            "#320=PRESENTATION_LAYER_ASSIGNMENT('12','',(#310,#2));",
            "#400=PRODUCT('id','T\\X\\FCr','',());#401=PRODUCT_DEFINITION_FORMATION('','',#400);",
            "#402=PRODUCT_DEFINITION('','',#401,$);#403=PRODUCT_DEFINITION_SHAPE('','',#402);",
            "#404=SHAPE_DEFINITION_REPRESENTATION(#403,#405);#405=SHAPE_REPRESENTATION('',(#11),#900);",
            "#406=SHAPE_REPRESENTATION_RELATIONSHIP('','',#405,#1);",
        ]
        .concat(),
    );
    assert_eq!(sink, []);
    let face = model.brep.faces.ids().next().expect("one face");
    let rgb = |colour: Option<crate::model::Colour>| colour.map(|c| [c.red, c.green, c.blue]);
    assert_eq!(rgb(model.colour_of(face)), Some([1.0, 0.0, 0.0]));
    assert_eq!(rgb(model.bodies[model.body_of(face)].own.appearance.colour), Some([0.25, 0.5, 1.0]));
    assert_eq!(model.layers_of(face).collect::<Vec<_>>(), ["12", "12"]);
    assert_eq!(model.product_of(face).map(|p| p.name.as_str()), Some("Tür"));
}

#[test]
fn faceted_solids_share_the_edges_of_their_poly_loops() {
    let face = |id: u32, points: &str| {
        format!(
            "#{id}=FACE_SURFACE('',(#{b}),#100,.T.);#{b}=FACE_OUTER_BOUND('',#{l},.T.);#{l}=POLY_LOOP('',({points}));",
            b = id + 1,
            l = id + 2
        )
    };
    let (model, sink) = read(
        &[
            "#1=FACETED_BREP_SHAPE_REPRESENTATION('',(#2),#900);#2=FACETED_BREP('',#3);",
            "#3=CLOSED_SHELL('',(#10,#20,#30,#40));",
            &face(10, "#111,#121,#112"),
            &face(20, "#111,#112,#122"),
            &face(30, "#112,#121,#122"),
            &face(40, "#121,#111,#122"),
            "#100=PLANE('',#11);#11=AXIS2_PLACEMENT_3D('',#111,$,$);"
                .replace("#11=", "#19=")
                .replace("#11)", "#19)")
                .as_str(),
            NET,
            DEGREES,
        ]
        .concat(),
    );
    assert_eq!(sink, []);
    // A tetrahedron: 4 - 6 + 4 = 2.
    let inventory = Inventory::of(&model);
    assert_eq!((inventory.solids, inventory.faces, inventory.edges, inventory.vertices), (1, 4, 6, 4));
    assert!(model.brep.faces_of_edges().iter().all(|(_, faces)| faces.len() == 2));
}

#[test]
fn a_shell_without_a_body_is_a_body_and_said_so() {
    let (model, sink) =
        read(&[FACE, CIRCLE, PLANE, DEGREES].concat().replace("SHELL_BASED_SURFACE_MODEL", "!OTHER"));
    assert_eq!(model.brep.faces.len(), 1);
    assert!(sink.iter().any(|d| d.code == "step.loose-body"), "{sink:?}");
}

/// The only diagnostic of a file whose context records are changed.
fn told(from: &str, to: &str) -> Vec<(&'static str, String, String)> {
    let context = DEGREES.replace(from, to);
    assert_ne!(context, DEGREES, "{from} stands in the context");
    let (_, sink) = read(&[FACE, CIRCLE, PLANE, &context].concat());
    assert!(sink.iter().all(|fact| fact.span.is_some()), "every fact has a line: {sink:?}");
    sink.into_iter().map(|fact| (fact.code, fact.entity.unwrap_or_default(), fact.message)).collect()
}

#[test]
fn an_uncertainty_that_is_no_positive_length_is_told() {
    let cases = [
        ("0.", "value_component is 0, expected a positive number"),
        ("-1.E-3", "value_component is -0.001, expected a positive number"),
        ("1.E999", "value_component is a real out of range, expected a finite number"),
        ("'small'", "value_component is a string, expected a finite number"),
    ];
    for (value, message) in cases {
        let told = told("LENGTH_MEASURE(1.E-3)", &format!("LENGTH_MEASURE({value})"));
        let [(code, entity, text)] = told.as_slice() else { panic!("{value}: {told:?}") };
        assert_eq!((*code, entity.as_str()), ("step.bad-uncertainty", "#905"));
        assert!(text.contains(message), "{value}: {text}");
    }
    let told = told("CONTEXT((#905))", "CONTEXT((#888))");
    assert_eq!((told[0].0, told[0].1.as_str()), ("step.bad-uncertainty", "#900"), "{told:?}");
}

#[test]
fn units_that_are_misspelt_or_missing_are_told() {
    let cases = [
        (".METRE.", ".METRR.", "#901", "`METRR`", "no unit of length: millimetre"),
        (".METRE.", ".GRAM.", "#901", "`GRAM`", "no unit of length: millimetre"),
        (".MILLI.", ".MILI.", "#901", "`MILI`", "no unit of length: millimetre"),
        (".RADIAN.", ".RADIANT.", "#902", "`RADIANT`", "no unit of plane angle: radian"),
        ("(0.0174532925199433)", "(0.)", "#902", "conversion_factor is 0", "no unit of plane angle: radian"),
        ("(0.0174532925199433)", "(-1.)", "#902", "conversion_factor is -1", "no unit of plane angle"),
        ("((#901,#902))", "((#777,#902))", "#900", "#777 is not in the file", "no unit of length"),
    ];
    for (from, to, entity, said, assumed) in cases {
        let told = told(from, to);
        let unit = told.iter().find(|fact| fact.0 == "step.unknown-unit").expect("the unit is told");
        assert!(unit.1 == entity && unit.2.contains(said), "{to}: {told:?}");
        let missing = told.iter().find(|fact| fact.0 == "step.missing-unit").expect("the assumption is told");
        assert!(missing.1 == "#900" && missing.2.contains(assumed), "{to}: {told:?}");
    }
    let told = told("((#901,#902))", "((#902))");
    assert!(matches!(told.as_slice(), [("step.missing-unit", entity, _)] if entity == "#900"), "{told:?}");
}

#[test]
fn what_a_header_lacks_is_told() {
    let records = [
        ("FILE_DESCRIPTION", "FILE_DESCRIPTION((''),'2;1');"),
        ("FILE_NAME", "FILE_NAME('','',(''),(''),'','','');"),
        ("FILE_SCHEMA", "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));"),
    ];
    let told = |header: &str| {
        let text = format!("ISO-10303-21;\nHEADER;{header}ENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n");
        let mut sink: Vec<Diagnostic> = Vec::new();
        let file = ExchangeStructure::parse(Source::new(text.into_bytes()).expect("small"), &mut sink);
        to_model(&file, &mut sink);
        assert!(sink.iter().all(|fact| fact.code == "step.bad-header" && fact.span.is_some()), "{sink:?}");
        sink.into_iter().map(|fact| (fact.entity.unwrap_or_default(), fact.message)).collect::<Vec<_>>()
    };
    let whole = records.map(|(_, record)| record).concat();
    assert_eq!(told(&whole), []);
    for (keyword, record) in records {
        let told = told(&whole.replace(record, ""));
        assert!(
            matches!(told.as_slice(), [(entity, text)] if entity == keyword && text.contains("no ")),
            "{told:?}"
        );
    }
    let cases =
        [("(('AUTOMOTIVE_DESIGN'))", "(())", "no schema"), (",'2;1'", "", "1 attributes, expected 2")];
    for (from, to, message) in cases {
        let told = told(&whole.replace(from, to));
        assert!(matches!(told.as_slice(), [(_, text)] if text.contains(message)), "{told:?}");
    }
}

#[test]
fn a_face_that_its_shell_lists_twice_counts_once() {
    let (model, sink) = read(&[FACE, CIRCLE, PLANE, DEGREES].concat().replace("('',(#4))", "('',(#4,#4))"));
    assert_eq!(model.brep.faces.len(), 1);
    assert!(
        matches!(sink.as_slice(), [fact] if fact.code == "step.repeated-face"
        && fact.entity.as_deref() == Some("#3") && fact.message.contains("#4")),
        "{sink:?}"
    );
}

#[test]
fn numbers_beyond_the_finite_ones_have_a_code_of_their_own() {
    for (from, to) in [("(0.,0.,0.)", "(0.,1.E999,0.)"), ("#11,1.)", "#11,1.E999)")] {
        let (_, sink) = read(&[FACE, CIRCLE, PLANE, DEGREES].concat().replacen(from, to, 1));
        assert!(sink.iter().any(|fact| fact.code == "step.not-finite"), "{to}: {sink:?}");
    }
}
