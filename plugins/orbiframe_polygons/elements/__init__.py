"""Elements: readers of the meshes of finite element programs, whose nodes have numbers of their own."""
