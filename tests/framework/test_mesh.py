import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework import mesh as shapes

CLOSED = {
    "sphere": lambda: shapes.sphere(1.5, (1, 2, 3), rings=9, segments=12),
    "smallest sphere": lambda: shapes.sphere(rings=2, segments=3),
    "bumpy sphere": lambda: shapes.bumpy_sphere(5000),
    "shading ball": shapes.shading_ball,
    "torus": lambda: shapes.torus(2.0, 0.5, rings=11, segments=7),
    "box": lambda: shapes.box((1, 2, 3), (4, 5, 6)),
}
TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def volume(mesh):
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return np.einsum("ni,ni->", a, np.cross(b, c)) / 6


def face_normals(mesh):
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return fw.normalize(np.cross(b - a, c - a))


@pytest.mark.parametrize("name", CLOSED)
def test_every_edge_of_a_closed_shape_is_shared_by_two_faces_that_run_along_it_in_opposite_directions(name):
    faces = CLOSED[name]().faces
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert_array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0))


@pytest.mark.parametrize("name", CLOSED)
def test_no_two_vertices_of_a_closed_shape_coincide_and_none_is_unused(name):
    mesh = CLOSED[name]()
    assert len(np.unique(mesh.vertices.round(9), axis=0)) == len(mesh.vertices)
    assert_array_equal(np.unique(mesh.faces), np.arange(len(mesh.vertices)))


def test_volumes_are_positive_and_tend_to_the_exact_ones():
    assert_allclose(volume(shapes.box((1, 2, 3), (4, 5, 6))), 8 * 6, rtol=1e-12)
    # Inscribed polyhedra: the defect falls with the square of the angle, (pi / 200)^2 times about 1.
    assert_allclose(volume(shapes.sphere(1.5, (1, 2, 3), 200, 400)), 4 / 3 * np.pi * 1.5**3, rtol=1e-3)
    assert_allclose(volume(shapes.torus(2, 0.5, 300, 200)), 2 * np.pi**2 * 2 * 0.5**2, rtol=1e-3)
    assert volume(shapes.bumpy_sphere(5000)) > 4
    assert volume(shapes.shading_ball()) > 4 / 3 * np.pi


@pytest.mark.parametrize("name", ["sphere", "bumpy sphere", "shading ball", "torus"])
def test_vertex_normals_are_unit_and_on_the_side_of_the_faces(name):
    mesh = CLOSED[name]()
    assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-12)
    at_corners = mesh.normals[mesh.faces]
    assert (np.einsum("nki,ni->nk", at_corners, face_normals(mesh)) > 0.6).all()


def test_edges_of_bumps_are_at_right_angles_to_their_ends_normals_up_to_the_square_of_their_length():
    def error(triangles):
        mesh = shapes.bumpy_sphere(triangles)
        start, end = mesh.faces[:, 0], mesh.faces[:, 1]
        edge = fw.normalize(mesh.vertices[end] - mesh.vertices[start])
        return np.median(np.abs(np.einsum("ni,ni->n", edge, mesh.normals[start] + mesh.normals[end])))

    assert_allclose(error(50_000) / error(200_000), 4, rtol=0.1)


@pytest.mark.parametrize("triangles", [1000, 66_000, 123_456])
def test_a_bumpy_sphere_has_about_as_many_triangles_as_asked(triangles):
    assert abs(len(shapes.bumpy_sphere(triangles).faces) / triangles - 1) < 0.02


def test_a_plane_faces_up_and_maps_uv_over_its_square():
    mesh = shapes.plane(4.0, (1, 2, 3), segments=3)
    assert mesh.faces.shape == (18, 3)
    assert_allclose(face_normals(mesh), np.tile([0.0, 1.0, 0.0], (18, 1)))
    assert_allclose(mesh.vertices, np.c_[4 * mesh.uv[:, 0] - 1, np.full(16, 2.0), 5 - 4 * mesh.uv[:, 1]])


def test_a_mesh_converts_its_arrays_and_leaves_the_callers_alone():
    vertices, faces = np.array(TRIANGLE, np.float32), np.array([[0, 1, 2]], np.uint8)
    mesh = fw.Mesh(vertices, faces)
    assert mesh.vertices.dtype == float and mesh.faces.dtype == np.int32 and mesh.normals is None
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0] = 1
    own = np.array(TRIANGLE, float)
    fw.Mesh(own, faces)
    own[0] = 7


@pytest.mark.parametrize(
    "arguments, message",
    [
        ((np.zeros((3, 2)), [[0, 1, 2]]), r"vertices has shape \(3, 2\)"),
        ((TRIANGLE, [0, 1, 2]), r"faces has shape \(3,\)"),
        ((TRIANGLE, [[0.0, 1.0, 2.0]]), "faces has dtype float64"),
        ((TRIANGLE, [[0, 1, 3]]), "from 0 to 3; with 3 vertices, 0 to 2"),
        ((TRIANGLE, [[0, 1, -1]]), "from -1 to 1"),
        (([], [[0, 1, 2]]), "with 0 vertices"),
        (
            ([[0, 0, 0], [1, np.nan, 0], [0, np.inf, 0]], [[0, 1, 2]]),
            "2 vertices are not finite, the first in row 1",
        ),
        ((np.full((3, 3), "a"), [[0, 1, 2]]), "vertices has dtype <U1"),
        ((TRIANGLE, [[0, 1, 2]], np.ones((2, 3))), r"normals has shape \(2, 3\); \(3, 3\)"),
        ((TRIANGLE, [[0, 1, 2]], None, np.ones((3, 3))), r"uv has shape \(3, 3\); \(3, 2\)"),
    ],
)
def test_a_mesh_refuses_in_one_sentence_what_is_not_one(arguments, message):
    with pytest.raises(ValueError, match=message) as caught:
        fw.Mesh(*arguments)
    assert "\n" not in str(caught.value)


def test_vertices_near_the_largest_float_are_not_taken_for_infinite():
    assert fw.Mesh(np.full((3, 3), 1.7e308), [[0, 1, 2]]).vertices.max() == 1.7e308


def test_an_obj_keeps_its_normals_and_uv(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvn 0 0 1\n"
        "f 1/1/1 2/2/1 3/3/1\nf 3/3/1 2/2/1 4/4/1\n"
    )
    mesh = fw.load_mesh(path)
    assert mesh.faces.shape == (2, 3) and volume(mesh) == 0
    assert_allclose(mesh.uv, mesh.vertices[:, :2])
    assert_allclose(mesh.normals, np.tile([0.0, 0.0, 1.0], (len(mesh.vertices), 1)))


@pytest.mark.parametrize("suffix", ["obj", "ply", "stl", "glb"])
def test_a_mesh_survives_each_format(tmp_path, suffix):
    import trimesh

    mesh, path = shapes.torus(rings=12, segments=8), tmp_path / f"torus.{suffix}"
    trimesh.Trimesh(mesh.vertices, mesh.faces, vertex_normals=mesh.normals, process=False).export(path)
    loaded = fw.load_mesh(str(path))
    assert len(loaded.vertices) == len(mesh.vertices) and len(loaded.faces) == len(mesh.faces)
    assert_allclose(volume(loaded), volume(mesh), rtol=1e-5)
    if suffix in ("ply", "glb", "obj"):
        assert_allclose(loaded.normals, mesh.normals, atol=1e-5)


def test_the_parts_of_a_scene_come_as_one_mesh_each_in_its_place(tmp_path):
    import trimesh

    scene, box = trimesh.Scene(), trimesh.creation.box()
    scene.add_geometry(box)
    scene.add_geometry(box, transform=trimesh.transformations.translation_matrix([10, 0, 0]))
    scene.export(tmp_path / "two.glb")
    mesh = fw.load_mesh(tmp_path / "two.glb")
    assert mesh.faces.shape == (24, 3)
    assert_allclose([mesh.vertices[:, 0].min(), mesh.vertices[:, 0].max()], [-0.5, 10.5])
    assert_allclose(volume(mesh), 2)


def test_the_teapot_is_at_hand():
    from pathlib import Path

    mesh = fw.load_mesh(Path(fw.__file__).parent / "data" / "teapot.obj")
    assert mesh.faces.shape == (992, 3) and mesh.vertices.shape == (792, 3)


@pytest.mark.parametrize(
    "name", ["bad.obj", "bad.ply", "bad.stl", "bad.glb", "empty.obj", "empty.stl", "points.obj"]
)
def test_a_file_without_a_mesh_is_refused_by_its_name(tmp_path, name):
    content = {"bad": b"\x00\xff solid not a mesh" * 9, "empty": b"", "points": b"v 0 0 0\nv 1 0 0\n"}
    (tmp_path / name).write_bytes(content[name.split(".")[0]])
    with pytest.raises(ValueError, match=f"load_mesh: .*{name}"):
        fw.load_mesh(tmp_path / name)


def test_a_missing_file_and_an_unknown_format_are_refused_by_name(tmp_path):
    with pytest.raises(FileNotFoundError, match="load_mesh: there is no file .*none.obj"):
        fw.load_mesh(tmp_path / "none.obj")
    with pytest.raises(ValueError, match="none.fbx ends in '.fbx'; one of .obj, .ply, .stl, .glb"):
        fw.load_mesh(tmp_path / "none.fbx")


def test_an_index_beyond_the_vertices_of_a_file_is_refused(tmp_path):
    (tmp_path / "far.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    with pytest.raises(ValueError, match="load_mesh: .*far.obj"):
        fw.load_mesh(tmp_path / "far.obj")


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: shapes.sphere(rings=1), "1 rings of 64"),
        (lambda: shapes.sphere(-1.0), "radius is -1"),
        (lambda: shapes.bumpy_sphere(4), "triangles is 4"),
    ],
)
def test_a_shape_that_cannot_be_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()
