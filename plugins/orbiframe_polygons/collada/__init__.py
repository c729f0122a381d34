"""COLLADA: the meshes of a scene in XML."""
