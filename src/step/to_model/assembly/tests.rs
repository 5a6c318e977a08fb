//! Small assemblies whose places follow from their own numbers.

use crate::diagnostic::Diagnostic;
use crate::math::Point3;
use crate::model::{AnnotationKind, Colour, Element, Instances, Model, Origin};
use crate::step::to_model::tests::{CIRCLE, DEGREES, FACE, PLANE, read};
use crate::units::LengthUnit;

/// The body of `FACE` (a surface model `#2`, in millimetres) is the shape `#1` of product `#301`; product `#311`
/// has the shape `#320` in metres; the use `#330` puts the first into the second.
const PRODUCTS: &str = "
#300=PRODUCT('part','part','',());
#301=PRODUCT_DEFINITION('','',#302,$);
#302=PRODUCT_DEFINITION_FORMATION('','',#300);
#303=PRODUCT_DEFINITION_SHAPE('','',#301);
#304=SHAPE_DEFINITION_REPRESENTATION(#303,#1);
#310=PRODUCT('whole','whole','',());
#311=PRODUCT_DEFINITION('','',#312,$);
#312=PRODUCT_DEFINITION_FORMATION('','',#310);
#313=PRODUCT_DEFINITION_SHAPE('','',#311);
#314=SHAPE_DEFINITION_REPRESENTATION(#313,#320);
#330=NEXT_ASSEMBLY_USAGE_OCCURRENCE('u','use','',#311,#301,$);
#331=PRODUCT_DEFINITION_SHAPE('','',#330);
#950=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#951,#902))REPRESENTATION_CONTEXT('',''));
#951=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));
#340=AXIS2_PLACEMENT_3D('',#341,#342,#343);
#341=CARTESIAN_POINT('',(2.,0.,0.));
#342=DIRECTION('',(0.,0.,1.));
#343=DIRECTION('',(0.,1.,0.));";

fn assembly(records: &str) -> (Model, Vec<Diagnostic>) {
    read(&[FACE, CIRCLE, PLANE, DEGREES, PRODUCTS, records].concat())
}

/// Where the part's (1, 0, 0) mm and (0, 1, 0) mm stand, in millimetres.
fn places(model: &Model) -> Vec<[[f64; 3]; 2]> {
    let instances = Instances::of(model, &LengthUnit::millimetre(), 100);
    let place = |transform: &crate::math::Affine, x, y| {
        let point = transform.point(&Point3::new(x, y, 0.0));
        [point.x, point.y, point.z].map(|part| (part * 1e9).round() / 1e9 + 0.0)
    };
    instances.bodies.iter().map(|b| [place(&b.transform, 1.0, 0.0), place(&b.transform, 0.0, 1.0)]).collect()
}

/// A quarter turn about z and a shift of 2 m: (1, 0, 0) goes to (2000, 1, 0), (0, 1, 0) to (1999, 0, 0).
const TURNED: [[[f64; 3]; 2]; 1] = [[[2000.0, 1.0, 0.0], [1999.0, 0.0, 0.0]]];

#[test]
fn a_use_is_placed_in_the_assemblys_own_unit_whichever_way_it_is_written() {
    let whole =
        "#320=SHAPE_REPRESENTATION('',(#340),#950);#332=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#333,#331);";
    let relation = |first: &str, second: &str, items: &str| {
        format!(
            "{whole}#333=(REPRESENTATION_RELATIONSHIP('','',{first},{second})\
             REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#334)SHAPE_REPRESENTATION_RELATIONSHIP());\
             #334=ITEM_DEFINED_TRANSFORMATION('','',{items});"
        )
    };
    // From the part to the whole, from the whole to the part, and with the items against the representations.
    for records in [
        relation("#1", "#320", "#11,#340"),
        relation("#320", "#1", "#340,#11"),
        relation("#1", "#320", "#340,#11"),
    ] {
        let (model, sink) = assembly(&records);
        assert_eq!(sink, []);
        assert_eq!(places(&model), TURNED);
        assert_eq!(model.products[1].unit.as_ref().map(|unit| unit.metres), Some(1.0));
    }
}

#[test]
fn mapped_items_and_operators_place_as_well() {
    // The use has no relationship: the mapped item of the assembly's representation places it.
    let mapped = "#320=SHAPE_REPRESENTATION('',(#340,#321),#950);#321=MAPPED_ITEM('',#322,#340);\
                  #322=REPRESENTATION_MAP(#11,#1);";
    let (model, sink) = assembly(mapped);
    assert_eq!(sink, []);
    assert_eq!(places(&model), TURNED);
    // An operator that doubles and mirrors: x to (2000, 2, 0), y to (2002, 0, 0).
    let operator = "#320=SHAPE_REPRESENTATION('',(#340,#321),#950);#321=MAPPED_ITEM('',#322,#323);\
                    #322=REPRESENTATION_MAP(#11,#1);\
                    #323=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,#343,#324,#341,2.,#342);\
                    #324=DIRECTION('',(1.,0.,0.));";
    let (model, sink) = assembly(operator);
    assert_eq!(sink, []);
    assert_eq!(places(&model), [[[2000.0, 2.0, 0.0], [2002.0, 0.0, 0.0]]]);
}

#[test]
fn a_mapped_item_without_a_use_makes_the_body_a_shape_of_the_product() {
    let twice = "#320=SHAPE_REPRESENTATION('',(#321,#325),#950);#321=MAPPED_ITEM('',#322,#340);\
                 #325=MAPPED_ITEM('',#322,#11);#322=REPRESENTATION_MAP(#11,#1);";
    let without = PRODUCTS.replace("SHAPE_DEFINITION_REPRESENTATION(#303", "X(#303");
    let without = without.replace("NEXT_ASSEMBLY_USAGE_OCCURRENCE", "Y");
    let (model, _) = read(&[FACE, CIRCLE, PLANE, DEGREES, &without, twice].concat());
    assert_eq!(places(&model), [TURNED[0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
}

#[test]
fn a_product_within_itself_is_left_out_with_a_diagnostic() {
    let circle = "#320=SHAPE_REPRESENTATION('',(#340),#950);\
                  #336=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','back','',#301,#311,$);";
    let (model, sink) = assembly(circle);
    assert_eq!(model.occurrences.len(), 1);
    assert!(sink.iter().any(|fact| fact.code == "step.cycle"), "{sink:?}");
}

#[test]
fn an_assembly_that_doubles_is_cut_at_the_limit() {
    let mut records = String::from("#320=SHAPE_REPRESENTATION('',(#340),#950);");
    for level in 0..40 {
        let (above, below) = (400 + 10 * level, 400 + 10 * (level + 1));
        records += &format!("#{above}=PRODUCT_DEFINITION('','',#302,$);");
        for k in 1..3 {
            records +=
                &format!("#{}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#{above},#{below},$);", above + k);
        }
    }
    records += "#800=PRODUCT_DEFINITION('','',#302,$);";
    let (model, sink) = assembly(&records);
    let instances = Instances::of(&model, &LengthUnit::millimetre(), 1000);
    assert!(instances.cut && instances.nodes.len() == 1000);
    assert_eq!(crate::model::instance_counts(&model).iter().max(), Some(&(1 << 40)));
    assert!(sink.iter().any(|fact| fact.code == "step.too-many-instances"), "{sink:?}");
}

const COLOURS: &str = "#320=SHAPE_REPRESENTATION('',(#340),#950);
#332=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#333,#331);
#333=(REPRESENTATION_RELATIONSHIP('','',#1,#320)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#334)SHAPE_REPRESENTATION_RELATIONSHIP());
#334=ITEM_DEFINED_TRANSFORMATION('','',#11,#340);
#500=PRESENTATION_STYLE_ASSIGNMENT((#501));
#501=SURFACE_STYLE_USAGE(.BOTH.,#502);
#502=SURFACE_SIDE_STYLE('',(#503));
#503=SURFACE_STYLE_RENDERING_WITH_PROPERTIES($,#504,(#505));
#504=COLOUR_RGB('',1.,0.,0.);
#505=SURFACE_STYLE_TRANSPARENT(0.25);
#510=PRESENTATION_STYLE_ASSIGNMENT((#511));
#511=SURFACE_STYLE_USAGE(.BOTH.,#512);
#512=SURFACE_SIDE_STYLE('',(#513));
#513=SURFACE_STYLE_FILL_AREA(#514);
#514=FILL_AREA_STYLE('',(#515));
#515=FILL_AREA_STYLE_COLOUR('',#516);
#516=DRAUGHTING_PRE_DEFINED_COLOUR('blue');
";

#[test]
fn looks_are_inherited_and_one_use_changes_them() {
    let seen = |records: &str| {
        let (model, _) = assembly(&[COLOURS, records].concat());
        let instances = Instances::of(&model, &LengthUnit::millimetre(), 10);
        let face = model.brep.faces.ids().next().expect("one face");
        let colour = instances.colour(&model, &instances.bodies[0], face);
        let transparency = model.transparency_of(face);
        (colour.map(|Colour { red, green, blue }| [red, green, blue]), transparency, model.is_hidden(face))
    };
    let (red, blue) = (Some([1.0, 0.0, 0.0]), Some([0.0, 0.0, 1.0]));
    assert_eq!(seen(""), (None, 0.0, false));
    assert_eq!(seen("#520=STYLED_ITEM('',(#500),#2);"), (red, 0.25, false));
    // The face's own before the body's.
    assert_eq!(seen("#520=STYLED_ITEM('',(#500),#2);#521=STYLED_ITEM('',(#510),#4);"), (blue, 0.0, false));
    // The whole shape, by its representation.
    assert_eq!(seen("#520=STYLED_ITEM('',(#510),#1);"), (blue, 0.0, false));
    // In this use the body is blue.
    let context = "#520=STYLED_ITEM('',(#500),#2);\
                   #521=CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM('',(#510),#2,#520,(#333));";
    assert_eq!(seen(context).0, blue);
    // Hidden by its style and by its layer.
    assert!(seen("#520=STYLED_ITEM('',(#500),#2);#522=INVISIBILITY((#520));").2);
    assert!(seen("#523=PRESENTATION_LAYER_ASSIGNMENT('x','',(#2));#522=INVISIBILITY((#523));").2);
}

#[test]
fn external_files_are_named() {
    let records = "#320=SHAPE_REPRESENTATION('',(#340),#950);#600=DOCUMENT_FILE('door.stp','','',#601,'',$);\
                   #602=APPLIED_DOCUMENT_REFERENCE(#600,'',(#301));";
    let (model, _) = assembly(records);
    assert_eq!(model.products[0].external, ["door.stp"]);
    assert_eq!(model.products[1].external, [""; 0]);
}

#[test]
fn annotations_are_linked_to_the_face_that_they_speak_of() {
    let records = "#320=SHAPE_REPRESENTATION('',(#340),#950);\
        #700=COMPOSITE_SHAPE_ASPECT('','',#303,.T.);#701=SHAPE_ASPECT('','',#303,.T.);\
        #702=SHAPE_ASPECT_RELATIONSHIP('',$,#700,#701);\
        #703=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#701,#1,#4);\
        #704=(GEOMETRIC_TOLERANCE('t','',#705,#700)GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#709))POSITION_TOLERANCE());\
        #705=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.1),#901);\
        #706=DIMENSIONAL_SIZE(#701,'diameter');#707=DRAUGHTING_CALLOUT('c',());\
        #708=DRAUGHTING_MODEL_ITEM_ASSOCIATION('','',#706,#1,#707);\
        #710=PROPERTY_DEFINITION('geometric validation property','area',#303);\
        #711=PROPERTY_DEFINITION_REPRESENTATION(#710,#712);#712=REPRESENTATION('',(#713),#900);\
        #713=MEASURE_REPRESENTATION_ITEM('',AREA_MEASURE(7.),#714);";
    let (model, _) = assembly(records);
    let face = model.brep.faces.ids().next().expect("one face");
    let of = |name: u64| {
        let found = model.annotations.iter().find(|annotation| annotation.origin == Origin::Instance(name));
        found.expect("the annotation is read")
    };
    assert_eq!((of(704).entity.as_str(), of(704).kind), ("POSITION_TOLERANCE", AnnotationKind::Tolerance));
    assert_eq!((of(704).values[0].value, of(704).values[0].unit.as_str()), (0.1, "mm"));
    for name in [704, 706, 707] {
        assert_eq!(of(name).on, [Element::Face(face)], "#{name}");
    }
    assert_eq!((of(710).values[0].value, of(710).on.as_slice()), (7.0, &[Element::Product(0)][..]));
    assert_eq!(model.annotations_on(face).count(), 3);
}
