//! Reading small files written here: structure, units, sharing, and what is broken.

use proptest::prelude::*;

use super::*;
use crate::geometry::Point;
use crate::stages::parse::{Parsed, parse};

fn reading(bytes: &[u8]) -> Result<Reading, ModelError> {
    read(&mut Scratch::default(), bytes, &Options::default(), &Cancel::new())
}

/// A tetrahedron as a faceted B-rep, with corners at the origin and one unit along each axis, in units of metres.
const TETRAHEDRON: &str = "
#1=CARTESIAN_POINT('',(0.,0.,0.));#2=CARTESIAN_POINT('',(1.,0.,0.));
#3=CARTESIAN_POINT('',(0.,1.,0.));#4=CARTESIAN_POINT('',(0.,0.,1));
#11=POLY_LOOP('',(#1,#3,#2));#12=POLY_LOOP('',(#1,#2,#4));#13=POLY_LOOP('',(#1,#4,#3));#14=POLY_LOOP('',(#2,#3,#4));
#21=FACE_BOUND('',#11,.T.);#22=FACE_BOUND('',#12,.T.);#23=FACE_BOUND('',#13,.T.);#24=FACE_BOUND('',#14,.T.);
#31=FACE('',(#21));#32=FACE('',(#22));#33=FACE('',(#23));#34=FACE('',(#24));
#40=CLOSED_SHELL('',(#31,#32,#33,#34));#41=FACETED_BREP('',#40);
#50=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#51))REPRESENTATION_CONTEXT('',''));
#51=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));
#52=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#53))REPRESENTATION_CONTEXT('',''));
#53=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#60=AXIS2_PLACEMENT_3D('',#1,$,$);#61=FACETED_BREP_SHAPE_REPRESENTATION('',(#41,#60),#50);
#70=PRODUCT_DEFINITION('','',#99,#99);#71=PRODUCT_DEFINITION_SHAPE('','',#70);#72=SHAPE_DEFINITION_REPRESENTATION(#71,#61);
";

/// An assembly in mm that uses the tetrahedron twice, shifted by 5 mm along x and by 7 mm along y.
const ASSEMBLY: &str = "
#100=PRODUCT_DEFINITION('','',#99,#99);#101=PRODUCT_DEFINITION_SHAPE('','',#100);
#102=SHAPE_REPRESENTATION('',(#110,#111),#52);#103=SHAPE_DEFINITION_REPRESENTATION(#101,#102);
#108=CARTESIAN_POINT('',(5.,0.,0.));#109=CARTESIAN_POINT('',(0.,7.,0.));
#110=AXIS2_PLACEMENT_3D('',#108,$,$);#111=AXIS2_PLACEMENT_3D('',#109,$,$);
#120=NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','','',#100,#70,$);#121=PRODUCT_DEFINITION_SHAPE('','',#120);
#122=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#123,#121);
#123=(REPRESENTATION_RELATIONSHIP('','',#61,#102)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#124)SHAPE_REPRESENTATION_RELATIONSHIP());
#124=ITEM_DEFINED_TRANSFORMATION('','',#60,#110);
#130=NEXT_ASSEMBLY_USAGE_OCCURRENCE('2','','',#100,#70,$);#131=PRODUCT_DEFINITION_SHAPE('','',#130);
#132=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#133,#131);
#133=(REPRESENTATION_RELATIONSHIP('','',#102,#61)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#134)SHAPE_REPRESENTATION_RELATIONSHIP());
#134=ITEM_DEFINED_TRANSFORMATION('','',#111,#60);
";

fn read_text(data: &str) -> Result<Reading, ModelError> {
    let text = format!("ISO-10303-21;DATA;{data}ENDSEC;END-ISO-10303-21;");
    reading(text.as_bytes())
}

#[test]
fn a_faceted_tetrahedron_shares_its_edges() {
    let Reading { model, skipped, warnings } = read_text(TETRAHEDRON).unwrap();
    assert_eq!((model.vertices.len(), model.edges.len(), model.faces.len()), (4, 6, 4));
    assert_eq!((model.bodies[0].solid, model.shells[0].closed, model.occurrences.len()), (true, true, 1));
    assert_eq!((model.unit_mm, model.vertices[1].point.coords.norm()), (1000.0, 1000.0));
    assert!(skipped.is_empty() && warnings.is_empty());
}

#[test]
fn a_parsed_tetrahedron_has_its_area_and_volume() {
    let text = format!("DATA;{TETRAHEDRON}");
    let parsed = parse(text.as_bytes(), &Options::default(), None, &Cancel::new()).unwrap();
    let area = 1.5 + 0.75_f64.sqrt();
    assert!((parsed.measures.area / 1e6 - area).abs() < 1e-9);
    assert!((parsed.measures.volume / 1e9 - 1.0 / 6.0).abs() < 1e-9);
}

/// A representation in mm of these items, and what they are made of.
fn shape(items: &str, entities: &str) -> Parsed {
    let text = format!(
        "DATA;#900=SHAPE_REPRESENTATION('',({items}),#901);#901=(GEOMETRIC_REPRESENTATION_CONTEXT(3)
        GLOBAL_UNIT_ASSIGNED_CONTEXT((#902))REPRESENTATION_CONTEXT('',''));
        #902=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));#903=CARTESIAN_POINT('',(0.,0.,0.));
        #904=AXIS2_PLACEMENT_3D('',#903,$,$);{entities}
        ENDSEC;END-ISO-10303-21;"
    );
    let parsed = parse(text.as_bytes(), &Options::default(), None, &Cancel::new()).unwrap();
    assert!(parsed.skipped.is_empty() && parsed.warnings.is_empty(), "{:?} {:?}", parsed.skipped, parsed.warnings);
    parsed
}

/// The faces #n1 to #n4 of a tetrahedron with a corner at (at, at, at) and edges of `size` along the axes.
fn tetrahedron(n: u32, at: f64, size: f64) -> String {
    let far = at + size;
    let points = [[at, at, at], [far, at, at], [at, far, at], [at, at, far]];
    let mut text = String::new();
    for (i, [x, y, z]) in (5..).zip(points) {
        text += &format!("#{n}{i}=CARTESIAN_POINT('',({x:?},{y:?},{z:?}));");
    }
    for (i, [a, b, c]) in (1..).zip([[5, 7, 6], [5, 6, 8], [5, 8, 7], [6, 7, 8]]) {
        text += &format!("#{n}{i}0=POLY_LOOP('',(#{n}{a},#{n}{b},#{n}{c}));#{n}{i}1=FACE_BOUND('',#{n}{i}0,.T.);");
        text += &format!("#{n}{i}=FACE('',(#{n}{i}1));");
    }
    text
}

/// Within 1e-4 of it.
fn near(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 1e-4
}

#[test]
fn a_void_counts_less() {
    let (outer, void) = (tetrahedron(1, 0.0, 1.0), tetrahedron(2, 0.1, 0.5));
    let shells = "#3=CLOSED_SHELL('',(#11,#12,#13,#14));#4=CLOSED_SHELL('',(#21,#22,#23,#24));
        #5=ORIENTED_CLOSED_SHELL('',*,#4,.F.);#6=BREP_WITH_VOIDS('',#3,(#5));";
    let parsed = shape("#6", &format!("{outer}{void}{shells}"));
    assert_eq!((parsed.model.bodies[0].solid, parsed.model.shells.len()), (true, 2));
    assert!(near(parsed.measures.area, 1.25 * (1.5 + 0.75_f64.sqrt())), "{}", parsed.measures.area);
    assert!(near(parsed.measures.volume, 0.875 / 6.0), "{}", parsed.measures.volume);
}

#[test]
fn open_shells_are_sheets() {
    let shells = "#3=OPEN_SHELL('',(#11,#12,#13));#6=SHELL_BASED_SURFACE_MODEL('',(#3));";
    let parsed = shape("#6", &format!("{}{shells}", tetrahedron(1, 0.0, 1.0)));
    assert!(!parsed.model.bodies[0].solid && !parsed.model.shells[0].closed);
    assert!(near(parsed.measures.area, 1.5), "{}", parsed.measures.area);
}

#[test]
fn a_set_holds_surfaces_without_topology() {
    // A disc of radius 1 between two half circles, a sphere of radius 1, and a copy of it twice as large beside it.
    let surfaces = "#1=PLANE('',#904);#2=CIRCLE('',#904,1.);
        #3=TRIMMED_CURVE('',#2,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(3.14159265358979)),.T.,.PARAMETER.);
        #4=TRIMMED_CURVE('',#2,(PARAMETER_VALUE(3.14159265358979)),(PARAMETER_VALUE(6.28318530717959)),.T.,.PARAMETER.);
        #5=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#3);#6=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#4);
        #7=OUTER_BOUNDARY_CURVE('',(#5,#6),.F.);#8=CURVE_BOUNDED_SURFACE('',#1,(#7),.F.);
        #10=SPHERICAL_SURFACE('',#904,1.);#11=CARTESIAN_POINT('',(5.,0.,0.));
        #12=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',$,$,#11,2.,$);#13=SURFACE_REPLICA('',#10,#12);
        #14=GEOMETRIC_SET('',(#8,#10,#13,#2));";
    let areas: Vec<f64> = shape("#14", surfaces).mesh.faces.iter().map(|f| f.area / std::f64::consts::PI).collect();
    assert!(areas.len() == 3 && areas.iter().zip([1.0, 4.0, 16.0]).all(|(a, b)| near(*a, b)), "{areas:?}");
}

#[test]
fn curves_on_surfaces_may_be_there_or_not() {
    // A cylinder of radius 2 and height 5 with a seam; its parameter curves are not even there to be followed.
    let solid = "#10=CARTESIAN_POINT('',(2.,0.,0.));#11=CARTESIAN_POINT('',(2.,0.,5.));#12=CARTESIAN_POINT('',(0.,0.,5.));
        #13=AXIS2_PLACEMENT_3D('',#12,$,$);#14=VERTEX_POINT('',#10);#15=VERTEX_POINT('',#11);#16=DIRECTION('',(0.,0.,1.));
        #20=CIRCLE('',#904,2.);#21=CIRCLE('',#13,2.);#22=VECTOR('',#16,1.);#23=LINE('',#10,#22);
        #30=EDGE_CURVE('',#14,#14,#40,.T.);#31=EDGE_CURVE('',#15,#15,#41,.T.);#32=EDGE_CURVE('',#14,#15,#42,.T.);
        #40=SURFACE_CURVE('',#20,(#998,#999),.PCURVE_S1.);#41=INTERSECTION_CURVE('',#21,(#998,#999),.PCURVE_S1.);
        #42=SEAM_CURVE('',#23,(#998,#999),.PCURVE_S1.);
        #50=ORIENTED_EDGE('',*,*,#30,.T.);#51=ORIENTED_EDGE('',*,*,#31,.F.);#52=ORIENTED_EDGE('',*,*,#32,.T.);
        #53=ORIENTED_EDGE('',*,*,#32,.F.);#54=ORIENTED_EDGE('',*,*,#30,.F.);#55=ORIENTED_EDGE('',*,*,#31,.T.);
        #60=EDGE_LOOP('',(#50,#52,#51,#53));#61=EDGE_LOOP('',(#54));#62=EDGE_LOOP('',(#55));
        #63=FACE_BOUND('',#60,.T.);#64=FACE_BOUND('',#61,.T.);#65=FACE_BOUND('',#62,.T.);
        #70=CYLINDRICAL_SURFACE('',#904,2.);#71=PLANE('',#904);#72=PLANE('',#13);
        #80=ADVANCED_FACE('',(#63),#70,.T.);#81=ADVANCED_FACE('',(#64),#71,.F.);#82=ADVANCED_FACE('',(#65),#72,.T.);
        #90=CLOSED_SHELL('',(#80,#81,#82));#91=MANIFOLD_SOLID_BREP('',#90);";
    let without = solid.replace("#14,#14,#40", "#14,#14,#20").replace("#15,#15,#41", "#15,#15,#21");
    // Of an edge along a line the ends tell all.
    let broken_line = solid.replace("#10,#22", "#998,#999");
    for text in [solid.to_owned(), without.replace("#14,#15,#42", "#14,#15,#23"), broken_line] {
        let parsed = shape("#91", &text);
        assert!(near(parsed.measures.area, 28.0 * std::f64::consts::PI), "{}", parsed.measures.area);
        assert!(near(parsed.measures.volume, 20.0 * std::f64::consts::PI), "{}", parsed.measures.volume);
        assert!(parsed.warnings.is_empty(), "{:?}", parsed.warnings);
    }
}

#[test]
fn a_tessellated_solid_has_area_and_volume() {
    let solid = "#1=COORDINATES_LIST('',4,((0.,0.,0.),(1.,0.,0.),(0.,1.,0.),(0.,0.,1.)));
        #2=TRIANGULATED_FACE('',#1,4,((0.,0.,1.)),$,(),((1,3,2),(1,2,4),(1,4,3),(2,3,4)));
        #3=TESSELLATED_SOLID('',(#2),$);";
    let parsed = shape("#3", solid);
    assert!(parsed.model.bodies[0].solid);
    assert!(near(parsed.measures.area, 1.5 + 0.75_f64.sqrt()), "{}", parsed.measures.area);
    assert!(near(parsed.measures.volume, 1.0 / 6.0), "{}", parsed.measures.volume);
}

#[test]
fn parts_are_placed_whichever_way_the_relation_is_written() {
    let Reading { model, skipped, .. } = read_text(&format!("{TETRAHEDRON}{ASSEMBLY}")).unwrap();
    assert!(skipped.is_empty(), "{skipped:?}");
    assert_eq!(model.bodies.len(), 1);
    let placed: Vec<_> =
        model.occurrences.iter().map(|o| (o.path.as_str(), o.placement.point(&Point::origin()))).collect();
    assert_eq!(placed, [("120", Point::new(5.0, 0.0, 0.0)), ("130", Point::new(0.0, 7.0, 0.0))]);
}

#[test]
fn a_product_in_itself_costs_only_that_branch() {
    let cycle = "#140=NEXT_ASSEMBLY_USAGE_OCCURRENCE('3','','',#70,#100,$);#150=PRODUCT_DEFINITION('','',#99,#99);
        #151=NEXT_ASSEMBLY_USAGE_OCCURRENCE('4','','',#150,#100,$);";
    let Reading { model, skipped, .. } = read_text(&format!("{TETRAHEDRON}{ASSEMBLY}{cycle}")).unwrap();
    assert_eq!(model.occurrences.len(), 2);
    assert!(skipped.iter().all(|s| s.entity == 140 && s.why.contains("part of itself")), "{skipped:?}");
}

#[test]
fn a_mapped_item_places_what_it_maps() {
    let mapped = "#200=REPRESENTATION_MAP(#60,#61);#201=MAPPED_ITEM('',#200,#110);#202=MAPPED_ITEM('',#200,#203);
        #203=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',$,$,#109,2.,$);#204=SHAPE_REPRESENTATION('',(#201,#202,#205),#52);
        #205=MAPPED_ITEM('',#206,#110);#206=REPRESENTATION_MAP(#110,#204);
        #108=CARTESIAN_POINT('',(5.,0.,0.));#109=CARTESIAN_POINT('',(0.,7.,0.));#110=AXIS2_PLACEMENT_3D('',#108,$,$);";
    let without_product = TETRAHEDRON.replace("#72=SHAPE_DEFINITION_REPRESENTATION(#71,#61);", "");
    let Reading { model, skipped, .. } = read_text(&format!("{without_product}{mapped}")).unwrap();
    let ends: Vec<_> = model.occurrences.iter().map(|o| o.placement.point(&Point::new(1.0, 0.0, 0.0))).collect();
    assert_eq!(ends, [Point::new(6.0, 0.0, 0.0), Point::new(2.0, 7.0, 0.0)]);
    assert_eq!(skipped[0].entity, 205);
}

#[test]
fn a_broken_face_is_skipped_with_its_number() {
    let Reading { model, skipped, .. } =
        read_text(&TETRAHEDRON.replace("#33=FACE('',(#23));", "#33=FACE('',(#999));")).unwrap();
    assert_eq!(model.faces.len(), 3);
    assert_eq!(skipped, [Skipped { entity: 33, why: "#999: there is no such instance".into() }]);
}

#[test]
fn files_without_faces_say_why() {
    let why = |bytes: &[u8]| reading(bytes).unwrap_err().why;
    assert_eq!(why(b"solid ascii stl"), "not a STEP, IGES or .brep file");
    assert_eq!(why(b""), "not a STEP, IGES or .brep file");
    assert_eq!(why(b"ISO-10303-21;DATA;ENDSEC;END-ISO-10303-21;"), "no entities");
    assert_eq!(why(b"DATA;#1=PRODUCT();"), "no shape representation");
    assert_eq!(why(b"#1=SHAPE_REPRESENTATION('',(#2),#3);#2=GEOMETRIC_CURVE_SET('',());"), "wireframe only: no faces");
}

proptest! {
    #[test]
    fn mutated_files_never_panic(cut in 0_usize..4000, changes in prop::collection::vec((0_usize..4000, any::<u8>()), 0..12)) {
        let mut bytes = format!("{TETRAHEDRON}{ASSEMBLY}").into_bytes();
        let length = bytes.len();
        changes.into_iter().for_each(|(at, value)| bytes[at % length] = value);
        bytes.truncate(length - cut % length / 4);
        if let Ok(Reading { model, .. }) = reading(&bytes) {
            prop_assert!(!model.occurrences.is_empty());
        }
    }

    #[test]
    fn swapped_references_never_panic(swaps in prop::collection::vec((1_u64..140, 1_u64..140), 1..8)) {
        let mut text = format!("{TETRAHEDRON}{ASSEMBLY}");
        for (from, to) in swaps {
            text = text.replace(&format!("#{from},"), &format!("#{to},")).replace(&format!("#{from})"), &format!("#{to})"));
        }
        if let Ok(Reading { model, .. }) = reading(text.as_bytes()) {
            prop_assert!(!model.occurrences.is_empty());
        }
    }
}
