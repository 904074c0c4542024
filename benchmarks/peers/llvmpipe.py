"""The same picture as a fragment shader on Mesa's llvmpipe: what a GPU's program costs on this CPU.

Needs moderngl (extra `bench`) and Mesa's EGL (Debian: libegl1 libgl1-mesa-dri). The shader is what one would write
for the scene by hand: the tree inlined, one thread per pixel, a march to a pixel's radius, tetrahedral normals, the
shadow of `soft_shadow`. Scenes of many primitives are loops over uniform arrays, one per kind.
"""

import functools
import os

import numpy as np

from framework import sdf_operators as operators
from framework import sdf_primitives as primitives

LOOP_FROM = 24  # primitives, above which a union becomes loops


def render_sdf_llvmpipe(scene, camera, width, height, to_light, k, t_max=40.0):
    """`solutions.fast.render_sdf`, by a fragment shader.

    Returns
    -------
    (t, normal, visibility)     float32, as there; None where moderngl or a software OpenGL is missing
    """
    target = _draw(scene, camera, width, height, to_light, k, t_max)
    if target is None:
        return None
    whole = np.frombuffer(target.read(components=4, dtype="f4", attachment=0), "f4").reshape(height, width, 4)
    t = np.frombuffer(target.read(components=1, dtype="f4", attachment=1), "f4").reshape(height, width)
    return np.where(t < 0, np.float32(np.inf), t), whole[..., :3], whole[..., 3]


def draw_only(scene, camera, width, height, to_light, k, t_max=40.0):
    """The same without reading the picture back, for timing: whether it could be drawn."""
    return _draw(scene, camera, width, height, to_light, k, t_max) is not None


def _draw(scene, camera, width, height, to_light, k, t_max):
    """The framebuffer that the picture is in, None without OpenGL."""
    context = _context()
    if context is None:
        return None
    program, target = _program(scene, context), _target(context, width, height)
    x, y, _, axis = camera.view_projection(width, height)[:, :3]
    right, up = x / (x @ x), y / (y @ y)
    for name, value in {
        "eye": camera.position, "axis": axis, "right": right, "up": up,
        "light": np.asarray(to_light) / np.linalg.norm(to_light),
    }.items():  # fmt: skip
        program[name].value = tuple(map(float, value))
    program["k"].value, program["far"].value = float(k), float(t_max)
    program["pixel"].value = float(np.linalg.norm(up) / height)
    program["size"].value = (width, height)
    target.use()
    context.vertex_array(program, []).render(mode=context.TRIANGLES, vertices=3)
    context.finish()
    return target


@functools.cache
def _context():
    os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")
    try:
        import moderngl

        return moderngl.create_context(standalone=True, backend="egl", require=330)
    except Exception:  # whatever is missing, and each platform says it in its own way
        return None


@functools.cache
def _target(context, width, height):
    return context.framebuffer(
        [context.texture((width, height), 4, dtype="f4"), context.texture((width, height), 1, dtype="f4")]
    )


@functools.cache
def _program(scene, context):
    body, loops, uniforms = _field(scene)
    program = context.program(
        vertex_shader="""#version 330
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }""",
        fragment_shader=_SHADER.replace("LOOPS", loops).replace("FIELD", body),
    )
    for name, values in uniforms.items():
        program[name].write(values.tobytes())
    return program


_SHADER = """#version 330
uniform vec3 eye, axis, right, up, light;
uniform float k, far, pixel;
uniform ivec2 size;
layout(location = 0) out vec4 picture;
layout(location = 1) out float depth;
float sphere(vec3 p, vec3 c, float r) { return length(p - c) - r; }
float box(vec3 p, vec3 c, vec3 h) {
  vec3 q = abs(p - c) - h;
  return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
}
float torus(vec3 p, vec3 c, float R, float r) { p -= c; return length(vec2(length(p.xz) - R, p.y)) - r; }
float capsule(vec3 p, vec3 a, vec3 b, float r) {
  vec3 u = b - a;
  p -= a;
  return length(p - u * clamp(dot(p, u) / dot(u, u), 0.0, 1.0)) - r;
}
float smooth_union(float a, float b, float k) {
  float o = max(k - abs(a - b), 0.0);
  return min(a, b) - o * o / (4.0 * k);
}
LOOPS
float field(vec3 p) { return FIELD; }
void main() {
  vec2 at = 2.0 * gl_FragCoord.xy / vec2(size) - 1.0;
  vec3 d = normalize(axis + at.x * right - at.y * up);
  float t = 0.0;
  bool hit = false;
  for (int i = 0; i < 256 && t < far; i++) {
    float h = field(eye + t * d);
    if (h < 0.1 * pixel * t) { hit = true; break; }
    t += h;
  }
  picture = vec4(0.0);
  depth = -1.0;
  if (!hit) return;
  vec3 p = eye + t * d;
  vec2 e = vec2(1.0, -1.0) * 5e-4;
  vec3 n = normalize(e.xyy * field(p + e.xyy) + e.yyx * field(p + e.yyx)
                     + e.yxy * field(p + e.yxy) + e.xxx * field(p + e.xxx));
  float seen = 0.0;
  if (dot(n, light) > 0.0) {
    seen = 1.0;
    vec3 o = p + 0.005 * n;
    float s = 0.02;
    for (int i = 0; i < 256 && s <= 12.0; i++) {
      float h = field(o + s * light);
      if (h < 1e-4) { seen = 0.0; break; }
      seen = min(seen, k * h / s);
      s += h;
    }
  }
  picture = vec4(n, seen);
  depth = t;
}
"""


def _field(scene):
    """The field as a GLSL expression, the functions that it needs for unions of many primitives, and their uniforms."""
    loops, uniforms = [], {}

    def vec(v):
        return "vec3(" + ", ".join(f"{float(c)!r}" for c in v) + ")"

    def text(node):
        if isinstance(node, operators.Union) and len(node.of) > LOOP_FROM:
            return many(node.of)
        if isinstance(node, operators.Union):
            return functools.reduce("min({}, {})".format, map(text, node.of))
        if isinstance(node, operators.SmoothUnion):
            return f"smooth_union({text(node.a)}, {text(node.b)}, {float(node.k)!r})"
        if isinstance(node, primitives.Plane):
            return f"(dot(p, {vec(node.normal)}) - {float(node.offset)!r})"
        name, arguments = _CALLS[type(node)](node)
        return (
            f"{name}(p, {', '.join(vec(a) if isinstance(a, tuple) else repr(float(a)) for a in arguments)})"
        )

    def many(nodes):
        kinds = {}
        for node in nodes:
            kinds.setdefault(type(node), []).append(node)
        parts = []
        for kind, members in kinds.items():
            if kind not in _CALLS or len(members) <= 2:
                parts += map(text, members)
                continue
            name, count = _CALLS[kind](members[0])[0], len(members)
            calls = [_CALLS[kind](member)[1] for member in members]
            arrays, arguments = [], []
            for i, first in enumerate(calls[0]):
                glsl = "vec3" if isinstance(first, tuple) else "float"
                uniforms[f"{name}_{i}"] = np.array([call[i] for call in calls], "f4")
                arrays.append(f"uniform {glsl} {name}_{i}[{count}];")
                arguments.append(f"{name}_{i}[i]")
            loops.append(
                "\n".join(arrays)
                + f"\nfloat all_{name}(vec3 p) {{ float h = 1e30; for (int i = 0; i < {count}; i++)"
                f" h = min(h, {name}(p, {', '.join(arguments)})); return h; }}"
            )
            parts.append(f"all_{name}(p)")
        return functools.reduce("min({}, {})".format, parts)

    body = text(scene)
    return body, "\n".join(loops), uniforms


_CALLS = {
    primitives.Sphere: lambda n: ("sphere", (n.center, n.radius)),
    primitives.Box: lambda n: ("box", (n.center, n.half_size)),
    primitives.Torus: lambda n: ("torus", (n.center, n.major_radius, n.minor_radius)),
    primitives.Capsule: lambda n: ("capsule", (n.a, n.b, n.radius)),
}
