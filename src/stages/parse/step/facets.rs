//! AP242 tessellated geometry: triangles that the file itself holds.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::cursor::Cursor;
use super::keyword::Kind;
use super::records::Record;
use super::topology::{Builder, LooseFace};
use crate::brep::{FaceGeometry, Facets, Loops};
use crate::geometry::{Point, Vector};
use crate::stages::parse::fault::{Fault, Read};

impl Builder<'_> {
    /// The faces of a tessellated item: one for each of its triangulated parts.
    pub(super) fn triangulated(&mut self, id: u64) -> Read<Vec<LooseFace>> {
        let record = self.record(id)?;
        let parts = if record.is(Kind::TessellatedSolid) || record.is(Kind::TessellatedShell) {
            record.fields(&[]).skip_many(1).references_leniently()?
        } else {
            vec![id]
        };
        let mut faces = Vec::with_capacity(parts.len());
        for part in parts {
            match self.triangulated_face(part) {
                Ok(face) => faces.push(face),
                Err(fault) => self.notes.skip(part, fault),
            }
        }
        Ok(faces)
    }

    fn triangulated_face(&mut self, id: u64) -> Read<LooseFace> {
        let record = self.record(id)?;
        let (linked, complex) = match record.kind {
            Kind::TriangulatedFace => (true, false),
            Kind::ComplexTriangulatedFace => (true, true),
            Kind::TriangulatedSurfaceSet => (false, false),
            Kind::ComplexTriangulatedSurfaceSet => (false, true),
            _ => return Err(record.fault("not a set of triangles that is known")),
        };
        let mut cursor = record.fields(&[]);
        let coordinates = self.coordinates(cursor.skip_many(1).reference()?)?;
        // The number of points, the normals and, for faces, the face that they approximate.
        cursor.skip_many(if linked { 3 } else { 2 });
        let used = indices(&mut cursor)?;
        let mut triangles = Vec::new();
        if complex {
            rows(&mut cursor, |strip| add_strip(strip, &mut triangles))?;
            rows(&mut cursor, |fan| add_fan(fan, &mut triangles))?;
        } else {
            rows(&mut cursor, |row| triangles.extend(row.first_chunk::<3>().copied()))?;
        }
        self.geometry.spend(id, triangles.len())?;
        let facets = facets(&record, &coordinates, &used, &triangles)?;
        Ok(LooseFace { entity: id, geometry: FaceGeometry::Faceted(Arc::new(facets)), loops: Loops::new() })
    }

    /// COORDINATES_LIST, in mm.
    fn coordinates(&mut self, id: u64) -> Read<Arc<[Point]>> {
        if let Some(known) = self.coordinates.get(&id) {
            return Ok(known.clone());
        }
        let record = self.record(id)?;
        if record.kind != Kind::CoordinatesList {
            return Err(record.fault("a list of coordinates was expected"));
        }
        let mut points = Vec::new();
        record.fields(&[]).skip_many(2).list(|row| {
            let values = row.reals()?;
            let [x, y, z] = values[..] else { return Err(Fault::new(id, "three coordinates were expected")) };
            points.push(self.geometry.in_reach(id, Vector::new(x, y, z))?);
            Ok(())
        })?;
        let points: Arc<[Point]> = points.into();
        self.coordinates.insert(id, points.clone());
        Ok(points)
    }
}

/// Indices that start at 1.
fn indices(cursor: &mut Cursor) -> Read<Vec<usize>> {
    let mut found = Vec::new();
    cursor.list(|c| {
        found.push(c.count(u32::MAX as usize)?);
        Ok(())
    })?;
    Ok(found)
}

/// Calls `use_row` with each list of indices in a list.
fn rows(cursor: &mut Cursor, mut use_row: impl FnMut(&[usize])) -> Read<()> {
    if !cursor.is_list() {
        cursor.skip();
        return Ok(());
    }
    cursor.list(|c| {
        use_row(&indices(c)?);
        Ok(())
    })
}

/// Every second triangle of a strip runs the other way round.
fn add_strip(strip: &[usize], triangles: &mut Vec<[usize; 3]>) {
    for (i, w) in strip.windows(3).enumerate() {
        triangles.push(if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] });
    }
}

fn add_fan(fan: &[usize], triangles: &mut Vec<[usize; 3]>) {
    let Some((hub, rim)) = fan.split_first() else { return };
    triangles.extend(rim.windows(2).map(|w| [*hub, w[0], w[1]]));
}

/// Only the points that triangles use; triangles without three different points are left out.
fn facets(record: &Record, coordinates: &[Point], used: &[usize], triangles: &[[usize; 3]]) -> Read<Facets> {
    let mut places: FxHashMap<usize, u32> = FxHashMap::default();
    let mut facets = Facets::default();
    for triangle in triangles {
        let mut corners = [0; 3];
        for (corner, &index) in corners.iter_mut().zip(triangle) {
            // An empty index list means that the triangles index the coordinates themselves.
            let point = if used.is_empty() { Some(index) } else { used.get(index.wrapping_sub(1)).copied() };
            let at = point.map(|p| p.wrapping_sub(1)).filter(|&p| p < coordinates.len());
            let at = at.ok_or_else(|| record.fault("a triangle with a point that is not there"))?;
            *corner = *places.entry(at).or_insert_with(|| {
                facets.points.push(coordinates[at]);
                facets.points.len() as u32 - 1
            });
        }
        if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
            facets.triangles.push(corners);
        }
    }
    if facets.triangles.is_empty() { Err(record.fault("no triangles")) } else { Ok(facets) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_turn_every_second_triangle() {
        let mut triangles = Vec::new();
        add_strip(&[1, 2, 3, 4], &mut triangles);
        assert_eq!(triangles, [[1, 2, 3], [3, 2, 4]]);
        triangles.clear();
        add_fan(&[1, 2, 3, 4], &mut triangles);
        assert_eq!(triangles, [[1, 2, 3], [1, 3, 4]]);
    }
}
