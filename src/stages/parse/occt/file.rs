//! All sections of a file, in the order in which OCCT writes them.

use memchr::memmem;

use super::locations::Locations;
use super::shapes::Shapes;
use super::text::{Found, Lost, Words, cancelled};
use super::{curves, surfaces, triangulations};
use crate::cancel::Cancel;

/// What comes before the number of the version.
const TITLE: &[u8] = b"CASCADE Topology V";
/// The title stands within so many bytes of the start.
const TITLE_WITHIN: usize = 4096;

/// The tables of a file; their entries are numbered from 1.
pub(super) struct File {
    pub version: u32,
    pub bytes: usize,
    pub locations: Locations,
    pub parameter_curves: Vec<curves::Made>,
    pub curves: Vec<curves::Made>,
    pub surfaces: Vec<surfaces::Made>,
    pub triangulations: Vec<triangulations::Made>,
    pub shapes: Shapes,
}

/// Where the title is; `None`: this is no such file.
pub(super) fn title(bytes: &[u8]) -> Option<usize> {
    let start = &bytes[..bytes.len().min(TITLE_WITHIN)];
    memmem::find(start, TITLE).filter(|&at| at == 0 || matches!(start[at - 1], b'\n' | b'\r'))
}

/// Reads all tables of a file whose title is at `title`.
pub(super) fn tables(bytes: &[u8], title: usize, cancel: &Cancel) -> Found<File> {
    let version = bytes.get(title + TITLE.len()).copied().unwrap_or_default();
    if !(b'1'..=b'3').contains(&version) {
        return Err(Lost("a version that is not known".into()));
    }
    let version = u32::from(version - b'0');
    let line = memchr::memchr2(b'\n', b'\r', &bytes[title..]).map_or(bytes.len(), |n| title + n);
    let mut words = Words::new(&bytes[line..]);
    words.expect("Locations")?;
    let locations =
        Locations::read(&mut words, cancel).map_err(|Lost(why)| Lost(format!("Locations: {why}").into()))?;
    let mut table = Tables { words, cancel };
    let parameter_curves = table.of("Curve2ds", |w| curves::curve(w, curves::Space::Plane))?;
    let curves = table.of("Curves", |w| curves::curve(w, curves::Space::Space))?;
    table.of("Polygon3D", triangulations::polygon)?;
    table.of("PolygonOnTriangulations", triangulations::polygon_on_triangulation)?;
    let surfaces = table.of("Surfaces", surfaces::surface)?;
    let triangulations = table.of("Triangulations", |w| triangulations::triangulation(w, version))?;
    let mut words = table.words;
    words.expect("TShapes")?;
    let shapes = Shapes::read(&mut words, version, cancel)?;
    Ok(File { version, bytes: bytes.len(), locations, parameter_curves, curves, surfaces, triangulations, shapes })
}

struct Tables<'a> {
    words: Words<'a>,
    cancel: &'a Cancel,
}

impl<'a> Tables<'a> {
    /// The entries of one section; a reason says which of them it is about.
    fn of<T>(&mut self, section: &str, read: impl Fn(&mut Words<'a>) -> Found<T>) -> Found<Vec<T>> {
        self.words.expect(section)?;
        let count = self.words.count()?;
        let mut entries = Vec::new();
        for number in 1..=count {
            cancelled(self.cancel)?;
            let entry = read(&mut self.words);
            entries.push(entry.map_err(|Lost(why)| Lost(format!("{section} {number} of {count}: {why}").into()))?);
        }
        Ok(entries)
    }
}
