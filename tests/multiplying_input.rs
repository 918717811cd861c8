//! Small files that a reader without bounds would be busy with for hours, or fill the memory with: references that
//! multiply, nesting that doubles its cost, borders that cross themselves everywhere.

mod part21;

use std::time::{Duration, Instant};

use part21::reading::{CYLINDER, PATIENCE, and, left_out, parsed, parsed_until};
use symalign::cancel::Cancel;

/// Written `count` times, with commas between.
fn times(count: usize, what: &str) -> String {
    vec![what; count].join(",")
}

/// `make` for each of the numbers, with `between`.
fn each(count: usize, between: &str, make: impl Fn(usize) -> String) -> String {
    (0..count).map(make).collect::<Vec<_>>().join(between)
}

/// The cylinder with a second body, an open shell of these faces.
fn and_shell(instances: &str, faces: &str) -> String {
    and(&format!(
        "{instances}#900=OPEN_SHELL('',({faces}));#901=SHELL_BASED_SURFACE_MODEL('',(#900));
         #902=SHAPE_REPRESENTATION('',(#901),#68);"
    ))
}

/// Whether some entity was left out for a reason that has these words.
#[track_caller]
fn assert_left_out(text: String, words: &str) {
    let (faces, lost) = left_out(text);
    assert!(faces >= 3, "{faces} faces");
    assert!(lost.iter().any(|(_, why)| why.contains(words)), "{:?}", &lost[..lost.len().min(5)]);
}

const BEYOND: &str = "references multiply beyond the file's size";

#[test]
fn line_breaks_and_comments_in_strings_are_passed_over_once() {
    for line in ["\n", "\n/*", "\n#1/*", "\n#1 \n", "\n#"] {
        let (faces, lost) = left_out(and(&format!("#100=PROPERTY('{}',$);", line.repeat(300_000))));
        assert_eq!((faces, lost), (3, Vec::new()), "{line:?}");
    }
}

#[test]
fn a_long_complex_instance_is_not_read_for_each_reference_to_it() {
    let parts = each(20_000, "", |i| format!("A{i}()"));
    let edge = format!("#100=({parts}EDGE_CURVE(#24,.F.)EDGE(#22,#22)REPRESENTATION_ITEM(''));");
    let face = "#102=FACE_BOUND('',#101,.T.);#103=ADVANCED_FACE('',(#102),#54,.T.);";
    let uses = format!("#101=EDGE_LOOP('',({}));", times(50_000, "#100"));
    assert_left_out(and_shell(&format!("{edge}{uses}{face}"), "#103"), BEYOND);
}

#[test]
fn a_point_with_a_long_name_is_not_read_for_each_reference_to_it() {
    let point = format!("#100=CARTESIAN_POINT('{}',(0.,0.,5.));", "x".repeat(1_000_000));
    let curve = format!("#101=BEZIER_CURVE('',1,({}),.U.,.F.,.F.);", times(50_000, "#100"));
    let face = "#102=SURFACE_OF_LINEAR_EXTRUSION('',#101,#35);#103=ADVANCED_FACE('',(#51),#102,.T.);";
    assert_left_out(and_shell(&format!("{point}{curve}{face}"), "#103"), BEYOND);
}

#[test]
fn faces_bounds_and_shells_that_multiply_are_left_out() {
    let vertex_loops = format!(
        "#100=VERTEX_LOOP('',#22);#101=FACE_BOUND('',#100,.T.);#102=ADVANCED_FACE('',({}),#54,.T.);",
        times(20_000, "#101")
    );
    assert_left_out(and_shell(&vertex_loops, &times(20_000, "#102")), BEYOND);
    let shells = format!(
        "#100=PLANE('',#46);#101=ADVANCED_FACE('',(),#100,.T.);#102=OPEN_SHELL('',({}));
         #103=SHELL_BASED_SURFACE_MODEL('',({}));#104=SHAPE_REPRESENTATION('',(#103),#68);",
        times(10_000, "#101"),
        times(10_000, "#102")
    );
    assert_left_out(and(&shells), BEYOND);
}

#[test]
fn curves_made_of_the_same_long_curve_are_left_out() {
    let text = format!(
        "#100=POLYLINE('',({}));#101=COMPOSITE_CURVE_SEGMENT(.U.,.T.,#100);#102=COMPOSITE_CURVE('',({}),.U.);
         #103=SURFACE_OF_LINEAR_EXTRUSION('',#102,#35);#104=ADVANCED_FACE('',(#51),#103,.T.);",
        times(10_000, "#23,#32"),
        times(20_000, "#101")
    );
    assert_left_out(and_shell(&text, "#104"), BEYOND);
}

#[test]
fn triangles_share_their_coordinates_and_do_not_multiply() {
    let n = 3000;
    let points = each(n, ",", |i| format!("({i}.,{}.,{}.)", i % 13, i % 7));
    let face = |i: usize| {
        format!(
            "#{}=TRIANGULATED_FACE('',#100,{n},(),$,(),(({},{},{})));",
            1000 + i,
            i + 1,
            (i + 1) % n + 1,
            (i + 9) % n + 1
        )
    };
    let text = format!(
        "#100=COORDINATES_LIST('',{n},({points}));{}#101=TESSELLATED_SOLID('',({}),$);
         #102=TESSELLATED_SHAPE_REPRESENTATION('',(#101),#68);",
        each(n, "", face),
        each(n, ",", |i| format!("#{}", 1000 + i)),
    );
    assert_eq!(left_out(and(&text)), (n + 3, Vec::new()));
    let one = format!("#200=TRIANGULATED_FACE('',#100,{n},(),$,(),({}));", each(n, ",", |_| "(1,2,3)".into()));
    let many = format!("{one}#101=TESSELLATED_SOLID('',({}),$);", times(3000, "#200"));
    assert_left_out(and(&text.replace("#101=", &format!("{many}#201="))), BEYOND);
}

/// Curves, each made of the one before.
fn chain(length: usize, first: &str, make: impl Fn(&str) -> String) -> String {
    each(length, "", |i| {
        let before = if i == 0 { first.to_owned() } else { format!("#{}", 99 + i) };
        format!("#{}={};", 100 + i, make(&before))
    })
}

#[test]
fn nesting_that_doubles_its_cost_is_refused() {
    let swept =
        "#200=SURFACE_OF_LINEAR_EXTRUSION('',#113,#35);#201=RECTANGULAR_TRIMMED_SURFACE('',#200,0.,1.,0.,1.,.T.,.T.);
        #202=ADVANCED_FACE('',(),#201,.T.);";
    let trimmed =
        |of: &str| format!("TRIMMED_CURVE('',{of},(PARAMETER_VALUE(0.1)),(PARAMETER_VALUE(0.9)),.T.,.PARAMETER.)");
    let offset = |of: &str| format!("OFFSET_CURVE_3D('',{of},0.1,.F.,#27)");
    let moved = |of: &str| format!("OFFSET_SURFACE('',{of},0.1,.F.)");
    assert_left_out(and_shell(&format!("{}{swept}", chain(14, "#24", trimmed)), "#202"), "curves nested too deep");
    assert_left_out(and_shell(&format!("{}{swept}", chain(14, "#24", offset)), "#202"), "nested too deep");
    let face = format!("{}#202=ADVANCED_FACE('',(),#113,.T.);", chain(14, "#45", moved));
    assert_left_out(and_shell(&face, "#202"), "surfaces nested too deep");
}

/// A number between -1 and 1 that looks like chance.
fn scattered(i: usize) -> f64 {
    (i as f64 * 12.9898).sin() * 43_758.545_3 % 1.0
}

#[test]
fn a_scribble_is_no_face() {
    let n = 8000;
    let point =
        |i: usize| format!("#{}=CARTESIAN_POINT('',({:.4},{:.4},5.));", 1000 + i, scattered(i), scattered(3 * i + 1));
    let on_wall = |i: usize| {
        let (u, v) = (9.0 * scattered(i), 9.0 * scattered(3 * i + 1));
        format!("#{}=CARTESIAN_POINT('',({:.6},{:.6},{v:.4}));", 1000 + i, 2.0 * u.cos(), 2.0 * u.sin())
    };
    let border =
        format!("#100=POLY_LOOP('',({}));#101=FACE_BOUND('',#100,.T.);", each(n, ",", |i| format!("#{}", 1000 + i)));
    for (points, surface) in [(each(n, "", point), "#54"), (each(n, "", on_wall), "#45")] {
        let text = format!("{points}{border}#102=ADVANCED_FACE('',(#101),{surface},.T.);");
        let (faces, lost) = left_out(and_shell(&text, "#102"));
        assert!(faces == 3 && lost.iter().any(|(entity, _)| *entity == 102), "{surface}: {faces} faces, {lost:?}");
    }
}

#[test]
fn borders_that_go_round_and_round_are_no_faces() {
    let face = "#102=ADVANCED_FACE('',(#101),#54,.T.);#101=FACE_BOUND('',#100,.T.);";
    // The same three points, over and over.
    let round = format!("#100=POLY_LOOP('',({}));{face}", times(100_000, "#23,#32,#56"));
    assert!(left_out(and_shell(&round, "#102")).0 >= 3);
    // The same circle.
    let circles = format!("#100=EDGE_LOOP('',({}));{face}", times(100_000, "#53"));
    assert_left_out(and_shell(&circles, "#102"), "a border of too many points");
    // Out and back along each of many edges.
    let n = 40_000;
    let point = |i: usize| format!("#{}=CARTESIAN_POINT('',({i}.,{}.,5.));", 1000 + i, i % 7);
    let there_and_back = (0..n).chain((1..n - 1).rev()).map(|i| format!("#{}", 1000 + i)).collect::<Vec<_>>().join(",");
    let slit = format!("{}#100=POLY_LOOP('',({there_and_back}));{face}", each(n, "", point));
    assert_left_out(and_shell(&slit, "#102"), "the loops bound no region");
}

#[test]
fn a_broken_list_of_millions_is_told_shortly() {
    let parsed = parsed(and_shell("", &times(500_000, "#998,#999"))).unwrap();
    assert_eq!(parsed.skipped.len(), 20_000);
    assert_eq!(parsed.warnings, ["980000 more entities were left out"]);
}

/// Work that takes long must end soon after it is cancelled.
#[track_caller]
fn assert_stops(text: String) {
    let cancel = Cancel::new();
    let handle = cancel.clone();
    let timer = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(300));
        handle.cancel();
        Instant::now()
    });
    let result = parsed_until(text, &cancel, PATIENCE);
    let late = timer.join().expect("it only sleeps").elapsed();
    assert_eq!(result.map(|_| "it was read").unwrap_err().why, "cancelled");
    assert!(late < Duration::from_secs(10), "{late:?} after it was cancelled");
}

#[test]
fn a_time_limit_stops_many_large_faces() {
    let spheres = "#100=SPHERICAL_SURFACE('',#46,3.);#101=ADVANCED_FACE('',(),#100,.T.);";
    assert_stops(and_shell(spheres, &times(100_000, "#101")));
}

#[test]
fn a_time_limit_stops_one_face_of_many_edges() {
    let n = 400;
    let point = |i: usize| {
        format!(
            "#{}=CARTESIAN_POINT('',({:.2},{:.4},{:.4}));",
            1000 + i,
            i as f64 / 100.0,
            scattered(i),
            scattered(7 * i)
        )
    };
    let edge = |i: usize| format!("#{}=EDGE_CURVE('',#101,#102,#100,.T.);", 2000 + i);
    let text = format!(
        "{}#100=QUASI_UNIFORM_CURVE('',3,({}),.U.,.F.,.F.);#101=VERTEX_POINT('',#1000);#102=VERTEX_POINT('',#{});{}
         #103=EDGE_LOOP('',({}));#104=FACE_BOUND('',#103,.T.);#105=ADVANCED_FACE('',(#104),#45,.T.);",
        each(n, "", point),
        each(n, ",", |i| format!("#{}", 1000 + i)),
        999 + n,
        each(9000, "", edge),
        each(9000, ",", |i| format!("#{}", 2000 + i)),
    );
    assert_stops(and_shell(&text, "#105"));
}

#[test]
fn the_cylinder_itself_is_whole() {
    assert_eq!(left_out(CYLINDER), (3, Vec::new()));
}
