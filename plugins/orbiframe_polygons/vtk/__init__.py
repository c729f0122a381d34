"""VTK: the legacy text and binary files (.vtk) and the XML files of surfaces and cells (.vtp, .vtu)."""
