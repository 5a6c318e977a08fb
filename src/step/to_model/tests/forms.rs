//! The curves and surfaces of ISO 10303-42 that are made of others, and the open conics; expected values are
//! closed forms.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

use super::*;

/// The edge's curve of some records, read without a word.
fn good_curve(records: &str) -> Curve {
    let (found, sink) = curve(records);
    assert_eq!(sink, []);
    found.read().expect("read").clone()
}

fn good_surface(records: &str) -> Surface {
    let (found, sink) = surface(records);
    assert_eq!(sink, []);
    found.read().expect("read").clone()
}

#[track_caller]
fn near(found: Point3<f64>, expected: [f64; 3]) {
    assert!((found - Point3::from(expected)).norm() < 1e-12, "{found:?} {expected:?}");
}

#[test]
fn open_conics_are_parametrised_as_the_standard_says() {
    // λ(u) = C + F (u² x + 2 u y), and C + R1 cosh u x + R2 sinh u y.
    let parabola = good_curve("#200=PARABOLA('',#11,3.);");
    near(parabola.point_at(2.0), [12.0, 12.0, 0.0]);
    near(Point3::from(parabola.derivatives(2.0)[1]), [12.0, 6.0, 0.0]);
    let hyperbola = good_curve("#200=HYPERBOLA('',#11,2.,5.);");
    near(hyperbola.point_at(1.0), [2.0 * 1f64.cosh(), 5.0 * 1f64.sinh(), 0.0]);
    // A negative focal distance opens the other way.
    near(good_curve("#200=PARABOLA('',#11,-3.);").point_at(2.0), [-12.0, -12.0, 0.0]);
    assert_eq!(refused(&curve("#200=PARABOLA('',#11,0.);").0), "focal_dist is 0, expected a positive number");
}

#[test]
fn parameters_of_open_conics_are_found_again() {
    for records in ["#200=PARABOLA('',#11,3.);", "#200=HYPERBOLA('',#11,2.,5.);"] {
        let curve = good_curve(records);
        for t in [-3.0, -0.7, 0.0, 0.2, 1.9, 4.0] {
            let found = curve.parameter_of(&curve.point_at(t), None);
            assert!((found - t).abs() < 1e-10, "{records} {t} {found}");
        }
    }
    // Off the curve, on the axis beyond the centre of curvature: the feet are symmetric, y = ±2 F sqrt((x - 2F)/F).
    let found = good_curve("#200=PARABOLA('',#11,1.);").parameter_of(&Point3::new(6.0, 0.0, 0.0), None);
    assert!((found.abs() - 2.0).abs() < 1e-10, "{found}");
}

#[test]
fn a_polyline_has_a_point_at_each_whole_number() {
    let points = "#210=CARTESIAN_POINT('',(0.,0.,0.));#211=CARTESIAN_POINT('',(4.,0.,0.));#212=CARTESIAN_POINT('',(4.,2.,0.));";
    let curve = good_curve(&format!("#200=POLYLINE('',(#210,#211,#212));{points}"));
    assert_eq!((curve.kind(), curve.domain()), ("polyline", (0.0, 2.0)));
    near(curve.point_at(0.25), [1.0, 0.0, 0.0]);
    near(curve.point_at(1.5), [4.0, 1.0, 0.0]);
    assert!((curve.parameter_of(&Point3::new(5.0, 1.0, 7.0), None) - 1.5).abs() < 1e-15);
    // Beyond the corner the corner is nearest.
    assert!((curve.parameter_of(&Point3::new(5.0, -1.0, 0.0), None) - 1.0).abs() < 1e-15);
}

/// A backward piece of the circle of radius 2, from 90° to 30°, as its own curve: an edge's own curve of the
/// opposite sense is kept.
const BACKWARD: &str =
    "#200=TRIMMED_CURVE('',#201,(PARAMETER_VALUE(90.)),(PARAMETER_VALUE(30.)),.F.,.PARAMETER.);
#201=CIRCLE('',#11,2.);";

#[test]
fn a_piece_against_its_basis_runs_from_the_first_trim_to_the_second_in_degrees() {
    let curve = good_curve(BACKWARD);
    let (start, end) = curve.domain();
    assert!((end - start - (FRAC_PI_2 - FRAC_PI_6)).abs() < 1e-13);
    near(curve.point_at(start), [0.0, 2.0, 0.0]);
    near(curve.point_at(end), [2.0 * FRAC_PI_6.cos(), 1.0, 0.0]);
    assert_eq!(curve.period(), None);
    for share in [0.1, 0.5, 0.9] {
        let t = start + share * (end - start);
        assert!((curve.parameter_of(&curve.point_at(t), None) - t).abs() < 1e-13);
    }
}

#[test]
fn trims_by_point_and_over_the_seam() {
    // From 270° to 90° along the circle: over the seam at 0°.
    let swept = |trims: &str| {
        let records = format!(
            "#100=SURFACE_OF_LINEAR_EXTRUSION('',#210,#113);#113=VECTOR('',#13,1.);
             #210=COMPOSITE_CURVE('',(#211),.F.);#211=COMPOSITE_CURVE_SEGMENT(.DISCONTINUOUS.,.T.,#212);
             #212=TRIMMED_CURVE('',#213,{trims},.T.,.CARTESIAN.);#213=CIRCLE('',#11,2.);
             #220=CARTESIAN_POINT('',(0.,-2.,0.));#221=CARTESIAN_POINT('',(0.,2.,0.));"
        );
        match good_surface(&records) {
            Surface::LinearExtrusion { curve, .. } => *curve,
            other => panic!("{other:?}"),
        }
    };
    for trims in [
        "(#220,PARAMETER_VALUE(1.)),(#221,PARAMETER_VALUE(2.))",
        "(#220),(#221)",
        "(PARAMETER_VALUE(270.)),(PARAMETER_VALUE(90.))",
    ] {
        let curve = swept(trims);
        let (start, end) = curve.domain();
        assert!(start == 0.0 && (end - PI).abs() < 1e-12, "{end}");
        near(curve.point_at(0.0), [0.0, -2.0, 0.0]);
        near(curve.point_at(FRAC_PI_2), [2.0, 0.0, 0.0]);
        near(curve.point_at(end), [0.0, 2.0, 0.0]);
    }
}

#[test]
fn a_composite_goes_through_its_segments() {
    // A line from (4, 0, 0) back to (2, 0, 0), then a quarter of the circle of radius 2.
    let curve = good_curve(
        "#200=COMPOSITE_CURVE('',(#211,#221),.F.);
         #211=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.F.,#212);
         #212=POLYLINE('',(#213,#214));#213=CARTESIAN_POINT('',(2.,0.,0.));#214=CARTESIAN_POINT('',(4.,0.,0.));
         #221=COMPOSITE_CURVE_SEGMENT(.DISCONTINUOUS.,.T.,#222);
         #222=TRIMMED_CURVE('',#223,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(90.)),.T.,.PARAMETER.);
         #223=CIRCLE('',#11,2.);",
    );
    let (start, end) = curve.domain();
    assert!(start == 0.0 && (end - 1.0 - FRAC_PI_2).abs() < 1e-13);
    near(curve.point_at(0.0), [4.0, 0.0, 0.0]);
    near(curve.point_at(0.75), [2.5, 0.0, 0.0]);
    near(curve.point_at(1.0 + FRAC_PI_6), [2.0 * FRAC_PI_6.cos(), 1.0, 0.0]);
    assert!((curve.parameter_of(&Point3::new(0.0, 3.0, 0.0), None) - end).abs() < 1e-13);
    let unbounded = "#200=COMPOSITE_CURVE('',(#211),.F.);#211=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#212);
         #212=PARABOLA('',#11,1.);";
    assert!(refused(&curve_of(unbounded)).contains("without ends"));
}

fn curve_of(records: &str) -> Carried<Curve> {
    curve(records).0
}

#[test]
fn an_offset_of_a_circle_is_a_circle() {
    // V × T = z × (0, 1, 0) = (-1, 0, 0) at angle 0: inwards.
    let curve = good_curve("#200=OFFSET_CURVE_3D('',#201,0.5,.F.,#13);#201=CIRCLE('',#11,2.);");
    for t in [0.0f64, 1.0, 4.0] {
        near(curve.point_at(t), [1.5 * t.cos(), 1.5 * t.sin(), 0.0]);
        near(Point3::from(curve.derivatives(t)[1]), [-1.5 * t.sin(), 1.5 * t.cos(), 0.0]);
        assert!((curve.derivatives(t)[2].norm() - 1.5).abs() < 1e-6);
        assert!((curve.parameter_of(&curve.point_at(t), None) - t).abs() < 1e-12);
    }
}

#[test]
fn offsets_of_quadrics_are_quadrics() {
    let surface = good_surface("#100=OFFSET_SURFACE('',#101,-0.5,.F.);#101=SPHERICAL_SURFACE('',#11,2.);");
    for (u, v) in [(0.3, 0.4), (5.0, -1.2), (1.0, FRAC_PI_2)] {
        let d = surface.derivatives(u, v);
        assert!((d.point.coords.norm() - 1.5).abs() < 1e-9, "{u} {v}");
        let (found_u, found_v) = surface.parameters_of(&d.point, None);
        assert!((found_v - v).abs() < 1e-7 && (v > 1.5 || (found_u - u).abs() < 1e-12));
    }
    // Exact first derivatives, second ones by differences.
    let exact = Surface::Sphere {
        frame: crate::math::Frame::from_axis(Point3::origin(), Vector3::z(), None).expect("axes"),
        radius: 1.5,
    };
    let (a, b) = (surface.derivatives(0.3, 0.4), exact.derivatives(0.3, 0.4));
    assert!((a.du - b.du).norm() < 1e-14 && (a.dv - b.dv).norm() < 1e-14);
    assert!((a.duu - b.duu).norm() < 1e-8 && (a.duv - b.duv).norm() < 1e-8 && (a.dvv - b.dvv).norm() < 1e-8);
}

#[test]
fn rectangles_of_surfaces_count_in_the_file_s_angles() {
    let surface = good_surface(
        "#100=RECTANGULAR_TRIMMED_SURFACE('',#101,350.,10.,-1.,4.,.T.,.F.);#101=CYLINDRICAL_SURFACE('',#11,2.);",
    );
    // With the second sense turned, v runs from the trim v1 down to v2; an open surface has one piece.
    let ((u0, u1), (v0, v1)) = surface.domain();
    assert!((u1 - u0 - PI / 9.0).abs() < 1e-12 && (v0, v1) == (-4.0, 1.0), "{:?}", surface.domain());
    near(surface.point(u0 + PI / 18.0, -3.0), [2.0, 0.0, 3.0]);
    let normal = surface.normal(u0, 0.0).expect("regular");
    assert!(normal.x < -0.9, "the turned parameter turns the normal");
    let (u, v) = surface.parameters_of(&Point3::new(2.0, 0.0, 3.0), None);
    assert!((u - u0 - PI / 18.0).abs() < 1e-12 && (v + 3.0).abs() < 1e-12);
    let basis = good_surface("#100=CURVE_BOUNDED_SURFACE('',#101,(),.T.);#101=PLANE('',#11);");
    assert_eq!(basis.kind(), "curve_bounded");
    near(basis.point(1.0, 2.0), [1.0, 2.0, 0.0]);
}

#[test]
fn a_composite_surface_is_a_grid_of_unit_squares() {
    let surface = good_surface(
        "#100=RECTANGULAR_COMPOSITE_SURFACE('',((#110),(#120)));
         #110=SURFACE_PATCH(#111,.CONTINUOUS.,.CONTINUOUS.,.T.,.T.);
         #120=SURFACE_PATCH(#121,.CONTINUOUS.,.CONTINUOUS.,.F.,.T.);
         #111=RECTANGULAR_TRIMMED_SURFACE('',#130,0.,4.,0.,2.,.T.,.T.);
         #121=RECTANGULAR_TRIMMED_SURFACE('',#130,4.,8.,0.,2.,.T.,.T.);
         #130=PLANE('',#11);",
    );
    assert_eq!(surface.domain(), ((0.0, 2.0), (0.0, 1.0)));
    assert_eq!(surface.periods(), (None, None));
    near(surface.point(0.5, 0.5), [2.0, 1.0, 0.0]);
    // The second patch runs backwards in u.
    near(surface.point(1.25, 0.5), [7.0, 1.0, 0.0]);
    near(Point3::from(surface.derivatives(1.25, 0.5).du), [-4.0, 0.0, 0.0]);
    let (u, v) = surface.parameters_of(&Point3::new(7.0, 1.0, 0.0), None);
    assert!((u - 1.25).abs() < 1e-12 && (v - 0.5).abs() < 1e-12);
}

#[test]
fn conics_on_surfaces_with_an_angle_and_a_length_keep_their_parameter() {
    // On a cylinder counted in degrees: centre (90°, 5), radius 30, so that u reaches ±30° and v ±30.
    let pcurve = "#300=SURFACE_CURVE('',#200,(#301),.CURVE_3D.);#301=PCURVE('',#100,#302);
        #302=DEFINITIONAL_REPRESENTATION('',(#303),#309);#309=PARAMETRIC_REPRESENTATION_CONTEXT('','');
        #303=CIRCLE('',#304,30.);#304=AXIS2_PLACEMENT_2D('',#305,$);#305=CARTESIAN_POINT('',(90.,5.));
        #100=CYLINDRICAL_SURFACE('',#11,1.);";
    let records = [FACE, CIRCLE, DEGREES, pcurve].concat().replace("#9,#9,#200,.T.", "#9,#9,#300,.T.");
    let (model, sink) = read(&records);
    assert_eq!(sink, []);
    let coedge = model.brep.coedges.ids().next().expect("one coedge");
    let found = model.brep.coedges[coedge].pcurve.as_ref().expect("read");
    let at = |t: f64| found.point_at(t);
    assert!((at(0.0).x - (FRAC_PI_2 + FRAC_PI_6)).abs() < 1e-13 && (at(0.0).y - 5.0).abs() < 1e-13);
    assert!((at(FRAC_PI_2).x - FRAC_PI_2).abs() < 1e-13 && (at(FRAC_PI_2).y - 35.0).abs() < 1e-13);
}

/// Twice the size, the first axis along y, then moved by (10, 0, 1).
const OPERATOR: &str = "#150=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#151,$,#152,2.,#153);
    #151=DIRECTION('',(0.,1.,0.));#152=CARTESIAN_POINT('',(10.,0.,1.));#153=DIRECTION('',(0.,0.,1.));";

#[test]
fn replicas_are_images_of_their_parents() {
    // (x, y, z) goes to (10 - 2 y, 2 x, 1 + 2 z).
    let circle = good_curve(&format!("#200=CURVE_REPLICA('',#201,#150);#201=CIRCLE('',#11,3.);{OPERATOR}"));
    near(circle.point_at(0.0), [10.0, 6.0, 1.0]);
    near(circle.point_at(FRAC_PI_2), [4.0, 0.0, 1.0]);
    let replica = "#100=SURFACE_REPLICA('',#101,#150);";
    let sphere = good_surface(&format!("{replica}#101=SPHERICAL_SURFACE('',#11,1.5);{OPERATOR}"));
    for (u, v) in [(0.0, 0.0), (2.0, 0.7), (4.0, -1.1)] {
        assert!(((sphere.point(u, v) - Point3::new(10.0, 0.0, 1.0)).norm() - 3.0).abs() < 1e-12);
    }
    near(sphere.point(0.0, 0.0), [10.0, 3.0, 1.0]);
    // The scale is in the basis vectors of a plane's parameters no more than in a cylinder's.
    let plane = good_surface(&format!("{replica}#101=PLANE('',#11);{OPERATOR}"));
    assert!((plane.normal(0.3, 4.0).expect("regular") - Vector3::z()).norm() < 1e-15);
    near(plane.point(0.0, 0.0), [10.0, 0.0, 1.0]);
    // Mirrored in z, the normal of the parent's parametrisation comes to point along -z.
    let mirror =
        OPERATOR.replace("#153);", "#154);#154=DIRECTION('',(0.,0.,1.));").replace("#151,$,", "#151,#155,")
            + "#155=DIRECTION('',(1.,0.,0.));";
    for parent in ["PLANE('',#11)", "CYLINDRICAL_SURFACE('',#11,1.5)"] {
        let mirrored = good_surface(&format!("{replica}#101={parent};{mirror}"));
        let plain = good_surface(&format!("#100={parent};"));
        // (x, y, z) goes to (10 + 2 y, 2 x, 1 + 2 z).
        let image = |[x, y, z]: [f64; 3]| [10.0 + 2.0 * y, 2.0 * x, 1.0 + 2.0 * z];
        near(mirrored.point(0.3, 0.7), image(plain.point(0.3, 0.7).coords.into()));
        let [nx, ny, nz] = plain.normal(0.3, 0.7).expect("regular").into();
        let expected = -Vector3::new(ny, nx, nz);
        assert!((mirrored.normal(0.3, 0.7).expect("regular") - expected).norm() < 1e-12, "{parent}");
    }
    let (found, _) = surface(&format!("#100=SURFACE_REPLICA('',#100,#150);{OPERATOR}"));
    assert!(refused(&found).contains("nested too deep"), "{found:?}");
}

#[test]
fn geometry_that_is_made_of_itself_ends() {
    let (found, sink) = curve(
        "#200=COMPOSITE_CURVE('',(#211,#211),.F.);#211=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#200);",
    );
    assert!(refused(&found).contains("nested too deep"), "{found:?}");
    assert_eq!(sink[0].code, "step.cycle");
    let (found, _) = surface("#100=OFFSET_SURFACE('',#100,1.,.F.);");
    assert!(refused(&found).contains("nested too deep"), "{found:?}");
    let (found, sink) = surface("#100=OFFSET_SURFACE('',#101,1.,.F.);#101=!MINE(1);");
    assert_eq!(refused(&found), "basis_surface #101 !MINE: not read yet");
    assert_eq!(sink[0].code, "step.not-read-yet");
}
