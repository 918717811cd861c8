//! Wavefront OBJ: text, an object for each placed body, a group for each face, mm.

use std::io::{self, Write};

use super::parts::{Part, parts, single};
use crate::geometry::Isometry;
use crate::stages::parse::Parsed;

/// Writes the model after a motion, with normals.
///
/// # Errors
/// An output that takes no more.
pub fn obj(parsed: &Parsed, by: &Isometry, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "# symalign, mm")?;
    let mut first = 1;
    for part in parts(parsed, by) {
        write_part(&part, first, out)?;
        first += part.points.len();
    }
    Ok(())
}

/// `first` is the number of the part's first point: OBJ counts the points of the whole file from 1.
fn write_part(part: &Part, first: usize, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "o {}", part.name)?;
    for point in &part.points {
        let [x, y, z] = single(&point.coords, 1.0);
        writeln!(out, "v {x} {y} {z}")?;
    }
    for normal in &part.normals {
        let [x, y, z] = single(normal, 1.0);
        writeln!(out, "vn {x} {y} {z}")?;
    }
    let mut triangles = part.triangles.iter();
    for (name, count) in &part.faces {
        writeln!(out, "g {name}")?;
        for triangle in triangles.by_ref().take(*count) {
            let [a, b, c] = triangle.map(|i| first + i as usize);
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        }
    }
    Ok(())
}
