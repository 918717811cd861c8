//! Reading small files written here: what stands for itself, placement, units, trimming, and what is broken.

use proptest::prelude::*;

use super::*;
use crate::brep::Model;
use crate::geometry::Point;
use crate::stages::parse::parse;

/// One entity: its type, form, matrix, status and parameters behind the type.
struct Entity(u32, i32, u64, &'static str, String);

fn entity(kind: u32, parameters: &str) -> Entity {
    Entity(kind, 0, 0, "00000000", parameters.to_owned())
}

fn part(kind: u32, parameters: &str) -> Entity {
    Entity(kind, 0, 0, "00010000", parameters.to_owned())
}

/// The text of a file; the n-th entity has the number 2 n - 1.
fn file(unit: &str, entities: &[Entity]) -> String {
    let line = |text: &str, letter: char, number: usize| format!("{text:<72}{letter}{number:7}\n");
    let mut text = line("a test", 'S', 1);
    let global = format!("1H,,1H;,1Ha,1Ha,1Ha,1Ha,32,38,6,308,15,1Ha,1.,{unit},1,0.01,1Ha,1E-6,9.,1Ha,1Ha,11,0,1Ha;");
    let chunks: Vec<&str> = global.as_bytes().chunks(72).map(|c| std::str::from_utf8(c).unwrap()).collect();
    chunks.iter().enumerate().for_each(|(i, chunk)| text += &line(chunk, 'G', i + 1));
    let (mut directory, mut parameters, mut at) = (String::new(), String::new(), 0);
    for (i, Entity(kind, form, matrix, status, values)) in entities.iter().enumerate() {
        let whole = format!("{kind},{values};");
        let chunks: Vec<&str> = whole.as_bytes().chunks(64).map(|c| std::str::from_utf8(c).unwrap()).collect();
        let first = format!("{kind:8}{:8}{:8}{:8}{:8}{:8}{matrix:8}{:8}{status}", at + 1, 0, 0, 0, 0, 0);
        let second = format!("{kind:8}{:8}{:8}{:8}{form:8}", 0, 0, chunks.len());
        directory += &line(&first, 'D', 2 * i + 1);
        directory += &line(&second, 'D', 2 * i + 2);
        for chunk in chunks {
            at += 1;
            parameters += &line(&format!("{chunk:<64}{:8}", 2 * i + 1), 'P', at);
        }
    }
    text + &directory + &parameters + &line("", 'T', 1)
}

/// The unit square in z = 0 with a round hole of radius 0.25, trimmed from a bilinear patch.
fn square() -> Vec<Entity> {
    let flat = "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,1.,0.,0.,0.,1.,0.,1.,1.,0.,0.,1.,0.,1.";
    vec![
        entity(144, "3,1,1,5,17"),
        part(128, flat),
        part(142, "0,3,0,7,2"),
        part(102, "4,9,11,13,15"),
        part(110, "0.,0.,0.,1.,0.,0."),
        part(110, "1.,0.,0.,1.,1.,0."),
        // Written from its end.
        part(110, "0.,1.,0.,1.,1.,0."),
        part(110, "0.,1.D0,0.,0.,0.,0."),
        part(142, "0,3,0,19,2"),
        part(100, "0.,0.5,0.5,0.75,0.5,0.75,0.5"),
    ]
}

fn read_text(text: &str) -> Result<Reading, ModelError> {
    read(text.as_bytes(), &Options::default(), &Cancel::new())
}

fn area(text: &str) -> f64 {
    parse(text.as_bytes(), &Options::default(), None, &Cancel::new()).unwrap().measures.area
}

fn placed_faces(model: &Model) -> usize {
    model.occurrences.iter().map(|o| model.faces_of(o.body).count()).sum()
}

#[test]
fn a_trimmed_square_has_its_area_in_every_unit() {
    let expected = 1.0 - std::f64::consts::PI / 16.0;
    let mm = area(&file("2,2HMM", &square()));
    assert!((mm - expected).abs() < 1e-6, "{mm} for {expected}");
    assert!((area(&file("1,4HINCH", &square())) / 25.4_f64.powi(2) - mm).abs() < 1e-9);
    let Reading { model, skipped, warnings } = read_text(&file("2,2HMM", &square())).unwrap();
    assert_eq!((model.vertices.len(), model.edges.len(), model.faces[0].entity), (5, 5, 1));
    assert_eq!((model.schema.as_str(), model.unit_mm), ("IGES 5.3", 1.0));
    assert!(skipped.is_empty() && warnings.is_empty());
}

#[test]
fn lower_case_and_crlf_and_cut_lines_are_read() {
    let text = file("2,2HMM", &square()).replace("D0", "d0").replace('\n', "\r\n");
    assert!((area(&text) - 1.0 + std::f64::consts::PI / 16.0).abs() < 1e-6);
}

#[test]
fn subfigures_place_their_faces_several_times() {
    let mut entities = square();
    entities[0].3 = "00010000";
    entities.push(Entity(308, 0, 0, "00010200", "0,1Hs,1,1".into()));
    entities.push(entity(408, "21,10.,0.,0.,1."));
    entities.push(Entity(408, 0, 27, "00000000", "21,0.,0.,0.,2.".into()));
    // A quarter turn about z.
    entities.push(part(124, "0.,-1.,0.,5.,1.,0.,0.,0.,0.,0.,1.,0."));
    let Reading { model, .. } = read_text(&file("2,2HMM", &entities)).unwrap();
    let placed: Vec<_> =
        model.occurrences.iter().map(|o| (o.path.as_str(), o.placement.point(&Point::new(1.0, 0.0, 0.0)))).collect();
    assert_eq!(placed, [("23", Point::new(11.0, 0.0, 0.0)), ("25", Point::new(5.0, 2.0, 0.0))]);
}

#[test]
fn blanked_and_annotation_and_dependent_entities_are_left_out() {
    let mut entities = square();
    let count = |entities: &[Entity]| read_text(&file("2,2HMM", entities)).map(|r| placed_faces(&r.model));
    entities.push(Entity(144, 0, 0, "01000000", "3,1,0,5".into()));
    entities.push(Entity(144, 0, 0, "00000100", "3,1,0,5".into()));
    entities.push(Entity(144, 0, 0, "00010000", "3,1,0,5".into()));
    assert_eq!(count(&entities).unwrap(), 1);
    entities[0].3 = "01000000";
    assert_eq!(count(&entities).unwrap(), 2, "where nothing stands for itself all that is shown counts");
}

#[test]
fn a_surface_without_boundary_has_that_of_its_parameters() {
    let mut entities = square();
    entities[0] = entity(144, "3,0,1,0,17");
    assert!((area(&file("2,2HMM", &entities)) - 1.0 + std::f64::consts::PI / 16.0).abs() < 1e-6);
    entities[0] = entity(100, "0.,0.,0.,1.,0.,1.,0.");
    entities[1].3 = "00000000";
    assert!((area(&file("2,2HMM", &entities)) - 1.0).abs() < 1e-6);
}

#[test]
fn a_curve_in_parameter_space_stands_in_for_one_in_space() {
    // A tube of radius 2 about z, 3 high: u along the line, v round the axis.
    let entities = [
        entity(144, "3,1,0,9"),
        part(120, "5,7,0.,6.283185307"),
        part(110, "0.,0.,0.,0.,0.,1."),
        part(110, "2.,0.,0.,2.,0.,3."),
        part(142, "0,3,11,0,1"),
        part(102, "4,13,15,17,19"),
        part(110, "0.,0.,0.,1.,0.,0."),
        part(110, "1.,0.,0.,1.,3.,0."),
        part(110, "1.,3.,0.,0.,3.,0."),
        part(110, "0.,3.,0.,0.,0.,0."),
    ];
    assert!((area(&file("2,2HMM", &entities)) - 18.0).abs() < 1e-4);
}

#[test]
fn a_conic_arc_and_a_tabulated_cylinder() {
    // A quarter of the ellipse (x / 4)^2 + (y / 2)^2 = 1, extruded by 3 along z.
    let entities = [entity(122, "3,4.,0.,3."), part(104, "1.,0.,4.,0.,0.,-16.,0.,4.,0.,0.,2.")];
    let Reading { model, .. } = read_text(&file("2,2HMM", &entities)).unwrap();
    let ends: Vec<Point> = model.vertices.iter().map(|v| v.point).collect();
    let near = |p: [f64; 3]| ends.iter().any(|e| (e - Point::from(p)).norm() < 1e-9);
    assert!(near([4.0, 0.0, 0.0]) && near([0.0, 2.0, 0.0]) && near([0.0, 2.0, 3.0]), "{ends:?}");
    // A quarter of its circumference is 4.8442241...
    assert!((area(&file("2,2HMM", &entities)) - 3.0 * 4.844_224_1).abs() < 1e-3);
}

#[test]
fn a_solid_with_topology_is_closed() {
    // The ball of radius 1: one face, its only loop a vertex.
    let entities = [
        entity(186, "3,1,0"),
        Entity(514, 1, 0, "00010000", "1,5,1".into()),
        Entity(510, 1, 0, "00010000", "7,1,0,11".into()),
        part(196, "9,1."),
        part(116, "5.,0.,0."),
        Entity(508, 1, 0, "00010000", "1,1,13,1,1,0".into()),
        Entity(502, 1, 0, "00010000", "1,5.,0.,1.".into()),
    ];
    let text = file("2,2HMM", &entities);
    let parsed = parse(text.as_bytes(), &Options::default(), None, &Cancel::new()).unwrap();
    assert_eq!((parsed.model.bodies[0].solid, parsed.model.shells[0].closed), (true, true));
    let volume = parsed.measures.volume;
    assert!((volume - std::f64::consts::PI * 4.0 / 3.0).abs() < 1e-3, "{volume}");
    assert!((parsed.measures.centroid.x - 5.0).abs() < 1e-3, "{}", parsed.measures.centroid);
}

#[test]
fn files_without_faces_say_why() {
    let why = |entities: &[Entity]| {
        let error = read_text(&file("2,2HMM", entities)).unwrap_err();
        (error.entity, error.why)
    };
    assert_eq!(why(&[]), (None, "no entities".into()));
    assert_eq!(why(&[entity(110, "0.,0.,0.,1.,0.,0.")]), (None, "no faces".into()));
    assert_eq!(why(&[entity(144, "9,1,0,5")]), (Some(1), "no face could be read: #9: there is no such entity".into()));
    assert_eq!(why(&[entity(144, "1,1,0,5")]).1, "no face could be read: not a surface that is known");
    assert_eq!(why(&[entity(184, "1,1")]), (Some(1), "no face could be read: an entity that is part of itself".into()));
    assert_eq!(
        why(&[entity(128, "999999,999999,1,1")]).1,
        "no face could be read: too few parameters for what they announce"
    );
    let compressed = format!("{:72}C{:7}\n", "", 1);
    assert_eq!(read_text(&compressed).unwrap_err().why, "a compressed IGES file: only the fixed form is read");
}

#[test]
fn curves_that_multiply_end() {
    let mut entities = vec![entity(144, "3,1,0,5"), part(110, "0.,0.,0.,1.,0.,0."), part(142, "0,3,0,7,2")];
    (0..40).for_each(|i| entities.push(part(102, &format!("2,{0},{0}", 9 + 2 * i))));
    assert!(read_text(&file("2,2HMM", &entities)).is_err());
}

proptest! {
    #[test]
    fn mutated_files_never_panic(cut in 0_usize..4000, changes in prop::collection::vec((0_usize..4000, any::<u8>()), 0..8)) {
        let mut bytes = file("2,2HMM", &square()).into_bytes();
        let length = bytes.len();
        changes.into_iter().for_each(|(at, value)| bytes[at % length] = value);
        bytes.truncate(length - cut % 90);
        if let Ok(Reading { model, .. }) = read(&bytes, &Options::default(), &Cancel::new()) {
            prop_assert!(!model.occurrences.is_empty());
        }
    }

    #[test]
    fn changed_digits_never_panic(changes in prop::collection::vec((0_usize..4000, b'0'..=b'9'), 1..20)) {
        let mut bytes = file("2,2HMM", &square()).into_bytes();
        let digits: Vec<usize> = (80..bytes.len()).filter(|&i| bytes[i].is_ascii_digit() && i % 81 < 72).collect();
        changes.into_iter().for_each(|(at, digit)| bytes[digits[at % digits.len()]] = digit);
        if let Ok(Reading { model, .. }) = read(&bytes, &Options::default(), &Cancel::new()) {
            prop_assert!(!model.occurrences.is_empty());
        }
    }
}
