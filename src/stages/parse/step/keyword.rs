//! The entity types that the B-rep asks for; all others are [`Kind::Other`] and never decoded.

macro_rules! kinds {
    ($($name:ident $word:literal)*) => {
        /// Type of an instance, or of one part of a complex instance.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub(super) enum Kind {
            $($name,)*
            /// A complex instance: several parts in parentheses.
            Complex,
            /// A type that no B-rep needs.
            Other,
        }

        const ALL: &[Kind] = &[$(Kind::$name,)* Kind::Complex, Kind::Other];
        const WORDS: &[&[u8]] = &[$($word,)*];

        impl Kind {
            /// The kind of an upper-case keyword.
            pub fn of(word: &[u8]) -> Self {
                let mut at = slot(word);
                while let Some(known) = WORDS.get(usize::from(TABLE[at])) {
                    if *known == word {
                        return ALL[usize::from(TABLE[at])];
                    }
                    at = (at + 1) % SLOTS;
                }
                Self::Other
            }

            /// The kind with a code that [`Kind::code`] gave.
            pub fn from_code(code: u8) -> Self {
                ALL.get(usize::from(code)).copied().unwrap_or(Self::Other)
            }

            /// A small number for compact tables.
            pub fn code(self) -> u8 {
                self as u8
            }
        }
    };
}

/// Places of [`TABLE`], some four for each word.
const SLOTS: usize = 512;

/// The word at each place by its number, 255 where there is none; words of one place stand behind each other.
const TABLE: [u8; SLOTS] = {
    let mut table = [u8::MAX; SLOTS];
    let mut word = 0;
    while word < WORDS.len() {
        let mut at = slot(WORDS[word]);
        while table[at] != u8::MAX {
            at = (at + 1) % SLOTS;
        }
        table[at] = word as u8;
        word += 1;
    }
    table
};

/// Where a word stands, by its length and four of its letters.
const fn slot(word: &[u8]) -> usize {
    let n = word.len();
    if n == 0 {
        return 0;
    }
    let letters = [word[0], word[n / 3], word[2 * n / 3], word[n - 1]];
    (n + 5 * letters[0] as usize + 23 * letters[1] as usize + 91 * letters[2] as usize + 307 * letters[3] as usize)
        % SLOTS
}

kinds! {
    CartesianPoint b"CARTESIAN_POINT"
    Direction b"DIRECTION"
    Vector b"VECTOR"
    Axis1 b"AXIS1_PLACEMENT"
    Axis2 b"AXIS2_PLACEMENT_3D"
    Placement b"PLACEMENT"
    TransformationOperator b"CARTESIAN_TRANSFORMATION_OPERATOR"
    TransformationOperator3d b"CARTESIAN_TRANSFORMATION_OPERATOR_3D"
    Line b"LINE"
    Circle b"CIRCLE"
    Ellipse b"ELLIPSE"
    Parabola b"PARABOLA"
    Hyperbola b"HYPERBOLA"
    Conic b"CONIC"
    BSplineCurve b"B_SPLINE_CURVE"
    BSplineCurveWithKnots b"B_SPLINE_CURVE_WITH_KNOTS"
    RationalBSplineCurve b"RATIONAL_B_SPLINE_CURVE"
    QuasiUniformCurve b"QUASI_UNIFORM_CURVE"
    UniformCurve b"UNIFORM_CURVE"
    BezierCurve b"BEZIER_CURVE"
    Polyline b"POLYLINE"
    TrimmedCurve b"TRIMMED_CURVE"
    CompositeCurve b"COMPOSITE_CURVE"
    CompositeCurveOnSurface b"COMPOSITE_CURVE_ON_SURFACE"
    BoundaryCurve b"BOUNDARY_CURVE"
    OuterBoundaryCurve b"OUTER_BOUNDARY_CURVE"
    CompositeCurveSegment b"COMPOSITE_CURVE_SEGMENT"
    ReparametrisedSegment b"REPARAMETRISED_COMPOSITE_CURVE_SEGMENT"
    SurfaceCurve b"SURFACE_CURVE"
    SeamCurve b"SEAM_CURVE"
    IntersectionCurve b"INTERSECTION_CURVE"
    BoundedSurfaceCurve b"BOUNDED_SURFACE_CURVE"
    OffsetCurve3d b"OFFSET_CURVE_3D"
    CurveReplica b"CURVE_REPLICA"
    Plane b"PLANE"
    CylindricalSurface b"CYLINDRICAL_SURFACE"
    ConicalSurface b"CONICAL_SURFACE"
    SphericalSurface b"SPHERICAL_SURFACE"
    ToroidalSurface b"TOROIDAL_SURFACE"
    DegenerateToroidalSurface b"DEGENERATE_TOROIDAL_SURFACE"
    ElementarySurface b"ELEMENTARY_SURFACE"
    SweptSurface b"SWEPT_SURFACE"
    BSplineSurface b"B_SPLINE_SURFACE"
    BSplineSurfaceWithKnots b"B_SPLINE_SURFACE_WITH_KNOTS"
    RationalBSplineSurface b"RATIONAL_B_SPLINE_SURFACE"
    QuasiUniformSurface b"QUASI_UNIFORM_SURFACE"
    UniformSurface b"UNIFORM_SURFACE"
    BezierSurface b"BEZIER_SURFACE"
    SurfaceOfRevolution b"SURFACE_OF_REVOLUTION"
    SurfaceOfLinearExtrusion b"SURFACE_OF_LINEAR_EXTRUSION"
    OffsetSurface b"OFFSET_SURFACE"
    RectangularTrimmedSurface b"RECTANGULAR_TRIMMED_SURFACE"
    CurveBoundedSurface b"CURVE_BOUNDED_SURFACE"
    SurfaceReplica b"SURFACE_REPLICA"
    VertexPoint b"VERTEX_POINT"
    Edge b"EDGE"
    EdgeCurve b"EDGE_CURVE"
    OrientedEdge b"ORIENTED_EDGE"
    Subedge b"SUBEDGE"
    EdgeLoop b"EDGE_LOOP"
    VertexLoop b"VERTEX_LOOP"
    PolyLoop b"POLY_LOOP"
    FaceBound b"FACE_BOUND"
    FaceOuterBound b"FACE_OUTER_BOUND"
    Face b"FACE"
    FaceSurface b"FACE_SURFACE"
    AdvancedFace b"ADVANCED_FACE"
    OrientedFace b"ORIENTED_FACE"
    Subface b"SUBFACE"
    ConnectedFaceSet b"CONNECTED_FACE_SET"
    ConnectedFaceSubSet b"CONNECTED_FACE_SUB_SET"
    OpenShell b"OPEN_SHELL"
    ClosedShell b"CLOSED_SHELL"
    OrientedOpenShell b"ORIENTED_OPEN_SHELL"
    OrientedClosedShell b"ORIENTED_CLOSED_SHELL"
    ManifoldSolidBrep b"MANIFOLD_SOLID_BREP"
    BrepWithVoids b"BREP_WITH_VOIDS"
    FacetedBrep b"FACETED_BREP"
    ShellBasedSurfaceModel b"SHELL_BASED_SURFACE_MODEL"
    FaceBasedSurfaceModel b"FACE_BASED_SURFACE_MODEL"
    GeometricSet b"GEOMETRIC_SET"
    GeometricCurveSet b"GEOMETRIC_CURVE_SET"
    TessellatedSolid b"TESSELLATED_SOLID"
    TessellatedShell b"TESSELLATED_SHELL"
    TriangulatedFace b"TRIANGULATED_FACE"
    ComplexTriangulatedFace b"COMPLEX_TRIANGULATED_FACE"
    TriangulatedSurfaceSet b"TRIANGULATED_SURFACE_SET"
    ComplexTriangulatedSurfaceSet b"COMPLEX_TRIANGULATED_SURFACE_SET"
    CoordinatesList b"COORDINATES_LIST"
    RepresentationItem b"REPRESENTATION_ITEM"
    MappedItem b"MAPPED_ITEM"
    RepresentationMap b"REPRESENTATION_MAP"
    Representation b"REPRESENTATION"
    ShapeRepresentation b"SHAPE_REPRESENTATION"
    AdvancedBrepRepresentation b"ADVANCED_BREP_SHAPE_REPRESENTATION"
    FacetedBrepRepresentation b"FACETED_BREP_SHAPE_REPRESENTATION"
    ManifoldSurfaceRepresentation b"MANIFOLD_SURFACE_SHAPE_REPRESENTATION"
    NonManifoldSurfaceRepresentation b"NON_MANIFOLD_SURFACE_SHAPE_REPRESENTATION"
    BoundedSurfaceRepresentation b"GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION"
    BoundedWireframeRepresentation b"GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION"
    TessellatedRepresentation b"TESSELLATED_SHAPE_REPRESENTATION"
    AccurateTessellatedRepresentation b"TESSELLATED_SHAPE_REPRESENTATION_WITH_ACCURACY_PARAMETERS"
    RepresentationRelationship b"REPRESENTATION_RELATIONSHIP"
    ShapeRepresentationRelationship b"SHAPE_REPRESENTATION_RELATIONSHIP"
    RelationshipWithTransformation b"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION"
    ItemDefinedTransformation b"ITEM_DEFINED_TRANSFORMATION"
    ContextDependentRepresentation b"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"
    ShapeDefinitionRepresentation b"SHAPE_DEFINITION_REPRESENTATION"
    ProductDefinitionShape b"PRODUCT_DEFINITION_SHAPE"
    ProductDefinition b"PRODUCT_DEFINITION"
    ProductDefinitionWithDocuments b"PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS"
    NextAssemblyUsage b"NEXT_ASSEMBLY_USAGE_OCCURRENCE"
    GlobalUnitAssignedContext b"GLOBAL_UNIT_ASSIGNED_CONTEXT"
    NamedUnit b"NAMED_UNIT"
    SiUnit b"SI_UNIT"
    LengthUnit b"LENGTH_UNIT"
    PlaneAngleUnit b"PLANE_ANGLE_UNIT"
    ConversionBasedUnit b"CONVERSION_BASED_UNIT"
    MeasureWithUnit b"MEASURE_WITH_UNIT"
    LengthMeasureWithUnit b"LENGTH_MEASURE_WITH_UNIT"
    PlaneAngleMeasureWithUnit b"PLANE_ANGLE_MEASURE_WITH_UNIT"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_give_the_kind_back() {
        for word in [b"CARTESIAN_POINT".as_slice(), b"PLANE_ANGLE_MEASURE_WITH_UNIT", b"NO_SUCH_TYPE"] {
            let kind = Kind::of(word);
            assert_eq!(Kind::from_code(kind.code()), kind);
        }
        assert_eq!(Kind::from_code(255), Kind::Other);
    }
}
