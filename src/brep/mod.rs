//! Boundary representations: a leaf that knows geometry only.
//!
//! A [`Model`] holds each body once, in the coordinates of its own part, and says by [`Occurrence`]s where the
//! bodies lie. A [`Mesh`] holds the tessellated faces of all occurrences in place. All lengths are mm.

pub mod curve;
pub mod measure;
pub mod mesh;
pub mod nurbs;
mod project;
pub mod sample;
pub mod simplify;
mod starts;
pub mod surface;
pub mod tessellate;
pub mod topology;
mod wireframe;

use std::sync::Arc;

use smallvec::SmallVec;

use crate::geometry::{Isometry, Point, Transform, Vector};
pub use curve::Curve;
pub use mesh::{Mesh, MeshFace, PlacedFaceId};
pub use surface::Surface;
pub use wireframe::{Side, Wireframe};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// Position in the arena.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(/// Index into [`Model::vertices`].
    VertexId);
id!(/// Index into [`Model::edges`].
    EdgeId);
id!(/// Index into [`Model::surfaces`].
    SurfaceId);
id!(/// Index into [`Model::faces`].
    FaceId);
id!(/// Index into [`Model::bodies`].
    BodyId);

/// A right-handed placement: an origin and three orthonormal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Where local (0, 0, 0) lies, mm.
    pub origin: Point,
    /// The first axis, unit.
    pub x: Vector,
    /// The second axis, unit.
    pub y: Vector,
    /// The third axis, unit.
    pub z: Vector,
}

impl Placement {
    /// The placement as a map from local to outer coordinates.
    pub fn transform(&self) -> Transform {
        Transform::from_axes(&self.origin, &self.x, &self.y, &self.z)
    }

    /// Local coordinates (x, y, z) of `p`.
    pub fn local(&self, p: &Point) -> Vector {
        let d = p - self.origin;
        Vector::new(d.dot(&self.x), d.dot(&self.y), d.dot(&self.z))
    }

    /// The point at local coordinates (x, y, z).
    pub fn point(&self, x: f64, y: f64, z: f64) -> Point {
        self.origin + self.x * x + self.y * y + self.z * z
    }
}

/// A vertex of the B-rep.
#[derive(Clone, Debug)]
pub struct Vertex {
    /// Number of the entity in the file.
    pub entity: u64,
    /// Where it lies in its part, mm.
    pub point: Point,
}

/// A bounded piece of a curve from `start` to `end`; `start == end` for closed edges.
#[derive(Clone, Debug)]
pub struct Edge {
    /// Number of the entity in the file.
    pub entity: u64,
    /// `None`: the straight segment between the vertices, of which a line would tell no more.
    pub curve: Option<Arc<Curve>>,
    /// Where it starts.
    pub start: VertexId,
    /// Where it ends.
    pub end: VertexId,
    /// Whether the edge runs from start to end in the direction of growing curve parameter.
    pub same_sense: bool,
}

/// An edge as one loop uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeUse {
    /// The edge.
    pub edge: EdgeId,
    /// Whether the loop runs along the edge from its start to its end.
    pub forward: bool,
}

/// The edges of a loop: for most no more than can be kept in place.
pub type Uses = SmallVec<[EdgeUse; 4]>;

/// The loops of a face: one for most.
pub type Loops = SmallVec<[FaceLoop; 1]>;

/// A closed chain of edges, or a single vertex (VERTEX_LOOP: the pole of a sphere, the apex of a cone).
///
/// Loops are given as the face bound orients them: along the loop, with the face normal up, the face's inside is
/// on the left. Files break this rule; who needs it must check.
#[derive(Clone, Debug)]
pub struct FaceLoop {
    /// Number of the entity in the file.
    pub entity: u64,
    /// The edges in order, each starting where the one before ends.
    pub uses: Uses,
    /// The vertex of a vertex loop (then `uses` is empty).
    pub pole: Option<VertexId>,
    /// Whether the file calls this loop the outer one (FACE_OUTER_BOUND); often it does not say.
    pub outer: bool,
}

/// What a face is made of.
#[derive(Clone, Debug)]
pub enum FaceGeometry {
    /// A surface trimmed by loops; `same_sense`: the face normal is the surface normal S_u x S_v, else opposite to it.
    Trimmed {
        /// What is trimmed.
        surface: SurfaceId,
        /// Whether the face has the surface's normal.
        same_sense: bool,
    },
    /// Triangles given by the file itself (AP242 tessellated geometry).
    Faceted(Arc<Facets>),
}

/// A triangle set; triangles run counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub struct Facets {
    /// mm.
    pub points: Vec<Point>,
    /// Corners, as indices of points.
    pub triangles: Vec<[u32; 3]>,
}

/// A face of the B-rep.
#[derive(Clone, Debug)]
pub struct Face {
    /// Number of the entity in the file.
    pub entity: u64,
    /// What it is made of.
    pub geometry: FaceGeometry,
    /// Empty: the whole surface (a sphere or torus without bounds).
    pub loops: Loops,
    /// Position in [`Model::shells`].
    pub shell: u32,
}

/// A connected set of faces of one body.
#[derive(Clone, Debug)]
pub struct Shell {
    /// Number of the entity in the file.
    pub entity: u64,
    /// Whether the file says that the shell is closed.
    pub closed: bool,
    /// Its faces.
    pub faces: Vec<FaceId>,
}

/// A solid (its first shell is the outer one, others are voids) or a sheet body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Number of the entity in the file.
    pub entity: u64,
    /// Whether the file says that it encloses a volume.
    pub solid: bool,
    /// Positions in [`Model::shells`].
    pub shells: Vec<u32>,
}

/// A body placed in the model.
#[derive(Clone, Debug)]
pub struct Occurrence {
    /// Name that tells occurrences of one body apart: the entity numbers of the assembly path, joined by `.`;
    /// empty for a body that is not part of an assembly.
    pub path: String,
    /// The body that is placed.
    pub body: BodyId,
    /// From the coordinates of the part to those of the model.
    pub placement: Transform,
}

/// A bounded curve (or, as a polyline of one point, a point) that is the edge of no face.
#[derive(Clone, Debug)]
pub struct FreeCurve {
    /// Number of the entity in the file.
    pub entity: u64,
    /// The curve, in the coordinates of its part.
    pub curve: Arc<Curve>,
    /// From the coordinates of the part to those of the model.
    pub placement: Transform,
}

/// Something that was left out while reading, with the reason.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Skipped {
    /// Number of the entity in the file.
    pub entity: u64,
    /// The reason, for people.
    pub why: String,
}

/// A CAD model: bodies, and where they lie.
#[derive(Clone, Debug)]
pub struct Model {
    /// First schema name of a STEP file's header, empty if there is none; for other formats their name and version.
    pub schema: String,
    /// Millimetres in one length unit of the (first) representation.
    pub unit_mm: f64,
    /// All vertices, see [`VertexId`].
    pub vertices: Vec<Vertex>,
    /// All edges, see [`EdgeId`].
    pub edges: Vec<Edge>,
    /// What faces are trimmed of, see [`SurfaceId`]: several may share one, and some may have none.
    pub surfaces: Vec<Surface>,
    /// All faces, see [`FaceId`].
    pub faces: Vec<Face>,
    /// All shells, body by body.
    pub shells: Vec<Shell>,
    /// All bodies, see [`BodyId`].
    pub bodies: Vec<Body>,
    /// Where the bodies lie.
    pub occurrences: Vec<Occurrence>,
    /// Curves beside the faces: they count for the bounding box and nothing else.
    pub free_curves: Vec<FreeCurve>,
}

impl Model {
    /// An empty model in mm.
    pub fn empty() -> Self {
        Self {
            schema: String::new(),
            unit_mm: 1.0,
            vertices: Vec::new(),
            edges: Vec::new(),
            surfaces: Vec::new(),
            faces: Vec::new(),
            shells: Vec::new(),
            bodies: Vec::new(),
            occurrences: Vec::new(),
            free_curves: Vec::new(),
        }
    }

    /// The model after a rigid motion: only the placements change.
    pub fn moved(mut self, by: &Isometry) -> Self {
        let of_bodies = self.occurrences.iter_mut().map(|o| &mut o.placement);
        for placement in of_bodies.chain(self.free_curves.iter_mut().map(|c| &mut c.placement)) {
            *placement = by.as_transform().after(placement);
        }
        self
    }

    /// Adds a surface.
    pub fn add_surface(&mut self, surface: Surface) -> SurfaceId {
        self.surfaces.push(surface);
        SurfaceId(self.surfaces.len() as u32 - 1)
    }

    /// The surface that a face is trimmed of, and whether the face has its normal; `None` for triangles.
    pub fn surface_of(&self, face: &Face) -> Option<(&Surface, bool)> {
        match face.geometry {
            FaceGeometry::Trimmed { surface, same_sense } => Some((&self.surfaces[surface.index()], same_sense)),
            FaceGeometry::Faceted(_) => None,
        }
    }

    /// The faces of a body, shell by shell.
    pub fn faces_of(&self, body: BodyId) -> impl Iterator<Item = FaceId> + '_ {
        let shells = self.bodies[body.index()].shells.iter();
        shells.flat_map(|&s| self.shells[s as usize].faces.iter().copied())
    }
}
