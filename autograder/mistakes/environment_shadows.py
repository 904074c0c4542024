"""Known mistakes in tasks 5.1 to 5.3."""

import numpy as np

from autograder.mistakes import mistake
from autograder.mistakes.right import environment_shadows as right
from solutions import environment_shadows as reference


# 5.1 --------------------------------------------------------------------------------------------------------------
@mistake("Of what should both halves of a cut have the same amount?")
def dominant_lights_by_area(env, count):
    """Lights of very unequal strength: dark parts of the sky get as many as bright ones."""
    return right.cut(env, count, even=False, unequal=True)


@mistake("Where in its region does most of the light come from?")
def dominant_lights_middle_of_the_region(env, count):
    """Lights stand beside the bright spots that they stand for."""
    return right.cut(env, count, centre=True)


@mistake("How large is a pixel near the pole, on the sphere?")
def dominant_lights_no_solid_angle(env, count):
    """The poles get too many lights and too much power."""
    return right.cut(env, count, flat=True)


@mistake("How bright does a colour look: what do its three channels count?")
def dominant_lights_red(env, count):
    """Blue parts of the sky get too few lights."""
    return right.cut(env, count, weights=(1.0, 0.0, 0.0))


@mistake("Where does the light of the rest of the sky come from?")
def dominant_lights_brightest_pixels(env, count):
    """All lights crowd around the brightest spot."""
    light = (env.pixels * env.solid_angles()[..., None]).reshape(-1, 3)
    best = np.argsort(-(light @ right.LUMINANCE), kind="stable")[:count]
    total = light[best].sum(axis=0)
    scale = light.sum(axis=0) / np.where(total > 0, total, 1)
    return env.directions().reshape(-1, 3)[best], light[best] * scale


@mistake("Is a light's power a mean, or a sum over its region?")
def dominant_lights_mean_radiance(env, count):
    """The powers do not add up to the sky's."""
    toward, power = right.cut(env, count)
    return toward, power / (4 * np.pi / count)


@mistake("How many channels has a power?")
def dominant_lights_grey(env, count):
    """The lights have lost their colours."""
    toward, power = right.cut(env, count)
    return toward, np.repeat((power @ right.LUMINANCE)[:, None], 3, axis=1)


@mistake("What is the length of a mean of unit vectors?")
def dominant_lights_not_unit(env, count):
    """Directions are too short."""
    toward, power = right.cut(env, count)
    return toward * 0.9, power


# 5.2 --------------------------------------------------------------------------------------------------------------
@mistake("Which directions matter most to a matt surface?")
def ambient_visibility_uniform(sdf, p, normal, t_max):
    """Low occluders count too much."""
    return right.ambient(sdf, p, normal, t_max, uniform=True)


@mistake("Around which axis is the hemisphere?")
def ambient_visibility_no_normal(sdf, p, normal, t_max):
    """Walls see the sky as floors do."""
    return right.ambient(sdf, p, normal, t_max, up=True)


@mistake("How far do you have to look?")
def ambient_visibility_no_t_max(sdf, p, normal, t_max):
    """Far things darken what they should not."""
    return right.ambient(sdf, p, normal, 20.0)


@mistake("Is the visible fraction asked for, or the hidden one?")
def ambient_visibility_occlusion(sdf, p, normal, t_max):
    """Open places are dark, corners bright."""
    return 1 - right.ambient(sdf, p, normal, t_max)


@mistake("How many cones cover a hemisphere?")
def ambient_visibility_one_cone(sdf, p, normal, t_max):
    """Everything is judged by what stands straight above."""
    return right.ambient(sdf, p, normal, t_max, 1)


@mistake("What do distances along one line know of the rest of the hemisphere?")
def ambient_visibility_along_the_normal(sdf, p, normal, t_max):
    """Corners are dark, but walls at the side do not count right."""
    t = np.linspace(0.1, 1, 5) * 0.25 * t_max
    missing = sum((s - sdf(p + s * normal)) / 2**i for i, s in enumerate(t))
    return np.clip(1 - missing / t_max, 0, 1)


@mistake("Is the fraction itself asked for?")
def ambient_visibility_squared(sdf, p, normal, t_max):
    """Half-open places are too dark."""
    return right.ambient(sdf, p, normal, t_max) ** 2


# 5.3 --------------------------------------------------------------------------------------------------------------
def _free(p):
    return np.full(p.shape[:-1], 100.0)


@mistake("Where does the scene come in?")
def shade_with_shadows_none(light, sdf, *rest):
    """No shadows at all."""
    return right.shade_parts(light, _free, *rest)


@mistake("What may stand between a mirror and what it shows?")
def shade_with_shadows_only_on_the_matt_part(light, sdf, *rest):
    """Mirrors show what is hidden from them."""
    return right.shade_parts(light, sdf, *rest, gloss=False) + right.shade_parts(
        light, _free, *rest, matt=False
    )


@mistake("What may stand between a matt surface and the sky?")
def shade_with_shadows_only_on_the_glossy_part(light, sdf, *rest):
    """Matt surfaces have no shadows."""
    return right.shade_parts(light, sdf, *rest, matt=False) + right.shade_parts(
        light, _free, *rest, gloss=False
    )


@mistake("From where does most of the light come, and what stands in that way?")
def shade_with_shadows_ambient(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Shadows are the same all around: the sun casts none."""
    everything = right.shade_parts(light, _free, p, normal, view, r0, roughness, albedo, t_max)
    return everything * reference.ambient_visibility(sdf, p, normal, t_max)[:, None]


@mistake("What does light.irradiance return: the integral, or the mean?")
def shade_with_shadows_divided_by_pi_twice(light, sdf, *rest):
    """Matt surfaces are too dark by a factor of 3.14."""
    return right.shade_parts(light, sdf, *rest, gloss=False) / np.pi + right.shade_parts(
        light, sdf, *rest, matt=False
    )


@mistake("How many lights stand for a sky?")
def shade_with_shadows_one_lamp(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """One hard shadow, whatever the sky is."""
    a = (light, sdf, p, normal, view, r0, roughness, albedo, t_max)
    return right.shade_parts(*a, matt=False) + right.lamps(light, sdf, p, normal, albedo, t_max, 1)


@mistake("Do the filtered sky and the table want the roughness, or alpha?")
def shade_with_shadows_alpha_for_roughness(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Reflections are too sharp."""
    return right.shade_parts(light, sdf, p, normal, view, r0, np.square(roughness), albedo, t_max)


@mistake("Which factor of the matt part does the task leave out?")
def shade_with_shadows_energy_conserving(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Matt parts are too dark at low angles."""
    facing = np.clip(np.sum(normal * view, axis=1), 0, 1)[:, None]
    fresnel = r0 + (1 - np.asarray(r0)) * (1 - facing) ** 5
    return right.shade_parts(light, sdf, p, normal, view, r0, roughness, albedo * (1 - fresnel), t_max)


@mistake("What is the glossy part where n.v is 0 or less?")
def shade_with_shadows_from_behind(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Mirrors seen from behind shine."""
    flip = np.where(np.sum(normal * view, axis=1, keepdims=True) < 0, -1.0, 1.0)
    return right.shade_parts(light, sdf, p, normal, flip * view, r0, roughness, albedo, t_max)


@mistake("How many rays to the sky does a point need, once each light is as large as its part of the sky?")
def shade_with_shadows_ray_to_every_pixel(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Right, at many times the evaluations: each pixel of the sky is a light of its own."""
    a = (light, sdf, p, normal, view, r0, roughness, albedo, t_max)
    count = light.env.pixels[..., 0].size
    return right.shade_parts(*a, matt=False) + right.lamps(light, sdf, p, normal, albedo, t_max, count)
