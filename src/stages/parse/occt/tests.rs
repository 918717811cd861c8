//! Reading small files written here: places, orientations, what is left out, and what is broken.

use proptest::prelude::*;

use super::*;
use crate::brep::FaceGeometry;
use crate::geometry::{Point, Vector};
use crate::stages::parse::parse;

const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
/// The edges of each face with their senses, counter-clockwise seen from outside.
const FACES: [[(usize, char); 3]; 4] = [
    [(1, '+'), (3, '-'), (0, '-')],
    [(0, '+'), (4, '+'), (2, '-')],
    [(2, '+'), (5, '-'), (1, '-')],
    [(3, '+'), (5, '+'), (4, '-')],
];
/// A corner of each face and its outward normal.
const NORMALS: [(usize, [f64; 3]); 4] =
    [(0, [0.0, 0.0, -1.0]), (0, [0.0, -1.0, 0.0]), (0, [-1.0, 0.0, 0.0]), (1, [1.0, 1.0, 1.0])];

/// Shapes of the solid tetrahedron; number n of `total` in the file is referred to as total + 1 - n. The solid is the
/// twentieth shape.
fn tetrahedron(total: usize) -> String {
    let number = |position: usize| total - position;
    let mut text = String::new();
    for [x, y, z] in CORNERS {
        text += &format!("Ve\n1e-07\n{x} {y} {z}\n0 0\n\n0101101\n*\n");
    }
    for (i, [a, b]) in EDGES.iter().enumerate() {
        let length = if *a == 0 { 1.0 } else { 2.0_f64.sqrt() };
        let ends = format!("+{} 0 -{} 0 *", number(*a), number(*b));
        text += &format!("Ed\n 1e-07 1 1 0\n1  {} 0 0 {length}\n0\n\n0101000\n{ends}\n", i + 1);
    }
    for (i, face) in FACES.iter().enumerate() {
        let uses: String = face.iter().map(|(e, sense)| format!("{sense}{} 0 ", number(4 + e))).collect();
        text += &format!("Wi\n\n0101100\n{uses}*\n");
        text += &format!("Fa\n0  1e-07 {} 0\n\n0111000\n+{} 0 *\n", i + 1, number(10 + 2 * i));
    }
    let faces: String = (0..4).map(|i| format!("+{} 0 ", number(11 + 2 * i))).collect();
    text + &format!("Sh\n\n0101100\n{faces}*\nSo\n\n0100000\n+{} 0 *\n", number(18))
}

/// A file with these locations (`Locations` without its count), the tetrahedron, and more shapes.
fn file(locations: &[&str], more: &[&str]) -> String {
    let mut text =
        format!("CASCADE Topology V1, (c) Matra-Datavision\nLocations {}\n{}\n", locations.len(), locations.join("\n"));
    text += "Curve2ds 0\nCurves 6\n";
    for [a, b] in EDGES.map(|e| e.map(|i| Vector::from(CORNERS[i]))) {
        let d = (b - a).normalize();
        text += &format!("1 {} {} {} {} {} {}\n", a.x, a.y, a.z, d.x, d.y, d.z);
    }
    text += "Polygon3D 0\nPolygonOnTriangulations 0\nSurfaces 4\n";
    for (corner, normal) in NORMALS {
        let (o, z) = (Vector::from(CORNERS[corner]), Vector::from(normal).normalize());
        let x = crate::geometry::any_perpendicular(&z);
        let y = z.cross(&x);
        let frame = [o, z, x, y].iter().flat_map(|v| v.iter()).map(f64::to_string).collect::<Vec<_>>().join(" ");
        text += &format!("1 {frame}\n");
    }
    let total = 20 + more.len();
    text + &format!("Triangulations 0\n\nTShapes {total}\n{}{}\n+1 0\n", tetrahedron(total), more.join("\n"))
}

fn read_text(text: &str) -> Result<Reading, ModelError> {
    read(text.as_bytes(), &Options::default(), &Cancel::new())
}

#[test]
fn a_tetrahedron_shares_its_edges_and_has_its_volume() {
    let Reading { model, skipped, warnings } = read_text(&file(&[], &[])).unwrap();
    assert_eq!((model.vertices.len(), model.edges.len(), model.faces.len()), (4, 6, 4));
    assert_eq!((model.bodies[0].entity, model.bodies[0].solid, model.shells[0].closed), (20, true, true));
    assert_eq!(model.faces.iter().map(|f| f.entity).collect::<Vec<_>>(), [12, 14, 16, 18]);
    assert!(skipped.is_empty() && warnings.is_empty());
    let parsed = parse(file(&[], &[]).as_bytes(), &Options::default(), None, &Cancel::new()).unwrap();
    assert!((parsed.measures.area - 1.5 - 0.75_f64.sqrt()).abs() < 1e-12);
    assert!((parsed.measures.volume - 1.0 / 6.0).abs() < 1e-12);
}

#[test]
fn compounds_place_a_body_several_times() {
    let shift = "1 1 0 0 10 0 1 0 0 0 0 1 0";
    let mirror = "1 -1 0 0 0 0 1 0 0 0 0 1 0";
    let composed = "2 1 2 2 1 0";
    let inner = "Co\n\n1100000\n+3 1 -3 3 *";
    let text = file(&[shift, mirror, composed], &[inner, "Co\n\n1100000\n+2 0 +3 0 *"]);
    let Reading { model, .. } = read_text(&text).unwrap();
    let end = Point::new(1.0, 0.0, 0.0);
    let placed: Vec<_> = model.occurrences.iter().map(|o| (o.path.as_str(), o.placement.point(&end).x)).collect();
    // Composed: twice the shift, then the mirror.
    assert_eq!(placed, [("1.1", 11.0), ("1.2", -21.0), ("2", 1.0)]);
    assert_eq!(model.bodies.len(), 1);
}

/// The normals of faces in mirrored places inside a body point outward, as the orientation of the shell says.
#[test]
fn a_mirrored_shell_inside_a_solid_is_turned() {
    let mirror = "1 -1 0 0 0 0 1 0 0 0 0 1 0";
    let text = file(&[mirror], &["So\n\n0100000\n-3 1 *"]);
    let parsed = parse(text.as_bytes(), &Options::default(), None, &Cancel::new()).unwrap();
    assert!((parsed.measures.bounds.min.x + 1.0).abs() < 1e-12);
    let flux: f64 = parsed.mesh.faces.iter().map(|f| f.flux).sum();
    assert!((flux - 1.0 / 6.0).abs() < 1e-12, "{flux}");
}

#[test]
fn loose_faces_of_a_compound_are_one_body() {
    let text = file(&[], &["Co\n\n1100000\n+10 0 +8 0 *"]);
    let Reading { model, .. } = read_text(&text).unwrap();
    assert_eq!((model.bodies.len(), model.faces.len(), model.bodies[0].solid), (1, 2, false));
    assert_eq!(model.bodies[0].entity, 21);
}

#[test]
fn a_face_without_surface_has_its_triangles() {
    let triangles = "\nTriangulations 1\n3 1 0 0.1\n0 0 0 1 0 0 0 1 0\n1 2 3";
    let text = file(&[], &["Fa\n0  1e-07 0 0\n2 1\n0111000\n*", "Sh\n\n0101000\n-2 0 *"]);
    let text = text.replace("\nTriangulations 0", triangles);
    let Reading { model, .. } = read_text(&text).unwrap();
    let FaceGeometry::Faceted(facets) = &model.faces[0].geometry else { panic!("triangles are facets") };
    assert_eq!(facets.triangles, [[0, 2, 1]], "the shell uses the face reversed");
}

#[test]
fn a_broken_face_is_skipped_with_its_number() {
    let text = file(&[], &[]).replace("\nFa\n0  1e-07 2 0", "\nFa\n0  1e-07 9 0");
    let Reading { model, skipped, .. } = read_text(&text).unwrap();
    assert_eq!(model.faces.len(), 3);
    assert_eq!((skipped[0].entity, skipped[0].why.as_str()), (14, "a face without a surface"));
}

#[test]
fn files_that_cannot_be_read_say_why() {
    let why = |text: &str| read_text(text).unwrap_err().why;
    let whole = file(&[], &[]);
    let cut = &whole[..whole.find("So\n").unwrap()];
    assert_eq!(why(cut), "the file cannot be read on: TShape 20 of 20: the file ends");
    assert!(why(&whole.replace("Surfaces 4", "Surfaces 9")).contains("Surfaces 5 of 9: a whole number was expected"));
    assert!(why(&whole.replace("Curves 6", "Curves 4000000000")).contains("more things are announced"));
    assert_eq!(why("\nOpen CASCADE Topology V4 (c)\n"), "a binary .brep file: only the text form is read");
    assert_eq!(why(&whole.replace("So\n\n0100000\n+2 0 *", "So\n\n0100000\n*")), "no faces");
    assert!(is_brep(whole.as_bytes()) && is_brep(format!("DBRep_DrawableShape\n\n{whole}").as_bytes()));
    assert!(!is_brep(b"ISO-10303-21; /* CASCADE Topology V1 */"));
}

#[test]
fn uses_that_multiply_end() {
    let doubled: Vec<String> = (0..40).map(|i| format!("Co\n\n1100000\n+{0} 1 +{0} 1 *", 41 - i)).collect();
    let more: Vec<&str> = doubled.iter().map(String::as_str).collect();
    let text = file(&["1 1 0 0 10 0 1 0 0 0 0 1 0"], &more);
    let options = Options { most_occurrences: 1000, ..Options::default() };
    let Reading { model, skipped, .. } = read(text.as_bytes(), &options, &Cancel::new()).unwrap();
    assert!(!model.occurrences.is_empty() && model.occurrences.len() <= 1000);
    assert!(skipped.iter().any(|s| s.why == "too many bodies are placed"));
}

proptest! {
    #[test]
    fn mutated_files_never_panic(cut in 0_usize..4000, changes in prop::collection::vec((0_usize..4000, any::<u8>()), 0..8)) {
        let mut bytes = file(&["1 1 0 0 10 0 1 0 0 0 0 1 0"], &["Co\n\n1100000\n+2 1 +2 0 *"]).into_bytes();
        let length = bytes.len();
        changes.into_iter().for_each(|(at, value)| bytes[at % length] = value);
        bytes.truncate(length - cut % 40);
        if let Ok(Reading { model, .. }) = read(&bytes, &Options::default(), &Cancel::new()) {
            prop_assert!(!model.occurrences.is_empty());
        }
    }

    #[test]
    fn changed_digits_never_panic(changes in prop::collection::vec((0_usize..4000, b'0'..=b'9'), 1..20)) {
        let mut bytes = file(&["1 1 0 0 10 0 1 0 0 0 0 1 0"], &["Co\n\n1100000\n+2 1 +2 0 *"]).into_bytes();
        let digits: Vec<usize> = (60..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
        changes.into_iter().for_each(|(at, digit)| bytes[digits[at % digits.len()]] = digit);
        if let Ok(Reading { model, .. }) = read(&bytes, &Options::default(), &Cancel::new()) {
            prop_assert!(!model.occurrences.is_empty());
        }
    }
}
