# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3 (ipykernel)
#     language: python
#     name: python3
# ---

# %% [markdown]
# # 5 · Light from everywhere
#
# ## The question
#
# Out of doors light does not come from a lamp: it comes from the whole sky, and from the ground. **How does one keep such
# light in an array, and how much of it does a surface send to the eye?**
#
# Words that we need:
#
# - **Radiance** $L$ is the light that travels along one ray: power per area across the ray and per solid angle,
#   W m⁻² sr⁻¹. Pictures keep it for red, green and blue, up to a common factor.
# - A **solid angle** is the size of a set of directions: the area that it takes up on a sphere of radius 1. Its unit is
#   the steradian, sr. All directions together are $4\pi$ sr.
# - An **environment map** stores the radiance $L(\omega)$ that arrives from each direction $\omega$, a unit vector, as if
#   it came from infinitely far away. Then all points of a scene share one map. Lighting a scene by such a map is called
#   **image-based lighting**.
# - A **BRDF** $f(\omega_i, \omega_o)$, with the unit 1/sr, is the share of light from $\omega_i$ that a surface sends
#   towards $\omega_o$. For a matt surface it is the constant $\rho / \pi$, with the **albedo** $\rho$ between 0 and 1.

# %%
from pathlib import Path

import numpy as np

import framework as fw
from solutions import fast

image = fw.read_image(Path(fw.__file__).parent / "data" / "sky_512x256.exr").astype(float)
print(f"{image.shape[0]} rows of {image.shape[1]} pixels; the brightest is {image.max():.0f}, "
      f"half of all are below {np.median(image):.2f}; {(image < 0).sum()} values are negative")
env = fw.Environment(np.maximum(image, 0))

# %% [markdown]
# The brightest pixel holds the sun. It outshines the rest so much that an 8-bit picture cannot hold both: hence OpenEXR.
# The negative values are no light: lossy compression rings beside the sun, and whoever takes such a file sets them to 0.
#
# ## The idea
#
# A **latitude-longitude map** has $H$ rows and $2H$ columns. Row $r$ and column $c$, at the pixel's centre, look along
#
# $$\theta = \pi\,\frac{r + \tfrac12}{H}, \qquad \varphi = 2\pi\,\frac{c + \tfrac12}{2H}, \qquad
# \omega = (\sin\theta \sin\varphi,\ \cos\theta,\ -\sin\theta \cos\varphi),$$
#
# where $\theta$ is the angle from straight up ($+y$). All rows have the same number of pixels, but the ring of directions
# that a row stands for shrinks towards the poles. The pixel's solid angle is the integral of $\sin\theta$ over it:
#
# $$\Delta\omega_r = \frac{\pi}{H}\left(\cos\frac{\pi r}{H} - \cos\frac{\pi (r + 1)}{H}\right).$$
#
# A **cube map** is the other common form: six square pictures, each a window of 90° by 90°. Its pixels differ less, but
# they differ too: the corner of a face is further away, and is seen at a slant.
#
# The light that leaves a point with the normal $n$ (a unit vector that stands on the surface) for the eye is the
# **rendering equation**, here without shadows:
#
# $$L_o(\omega_o) = \int_{n \cdot \omega > 0} L(\omega)\, f(\omega, \omega_o)\, (n \cdot \omega)\, d\omega .$$
#
# On a matt surface all that is left to find is the **irradiance** $E(n) = \int L\,(n\cdot\omega)\,d\omega$, because
# $L_o = \rho E / \pi$. Two ways to an integral:
#
# - **Quadrature**: add up all pixels, each with its solid angle. Exact, and as long as the map is large.
# - **Monte Carlo**: draw $N$ directions $\omega_j$ with the density $p(\omega)$ per steradian, and take the mean of
#   $L(\omega_j)\,(n\cdot\omega_j) / p(\omega_j)$. It is right on average for any $p$ that misses no light. Its **standard
#   error**, the usual distance from the truth, is $\sigma / \sqrt N$, where $\sigma$ is the spread of the single terms.
#   Four times as many directions halve it.
#
# ## The code

# %%
def pixel_centres(height):
    """Directions (H, 2H, 3) and solid angles (H, 2H) of a map's pixels."""
    theta = np.pi * (np.arange(height) + 0.5)[:, None] / height
    phi = np.pi * (np.arange(2 * height) + 0.5) / height
    d = np.stack(np.broadcast_arrays(np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)), axis=-1)
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    return d, np.broadcast_to((np.pi / height * (edges[:-1] - edges[1:]))[:, None], (height, 2 * height))


directions, solid_angles = pixel_centres(env.height)


def irradiance(normals, pixels, directions, solid_angles):
    """E (N, 3) by quadrature: the cosine, clamped below the horizon, times radiance times solid angle."""
    cosine = np.maximum(normals @ directions.reshape(-1, 3).T, 0)
    return cosine @ (pixels * solid_angles[..., None]).reshape(-1, 3)


up = np.array([[0.0, 1.0, 0.0]])
print(f"all solid angles together: {solid_angles.sum() / np.pi:.12f} π sr")
print(f"under a sky of radiance 1, E = {irradiance(up, np.ones_like(env.pixels), directions, solid_angles)[0, 0]:.6f}; "
      f"π = {np.pi:.6f}")
row = int(np.argmax(np.cumsum(solid_angles[:, 0]) > 0.5 * solid_angles[:, 0].sum() / 8))
print(f"the top {row} of {env.height} rows hold {row / env.height:.0%} of the pixels, "
      f"but {solid_angles[:row].sum() / (4 * np.pi):.1%} of the directions")

# %% [markdown]
# Three ways to draw directions. *Uniform* gives each direction above the surface the same chance. *Cosine* prefers those
# that count more because of $n \cdot \omega$. *By light* draws pixels in proportion to their luminous energy, that is
# luminance times solid angle: it goes where the sun is.

# %%
def to_world(local, normal):
    """Directions (N, 3) about +z turned so that +z becomes `normal` (N, 3)."""
    tangent, bitangent = fw.orthonormal_frame(normal)
    return local[:, :1] * tangent + local[:, 1:2] * bitangent + local[:, 2:] * normal


def about_normal(u, normal, power):
    """Directions with a density in proportion to (n.w)^power, and the density per steradian; power is 0 or 1."""
    z = u[:, 0] if power == 0 else np.sqrt(u[:, 0])
    r, phi = np.sqrt(1 - z * z), 2 * np.pi * u[:, 1]
    local = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)
    return to_world(local, normal), (power + 1) * z**power / (2 * np.pi)


luminance = env.pixels @ [0.2126, 0.7152, 0.0722]
energy = (luminance * solid_angles).ravel()
cumulative = np.cumsum(energy) / energy.sum()


def by_light(u):
    """Pixels drawn in proportion to their energy: index (N,), and the density per steradian."""
    pixel = np.minimum(np.searchsorted(cumulative, u, side="right"), energy.size - 1)
    return pixel, energy[pixel] / energy.sum() / solid_angles.ravel()[pixel]


def estimate(way, normals, samples, rng):
    """E (N, 3) by Monte Carlo, `samples` directions for each normal."""
    n = np.repeat(normals, samples, axis=0)
    if way == "by light":
        pixel, density = by_light(rng.random(len(n)))
        d = directions.reshape(-1, 3)[pixel]
    else:
        d, density = about_normal(rng.random((len(n), 2)), n, power=0 if way == "uniform" else 1)
        row, column = (np.arccos(np.clip(d[:, 1], -1, 1)), np.arctan2(d[:, 0], -d[:, 2]) % (2 * np.pi))
        row = np.minimum((row * env.height / np.pi).astype(int), env.height - 1)
        pixel = row * 2 * env.height + (column * env.height / np.pi).astype(int) % (2 * env.height)
    weight = np.maximum((n * d).sum(axis=1), 0) / np.maximum(density, 1e-300)
    terms = env.pixels.reshape(-1, 3)[pixel] * weight[:, None]
    return terms.reshape(len(normals), samples, 3).mean(axis=1)


# %% [markdown]
# ## The picture
#
# One environment in its two forms. At the top and at the bottom of the map each row is stretched until it is as wide as
# the horizon. The six faces of the cube stand in OpenEXR's order. Both pictures hold the same light.

# %%
map_picture = fw.tone_map(env.resized(160).pixels, exposure=-0.5, method="filmic")
faces = env.to_cube(107)
fw.show.strip([map_picture], ["latitude and longitude: 360° across, 180° down, +y at the top"],
              caption="Black is no light, white radiance about 4 and more.")
fw.show.strip([fw.tone_map(face, -0.5, "filmic") for face in faces], ["+x", "-x", "+y", "-y", "+z", "-z"],
              caption="The faces of the cube, 90° each way.")

back = fw.Environment.from_cube(env.to_cube(256))
changed = (back.pixels * back.solid_angles()[..., None]).sum() / (env.pixels * solid_angles[..., None]).sum() - 1
print(f"from the map to a cube of 256² and back the energy changes by {abs(changed):.2%}")

# %% [markdown]
# Now a ball of rough metal under that sky, every pixel by Monte Carlo: the compiled engine draws directions where the
# metal's BRDF is large ([walkthrough 8](08_brdf_and_table.ipynb) shows how). With one direction a pixel there is mostly
# noise, with more it clears slowly. Drag the slider, or turn the sky.

# %%
SIZE = 256
y, x = np.mgrid[1 : -1 : SIZE * 1j, -1 : 1 : SIZE * 1j]
ball = x * x + y * y < 0.94
normal = np.stack([x, y, np.sqrt(np.clip(1 - x * x - y * y, 0, 1))], axis=-1)[ball]
view = np.broadcast_to([0.0, 0.0, 1.0], normal.shape)
GOLD = (1.0, 0.78, 0.34)


def noisy_ball(directions_a_pixel, turned_by_degrees):
    turned = fw.Environment(np.roll(env.pixels, int(turned_by_degrees / 360 * 2 * env.height), axis=1))
    picture = np.zeros((SIZE, SIZE, 3))
    picture[:] = fw.tone_map(np.array([0.25, 0.3, 0.38]))
    light, _ = fast.monte_carlo_shade(turned, normal, view, GOLD, 0.16, directions_a_pixel, np.random.default_rng(5))
    picture[ball] = fw.tone_map(light, exposure=-0.2, method="filmic")
    return picture


fw.interact(noisy_ball, strip=2, directions_a_pixel=[1, 2, 3, 4, 6, 8, 12], turned_by_degrees=np.arange(0, 360, 15),
            title="Rough gold under the sky, alpha = 0.16");

# %% [markdown]
# ## Run time against error
#
# The irradiance at 64 normals all over the sphere, in four ways, each with more and more directions. The truth is the
# sum over all pixels; the smaller maps, made once, hold averages of their pixels. Change `sun` to 0 to take the sun
# out of the sky, and run the cell again.

# %%
sun = 1.0  # yours to change: the brightness of everything above radiance 100, as a multiple

pixels = np.where(env.pixels.max(axis=-1, keepdims=True) > 100, sun * env.pixels, env.pixels)
env = fw.Environment(pixels)
energy = ((env.pixels @ [0.2126, 0.7152, 0.0722]) * solid_angles).ravel()
cumulative = np.cumsum(energy) / energy.sum()
i = np.arange(64) + 0.5
height, turn = 1 - 2 * i / 64, np.pi * (1 + 5**0.5) * i
normals = np.stack([np.sqrt(1 - height**2) * np.cos(turn), height, np.sqrt(1 - height**2) * np.sin(turn)], axis=1)
truth = irradiance(normals, env.pixels, directions, solid_angles)


def relative(found):
    return np.sqrt(np.mean(((found - truth) / truth.mean()) ** 2))


smaller = {rows: (env.resized(rows).pixels, *pixel_centres(rows)) for rows in (4, 16, 64)}
methods = {
    way: {f"{n}": lambda way=way, n=n: estimate(way, normals, n, np.random.default_rng(7)) for n in (16, 128, 1024)}
    for way in ("uniform", "cosine", "by light")
}
methods["all pixels of a smaller map"] = {f"{rows} rows": lambda m=m: irradiance(normals, *m) for rows, m in smaller.items()}
points = fw.plane.measure(methods, relative)
fw.plane.show(points, "RMS error of the irradiance, relative to its mean", "64 normals under the sky")
best = {way: min(p.error for p in points if p.method == way) for way in methods}
print(f"with 1024 directions: uniform {best['uniform']:.1%}, cosine {best['cosine']:.1%}, by light {best['by light']:.2%}")
print(f"the rule σ/√N: from 16 to 1024 directions 'by light' became "
      f"{points[6].error / points[8].error:.1f} times better, √64 = 8")

# %% [markdown]
# Where the sun shines, directions that do not know of it are nearly useless: hardly any meets it, and the one that does
# counts thousands of times too much. Such single bright pixels are called **fireflies**. And for a *matt* surface no
# sampling is needed at all: the sum over a small map, whose pixels are averages, beats every sampler. That is the whole
# idea of [prefiltering](07_prefiltering.ipynb).
#
# ## What goes wrong, and the cure
#
# **Solid angles forgotten.** The mean over the pixels is not the mean over the directions. And **every second pixel
# taken** to make a map smaller is no average either: it drops the sun, or doubles it.

# %%
flat, right = env.pixels.mean(axis=(0, 1)), (env.pixels * solid_angles[..., None]).sum(axis=(0, 1)) / (4 * np.pi)
print(f"mean radiance over pixels {flat[1]:.3f}, over directions {right[1]:.3f}: {flat[1] / right[1] - 1:+.0%}")
total = (env.pixels * solid_angles[..., None]).sum()
for step in (4, 16):
    first = [env.pixels[a::step, b::step] for a in (0, step // 2) for b in (0, step // 2)]
    w = pixel_centres(env.height // step)[1]
    kept = [(part * w[..., None]).sum() / total for part in first]
    small = env.resized(env.height // step)
    print(f"one pixel in {step} x {step} keeps {min(kept):.2f} to {max(kept):.2f} of the light, by where one starts; "
          f"the average keeps {(small.pixels * w[..., None]).sum() / total:.6f}")

# %% [markdown]
# **A running sum in float32.** To draw pixels by their energy one adds them up. In float32 (24 bits) a sum that has
# become large swallows what is small: below the sun's row whole stretches of sky no longer raise the sum at all. Those
# pixels are never drawn, their light is missing, and no error message says so. Here is a map of 1024 rows: a sky of
# radiance between 0 and 1, and a sun of 60000 in it.

# %%
rng = np.random.default_rng(1)
w = pixel_centres(1024)[1]
small_energy = rng.random((1024, 2048)) * w * 0.1
small_energy[200, 700] = 60000 * w[200, 700] * 40
single = np.cumsum(small_energy.ravel().astype(np.float32))
double = np.cumsum(small_energy.ravel())
for name, sums in (("float32", single), ("float64", double)):
    never = np.diff(sums, prepend=0) <= 0
    print(f"{name}: {never.mean():6.1%} of the pixels are never drawn; "
          f"the sum is off by {abs(float(sums[-1]) / small_energy.sum() - 1):.1e}")

# %% [markdown]
# The cure costs nothing: add in float64. Or first draw a row by the rows' sums, then a pixel within it: then no sum has
# more than a few thousand terms, and the search becomes faster too.
#
# **A firefly in the mean.** One sample with a tiny density and a bright pixel ruins a pixel for long. Clamping such terms
# makes pictures calmer and *wrong*: it loses light. Drawing them with the right density is the cure, and the plane above
# shows what it is worth.
#
# ## Exercises
#
# **1.** Why is the irradiance under a constant sky of radiance 1 equal to $\pi$, and not $2\pi$?
#
# <details><summary>Answer</summary>
#
# The hemisphere has $2\pi$ sr, but light that comes in at a slant spreads over more surface. The mean of $\cos\theta$
# over the hemisphere is one half:
# $\int_0^{2\pi}\!\int_0^{\pi/2} \cos\theta \sin\theta\, d\theta\, d\varphi = 2\pi \cdot \tfrac12 = \pi$. This is why the
# matt BRDF is $\rho/\pi$: with $\rho = 1$ the surface sends out all that it gets.
#
# </details>
#
# **2.** Draw half of the directions by the cosine and half by light. What must the weight of a sample be, so that the
# estimate is right on average and neither kind's fireflies are left?
#
# <details><summary>Answer</summary>
#
# All samples together come from the mixture $p = \tfrac12 p_\text{cos} + \tfrac12 p_\text{light}$, whichever of the two drew
# them. So divide by that sum, not by the own density. A direction that one of them draws rarely has a large $p$ from the
# other. This is **multiple importance sampling** with the balance heuristic.
#
# </details>
#
# **3.** The sun's disc has an angular radius of 0.27°. How many uniform directions of the hemisphere are needed until on
# average one meets it?
#
# <details><summary>Answer</summary>
#
# The disc has the solid angle $2\pi(1 - \cos 0.27°)$, the hemisphere $2\pi$. So the chance of one direction is
# $1 - \cos 0.27° = 2 \sin^2 0.135° \approx 1.1 \cdot 10^{-5}$, and it takes about 90 000 directions.
#
# </details>
#
# ## From the lecture
#
# Objects that are lit by a map alone seem to float. There are two reasons. The map is infinitely far away, so nothing
# changes when an object moves; and the equation above has no shadows, so nothing darkens where the object stands.
# [Walkthrough 9](09_split_sum_and_shadows.ipynb) brings the shadows back. The lecture's other point is the plane above:
# Monte Carlo is the general solution, and each pixel of each picture would have to pay for it. The next two walkthroughs
# ask what can be done beforehand, once for each map.
#
# ## Where to read on
#
# - J. F. Blinn, M. E. Newell, *Texture and reflection in computer generated images*, Communications of the ACM 19 (1976):
#   the first environment maps.
# - N. Greene, *Environment mapping and other applications of world projections*, IEEE Computer Graphics and Applications
#   6 (1986): the cube.
# - J. T. Kajiya, *The rendering equation*, SIGGRAPH 1986.
# - E. Veach, L. J. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, SIGGRAPH 1995: exercise 2.
# - P. Debevec, *Rendering synthetic objects into real scenes*, SIGGRAPH 1998: light from photographs.
# - M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 4th edition, 2023, chapters 2 and 12.
