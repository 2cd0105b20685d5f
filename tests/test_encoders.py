"""Laws of encoders: what was asked for is in the file, files are whole or not there, bytes repeat."""

from __future__ import annotations

import subprocess
import sys

import av
import numpy as np
import pytest
from PIL import Image

from renderers.encoders import mp4, png

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


def test_writing_pictures_imports_no_video_library(tmp_path):
    code = (
        "import sys, pathlib, numpy; from renderers.encoders.png import Writer;"
        f"w = Writer(pathlib.Path({str(tmp_path / 'a.png')!r}), numbered=False, comment='');"
        "w.write(numpy.zeros((4, 4, 3), numpy.uint8)); w.close();"
        "print([m for m in ('av', 'imageio') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
