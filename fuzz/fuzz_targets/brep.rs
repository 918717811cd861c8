//! Valid Part 21 text with changed values and references -> B-rep, mesh and measures.
#![no_main]

#[path = "../../tests/part21/mod.rs"]
mod part21;

use libfuzzer_sys::{fuzz_crossover, fuzz_mutator, fuzz_target, fuzzer_mutate};
use part21::Text;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use symalign::brep::tessellate;
use symalign::cancel::Cancel;
use symalign::stages::parse::{Options, parse};

/// Small limits, so that a find is not only a large model.
fn options() -> Options {
    let tessellation = tessellate::Options { deflection: 0.05, angle: 0.8, max_triangles: 200_000 };
    Options { most_occurrences: 1000, most_faces: 1000, tessellation }
}

fuzz_target!(|bytes: &[u8]| {
    let Ok(parsed) = parse(bytes, &options(), None, &Cancel::new()) else { return };
    let measures = &parsed.measures;
    assert!(measures.area.is_finite() && measures.volume.is_finite(), "{measures:?}");
    assert!(measures.centroid.iter().all(|c| c.is_finite()), "{measures:?}");
    assert!(parsed.mesh.points.iter().flat_map(|p| p.iter()).all(|c| c.is_finite()));
    let points = parsed.mesh.points.len() as u32;
    assert!(parsed.mesh.triangles.iter().flatten().all(|i| *i < points));
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let mut rng = Pcg64::seed_from_u64(u64::from(seed));
    if rng.random_range(0..16) == 0 {
        return fuzzer_mutate(data, size, max_size);
    }
    let mut text = Text::split(&data[..size]);
    for _ in 0..rng.random_range(1..=4) {
        text.change(&mut rng);
    }
    give(&text, data, max_size)
});

fuzz_crossover!(|a: &[u8], b: &[u8], out: &mut [u8], seed: u32| {
    let mut rng = Pcg64::seed_from_u64(u64::from(seed));
    let (mut text, other) = (Text::split(a), Text::split(b));
    for instance in other.instances {
        let number = part21::number_of(&instance);
        let known = text.instances.iter().position(|i| part21::number_of(i) == number);
        match known {
            Some(at) if rng.random_bool(0.3) => text.instances[at] = instance,
            Some(_) => {}
            None => text.instances.push(instance),
        }
    }
    let length = out.len();
    give(&text, out, length)
});

/// Writes the text where it fits; text that is too long is cut, which is a case, too.
fn give(text: &Text, data: &mut [u8], max_size: usize) -> usize {
    let bytes = text.join();
    let length = bytes.len().min(max_size).min(data.len());
    data[..length].copy_from_slice(&bytes[..length]);
    length
}
