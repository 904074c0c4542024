"""Run time against error, and growth with work, of the techniques of the course: `course bench`."""

# What `course bench NAME` measures: a module of that name in this package, see `harness`.
TECHNIQUES = {
    "steppers": "how far a ray steps and when it stops: plain, over-relaxed, auto-relaxed; constant and cone widths",
    "shadows": "visibility of a round light from one march: ratio, arcsin, Aaltonen, signed",
    "prefilter": "GGX-filtered maps: importance sampling against the exact filter",
    "lut": "table of the split sum: samples of the distribution, visible normals, quadrature; and by its size",
    "split_sum": "the split sum against Monte Carlo with visible normals",
    "grid": "meshes sampled into grids of distances: built whole, or brought up to date after a move",
    "shadow_maps": "soft shadows by maps (one look-up, PCF, PCSS) and by distance fields, with and without their build",
    "raster": "the rasteriser against OpenGL on the same processor",
    "growth": "how run time grows with pixels, primitives, triangles and the size of the map",
}
