//! What is in the picture: meshes, materials, lights, cameras, and the scenes that Bilux ships.
