"""Images in files: every kind of EXR, PNG, and files that are none."""

import subprocess
import sys
import textwrap

import numpy as np
import OpenEXR
import pytest
from numpy.testing import assert_array_equal

import framework as fw
from framework.exr import read_exr

LOSSLESS = ["no", "rle", "zips", "zip", "piz"]
RNG = np.random.default_rng(3)


def planes(kind, shape=(19, 23)):
    values = RNG.normal(size=(4, *shape)) * 100
    return values.astype(kind) if kind != np.uint32 else np.abs(values).astype(np.uint32)


def write(path, channels, compression=OpenEXR.ZIP_COMPRESSION, **attributes):
    header = {"compression": compression, "type": OpenEXR.scanlineimage, **attributes}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))


@pytest.mark.parametrize("name", LOSSLESS)
@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 3), (5, 7, 4), (1, 1, 3)])
def test_what_is_written_is_read_to_the_bit(tmp_path, name, half, shape):
    image = RNG.normal(size=shape).astype(np.float16 if half else np.float32)
    fw.write_image(tmp_path / "a.exr", image, half=half, compression=name)
    assert_array_equal(fw.read_image(tmp_path / "a.exr"), image.astype(np.float32))


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.uint32])
@pytest.mark.parametrize("names", ["RGB", "RGBA", "Y", "BGR", "ABGR"])
def test_channels_of_any_kind_and_order_come_as_colours(tmp_path, kind, names):
    values = dict(zip(names, planes(kind), strict=False))
    write(tmp_path / "a.exr", {name: np.ascontiguousarray(values[name]) for name in names})
    image = fw.read_image(tmp_path / "a.exr")
    wanted = "Y" if names == "Y" else "RGBA" if "A" in names else "RGB"
    stacked = np.stack([values[name] for name in wanted], axis=-1)
    assert_array_equal(image, stacked[..., 0] if wanted == "Y" else stacked)


@pytest.mark.parametrize("compression", ["PXR24", "B44", "B44A", "DWAA", "DWAB"])
def test_lossy_files_are_read_nearly(tmp_path, compression):
    ramp = np.linspace(0.1, 2, 64 * 64, dtype=np.float16).reshape(64, 64)
    write(tmp_path / "a.exr", {c: ramp for c in "RGB"}, getattr(OpenEXR, f"{compression}_COMPRESSION"))
    np.testing.assert_allclose(fw.read_image(tmp_path / "a.exr")[..., 1], ramp, atol=0.05)


def test_tiles_and_channels_of_mixed_kinds_are_read(tmp_path):
    values = dict(zip("RGB", planes(np.float32), strict=False))
    write(tmp_path / "t.exr", dict(values), type=OpenEXR.tiledimage, tiles=OpenEXR.TileDescription())
    assert_array_equal(fw.read_image(tmp_path / "t.exr"), np.stack(list(values.values()), axis=-1))
    values["G"] = values["G"].astype(np.float16)
    write(tmp_path / "m.exr", dict(values))
    assert_array_equal(fw.read_image(tmp_path / "m.exr"), np.stack(list(values.values()), axis=-1))


def test_attributes_are_kept(tmp_path):
    attributes = {"scene": "two spheres", "error": 0.125, "envmap": "latlong"}
    fw.write_image(tmp_path / "a.exr", np.ones((2, 4, 3), np.float32), attributes=attributes)
    _, kept = read_exr(tmp_path / "a.exr")
    assert {name: kept[name] for name in attributes} == attributes


def test_halves_beyond_their_range_are_refused_or_clamped_with_a_count(tmp_path):
    image = np.ones((2, 2, 3), np.float32)
    image[0, 0] = 70000
    with pytest.raises(ValueError, match="a.exr: 3 of 12 values are beyond 65504"):
        fw.write_image(tmp_path / "a.exr", image, half=True)
    with pytest.warns(UserWarning, match="3 of 12"):
        fw.write_image(tmp_path / "a.exr", image, half=True, on_overflow="clamp")
    assert fw.read_image(tmp_path / "a.exr").max() == 65504


def test_what_cannot_be_written_leaves_the_folder_as_it_was(tmp_path):
    image, path = np.ones((2, 4, 3), np.float32), tmp_path / "a.exr"
    for wrong in (
        {"attributes": {"envmap": "sphere"}},
        {"attributes": {"x": object()}},
        {"compression": "mp3"},
    ):
        with pytest.raises(ValueError, match="a.exr"):
            fw.write_image(path, image, **wrong)
    with pytest.raises(ValueError, match="uint8.*want floating point"):
        fw.write_image(path, image.astype(np.uint8))
    with pytest.raises(FileNotFoundError):
        fw.write_image(tmp_path / "missing" / "a.exr", image)
    assert not list(tmp_path.iterdir())
    fw.write_image(path, image)
    with pytest.raises(ValueError):
        fw.write_image(path, 2 * image, attributes={"x": object()})
    assert_array_equal(fw.read_image(path), image)


def bad_files(folder):
    good = folder / "good.exr"
    fw.write_image(good, np.ones((8, 16, 3), np.float32))
    block = good.read_bytes()
    place = block.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
    huge = block[:place] + np.array([0, 0, 99999, 99999], "<i4").tobytes() + block[place + 16 :]
    files = {"truncated.exr": block[: len(block) // 2], "huge.exr": huge, "text.exr": b"not an image",
             "empty.exr": b"", "short.exr": block[:20], "text.png": b"not an image", "picture.gif": b"GIF89a"}  # fmt: skip
    for name, content in files.items():
        (folder / name).write_bytes(content)
    write(folder / "depth.exr", {"Z": np.ones((4, 4), np.float32)})
    return [*files, "depth.exr", "missing.exr", "missing.png"]


def test_bad_files_get_one_sentence_with_their_name(tmp_path, capfd):
    for name in bad_files(tmp_path):
        with pytest.raises((ValueError, OSError)) as said:
            fw.read_image(tmp_path / name)
        assert name in str(said.value) and "\n" not in str(said.value), name
        # told by the header, before anything is allocated
        assert name != "huge.exr" or "100000 x 100000" in str(said.value)
    assert capfd.readouterr().out == ""


DAMAGE = """
import resource, sys, warnings
import numpy as np
resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))
warnings.simplefilter("ignore")
sys.path.insert(0, {root!r})
import framework as fw
count, folder = int(sys.argv[1]), sys.argv[2]
rng = np.random.default_rng(7)
good = []
for name, half in (("zip", False), ("piz", True), ("rle", True), ("dwab", True)):
    image = rng.gamma(1.0, 2.0, (32, 64, 3)).astype(np.float32)
    fw.write_image(folder + "/good.exr", image, half=half, compression=name)
    good.append(open(folder + "/good.exr", "rb").read())
read = refused = 0
for i in range(count):
    block = bytearray(good[i % len(good)])
    how = i // len(good) % 3
    if how == 0:
        block = block[: rng.integers(0, len(block))]
    else:
        low, high = (0, 400) if how == 1 else (300, len(block))
        for place in rng.integers(low, min(high, len(block)), rng.integers(1, 9)):
            block[place] = rng.integers(256)
    path = folder + "/damaged.exr"
    open(path, "wb").write(block)
    try:
        fw.read_image(path)
        read += 1
    except (ValueError, OSError) as error:
        assert "damaged.exr" in str(error) and "\\n" not in str(error), error
        refused += 1
print(read, refused, file=sys.stderr)
"""


def damage(count, folder):
    root = str(__import__("pathlib").Path(fw.__file__).parents[1])
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(DAMAGE).format(root=root), str(count), str(folder)],
                          capture_output=True, text=True, timeout=300)  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == ""
    read, refused = map(int, done.stderr.split()[-2:])
    assert read + refused == count and refused > count / 4


def test_damaged_files_are_read_or_refused(tmp_path):
    damage(60, tmp_path)


@pytest.mark.drill
def test_many_damaged_files_are_read_or_refused(tmp_path):
    damage(1200, tmp_path)


@pytest.mark.parametrize("shape", [(3, 4), (3, 4, 3), (3, 4, 4)])
def test_png_keeps_display_values(tmp_path, shape):
    image = RNG.random(shape)
    fw.write_image(tmp_path / "a.png", image)
    np.testing.assert_allclose(fw.read_image(tmp_path / "a.png"), image, atol=0.5 / 255 + 1e-6)


def test_a_png_of_radiance_is_refused(tmp_path):
    with pytest.raises(ValueError, match="tone_map"):
        fw.write_image(tmp_path / "a.png", np.full((2, 2, 3), 3.0))


def test_tone_mapping_stays_in_range_and_order():
    x = np.array([0.0, 1e-6, 0.18, 0.5, 1.0, 8.0, 6e4, 1e300])
    for method in ("gamma", "filmic"):
        y = fw.tone_map(x, method=method)
        assert y[0] == 0 and abs(y[-1] - 1) < 1e-12 and (np.diff(y) >= 0).all()
    # the definition of sRGB: 0.5 linear is 0.7354 encoded
    np.testing.assert_allclose(fw.tone_map(0.5), 0.735357, atol=1e-6)
    np.testing.assert_allclose(fw.tone_map(0.25, exposure=1.0), fw.tone_map(0.5))
