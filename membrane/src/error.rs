//! What a mesh, a cell or a stretch cannot do.

/// Why a mesh or a cell cannot be built, or a stretch does not end; every message has the numbers and the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MembraneError {
    /// Some edges have one triangle only: the surface has a hole.
    #[error(
        "the mesh is open: {open_edges} edges lack a second triangle, the first between nodes {} and {}; a cell needs a closed surface, add the missing triangles", first[0], first[1]
    )]
    OpenMesh {
        /// Edges with one triangle.
        open_edges: usize,
        /// Nodes of the first of them.
        first: [u32; 2],
    },
    /// More than two triangles meet in an edge.
    #[error(
        "{triangles} triangles meet in the edge between nodes {} and {}, a closed surface has 2; remove the others", edge[0], edge[1]
    )]
    NotManifold {
        /// Nodes of the edge.
        edge: [u32; 2],
        /// Triangles at the edge.
        triangles: usize,
    },
    /// Two neighbours wind in opposite senses.
    #[error(
        "triangles {} and {} wind in opposite senses along the edge between nodes {} and {}; swap two nodes of one of them", triangles[0], triangles[1], edge[0], edge[1]
    )]
    MixedWinding {
        /// Nodes of the edge.
        edge: [u32; 2],
        /// The two triangles.
        triangles: [u32; 2],
    },
    /// All triangles wind inwards.
    #[error("the triangles wind inwards (volume {volume:.4e} m3); swap two nodes of every triangle")]
    Inward {
        /// Enclosed volume with the sign of the winding, m3.
        volume: f64,
    },
    /// A triangle has (almost) no area, or uses a node twice.
    #[error("triangle {triangle} is degenerate (area {area:.3e} m2, its longest edge {edge:.3e} m); merge its nodes")]
    DegenerateTriangle {
        /// Triangle number.
        triangle: usize,
        /// Its area, m2.
        area: f64,
        /// Its longest edge, m.
        edge: f64,
    },
    /// A triangle names a node that is not there.
    #[error("triangle {triangle} names node {node}, the mesh has {nodes}; node numbers start at 0")]
    NoSuchNode {
        /// Triangle number.
        triangle: usize,
        /// Node number.
        node: u32,
        /// Nodes of the mesh.
        nodes: usize,
    },
    /// A node belongs to no triangle.
    #[error("node {node} belongs to no triangle; remove it or add the triangles around it")]
    LooseNode {
        /// Node number.
        node: usize,
    },
    /// A node position is not finite.
    #[error("node {node} is not at a finite position; check the input")]
    NotFinite {
        /// Node number.
        node: usize,
    },
    /// A mesh file cannot be read.
    #[cfg(feature = "import")]
    #[error("{path} gives no mesh: {reason}")]
    Import {
        /// The file.
        path: String,
        /// What is wrong with it, and the remedy.
        reason: String,
    },
    /// A generator was asked for too few nodes.
    #[error("{nodes} nodes are too few for a {shape}, it needs at least {least}")]
    TooFewNodes {
        /// What was to be meshed.
        shape: &'static str,
        /// Nodes asked for.
        nodes: usize,
        /// Fewest nodes.
        least: usize,
    },
    /// A quantity that must be positive and finite is not.
    #[error("{what} is {value:.4e}, it must be positive and finite")]
    NotPositive {
        /// Which quantity.
        what: &'static str,
        /// Its value, SI.
        value: f64,
    },
    /// A quantity that must be finite is not.
    #[error("{what} is {value:.4e}, it must be finite")]
    NotFiniteValue {
        /// Which quantity.
        what: &'static str,
        /// Its value, SI.
        value: f64,
    },
    /// A quantity lies outside its range.
    #[error("{what} is {value:.4e}, it must lie between {low:.4e} and {high:.4e}")]
    OutOfRange {
        /// Which quantity.
        what: &'static str,
        /// Its value, SI.
        value: f64,
        /// Its lower bound, SI.
        low: f64,
        /// Its upper bound, SI.
        high: f64,
    },
    /// No biconcave profile has the asked diameter, volume, area and thickness.
    #[error(
        "no biconcave disc of diameter {diameter:.4e} m has volume {volume:.4e} m3, area {area:.4e} m2 and thickness {thickness:.4e} m (least relative error reached {error:.1e}); change one of them, a sphere of this volume has area {sphere_area:.4e} m2"
    )]
    NoSuchDisc {
        /// Diameter, m.
        diameter: f64,
        /// Volume, m3.
        volume: f64,
        /// Area, m2.
        area: f64,
        /// Greatest thickness, m.
        thickness: f64,
        /// Greatest relative error of the three where the search ended.
        error: f64,
        /// Area of a sphere of this volume, m2.
        sphere_area: f64,
    },
    /// A nucleus reaches out of its cell.
    #[error(
        "node {node} of the nucleus is {distance:.3e} m from the centre, the cell's membrane there {cell:.3e} m; make the nucleus smaller"
    )]
    NucleusOutside {
        /// Node of the nucleus.
        node: usize,
        /// Its distance from the common centre, m.
        distance: f64,
        /// Distance of the cell's node in its direction, m.
        cell: f64,
    },
    /// A patch at an end of the cell holds no node.
    #[error("no node lies in the patch at an end of the cell ({what}); widen the patch or use more nodes")]
    EmptyPatch {
        /// Which patch was asked for.
        what: String,
    },
    /// A curve has too few diameters for the moduli that are to be found.
    #[error(
        "{diameters} diameters cannot give {free} moduli{}; measure more, or free fewer", if *errors { "" } else { " and their own error" }
    )]
    TooFewData {
        /// Diameters measured.
        diameters: usize,
        /// Moduli to be found.
        free: usize,
        /// Whether the diameters have errors.
        errors: bool,
    },
    /// The equilibrium search has not come to rest.
    #[error(
        "no equilibrium under {force:.3e} N after {iterations} iterations: the greatest force left on a node is {residual:.3e} N, asked was {tolerance:.3e} N; allow more iterations, a larger tolerance, or reach the force in smaller steps"
    )]
    NoEquilibrium {
        /// End force, N.
        force: f64,
        /// Greatest force left on a node, N.
        residual: f64,
        /// Greatest force allowed, N.
        tolerance: f64,
        /// Iterations done.
        iterations: usize,
    },
}
