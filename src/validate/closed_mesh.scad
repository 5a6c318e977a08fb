// Import alone accepts an open mesh; a difference with a cube forces the mesh into an exact polyhedron, which
// only a closed one becomes. The cube lies beside the mesh, so the result must be the mesh itself.
difference() {
    translate([-(@CX@), -(@CY@), -(@CZ@)]) import("@MESH@");
    translate([@X@, @Y@, @Z@]) cube(@SIZE@);
}
