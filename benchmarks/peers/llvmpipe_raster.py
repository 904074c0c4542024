"""The same G-buffer from OpenGL on the CPU: Mesa's llvmpipe through moderngl."""

import moderngl
import numpy as np

VERTEX = """
#version 330
uniform mat4 matrix;
in vec3 in_position;
in vec3 in_normal;
out vec3 point;
out vec3 across;
void main() {
    point = in_position;
    across = in_normal;
    gl_Position = matrix * vec4(in_position, 1.0);
}
"""
FRAGMENT = """
#version 330
in vec3 point;
in vec3 across;
layout(location = 0) out vec4 position;
layout(location = 1) out vec4 normal;
void main() {
    position = vec4(point, 1.0);
    normal = vec4(normalize(across), 0.0);
}
"""


class Rasterizer:
    """A mesh with vertex normals, ready to be drawn: position and normal as float32, both sides, with a depth test.

    Setting up, uploading and reading back are not part of `draw`.
    """

    def __init__(self, mesh, camera, width, height):
        self.context = context = moderngl.create_standalone_context(backend="egl")
        program = context.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
        program["matrix"].write(camera.view_projection(width, height).T.astype("f4").tobytes())
        corners = context.buffer(np.hstack([mesh.vertices, mesh.normals]).astype("f4").tobytes())
        faces = context.buffer(mesh.faces.astype("i4").tobytes())
        layout = [(corners, "3f 3f", "in_position", "in_normal")]
        self._array = context.vertex_array(program, layout, faces)
        self._targets = [context.texture((width, height), 4, dtype="f4") for _ in range(2)]
        self._frame = context.framebuffer(self._targets, context.depth_renderbuffer((width, height)))
        self._shape = (height, width, 4)

    @property
    def name(self):
        return self.context.info["GL_RENDERER"]

    def draw(self):
        """One frame; returns when it is finished."""
        self._frame.use()
        self.context.enable_only(moderngl.DEPTH_TEST)
        self._frame.clear()
        self._array.render()
        self.context.finish()

    def read(self):
        """Position, normal (H, W, 3) and mask (H, W) of the last frame, row 0 the top."""
        position, normal = (
            np.frombuffer(target.read(), np.float32).reshape(self._shape)[::-1] for target in self._targets
        )
        return position[..., :3], normal[..., :3], position[..., 3] > 0
