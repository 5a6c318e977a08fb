//! Faces on the rarer curves and surfaces of ISO 10303-42, from the text of a file to triangles: areas and places by
//! closed forms.

use std::f64::consts::PI;

use resurf::diagnostic::Diagnostics;
use resurf::math::Point3;
use resurf::mesh::{Mesh, Tolerances, tessellate_bodies};
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model};

/// One face `#4` in millimetres and degrees, on `#100`, with the bounds that the records give.
fn mesh(records: &str) -> Mesh {
    let text = format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n\
         #1=SHAPE_REPRESENTATION('',(#2),#900);\n#2=SHELL_BASED_SURFACE_MODEL('',(#3));\n#3=OPEN_SHELL('',(#4));\n\
         #11=AXIS2_PLACEMENT_3D('',#12,#13,#14);\n#12=CARTESIAN_POINT('',(0.,0.,0.));\n\
         #13=DIRECTION('',(0.,0.,1.));\n#14=DIRECTION('',(1.,0.,0.));\n\
         #900=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#905))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#902))REPRESENTATION_CONTEXT('',''));\n\
         #901=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
         #902=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
         #905=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),#901,'distance_accuracy_value','');\n\
         {records}\nENDSEC;\nEND-ISO-10303-21;\n"
    );
    let mut sink = Diagnostics::default();
    let file = ExchangeStructure::parse(Source::new(text.into_bytes()).expect("small"), &mut sink);
    let model = to_model(&file, &mut sink);
    let bodies: Vec<_> = model.brep.bodies.ids().collect();
    assert_eq!((bodies.len(), model.brep.faces.len()), (1, 1), "{:?}", sink.kept());
    let tolerances = Tolerances { chord: 2e-3, angle: 0.2 };
    tessellate_bodies(&model.brep, &bodies, &tolerances)
        .unwrap_or_else(|error| panic!("{error}: {:?}", sink.kept()))
}

/// A bound of straight edges through points, by `EDGE_CURVE`s on lines: records from `#20` on.
fn polygon(points: &[[f64; 3]]) -> String {
    let count = points.len();
    let list = |base: usize| (0..count).map(|k| format!("#{}", base + k)).collect::<Vec<_>>().join(",");
    let mut text = format!("#5=FACE_OUTER_BOUND('',#6,.T.);#6=EDGE_LOOP('',({}));", list(60));
    for (k, [x, y, z]) in points.iter().enumerate() {
        let next = (k + 1) % count;
        let [dx, dy, dz] = [0, 1, 2].map(|axis| points[next][axis] - points[k][axis]);
        text += &format!(
            "#{}=CARTESIAN_POINT('',({x:?},{y:?},{z:?}));#{}=VERTEX_POINT('',#{});#{}=EDGE_CURVE('',#{},#{},#{},.T.);\
             #{}=ORIENTED_EDGE('',*,*,#{},.T.);#{}=LINE('',#{},#{});#{}=VECTOR('',#{},1.);#{}=DIRECTION('',({dx:?},{dy:?},{dz:?}));",
            20 + k,
            30 + k,
            20 + k,
            40 + k,
            30 + k,
            30 + next,
            50 + k,
            60 + k,
            40 + k,
            50 + k,
            20 + k,
            70 + k,
            70 + k,
            80 + k,
            80 + k
        );
    }
    text
}

/// A bound of one closed edge on `#200` from a point back to it.
fn ring([x, y, z]: [f64; 3]) -> String {
    format!(
        "#5=FACE_OUTER_BOUND('',#6,.T.);#6=EDGE_LOOP('',(#7));#7=ORIENTED_EDGE('',*,*,#8,.T.);\
         #8=EDGE_CURVE('',#9,#9,#200,.T.);#9=VERTEX_POINT('',#10);#10=CARTESIAN_POINT('',({x:?},{y:?},{z:?}));"
    )
}

const FACE: &str = "#4=ADVANCED_FACE('',(#5),#100,.T.);";
const PLANE: &str = "#100=PLANE('',#11);";

#[track_caller]
fn assert_area(records: &[&str], expected: f64) -> Mesh {
    let mesh = mesh(&records.concat());
    let area = mesh.area();
    assert!((area - expected).abs() < 2e-3 * expected, "{area}, expected {expected}");
    mesh
}

#[test]
fn a_grid_of_patches_with_a_polygon_for_a_bound() {
    let grid = "#100=RECTANGULAR_COMPOSITE_SURFACE('',((#110),(#120)));
         #110=SURFACE_PATCH(#111,.CONTINUOUS.,.CONTINUOUS.,.T.,.T.);
         #120=SURFACE_PATCH(#121,.CONTINUOUS.,.CONTINUOUS.,.F.,.T.);
         #111=RECTANGULAR_TRIMMED_SURFACE('',#130,0.,4.,0.,2.,.T.,.T.);
         #121=RECTANGULAR_TRIMMED_SURFACE('',#130,4.,8.,0.,2.,.T.,.T.);
         #130=PLANE('',#11);";
    let bound = polygon(&[[1.0, 0.5, 0.0], [3.0, 0.5, 0.0], [3.0, 1.5, 0.0], [1.0, 1.5, 0.0]]);
    assert_area(&[FACE, grid, &bound], 2.0);
}

#[test]
fn bounds_of_a_curve_bounded_surface_are_those_of_the_face() {
    let surface = "#100=CURVE_BOUNDED_SURFACE('',#101,(),.T.);#101=PLANE('',#11);";
    assert_area(&[FACE, surface, &polygon(&[[0.0; 3], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]])], 6.0);
}

#[test]
fn a_replica_of_a_plane_lies_where_its_operator_says() {
    let replica = "#100=SURFACE_REPLICA('',#101,#150);#101=PLANE('',#11);
        #150=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#151,$,#152,2.,#153);
        #151=DIRECTION('',(0.,1.,0.));#152=CARTESIAN_POINT('',(10.,0.,1.));#153=DIRECTION('',(0.,0.,1.));";
    let bound = polygon(&[[0.0, 0.0, 1.0], [5.0, 0.0, 1.0], [5.0, 2.0, 1.0], [0.0, 2.0, 1.0]]);
    let mesh = assert_area(&[FACE, replica, &bound], 10.0);
    assert!(mesh.vertices.iter().all(|p| (p.z - 1.0).abs() < 1e-12));
}

#[test]
fn closed_edges_on_polylines_replicas_and_offsets() {
    let points = "#210=CARTESIAN_POINT('',(0.,0.,0.));#211=CARTESIAN_POINT('',(4.,0.,0.));#212=CARTESIAN_POINT('',(0.,3.,0.));";
    let triangle = format!("#200=POLYLINE('',(#210,#211,#212,#210));{points}");
    assert_area(&[FACE, PLANE, &triangle, &ring([0.0; 3])], 6.0);
    // Twice a circle of radius 3, about the origin.
    let replica = "#200=CURVE_REPLICA('',#201,#150);#201=CIRCLE('',#11,3.);
        #150=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',$,$,#12,2.,$);";
    assert_area(&[FACE, PLANE, replica, &ring([6.0, 0.0, 0.0])], 36.0 * PI);
    // Along the reference direction times the tangent: inwards.
    let offset = "#200=OFFSET_CURVE_3D('',#201,1.,.F.,#13);#201=CIRCLE('',#11,3.);";
    assert_area(&[FACE, PLANE, offset, &ring([2.0, 0.0, 0.0])], 4.0 * PI);
    // Half a circle and its diameter.
    let half = "#200=COMPOSITE_CURVE('',(#210,#220),.F.);#210=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#211);
        #220=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#221);#201=CIRCLE('',#11,3.);
        #211=TRIMMED_CURVE('',#201,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(3.141592653589793)),.T.,.PARAMETER.);
        #221=POLYLINE('',(#222,#223));#222=CARTESIAN_POINT('',(-3.,0.,0.));#223=CARTESIAN_POINT('',(3.,0.,0.));";
    assert_area(&[FACE, PLANE, half, &ring([3.0, 0.0, 0.0])], 4.5 * PI);
}

#[test]
fn a_poly_loop_bounds_a_plane() {
    let records = "#4=FACE_SURFACE('',(#5),#100,.T.);#5=FACE_OUTER_BOUND('',#6,.T.);#6=POLY_LOOP('',(#20,#21,#22));
        #20=CARTESIAN_POINT('',(0.,0.,0.));#21=CARTESIAN_POINT('',(4.,0.,0.));#22=CARTESIAN_POINT('',(0.,3.,0.));";
    assert_area(&[records, PLANE], 6.0);
}

#[test]
fn parts_of_a_torus_that_meets_itself() {
    let vertex = |x: f64, z: f64| {
        format!(
            "#5=FACE_BOUND('',#6,.T.);#6=VERTEX_LOOP('',#9);#9=VERTEX_POINT('',#10);#10=CARTESIAN_POINT('',({x:?},0.,{z:?}));"
        )
    };
    // Radii 1 and 2: the poles are at v = ±120°, at heights ±√3. 2π r ∫ (R + r cos v) dv over each part, where the
    // distance from the axis is negative in the inner one.
    let pole = 2.0 * PI / 3.0;
    let part = |from: f64, to: f64| 4.0 * PI * ((to - from) + 2.0 * (to.sin() - from.sin()));
    let torus = |word: &str| format!("#100=DEGENERATE_TOROIDAL_SURFACE('',#11,1.,2.,{word});");
    let outer = assert_area(&[FACE, &torus(".T."), &vertex(0.0, 3f64.sqrt())], part(-pole, pole));
    let far = |mesh: &Mesh| mesh.vertices.iter().map(|p: &Point3<f64>| p.x.hypot(p.y)).fold(0.0, f64::max);
    assert!((far(&outer) - 3.0).abs() < 5e-3);
    let inner = assert_area(&[FACE, &torus(".F."), &vertex(0.0, 3f64.sqrt())], -part(pole, 2.0 * PI - pole));
    assert!((far(&inner) - 1.0).abs() < 5e-3);
}

#[test]
fn parameter_curves_a_turn_above_the_pole_of_a_sphere_are_no_guide() {
    // An eighth of a sphere of radius 3; two of its sides have parameter curves at v - 2π, which is the same circle.
    let turn = -2.0 * PI;
    let side = |k: usize, [from, to]: [usize; 2], axis: usize, uv: [f64; 2], along: &str| {
        format!(
            "#{}=EDGE_CURVE('',#{from},#{to},#{},.T.);#{}=SURFACE_CURVE('',#{},(#{}),.CURVE_3D.);#{}=CIRCLE('',#{axis},3.);
             #{}=PCURVE('',#100,#{});#{}=DEFINITIONAL_REPRESENTATION('',(#{}),#190);#{}=LINE('',#{},#{});
             #{}=CARTESIAN_POINT('',({:?},{:?}));#{}=VECTOR('',#{along},1.);",
            k, k + 1, k + 1, k + 2, k + 3, k + 2, k + 3, k + 4, k + 4, k + 5, k + 5, k + 6, k + 7, k + 6, uv[0],
            uv[1], k + 7
        )
    };
    let records = "#100=SPHERICAL_SURFACE('',#11,3.);
        #5=FACE_OUTER_BOUND('',#6,.T.);#6=EDGE_LOOP('',(#60,#61,#62));#60=ORIENTED_EDGE('',*,*,#200,.T.);
        #61=ORIENTED_EDGE('',*,*,#210,.T.);#62=ORIENTED_EDGE('',*,*,#220,.F.);
        #30=VERTEX_POINT('',#20);#31=VERTEX_POINT('',#21);#32=VERTEX_POINT('',#22);
        #20=CARTESIAN_POINT('',(3.,0.,0.));#21=CARTESIAN_POINT('',(0.,3.,0.));#22=CARTESIAN_POINT('',(0.,0.,3.));
        #40=AXIS2_PLACEMENT_3D('',#12,#14,#41);#41=DIRECTION('',(0.,1.,0.));
        #42=AXIS2_PLACEMENT_3D('',#12,#43,#14);#43=DIRECTION('',(0.,-1.,0.));
        #180=DIRECTION('',(1.,0.));#181=DIRECTION('',(0.,1.));
        #190=(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()REPRESENTATION_CONTEXT('',''));";
    let sides = side(200, [30, 31], 11, [0.0, 0.0], "180")
        + &side(210, [31, 32], 40, [0.5 * PI, turn], "181")
        + &side(220, [30, 32], 42, [0.0, turn], "181");
    assert_area(&[FACE, records, &sides], 4.5 * PI);
}

#[test]
fn a_bound_that_begins_at_the_vertex_of_a_hyperbola_but_for_rounding() {
    // x = 2 cosh t, y = sinh t, from t = -1 to 1 by two edges, and the chord between the ends.
    let (x, y) = (2.0 * 1f64.cosh(), 1f64.sinh());
    let records = format!(
        "#5=FACE_OUTER_BOUND('',#6,.T.);#6=EDGE_LOOP('',(#60,#61,#62));#60=ORIENTED_EDGE('',*,*,#40,.F.);
         #61=ORIENTED_EDGE('',*,*,#41,.F.);#62=ORIENTED_EDGE('',*,*,#42,.F.);
         #40=EDGE_CURVE('',#30,#31,#50,.T.);#41=EDGE_CURVE('',#32,#30,#50,.T.);#42=EDGE_CURVE('',#31,#32,#51,.T.);
         #50=HYPERBOLA('',#11,2.,1.);#51=LINE('',#21,#70);#70=VECTOR('',#71,1.);#71=DIRECTION('',(0.,-1.,0.));
         #30=VERTEX_POINT('',#20);#31=VERTEX_POINT('',#21);#32=VERTEX_POINT('',#22);
         #20=CARTESIAN_POINT('',(2.,1.3E-16,0.));
         #21=CARTESIAN_POINT('',({x:?},{y:?},0.));#22=CARTESIAN_POINT('',({x:?},-{y:?},0.));"
    );
    assert_area(&[FACE, PLANE, &records], x * y - 2.0);
}
