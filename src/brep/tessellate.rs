//! B-rep -> triangles: edges first, so that both faces of an edge share its points, then each face in its
//! parameter space.
