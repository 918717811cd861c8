//! Binary STL: triangles without structure, mm.

use std::io::{self, Write};

use super::parts::{Part, doubled_normal, parts, single};
use crate::geometry::{Isometry, Vector};
use crate::stages::parse::Parsed;

/// Bytes of the header, which says nothing.
const HEADER: usize = 80;

/// Writes the model after a motion: 80 bytes of header, the number of triangles, then of each its normal, its
/// corners (f32, mm) and two zero bytes, little-endian.
///
/// # Errors
/// More triangles than the format can count, or an output that takes no more.
pub fn stl(parsed: &Parsed, by: &Isometry, out: &mut dyn Write) -> io::Result<()> {
    let count = u32::try_from(parsed.mesh.triangles.len()).map_err(io::Error::other)?;
    let mut header = [b' '; HEADER];
    header[..8].copy_from_slice(b"symalign");
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    parts(parsed, by).iter().try_for_each(|part| write_part(part, out))
}

fn write_part(part: &Part, out: &mut dyn Write) -> io::Result<()> {
    for triangle in &part.triangles {
        let normal = doubled_normal(&part.points, triangle).try_normalize(0.0).unwrap_or_else(Vector::zeros);
        let corners = triangle.map(|i| single(&part.points[i as usize].coords, 1.0));
        for value in single(&normal, 1.0).iter().chain(corners.as_flattened()) {
            out.write_all(&value.to_le_bytes())?;
        }
        out.write_all(&[0; 2])?;
    }
    Ok(())
}
