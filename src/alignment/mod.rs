//! The frames we compare with. Each is a function from a mesh to a [`Frame`](crate::geometry::Frame); raster,
//! descriptor and distance are the same for all.

/// A way to find a model's canonical frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// The dominant mirror symmetry, then the smallest projected area: the paper's method.
    Symmetry,
    /// Principal components of the vertices.
    Pca,
    /// Continuous principal components of the surface (Vranic).
    Cpca,
    /// Principal components of the surface normals.
    Npca,
    /// The file's own axes, carried along by `--random-pose`: the frame an author chose.
    File,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 5] = [Self::Symmetry, Self::Pca, Self::Cpca, Self::Npca, Self::File];

    /// The name in settings, stores and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Symmetry => "symmetry",
            Self::Pca => "pca",
            Self::Cpca => "cpca",
            Self::Npca => "npca",
            Self::File => "file",
        }
    }
}
