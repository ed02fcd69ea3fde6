//! Meshes by gmsh.

mod vtk_grid;
mod window_meshes;
