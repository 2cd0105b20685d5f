"""Laws of encoders: what was asked for is in the file, files are whole or not there, bytes repeat."""

from __future__ import annotations

import subprocess
import sys

import av
import numpy as np
import pytest
from PIL import Image

from renderers.develop import develop
from renderers.encoders import mp4, png
from renderers.encoders.mp4 import planes_of

COMMENT = "sceneql 0 script 0123abcd"


def pictures(count, width=96, height=64):
    for k in range(count):
        y, x = np.mgrid[:height, :width]
        yield np.stack([(x + 3 * k) % 256, 2 * y, np.full_like(x, 10 * k)], axis=-1).astype(np.uint8)


def film(path, count=12, rate=30.0, size=(96, 64), end="close"):
    writer = mp4.Writer(path, size=size, rate=rate, quality=17, comment=COMMENT)
    for picture in pictures(count, *size):
        writer.write(picture)
    return getattr(writer, end)()


@pytest.mark.parametrize("rate", [24.0, 30.0, 60.0, 12.5])
def test_a_film_has_the_frames_the_rate_and_the_size_asked_for(tmp_path, rate):
    path = tmp_path / "film.mp4"
    assert film(path, 12, rate) == [path]
    assert [p.name for p in tmp_path.iterdir()] == ["film.mp4"]
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        assert float(stream.average_rate) == rate
        assert (stream.width, stream.height) == (96, 64)
        assert stream.codec_context.name == "h264"
        assert stream.codec_context.pix_fmt == "yuv420p"
        assert (stream.codec_context.colorspace, stream.codec_context.color_trc) == (1, 1)
        assert container.metadata["comment"] == COMMENT
        times = [frame.time for frame in container.decode(video=0)]
    assert times == pytest.approx([k / rate for k in range(12)])


def test_a_film_starts_fast_on_the_web(tmp_path):
    film(tmp_path / "film.mp4")
    content = (tmp_path / "film.mp4").read_bytes()
    assert 0 < content.index(b"moov") < content.index(b"mdat")


def test_the_bytes_of_a_film_repeat(tmp_path):
    film(tmp_path / "a.mp4")
    film(tmp_path / "b.mp4")
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_colors_of_a_film_are_right_in_bt709(tmp_path):
    writer = mp4.Writer(tmp_path / "film.mp4", size=(64, 64), rate=30, quality=5, comment="")
    color = np.array([230, 60, 40], dtype=np.uint8)
    for _ in range(3):
        writer.write(np.broadcast_to(color, (64, 64, 3)).copy())
    writer.close()
    with av.open(str(tmp_path / "film.mp4")) as container:
        frame = next(container.decode(video=0))
        shown = frame.reformat(format="rgb24", src_colorspace="ITU709", dst_colorspace="ITU709").to_ndarray()
    assert np.abs(shown.astype(int) - color).max() <= 4


def test_an_aborted_film_keeps_its_frames_beside_the_final_name(tmp_path):
    assert film(tmp_path / "film.mp4", 7, end="abort") == [tmp_path / "film.partial.mp4"]
    assert [p.name for p in tmp_path.iterdir()] == ["film.partial.mp4"]
    with av.open(str(tmp_path / "film.partial.mp4")) as container:
        assert sum(1 for _ in container.decode(video=0)) == 7


def test_nothing_is_left_of_a_film_without_frames(tmp_path):
    assert film(tmp_path / "film.mp4", 0, end="abort") == []
    assert list(tmp_path.iterdir()) == []


def test_an_earlier_film_stays_whole_until_the_new_one_is(tmp_path):
    path = tmp_path / "film.mp4"
    film(path)
    before = path.read_bytes()
    writer = mp4.Writer(path, size=(96, 64), rate=30, quality=17, comment=COMMENT)
    for picture in pictures(5):
        writer.write(picture)
        assert path.read_bytes() == before
    writer.close()
    assert path.read_bytes() != before


def test_an_odd_size_is_refused_in_words(tmp_path):
    with pytest.raises(ValueError, match="must be even, not 95 64"):
        mp4.Writer(tmp_path / "film.mp4", size=(95, 64), rate=30, quality=17, comment="")


def test_a_picture_is_kept_to_the_bit_with_its_comment(tmp_path):
    picture = next(pictures(1))
    writer = png.Writer(tmp_path / "still.png", numbered=False, comment=COMMENT)
    writer.write(picture)
    assert writer.close() == [tmp_path / "still.png"]
    with Image.open(tmp_path / "still.png") as image:
        assert np.array_equal(np.asarray(image), picture)
        assert image.text["Comment"] == COMMENT


def test_a_row_of_pictures_is_numbered_and_what_was_made_is_kept(tmp_path):
    writer = png.Writer(tmp_path / "row.png", numbered=True, comment="")
    for picture in pictures(3):
        writer.write(picture)
    assert writer.abort() == writer.close()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["row.0000.png", "row.0001.png", "row.0002.png"]


def test_files_are_as_small_as_compression_makes_them_and_their_pixels_the_same(tmp_path):
    sizes = []
    for compression in (0, 1, 9):
        writer = png.Writer(tmp_path / f"{compression}.png", numbered=False, comment="", compression=compression)
        picture = next(pictures(1))
        writer.write(picture)
        (file,) = writer.close()
        sizes.append(file.stat().st_size)
        with Image.open(file) as image:
            assert np.array_equal(np.asarray(image), picture)
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] > picture.size > 2 * sizes[1] > 2 * sizes[2]


@pytest.mark.parametrize("threads", ["1", "2"])
def test_a_picture_that_cannot_be_written_beside_the_next_one_is_told_and_the_others_are_kept(
    tmp_path, monkeypatch, threads
):
    monkeypatch.setenv("SCENEQL_THREADS", threads)
    writer = png.Writer(tmp_path / "row.png", numbered=True, comment="")
    first, second = pictures(2)
    writer.write(first)
    (tmp_path / "row.0001.png").mkdir()  # in its way
    with pytest.raises(OSError, match="directory"):
        [lambda: writer.write(second), lambda: (writer.write(second), writer.close())][int(threads) - 1]()
    assert writer.abort() == [tmp_path / "row.0000.png"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["row.0000.png", "row.0001.png"]


def test_writing_pictures_imports_no_video_library(tmp_path):
    code = (
        "import sys, pathlib, numpy; from renderers.encoders.png import Writer;"
        f"w = Writer(pathlib.Path({str(tmp_path / 'a.png')!r}), numbered=False, comment='');"
        "w.write(numpy.zeros((4, 4, 3), numpy.uint8)); w.close();"
        "print([m for m in ('av', 'imageio') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def decoded(path):
    """The planes of each frame of a film."""
    with av.open(str(path)) as container:
        for frame in container.decode(video=0):
            rows = [np.frombuffer(plane, np.uint8).reshape(plane.height, plane.line_size) for plane in frame.planes]
            yield [row[:, : plane.width].astype(float) for row, plane in zip(rows, frame.planes, strict=True)]


def linear(code):
    c = np.asarray(code) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def video_levels(codes):
    """Exact levels of luma and both chroma of sRGB codes (..., 3), by ITU-R BT.709-6."""
    luma = codes @ [0.2126, 0.7152, 0.0722]
    chroma = [(codes[..., k] - luma) / (1 - share) for k, share in ((2, 0.0722), (0, 0.2126))]
    return [16 + 219 / 255 * luma, *(128 + 112 / 255 * one for one in chroma)]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_flat_tones_of_a_film_are_true_to_a_tenth_of_a_level_in_the_mean(tmp_path, seed):
    """What develop's dither says between two levels goes through the conversion to a film's planes and its coding.

    Chroma has the neighbors of another tone in its means.
    """
    side, tones = 32, np.random.default_rng(seed).uniform(5, 200, (9, 16))
    codes = np.repeat(np.repeat(tones, side, 0), side, 1)[..., None] * [1.0, 0.9, 0.8]
    writer = mp4.Writer(tmp_path / "film.mp4", size=(512, 288), rate=30, quality=17, comment="")
    for _ in range(4):
        writer.write(develop(linear(codes).astype(np.float32)))
    writer.close()
    *_, last = decoded(tmp_path / "film.mp4")
    for plane, wanted, most in zip(last, video_levels(codes), (0.04, 0.1, 0.1), strict=True):
        size = plane.shape[0] // 9
        off = (plane - wanted[:: codes.shape[0] // plane.shape[0], :: codes.shape[1] // plane.shape[1]]).reshape(
            9, size, 16, size
        )
        assert np.sqrt((off.mean((1, 3)) ** 2).mean()) < most


def test_planes_are_those_of_bt709_and_whole_levels_stay_as_they_are():
    codes = np.random.default_rng(2).integers(0, 256, (6, 8, 3)).astype(np.uint8)
    blocks = np.repeat(np.repeat(codes, 8, 0), 16, 1)
    for plane, wanted in zip(planes_of(blocks), video_levels(codes.astype(float)), strict=True):
        size = plane.shape[0] // 6
        inner = plane.reshape(6, size, 8, plane.shape[1] // 8)[:, :, :, 1:-1].astype(float)  # chroma reads neighbors
        assert np.abs(inner - wanted[:, None, :, None]).max() < 1
    for gray in (0, 255):
        luma, *chroma = planes_of(np.full((16, 16, 3), gray, np.uint8))
        assert (luma == 16 + 219 * gray // 255).all()
        assert all((one == 128).all() for one in chroma)


@pytest.mark.parametrize("rate", [24.0, 30.0, 60.0, 1.0])
def test_a_player_can_go_to_every_half_second(tmp_path, rate):
    film(tmp_path / "film.mp4", 70, rate)
    with av.open(str(tmp_path / "film.mp4")) as container:
        keys = [frame.time for frame in container.decode(video=0) if frame.key_frame]
    assert max(np.diff([*keys, 70 / rate])) <= max(0.5, 1 / rate) + 1e-9
