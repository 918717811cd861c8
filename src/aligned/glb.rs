//! Binary glTF 2.0: a node with a mesh for each placed body, metres.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::parts::{Part, parts, single};
use crate::geometry::Isometry;
use crate::stages::parse::Parsed;

/// mm in the unit of glTF.
const METRE: f64 = 1000.0;
/// Codes of glTF.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// Bytes of a point or normal, and of a triangle.
const TRIPLE: usize = 12;

/// Writes the model after a motion: x, y and z are those of the frame, in metres. (glTF calls y "up"; a frame has no
/// up, so nothing is turned.)
///
/// # Errors
/// More bytes than the format can count (4 GiB), or an output that takes no more.
pub fn glb(parsed: &Parsed, by: &Isometry, out: &mut dyn Write) -> io::Result<()> {
    let parts: Vec<_> = parts(parsed, by).into_iter().filter(|part| !part.triangles.is_empty()).collect();
    let binary = binary(&parts);
    let mut text = document(&parts, binary.len()).to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = u32::try_from(12 + 8 + text.len() + 8 + binary.len()).map_err(io::Error::other)?;
    out.write_all(b"glTF")?;
    out.write_all(&2_u32.to_le_bytes())?;
    out.write_all(&total.to_le_bytes())?;
    chunk(*b"JSON", &text, out)?;
    chunk(*b"BIN\0", &binary, out)
}

fn chunk(kind: [u8; 4], bytes: &[u8], out: &mut dyn Write) -> io::Result<()> {
    // The whole is less than 4 GiB.
    out.write_all(&(bytes.len() as u32).to_le_bytes())?;
    out.write_all(&kind)?;
    out.write_all(bytes)
}

/// All points, then all normals, then all triangles, part by part.
fn binary(parts: &[Part]) -> Vec<u8> {
    let points = parts.iter().flat_map(|part| part.points.iter().map(|p| single(&p.coords, METRE)));
    let normals = parts.iter().flat_map(|part| part.normals.iter().map(|n| single(&upright(n), 1.0)));
    let triangles = parts.iter().flat_map(|part| part.triangles.iter().flatten());
    let floats = points.chain(normals).flatten().flat_map(f32::to_le_bytes);
    floats.chain(triangles.flat_map(|i| i.to_le_bytes())).collect()
}

/// glTF wants normals of length 1, also of points in no triangle that has an area.
fn upright(normal: &crate::geometry::Vector) -> crate::geometry::Vector {
    if normal.norm_squared() > 0.5 { *normal } else { crate::geometry::Vector::z() }
}

/// The JSON that tells what the bytes are.
fn document(parts: &[Part], bytes: usize) -> Value {
    let points: usize = parts.iter().map(|part| part.points.len()).sum();
    let length = TRIPLE * points;
    let nodes: Vec<_> = parts.iter().enumerate().map(|(i, part)| json!({"name": part.name, "mesh": i})).collect();
    let mesh = |(i, part): (usize, &Part)| {
        let attributes = json!({"POSITION": 3 * i, "NORMAL": 3 * i + 1});
        json!({"name": part.name, "primitives": [{"attributes": attributes, "indices": 3 * i + 2, "material": 0}]})
    };
    json!({
        "asset": {"version": "2.0", "generator": concat!("symalign ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": (0..parts.len()).collect::<Vec<_>>()}],
        "nodes": nodes,
        "meshes": parts.iter().enumerate().map(mesh).collect::<Vec<_>>(),
        "materials": [{
            "pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.72, 0.75, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.6},
            "doubleSided": true,
        }],
        "accessors": accessors(parts),
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": length, "target": ARRAY_BUFFER},
            {"buffer": 0, "byteOffset": length, "byteLength": length, "target": ARRAY_BUFFER},
            {"buffer": 0, "byteOffset": 2 * length, "byteLength": bytes - 2 * length, "target": ELEMENT_ARRAY_BUFFER},
        ],
        "buffers": [{"byteLength": bytes}],
    })
}

/// Of each part its points, normals and triangles.
fn accessors(parts: &[Part]) -> Vec<Value> {
    let (mut point, mut triangle) = (0, 0);
    let mut accessors = Vec::with_capacity(3 * parts.len());
    for part in parts {
        let (count, offset) = (part.points.len(), TRIPLE * point);
        let (low, high) = extent(part);
        accessors.push(json!({"bufferView": 0, "byteOffset": offset, "componentType": FLOAT, "count": count,
            "type": "VEC3", "min": low, "max": high}));
        accessors.push(json!({"bufferView": 1, "byteOffset": offset, "componentType": FLOAT, "count": count,
            "type": "VEC3"}));
        accessors.push(json!({"bufferView": 2, "byteOffset": TRIPLE * triangle, "componentType": UNSIGNED_INT,
            "count": 3 * part.triangles.len(), "type": "SCALAR"}));
        (point, triangle) = (point + count, triangle + part.triangles.len());
    }
    accessors
}

/// The least and the greatest coordinates, as the file holds them.
fn extent(part: &Part) -> ([f32; 3], [f32; 3]) {
    let points = part.points.iter().map(|p| single(&p.coords, METRE));
    points.fold(([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), |(low, high), p| {
        ([0, 1, 2].map(|i| low[i].min(p[i])), [0, 1, 2].map(|i| high[i].max(p[i])))
    })
}
