//! What broken files come to: a clear reason, or the rest of the model with the number of each entity that is left
//! out; within limits of time and memory.

mod part21;

use part21::reading::{CYLINDER, and, left_out, parsed, with};

/// The model must be as good as new.
#[track_caller]
fn assert_whole(text: impl Into<Vec<u8>>) {
    let (expected, found) = (parsed(CYLINDER).unwrap(), parsed(text).unwrap());
    assert_eq!(found.measures, expected.measures);
    assert_eq!((found.mesh.faces.len(), found.skipped.as_slice()), (3, [].as_slice()));
}

/// Two faces are left, and the third is left out for a reason that has these words.
#[track_caller]
fn assert_lost(text: impl Into<Vec<u8>>, face: u64, words: &str) {
    let (faces, lost) = left_out(text);
    let told = lost.iter().any(|(entity, why)| *entity == face && why.contains(words));
    assert!(faces == 2 && told, "{faces} faces; {lost:?}");
}

#[test]
fn files_truncated_anywhere_keep_what_was_complete_and_say_so() {
    for length in 0..CYLINDER.trim_end().len() {
        let Ok(parsed) = parsed(&CYLINDER.as_bytes()[..length]) else { continue };
        assert!(!parsed.warnings.is_empty(), "nothing is said of a file cut at {length}");
        assert!(parsed.mesh.faces.len() <= 3);
    }
    let last_shell = CYLINDER.find("#63=").unwrap();
    assert_lost(&CYLINDER.as_bytes()[..last_shell], 59, "#63: there is no such instance");
}

#[test]
fn wrong_types_are_told_with_their_number() {
    assert_lost(with("#53=DIRECTION('',(0.,0.,1.));"), 50, "#53: an edge was expected");
    assert_lost(with("#54=CIRCLE('',#55,2.);"), 50, "#54: not a surface that is known");
    assert_lost(with("#55=CARTESIAN_POINT('',(0.,0.,0.));"), 50, "#55: a placement was expected");
    assert_lost(with("#61=PLANE('',#64);"), 59, "#61: a loop was expected");
    assert_lost(with("#60=EDGE_LOOP('',(#62));"), 59, "#60: a face bound was expected");
    assert_lost(with("#50=PLANE('',#55);"), 50, "a face was expected");
    assert_lost(with("#54=PLANE('',.T.);"), 50, "#54: a reference was expected");
    assert_lost(with("#56=CARTESIAN_POINT('','0.,0.,5.');"), 50, "#56: a list was expected");
    assert_lost(with("#56=CARTESIAN_POINT('',(0.,'0.',5.));"), 50, "#56: a number was expected");
    assert_lost(with("#56=CARTESIAN_POINT('',(0.,5.));"), 50, "#56: three coordinates were expected");
}

#[test]
fn a_wrong_curve_costs_no_face_where_its_ends_are_known() {
    let (faces, lost) = left_out(with("#33=PLANE('',#46);"));
    assert_eq!((faces, lost), (3, Vec::new()));
    let warnings = parsed(with("#33=PLANE('',#46);")).unwrap().warnings;
    assert_eq!(warnings, ["edge #30 is taken as straight: #33: not a curve that is known"]);
}

#[test]
fn dangling_null_and_self_references_cost_one_face() {
    assert_lost(with("#51=FACE_BOUND('',#999,.T.);"), 50, "#999: there is no such instance");
    assert_lost(with("#51=FACE_BOUND('',#18446744073709551616,.T.);"), 50, "#51: a bad reference");
    assert_lost(with("#51=FACE_BOUND('',$,.T.);"), 50, "#51: a reference was expected");
    assert_lost(with("#51=FACE_BOUND('',*,.T.);"), 50, "#51: a reference was expected");
    assert_lost(with("#51=FACE_BOUND('',#51,.T.);"), 50, "#51: a loop was expected");
    assert_lost(with("#53=ORIENTED_EDGE('',*,*,#53,.T.);"), 50, "edges nested too deep");
    assert_lost(with("#50=ORIENTED_FACE('',*,#50,.T.);"), 50, "faces nested too deep");
    assert_lost(with("#54=OFFSET_SURFACE('',#54,1.,.F.);"), 50, "surfaces nested too deep");
}

#[test]
fn cycles_cost_the_branch_that_they_are_in() {
    let cycle = "#100=OFFSET_SURFACE('',#101,1.,.F.);#101=RECTANGULAR_TRIMMED_SURFACE('',#100,0.,1.,0.,1.,.T.,.T.);
        #102=ADVANCED_FACE('',(#51),#100,.T.);#103=OPEN_SHELL('',(#102));#104=SHELL_BASED_SURFACE_MODEL('',(#103,#105));
        #105=ORIENTED_OPEN_SHELL('',*,#105,.T.);#106=SHAPE_REPRESENTATION('',(#104,#107),#68);
        #107=MAPPED_ITEM('',#108,#11);#108=REPRESENTATION_MAP(#11,#106);";
    let (faces, lost) = left_out(and(cycle));
    assert_eq!(faces, 3);
    for (entity, words) in [(102, "nested too deep"), (105, "a shell was expected"), (107, "contains itself")] {
        assert!(lost.iter().any(|(e, why)| *e == entity && why.contains(words)), "{entity}: {lost:?}");
    }
}

#[test]
fn a_shell_or_solid_that_cannot_be_read_is_told() {
    let why = |text: String| parsed(text).map(|_| "it was read").unwrap_err().to_string();
    assert_eq!(why(with("#16=PLANE('',#64);")), "parse: no face could be read: a shell was expected (#16)");
    assert_eq!(
        why(with("#15=MANIFOLD_SOLID_BREP('',$);")),
        "parse: no face could be read: a reference was expected (#15)"
    );
    assert_eq!(why(with("#16=CLOSED_SHELL('',());")), "parse: wireframe only: no faces");
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    assert_lost(with("#56=CARTESIAN_POINT('',(0.,0.,1.E999));"), 50, "#56: a number that is not finite");
    assert_lost(with("#56=CARTESIAN_POINT('',(0.,0.,NAN));"), 50, "#56: a number was expected");
    assert_lost(with("#56=CARTESIAN_POINT('',(0.,0.,-INF));"), 50, "#56: a number that is not finite");
    assert_lost(with("#57=DIRECTION('',(0.,1.E400,1.));"), 50, "#57: a number that is not finite");
    assert_lost(with("#45=CYLINDRICAL_SURFACE('',#46,1.E999);"), 17, "#45: a number that is not finite");
    assert_lost(with("#45=CYLINDRICAL_SURFACE('',#46,-2.);"), 17, "#45: a length that is not positive");
    assert_lost(with("#45=CYLINDRICAL_SURFACE('',#46,0.);"), 17, "#45: a length that is not positive");
    // Finite in metres, infinite in mm.
    let metres = with("#69=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));");
    let far = metres.replace("#56=CARTESIAN_POINT('',(0.,0.,5.));", "#56=CARTESIAN_POINT('',(0.,0.,1.E307));");
    assert_lost(far, 50, "#56: a number that is not finite");
}

#[test]
fn one_point_far_out_does_not_spoil_the_model() {
    for value in ["1.E30", "1.E160", "-1.E300"] {
        let (faces, lost) = left_out(with(&format!("#56=CARTESIAN_POINT('',(0.,0.,{value}));")));
        assert!(faces == 2 && lost.iter().any(|(entity, _)| *entity == 50), "{value}: {faces} faces, {lost:?}");
        // The vertex of an edge of the wall and of the top.
        let (faces, lost) = left_out(with(&format!("#23=CARTESIAN_POINT('',({value},0.,5.));")));
        assert!(faces >= 1 && !lost.is_empty(), "{value}: {faces} faces, {lost:?}");
    }
}

#[test]
fn huge_counts_and_degrees_are_refused() {
    let face = "#102=ADVANCED_FACE('',(#51),#101,.T.);";
    let more = |surface: &str| {
        with("#16=CLOSED_SHELL('',(#17,#50,#59,#102));")
            .replace("ENDSEC;END", &format!("#101={surface};{face}ENDSEC;END"))
    };
    let net = "((#12,#23),(#32,#26))";
    for (surface, words) in [
        (format!("BEZIER_SURFACE('',1000000000,1,{net},.U.,.F.,.F.,.F.)"), "a whole number within limits"),
        (format!("BEZIER_SURFACE('',26,1,{net},.U.,.F.,.F.,.F.)"), "a whole number within limits"),
        (format!("BEZIER_SURFACE('',0,1,{net},.U.,.F.,.F.,.F.)"), "degree 0"),
        (format!("BEZIER_SURFACE('',3,1,{net},.U.,.F.,.F.,.F.)"), "2 control points for degree 3"),
        (
            format!(
                "B_SPLINE_SURFACE_WITH_KNOTS('',1,1,{net},.U.,.F.,.F.,.F.,(2,4000000000),(2,2),(0.,1.),(0.,1.),.U.)"
            ),
            "knots that do not fit",
        ),
        (
            format!("B_SPLINE_SURFACE_WITH_KNOTS('',1,1,{net},.U.,.F.,.F.,.F.,(2,2),(2,2),(1.,0.),(0.,1.),.U.)"),
            "knots that do not grow",
        ),
        ("BEZIER_SURFACE('',1,1,((#12,#23),(#32)),.U.,.F.,.F.,.F.)".into(), "unequal length"),
        ("BEZIER_SURFACE('',1,1,(),.U.,.F.,.F.,.F.)".into(), "no control points"),
    ] {
        let (faces, lost) = left_out(more(&surface));
        assert!(faces == 3 && lost.iter().any(|(e, why)| *e == 102 && why.contains(words)), "{surface}: {lost:?}");
    }
}

#[test]
fn weights_that_vanish_are_refused() {
    let rational = |weights: &str| {
        with("#39=(BOUNDED_CURVE()B_SPLINE_CURVE(2,(#12,#23,#32),.U.,.F.,.F.)B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.),.U.)\
             CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE((WEIGHTS))REPRESENTATION_ITEM(''));")
        .replace("WEIGHTS", weights)
    };
    for (weights, words) in [
        ("1.,0.,1.", "a weight that is not positive"),
        ("1.,-1.,1.", "a weight that is not positive"),
        ("1.,1.", "not as many weights as control points"),
    ] {
        let found = parsed(rational(weights)).unwrap();
        let lost: Vec<_> = found.skipped.iter().map(|s| (s.entity, s.why.as_str())).collect();
        assert_eq!(lost, [17, 59].map(|face| (face, "#38: a closed edge without a curve")));
        assert_eq!(found.warnings[0], format!("edge #38 is taken as straight: #39: {words}"));
    }
}

#[test]
fn deep_nesting_costs_one_entity() {
    let deep = |n: usize| format!("{}1.{}", "(".repeat(n), ")".repeat(n));
    assert_lost(with(&format!("#56=CARTESIAN_POINT('',{});", deep(300_000))), 50, "#56");
    assert_lost(with(&format!("#50=ADVANCED_FACE('',{},#54,.T.);", deep(300_000))), 50, "a reference was expected");
    assert_whole(and(&format!("#100=PROPERTY{};", deep(300_000))));
    assert_lost(with(&format!("#54=PLANE('',{}#55;", "(".repeat(300_000))), 50, "#54");
    assert_whole(and(&format!("#100=(A{}B());", deep(300_000))));
}

#[test]
fn comments_and_control_directives_in_strings_are_only_text() {
    assert_whole(with("#18=FACE_BOUND('/* no comment; #18=FACE_BOUND('''' */',#19,.T.);"));
    assert_whole(with("#18=FACE_BOUND('\\X2\\0410042004\\X0\\ \\S\\D \\PA\\ \\X\\C4 \\N\\ \\F\\ ;',#19,.T.);"));
    assert_whole(with("#18=/* FACE_BOUND('x',#1,.F.); ' */FACE_BOUND(/**/'it''s'/*'*/,/*,*/#19/*\n*/,.T./**/)/**/;"));
    assert_whole(CYLINDER.replace(',', " /* , */\n,\\N\\ "));
}

#[test]
fn raw_bytes_beyond_ascii_are_only_text() {
    let named = with("#18=FACE_BOUND('NAME',#19,.T.);");
    let at = named.find("NAME").unwrap();
    for name in [&b"\xca\xee\xeb\xb8\xf1\xee"[..], b"\xff\xfe\x00\x01;", "Zahnr\u{e4}der \u{6b6f}\u{8eca}".as_bytes()] {
        assert_whole([&named.as_bytes()[..at], name, &named.as_bytes()[at + 4..]].concat());
    }
    let marked = [b"\xef\xbb\xbf".as_slice(), CYLINDER.as_bytes()].concat();
    assert_whole(marked);
}

#[test]
fn lower_case_is_read_as_upper_case() {
    assert_whole(CYLINDER.to_lowercase());
}

#[test]
fn line_ends_of_all_systems_are_read() {
    assert_whole(CYLINDER.replace('\n', "\r\n"));
    assert_whole(CYLINDER.replace('\n', "\r"));
    assert_whole(CYLINDER.replace('\n', ""));
    assert_whole(CYLINDER.replace(',', ",\r\n\t "));
}

#[test]
fn a_header_or_an_end_that_is_missing_costs_nothing() {
    let data = CYLINDER.find("DATA;").unwrap();
    assert_whole(&CYLINDER.as_bytes()[data..]);
    assert_whole(&CYLINDER.as_bytes()[data + 5..]);
    assert_whole(CYLINDER.replace("FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));", "FILE_SCHEMA;FILE_NAME(;"));
    assert_whole(CYLINDER.replace("END-ISO-10303-21;", "end-iso-10303-21;"));
    assert_whole(CYLINDER.replace("ENDSEC;END-ISO-10303-21;", "\0\0\0\x1a"));
}

#[test]
fn instances_in_any_order_and_twice_are_read() {
    let text = part21::Text::split(CYLINDER.as_bytes());
    let mut reversed = text.clone();
    reversed.instances.reverse();
    assert_whole(reversed.join());
    let mut doubled = text.clone();
    doubled.instances.extend(text.instances.clone());
    assert_whole(doubled.join());
    let warnings = parsed(doubled.join()).unwrap().warnings;
    assert_eq!(warnings, [format!("{} instances repeat the number of another one", text.instances.len())]);
}

#[test]
fn giant_strings_and_names_are_passed_over() {
    let long = 200_000_000;
    assert_whole(with(&format!("#18=FACE_BOUND('{}',#19,.T.);", "x".repeat(long))));
    assert_whole(CYLINDER.replace("AUTOMOTIVE_DESIGN", &"\u{e4}".repeat(10_000_000)));
    assert_whole(and(&format!("#100={}();", "X".repeat(long / 4))));
    assert_whole(and(&format!("/*{}*/", "*".repeat(long / 4))));
    assert_lost(with(&format!("#54=PLANE('{}", "x".repeat(long / 4))), 50, "#54: there is no such instance");
}

#[test]
fn what_is_no_step_file_is_told() {
    let why = |bytes: &[u8]| parsed(bytes).map(|_| "it was read").unwrap_err().why;
    for bytes in
        [&b""[..], b"\0\0\0\0", b"solid cube\nendsolid", b"PK\x03\x04", &[0xff; 4000], b"#", b"'", b"/*", b"(((("]
    {
        assert_eq!(why(bytes), "not a STEP, IGES or .brep file");
    }
    assert_eq!(why(b"ISO-10303-21;HEADER;ENDSEC;DATA;ENDSEC;END-ISO-10303-21;"), "no entities");
}
